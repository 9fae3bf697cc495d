# SPDX-License-Identifier: Apache-2.0
"""The smooth scenes of test/integrators: scene text, held wrench or None, times (s).

A wrench is (force, torque, frame).
"""

TOP = (
    '{mass: 1.0, inertia: [0.03, 0.02, 0.01], inertia_about: origin, center_of_mass: [0, 0, 0.1]}')
SKEW = ('{mass: 2.0, inertia: [[0.05, 0.004, -0.002], [0.004, 0.06, 0.003], [-0.002, 0.003, '
        '0.03]], center_of_mass: [0.02, -0.01, 0.1]}')
BOX = '{mass: 1.5, inertia: [1.0, 2.0, 2.5], center_of_mass: [0.1, 0.2, -0.1]}'

CASES = {
    'asymmetric_heavy_top': (
        TOP, 'pivot', '[gravity: {g: 9.81}]',
        '{euler_zyz: [0.0, 0.5, 0.0], angular_velocity: [0, 0, 60]}', None, [0.05, 1.0, 2.0]),
    'skew_heavy_top': (
        SKEW, 'pivot', '[gravity: {g: 9.81}]',
        '{euler_zyz: [0.3, 1.2, 0.4], angular_velocity: [3, -2, 20]}', None, [0.1, 2.0]),
    'driven_body': (
        '{mass: 1.0, inertia: [1.0, 2.0, 3.0]}', 'free', '[torque: {value: [0.3, -0.2, 0.5]}]',
        '{angular_velocity: [0.1, 2.0, 0.3]}', None, [1.0, 10.0]),
    'driven_from_rest': ('{mass: 1.0, inertia: [1.0, 2.0, 3.0]}', 'free',
                         '[torque: {value: [0.3, -0.2, 0.5]}]', '{}', None, [1e-3, 3.0]),
    'driven_in_pieces': (BOX, 'free',
                         '[torque: {times: [0.5, 1.25, 2.5], values: [[1, 0, 0.5], [0, -3, 0], '
                         '[0, 0, 0]], frame: world}, '
                         'torque: {value: [0.1, 0, 0]}]',
                         '{angular_velocity: [0.4, 3.0, 0.2]}', None, [0.25, 1.0, 2.0, 4.0]),
    'thrown_with_drag': (BOX, 'free', '[gravity: {g: 9.81}, drag: {linear: 0.7, angular: 0.4}]',
                         '{angular_velocity: [1, 2, 3], position: [0, 0, 2], velocity: [5, 0, 4]}',
                         None, [0.3, 3.0]),
    'damped_top': (SKEW, 'pivot', '[gravity: {g: 9.81}, drag: {linear: 0.5, angular: 0.01}]',
                   '{tilt: 0.7, spin: 25.0}', None, [0.1, 2.0]),
    'major_axis_relaxation': ('{mass: 1.0, inertia: [1.0, 2.0, 3.0]}', 'free',
                              '[internal_dissipation: {coefficient: 0.05}]',
                              '{angular_velocity: [2.0, 0.1, 0.2]}', None, [1.0, 10.0]),
    'held_free_body': (
        BOX, 'free', '[]', '{angular_velocity: [0.4, 3.0, 0.2], velocity: [1, 0, 0]}',
        ([2.0, 1.0, -1.0], [0.5, -1.0, 2.0], 'body'), [0.1, 3.0]),
    'held_free_body_world': (
        BOX, 'free', '[]', '{angular_velocity: [0.4, 3.0, 0.2], velocity: [1, 0, 0]}',
        ([2.0, 1.0, -1.0], [0.5, -1.0, 2.0], 'world'), [0.1, 3.0]),
    'held_from_rest': ('{mass: 1.0, inertia: [1.0, 2.0, 3.0]}', 'free', '[]', '{}',
                       ([0.0, 0.0, 2.0], [0.0, 0.0, 0.0], 'world'), [1e-3, 1.0]),
    'held_top': (SKEW, 'pivot', '[gravity: {g: 9.81}]', '{tilt: 0.7, spin: 25.0}',
                 ([3.0, -1.0, 2.0], [0.02, 0.05, 0.1], 'world'), [0.1, 1.5]),
    'held_top_body': (SKEW, 'pivot', '[gravity: {g: 9.81}]', '{tilt: 0.7, spin: 25.0}',
                      ([3.0, -1.0, 2.0], [0.02, 0.05, 0.1], 'body'), [0.1, 1.5]),
    'held_needle': ('{mass: 1.0, inertia: [1.0, 1.0000000005, 1.0e-9]}', 'free', '[]',
                    '{angular_velocity: [1.0, 0.5, 200.0]}', ([0, 0, 0], [0.2, 0.1, 1e-8], 'body'),
                    [0.1, 1.0]),
    'held_thin_rod': ('{mass: 1.0, inertia: [0.02, 0.02, 0.0]}', 'free', '[]',
                      '{angular_velocity: [3.0, -1.0, 0.0]}',
                      ([0, 0, 0], [0.02, 0.05, 0.1], 'world'), [0.1, 3.0]),
    'held_fast_body': ('{mass: 1.0, inertia: [1.0, 1.2, 1.5]}', 'free', '[]',
                       '{angular_velocity: [1.0, 2.0, 400.0]}',
                       ([0, 0, 0], [30.0, 10.0, 5.0], 'world'), [0.01, 0.3]),
    'held_hinge': (SKEW, '{hinge: {axis: [1, 2, 0.5], through: [0.05, 0, -0.1]}}',
                   '[gravity: {g: 9.81}, drag: {linear: 0.3, angular: 0.02}]',
                   '{euler_zyz: [0.3, 1.2, 0.4], angle: 0.5, rate: 4.0, position: [1, 2, 3]}',
                   ([3.0, -1.0, 2.0], [0.2, 0.5, 0.1], 'world'), [0.1, 3.0]),
    'held_hinge_body': (
        SKEW, '{hinge: {axis: [1, 2, 0.5], through: [0.05, 0, -0.1]}}', '[gravity: {g: 9.81}]',
        '{euler_zyz: [0.3, 1.2, 0.4], angle: 0.5, rate: 14.0}',
        ([3.0, -1.0, 2.0], [0.2, 0.5, 0.1], 'body'), [0.1, 3.0])}


def text(name):
    """Return the scene text of a case."""
    body, constraint, effects, initial, _, _ = CASES[name]
    return (f'scene: {name}\nbody: {body}\nconstraint: {constraint}\neffects: {effects}\n'
            f'initial: {initial}\n')
