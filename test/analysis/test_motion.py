# SPDX-License-Identifier: Apache-2.0
"""Quantities derived from attitude and omega, against the simulation's numbers and theory."""

import types

import numpy as np
import pytest
from near import near

from rigid_body_sim.analysis.history import History, Segment
from rigid_body_sim.analysis.motion import Motion, conserved
from rigid_body_sim.numerics import rotations
from rigid_body_sim.scene.scene import load_scene
from rigid_body_sim.simulation.simulation import Simulation
from rigid_body_sim.theory import billiard

pytestmark = pytest.mark.without_numba


def taken(scene, ticks, rate=1000.0, block=230):
    """Return (Motion, States) of a scene over some ticks, taken in blocks."""
    source = types.SimpleNamespace(
        scene=scene, ticks=ticks, start=0, history=History((), (Segment(0, scene, rate, 0.0),)))
    states = Simulation(scene, rate=rate).states(np.arange(ticks) / rate)
    motion, stamps = Motion(source), np.rint(states.time * 1e9).astype(np.int64)
    for begin in range(0, ticks, block):
        part = slice(begin, begin + block)
        motion.add(stamps[part], states.time[part], states.orientation[part],
                   states.angular_velocity[part], states.position[part])
    return motion, states


def test_omega_in_the_world_and_euler_angles_are_those_of_the_kernels():
    motion, states = taken(load_scene('heavy_top'), 500)
    for k in (0, 137, 499):
        q, omega = states.orientation[k].tolist(), states.angular_velocity[k].tolist()
        world = [motion.angular_velocity_world.curve(c)[1][k] for c in range(3)]
        assert world == pytest.approx(rotations.rotate(*q, *omega), rel=1e-14, abs=1e-12)
        euler = [motion.euler.curve(c)[1][k] for c in range(3)]
        assert euler == pytest.approx(rotations.to_euler_zyz(*q), abs=1e-12)


@pytest.mark.parametrize(('name', 'overrides', 'of'), [
    ('tennis_racket', [], 'L'), ('heavy_top', [], 'L_z'), ('heavy_top', ['effects=[]'], 'L')])
def test_the_momentum_that_the_scene_conserves_is_constant_to_round_off(name, overrides, of):
    motion, _ = taken(load_scene(name, overrides), 2000)
    assert motion.conserved.name == of
    summary = motion.momentum.summary()
    assert summary['judged_ticks'] == 2000 and summary['largest_residual'] < 1e-14     # 1.3e-15


def test_a_wrong_attitude_shows_in_the_momentum_though_energy_and_l2_do_not_know_it():
    scene = load_scene('tennis_racket')
    source = types.SimpleNamespace(
        scene=scene, ticks=100, start=0, history=History((), (Segment(0, scene, 1000.0, 0.0),)))
    states = Simulation(scene).states(np.arange(100) / 1000.0)
    q = states.orientation.copy()
    q[50:] = [rotations.multiply(0.0, 0.0, np.sin(5e-10), np.cos(5e-10), *one)
              for one in q[50:].tolist()]
    motion = Motion(source)
    motion.add(np.arange(100) * 10**6, states.time, q, states.angular_velocity, states.position)
    # turned by 1e-9 rad about z, L along y
    assert motion.momentum.largest == near(1e-9, rel=1e-3)


def test_no_momentum_is_claimed_where_none_is_conserved():
    for name in ('billiard_low', 'kater_pendulum'):
        assert conserved(load_scene(name)) is None
    assert conserved(None) is None


def test_slip_falls_as_the_notes_say_and_ends_when_rolling_begins():
    scene = load_scene('billiard_low')
    a, mu, g = scene.body.radius, 0.2, 9.81
    motion, _ = taken(scene, 1000)
    times, slip = motion.slip.curve()
    v0, h = 0.255 / 0.17, -0.01
    onset = billiard.onset_of_rolling(v0, h, a, mu, g)
    sliding = times < onset - 2e-3
    expected = (billiard.sliding_speed(times, v0, h, a, mu, g)
                - a * billiard.sliding_spin(times, v0, h, a, mu, g))
    # 2e-13: differences of positions
    assert slip[sliding] == pytest.approx(np.abs(expected[sliding]), abs=1e-11)
    assert slip[times > onset + 2e-3].max() < 1e-11
    assert 300 < np.count_nonzero(sliding) < 500
    [(first, begin), (second, rolls)] = motion.phases
    assert (first, begin, second, motion.until) == ('slip', 0.0, 'roll', 0.999)
    # to a tick, and the differences reach one further
    assert rolls == pytest.approx(onset, abs=2.1e-3)
