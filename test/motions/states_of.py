# SPDX-License-Identifier: Apache-2.0
"""The bits of some closed forms: run as a script it prints them, as hexadecimal numbers."""

import json

import numpy as np

from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.simulation.simulation import Simulation

HELD = ('{{scene: a, constraint: {}, effects: [{}], initial: {}, '
        'body: {{mass: 2, inertia: [0.5, 0.5, 0.25], center_of_mass: [0.1, 0.2, -0.3]}}}}')
HINGE = '{hinge: {axis: [0, 0, 1], through: [0.1, 0.2, 0]}}'
SCENES = {
    'torsion pendulum': HELD.format(
        HINGE, 'spring: {stiffness: 8, angle: 0.3, damping: 0.1}, torque: {value: [1, 0.2, 0.7]}',
        '{euler: [0.3, 0.7, -0.4], angle: 0.75, rate: 2}'),
    'overdamped torsion pendulum': HELD.format(
        HINGE, 'spring: {stiffness: 8, damping: 9}', '{angle: 0.75, rate: 2}'),
    'top held away from its origin': HELD.format(
        '{pivot: {at: [0.1, 0.2, -0.55]}}', 'gravity: {g: 9.81}',
        '{euler: [0.3, 0.7, -0.4], angular_velocity: [0.5, -1, 6], position: [1, -2, 3]}')}
TIMES = np.array([0.0, 1e-3, 0.4, 1.7, 2.5, 3.1, 7.7, 19.0, 40.0, 41.5])


def states():
    """Return the states of each scene, one by one and all at once, as hexadecimal numbers."""
    found = {}
    for name, text in SCENES.items():
        simulation = Simulation(parse_scene(text))
        assert simulation.choice.method == 'exact', name
        alone = [simulation.states([time]).vector[0] for time in TIMES]
        rows = np.concatenate([alone, simulation.states(TIMES).vector])
        found[name] = [number.hex() for number in rows.ravel().tolist()]
    return found


if __name__ == '__main__':
    print(json.dumps(states()))
