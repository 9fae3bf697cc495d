# SPDX-License-Identifier: Apache-2.0
"""The table of cases that must have the same bits on every machine.

A case runs a scene and returns its parts: name -> list of arrays and texts, whose bytes make a
digest for each part. Some cases compute in another way what another case computes (`same_as`) and
must have the same digests: ticks in slices, other blocks of times, other numbers of threads.

Durations are short and states few, so that plain Python takes minutes, not hours.
"""

import functools
import os
import typing
import unittest.mock

import numpy as np

from rigid_body_sim.choice.choose import choose, methods_for
from rigid_body_sim.integrators import METHODS
from rigid_body_sim.scene.scene import load_scene, parse_scene, scene_names
from rigid_body_sim.scene.state import ANGULAR_VELOCITY
from rigid_body_sim.simulation.arithmetic import EXCEPTED
from rigid_body_sim.simulation.ensemble import ensemble
from rigid_body_sim.simulation.simulation import Simulation
from rigid_body_sim.study.machines import scenes

EXACT, STEPPED = (20.0, 300), (0.4, 5)
"""Duration (s) and number of states of a closed form, and of a method that steps."""
PACE = {'chandler_wobble': 1e5, 'needle': 0.01, 'fast_top': 0.1, 'billiard_center': 0.05,
        'billiard_follow': 0.05, 'billiard_low': 0.05, 'billiard_natural_roll': 0.05,
        'ball_with_side_spin': 0.05, 'ball_struck_twice': 0.05, 'graded_tensor': 0.1,
        'librating_satellite': 1e3}
"""Factor of the durations of a scene, if it is not 1."""
STEPS, ACCURACY = 40, 1e-9
"""Number of steps of a method without error control; accuracy (rad) of one with it."""
ACCURACIES, HORIZON = (1e-6, 1e-12), 0.5
ACCURACIES_ON_A_PLANE = (1e-3,)
"""Accuracies (rad) and horizon (s) asked of `auto`."""
FORCE, TORQUE = (0.03, -0.02, 0.0), (1e-3, 2e-3, 0.0)
ON_AWKWARD = ('exact', 'dop8', 'taylor')
"""Methods that run awkward scenes."""
COMMANDED = ('tennis_racket', 'heavy_top', 'skew_hinge', 'skew_tensor', 'driven_body',
             'ball_with_side_spin')
"""Scenes that take commands, by the method that `auto` chooses."""
BOOKED = (('major_axis_relaxation', 'dop8'), ('skew_top_damped', 'gauss16'))
"""Scenes and methods whose ledger is read; it contains heat."""
STRETCHED = (('heavy_top', 'exact'), ('skew_hinge', 'exact'), ('ball_with_side_spin', 'exact'),
             ('tennis_racket', 'exact'), ('skew_top', 'taylor'), ('driven_in_pieces', 'dop8'))
WAYS = ('one by one', 'in slices', 'foreseen', 'backwards')
"""Scenes and methods whose ticks are read in one go, and the other ways to read them."""
ENSEMBLES = (('heavy_top', 'exact'), ('skew_top', 'taylor'), ('heavy_top', 'dop8'))
BODIES, THREADS = (3, 8, 17, 40), (1, 2, 5)
"""Scenes and methods that run many bodies, the numbers of bodies and of threads."""
SIDE_BY_SIDE, BY_ORDER = ('thrown_with_drag', 'skew_hinge_damped'), (1e-3, ACCURACY)
"""Scenes that taylor follows by other unknowns where it has eight bodies at once, and accuracies
that make it take series of other orders."""


class Case(typing.NamedTuple):
    """One case of the table.

    Attributes
    ----------
    scene : str
        Name of the scene, one that ships or an awkward one.
    run : function
        Returns the parts.
    same_as : str or None
        Name of the case that must have the same digests.
    """

    scene: str
    run: typing.Callable
    same_as: str | None = None


def scene_of(name):
    """Return a scene that ships, or an awkward one."""
    return parse_scene(scenes.text(name)) if name in scenes.AWKWARD else load_scene(name)


def _times(name, method):
    duration, count = EXACT if method == 'exact' else STEPPED
    return np.arange(count) * (duration * PACE.get(name, 1.0) / (count - 1))


def _simulation(name, method):
    """Return the simulation of a scene by a method, with its accuracy or its step."""
    if method != 'exact' and 'accuracy' not in METHODS[method].TAKES:
        return Simulation(scene_of(name), method, step=float(_times(name, method)[-1]) / STEPS)
    return Simulation(scene_of(name), method, accuracy=ACCURACY)


def _parts(simulation, states):
    """Return all that messages carry of states: the states, energies, L^2 and reactions."""
    found = {'states': [states.vector], 'energies': simulation.diagnose(states)}
    if simulation.scene.constraint.kind != 'free':
        found['reactions'] = simulation.reactions(states.time)
    return found


def set_up(name):
    """Return the numbers of a scene: mass, centre, moments and axes about both points, start."""
    scene = scene_of(name)
    body, held = scene.body, scene.constraint
    return {'body': [np.array([body.mass, *body.center_of_mass])],
            'about the centre': [[*body.about_center.moments, *body.about_center.axes]],
            'about the origin': [[*body.about_origin.moments, *body.about_origin.axes]],
            # the digests were made when every constraint had both
            'constraint': [held.axis or (0.0, 0.0, 1.0),
                           held.through if held.axis else (0.0, 0.0, 0.0)],
            'start': [scene.initial.vector]}


def states(name, method):
    """Return the states of a scene by a method, and what follows from them."""
    simulation = _simulation(name, method)
    found = _parts(simulation, simulation.states(_times(name, method)))
    if method == 'exact':
        simulation.advance(500)
        found |= {'tick 500': [simulation.vector],
                  'events': [[event.time for event in simulation.events]]}
    return found


def chosen(name):
    """Return the choice of `auto`: method, tolerance, expected error."""
    scene = scene_of(name)
    # without numba the trials of a body on a plane take ten seconds per scene at 1e-12 rad
    asked = ACCURACIES if scene.body.surface is None else ACCURACIES_ON_A_PLANE
    found = (choose(scene, accuracy=one, horizon=HORIZON) for one in asked)
    return {f'{one.accuracy:g} rad': [one.method, [one.tolerance, one.expected_error]]
            for one in found}


def commanded(name, frame):
    """Return states and ledger under impulses, a held wrench and its release."""
    simulation = Simulation(scene_of(name), accuracy=ACCURACY, horizon=HORIZON)
    found = {}
    simulation.advance(7)
    simulation.impulse(force=FORCE, torque=TORQUE, frame=frame)
    simulation.impulse(torque=TORQUE, frame=frame)
    found['after impulses'] = [simulation.advance_through(9).vector]
    simulation.hold(force=FORCE, torque=TORQUE, frame=frame)
    found['under a wrench'] = [simulation.advance_through(30).vector]
    found['acceleration'] = simulation.acceleration
    simulation.release()
    found['let go'] = [simulation.advance_through(20).vector]
    return found | ledger(simulation)


def ledger(simulation):
    """Return the ledger of a simulation as a part."""
    return {'ledger': [list(simulation.ledger().values())]}


def booked(name, method):
    """Return the ledger of a scene by a method."""
    simulation = _simulation(name, method)
    simulation.advance(300)
    return ledger(simulation)


def ticks(name, method, way):
    """Return 300 ticks, read one by one, in slices, foreseen, backwards or in one go."""
    simulation = _simulation(name, method)
    if way == 'one by one':
        found = []
        for _ in range(300):
            simulation.advance()
            found.append(simulation.vector.copy())
        return {'states': [np.array(found)]}
    if way == 'foreseen':
        found = []
        while simulation.tick < 300:
            foreseen = simulation.foresee(min(64, 300 - simulation.tick)).vector
            found.append(foreseen)
            simulation.advance(len(foreseen))
            if not len(foreseen):
                found.append(simulation.advance_through(1).vector)
        return {'states': [np.concatenate(found)]}
    if way == 'backwards':
        times = simulation.time_at(np.arange(300, 0, -1))
        return {'states': [simulation.states(times).vector[::-1]]}
    sizes = {'in slices': (1, 7, 129, 2, 128, 33), 'in one go': (300,)}[way]
    return {'states': [np.concatenate([simulation.advance_through(size).vector
                                       for size in sizes])]}


def many(name, method, bodies, threads, accuracy=ACCURACY):
    """Return the states of bodies that start differently."""
    scene = scene_of(name)
    starts = np.tile(scene.initial.vector, (bodies, 1))
    starts[:, ANGULAR_VELOCITY] += np.arange(bodies)[:, np.newaxis] * (0.001, -0.003, 0.007)
    with unittest.mock.patch.object(os, 'cpu_count', return_value=threads):
        found = ensemble(scene, starts, np.arange(4) * 0.06, method, accuracy)
    return {'states': [found.vector]}


@functools.cache
def cases():
    """Return the table: name -> Case."""
    table = {}
    for name in [*scene_names(), *scenes.AWKWARD]:
        table[f'{name}: set-up'] = Case(name, functools.partial(set_up, name))
        table[f'{name}: choice of auto'] = Case(name, functools.partial(chosen, name))
        for method in methods_for(scene_of(name)):
            if method not in EXCEPTED and (name not in scenes.AWKWARD or method in ON_AWKWARD):
                table[f'{name} by {method}'] = Case(name, functools.partial(states, name, method))
    for name in COMMANDED:
        for axes in ('body', 'world'):
            run = functools.partial(commanded, name, axes)
            table[f'{name} under commands in {axes} axes'] = Case(name, run)
    for name, method in BOOKED:
        table[f'{name} by {method}: ledger'] = Case(name, functools.partial(booked, name, method))
    for name, method in STRETCHED:
        whole = f'{name} by {method}: ticks in one go'
        table[whole] = Case(name, functools.partial(ticks, name, method, 'in one go'))
        for way in WAYS:
            run = functools.partial(ticks, name, method, way)
            table[f'{name} by {method}: ticks {way}'] = Case(name, run, whole)
    for name, method in ENSEMBLES:
        for bodies in BODIES:
            first = f'{bodies} of {name} by {method}: {THREADS[0]} threads'
            for threads in THREADS:
                run = functools.partial(many, name, method, bodies, threads)
                label = f'{bodies} of {name} by {method}: {threads} threads'
                table[label] = Case(name, run, None if label == first else first)
    for name in SIDE_BY_SIDE:
        for accuracy in BY_ORDER:
            run = functools.partial(many, name, 'taylor', BODIES[0], THREADS[0], accuracy)
            label = f'{BODIES[0]} of {name} by taylor to {accuracy:g}: {THREADS[0]} threads'
            table[label] = Case(name, run)
    return table
