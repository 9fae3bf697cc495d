# SPDX-License-Identifier: Apache-2.0
"""taylor on effects whose laws are formulas, and where what a root is taken of passes zero."""

import math
import types

import numpy as np
import pytest
from soak import IN_SOAK

from rigid_body_sim.choice import measured
from rigid_body_sim.errors import BadInput
from rigid_body_sim.integrators import runnable
from rigid_body_sim.integrators.equations.expanded import Expanded
from rigid_body_sim.integrators.equations.plan import Plan
from rigid_body_sim.integrators.solver import Stepped
from rigid_body_sim.scene.scene import parse_scene

pytestmark = pytest.mark.without_numba
SKEW = ('{mass: 1, inertia: [[0.2, 0.03, 0.01], [0.03, 0.3, -0.02], [0.01, -0.02, 0.4]], '
        'center_of_mass: [0.1, -0.2, 0.3]}')
PLAIN = '{mass: 1, inertia: [0.2, 0.3, 0.4], center_of_mass: [0, 0, -1]}'
MATRIX = '[[0.3, 0.1, 0], [0.1, 0.2, 0], [0, 0, 0.1]]'
WOBBLE = '{angular_velocity: [1, 2, 3]}'
PATH = "motion: [0.1, 'd*sin(3*t)', '0.1*cos(7*t)']"
SCENES = {
    'gravity gradient': ('free', 'gravity_gradient: {mu: 3e14, position: [7e4, 1e4, 2e4]}',
                         WOBBLE),
    'gravity gradient on an orbit': (
        'free', 'gravity_gradient: {orbit: {rate: 0.7, normal: [0, 0, 1], toward: [1, 0, 0]}}',
        WOBBLE),
    'motor': ('free', 'rotor: {axis: [1, 2, 3], inertia: 0.1, rate: 3, torque: 0.2}', WOBBLE),
    'drag of numbers': ('free', 'gravity: {g: 9.81}, drag: {quadratic: 0.3, angular: 0.1, '
                        'angular_quadratic: 0.1}', '{velocity: [1, 2, 3], ' + WOBBLE[1:]),
    'drag of matrices': ('free', f'drag: {{linear: {MATRIX}, quadratic: {MATRIX}, '
                         f'angular_quadratic: {MATRIX}}}', '{velocity: [1, 2, 3], ' + WOBBLE[1:]),
    'drag at a pivot': ('pivot', f'gravity: {{g: 9.81}}, drag: {{linear: {MATRIX}, '
                        f'quadratic: {MATRIX}}}', WOBBLE),
    'drag on a hinge': ('{hinge: {axis: [1, 2, 2]}}', 'gravity: {g: 9.81}, drag: {quadratic: 0.1}',
                        '{angle: 1, rate: 2}'),
    'door with springs': (
        '{hinge: {axis: [0.1, 0, 1]}}', 'gravity: {g: 9.81}, spring: {stiffness: 12, angle: 0.4, '
        'damping: 0.02}, spring: {at: [0.3, 0.1, 0], anchor: [1, 0, 0], stiffness: 3, '
        'length: 0.2}', '{angle: -1.2, rate: 3}'),
    'more than two turns on a hinge': (
        '{hinge: {axis: [1, 2, 2]}}', "potential: {energy: '-0.3*cos(angle - 1)'}, force: {value: "
        "['0.1*qx', 0, '0.2*x'], at: [0.1, 0, 0]}, torque: {value: ['0.1*wx^2', 0, 'd*rate']}",
        '{angle: 5, rate: 9}'),
    'moving pivot': (f'{{pivot: {{{PATH}}}}}', 'gravity: {g: 9.81}, drag: {linear: 0.2}', WOBBLE),
    'moving pivot off the origin': (
        f'{{pivot: {{at: [0.1, 0.2, 0], {PATH}}}}}',
        "drag: {quadratic: 0.2}, spring: {at: [0.1, 0, 0], anchor: [0, 0, 1], stiffness: 2, "
        "damping: 0.1}, torque: {value: ['0.1*x', '0.1*vx', '0.1*qz']}", WOBBLE)}
AT_ZERO = {
    'fall from rest': (PLAIN, 'free', 'gravity: {g: 9.81}, drag: {quadratic: 0.3}', '{}'),
    'thrown upward': (PLAIN, 'free', 'gravity: {g: 9.81}, drag: {quadratic: 0.3}',
                      '{velocity: [0, 0, 5]}'),
    'thrown nearly upward': (PLAIN, 'free', 'gravity: {g: 9.81}, drag: {quadratic: 0.3}',
                             '{velocity: [1.0e-7, 0, 5]}'),
    'swing': (SKEW, '{hinge: {axis: [1, 2, 2]}}', 'gravity: {g: 9.81}, drag: {quadratic: 0.3}',
              '{angle: 1, rate: 2}'),
    'in an expression': (PLAIN, 'free', "force: {value: ['-0.3*(vx^2)^1.5 - x', 0, "
                         "'-9.81 - 0.3*vz*sqrt(vz^2)'], frame: world}", '{velocity: [1, 0, 5]}'),
    'nothing moves': (PLAIN, 'free', 'drag: {quadratic: 0.3, angular: 0.1}', WOBBLE),
    'root that begins at zero': (PLAIN, 'free', "force: {value: ['-0.3*sqrt(x)', 0, 0], "
                                 "frame: world}", '{velocity: [1, 0, 0], position: [0, 0, 1]}')}


def scene_of(body, constraint, effects, initial):
    return parse_scene(f'scene: a\nparameters: {{d: 0.05}}\nbody: {body}\n'
                       f'constraint: {constraint}\neffects: [{effects}]\ninitial: {initial}\n')


def state(scene, time, method='taylor', **control):
    out = np.empty(14)
    Stepped(scene, method, horizon=time, **control).start(scene.initial.vector).state(time, out)
    return out


@pytest.mark.parametrize('name', SCENES)
def test_taylor_and_dop8_agree(name):
    scene = scene_of(SKEW, *SCENES[name])
    # at 1e-13 the two may differ by 2e-13; at 3e-14 what is left is mostly rounding
    found, other = (state(scene, 1.0, method, accuracy=3e-14) for method in ('taylor', 'dop8'))
    assert np.abs(found - other).max() < 2e-14    # measured: 7e-15


def test_one_effect_without_a_series_is_enough_to_be_refused():
    """Also where the others have one; an effect that does not act needs none."""
    with_one, without, idle = (types.SimpleNamespace(acting=acting, series=series)
                               for acting, series in ((1, 1), (1, None), (None, None)))
    for effects in [without], [with_one, without], [without, with_one, idle]:
        with pytest.raises(BadInput, match='taylor cannot run the scene made up'):
            Expanded(types.SimpleNamespace(name='made up', effects=effects))


def test_weight_on_a_hinge_takes_no_product_of_series():
    """What the attitude turns is linear in sin and cos of the angle, which take two."""
    scene = scene_of(SKEW, '{hinge: {axis: [1, 2, 2]}}',
                     'gravity: {g: 9.81}, spring: {stiffness: 12, damping: 0.1}',
                     '{angle: 1, rate: 2}')
    assert Plan(Expanded(scene).rates).products == 2


@pytest.mark.parametrize('name', [
    pytest.param(name, marks=[IN_SOAK] * (name == 'in an expression')) for name in AT_ZERO])
def test_a_root_passes_zero(name):
    """Where |v| is 0 the series of |v| goes on as that of -|v|: errors of 1e-5 and more."""
    scene = scene_of(*AT_ZERO[name])
    found, other = (state(scene, 2.0, method, accuracy=1e-13) for method in ('taylor', 'gauss16'))
    assert np.abs(found - other).max() < 3e-14    # measured: 6e-15


def test_a_state_between_the_steps_over_a_zero_is_that_of_a_run_that_ends_there():
    """After the turning point the speed is w tanh(g t/w), w^2 = M g/D."""
    scene = scene_of(*AT_ZERO['thrown upward'])
    final = math.sqrt(9.81 / 0.3)
    turn = final / 9.81 * math.atan(5.0 / final)
    out = np.empty(14)
    motion = Stepped(scene, 'taylor', accuracy=1e-13, horizon=2.0).start(scene.initial.vector)
    for after in (0.0, 1e-10, 1e-9, 1e-8, 1e-6, 1e-3, 0.5):
        motion.state(turn + after, out)
        assert out[13] == pytest.approx(-final * math.tanh(9.81 / final * after), abs=1e-14)


def test_a_body_near_a_symmetric_one_is_not_spun_by_terms_that_cancel():
    """The torque of gravity gradient about the axis of a slim body is that of its moments."""
    scene = scene_of('{mass: 1, inertia: [1, 1.0000001, 1.0e-7]}', 'free',
                     'gravity_gradient: {mu: 3e14, position: [7e4, 1e4, 2e4]}',
                     '{tilt: 0.4, angular_velocity: [1, 2, 0]}')
    found, other = (state(scene, 1.0, method, accuracy=1e-12) for method in ('taylor', 'dop8'))
    assert np.abs(found - other).max() < 1e-11


def test_it_is_for_those_who_name_it():
    """Nothing was measured for `auto` where what acts is a formula."""
    scene = scene_of(SKEW, *SCENES['gravity gradient'])
    assert 'taylor' in runnable(scene)
    assert not measured.on_such(scene, 'taylor')
