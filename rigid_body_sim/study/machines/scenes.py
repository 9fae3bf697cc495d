# SPDX-License-Identifier: Apache-2.0
"""Scenes with features that those that ship lack: awkward bodies, skew axes, drag.

Each stands for an operation on the way from a scene's text to its numbers that once gave other
bits on another machine, or could: a dot product, an eigenvector, a parallel axis, a long lever.
"""

SKEW = """{mass: 2.0, center_of_mass: [0.02, -0.01, 0.1],
  inertia: [[0.05, 0.004, -0.002], [0.004, 0.06, 0.003], [-0.002, 0.003, 0.03]]}"""
COMPOSITE = """
  parts: [{mass: 0.1, shape: {cylinder: {radius: 0.02, length: 0.3}}, at: [0.0, 0.0, 0.1],
           orientation: [0.1, 0.2, 0.3, 0.9]},
          {mass: 0.2, shape: {solid_sphere: {radius: 0.03}}, at: [0.01, 0.2, 0.0]},
          {mass: 0.3, shape: {box: {size: [0.1, 0.2, 0.3]}}, at: [-0.1, 0.05, 0.07],
           orientation: [0.5, -0.3, 0.2, 0.7]}]"""
RODS = """
  parts: [{mass: 0.2, shape: {rod: {length: 0.7}}, orientation: [0.3, 0.1, -0.2, 0.9]},
          {mass: 0.2, shape: {rod: {length: 0.7}}, orientation: [0.3, 0.1, -0.2, 0.9]}]"""
SPHERES = """
  parts: [{mass: 0.3, shape: {solid_sphere: {radius: 0.11}}, at: [0.1, 0.2, 0.3]},
          {mass: 0.3, shape: {spherical_shell: {radius: 0.07}}, at: [-0.1, -0.2, -0.3]}]"""
NEEDLE = """{mass: 2.0, inertia_about: origin, center_of_mass: [0.06, -0.064, 0.048],
  inertia: [[0.0192000204, 0.01151999424, -0.00863999568],
            [0.01151999424, 0.017712015744, 0.009215988192],
            [-0.00863999568, 0.009215988192, 0.023088008856]]}"""
WEIGHT = '[gravity: {g: 9.81}]'
TABLE = '[sliding_friction: {mu: 0.213, g: 9.81}]'
BALL = '{mass: 0.17, shape: {solid_sphere: {radius: 0.028575}}}'

AWKWARD = {
    'skew_tensor': (SKEW, 'free', '[]', '{angular_velocity: [0.3, 5.0, -0.2]}'),
    'graded_tensor': (
        '{mass: 1.0, inertia: [[1.0, 1.0e-5, 3.0e-6], [1.0e-5, 1.0, 2.0e-6],'
        ' [3.0e-6, 2.0e-6, 1.0e-3]]}',
        'free', '[]', '{angular_velocity: [0.3, 0.1, 70.0]}'),
    'offset_centre': (
        '{mass: 1.3, inertia: [0.9, 1.1, 1.7], inertia_about: origin,'
        ' center_of_mass: [0.11, -0.23, 0.17]}',
        'free', WEIGHT, '{angular_velocity: [1, 2, 3], velocity: [0.1, 0.2, 3.0]}'),
    'composite': (COMPOSITE, 'free', '[]', '{angular_velocity: [0.3, 5.0, -0.2]}'),
    'composite_thrown': (
        COMPOSITE, 'free', WEIGHT,
        '{euler_zyz: [0.7, 1.9, -2.3], angular_velocity: [7, -3, 11], velocity: [3, -1, 5]}'),
    'two_rods': (RODS, 'free', '[]', '{angular_velocity: [0.5, 0.75, 0.54]}'),
    'two_spheres': (SPHERES, 'free', '[]', '{angular_velocity: [0.7, 0.5, -0.4]}'),
    'skew_symmetric': (
        '{mass: 1.0, inertia: [[1.3, 0.1, 0.2], [0.1, 1.15, 0.1], [0.2, 0.1, 1.3]]}',
        'free', '[]', '{angular_velocity: [2.0, -1.0, 0.5]}'),
    'racket_near_its_axis': (
        '{mass: 1.0, inertia: [1.0, 2.0, 3.0]}', 'free', '[]',
        '{orientation: [0.1, -0.7, 0.3, 0.5], angular_velocity: [1.0e-7, 13.0, 3.0e-8]}'),
    'top_from_tilt': (
        '{mass: 0.37, inertia: [0.03, 0.03, 0.01], inertia_about: origin,'
        ' center_of_mass: [0, 0, 0.083]}',
        'pivot', WEIGHT, '{tilt: 0.7, spin: 47.3}'),
    'skew_top': (
        SKEW, 'pivot', WEIGHT, '{euler_zyz: [0.3, 1.2, 0.4], angular_velocity: [3, -2, 20]}'),
    'skew_top_damped': (
        SKEW, 'pivot', '[gravity: {g: 9.81}, drag: {linear: 0.5, angular: 0.01}]',
        '{tilt: 0.7, spin: 25.0}'),
    'composite_top': (
        COMPOSITE, 'pivot', WEIGHT, '{euler_zyz: [0.3, 1.2, 0.4], angular_velocity: [3, -2, 9]}'),
    'skew_hinge': (
        SKEW, '{hinge: {axis: [1, 2, 0.5], through: [0.05, 0.03, -0.1]}}', WEIGHT,
        '{euler_zyz: [0.3, 1.2, 0.4], angle: 0.5, rate: 4.0, position: [1, 2, 3]}'),
    'skew_hinge_damped': (
        SKEW, '{hinge: {axis: [1, 2, 0.5], through: [0.05, 0.03, -0.1]}}',
        '[gravity: {g: 9.81}, drag: {linear: 0.3, angular: 0.02}]',
        '{euler_zyz: [0.3, 1.2, 0.4], angle: 0.5, rate: 4.0}'),
    'hinge_turning_over': (
        COMPOSITE, '{hinge: {axis: [0.3, -0.5, 0.8], distance: 0.31}}', WEIGHT,
        '{angle: 0.5, rate: 17.0}'),
    'thrown_with_drag': (
        SKEW, 'free', '[gravity: {g: 9.81}, drag: {linear: 0.7, angular: 0.04}]',
        '{angular_velocity: [1, 2, 3], position: [0, 0, 2], velocity: [5, 0, 4]}'),
    'driven_in_pieces': (
        SKEW, 'free',
        '[torque: {times: [0.1, 0.3], values: [[1, 0, 0.5], [0, -3, 0]], frame: world},'
        ' torque: {value: [0.1, 0, 0]}]', '{angular_velocity: [0.4, 3.0, 0.2]}'),
    'stiff_relaxation': (
        '{mass: 1.0, inertia: [1.0, 2.0, 3.0]}', 'free',
        '[internal_dissipation: {coefficient: 3.0}]', '{angular_velocity: [5.0, 0.1, 0.2]}'),
    'ball_with_side_spin': (
        BALL, 'table', TABLE,
        '{angular_velocity: [11.0, -37.0, 23.0], velocity: [1.7, 0.31, 0.0]}'),
    'ball_struck_twice': (
        BALL, 'table',
        '[strike: {speed: 1.5, height: 0.011}, sliding_friction: {mu: 0.2, g: 9.81},'
        ' strike: {impulse: [0.03, 0.11, 0], point: [-0.02, 0.013, 0.007], time: 0.2}]', '{}'),
    'struck_composite': (
        COMPOSITE, 'free',
        '[strike: {impulse: [0.3, -0.2, 0.5], point: [0.1, 0.2, -0.3], time: 0.25, frame: body}]',
        '{angular_velocity: [0.3, 2.0, -0.2]}'),
    'thrown_and_pushed': (
        SKEW, 'free',
        '[gravity: {g: 9.81}, force: {value: [0.3, 0.1, -0.7], at: [0.1, 0.2, 0.05]}]',
        '{angular_velocity: [1, 2, 3], velocity: [5, 0, 4]}'),
    'skew_needle': (
        NEEDLE, 'pivot', WEIGHT,
        '{orientation: [0.1, 0.5, -0.2, 0.8], angular_velocity: [3.0, -7.0, 4.0]}'),
    'struck_needle': (
        NEEDLE, 'pivot',
        '[gravity: {g: 9.81},'
        ' strike: {impulse: [3.0e-5, -2.0e-5, 5.0e-5], point: [0.01, 0.02, 0.05], time: 0.1}]',
        '{orientation: [0.1, 0.5, -0.2, 0.8], angular_velocity: [3.0, -7.0, 4.0]}'),
}
"""Body, constraint, effects and initial conditions by name."""


def text(name):
    """Return the text of an awkward scene."""
    body, constraint, effects, initial = AWKWARD[name]
    return (f'scene: {name}\nbody: {body}\nconstraint: {constraint}\neffects: {effects}\n'
            f'initial: {initial}\n')
