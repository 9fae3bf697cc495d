# SPDX-License-Identifier: Apache-2.0
"""Scenes outside the table by which `auto` chooses: text, and duration (s) of the accuracy."""

CASES = {
    'slow_top': ('{mass: 0.8, inertia: [0.05, 0.04, 0.03], inertia_about: origin, center_of_mass: '
                 '[0.0, 0.01, 0.08]}',
                 'pivot', '[gravity: {g: 9.81}]',
                 '{euler_zyz: [0.4, 1.0, 0.1], angular_velocity: [1.0, 2.0, 25.0]}', 20.0),
    'fast_top': ('{mass: 0.5, inertia: [0.002, 0.0025, 0.0012], inertia_about: origin, '
                 'center_of_mass: [0.001, 0.002, 0.03]}',
                 'pivot', '[gravity: {g: 9.81}]',
                 '{euler_zyz: [0.0, 0.3, 0.0], angular_velocity: [0.5, 0.0, 180.0]}', 5.0),
    'driven_from_outside': ('{mass: 1.0, inertia: [0.8, 1.5, 2.0]}', 'free',
                            '[torque: {value: [0.2, 0.1, -0.3], frame: world}]',
                            '{angular_velocity: [1.0, 0.5, -0.7]}', 30.0),
    'tumbling_with_drag': (
        '{mass: 1.0, inertia: [2.0, 1.1, 1.6]}', 'free', '[drag: {angular: 0.05}]',
        '{angular_velocity: [3.0, -1.0, 2.0]}', 40.0),
    'top_with_drag': ('{mass: 1.0, inertia: [0.04, 0.03, 0.02], inertia_about: origin, '
                      'center_of_mass: [0.0, 0.02, 0.09]}',
                      'pivot', '[gravity: {g: 9.81}, drag: {linear: 0.2, angular: 0.001}]',
                      '{euler_zyz: [0.1, 0.6, 0.0], angular_velocity: [1, 0, 50]}', 10.0),
    'driven_hinge': (
        '{mass: 1.0, inertia: [0.3, 0.2, 0.1], center_of_mass: [0.1, 0.0, -0.3]}',
        '{hinge: {axis: [1, 2, 0.5]}}', '[gravity: {g: 9.81}, torque: {value: [0.5, 1.0, 0.2]}]',
        '{angle: 0.5, rate: 2.0}', 20.0)}
ACCURACIES = (1e-3, 1e-6, 1e-9, 1e-12)


def text(name):
    """Return the scene text of a case."""
    body, constraint, effects, initial, _ = CASES[name]
    return (f'scene: {name}\nbody: {body}\nconstraint: {constraint}\neffects: {effects}\n'
            f'initial: {initial}\n')
