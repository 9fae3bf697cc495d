# SPDX-License-Identifier: Apache-2.0
"""Convex bodies on a plane for the tests of methods that have kernels of their own there."""

from rigid_body_sim.scene.scene import parse_scene

BODIES = {
    'egg': '{mass: 0.06, inertia: [3.0e-5, 3.4e-5, 2.0e-5], center_of_mass: [0.001, 0, -0.002], '
           'surface: {ellipsoid: {semi_axes: [0.022, 0.021, 0.03]}}}',
    'ball': '{mass: 0.1, inertia: [[3.0e-5, 2.0e-6, -1.0e-6], [2.0e-6, 3.4e-5, 3.0e-6], '
            '[-1.0e-6, 3.0e-6, 2.0e-5]], center_of_mass: [0.001, -0.002, -0.002], '
            'surface: {sphere: {radius: 0.03}}}',
    'ring': '{mass: 0.2, inertia: [3.0e-4, 3.0e-4, 5.0e-4], '
            'surface: {torus: {radius: 0.05, tube: 0.01}}}',
    'disk': '{mass: 0.2, shape: {disk: {radius: 0.05}}}'}
FALLING = ('{position: [0, 0, 0.08], euler_zyz: [0.3, 1.1, 0.2], velocity: [0.2, 0.1, -0.3], '
           'angular_velocity: [8, -5, 13]}')
LYING = '{euler_zyz: [0.3, 0.9, 0.2], velocity: [0.3, 0.1, 0], angular_velocity: [3, -5, 33]}'
ROUGH, IDEAL = 'sliding_friction: {mu: 0.2}', 'sliding_friction: {mu: .inf}'
HILL = '{table: {normal: [0.1, -0.05, 1.0], restitution: 0.6}}'
SLOPE = '{table: {normal: [0.1, -0.05, 1.0]}}'
VISCOUS, FILM = 'rolling_friction: {viscous: 0.01}', 'air_film: {viscosity: 0.03}'


def scene_of(body, effects=ROUGH, initial=LYING, table='table'):
    """Return a scene under gravity."""
    return parse_scene(f'scene: convex\nbody: {BODIES.get(body, body)}\nconstraint: {table}\n'
                       f'effects: [gravity: {{g: 9.81}}, {effects}]\ninitial: {initial}\n')
