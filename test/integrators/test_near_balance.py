# SPDX-License-Identifier: Apache-2.0
"""A body let go from rest close to its balance: large terms cancel but for their rounding.

No step errs by less than that rounding, however short it is: a march that asks for less hangs.
"""

import math

import numpy as np
import pytest

from rigid_body_sim.numerics.rotations import angle_between, from_rotation_vector, multiply
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.simulation.simulation import Simulation

SKEW = """{mass: 2.0, center_of_mass: [0.02, -0.01, 0.1],
  inertia: [[0.05, 0.004, -0.002], [0.004, 0.06, 0.003], [-0.002, 0.003, 0.03]]}"""


def hanging():
    """Return the quaternion that turns the centre of mass right below the pivot."""
    x, y, z = np.array([0.02, -0.01, 0.1]) / math.hypot(0.02, -0.01, 0.1)
    angle = math.acos(-z)
    return from_rotation_vector(*(np.array([-y, x, 0.0]) / math.hypot(x, y) * angle))


def let_go(effects, orientation, body=SKEW, constraint='pivot'):
    return parse_scene(f'scene: let_go\nbody: {body}\nconstraint: {constraint}\n'
                       f'effects: [{{{effects}}}]\n'
                       f'initial: {{orientation: {list(map(float, orientation))}}}')


@pytest.mark.without_numba
@pytest.mark.parametrize('away', [1e-3, 1e-6, 1e-9])
def test_methods_agree_on_a_hanging_body_let_go_beside_its_balance(away):
    start = multiply(*from_rotation_vector(away, 0.0, 0.0), *hanging())
    scene = let_go('gravity: {g: 9.81}', start)
    ends = []
    for method, accuracy in (('taylor', 1e-13), ('dop8', 1e-13), ('gauss16', 1e-12)):
        simulation = Simulation(scene, method, accuracy=accuracy, rate=2.0)
        simulation.advance()
        ends.append(simulation.state.orientation)
    # half the period of a swing is about 0.3 s: it has moved
    assert angle_between(*ends[0], *start) > 0.1 * away
    for end in ends[1:]:
        assert angle_between(*ends[0], *end) < 2e-15    # measured 5e-16


@pytest.mark.without_numba
def test_a_satellite_let_go_beside_its_balance_swings_as_the_formula_says():
    scene = let_go('gravity_gradient: {mu: 90, position: [0, 3, 0]}',
                   from_rotation_vector(0.0, 0.0, math.pi / 2 + 1e-4),
                   '{mass: 1, inertia: [0.2, 0.3, 0.4]}', 'free')
    simulation = Simulation(scene, 'dop8', accuracy=1e-13, rate=1.0)
    simulation.advance(2)
    angle = 2.0 * math.atan2(*simulation.state.orientation[2:]) - math.pi / 2
    rate = math.sqrt(3 * 90 / 27 * 0.1 / 0.4)    # sqrt(3 mu/r^3 (I2 - I1)/I3)
    assert angle == pytest.approx(1e-4 * math.cos(2.0 * rate), abs=1e-12)


def test_steps_that_know_terms_that_cancel_do_not_err_by_their_rounding_one_way():
    """A slow top tumbles far from its balance: what each step leaves out adds up over 1500 steps.

    An ulp of the start moves it by 2e-13 rad.
    """
    scene = parse_scene("""
scene: slow_top
body: {mass: 1.0, inertia: [0.03, 0.03, 0.01], inertia_about: origin, center_of_mass: [0, 0, 0.1]}
constraint: pivot
effects: [gravity: {g: 10.0}]
initial: {euler_zyz: [0.1, 0.7, 0.2], angular_velocity: [0.3, -0.2, 20.0]}
""")
    times = np.linspace(70.0, 100.0, 13)
    expected = Simulation(scene).states(times).orientation
    found = Simulation(scene, 'gauss16', accuracy=1e-15).states(times).orientation
    # measured: 1.2e-12; with steps that may err by 2^-51 of what the weight can do 3.6e-11
    assert max(angle_between(*one, *other) for one, other in zip(
        found, expected, strict=True)) < 5e-12
