# SPDX-License-Identifier: Apache-2.0
"""What a course asks of a solver of SciPy, by one that is made up: it steps by 0.75 s."""

import math
import types

import numpy as np
import pytest
from near import near

from rigid_body_sim.errors import NotConverged
from rigid_body_sim.integrators import METHODS
from rigid_body_sim.integrators.equations.equations import Equations
from rigid_body_sim.integrators.families import scipy_methods
from rigid_body_sim.integrators.families.scipy_methods import Bound, _Course
from rigid_body_sim.integrators.marching.work import TooMuchWork
from rigid_body_sim.scene.scene import parse_scene

pytestmark = pytest.mark.without_numba

INERTIA = 2.0
JUMPS = 'torque: {times: [0, 1, 3], values: [[0, 0, 4], [0, 0, 0], [0, 0, 6]]}'


class Solver:
    """It keeps what it was made with; the rate of turning is the number of its step, all told."""

    made, steps = (), 0
    fails = None

    def __init__(self, rate, begin, y, end, **settings):
        self.rate, self.begin, self.end, self.settings = rate, begin, end, settings
        self.t, self.y, self.start, self.status = begin, y.copy(), y.copy(), 'running'
        Solver.made = *Solver.made, self

    def step(self):
        Solver.steps += 1
        self.t = min(self.end, self.t + 0.75)
        self.y[4:7] = 0.0, 0.0, Solver.steps
        self.status = 'finished' if self.t == self.end else 'running'
        return Solver.fails(self) if Solver.fails and Solver.steps == 3 else None

    def dense_output(self):
        y = self.y.copy()
        return lambda time: y


def course(effects=JUMPS, omega=(0.0, 2.0, 3.0), accuracy=1e-9, most=None, fails=None,
           stop=math.inf):
    """Return the course of a ball on a pivot from 0.25 s on."""
    scene = parse_scene(f'scene: s\nbody: {{mass: 1, inertia: {[INERTIA] * 3}}}\n'
                        f'constraint: pivot\neffects: [{effects}]\ninitial: {{}}\n')
    Solver.made, Solver.steps, Solver.fails = (), 0, fails
    vector = scene.initial.vector.copy()
    vector[0], vector[5:8] = 0.25, omega
    return _Course(types.SimpleNamespace(
        scene=scene, method=METHODS['lsoda'], vector=vector, most=most, accuracy=accuracy,
        stop=stop),
        Equations(scene), Solver)


def states(of, *times):
    """Return the states of a course at times."""
    out = np.empty((len(times), 14))
    of.states(np.array(times), out)
    return out


def test_a_solver_follows_each_stretch_between_jumps_of_what_acts():
    """Steps end at 1, then 1.75, 2.5, 3, then 3.75 and 4.5; a time belongs to the one it ends."""
    of = course()
    out = states(of, 4.0, 0.25, 1.0, 1.1, 2.5, 3.0, 3.75)
    assert out[:, 0].tolist() == [4.0, 0.25, 1.0, 1.1, 2.5, 3.0, 3.75]
    assert out[:, 7] == near([6.0, 1.0, 1.0, 2.0, 3.0, 4.0, 5.0], rel=1e-15)
    assert [(one.begin, one.end) for one in Solver.made] == [
        (0.25, 1.0), (1.0, 3.0), (3.0, math.inf)]
    assert [one.start[6] for one in Solver.made] == [3.0, 1.0, 4.0]
    grown = [one.rate(1.5, one.start)[6] for one in Solver.made]
    assert grown == near([4.0 / INERTIA, 0.0, 6.0 / INERTIA], rel=1e-15)
    one = np.empty(14)
    of.state(4.5, one)    # seen already
    assert (one[0], one[7], Solver.steps, len(Solver.made)) == (4.5, 6.0, 6, 3)
    of.state(4.6, one)
    assert (one[7], Solver.steps, len(Solver.made)) == (7.0, 7, 3)
    assert (of.kinks(9.0), of.TELLS_EVENTS) == ([], False)


@pytest.mark.parametrize(('omega', 'scale'), [
    ((2.0, -3.0, 6.0), 7.0), ((0.2, -0.3, 0.6), 1.0)])
@pytest.mark.parametrize(('accuracy', 'asked'), [
    (1e-9, 1e-9), (1e-15, 100.0 * 2.0 ** -52)])
def test_a_solver_is_asked_for_the_accuracy_of_each_unknown(omega, scale, accuracy, asked):
    """Relative, and for a small one that of its unit; a finer one than SciPy takes is its own."""
    of = course(omega=omega, accuracy=accuracy)
    states(of, 0.5)
    settings = Solver.made[0].settings
    assert settings['rtol'] == near(asked, rel=1e-15)
    assert settings['atol'][:7] == near([asked] * 4 + [asked * scale] * 3, rel=1e-15)
    assert settings['first_step'] is None


@pytest.mark.parametrize(('jump', 'first'), [(1.0, 1e-3), (0.2505, 5e-4)])
def test_where_nothing_moves_yet_the_first_step_is_short(jump, first):
    of = course(f'torque: {{times: [{jump}], values: [[0, 0, 4]]}}', (0.0, 0.0, 0.0))
    states(of, 0.25)
    assert Solver.made[0].settings['first_step'] == near(first, rel=1e-12)


def not_finite(solver):
    solver.y[0] = math.nan


def failed(solver):
    solver.status = 'failed'
    return 'too stiff'


def refused(solver):
    raise ValueError('array must not contain infs or NaNs')


@pytest.mark.parametrize(('fails', 'said'), [
    (not_finite, 'the state is no longer finite'), (failed, 'too stiff'),
    (refused, 'the rates are not finite')])
def test_a_solver_that_goes_on_no_more_is_told_with_the_time_it_reached(fails, said):
    """The third step fails: those before it ended at 1 and 1.75 s, and their states stay."""
    of = course(fails=fails)
    with pytest.raises(NotConverged, match=rf'^lsoda on s: at t = 1\.75 s:? {said}') as found:
        states(of, 4.0)
    assert found.value.time == 1.75
    at_once = course(fails=fails)
    Solver.steps = 2
    with pytest.raises(NotConverged, match=r'at t = 0\.25 s') as found:
        states(at_once, 4.0)
    assert found.value.time == 0.25


def test_a_trial_counts_each_step_as_ten_from_where_it_goes_on():
    of = course(most=30)
    assert states(of, 2.5)[0, 7] == 3.0
    assert states(of, 4.5)[0, 7] == 6.0
    with pytest.raises(TooMuchWork, match=r'^lsoda on s: more than 30 steps to t = 9\.0 s$'
                       ) as found:
        states(of, 9.0)
    assert (found.value.time, Solver.steps) == (7.5, 10)


def test_a_bound_is_for_any_accuracy_and_has_no_runner():
    of = course()
    stepped = types.SimpleNamespace(scene=of._scene, wrench=None, method=METHODS['radau'],
                                    vector=of._scene.initial.vector, most=None, accuracy=1e-6,
                                    stop=math.inf)
    bound = scipy_methods.bind(METHODS['radau'], stepped)
    assert isinstance(bound, Bound)
    assert bound.solver.__name__ == 'Radau'
    assert bound.at(stepped) is bound
    assert bound.runner(stepped, 0.0) is None
    assert bound.KEEPS_ENTRIES is False
    assert isinstance(bound.course(stepped), _Course)
