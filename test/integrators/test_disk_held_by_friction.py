# SPDX-License-Identifier: Apache-2.0
"""A disk or hoop that dry rolling friction holds: its lowest point stays where it is on the rim."""

import math

import numpy as np
import pytest
from scipy.integrate import quad

from rigid_body_sim.integrators.equations.contact_views import ROLLING, ROW, SLIDING, UNKNOWNS
from rigid_body_sim.integrators.marching.contact import MODE, RIM, SWIFT, OnPlane
from rigid_body_sim.mechanics.balance import Dynamics
from rigid_body_sim.mechanics.contact.forces import posture
from rigid_body_sim.mechanics.contact.parameters import CONTACT
from rigid_body_sim.mechanics.contact.touch import tangent
from rigid_body_sim.numerics.rotations import rotate_back
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.simulation.simulation import Simulation

G, M, R = 9.81, 1.0, 0.5
OMEGA, U = UNKNOWNS.part('omega').places, UNKNOWNS.part('u').first


def scene(dry, spin, effects='', mu='.inf'):
    """Return a hoop 1.1 rad from lying flat that turns about the vertical."""
    return parse_scene(
        f'scene: hoop\nbody: {{mass: {M}, shape: {{hoop: {{radius: {R}}}}}}}\nconstraint: table\n'
        f'effects: [gravity: {{g: {G}}}, sliding_friction: {{mu: {mu}}}{effects}, '
        f'rolling_friction: {{dry: {dry}}}]\n'
        f'initial: {{euler_zyz: [0.3, 1.1, 0.2], angular_velocity_world: [0, 0, {spin}], '
        'rolling: true}\n')


def along_rim(orientation, omega):
    """Return the velocity of the lowest point along the rim, over the radius and up to its sign.

    It is b . omega with the tangent e and b = e x gamma.
    """
    gamma = np.array(rotate_back(*orientation, 0.0, 0.0, 1.0))
    return np.cross(tangent(gamma), gamma) @ omega


@pytest.mark.parametrize('dry', [1e-5, 0.002, 0.3])
def test_a_hoop_falls_straight_when_its_quadrature_says(dry):
    """It turns about the tangent at its lowest point: no friction acts, and no energy is lost.

    (A + m R^2) a'^2/2 = m g R (sin 1.1 - sin a). Friction changed its sign in each step, which
    took steps without end.
    """
    sim = Simulation(scene(dry, 0.0), 'dop8', 1e-12)
    share = 1.5 * R / G    # (A + m R^2)/(m g R)

    def slowness(root):    # dt/d root with a = 1.1 - root^2
        fallen = math.sin(1.1) - math.sin(1.1 - root * root)
        return 2.0 * root / math.sqrt(2.0 * fallen / share)

    time, _ = quad(slowness, 0.0, math.sqrt(1.1 - 1e-6), epsabs=1e-13, epsrel=1e-12)
    assert sim.at_event('rest', within=1.0).time == pytest.approx(time, abs=1e-11)
    sim.advance(200)
    ledger = sim.ledger()
    assert ledger['dissipated_rolling'] == pytest.approx(0.0, abs=1e-14)
    assert abs(ledger['energy_residual']) < 1e-11
    N = sim.reactions([0.2]).force[0][2]
    tilt = math.asin(math.hypot(*rotate_back(*sim.states([0.2])[0].orientation, 0, 0, 1)[:2]))
    falls, square = math.cos(tilt) / share, 2.0 * (math.sin(1.1) - math.sin(tilt)) / share
    assert pytest.approx(M * (G - R * (falls * math.cos(tilt) + square * math.sin(tilt)))) == N


def test_friction_lets_go_where_it_could_hold_no_more_and_every_event_is_in_the_ledger():
    sim = Simulation(scene(0.05, 2.0), 'dop8', 1e-13)
    held, rolls = sim.states([0.04, 0.2])
    assert along_rim(held.orientation, held.angular_velocity) == pytest.approx(0.0, abs=1e-13)
    assert abs(along_rim(rolls.orientation, rolls.angular_velocity)) > 0.1
    sim.advance(20)
    assert sim.ledger()['dissipated_rolling'] == pytest.approx(0.0, abs=1e-14)
    sim.advance(400)
    ledger = sim.ledger()
    assert ledger['dissipated_rolling'] > 1e-3
    assert abs(ledger['energy_residual']) < 2e-13
    assert ledger['momentum_residual'] < 2e-13


@pytest.mark.parametrize('time', [0.02, 0.2])
@pytest.mark.parametrize('mu', ['.inf', '0.05'])
def test_reactions_are_those_under_which_it_moves(time, mu):
    """Held and rolling, with slip and without: omega' is the slope of omega."""
    sim = Simulation(scene(0.05, 2.0, mu=mu), 'dop8', 1e-13)
    before, now, after = sim.states([time - 1e-4, time, time + 1e-4])
    slope = (after.angular_velocity - before.angular_velocity) / 2e-4
    balance = Dynamics(sim.scene).balance(now.vector)
    assert balance.angular_acceleration == pytest.approx(slope, abs=1e-6)


@pytest.mark.without_numba
@pytest.mark.parametrize('effects', ['', ', spinning_friction: {radius: 0.01}'])
@pytest.mark.parametrize('mode', [ROLLING, SLIDING])
def test_what_holds_the_lowest_point_takes_no_power_and_leaves_it_where_it_is(mode, effects):
    bound = OnPlane(scene(0.1, 0.0, effects, '0.4'), None, None, None)
    p, y = bound.parameters(0.0), np.zeros(UNKNOWNS.size)
    p[MODE], p[SWIFT], p[RIM] = mode, 1.0, 0.0
    y[:4] = np.array([0.1, -0.5, 0.3, 0.8]) / np.sqrt(0.99)
    y[U:U + 2] = (0.3, -0.2) if mode == SLIDING else (0.0, 0.0)
    c = CONTACT.load(p.tolist())
    gamma = posture(c, tuple(y[:4].tolist()), (0.0, 0.0, 0.0)).axes[2]
    along = np.array(tangent(gamma))
    y[OMEGA] = 1.7 * along - 2.3 * np.array(gamma)
    row = np.empty(ROW.size)
    bound.rates.rate(p, y, row)
    h = 1e-5 / row[ROW.part('pace').first]
    moved = []
    for step in (-h, h):
        later = y + step * row[:UNKNOWNS.size]
        at = posture(c, tuple(later[:4].tolist()), tuple(later[OMEGA].tolist()))
        moved.append(np.dot(tangent(at.axes[2]), at.moved))
    assert abs(moved[1] - moved[0]) / (2.0 * h * row[ROW.part('pace').first]) < 1e-8
    assert max(map(abs, moved)) < 1e-9
    heat = row[UNKNOWNS.part('ledger').part('rolled').first]
    assert heat == pytest.approx(0.0, abs=1e-15)
