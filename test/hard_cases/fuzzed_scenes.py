# SPDX-License-Identifier: Apache-2.0
"""Random scenes of all constraints and effects, with extreme numbers, run in plain Python.

``python fuzzed_scenes.py FIRST END`` prints a line for each seed: refused, gave up, or runs and
the method. Plain Python compiles nothing; it is a hundred times slower, so marches are bounded to
a hundredth of their work. Every scene is given SECONDS, after which an alarm interrupts it: a run
that goes on then hears no interrupt and has no bound.
"""

import json
import random
import signal
import sys
import warnings

import numpy as np

from rigid_body_sim.choice import trial
from rigid_body_sim.errors import BadInput, NotConverged
from rigid_body_sim.integrators.marching import work
from rigid_body_sim.mechanics import events
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.simulation.simulation import Simulation

EXTREMES = (0.0, 1e-310, 1e-160, 1e-30, 1e-9, 1e-3, 1.0, 1e3, 1e6, 1e15, 1e40, 1e74, 1e160, 1e308)
SHARE = 0.1      # of the numbers that are extremes
SECONDS = 60


class Slow(Exception):
    """A scene took longer than SECONDS."""


def number(source, signed=True):
    """Return an extreme or a usual number."""
    size = (source.choice(EXTREMES) if source.random() < SHARE
            else 10.0 ** source.uniform(-3.0, 3.0))
    return size * (source.choice((1, -1)) if signed else 1)


def vector(source):
    """Return three numbers."""
    return [number(source) if source.random() < 0.8 else 0.0 for _ in range(3)]


def moments(source):
    """Return moments of slim, nearly symmetric and other bodies."""
    a, b = 10.0 ** source.uniform(-3.0, 1.0), 10.0 ** source.uniform(-3.0, 1.0)
    return source.choice((
        [a, a, a * source.choice((1e-310, 1e-100, 1e-12, 1e-6, 1e-4, 1.0, 1.99))],
        [a, a * (1.0 + 1e-9), a * 10.0 ** source.uniform(-8.0, -3.0)],
        [number(source, signed=False) for _ in range(3)],
        [a, b, abs(a - b) + source.random() * (a + b - abs(a - b))]))


def effects(source, constraint):
    """Return a list of effects that the constraint can have, several torques at once too."""
    def positive():
        return number(source, signed=False)
    if constraint == 'table':
        return [{'sliding_friction': {'mu': positive(), 'g': positive()}}]
    found = [{'gravity': {'g': positive()}},
             {'drag': {'linear': positive(), 'angular': positive()}},
             {'strike': {'point': vector(source), 'impulse': vector(source), 'time': 0.002}},
             {'internal_dissipation': {'coefficient': positive()}}][:4 if constraint == 'free'
                                                                    else 3]
    found = [one for one in found if source.random() < 0.4]
    for _ in range(source.choice((0, 0, 1, 2))):
        frame = source.choice(('body', 'world'))
        found.append({'torque': source.choice((
            {'value': vector(source), 'frame': frame},
            {'times': [0.001, 0.5], 'values': [vector(source), vector(source)],
             'frame': frame}))})
    return found


def scene(seed):
    """Return the scene of a seed as plain data."""
    source = random.Random(seed)
    constraint = source.choice(('free', 'pivot', 'hinge', 'table'))
    found = {'scene': 'fuzzed', 'constraint': constraint, 'effects': effects(source, constraint)}
    mass, omega = number(source, signed=False), vector(source)
    if constraint == 'table':
        radius = number(source, signed=False)
        return found | {'body': {'mass': mass, 'shape': {'solid_sphere': {'radius': radius}}},
                        'initial': {'angular_velocity': omega,
                                    'velocity': [number(source), number(source), 0.0]}}
    center = source.choice(([0, 0, 0], [0, 0, number(source)], vector(source)))
    found['body'] = {'mass': mass, 'inertia': moments(source), 'center_of_mass': center}
    turn = [source.uniform(-1.0, 1.0) for _ in range(4)]
    if constraint == 'hinge':
        return found | {'constraint': {'hinge': {'axis': turn[:3]}},
                        'initial': {'rate': number(source), 'angle': number(source)}}
    start = {'angular_velocity': omega, 'orientation': turn}
    if constraint == 'free':
        start |= {'velocity': vector(source), 'position': vector(source)}
    return found | {'initial': start}


def outcome(seed):
    """Return what becomes of a scene: refused, gave up, or runs and the method."""
    read = None
    try:
        read = parse_scene(json.dumps(scene(seed)))
        simulation = Simulation(read)
        for _ in range(3):
            simulation.advance()
            assert np.isfinite(simulation.vector).all(), simulation.vector
        states = simulation.states(np.linspace(0.0, 10.0, 5)).vector
        assert np.isfinite(states).all(), states
    except (BadInput, NotConverged) as refusal:
        text = str(refusal)
        assert text.isprintable() and len(text) < 2000, text
        return f'{"refused" if read is None else "gave up"}: {text}'
    return f'runs: {simulation.choice.method}'


def alarm(*_):
    """Interrupt what runs."""
    raise Slow


def main(first, end):
    """Run the scenes of the seeds from the first to the end; return the exit status."""
    warnings.simplefilter('ignore')    # plain Python warns where compiled code makes inf
    work.FIRST_LOOK, work.MOST, work.PATIENCE = 32, 100.0, 1e5
    trial.STEPS, trial.STEPS_PER_RADIAN, trial.RADIANS, events.LOOKS_A_TICK = 50, 5, 2.0, 20
    signal.signal(signal.SIGALRM, alarm)
    bad = 0
    for seed in range(first, end):
        signal.alarm(SECONDS)
        try:
            found = outcome(seed)
        except Exception as error:
            found, bad = f'{type(error).__name__}: {error}', bad + 1
        signal.alarm(0)
        print(seed, found.replace('\n', ' '), flush=True)
    return min(bad, 1)


if __name__ == '__main__':
    sys.exit(main(*map(int, sys.argv[1:])))
