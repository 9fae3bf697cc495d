# SPDX-License-Identifier: Apache-2.0
"""Runners: a method (ours or a peer's) on one problem, with settings from coarse to fine.

A peer is a module in peers/ with NAME, `version()` and `runners(problem)`; ours come from the
table of methods. A Runner's `make(setting)` does what a user does once (compile, allocate); only
the Run that it returns is timed.
"""

from dataclasses import dataclass

import numpy as np

from rigid_body_sim.choice.choose import choose, methods_for
from rigid_body_sim.integrators import METHODS
from rigid_body_sim.mechanics.bounds import swing_rate
from rigid_body_sim.scene.effects.wrench import Wrench
from rigid_body_sim.scene.state import ANGULAR_VELOCITY, ORIENTATION, STATE_SIZE
from rigid_body_sim.simulation.simulation import Simulation

TOLERANCES = tuple(10.0 ** -k for k in range(1, 16))
STEPS_OF_A_RADIAN = tuple(2.0 ** k for k in range(-1, 16))
ONE_MORE = 'exact, one more state'
"""Name of the exact method without its anchor: the cost of a state once the start is known."""
GRID = 32
"""Divisor of the number of steps: references have so many times, and a step ends at each."""


class RefusedError(Exception):
    """Error of a method that cannot run a problem, or is wrong by design; its text says why."""


@dataclass(frozen=True)
class Runner:
    """One line of the figure, or one variant of it.

    Attributes
    ----------
    name : str
        Runners of one name are variants of one line, which shows the best of them at each cost.
    control : str
        Meaning of a setting: accuracy, tolerance, step or none.
    settings : tuple
        Settings from coarse to fine.
    make : callable
        Takes a setting and returns a Run.
    is_peer : bool
    variant : str
        What a variant sets beside `settings`.
    """

    name: str
    control: str
    settings: tuple
    make: object
    is_peer: bool = False
    variant: str = ''


class Run:
    """A method that is ready to run.

    `start()` goes (back) to the start and `to(time)` goes on; these are timed. `state()` returns
    q and omega there, 7 numbers.
    """

    def __init__(self, start, to, state):
        self.start, self.to, self.state = start, to, state


def steps_for(problem, reference):
    """Return steps (s) from coarse to fine that divide the duration.

    They are shares of a radian at the fastest rate of the motion.
    """
    fastest = max(float(sum(x * x for x in omega)) ** 0.5 for omega in reference.omega)
    fastest = (max(fastest, float(np.linalg.norm(problem.scene.initial.angular_velocity)))
               + swing_rate(problem.scene) / 2.0)
    counts = {GRID * max(1, round(problem.duration * fastest * k / GRID))
              for k in STEPS_OF_A_RADIAN}
    return tuple(problem.duration / count for count in sorted(counts))


def ours(problem, reference):
    """Yield a Runner for every method that can run the problem, from the table of methods."""
    steps = steps_for(problem, reference)
    for name in methods_for(problem.scene):
        if name == 'exact':
            yield Runner(name, 'none', (None,), lambda _: _our_run(problem, 'exact', {}))
            yield Runner(
                ONE_MORE, 'none', (None,), lambda _: _one_more(_our_run(problem, 'exact', {})))
            continue
        for control in METHODS[name].TAKES:
            label = (name if len(METHODS[name].TAKES) == 1 or control == 'accuracy'
                     else f'{name}, fixed step')
            yield Runner(label, control, TOLERANCES if control == 'accuracy' else steps,
                         lambda setting, name=name, control=control: _our_run(
                             problem, name, {control: setting}))


def begun(scene):
    """Return the initial state vector of all methods, after the strikes at time 0."""
    if any(effect.name == 'strike' for effect in scene.effects):
        return Simulation(scene).states(np.zeros(1)).vector[0]
    return scene.initial.vector


def _our_run(problem, method, control):
    scene, end = problem.scene, problem.duration
    choice = choose(scene, method, horizon=end, **control)
    if any(effect.name == 'strike' and effect.time > 0.0 for effect in scene.effects):
        return _struck_run(scene, method, control)
    start, out, still = begun(scene), np.empty(STATE_SIZE), Wrench()
    result = out[ORIENTATION.start:ANGULAR_VELOCITY.stop]
    solver = None

    def begin():
        nonlocal solver
        solver = choice.solver(start, still)

    def to(time):
        solver.state(time, out)
    return Run(begin, to, lambda: result)


def _one_more(run):
    """Return a Run that keeps the start of another one."""
    run.start()
    return Run(lambda: None, run.to, run.state)


def _struck_run(scene, method, control):
    """Return the Run of a scene with strikes on the way, which Simulation applies."""
    simulation = Simulation(scene, method, **control)
    result = np.empty((1, STATE_SIZE))

    def to(time):
        result[:] = simulation.states(np.array([time])).vector
    return Run(simulation.reset, to, lambda: result[0, ORIENTATION.start:ANGULAR_VELOCITY.stop])
