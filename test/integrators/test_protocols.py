# SPDX-License-Identifier: Apache-2.0
"""Every method, family and solver declares what the contracts of protocols.py ask for."""

import types

import pytest

from rigid_body_sim.integrators import GENERAL, METHODS, protocols
from rigid_body_sim.integrators.solver import Stepped
from rigid_body_sim.motions.solver import Exact

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


def test_a_missing_declaration_is_found():
    names = {name: value for name, value in vars(GENERAL).items() if name != 'STIFF'}
    assert not isinstance(types.SimpleNamespace(**names), protocols.Method)


@pytest.mark.parametrize('solver', [Stepped, Exact])
def test_solvers_have_the_methods_of_the_contract(solver):
    assert issubclass(solver, protocols.Solver)


def test_the_general_method_takes_wrenches():
    assert (GENERAL.FAMILY.TAKES_WRENCH and GENERAL.HEAT and GENERAL.TABLE
            and 'dissipation' in GENERAL.STIFF)
    assert {'accuracy', 'step'} == set(GENERAL.TAKES)
