# SPDX-License-Identifier: Apache-2.0
"""Functions of the user's own: the Run that they see, and what becomes of what they return."""

import types

import numpy as np
import pytest
from near import near

from rigid_body_sim.errors import BadInput
from rigid_body_sim.scene.scene import load_scene
from rigid_body_sim.simulation.simulation import Simulation
from rigid_body_sim.sweeps import functions

pytestmark = pytest.mark.without_numba
HORIZON = 0.7503


def plan(**own):
    """Return what functions read of a Plan, of runs that differ in their mass."""
    return types.SimpleNamespace(
        spec=types.SimpleNamespace(integrator='auto', accuracy=1e-9, functions=own,
                                   times=np.array([0.25, HORIZON])),
        horizon=HORIZON, template_run=3, overrides=lambda run: {'body.mass': 0.5 + 0.125 * run},
        scene_of=lambda run: load_scene('heavy_top', [f'body.mass={0.5 + 0.125 * run}']))


def test_the_simulation_of_a_run_has_its_scene_and_its_last_time_is_a_tick():
    simulation = functions.simulation_of(plan(), 2)
    assert simulation.scene.body.mass == 0.75
    assert simulation.accuracy == 1e-9
    assert simulation.rate == near(751 / HORIZON, rel=1e-15)    # a thousand ticks a second or more
    simulation.advance(751)
    assert simulation.time == near(HORIZON, rel=1e-15)


def test_a_run_has_states_at_any_times_and_its_simulation():
    one = plan()
    simulation = functions.simulation_of(one, 2)
    expected = Simulation(one.scene_of(2), 'auto', 1e-9).states([0.1, 0.7]).vector
    start = simulation.scene.initial.vector
    for choice in (None, simulation.choice):
        run = functions.Run(2, {'body.mass': 0.75}, None, one, choice, start)
        assert run.at([0.1, 0.7]).vector == pytest.approx(expected, abs=1e-12)
        assert run.at(0.7).vector == pytest.approx(expected[1:], abs=1e-12)
    assert run.simulation is run.simulation and run.simulation.time == 0.0
    assert (run.number, run.values) == (2, {'body.mass': 0.75})


@pytest.mark.parametrize(('name', 'value', 'expected'), [
    ('my.module:Class.height', 3, {'height': 3.0}), ('height', [1, 2], {'height': [1.0, 2.0]}),
    ('my.module:f', {'low': 1, 'high': [2, 3]}, {'low': 1.0, 'high': [2.0, 3.0]})])
def test_a_bare_value_has_the_name_of_its_function(name, value, expected):
    found = functions.returned(name, value)
    assert {key: one.tolist() for key, one in found.items()} == expected
    assert all(one.dtype == float for one in found.values())


def test_a_number_a_row_and_a_dict_of_them_are_kept():
    seen = []

    def height(run):
        seen.append((run.number, run.values, run.states.time.tolist()))
        return run.states.position[:, 2]
    assert functions.outputs_of(plan(
        **{'m:height': height, 'm:one': lambda run: 1.0,
           'm:both': lambda run: {'low': 0.5, 'high': [1, 2, 3]}})) == {
        'm:height': [('height', 2)], 'm:one': [('one', None)],
        'm:both': [('low', None), ('high', 3)]}
    assert seen == [(3, {'body.mass': 0.875}, [0.25, HORIZON])]


@pytest.mark.parametrize(('function', 'said'), [
    (lambda run: np.eye(2), r'fails on run 3 \(ValueError: returned an array of shape \(2, 2\)'),
    (lambda run: 'high', r'fails on run 3 \(ValueError'),
    (lambda run: 1 // 0, r'fails on run 3 \(ZeroDivisionError: ')])
def test_a_function_that_fails_is_one_line(function, said):
    with pytest.raises(BadInput, match=f'keep: function m:f: {said}'):
        functions.outputs_of(plan(**{'m:f': function}))
