# SPDX-License-Identifier: Apache-2.0
"""States between the nodes of methods with long steps: as good as the nodes, in any order."""

import gc
import weakref

import numpy as np
import pytest
from data import smooth_cases

from rigid_body_sim.integrators.solver import Stepped
from rigid_body_sim.numerics.rotations import angle_between
from rigid_body_sim.scene.scene import parse_scene

METHODS = ('gauss16', 'taylor')


@pytest.fixture(scope='module')
def top():
    return parse_scene(smooth_cases.text('asymmetric_heavy_top'))


def states(scene, method, times, **control):
    out = np.empty((len(times), 14))
    Stepped(scene, method, **control).start(scene.initial.vector).states(times, out)
    return out


@pytest.mark.parametrize('control', [{'accuracy': 1e-9}, {'step': 0.03}])
@pytest.mark.parametrize('method', METHODS)
def test_states_do_not_depend_on_what_else_was_asked(top, method, control):
    times = np.random.default_rng(7).uniform(0.0, 20.0, 300)
    solver = Stepped(top, method, **control).start(top.initial.vector)
    together, again, alone = np.empty((300, 14)), np.empty((300, 14)), np.empty(14)
    solver.states(times, together)
    solver.states(times[::-1], again)
    assert np.array_equal(again, together[::-1])
    for k in (0, 150, 299):
        Stepped(top, method, **control).start(top.initial.vector).state(times[k], alone)
        assert np.array_equal(alone, together[k])


@pytest.mark.parametrize(
    ('method', 'control'), [('gauss16', {'step': 0.03}), ('taylor', {'accuracy': 1e-12})])
def test_states_between_nodes_are_as_good_as_nodes(top, method, control):
    times = np.linspace(0.0, 0.4, 101)
    pairs = zip(states(top, method, times, **control), states(top, 'dop8', times, accuracy=1e-15),
                strict=True)
    assert max(angle_between(*a[1:5], *b[1:5]) for a, b in pairs) < 1e-13


def test_a_solver_that_is_let_go_leaves_memory_at_once(top):
    """Each holds some 20 kB: those that stayed until the garbage is collected fill the caches."""
    prototype = Stepped(top, 'taylor', accuracy=1e-9)
    # a first call may compile, and what numba raises meanwhile holds the frames, with the solver
    prototype.start(top.initial.vector).state(1.0, np.empty(14))
    gc.disable()
    try:
        solver = prototype.start(top.initial.vector)
        solver.state(1.0, np.empty(14))
        gone = weakref.ref(solver)
        del solver
        assert gone() is None
    finally:
        gc.enable()
