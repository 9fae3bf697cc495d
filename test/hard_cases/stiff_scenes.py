# SPDX-License-Identifier: Apache-2.0
"""Slim and stiffly damped bodies; run by the tests in plain Python, where they compile nothing.

``python stiff_scenes.py NAME ...`` prints what the tests of these names look at, as JSON.
"""

import json
import pathlib
import sys

import numpy as np
from soak import SOAK

from rigid_body_sim import Simulation
from rigid_body_sim.integrators.solver import Stepped
from rigid_body_sim.scene.scene import load_scene, parse_scene
from rigid_body_sim.scene.state import STATE_SIZE

DEPARTURES = json.loads(
    (pathlib.Path(__file__).resolve().parents[1] / 'data' / 'departures.json').read_text())
ACCURACIES = 1e-12, 1e-6
SLIM = {
    'body': {'mass': 5.911208944562758, 'center_of_mass': [0, 0, 0.2],
             'inertia': [0.02721572901998965, 0.027215731741562554, 4.009956990958362e-07]},
    'effects': [{'gravity': {'g': 1.62}}, {'drag': {'linear': 0.21396549380914806}}],
    'initial': {'orientation': [-0.8640404958536038, 0.34559433430416686,
                                -0.0008788982795752972, -0.3660571064188381],
                'angular_velocity': [-9.452196416743863, 4.791690095390727, 4.398497056076267]}}


def scene(constraint='pivot', **parts):
    """Return a scene of these parts."""
    return parse_scene(json.dumps({'scene': 'stiff', 'constraint': constraint} | parts))


def followed(scene, horizon):
    """Return the method and the states at three ticks and at the end of a horizon."""
    simulation = Simulation(scene, horizon=horizon)
    simulation.advance(3)
    states = simulation.states([0.003, horizon])
    assert np.array_equal(states.vector[0], simulation.vector)
    return {'method': simulation.choice.method, 'expected': simulation.choice.expected_error,
            'end': states.vector[1].tolist()}


def led_to(scene, horizon):
    """Return the state at the end of a horizon by gauss16; in the soak as `followed`, by auto.

    The choice of auto takes several runs, of up to ten seconds; `slim` and `hinge` have it.
    """
    if SOAK:
        return followed(scene, horizon)
    end = np.empty(STATE_SIZE)
    Stepped(scene, 'gauss16', 1e-12, horizon=horizon).start(scene.initial.vector).state(
        horizon, end)
    return {'end': end.tolist()}


def slim():
    """Run a slim body whose drag about its axis is nothing but rounding."""
    return followed(scene(**SLIM), 2.0)


def hinge():
    """Run a pendulum in something like tar: it creeps."""
    effects = json.dumps([{'gravity': {'g': 9.81}}, {'drag': {'angular': 1e8, 'linear': 0.1}}])
    return followed(load_scene('kater_pendulum_from_p', [f'effects={effects}']), 100.0)


def spinning():
    """Run a top whose axis creeps while it spins."""
    return led_to(scene(body={'mass': 1.0, 'inertia': [0.02, 0.02, 0.01],
                              'center_of_mass': [0, 0, 0.2]},
                        effects=[{'gravity': {'g': 9.81}}, {'drag': {'linear': 1e6}}],
                        initial={'tilt': 0.5, 'spin': 30.0}), 1.0)


def skew():
    """Run a body whose arm is along none of its axes."""
    return followed(scene(body={'mass': 1.0, 'inertia': [0.02, 0.03, 0.04],
                                'center_of_mass': [0.1, 0.05, 0.2]},
                          effects=[{'gravity': {'g': 9.81}}, {'drag': {'linear': 1e8}}],
                          initial={'tilt': 0.5, 'spin': 3.0}), 1.0)


def driven():
    """Run a driven body that reaches its last rate at once."""
    return led_to(scene('free', body={'mass': 1.0, 'inertia': [0.02, 0.03, 1.5e-2]},
                        effects=[{'drag': {'angular': 1e5}},
                                 {'torque': {'value': [0.1, 0.2, 0.3]}}],
                        initial={'angular_velocity': [1, 2, 3]}), 1.0)


def needle():
    """Run a body with drag whose third moment is 1e-100."""
    return led_to(scene('free', body={'mass': 1.0, 'inertia': [0.02, 0.02, 1e-100]},
                        effects=[{'drag': {'angular': 0.001}}],
                        initial={'angular_velocity': [1, 2, 3]}), 0.1)


def departures():
    """Run the bodies of departures.json at two accuracies, or those of `make test` at one each."""
    found = {}
    for place, (name, case) in enumerate(DEPARTURES.items()):
        body = scene('free', body={'mass': 1.0, 'inertia': case['moments']},
                     effects=[{'internal_dissipation': {'coefficient': case['coefficient']}}],
                     initial={'angular_velocity': case['angular_velocity']})
        for accuracy in ACCURACIES if SOAK else [ACCURACIES[place % len(ACCURACIES)]]:
            simulation = Simulation(body, accuracy=accuracy, horizon=case['time'])
            state = simulation.states([case['time']]).vector[0]
            found[f'{name} {accuracy}'] = {
                'expected': simulation.choice.expected_error,
                'error': 2.0 * np.linalg.norm(state[1:5] - case['orientation_after']),
                'rate': np.abs(state[5:8] - case['angular_velocity_after']).max()}
    return found


if __name__ == '__main__':
    print(json.dumps({name: globals()[name]() for name in sys.argv[1:]}))
