# SPDX-License-Identifier: Apache-2.0
"""Table and figure of a work-precision study of made-up results, by hand and as they were kept."""

import kept
import pytest

from rigid_body_sim.study.precision import figure, table


def point(error, cost, **more):
    return {'setting': 1, 'set_up': 0.25, 'first_run': 0.1, 'error': error,
            'largest_error': 2.0 * error, 'omega_error': 3.0 * error, 'largest_omega_error': error,
            'energy_residual': 1e-15, 'momentum_residual': 2e-15,
            'cpu': {'median': cost, 'least': 0.9 * cost, 'most': 1.5 * cost}, **more}


def line(name, *points, peer=False, control='accuracy', notes=(), variant=''):
    return {'name': name, 'variant': variant, 'control': control, 'is_peer': peer,
            'notes': list(notes), 'points': [point(*one) for one in points]}


RESULT = {
    'problem': 'racket', 'about': 'made up', 'duration': 100.0, 'floor': 1e-13,
    'lines': [
        line('exact', (1e-15, 2e-6), control='none'),
        line('exact, one more state', (1e-15, 1e-7), control='none'),
        line('dop8', (1e-2, 1e-5), (1e-5, 3e-5), (1e-10, 8e-5), (2e-13, 2e-4),
             notes=['first', 'it gave up at 1e-14']),
        line('dop8, fixed step', (1e-4, 4e-6), (1e-8, 9e-5), control='step'),
        line('a peer', (1e-4, 4e-5), (1e-7, 1e-4), peer=True),
        line('another', (20.0, 1e-6), (1e-18, 1e-2), peer=True)],
    'refused': {'lsoda': 'it is not asked'}}
LINES = {one['name']: one for one in RESULT['lines']}


def test_the_cost_at_a_level_is_the_least_of_what_reaches_it():
    assert table.cost_at(LINES['dop8'], 1e-3) == 3e-5
    assert table.cost_at(LINES['dop8'], 1e-5) == 3e-5    # reached exactly
    assert table.cost_at(LINES['dop8'], 1e-12) == 2e-4
    assert table.cost_at(LINES['dop8'], 1e-13) is None
    assert table.cost_at(LINES['dop8'], 1e-5, 'largest_error') == 8e-5
    assert table.best(LINES['dop8']) == 2e-13


def test_ratios_compare_our_cheapest_with_the_cheapest_peer():
    found = table.ratios(RESULT, lambda name: name.startswith('dop8'))
    assert found == pytest.approx([4e-6 / 4e-5, 8e-5 / 1e-4, 8e-5 / 1e-2, 2e-4 / 1e-2])
    assert table.ratios(RESULT, lambda name: False) == [None] * 4
    alone = RESULT | {'lines': [one for one in RESULT['lines'] if not one['is_peer']]}
    assert table.ratios(alone, lambda name: True) == [None] * 4


def test_variants_of_one_line_are_joined_to_the_points_that_no_cheaper_one_beats():
    engine = [line('engine', (1.0, 1e-4), (0.1, 1e-3), (0.02, 1e-2), peer=True, control='step',
                   variant='soft', notes=['it sank']),
              line('engine', (0.5, 2e-4), (0.2, 2e-3), (0.01, 2e-2), peer=True, control='step',
                   variant='stiff', notes=['it shook'])]
    alone, joined = table.fronts([LINES['dop8'], *engine])
    assert alone == LINES['dop8']
    assert [(one['error'], one['cpu']['median']) for one in joined['points']] == [
        (1.0, 1e-4), (0.5, 2e-4), (0.1, 1e-3), (0.02, 1e-2), (0.01, 2e-2)]
    assert [one['setting'] for one in joined['points'][:2]] == ['soft, step 1', 'stiff, step 1']
    assert joined['notes'] == ['it sank', 'it shook']
    result = RESULT | {'lines': [LINES['dop8'], *engine]}
    assert sum('engine (peer)' in row for row in table.lines(result)) == 1
    axes, = figure.draw([result]).axes
    drawn = axes.containers[-1][0].get_ydata().tolist()
    assert drawn == [1.0, 0.5, 0.1, 0.02, 0.01]


def test_of_equal_errors_and_of_equal_costs_the_first_point_is_kept():
    """The joined line has the name and the sign of a peer of its variants, and no variant."""
    engine = [line('engine', (1.0, 1e-4), (0.5, 1e-3), peer=True, control='step', variant='stiff'),
              line('engine', (0.5, 2e-3), (0.8, 1e-4), (0.25, 4e-3), peer=True,
                   control='tolerance', variant='soft', notes=['first', 'second', 'last'])]
    joined, = table.fronts(engine)
    assert [(one['error'], one['cpu']['median']) for one in joined['points']] == [
        (0.8, 1e-4), (0.5, 1e-3), (0.25, 4e-3)]
    assert [one['setting'] for one in joined['points']] == [
        'soft, step 1', 'stiff, step 1', 'soft, step 1']
    assert (joined['name'], joined['variant'], joined['control'], joined['is_peer']) == (
        'engine', '', 'step', True)
    text = table.lines(RESULT | {'lines': engine, 'refused': {}})
    assert [row for row in text if row.startswith('  engine: ')] == ['  engine: last']


@pytest.mark.parametrize(('ratio', 'text'), [
    (None, '-'), (2.0, '1/0.5'), (0.0101, '1/99'), (0.0015, '1/667'), (1.0 / 1234.0, '1/1234'),
    (1.0 / 12345.6, '1/12346')])
def test_a_share_is_one_over_a_number(ratio, text):
    assert table._share(ratio) == text


def test_who_leads_at_some_level_is_drawn_thick():
    ours = [one for one in RESULT['lines'] if not one['is_peer']]
    assert figure.leaders(ours) == {'exact, one more state'}
    assert figure.leaders(ours[2:]) == {'dop8', 'dop8, fixed step'}
    assert figure.leaders([LINES['a peer'], LINES['another']]) == {'a peer', 'another'}
    assert figure.leaders([]) == set()


@pytest.mark.parametrize('count', [1, 3])
def test_ours_have_full_marks_and_two_names_stand_below_each_column(count):
    drawn = figure.draw([RESULT] * count)
    is_peer = {line['name']: line['is_peer'] for line in table.fronts(RESULT['lines'])}
    for axes in drawn.axes:
        lines = {one.get_label(): one[0] for one in axes.containers}
        assert {name: line.get_markerfacecolor() == line.get_color()
                for name, line in lines.items()} == {
                    name: not peer for name, peer in is_peer.items()}
    legend, = drawn.legends
    assert (legend._ncols, legend.get_frame_on()) == (2 * min(2, count), False)


def test_table_and_figure_are_those_kept():
    other = RESULT | {'problem': 'top', 'floor': 1e-10, 'lines': RESULT['lines'][2:5]}
    kept.check('work_precision', {
        'table': table.lines(RESULT), 'another': table.lines(other),
        'figure': kept.drawn(figure.draw([RESULT, other, RESULT])),
        'alone': kept.drawn(figure.draw([other]))})
