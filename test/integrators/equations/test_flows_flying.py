# SPDX-License-Identifier: Apache-2.0
"""The compositions on a free body under a force: its centre of mass, by hand in each axis."""

import numpy as np
import pytest
from near import near

from rigid_body_sim.integrators.solver import Stepped
from rigid_body_sim.scene.effects.wrench import Wrench
from rigid_body_sim.scene.scene import parse_scene

SCENE = parse_scene("""
scene: flying
body: {mass: 2.0, inertia: [1.0, 1.5, 2.0]}
constraint: free
effects: [gravity: {g: 9.0}]
initial: {angular_velocity: [0.3, 0.2, 0.1], position: [1, 2, 3], velocity: [4, -5, 6]}
""")
FORCE, COUPLE = np.array([1.0, -2.0, 3.0]), (0.2, 0.1, -0.3)


@pytest.mark.without_numba
def test_under_a_constant_force_the_centre_moves_on_a_parabola_in_each_axis():
    """Every method of order 2 is exact there; the first order one errs by a t h/2."""
    wrench, out, t, h = Wrench(FORCE.tolist(), COUPLE), np.empty(14), 0.4, 0.05
    a = FORCE / 2.0 + [0.0, 0.0, -9.0]
    place = np.array([1.0, 2.0, 3.0]) + np.array([4.0, -5.0, 6.0]) * t + 0.5 * a * t * t
    for method in 'split2', 'split4', 'split6', 'split8', 'semi_implicit_euler':
        Stepped(SCENE, method, step=h, wrench=wrench).start(SCENE.initial.vector).state(t, out)
        assert out[11:] == near([4.0, -5.0, 6.0] + a * t, rel=1e-14)
        late = 0.5 * a * t * h if method == 'semi_implicit_euler' else 0.0
        assert out[8:11] == near(place + late, rel=1e-14)


@pytest.mark.without_numba
def test_drag_slows_each_axis_for_itself():
    """M v' = -c v with c dt small: v e^(-c t/m) in each axis, to the order of the method."""
    scene = parse_scene("""
scene: dragged
body: {mass: 2.0, inertia: [1.0, 1.5, 2.0]}
constraint: free
effects: [drag: {linear: 0.5, angular: 0.3}, torque: {value: [0.1, 0.2, 0.3]}]
initial: {angular_velocity: [0.3, 0.2, 0.1], position: [1, 2, 3], velocity: [4, -5, 6]}
""")
    out, left, start = np.empty(14), np.exp(-0.1), np.array([4.0, -5.0, 6.0])
    for method in 'split2', 'split4':
        Stepped(scene, method, step=0.02).start(scene.initial.vector).state(0.4, out)
        assert out[11:] == near(start * left, rel=1e-5)
        assert out[8:11] == pytest.approx([1.0, 2.0, 3.0] + start * (1.0 - left) * 4.0, abs=1e-5)


@pytest.mark.without_numba
def test_a_force_along_body_axes_turns_with_the_body():
    scene = parse_scene("""
scene: rocket
body: {mass: 2.0, inertia: [1.0, 1.5, 2.0]}
constraint: free
effects: [force: {value: [1.0, -2.0, 3.0], frame: body}]
initial: {euler: [0.3, 1.1, -0.7], angular_velocity: [0.3, 0.2, 1.1]}
""")
    out, best = np.empty(14), np.empty(14)
    Stepped(scene, 'dop8', 1e-12).start(scene.initial.vector).state(0.4, best)
    for method in 'split2', 'split4':
        Stepped(scene, method, step=0.01).start(scene.initial.vector).state(0.4, out)
        # measured: 1e-6 (split2)
        assert np.abs(out[8:] - best[8:]).max() < 1e-5
