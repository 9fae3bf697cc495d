# SPDX-License-Identifier: Apache-2.0
"""The way from a state to the unknowns of a method, and back."""

import math

import numpy as np
import pytest
from mpmath import mpf, sqrt, workdps

from rigid_body_sim.integrators.equations.equations import Equations
from rigid_body_sim.integrators.equations.euler import (
    EQUATION,
    attitude_rate,
    lost_norm,
    settled,
    taken,
    unit,
)
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.scene.state import STATE_SIZE, State

pytestmark = pytest.mark.without_numba


SKEW = [[0.3, 0.01, 0.0], [0.01, 0.4, 0.02], [0.0, 0.02, 0.5]]


@pytest.mark.parametrize(('inertia', 'center'), [
    ([3.0, 4.0, 5.0], (0.0, 0.0, 0.0)), ([3.0, 4.0, 5.0], (1.0, 0.0, 0.0)),
    ([3.0, 4.0, 5.0], (0.0, 1.0, 0.0)), ([3.0, 4.0, 5.0], (0.0, 0.0, 1.0)),
    (SKEW, (0.3, -0.2, 0.1))])
def test_what_is_written_is_what_was_read(inertia, center):
    """Whether the centre of mass, whose place is solved for, is the body's origin or beside it."""
    scene = parse_scene(
        f'scene: s\nbody: {{mass: 2.0, inertia: {inertia}, '
        f'center_of_mass: {list(center)}}}\nconstraint: free\neffects: [drag: {{linear: 1.0}}]\n'
        'initial: {}\n')
    start = State.of(1.5, (0.1, -0.5, 0.5, 0.7), (1.0, -2.0, 3.0), (1.0, 2.0, 3.0),
                     (0.1, -0.2, 0.3)).vector
    equations, out = Equations(scene, None), np.empty(STATE_SIZE)
    p, y = equations.start(start)
    equations.kernels.write(p, 1.5, tuple(y.tolist()), out)
    # measured: 5e-16
    assert out == pytest.approx(start, abs=4e-15)


@pytest.mark.parametrize(('q', 'lost'), [
    # numbers whose squares are doubles
    ((0.5, 0.5, 0.5, 0.5), 0.0), ((0.5, 0.0, 0.0, 0.0), 0.375), ((0.0, 0.25, 0.0, 0.0), 0.46875),
    ((0.0, 0.0, 2.0, 0.0), -1.5), ((0.0, 0.0, 0.0, 1.5), -0.625),
    ((0.5, -0.25, 0.125, 0.75), 0.5 * (1.0 - 0.890625))])
def test_what_a_norm_has_lost_is_half_of_what_its_square_lacks(q, lost):
    assert lost_norm(*q) == lost


def of_pauli(x, y, z, w):
    """Return the unitary matrix of a quaternion: products of matrices are those of quaternions."""
    return np.array([[w - 1j * z, -y - 1j * x], [y - 1j * x, w + 1j * z]])


@pytest.mark.parametrize('q', [(0.0, 0.0, 0.0, 1.0), (0.1, -0.5, 0.3, 0.8), (1.0, 2.0, -3.0, 0.5)])
@pytest.mark.parametrize('omega', [(2.0, 0.0, 0.0), (0.3, -0.7, 1.1)])
def test_the_attitude_turns_by_half_of_its_product_with_the_angular_velocity(q, omega):
    rate = of_pauli(*attitude_rate(*q, *omega))
    assert rate == pytest.approx(0.5 * of_pauli(*q) @ of_pauli(*omega, 0.0), abs=1e-15)


@pytest.mark.parametrize(('moments', 'left'), [
    ((1.0, 1.0, 1.0), (5.0, 6.0, 7.0)), ((0.0, 1.0, 1.0), (0.0, 6.0, 7.0)),
    ((1.0, 0.0, 1.0), (5.0, 0.0, 7.0)), ((1.0, 1.0, 0.0), (5.0, 6.0, 0.0)),
    ((0.0, 0.0, 1.0), (0.0, 0.0, 7.0))])
def test_no_torque_turns_a_body_about_an_axis_without_a_moment(moments, left):
    p = np.zeros(EQUATION.size)
    EQUATION.part('inverse').store(p, moments)
    assert taken(p, 5.0, 6.0, 7.0) == left


@pytest.mark.parametrize('stretch', [1.0, 1.0 + 3e-13, 1.0 - 2e-12])
@pytest.mark.parametrize('lost', [(0.0, 0.0, 0.0, 0.0), (3e-14, -2e-14, 1e-14, 5e-14)])
@pytest.mark.parametrize('way', [(0.1, -0.5, 0.3, 0.8), (0.8, 0.3, -0.5, -0.1)])
def test_an_attitude_and_what_it_lost_get_norm_1_together(stretch, lost, way):
    """They are q + c over its norm, to what the norm of q rounds."""
    q = tuple((stretch * np.array(way) / math.sqrt(0.99)).tolist())
    found, rest = unit(*q, *lost)
    with workdps(40):
        sums = [mpf(one) + mpf(more) for one, more in zip(q, lost, strict=True)]
        norm = sqrt(sum(one * one for one in sums))
        for one, more, exact in zip(found, rest, sums, strict=True):
            assert abs(mpf(one) + mpf(more) - exact / norm) < 1e-16    # measured: 3e-17
            assert abs(more) <= 0.5 * math.ulp(one)
    y, c = (*q, 1.0, 2.0, 3.0), (*lost, 1e-18, 2e-18, 3e-18)
    assert settled(y, c) == ((*found, *y[4:]), (*rest, *c[4:]))
