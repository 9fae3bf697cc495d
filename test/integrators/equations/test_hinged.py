# SPDX-License-Identifier: Apache-2.0
"""The angle of a body on a hinge: less whole turns, without losing a digit of it."""

from fractions import Fraction

import mpmath
import numpy as np
import pytest
from near import near

from rigid_body_sim.compilation.templates import specialise
from rigid_body_sim.integrators.equations import euler, hinged, hinged_field
from rigid_body_sim.integrators.equations.hinged import (
    TURN,
    angle_between,
    attitude,
    less_turns,
    settled,
)
from rigid_body_sim.numerics.rotations import multiply

pytestmark = pytest.mark.without_numba

with mpmath.workdps(40):
    TWO_TURNS = Fraction(str(4 * mpmath.pi))


@pytest.mark.parametrize(('phi', 'turns'), [
    (6.3, -1), (9.0, -1), (12.5, -1), (-6.3, 1), (-12.5, 1), (6.28, 0), (-6.28, 0), (0.0, 0)])
def test_an_angle_beyond_a_turn_loses_two_turns_and_no_digit(phi, turns):
    y, c = settled((phi, 5.0), (3e-17, 7e-18))
    assert (y[1], c[1]) == (5.0, 7e-18)
    assert abs(y[0]) < TURN
    left = Fraction(y[0]) + Fraction(c[0]) - Fraction(phi) - Fraction(3e-17) - turns * TWO_TURNS
    # measured: 3e-32
    assert abs(left) < 1e-31


@pytest.mark.parametrize('phi', [0.0, 0.3, -0.3, 6.2, -6.2])
@pytest.mark.parametrize('turned', [0.1, -0.1, 3.2, -3.2, 6.2, -6.2])
def test_a_turn_is_told_without_two_turns_so_that_the_angle_stays_within_one(phi, turned):
    found = less_turns(turned, phi)
    assert -TURN < found + phi <= TURN
    turns = (found - turned) / float(TWO_TURNS)
    assert turns == pytest.approx(round(turns), abs=1e-15)    # measured: 1e-16


@pytest.mark.parametrize('angle', [0.2, -0.2, 3.0, 3.3, -3.3, 6.2, -6.2])
def test_the_angle_between_attitudes_is_told_up_to_a_turn_either_way(angle):
    """The sign of the second quaternion tells angles apart that differ by a turn."""
    n, q = np.array([0.48, -0.6, 0.64]), (0.1, -0.5, 0.5, 0.7)
    turn = *(np.sin(0.5 * angle) * n), np.cos(0.5 * angle)
    # measured: 4e-16
    assert angle_between(q, multiply(*q, *turn), tuple(n)) == near(angle, rel=4e-15)


@pytest.mark.parametrize('in_field', [False, True])
def test_the_rate_grows_by_the_torque_about_the_axis_over_the_moment(in_field):
    """The torque is asked at the attitude, at omega = phi' n and at rest in the place."""
    rows = np.random.default_rng(1).normal(size=(3, 14 if in_field else 10)).round(3)
    kind, n, place = hinged_field if in_field else hinged, (0.48, -0.6, 0.64), (0.7, -0.8, 0.9)
    bound = specialise(kind, torque='def torque(p, *state):\n    return tuple(sum(a * b for a, b '
                       f'in zip(row, state, strict=True)) for row in {rows.tolist()})\n')
    p, phi, speed, time = np.zeros(hinged.PARAMETERS.size), 0.9, -1.7, 0.4
    euler.BODY.part('hinge_axis').store(p, n)
    hinged.store_attitude(p, (0.1, -0.5, 0.5, 0.7))
    euler.store_start(p, euler.Start(0.3, place, (1.0, 2.0, 3.0)))
    p[hinged.INVERSE] = 2.5
    q = multiply(0.1, -0.5, 0.5, 0.7, *(np.sin(0.45) * np.array(n)), np.cos(0.45))
    assert attitude(p, phi) == near(q, rel=4e-15)
    state = [*q, *(speed * np.array(n)), 0.0, 0.0, 0.0]
    growth = 2.5 * np.dot(n, rows @ [*state, *((time, *place) if in_field else ())])
    found = bound.rate(p, (phi, speed, time) if in_field else (phi, speed))
    # measured: 2e-16
    assert found == near((speed, growth, 1.0)[:len(found)], rel=4e-15)


@pytest.mark.parametrize('in_field', [False, True])
def test_a_state_is_an_angle_and_its_rate_and_back(in_field):
    """From a start on, where phi is 0: the place stays, and the hinge point is the reference."""
    kind, n, q = hinged_field if in_field else hinged, (0.48, -0.6, 0.64), (0.1, -0.5, 0.5, 0.7)
    bound = specialise(kind, torque='def torque(p, *state):\n    return 0.0, 0.0, 0.0\n')
    p, point, out = np.zeros(hinged.PARAMETERS.size), np.full(6, 9.0), np.empty(14)
    euler.BODY.part('hinge_axis').store(p, n)
    euler.BODY.part('frame_axes').store(p, (0.0, 0.0, 0.0, 1.0))
    place = (0.7, -0.8, 0.9)
    bound.start(p, np.array([0.3, *q, *(-1.7 * np.array(n)), *place, 0.0, 0.0, 0.0]), point, 2)
    assert point == near([9.0, 9.0, 0.0, -1.7, *([0.3] if in_field else [9.0]), 9.0], rel=1e-15)
    assert hinged.load_attitude(p) == q
    bound.write(p, 0.4, (0.9, 2.5), out)
    turned = multiply(*q, *(np.sin(0.45) * np.array(n)), np.cos(0.45))
    expected = [0.4, *turned, *(2.5 * np.array(n)), *place, 0.0, 0.0, 0.0]
    assert out == near(expected, rel=4e-15)    # measured: 2e-16
