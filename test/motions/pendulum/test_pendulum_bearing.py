# SPDX-License-Identifier: Apache-2.0
"""The reaction of the bearing of a hinge, and the hinged scenes that ship."""

import math

import numpy as np
import pytest
from motions.hinged import HANGING, anchored, at, bearing, random_scene, scene_of, start_of
from near import near
from scipy.spatial.transform import Rotation

from rigid_body_sim.scene.bodies import make_body
from rigid_body_sim.scene.scene import load_scene, parse_scene
from rigid_body_sim.simulation.simulation import Simulation
from rigid_body_sim.theory import kater_pendulum

EPSILON = np.finfo(float).eps


def test_reaction_by_hand():
    """Rod about its end: M g at rest, M g/4 released level, 4 M g at the bottom from upright."""
    M, g, length = 2.0, 9.81, 1.2
    rod = make_body(
        M, (M * length ** 2 / 12.0, 0.0, M * length ** 2 / 12.0), (0.0, 0.0, -0.5 * length))
    scene = scene_of(rod, (1.0, 0.0, 0.0), g=g)
    assert bearing(scene, start_of()) == pytest.approx(
        [0.0, 0.0, M * g, 0.0, 0.0, 0.0], rel=1e-15, abs=1e-15)
    level = start_of((math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5)))
    assert bearing(scene, level) == pytest.approx(
        [0.0, 0.0, 0.25 * M * g, 0.0, 0.0, 0.0], rel=1e-14, abs=1e-14)
    fastest = math.sqrt(2.0 * M * g * length / (M * length ** 2 / 3.0))
    assert bearing(scene, start_of(HANGING, (fastest, 0.0, 0.0)))[2] == near(4.0 * M * g, 1e-14)


def test_unbalanced_wheel_shakes_its_bearing():
    """A canted disk on its middle: the couple w^2 (I3 - I1) sin cos turns with the disk."""
    I1, I3, w, cant = 0.3, 0.6, 7.0, 0.2
    axis = (math.sin(cant), 0.0, math.cos(cant))
    scene = scene_of(make_body(1.0, (I1, I1, I3)), axis, g=0.0)
    out = bearing(scene, start_of(HANGING, w * np.array(axis)))
    assert out[:3].tolist() == [0.0, 0.0, 0.0]
    assert out[3:] == pytest.approx(
        [0.0, -w * w * (I3 - I1) * math.sin(cant) * math.cos(cant), 0.0], rel=1e-14, abs=1e-14)


def test_reaction_is_what_momentum_asks_for():
    """Newton and Euler by differences: M v' = F - M g z, L' = r x (-M g z) + couple."""
    rng = np.random.default_rng(6)
    for _ in range(40):
        scene, start = random_scene(rng)
        anchor = anchored(scene, start)
        body, g = scene.body, scene.effect('gravity').g
        arm = np.subtract(body.center_of_mass, scene.constraint.through)

        def momenta(time, anchor=anchor, body=body, arm=arm):
            state = at(anchor, time)
            turn = Rotation.from_quat(state[1:5])
            velocity = state[11:14] + turn.apply(np.cross(state[5:8], body.center_of_mass))
            return np.concatenate([body.mass * velocity,
                                   turn.apply(body.about_center.matrix @ state[5:8])
                                   + body.mass * np.cross(turn.apply(arm), velocity)])

        time, h = rng.uniform(-3.0, 3.0), 2e-3
        slope = sum(weight * (momenta(time + k * h) - momenta(time - k * h)) for k, weight in
                    ((1, 4.0 / 5.0), (2, -1.0 / 5.0), (3, 4.0 / 105.0), (4, -1.0 / 280.0))) / h
        state = at(anchor, time)
        lever = Rotation.from_quat(state[1:5]).apply(arm)
        weight = np.array([0.0, 0.0, -body.mass * g])
        out = bearing(scene, state)
        size = np.abs(out).max() + body.mass * g
        # rounding of the momenta over h, and the ninth derivative
        assert slope[:3] == pytest.approx(out[:3] + weight, abs=1e-10 * size)
        assert slope[3:] == pytest.approx(
            out[3:] + np.cross(lever, weight), abs=1e-10 * size * (1.0 + np.linalg.norm(arm)))
        axis = Rotation.from_quat(state[1:5]).apply(scene.constraint.axis)
        assert abs(axis @ out[3:]) <= 1e-14 * np.abs(out[3:]).max()


@pytest.mark.parametrize('name', ['kater_pendulum', 'kater_pendulum_from_p'])
def test_kater(name):
    """The same period from both edges, with the finite swing; g = l' Omega^2 errs by -phi0^2/8."""
    scene = load_scene(name)
    simulation = Simulation(scene)
    assert simulation.choice.method == 'exact'
    simulation.advance(20_000)
    assert abs(simulation.ledger()['energy_residual']) <= 4.0 * EPSILON
    times = [event.time for event in simulation.events]
    Omega = kater_pendulum.frequency_from_q(9.81, 0.4, math.sqrt(0.24))
    assert 2.0 * np.diff(times) == near(kater_pendulum.period(Omega, 0.1), 1e-13)
    measured = kater_pendulum.gravity_recovered(1.0, math.pi / (times[1] - times[0]))
    assert measured == near(9.81 * kater_pendulum.gravity_bias(0.1), 1e-13)
    assert measured == near(9.81 * (1.0 - 0.1 ** 2 / 8.0), 1e-5)


def test_baseball_bat():
    """Struck at rest by J at d, then no torque: omega = J d/I for ever, the hand stays."""
    simulation = Simulation('baseball_bat')
    assert simulation.choice.method == 'exact'
    simulation.advance(100_000)
    rate = 2.0 * 0.6227272727272727 / (0.036 + 0.9 * 0.55 ** 2)
    assert simulation.state.angular_velocity == near([0.0, 0.0, rate], 4.0 * EPSILON)
    assert abs(simulation.state.orientation[2]) == near(abs(math.sin(0.5 * rate * 100.0)), 1e-12)
    assert not simulation.state.position.any() and not simulation.state.velocity.any()
    assert simulation.events == []


def test_scene_of_a_tilted_hinge():
    """A door whose hinge leans by 0.3 rad swings like a pendulum under g sin(0.3)."""
    text = """
scene: door
body: {mass: 20.0, shape: {box: {size: [0.8, 0.04, 2.0]}}, center_of_mass: [0.4, 0, 1.0]}
constraint: {hinge: {axis: [0, 0, 1]}}
effects: [gravity: {g: 9.81}]
initial: {euler_zyz: [0, 0.3, 0], angle: 0.01}
"""
    simulation = Simulation(parse_scene(text))
    assert simulation.choice.method == 'exact'
    simulation.advance(30_000)
    moment = 20.0 * (0.8 ** 2 + 0.04 ** 2) / 12.0 + 20.0 * 0.4 ** 2
    Omega = math.sqrt(20.0 * 9.81 * math.sin(0.3) * 0.4 / moment)
    gaps = np.diff([event.time for event in simulation.events])
    assert 2.0 * gaps == near(kater_pendulum.period(Omega, 0.01), 1e-13)
