# SPDX-License-Identifier: Apache-2.0
"""Marks and segments of journals that are written by hand."""

import pytest

from rigid_body_sim.analysis.history import History, Mark, Segment, history
from rigid_body_sim.scene.scene import parse_scene

S = 1_000_000_000
SCENE = ('scene: s\nbody: {{mass: 1, inertia: [1, 2, 2.5]}}\nconstraint: {constraint}\n'
         'effects: [{effects}]\ninitial: {{}}\n')


def scene(effects='', constraint='free'):
    return parse_scene(SCENE.format(effects=effects, constraint=constraint))


def segment(**changes):
    return Segment(**{'stamp': 0, 'scene': scene(), 'rate': 100.0, 'pace': 1.0, **changes})


def commands(time, *given):
    return {'kind': 'commands', 'log_time': time, 'tick': time // 10_000_000, 'commands': [
        {'topic': topic, 'force': force, 'torque': (0, 0, torque)}
        for topic, force, torque in given]}


PUSH, HOLD = ('cmd_impulse', (1, 0, 0), 0), ('cmd_wrench', (1, 0, 0), 0)
TWIST, NOTHING = ('cmd_wrench', (0, 0, 0), 2), ('cmd_wrench', (0, 0, 0), 0)
ENDED = ('timeout', (1, 0, 0), 0)


@pytest.mark.parametrize(('effects', 'constraint', 'energy', 'momentum'), [
    ('', 'free', True, True), ('gravity: {g: 1}', 'free', True, True),
    ('gravity: {g: 1}', 'pivot', True, False),
    ('strike: {impulse: [1, 0, 0], time: 1}', 'free', True, True),
    ('internal_dissipation: {coefficient: 1}', 'free', False, True),
    ('drag: {linear: 1}', 'free', False, True),
    ('drag: {angular: 1}', 'free', False, False), ('torque: {value: [0, 0, 1]}', 'free', False,
                                                  False)])
def test_what_is_constant_follows_from_the_effects(effects, constraint, energy, momentum):
    one = segment(scene=scene(effects, constraint))
    assert (one.keeps_energy, one.keeps_momentum) == (energy, momentum)
    held = segment(scene=scene(effects, constraint), held=True)
    assert (held.keeps_energy, held.keeps_momentum) == (False, False)


def test_of_an_unknown_scene_nothing_is_known_to_be_constant():
    assert not segment(scene=None).keeps_energy
    assert not segment(scene=None).keeps_momentum


def test_a_wrench_is_held_until_it_is_nothing_or_ends_and_impulses_do_not_matter():
    found = history([commands(1 * S, PUSH), commands(2 * S, HOLD), commands(3 * S, PUSH),
                     commands(4 * S, NOTHING), commands(5 * S, TWIST), commands(6 * S, ENDED),
                     commands(7 * S, HOLD, PUSH), commands(8 * S, PUSH, HOLD)],
                    (), segment(), 9 * S)
    assert [one.held for one in found.segments] == [
        False, False, True, True, False, True, False, True, True]
    assert [one.begun_by for one in found.segments] == ['', *['commands'] * 8]
    assert [one.stamp for one in found.segments] == [k * S for k in range(9)]


def test_a_reset_ends_what_is_held_and_parameters_may():
    changed = {'kind': 'parameters', 'tick': 0, 'changed': {'rate': 50.0},
               'scene': SCENE.format(effects='drag: {linear: 1}', constraint='free'),
               'simulation': {'rate': 50.0}}
    found = history([
        commands(1 * S, HOLD), {'kind': 'reset', 'log_time': 2 * S, 'tick': 20},
        commands(3 * S, HOLD), {**changed, 'log_time': 4 * S, 'keeps_state': True},
        {**changed, 'log_time': 5 * S, 'keeps_state': False,
         'changed': {'real_time_factor': 2}}], (), segment(), 6 * S)
    assert [one.held for one in found.segments] == [False, True, False, True, True, False]
    assert [one.rate for one in found.segments] == [100.0] * 4 + [50.0] * 2
    assert [one.pace for one in found.segments] == [1.0] * 5 + [2.0]
    assert [one.keeps_energy for one in found.segments] == [
        True, False, True, False, False, False]
    assert [mark.name for mark in found.marks] == [
        'cmd_wrench', 'reset', 'cmd_wrench', 'rate = 50.0', 'real_time_factor = 2']


STRUCK = scene('strike: {impulse: [1, 0, 0], time: 1.5}, strike: {impulse: [1, 0, 0], time: 0},'
               ' strike: {impulse: [1, 0, 0], time: 4}')


def strikes(entries, end):
    found = history(entries, (), segment(scene=STRUCK), end)
    return ([mark.stamp / S for mark in found.marks if mark.kind == 'strike'],
            [one.stamp / S for one in found.segments],
            [one.begun_by for one in found.segments])


def test_strikes_cut_segments_at_their_times():
    assert strikes([], 10 * S) == ([0.0, 1.5, 4.0], [0.0, 1.5, 4.0], ['', 'strike', 'strike'])
    assert strikes([], 4 * S)[0] == [0.0, 1.5, 4.0]
    assert strikes([], 4 * S - 1)[0] == [0.0, 1.5]


def test_strikes_come_again_after_a_reset_only():
    reset = {'kind': 'reset', 'log_time': 2 * S, 'tick': 200}
    assert strikes([reset], 10 * S) == (
        [0.0, 1.5, 2.0, 3.5, 6.0], [0.0, 1.5, 2.0, 3.5, 6.0],
        ['', 'strike', 'reset', 'strike', 'strike'])
    assert strikes([commands(2 * S, PUSH)], 10 * S) == (
        [0.0, 1.5, 4.0], [0.0, 1.5, 2.0, 4.0], ['', 'strike', 'commands', 'strike'])
    # a command at the instant of a strike: the strike belongs to what ends there
    assert strikes([commands(int(1.5 * S), PUSH)], 3 * S)[0] == [0.0]
    assert strikes([commands(int(1.5 * S) + 1, PUSH)], 3 * S)[0] == [0.0, 1.5]


def test_each_stamp_has_its_segment_and_earlier_ones_have_the_first():
    found = History((), (segment(stamp=10), segment(stamp=20), segment(stamp=30)))
    assert found.at([0, 10, 19, 20, 29, 30, 99]).tolist() == [0, 0, 0, 1, 1, 2, 2]


def test_marks_are_in_the_order_of_their_stamps_with_what_they_say():
    status = {'name': 'flip', 'message': 'it flipped', 'values': [{'key': 'tick', 'value': '7'}]}
    found = history([
        commands(3 * S, PUSH, HOLD, PUSH),
        {'kind': 'gap', 'log_time': 9 * S, 'after': 1 * S, 'until': 2 * S, 'ticks': 99},
        {'kind': 'start', 'log_time': 0}], [(2 * S, status)], segment(), 9 * S)
    assert found.marks == (
        Mark(1 * S, 'gap', '99 ticks not recorded', {'ticks': 99, 'until': 2 * S}),
        Mark(2 * S, 'event', 'flip', {'message': 'it flipped', 'tick': '7'}),
        Mark(3 * S, 'commands', 'cmd_impulse, cmd_wrench', {'tick': 300}))
