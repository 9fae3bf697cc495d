# SPDX-License-Identifier: Apache-2.0
"""A simulation continues another at a tick, with a new method, accuracy, rate or scene."""

import numpy as np
from near import near

from rigid_body_sim.simulation.simulation import Simulation

TORQUE = (0.02, -0.03, 0.01)


def half_way():
    simulation = Simulation('tennis_racket')
    simulation.impulse(torque=TORQUE)
    simulation.advance(700)
    simulation.hold(torque=TORQUE, frame='body')
    simulation.advance(300)
    return simulation


def test_another_method_goes_on_from_the_present_state():
    first, undisturbed = half_way(), half_way()
    second = Simulation('tennis_racket', integrator='dop8')
    second.follow(first, keep_state=True)
    assert (second.tick, second.time) == (1000, 1.0)
    assert second.wrench == first.wrench
    second.advance(500)
    undisturbed.advance(500)
    assert second.time == undisturbed.time
    # measured 3e-13: the accuracy asked of dop8 is 1e-12
    np.testing.assert_allclose(second.vector, undisturbed.vector, rtol=0.0, atol=1e-11)
    assert abs(second.ledger()['energy_residual']) < 1e-11
    assert second.ledger()['work'] == near(undisturbed.ledger()['work'], rel=1e-10)


def test_another_rate_keeps_the_time():
    first, undisturbed = half_way(), half_way()
    second = Simulation('tennis_racket', rate=250.0)
    second.follow(first, keep_state=True)
    second.advance(125)
    undisturbed.advance(500)
    assert (second.tick, second.time, undisturbed.time) == (1125, 1.5, 1.5)
    np.testing.assert_allclose(second.vector, undisturbed.vector, rtol=0.0, atol=1e-11)


def test_another_scene_begins_at_its_own_start():
    first = half_way()
    second = Simulation('free_body')
    second.follow(first, keep_state=False)
    assert (second.tick, second.time) == (1000, 0.0)
    assert second.vector.tolist() == second.scene.initial.vector.tolist()
    assert not second.wrench


def test_commands_in_body_axes_turn_with_the_attitude_that_was_taken_over():
    first, undisturbed = half_way(), half_way()
    second = Simulation('tennis_racket')
    second.follow(first, keep_state=True)
    for simulation in (second, undisturbed):
        simulation.release()
        simulation.impulse(torque=TORQUE, frame='body')
    assert second.vector.tolist() == undisturbed.vector.tolist()
