# SPDX-License-Identifier: Apache-2.0
"""Cases with a reference of at least 34 digits (groups 1, 2, 3 and 6).

They compare the attitude at every reference time, and the times of flips. The bound on an
attitude is the floor of two roundings of a quaternion, 2e-15 rad. For free bodies half an ulp of
the angle turned through is added (the rounding of omega itself; the motion may magnify it far
beyond that: up to 3 rad on the separatrix, yet the closed form stays within the bound, because its
rates have more digits than a double). The bound on a flip is 4 ulp of its time.
"""

import functools
import json
import math
import pathlib

import numpy as np
from mpmath import mp, mpf

from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.simulation.simulation import Simulation
from rigid_body_sim.study.hard_cases import beside
from rigid_body_sim.study.hard_cases.case import Case, Outcome

RECORDS = json.loads(pathlib.Path(__file__).with_name('references.json').read_text())
EPSILON = np.finfo(float).eps
FLOOR = 2e-15


def scene_of(record):
    """Return the scene of a record."""
    top = record['kind'] == 'pivot'
    body = {'mass': record.get('mass', 1.0), 'inertia': record['moments']}
    if top:
        body |= {'inertia_about': 'origin', 'center_of_mass': record['center']}
    return parse_scene(json.dumps({
        'scene': 'hard_case', 'body': body, 'constraint': record['kind'],
        'effects': [{'gravity': {'g': record['g']}}] if top else [],
        'initial': {key: record[key] for key in ('orientation', 'angular_velocity')}}))


def attitude(record):
    """Return the Outcome at the reference time with the largest ratio of error to bound."""
    simulation = Simulation(scene_of(record))
    states = simulation.states([state['time'] for state in record['states']]).orientation
    size = math.hypot(*record['angular_velocity']) if record['kind'] == 'free' else 0.0
    found = [(beside.angle(q, state['orientation']), FLOOR + 0.5 * EPSILON * size * state['time'])
             for q, state in zip(states, record['states'], strict=True)]
    error, bound = max(
        found, key=lambda pair: pair[0] / pair[1] if pair[0] == pair[0] else math.inf)
    last = record['states'][-1]['time']
    return Outcome(
        error, bound, 'rad',
        f'two roundings of q{" and half an ulp of the angle turned over" if size else ""}, '
        f'up to {last:g} s')


def flips(record):
    """Return the Outcome of the times of flips, with errors relative to the times."""
    simulation = Simulation(scene_of(record), rate=1.0)
    last = float(mpf(record['flips'][-1]['time']))
    simulation.advance(math.ceil(min(last, 1e15)) + 1)
    times = [event.time for event in simulation.events if event.name == 'flip']
    with mp.workdps(40):
        errors = [float(abs(mpf(times[flip['count'] - 1]) / mpf(flip['time']) - 1))
                  for flip in record['flips']]
    return Outcome(max(errors), 4.0 * EPSILON, 'of the time',
                   f'rounding of the times of flips {[flip["count"] for flip in record["flips"]]}')


def cases():
    """Yield the cases."""
    for record in RECORDS:
        yield Case(record['group'], record['name'], record['why'],
                   functools.partial(attitude, record), beside.attitude(scene_of(record), record))
        if record['group'] == 1 and record['flips']:
            yield Case(
                1, f'flips: {record["name"]}',
                'energy does not show them; each is the time of a passage through the middle '
                'axis',
                functools.partial(flips, record))
