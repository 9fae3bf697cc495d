# SPDX-License-Identifier: Apache-2.0
"""Bodies that start at rest where forces balance, and forces that are switched on softly.

What is left of large terms that cancel is rounding: no step may follow it, and what moves besides
loses nothing by that.
"""

import math

import numpy as np
import pytest
from soak import some_of

from rigid_body_sim.integrators.solver import Stepped
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.simulation.simulation import Simulation

pytestmark = pytest.mark.without_numba

HORIZON = 20.0
WEIGHT = 1.3 * 9.81
GRAVITY = 'gravity: {g: 9.81}'


def scene(effects, initial='', constraint='free'):
    return parse_scene(f"""
scene: at_rest
body: {{mass: 1.3, inertia: [1.0, 2.0, 2.7], center_of_mass: [0, 0, -0.15]}}
constraint: {constraint}
effects: [{effects}]
initial: {{{initial}}}
""")


LOW = f'position: [0.1, 0.2, {0.45 - WEIGHT / 7.3}]'
RESTING = {
    'spring': (f'{GRAVITY}, spring: {{stiffness: 7.3, at: [0, 0, 0.3], '
               f'anchor: [1.0, 2.0, {0.45 + WEIGHT / 7.3}]}}', 'position: [1.0, 2.0, 0.15]'),
    'potential': (f"{GRAVITY}, potential: {{energy: '3.65*(z - 0.45)^2'}}", LOW),
    'force': (f"{GRAVITY}, force: {{value: [0, 0, '-7.3*(z - 0.45)'], frame: world, "
              'at: [0, 0, 0.1]}', LOW)}


@pytest.mark.parametrize(('method', 'name'), some_of(['gauss16', 'dop8', 'auto'], sorted(RESTING)))
def test_a_free_body_rests_where_its_weight_is_balanced(method, name):
    """By about an ulp it does not; what that gives within 20 s is no more than 1e-12 m/s."""
    effects, initial = RESTING[name]
    simulation = Simulation(scene(effects, initial), method, accuracy=1e-9, horizon=HORIZON)
    states = simulation.states(np.linspace(0.0, HORIZON, 7))
    start = states[0]
    for state in states:
        assert state.position == pytest.approx(start.position, rel=0.0, abs=1e-6)
        assert np.abs(state.velocity).max() < 1e-6


@pytest.mark.parametrize('method', ['gauss16', 'dop8'])
def test_a_body_whose_spring_bears_it_beside_its_center_moves_as_it_turns(method):
    """At first the forces balance but for an ulp, the torques do not."""
    hung = scene(f'{GRAVITY}, spring: {{stiffness: 7.3, at: [0.02, 0, 0.01], length: 0.1, '
                 f'anchor: [0.02, 0.0, {0.11 + WEIGHT / 7.3}]}}')
    states, best = (Simulation(hung, name, accuracy=accuracy, horizon=2.0).states([1.0, 2.0])
                    for name, accuracy in ((method, 1e-9), ('taylor', 1e-13)))
    assert np.abs(best.velocity[0]).max() > 1e-4
    for part in ('orientation', 'angular_velocity', 'position', 'velocity'):
        assert getattr(states, part) == pytest.approx(getattr(best, part), rel=0.0, abs=2e-9)


PUSHED = "force: {{value: ['0.5*(1 + tanh((t - 5)/{width}))', 0, 0], frame: world}}"


@pytest.mark.parametrize(('method', 'accuracy'), [
    ('auto', 1e-6), ('dop8', 1e-9), ('gauss16', 1e-9), ('taylor', 1e-9)])
@pytest.mark.parametrize('width', [0.5])
def test_a_force_that_is_switched_on_softly_pushes_a_body_from_rest(method, accuracy, width):
    """P = (t + w ln cosh((t - 5)/w) - w ln cosh(5/w))/2, half a kg m/s for each second at last."""
    simulation = Simulation(scene(PUSHED.format(width=width)), method, accuracy=accuracy,
                            horizon=HORIZON)
    times = np.array([5.0, HORIZON])
    found = 1.3 * simulation.states(times).velocity[:, 0]
    log_cosh = np.log(np.cosh((times - 5.0) / width))
    expected = 0.5 * (times + width * (log_cosh - math.log(math.cosh(5.0 / width))))
    assert found == pytest.approx(expected, rel=0.0, abs=accuracy * expected[-1])


@pytest.mark.parametrize('method', ['dop8', 'gauss16'])
def test_a_body_that_turns_turns_as_accurately_while_nothing_pushes_it_yet(method):
    turning = 'angular_velocity: [1, 2, 3]'
    ends = [Simulation(scene(effects, turning), method, accuracy=1e-9, horizon=HORIZON)
            .states([HORIZON])[0] for effects in (PUSHED.format(width=0.5), '')]
    assert ends[0].orientation == pytest.approx(ends[1].orientation, rel=0.0, abs=1e-9)
    assert ends[0].angular_velocity == pytest.approx(ends[1].angular_velocity, rel=0.0, abs=1e-9)


@pytest.mark.parametrize(('method', 'balanced'), some_of(
    ['auto', 'dop8', 'gauss16'], [('-5*angle', 'angle: 1.0'), ('-5*(angle - 1) - 0.3*rate', '')]))
def test_a_hinge_rests_where_a_law_of_its_angle_balances_a_torque(method, balanced):
    """The choice asks, too, what half an ulp on the start would do."""
    law, initial = balanced
    held = 5.0 if initial else -5.0
    balanced = scene(f"torque: {{value: [0, 0, '{law}']}}, torque: {{value: [0, 0, {held}]}}",
                     initial, '{hinge: {axis: [0, 0, 1]}}')
    simulation = Simulation(balanced, method, accuracy=1e-9, horizon=HORIZON)
    state = simulation.states([HORIZON])[0]
    assert simulation.choice.expected_error < 1e-9
    assert 2.0 * math.asin(state.orientation[2]) == pytest.approx(
        1.0 if initial else 0.0, rel=0.0, abs=1e-9)


@pytest.mark.parametrize('accuracy', [1e-6, 1e-9, 1e-12])
def test_a_first_step_in_which_a_stiff_body_would_leave_doubles_is_refused(accuracy):
    """Its squares are infinite, and beside an infinite motion no error showed."""
    hanging = parse_scene("""
scene: hanging
body: {mass: 1.0, inertia: [1.0, 2.0, 2.5], center_of_mass: [0, 0, 0.1]}
constraint: pivot
effects: [internal_dissipation: {coefficient: 10000.0}, gravity: {g: 9.81}]
initial: {orientation: [0, 1, 0, 1.29e-5], angular_velocity: [0, 1.563e-4, 0]}
""")
    solver, out = Stepped(hanging, 'dop8', accuracy=accuracy, horizon=0.5), np.empty(14)
    solver.start(hanging.initial.vector).state(0.1, out)
    # the attitude follows the momentum: c M g r turn = omega
    assert abs(2.0 * out[4]) == pytest.approx(out[6] / 9810.0, rel=0.0, abs=accuracy)
