# SPDX-License-Identifier: Apache-2.0
"""Every method, family and solver declares what the contracts of protocols.py ask for."""

import types

import pytest

from rigid_body_sim.choice.choose import choose
from rigid_body_sim.integrators import GENERAL, METHODS, protocols
from rigid_body_sim.integrators.solver import Stepped
from rigid_body_sim.motions.solver import Exact
from rigid_body_sim.scene.effects.wrench import Wrench
from rigid_body_sim.scene.scene import load_scene

FAMILIES = sorted(
    {method.FAMILY for method in METHODS.values()}, key=lambda family: family.__name__)


@pytest.mark.parametrize('method', METHODS.values(), ids=METHODS)
def test_a_method_declares_what_it_can_do(method):
    assert isinstance(method, protocols.Method)
    assert set(method.TAKES) <= {'accuracy', 'step'} and method.TAKES
    assert isinstance(method.FAMILY, protocols.Family)


@pytest.mark.parametrize('family', FAMILIES, ids=lambda family: family.__name__)
def test_a_family_with_lanes_has_a_batch_mode(family):
    assert isinstance(family, protocols.LanesFamily) == family.LANES


def test_steps_of_a_runge_kutta_method_alone_end_where_the_sliding_of_a_ball_does():
    assert [family for family in FAMILIES if family.TABLE] == [GENERAL.FAMILY]


def test_a_missing_declaration_is_found():
    names = {name: value for name, value in vars(GENERAL).items() if name != 'STIFF'}
    assert not isinstance(types.SimpleNamespace(**names), protocols.Method)


@pytest.mark.parametrize(('name', 'solver'), [('dop8', Stepped), ('exact', Exact)])
@pytest.mark.without_numba
def test_solvers_have_what_the_contract_names(name, solver):
    scene = load_scene('free_body')
    made = choose(scene, name).solver(scene.initial.vector, Wrench())
    assert isinstance(made, solver)
    assert isinstance(made, protocols.Solver)


def test_the_general_method_takes_wrenches():
    assert (GENERAL.FAMILY.TAKES_WRENCH and GENERAL.HEAT and GENERAL.TABLE
            and 'dissipation' in GENERAL.STIFF)
    assert {'accuracy', 'step'} == set(GENERAL.TAKES)
