# SPDX-License-Identifier: Apache-2.0
"""The jump of a body under an impulse, beside the same formula in rational numbers."""

import random
from fractions import Fraction

import numpy as np
import pytest
from near import near

from rigid_body_sim.mechanics import impulse, parameters
from rigid_body_sim.numerics.vectors import cross, dot
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.scene.state import ANGULAR_VELOCITY, ORIENTATION

BODY = """
scene: body
body: {{mass: {mass}, inertia: {inertia}, center_of_mass: {center}}}
constraint: {constraint}
effects: []
initial: {{orientation: {orientation}}}
"""


def turned_back(q, vector):
    """Return the body components of a world vector, Fractions, for a quaternion of any norm."""
    u, w = [-Fraction(x) for x in q[:3]], Fraction(q[3])
    square, along, side = dot(u, u), dot(u, vector), cross(u, vector)
    return [((w * w - square) * vector[k] + 2 * along * u[k] + 2 * w * side[k])
            / (w * w + square) for k in range(3)]


@pytest.mark.parametrize('constraint', ['free', 'pivot'])
@pytest.mark.parametrize('thin', [1.0, 0.1, 0.007, 1.1e-3, 1e-6])
def test_each_part_of_the_jump_is_right_to_rounding_however_thin_the_body_is(constraint, thin):
    """Rounding of G across the body would be the larger part of the spin about its axis."""
    draw = random.Random(f'{constraint} {thin}')
    for _ in range(20):
        inertia = [1.0, 1.0 + thin * draw.uniform(0.0, 0.9), thin]
        q = [draw.gauss(0.0, 1.0) for _ in range(4)]
        center = [0.0, 0.0, draw.uniform(-1.0, 1.0)]
        scene = parse_scene(BODY.format(
            mass=draw.uniform(0.5, 2.0), inertia=inertia, center=center, orientation=q,
            constraint=constraint))
        force, couple = np.array([[draw.gauss(0.0, 1.0) for _ in range(3)] for _ in range(2)])
        state, p = scene.initial.vector.copy(), parameters.parameters(scene)
        known = parameters.scene_parameters(scene)
        q = state[ORIENTATION].tolist()
        J, K = ([Fraction(x) for x in given.tolist()] for given in (force, couple))
        arm = [Fraction(x) if constraint == 'pivot' else 0 for x in center]
        G = [a + b for a, b in zip(turned_back(q, K), cross(arm, turned_back(q, J)), strict=True)]
        before = state[ANGULAR_VELOCITY].copy()
        assert impulse.apply_impulse(p, state, force, couple, np.empty(impulse.RESPONSE_SIZE))
        for k in range(3):
            d = float(G[k] / Fraction(known.moments[k]))
            # measured: 2.3e-16; 7e-14 where G is made in doubles
            assert (state[ANGULAR_VELOCITY] - before)[k] == near(d, rel=4.5e-16)
