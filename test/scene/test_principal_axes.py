# SPDX-License-Identifier: Apache-2.0
"""Principal axes where moments are equal: any axes of their plane will do, the nearest are taken.

Angles are in radians.
"""

from decimal import Decimal

import numpy as np
import pytest
from near import near
from scipy.spatial.transform import Rotation

from rigid_body_sim.scene.principal_axes import (
    ULPS,
    Lost,
    _lost,
    eigenvectors,
    is_slim,
    nearest_to_the_body,
    nearest_where_equal,
    without_traces,
)

LOST = 1e-20, 2e-20, 3e-20
NOTHING = [[0.0] * 3 for _ in range(3)]


def nearest(moments, rows):
    """Return moments, axes and what is lost, of axes given as rows."""
    return nearest_where_equal(list(moments), [list(map(float, row)) for row in rows],
                               Lost(list(LOST), [list(row) for row in NOTHING]))


@pytest.mark.parametrize('angle', [0.3, -1.2, 0.7])
@pytest.mark.parametrize('k', [0, 1, 2])
def test_axes_in_the_plane_of_two_equal_moments_turn_to_those_of_the_body(k, angle):
    """The third axis is tilted: nothing but its own plane may turn."""
    moments, i, j = [2.0, 2.0, 2.0], (k + 1) % 3, (k + 2) % 3
    moments[k] = 3.0
    tilt = Rotation.from_rotvec(0.4 * np.eye(3)[i] - 0.2 * np.eye(3)[j])
    rows = (tilt * Rotation.from_rotvec(angle * np.eye(3)[k])).as_matrix().T
    found, axes, lost = nearest(moments, rows)
    axes = np.array(axes)
    assert found == moments
    assert axes[k].tolist() == rows[k].tolist()
    assert axes @ axes.T == pytest.approx(np.eye(3), abs=4e-16)    # measured: 2e-16
    assert np.linalg.det(axes) > 0.0
    # as much of the body's axes as the plane allows: a further turn in it would only lose
    assert axes[i][j] - axes[j][i] == pytest.approx(0.0, abs=4e-16)
    assert axes[i][i] + axes[j][j] > 0.0
    assert (lost.moments[i], lost.moments[j]) == (0.0, 0.0)
    assert lost.moments[k] == LOST[k]


def test_what_rounding_takes_from_the_turned_axes_is_kept():
    rows = Rotation.from_rotvec([0.1, 0.2, 0.9]).as_matrix().T
    _, axes, lost = nearest((2.0, 2.0, 3.0), rows)
    whole = np.array(axes, dtype=np.longdouble) + np.array(lost.vectors, dtype=np.longdouble)
    taken = np.abs(lost.vectors[:2])
    assert 0.0 < taken.max() < 2e-16
    # the axes that were given are orthogonal to rounding; norms are made 1 from these
    for row in whole[:2]:
        assert abs(float(row @ row) - 1.0) < 5e-16


@pytest.mark.parametrize(('second', 'equal'), [
    (2.0 * (1.0 + 0.4 * ULPS), True), (2.0 * (1.0 + 4.0 * ULPS), False)])
def test_moments_that_agree_to_rounding_become_their_mean(second, equal):
    rows = Rotation.from_rotvec([0.0, 0.0, 0.5]).as_matrix().T
    moments, axes, _ = nearest((2.0, second, 3.0), rows)
    assert moments == ([0.5 * (2.0 + second)] * 2 if equal else [2.0, second]) + [3.0]
    assert np.array(axes) == pytest.approx(np.eye(3) if equal else rows, abs=2e-16)


def test_a_sphere_has_the_axes_of_the_body():
    rows = Rotation.random(random_state=1).as_matrix().T
    moments, axes, lost = nearest((2.0, 2.0, 2.0), rows)
    assert (moments, axes, lost) == ([2.0] * 3, np.eye(3).tolist(), Lost([0.0] * 3, NOTHING))
    # one moment is three units in the last place larger: the mean is one unit larger
    for k in range(3):
        moments, _, _ = nearest(np.roll((2.0 + 3.0 * 2.0 ** -51, 2.0, 2.0), k).tolist(), rows)
        assert moments == [2.0 + 2.0 ** -51] * 3


@pytest.mark.parametrize(('least', 'slim'), [
    (0.0, False), (1e-16, False), (1e-12, True), (0.99 * 2.0 ** -10, True),
    (1.01 * 2.0 ** -10, False)])
def test_a_slim_body_keeps_two_moments_that_differ_by_their_rounding(least, slim):
    for size in 1e-9, 1.0, 1e9:
        assert bool(is_slim((size, size, size * least))) is slim
    rows = Rotation.from_rotvec([0.0, 0.0, 0.5]).as_matrix().T
    moments, axes, _ = nearest((1.0, 1.0 + 2.0 ** -52, least), rows)
    assert (axes == rows.tolist()) is slim
    assert (moments[1] > moments[0]) is slim


@pytest.mark.parametrize('size', [1e-9, 1.0, 1e9])
@pytest.mark.parametrize(('off', 'turned'), [(1e-30, True), (1e-36, False)])
def test_what_is_off_the_diagonal_counts_beside_what_is_on_it(size, off, turned):
    """In a unit of any size: the square of 1e-36 is below 1e-70 of 2 times 1."""
    moments, (first, second, _), _ = eigenvectors(
        [[2.0 * size, off * size, 0.0], [off * size, size, 0.0], [0.0, 0.0, 3.0 * size]])
    assert moments == [2.0 * size, size, 3.0 * size]
    assert (first[1], second[0]) == near((off, -off) if turned else (0.0, 0.0), rel=1e-12)


@pytest.mark.parametrize('size', [1e-9, 1.0, 1e9])
@pytest.mark.parametrize(('share', 'left'), [(1.1e-36, True), (0.9e-36, False), (-0.9e-36, False)])
def test_a_moment_that_is_but_a_trace_of_the_largest_is_zero(size, share, left):
    moments, vectors, lost = without_traces(
        [size * share, 0.5 * size, size], NOTHING, Lost(list(LOST), NOTHING))
    assert moments == [size * share if left else 0.0, 0.5 * size, size]
    assert lost.moments == [LOST[0] if left else 0.0, *LOST[1:]] and vectors is NOTHING


def test_what_a_double_lost_is_nothing_where_it_overflows():
    assert _lost(Decimal('1e400')) == 0.0
    assert _lost(Decimal('0.1')) == near(-5.551115123125783e-18, rel=1e-15)


@pytest.mark.parametrize('seed', range(8))
def test_of_all_orders_and_signs_of_the_axes_the_turn_is_the_least(seed):
    rows = Rotation.random(random_state=seed).as_matrix().T
    _, axes, _ = nearest_to_the_body([1.0, 2.0, 4.0], rows.tolist(), Lost(list(LOST), NOTHING))
    found = Rotation.from_matrix(axes).magnitude()
    assert found == near(min((one * Rotation.from_matrix(rows)).magnitude()
                             for one in Rotation.create_group('O')), rel=1e-14)


@pytest.mark.parametrize('order', [(0, 1, 2), (2, 0, 1), (0, 2, 1), (2, 1, 0)])
@pytest.mark.parametrize('signs', [(1, 1, 1), (-1, 1, 1), (1, -1, -1), (-1, -1, -1)])
def test_axes_in_any_order_and_of_any_sign_become_those_nearest_to_the_body(order, signs):
    """Those of a turn by 0.3 rad come back, with their moments and with what they lost."""
    rows = Rotation.from_rotvec([0.2, -0.1, 0.2]).as_matrix().T
    lost = 1e-17 * np.arange(9.0).reshape(3, 3)
    given = [(sign * rows[k], sign * lost[k]) for k, sign in zip(order, signs, strict=True)]
    moments, axes, found = nearest_to_the_body(
        [(1.0, 2.0, 4.0)[k] for k in order], [row.tolist() for row, _ in given],
        Lost([LOST[k] for k in order], [less.tolist() for _, less in given]))
    assert moments == [1.0, 2.0, 4.0] and found.moments == list(LOST)
    assert axes == rows.tolist() and np.array_equal(found.vectors, lost)
