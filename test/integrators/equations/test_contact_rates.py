# SPDX-License-Identifier: Apache-2.0
"""A body on a plane: when its gap ends a flight, where it is a moment later, what is written."""

import numpy as np
import pytest
from near import near

from rigid_body_sim.integrators.equations import contact_states
from rigid_body_sim.integrators.equations.contact_rates import SHORT
from rigid_body_sim.integrators.equations.contact_views import (
    FLIGHT,
    LEDGER,
    ROLLING,
    ROW,
    UNKNOWNS,
)
from rigid_body_sim.integrators.marching.contact import OnPlane
from rigid_body_sim.integrators.marching.contact_phase import MODE, SWIFT
from rigid_body_sim.mechanics.contact.forces import posture
from rigid_body_sim.mechanics.contact.parameters import CONTACT
from rigid_body_sim.mechanics.contact.touch import lever
from rigid_body_sim.mechanics.ledger import ENTRIES_SIZE, HEATS
from rigid_body_sim.numerics.rotations import matrix
from rigid_body_sim.numerics.vectors import apply, cross
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.scene.state import STATE_SIZE

pytestmark = pytest.mark.without_numba

GAP, OMEGA, U = (UNKNOWNS.part(name).first for name in ('gap', 'omega', 'u'))
WATCHED, FORCE = ROW.part('watched').first, ROW.part('force')
SCENE = parse_scene("""
scene: egg
body: {mass: 0.06, inertia: [3.0e-5, 3.4e-5, 2.0e-5],
       surface: {ellipsoid: {semi_axes: [0.022, 0.021, 0.03]}}}
constraint: table
effects: [gravity: {g: 9.81}]
initial: {angular_velocity: [0, 0, 0]}
""")


@pytest.mark.without_numba
@pytest.mark.parametrize(('gap', 'speed', 'watched'), [
    (0.01, -1.0, 0.01), (0.01, 1.0, 0.01), (0.01, 0.0, 0.01), (-1e-18, -1.0, -1e-18),
    (-1e-18, 1e-6, 0.0), (-1e-18, 0.0, 0.0), (-1e-18, -1e-17, 0.0), (0.0, 1.0, 0.0)])
@pytest.mark.parametrize('turning', [(0.0, 0.0, 0.0), (0.0, 0.0, 3.0), (-3.0, 3.0, 0.0)])
def test_a_gap_ends_a_flight_when_it_shrinks_by_more_than_rounding(gap, speed, watched, turning):
    """A body that has just lifted off is not below the plane by the rounding of its gap."""
    bound = OnPlane(SCENE, None, None, None)
    p, y, row = bound.parameters(0.0), np.zeros(UNKNOWNS.size), np.empty(ROW.size)
    p[MODE], p[SWIFT] = FLIGHT, 1.0
    y[3], y[GAP], y[U + 2], y[OMEGA:U] = 1.0, gap, speed, turning
    bound.rates.rate(p, y, row)
    assert row[WATCHED] == watched
    assert row[GAP] == pytest.approx(speed, abs=1e-15)
    assert row[U + 2] == pytest.approx(-9.81)


def rolling():
    """Return (rates, parameters, unknowns) of the egg as it rolls in any attitude."""
    bound = OnPlane(SCENE, None, None, None)
    p, y = bound.parameters(0.0), np.zeros(UNKNOWNS.size)
    p[MODE], p[SWIFT] = ROLLING, 0.3
    y[:4] = np.array([0.1, -0.5, 0.3, 0.8]) / np.sqrt(0.99)
    y[OMEGA:U] = 3.0, -8.0, 5.0
    return bound.rates, p, y


def test_a_moment_later_the_body_has_turned_and_its_rates_have_grown():
    """By the difference that a creep takes: the attitude turns by omega, r goes with it."""
    rates, p, y = rolling()
    c, row = CONTACT.load(p), np.empty(ROW.size)
    rates.rate(p, y, row)
    omega, short = tuple(y[OMEGA:U].tolist()), SHORT * c.size[0] / c.swift
    at, force, none = posture(c, tuple(y[:4].tolist()), omega), FORCE.load(row), (0.0, 0.0, 0.0)
    unknowns = UNKNOWNS.load(y)
    _, now = rates._ahead(p, c._replace(swift=1e30), unknowns, at, force, none)
    later, pushed = rates._ahead(p, c, unknowns, at, force, none)
    slopes = (np.array(later.axes) - np.array(at.axes)) / short
    assert slopes == pytest.approx(np.array([cross(axis, omega) for axis in at.axes]), abs=1e-4)
    assert later == posture(c, later.q, later.omega)
    assert (np.array(later.omega) - omega) / short == near(row[OMEGA:U], rel=1e-6)
    # the torque without the contact is -omega x I omega, and omega grows by the whole torque
    grown = row[OMEGA:U]
    I = np.array(c.inertia)
    expected = -(np.cross(grown, I @ omega) + np.cross(omega, I @ grown))
    assert (np.array(pushed.torque) - now.torque) / short == near(expected, rel=1e-4)
    assert pushed.force == pytest.approx((0.0, 0.0, -9.81 * c.mass))


def test_what_is_written_holds_each_heat_by_its_cause():
    rates, p, y = rolling()
    LEDGER.store(y, LEDGER.load(y)._replace(
        work=7.0, slid=1.0, rolled=20.0, filmed=300.0, struck=4e3, damped=5e4, spun=6e5))
    out, row = np.empty(STATE_SIZE + ENTRIES_SIZE + len(HEATS)), np.empty(ROW.size)
    rates.rate(p, y, row)
    contact_states.write(p, y, row, 2.5, (0.1, 0.2), out)
    assert out[0] == 2.5
    assert out[STATE_SIZE:STATE_SIZE + 2].tolist() == [7.0, 654321.0]
    assert out[STATE_SIZE + ENTRIES_SIZE:].tolist() == [1.0, 20.0, 300.0, 4e3, 6e5]
    assert out[1:5] == pytest.approx(y[:4], abs=1e-15)
    # without slip the centre of mass moves by r x omega, and lies above the plane by -n . r
    axes = matrix(*y[:4].tolist())
    arm = lever(CONTACT.load(p), axes[2])
    assert out[11:14] == pytest.approx(apply(axes, cross(arm, tuple(y[OMEGA:U]))), abs=1e-15)
    assert out[8:11] == pytest.approx([0.1, 0.2, -np.dot(axes[2], arm)], abs=1e-15)
    short = np.full(len(out), np.nan)
    contact_states.write(p, y, row, 2.5, (0.1, 0.2), short[:STATE_SIZE])
    assert short[:STATE_SIZE].tolist() == out[:STATE_SIZE].tolist()
