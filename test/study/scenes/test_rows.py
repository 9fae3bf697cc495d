# SPDX-License-Identifier: Apache-2.0
"""The rows of every check for a made-up motion, which obeys no law, are those that are kept.

What is predicted and what is measured differ widely then, so a change of either shows, even where
a true motion would meet both, or lie below a bound in any case.
"""

import math
import types

import kept
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from rigid_body_sim.errors import BadInput
from rigid_body_sim.scene.scene import load_scene
from rigid_body_sim.scene.state import States
from rigid_body_sim.study.scenes import experiment
from rigid_body_sim.study.scenes.systems import SYSTEMS

PACE = {'chandler_wobble': 6e-7, 'kater_pendulum': 6.0, 'kater_pendulum_from_p': 6.0,
        'kapitza_pendulum': 40.0, 'baseball_bat': 5.0, 'librating_satellite': 3e-3,
        'tennis_racket': -1.0, 'rising_egg': -100.0, 'rattleback': 87.0, 'free_body': 8.0,
        **dict.fromkeys((name for name in SYSTEMS if name.startswith('billiard')), 5.0)}
"""How fast a body turns in a made-up motion if not as fast as at the start, rad/s."""
AT = {'impact': 0.0878, 'rolling began': 0.4, 'rest': 0.8}
"""When each event happens, over the span that is searched; a coin hits the table about then."""
PARTS = ('name', 'predicted', 'measured', 'tolerance', 'unit', 'bound', 'absolute', 'as_written',
         'detail')


def _mark(part):
    """Return a number between -1 and 1 that any number of a mapping moves."""
    if isinstance(part, (dict, list)):
        parts = part.values() if isinstance(part, dict) else part
        return sum(0.5 ** (k % 5 + 1) * _mark(one) for k, one in enumerate(parts)) / 2.0
    return math.atan(part) / 1.6 if isinstance(part, (int, float)) else 0.0


class Motion:
    """Stands in for Simulation: a body that begins as the scene says, and turns in two ways.

    R(t) = exp(u a(t)) R(0) exp(v b(t)) with u fixed in the world and v in the body; each rate
    swells and sinks, and the body wanders about.
    """

    def __init__(self, scene, method, accuracy):
        self._place, self.rate, self._ticks = scene.initial.position, 1000.0, 0
        self._mark = 1.0 + 0.1 * _mark(scene.mapping)
        self._turn = Rotation.from_quat(scene.initial.orientation)
        omega, self._velocity = (np.array(one) for one in (
            scene.initial.angular_velocity, scene.initial.velocity))
        for effect in scene.effects:
            if effect.name == 'strike':    # as a law would have it but for the factors
                impulse = np.array(effect.impulse) / scene.body.mass
                omega += 0.3 * np.cross(effect.point or (0.0, 0.0, effect.height), impulse)
                self._velocity += 0.9 * impulse
        pace = PACE.get(scene.name, float(np.linalg.norm(omega))) or 1.0
        self._v = np.array([0.48, -0.6, 0.64])
        self._b = 0.37 * pace * self._mark
        self._omega, rest = omega, self._turn.apply(omega - self._b * self._v)
        self._a = float(np.linalg.norm(rest))
        self._u = rest / self._a

    def states(self, times):
        t = np.asarray(times, float)
        a, b = self._a, self._b
        turned = self._turns(t)
        omega = (turned.inv().apply(self._u) * (a * (1.0 + 0.1 * np.sin(1.3 * a * t)))[:, None]
                 + self._v * (b * (1.0 + 0.2 * np.sin(0.7 * b * t)))[:, None])
        wander = 0.01 * np.stack([np.sin(a * t), np.cos(b * t) - 1.0, np.sin((a - b) * t)], 1)
        omega[t == 0.0] = self._omega    # to the last bit
        place = self._place + self._velocity * t[:, None] + wander
        return States(np.column_stack([t, turned.as_quat(), omega, place,
                                       self._velocity + a * wander]))

    def _turns(self, t):
        a, b = self._a, self._b
        first = a * t + (1.0 - np.cos(1.3 * a * t)) / 13.0
        second = b * t + (1.0 - np.cos(0.7 * b * t)) / 3.5
        return (Rotation.from_rotvec(first[:, None] * self._u) * self._turn
                * Rotation.from_rotvec(second[:, None] * self._v))

    def advance(self, ticks):
        self._ticks += ticks

    @property
    def events(self):
        time = 1e-3 * self._ticks * self._mark
        return [types.SimpleNamespace(name=name, time=share * time)
                for name, share in (*AT.items(), ('rolling began', 0.9))]

    def at_event(self, name, before):
        return types.SimpleNamespace(time=before * AT[name] * self._mark)

    def ledger(self):
        return {'energy_residual': -1e-3 * self._ticks, 'dissipated': 2e-3 * self._ticks}

    def diagnose(self, states):
        return 1.0 + 0.1 * np.sin(states.time), None


@pytest.mark.parametrize('name', SYSTEMS)
def test_rows_of_a_made_up_motion(name, monkeypatch):
    monkeypatch.setattr(experiment, 'Simulation', Motion)
    run = experiment.Experiment(load_scene(name), 'exact')
    kept.check(f'rows_{name}', list(map(_kept, SYSTEMS[name].check(run))))


@pytest.mark.parametrize(('name', 'changes'), [
    *(('billiard_follow', one) for one in (
        'strike.time=0.5', 'strike.impulse=[-0.2, 0, 0]', 'strike.impulse=[0.2, 0.1, 0]',
        'sliding_friction.mu=0', 'initial.velocity=[1, 0, 0]',
        'initial.angular_velocity=[0, 1, 0]', 'initial.orientation=[0, 0, 1, 0]')),
    *(('symmetric_top', one) for one in (
        'body.inertia=[1, 1.1, 1.5]', 'body.inertia=[1, 1, 1]',
        'initial.angular_velocity=[0, 0, 2]', 'initial.angular_velocity=[1, 0, 0]')),
    *(('heavy_top', one) for one in (
        'gravity.g=0', 'body.center_of_mass=[0, 0, -0.1]',
        'body.center_of_mass=[0.01, 0, 0.1]', 'body.center_of_mass=[0, 0.01, 0.1]',
        'body.inertia=[0.02, 0.021, 0.005]', 'initial.tilt=0', 'initial.tilt=3.14159265')),
    ('tennis_racket', 'body.inertia=[1, 1, 1.5]'),
    ('tennis_racket', 'initial.angular_velocity=[1, 0, 0]'),
    ('asymmetric_top', 'initial.angular_velocity=[0, 1, 0]'),
    ('sleeping_top', 'initial.tilt=0.3'), ('steady_precession', 'initial.spin=3'),
    ('sphere', 'initial.angular_velocity=[0, 0, 0]'), ('kater_pendulum', 'initial.rate=30'),
    ('kater_pendulum', 'gravity.g=0'), ('kater_pendulum', 'constraint.hinge.through=[0, 0, -0.4]')
])
def test_what_no_formula_is_for_is_refused(name, changes, monkeypatch):
    monkeypatch.setattr(experiment, 'Simulation', Motion)
    run = experiment.Experiment(load_scene(name, [changes]), 'exact')
    with pytest.raises(BadInput, match=f'^{name}: '):
        list(SYSTEMS[name].check(run))


def _kept(row):
    """Return a Quantity as plain data; what is as good as 0 beside an absolute tolerance is 0."""
    found = {part: getattr(row, part) for part in PARTS}
    if row.absolute and np.ndim(row.measured) == 0 and abs(row.measured) < 1e-3:
        found['measured'] = 0.0
    return found
