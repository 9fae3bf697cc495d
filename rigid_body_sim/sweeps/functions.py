# SPDX-License-Identifier: Apache-2.0
"""Functions of the user's own in a sweep: the Run that they see, and what they may return."""

import functools
import math

import numpy as np

from rigid_body_sim.errors import BadInput
from rigid_body_sim.scene.state import STATE_SIZE, States
from rigid_body_sim.simulation.simulation import Simulation
from rigid_body_sim.sweeps import plan as plans

RATE = 1000.0
"""Ticks per second of runs that need a Simulation, those of scenes with strikes."""


class Run:
    """One run as a function of the user's own sees it.

    Attributes
    ----------
    number : int
    values : dict
        Key of the scene -> its value in this run.
    states : States
        At the times of the sweep.
    """

    def __init__(self, number, values, states, plan, choice, start):
        self.number, self.values, self.states = number, values, states
        self._plan, self._choice, self._start = plan, choice, start

    def at(self, times) -> States:
        """Return the States at any times, s, which the sweep need not list."""
        if self._choice is None:
            return self.simulation.states(times)
        times = np.ascontiguousarray(times, dtype=float).reshape(-1)
        out = np.empty((1, len(times), STATE_SIZE))
        self._choice.many(self._start[np.newaxis], times, out)
        return States(out[0])

    @functools.cached_property
    def simulation(self) -> Simulation:
        """A Simulation of this run, at its start."""
        return simulation_of(self._plan, self.number)


def simulation_of(plan, run):
    """Return the Simulation of one run, of which the last time is a tick."""
    spec = plan.spec
    rate = math.ceil(plan.horizon * RATE) / plan.horizon
    return Simulation(plan.scene_of(run), spec.integrator, spec.accuracy, rate,
                      horizon=plan.horizon)


def returned(name, value):
    """Return what a function returned as name -> number or array, its own name for a bare one."""
    if isinstance(value, dict):
        return {plans.word(str(key)): np.asarray(one, dtype=float) for key, one in value.items()}
    short = plans.word(name.rpartition(':')[2].rpartition('.')[2])
    return {short: np.asarray(value, dtype=float)}


def length_of(value):
    """Return the length of an array, None of a number."""
    if value.ndim > 1:
        raise ValueError(f'returned an array of shape {value.shape}; a number or a row is kept')
    return len(value) if value.ndim else None


def outputs_of(plan):
    """Return what each function of a plan gives: name -> [(variable, length or None)].

    Raises
    ------
    BadInput
        The function fails on the template's run.
    """
    found = {}
    for name, function in plan.spec.functions.items():
        simulation = simulation_of(plan, plan.template_run)
        run = Run(plan.template_run, plan.overrides(plan.template_run),
                  simulation.states(plan.spec.times), plan, None,
                  simulation.scene.initial.vector)
        try:
            told = returned(name, function(run))
            found[name] = [(key, length_of(value)) for key, value in told.items()]
        except Exception as error:
            raise BadInput(f'keep: function {name}', f'fails on run {plan.template_run} '
                           f'({type(error).__name__}: {error})',
                           'a function of one Run that returns a number, a row of numbers or a '
                           'dict of them') from error
    return found
