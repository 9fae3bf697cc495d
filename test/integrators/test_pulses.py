# SPDX-License-Identifier: Apache-2.0
"""Drives that are nothing for long and short and strong then, and what rounds at a body at rest.

No step may pass over a pulse, and none may follow the rounding of terms that cancel.
"""

import math

import numpy as np
import pytest
from near import near
from soak import IN_SOAK, some_of

from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.simulation.ensemble import ensemble
from rigid_body_sim.simulation.simulation import Simulation

pytestmark = pytest.mark.without_numba

METHODS = 'auto', 'taylor', 'dop8', 'gauss16'


def driven(torque, rate=0.0):
    """Return a body that turns about its third axis, driven by an expression."""
    return parse_scene(f"""
scene: driven
body: {{mass: 1.0, inertia: [1.0, 2.0, 3.0]}}
constraint: free
effects: [torque: {{value: [0, 0, '{torque}']}}]
initial: {{angular_velocity: [0, 0, {rate}]}}
""")


PULSES = [('exp(-(t - 50)^2)', math.sqrt(math.pi)),
          ('tanh((t - 50)/0.01) - tanh((t - 50.1)/0.01)', 0.2),
          ('exp(-((t - 50)/0.02)^2)', 0.02 * math.sqrt(math.pi))]


# by taylor many bodies meet a pulse below
@pytest.mark.parametrize(('method', 'pulse'), [
    *some_of(['dop8', 'gauss16', 'auto'], PULSES),
    *(pytest.param('taylor', pulse, marks=IN_SOAK) for pulse in PULSES)])
def test_a_pulse_turns_a_body_that_rests(method, pulse):
    torque, impulse = pulse
    simulation = Simulation(driven(torque), method, accuracy=1e-6, horizon=60.0)
    states = simulation.states([60.0, 40.0])
    # a method that is named may miss the accuracy, and tells it
    told = simulation.choice.expected_error
    assert told <= (1e-6 if method == 'auto' else 1e-3)
    # the body turns at impulse/3 for 10 s
    assert states.angular_velocity[0, 2] == pytest.approx(
        impulse / 3.0, rel=0.0, abs=0.3 * max(told, 1e-6))
    assert abs(states.angular_velocity[1, 2]) < 1e-10


def test_the_ledger_does_not_follow_the_rounding_of_a_soft_switch():
    """At first 1 + tanh is 2e-9, a few ulps of 1 rough: panels of 1e-10 s would resolve those.

    Its residuals are what those ulps are beside the momentum. Measured: 7.5e-10 at 0.3 s.
    """
    simulation = Simulation(driven('0.5*(1 + tanh((t - 5)/0.5))'), 'gauss16', accuracy=1e-9,
                            horizon=10.0, rate=10.0)
    for ticks, residual in ((3, 1e-8), (17, 1e-10), (80, 1e-14)):
        simulation.advance(ticks)
        ledger = simulation.ledger()
        assert abs(ledger['energy_residual']) < residual
        assert ledger['momentum_residual'] < residual
        assert simulation._spans[-1].solver._quadrature._count < 100    # measured: 14


@pytest.mark.parametrize('rate', [pytest.param(0.0, marks=IN_SOAK), 1.0])
def test_the_ledger_sees_a_pulse(rate):
    """Before it begins, a ten-thousandth of an ulp of what comes is no reason for short panels."""
    simulation = Simulation(driven('exp(-((t - 5)/0.01)^2)', rate), 'dop8', accuracy=1e-9,
                            horizon=10.0, rate=10.0)
    for _ in range(8):
        simulation.advance(10)
        ledger = simulation.ledger()
        assert abs(ledger['energy_residual']) < 1e-9 and ledger['momentum_residual'] < 1e-9
    impulse = 0.01 * math.sqrt(math.pi)
    gained = 1.5 * ((rate + impulse / 3.0)**2 - rate**2)
    assert ledger['work'] == near(gained, rel=1e-8)


@pytest.mark.parametrize(('method', 'soft'), some_of(METHODS, [(0.1, 1e-3), (0.5, 1e-5)]))
def test_a_torque_that_is_switched_on_softly_speeds_up_a_body_from_rest(method, soft):
    """At first 1 + tanh is 0, then a few ulps of 1, and no step is short enough for those."""
    width, accuracy = soft
    simulation = Simulation(driven(f'0.5*(1 + tanh((t - 5)/{width}))'), method,
                            accuracy=accuracy, horizon=10.0)
    rate = simulation.states([10.0]).angular_velocity[0, 2]
    told = simulation.choice.expected_error
    assert told <= (accuracy if method == 'auto' else 1e-3)
    assert rate == pytest.approx(5.0 / 3.0, rel=0.0, abs=3.0 * max(told, accuracy))


@pytest.mark.parametrize(('method', 'target'), some_of(
    ['auto', 'dop8', 'gauss16'], ['1', '1 + tanh(t - 5)']))
def test_a_hinge_that_is_held_at_an_angle_comes_to_rest_there(method, target):
    """At rest a regulator's terms are as large as its stiffness times the angle, and cancel."""
    scene = parse_scene(f"""
scene: regulated
body: {{mass: 1.0, inertia: [1.0, 1.0, 1.0]}}
constraint: {{hinge: {{axis: [0, 0, 1]}}}}
effects: [torque: {{value: [0, 0, '-5*(angle - ({target})) - 3*rate']}}]
initial: {{}}
""")
    simulation = Simulation(scene, method, accuracy=1e-6, horizon=30.0)
    state = simulation.states([30.0])[0]
    final = 1.0 if target == '1' else 2.0
    # exp(-1.5 * 25) of an angle is 5e-17
    assert 2.0 * math.asin(state.orientation[2]) == pytest.approx(final, rel=0.0, abs=1e-6)
    assert np.abs(state.angular_velocity).max() < 1e-6


def test_many_bodies_meet_a_pulse_as_one_does():
    scene = driven('exp(-((t - 5)/0.01)^2)')
    starts = np.tile(scene.initial.vector, (3, 1))
    starts[:, 7] = 0.0, 0.5, 1.0
    found = ensemble(scene, starts, [8.0], integrator='taylor', accuracy=1e-9, horizon=10.0)
    assert found.angular_velocity[:, 0, 2] == pytest.approx(
        starts[:, 7] + 0.01 * math.sqrt(math.pi) / 3.0, rel=0.0, abs=1e-9)
