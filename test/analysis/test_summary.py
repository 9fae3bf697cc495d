# SPDX-License-Identifier: Apache-2.0
"""The words of the short report, from numbers as report.json has them."""

import types

import pytest

from rigid_body_sim.analysis import summary

LEVEL = {'value': 2.5, 'from': 0.0, 'until': None, 'begun_by': None}
KEPT = {'first': 2.5, 'last': 2.5, 'levels': [LEVEL], 'stretches': 1, 'last_residual': -2e-16,
        'largest_residual': 3e-16}
FOUND = {
    'namespace': '/', 'scene': 'top', 'made_by': 'sim_node', 'version': '1.2.3', 'rate': 500.0,
    'run': {'method': 'exact'}, 'accuracy_missed': [], 'energy': KEPT,
    'angular_momentum_squared': KEPT, 'momentum': None, 'flips': None, 'phases': None, 'lines': [],
    'events': {}, 'strikes': 0, 'commands': 0, 'parameter_changes': 0, 'left_out_by_recorder': 0,
    'timing': {'ticks': 11, 'missing': 0, 'lateness': None}}


def report(**changes):
    """Return the lines of a report with other numbers."""
    return summary.lines(FOUND | changes)


def test_a_quiet_run_is_told_in_four_lines():
    kept = 'drift -2.0e-16, largest residual 3.0e-16 (relative, round-off)'
    assert report() == [
        'top: exact, 500 Hz, by sim_node 1.2.3; 11 ticks', f'  energy   2.5 J; {kept}',
        f'  L^2      2.5 (kg m^2/s)^2; {kept}', '  drops    none']


@pytest.mark.parametrize(('changes', 'first'), [
    ({'scene': None}, 'unknown scene: exact, 500 Hz, by sim_node 1.2.3; 11 ticks'),
    ({'namespace': '/left'}, 'top in /left: exact, 500 Hz, by sim_node 1.2.3; 11 ticks'),
    ({'version': ''}, 'top: exact, 500 Hz, by sim_node; 11 ticks'),
    ({'made_by': ''}, 'top: exact, 500 Hz; 11 ticks'),
    ({'run': None, 'rate': 499.98765432}, 'top: 499.988 Hz, by sim_node 1.2.3; 11 ticks')])
def test_the_first_line_names_what_was_recorded(changes, first):
    assert report(**changes)[0] == first


@pytest.mark.parametrize(('missing', 'left_out', 'told'), [
    (0, 0, 'none'), (40, 40, '40 ticks are missing, 40 of them left out by the recorder'),
    (3, 0, '3 ticks are missing, 0 of them left out by the recorder'),
    (0, 2, '0 ticks are missing, 2 of them left out by the recorder')])
def test_drops_are_told_whoever_lost_them(missing, left_out, told):
    timing = FOUND['timing'] | {'missing': missing}
    assert report(timing=timing, left_out_by_recorder=left_out)[-1] == f'  drops    {told}'


@pytest.mark.parametrize(('values', 'told'), [
    (dict.fromkeys(KEPT), 'not recorded'),
    (KEPT | {'last': 3.0, 'largest_residual': None},
     '2.5 to 3 J (not constant in this scene)'),
    (KEPT | {'largest_residual': 1e-3, 'last_residual': 1e-4},
     '2.5 J; drift +1.0e-04, largest residual 1.0e-03 (relative)'),
    (KEPT | {'largest_residual': 2.0**-50},    # 4 ulp of 1
     '2.5 J; drift -2.0e-16, largest residual 8.9e-16 (relative, round-off)'),
    (KEPT | {'stretches': 2, 'levels': [
        LEVEL | {'until': 1.0}, {'value': 4.0, 'from': 1.0, 'until': None, 'begun_by': 'a hit'}]},
     '2.5 J from 0 s on, 4 J from 1 s on (a hit); within each '
     'drift -2.0e-16, largest residual 3.0e-16 (relative, round-off)'),
    # a wrench is held between the two
    (KEPT | {'stretches': 2, 'levels': [
        LEVEL | {'until': 1.0}, {'value': 4.0, 'from': 1.5, 'until': None, 'begun_by': None}]},
     '2.5 J from 0 to 1 s, 4 J from 1.5 s on; within each '
     'drift -2.0e-16, largest residual 3.0e-16 (relative, round-off)'),
    (KEPT | {'levels': [LEVEL | {'until': 1.0}]},
     '2.5 J from 0 to 1 s; within each '
     'drift -2.0e-16, largest residual 3.0e-16 (relative, round-off)')])
def test_a_quantity_is_told_for_each_stretch_in_which_it_is_constant(values, told):
    assert report(energy=values)[1] == f'  energy   {told}'


@pytest.mark.parametrize(('stretches', 'end'), [
    (6, '6 J from 5 s on; within'), (7, '6 J from 5 s on, and in 1 more stretches; within')])
def test_six_stretches_are_told_and_the_others_counted(stretches, end):
    levels = [{'value': k + 1.0, 'from': float(k), 'until': k + 1.0, 'begun_by': None}
              for k in range(stretches)]
    levels[-1]['until'] = None
    line = report(energy=KEPT | {'stretches': stretches, 'levels': levels})[1]
    assert end in line
    assert line.count(' J from ') == 6


@pytest.mark.parametrize(('count', 'told'), [
    (2, 'slides 0 to 1 s, rolls 1 to 2 s'),
    (7, 'slides 0 to 1 s, rolls 1 to 2 s, slides 2 to 3 s, rolls 3 to 4 s, slides 4 to 5 s, '
        'rolls 5 to 6 s and 1 more')])
def test_phases_are_told_with_their_times(count, told):
    motion = types.SimpleNamespace(until=float(count), phases=[
        ('slides' if k % 2 == 0 else 'rolls', float(k)) for k in range(count)])
    assert f'  phases   {told}' in report(phases=summary.phases(motion))


@pytest.mark.parametrize(('parts', 'told'), [
    (1, ''), (2, 'within each of 2 stretches '), (3, 'within each of 3 stretches ')])
def test_the_angular_momentum_is_told_by_its_name(parts, told):
    momentum = {'of': 'L_z', 'stretches': parts, 'last_residual': 0.0, 'largest_residual': 1e-16}
    assert (f'  L_z      {told}drift +0.0e+00, largest residual 1.0e-16 (relative, round-off)'
            in report(momentum=momentum))
    assert not [line for line in report(momentum=momentum | {'largest_residual': None})
                if 'L_z' in line]


def test_events_commands_and_changes_are_counted():
    assert '  events   2 x impact, 1 x strike, 1 tick with commands, 3 changes of parameters' in (
        report(events={'flip': 9, 'impact': 2}, strikes=1, commands=1, parameter_changes=3,
               flips=9))
    assert '  flips    0' in report(flips=0)
    assert not [line for line in report(events={'flip': 9}) if 'events' in line]


def test_a_frequency_that_was_not_found_is_left_out():
    line = {'name': 'nutation', 'axes': 'xy', 'source': 'theory', 'predicted': 4.0,
            'measured': 4.004}
    other = line | {'name': 'precession', 'measured': None}
    told = report(lines=[line, other])
    assert ('  nutation: 4.004 Hz measured, 4 Hz predicted (+1.0e-03 relative; theory)') in told
    assert not [text for text in told if 'precession' in text]


def test_lateness_is_told_in_microseconds():
    timing = FOUND['timing'] | {
        'lateness': {'p50': 39e-6, 'p99': 185e-6, 'max': 2.698e-3}, 'achieved_rate': None,
        'standstills': 0}
    late = '  messages were published late by p50 39, p99 185, max 2698 us'
    assert late in report(timing=timing)
    assert f'{late}; 499.500 Hz achieved; stood still 2 times' in report(
        timing=timing | {'achieved_rate': 499.5, 'standstills': 2})


def told(what):
    """Return something whose summary is what is given."""
    return types.SimpleNamespace(summary=lambda: what)


def mark(kind, name='', **values):
    return types.SimpleNamespace(kind=kind, name=name, values=values)


@pytest.mark.parametrize('known', [True, False])
def test_the_numbers_of_a_report_are_those_that_were_measured(known):
    history = types.SimpleNamespace(segments=[types.SimpleNamespace(rate=500.0), None], marks=[
        mark('event', 'flip'), mark('event', 'flip'), mark('event', 'lift'), mark('strike'),
        mark('commands'), mark('gap', ticks=3), mark('gap', ticks=4), mark('reset'),
        mark('parameters'), mark('parameters')])
    scene = types.SimpleNamespace(name='top')
    source = types.SimpleNamespace(
        history=history, namespace='/left', scene=scene if known else None, made_by='sim_node',
        version='1.2.3', run={'method': 'exact'}, accuracy_missed=['late'])
    motion = types.SimpleNamespace(
        conserved=types.SimpleNamespace(name='L_z'), momentum=told({'stretches': 2}), slip=None)
    measured = types.SimpleNamespace(
        source=source, motion=motion if known else None, energy=told('E'), momentum=told('L'),
        punctuality=told('t'), flips=types.SimpleNamespace(count=2) if known else None)
    line = types.SimpleNamespace(name='n', axes='xy', source='theory', frequency=4.0)
    found = summary.summary(
        measured, *(types.SimpleNamespace(lines=[(line, 4.25)]), (None, {'work': [1.0, 2.0, 5.0]})
                    ) if known else ())
    assert found == {
        'namespace': '/left', 'scene': 'top' if known else None, 'made_by': 'sim_node',
        'version': '1.2.3', 'run': {'method': 'exact'}, 'accuracy_missed': ['late'], 'rate': 500.0,
        'energy': 'E', 'angular_momentum_squared': 'L', 'round_off_floor': summary.FLOOR,
        'flips': 2 if known else None, 'events': {'flip': 2, 'lift': 1}, 'strikes': 1,
        'commands': 1, 'resets': 1, 'parameter_changes': 2, 'timing': 't',
        'left_out_by_recorder': 7,
        'momentum': {'of': 'L_z', 'stretches': 2} if known else None, 'phases': None,
        'lines': [{'name': 'n', 'axes': 'xy', 'source': 'theory', 'predicted': 4.0,
                   'measured': 4.25}] if known else [],
        'ledger': {'work': 5.0} if known else None}
