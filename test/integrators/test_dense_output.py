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
SWING = """
scene: swing
body: {mass: 1.0, inertia: [0.1, 0.1, 0.1], center_of_mass: [0, 0, -0.3]}
constraint: {hinge: {axis: [1, 0, 0]}}
effects: [gravity: {g: 1.0}, drag: {angular: 0.1, linear: 0}]
initial: {angle: 0.1, rate: 4.0}
"""


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


@pytest.mark.without_numba
@pytest.mark.parametrize('tolerance', [2.0 ** -15, 2.0 ** -18, 2.0 ** -22])
def test_states_between_nodes_err_no_more_than_nodes_at_coarse_tolerances(tolerance):
    """Where the last sweep of a shorter step changed all that it may err by, 3 to 4.5 times more.

    Measured: 1.1 to 1.2 times.
    """
    swing = parse_scene(SWING)

    def errors(times):
        pairs = zip(states(swing, 'gauss16', times, accuracy=tolerance, horizon=8.0),
                    states(swing, 'dop8', times, accuracy=1e-14, horizon=8.0), strict=True)
        return [angle_between(*a[1:5], *b[1:5]) for a, b in pairs]
    solver, nodes = Stepped(swing, 'gauss16', accuracy=tolerance, horizon=8.0), [0.0]
    course = solver.start(swing.initial.vector)._course
    while nodes[-1] < 8.0:
        nodes.append(course.step_at(nodes[-1])[1])
    assert len(nodes) == 17
    most = max(errors(np.array(nodes[:-1])))
    assert max(errors(np.linspace(0.0, 8.0, 401))) < 1.5 * most


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
