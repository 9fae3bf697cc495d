# SPDX-License-Identifier: Apache-2.0
"""An effect that a scene does not list is neither in its code nor called."""

import inspect

import numpy as np
import pytest
from data import smooth_cases

from rigid_body_sim.integrators.equations.equations import Equations
from rigid_body_sim.integrators.solver import Stepped
from rigid_body_sim.scene.effects import EFFECTS
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.simulation.simulation import Simulation

KERNELS = {'gravity': 'moment_of_weight', 'torque': 'constant_elementary', 'drag': 'couple_drag',
           'internal_dissipation': 'turning_internal_dissipation'}


@pytest.mark.parametrize(
    ('case', 'listed'),
    [('asymmetric_heavy_top', {'gravity'}), ('damped_top', {'gravity', 'drag'}),
     ('driven_body', {'torque'}), ('major_axis_relaxation', {'internal_dissipation'})])
def test_source_made_for_a_scene_names_its_effects_and_no_other(case, listed):
    source = inspect.getsource(Equations(parse_scene(smooth_cases.text(case))).kernels)
    assert {name for name, kernel in KERNELS.items() if kernel in source} == listed


def test_scenes_that_differ_in_numbers_share_their_sources_and_nothing_else():
    text = smooth_cases.text('damped_top')
    first, same = Equations(parse_scene(text)), Equations(parse_scene(text, {'body.mass': 1.5}))
    other = Equations(parse_scene(text, {'effects': [{'gravity': {'g': 9.81}}]}))
    assert same.calls is first.calls
    assert same.kernels is first.kernels
    assert not np.array_equal(same.held(0.0), first.held(0.0))
    assert other.kernels is not first.kernels


def entered(*arguments):
    raise AssertionError('an effect that the scene does not list was entered')


@pytest.mark.parametrize(
    ('scene', 'listed'), [('asymmetric_heavy_top', 'gravity'), ('tennis_racket', None)])
def test_absent_effects_are_never_entered(monkeypatch, scene, listed):
    for name, effect in EFFECTS.items():
        if name != listed:
            for view in ('acting', 'value', 'as_impulse', 'energy'):
                if hasattr(effect, view):
                    monkeypatch.setattr(effect, view, entered)
    if listed:
        made = parse_scene(smooth_cases.text(scene))
        solver = Stepped(made, 'dop8', accuracy=1e-9).start(made.initial.vector)
        solver.state(0.1, np.empty(14))
    simulation = Simulation(
        made if listed else scene, accuracy=1e-9, integrator='dop8' if listed else 'auto')
    simulation.advance(10)
    assert abs(simulation.ledger()['energy_residual']) < 1e-9


def test_an_effect_that_is_listed_is_entered(monkeypatch):
    monkeypatch.setattr(EFFECTS['gravity'], 'acting', entered)
    with pytest.raises(AssertionError, match='was entered'):
        Equations(parse_scene(smooth_cases.text('asymmetric_heavy_top')))


def test_the_ledgers_kernel_is_not_made_before_the_ledger_asks():
    made = parse_scene(smooth_cases.text('asymmetric_heavy_top'))
    solver = Stepped(made, 'dop8', accuracy=1e-9).start(made.initial.vector)
    solver.state(0.1, np.empty(14))
    assert 'actors' not in vars(solver._ledger)
    solver.entries(0.1)
    assert solver._ledger.actors._kernels is not None
