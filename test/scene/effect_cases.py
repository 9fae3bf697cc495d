# SPDX-License-Identifier: Apache-2.0
"""One small scene for each effect of the table, and what `--set` changes in it.

A new effect fails test_every_effect.py until it stands here.
"""

SKEW = '{mass: 1.3, inertia: [0.05, 0.08, 0.11], center_of_mass: [0.02, -0.03, 0.1]}'
EGG = '{mass: 0.6, shape: {ellipsoid: {semi_axes: [0.03, 0.02, 0.025]}}}'
COIN = '{mass: 0.4, shape: {disk: {radius: 0.04}}}'
BALL = '{mass: 0.17, shape: {solid_sphere: {radius: 0.028}}}'
TURNING = '{orientation: [0.1, -0.4, 0.2, 0.888], angular_velocity: [1, -2, 3]}'
LYING = '{orientation: [0.1, -0.4, 0.2, 0.888], angular_velocity: [1, -2, 8]}'
ROLLS = '{tilt: 1.2, angular_velocity: [1, 0, 12], rolling: true}'
HINGE = '{hinge: {axis: [1, 2, 0.5]}}'
SWINGS = '{angle: 1.0, rate: 2.0}'
PLANE = '{table: {normal: [0, 0.1, 1]}}'
HEAVY = 'gravity: {g: 9.81}}, {sliding_friction: {mu: 0.3}'

# effect: scenes with it, each of body, constraint, effects, initial, override
CASES = {
    'gravity': ((SKEW, 'pivot', 'gravity: {g: 9.81}', TURNING, 'gravity.g=1.6'),
                (SKEW, HINGE, 'gravity: {g: [1, 2, -9]}', SWINGS, 'gravity.g.0=3'),
                (SKEW, "{pivot: {motion: [0, 0, 'A*cos(9*t)']}}", 'gravity: {g: 9.81}', TURNING,
                 'parameters.A=0.2')),
    'torque': ((SKEW, 'free', "torque: {value: ['-A*wx', 0, '0.1*sin(3*t)']}", TURNING,
                'parameters.A=0.2'),
               (SKEW, 'pivot', 'torque: {times: [0, 0.01], values: [[1, 0, 0], [0, 1, 0]]}',
                TURNING, 'torque.values.0.0=2'),
               (EGG, PLANE, f'{HEAVY}}}, {{torque: {{value: [0, 0, 0.01]}}', LYING,
                'torque.value.2=0.02')),
    'force': ((SKEW, 'free', "force: {value: [A, 0, '0.1*sin(3*t)'], at: [0.1, 0, 0]}", TURNING,
               'force.at.0=0.2'),
              (SKEW, HINGE, 'force: {value: [1, 0, 2], frame: world}', SWINGS,
               'force.value.0=3')),
    'potential': ((SKEW, 'free', "potential: {energy: '0.5*A*(z - 1)^2 + 0.1*qx*qw'}", TURNING,
                   'parameters.A=0.2'),
                  (SKEW, HINGE, "potential: {energy: '0.1*angle^2'}", SWINGS,
                   'potential.energy=0.3*angle^2')),
    'strike': ((SKEW, 'free', 'strike: {impulse: [0.1, 0, 0.3], point: [0, 0.1, 0], time: 0.015}',
                TURNING, 'strike.impulse.0=0.5'),
               (BALL, 'table', 'sliding_friction: {mu: 0.2, g: 9.81}}, {strike: {speed: 1, '
                'height: 0.02}', '{}', 'strike.speed=2')),
    'sliding_friction': ((BALL, 'table', 'sliding_friction: {mu: 0.2, g: 9.81}',
                          '{velocity: [1, 0, 0]}', 'sliding_friction.mu=0.3'),
                         (EGG, PLANE, HEAVY, LYING, 'sliding_friction.mu=0.1')),
    'rolling_friction': ((EGG, 'table', f'{HEAVY}}}, {{rolling_friction: {{viscous: 0.1}}',
                          LYING, 'rolling_friction.viscous=0.2'),),
    'spinning_friction': ((EGG, 'table', f'{HEAVY}}}, {{spinning_friction: {{radius: 0.001}}',
                           LYING, 'spinning_friction.radius=0.002'),),
    'air_film': ((COIN, 'table', f'{HEAVY}}}, {{air_film: {{viscosity: 1.8e-5}}', ROLLS,
                  'air_film.viscosity=1.0e-3'),),
    'internal_dissipation': ((SKEW, 'free', 'internal_dissipation: {coefficient: 0.5}', TURNING,
                              'internal_dissipation.coefficient=1'),
                             (SKEW, 'pivot', 'gravity: {g: 9.81}}, {internal_dissipation: '
                              '{coefficient: 0.5}', TURNING,
                              'internal_dissipation.coefficient=1')),
    'drag': ((SKEW, 'free', 'drag: {linear: 0.3, angular: 0.01}', TURNING, 'drag.linear=0.5'),
             (SKEW, 'pivot', 'drag: {quadratic: 0.3, angular: [[0.01, 0, 0], [0, 0.02, 0], '
              '[0, 0, 0.03]]}', TURNING, 'drag.quadratic=0.5')),
    'spring': ((SKEW, 'free', 'spring: {at: [0.1, 0, 0], anchor: [0, 0, 1], stiffness: 4, '
                'damping: 0.1, length: 0.2}', TURNING, 'spring.stiffness=5'),
               (SKEW, HINGE, 'spring: {stiffness: 2, angle: 0.3, damping: 0.1}', SWINGS,
                'spring.angle=0.1')),
    'magnetic': ((SKEW, 'pivot', 'magnetic: {moment: [0, 0.1, 1.2], field: [0.3, 0, 0.4]}',
                  TURNING, 'magnetic.moment.0=2'),
                 (SKEW, 'free', "magnetic: {moment: [0, 0.1, 1.2], field: ['A*x', 0, 0.4]}",
                  TURNING, 'magnetic.moment.0=2')),
    'gravity_gradient': ((SKEW, 'free', 'gravity_gradient: {mu: 90, position: [0, 3, 0]}',
                          TURNING, 'gravity_gradient.mu=20'),
                         (SKEW, 'free', 'gravity_gradient: {orbit: {rate: 2, normal: [0, 0, 1], '
                          'toward: [1, 0, 0]}}', TURNING, 'gravity_gradient.orbit.rate=3')),
    'rotor': ((SKEW, 'free', 'rotor: {axis: [1, 2, 3], momentum: 0.4}', TURNING,
               'rotor.momentum=0.2'),
              (SKEW, HINGE, 'rotor: {axis: [1, 2, 3], inertia: 0.01, rate: 30, torque: 0.1}',
               SWINGS, 'rotor.torque=0.5')),
    'dry_friction': ((SKEW, HINGE, 'gravity: {g: 9.81}}, {dry_friction: {torque: 0.02}', SWINGS,
                      'dry_friction.torque=0.1'),),
}
ALL = [(name, number) for name, cases in CASES.items() for number in range(len(cases))]


def text(name, number):
    """Return the scene of a case."""
    body, constraint, effects, initial, _ = CASES[name][number]
    return (f'scene: {name}_{number}\nparameters: {{A: 0.1}}\nbody: {body}\n'
            f'constraint: {constraint}\neffects: [{{{effects}}}]\ninitial: {initial}\n')


def override(name, number):
    """Return the override of a case."""
    return CASES[name][number][-1]
