# SPDX-License-Identifier: Apache-2.0
"""Run scenes of the scene language without numba: a second each, where compiling takes ten.

From the source tree, ``NUMBA_DISABLE_JIT=1 PYTHONPATH=.:test python
test/scene/language_cases.py`` prints JSON: case -> state (14 numbers) and ledger at its time.
"""

import json

from soak import SOAK

from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.simulation.simulation import Simulation

SKEW = '{mass: 1.3, inertia: [0.05, 0.08, 0.11], center_of_mass: [0.02, -0.03, 0.1]}'
DISK = '{mass: 2.0, inertia: [0.3, 0.3, 0.5]}'
DRAGGED = ('{linear: [[0.5, 0.1, 0], [0.1, 0.3, 0], [0, 0, 0.7]], '
           'angular: [[0.05, 0.01, 0], [0.01, 0.03, 0], [0, 0, 0.07]], '
           'quadratic: [[0.5, 0.1, 0], [0.1, 0.3, 0], [0, 0, 0.7]], angular_quadratic: 0.02}')
SATELLITE = '{mass: 1, inertia: [0.2, 0.3, 0.4]}'
TURNING = '{orientation: [0.1, -0.4, 0.2, 0.888], angular_velocity: [1, -2, 3]}'

# case: body, constraint, parameters, effects, initial, time (s)
CASES = {
    # what has a closed form
    'torque of time': (
        DISK, 'free', 'Gamma: 0.1, w0: 12.0', "torque: {value: [0, 0, 'Gamma*sin(w0*t)']}",
        '{spin: 3.0}', 2.0),
    'torque of the world': (
        DISK, 'free', 'Gamma: 0.1', "torque: {value: [0, 0, 'Gamma*exp(-t)'], frame: world}",
        '{spin: 3.0}', 2.0),
    'drag of a disk by the square': (
        DISK, 'free', 'k: 0.7', "torque: {value: [0, 0, '-k*wz*abs(wz)'], books: heat}",
        '{spin: 3.0}', 2.0),
    'fall with drag by the square': (
        DISK, 'free', 'c: 0.7',
        "gravity: {g: 9.81}}, {force: {value: [0, 0, '-c*vz*abs(vz)'], frame: world, books: heat}",
        '{}', 3.0),
    'on a spring': (
        DISK, 'free', '', 'spring: {at: [0, 0, 0], anchor: [0, 0, 1], stiffness: 50}',
        '{velocity: [0.5, 0, 0]}', 2.0),
    'on a damped spring': (
        DISK, 'free', '',
        'spring: {at: [0, 0, 0], anchor: [0, 0, 1], stiffness: 50, damping: 3}',
        '{position: [0, 0, 1], velocity: [0.5, 0, 0]}', 2.0),
    'spring of a length': (
        DISK, 'free', '',
        'spring: {at: [0, 0, 0], anchor: [0, 0, 0], stiffness: 50, length: 0.4, damping: 3}',
        '{position: [0, 0, 0.5]}', 2.0),
    'in a well': (
        DISK, 'free', 'k: 50', "potential: {energy: '0.5*k*(x^2 + y^2 + (z - 1)^2)'}",
        '{velocity: [0.5, 0, 0]}', 2.0),
    'compass needle': (
        '{mass: 1, inertia: [0.3, 0.3, 0.5]}', 'pivot', '',
        'magnetic: {moment: [2, 0, 0], field: [0.5, 0, 0]}',
        '{rotation_vector: [0, 0, 1.0e-4]}', 2.0),
    'satellite': (
        '{mass: 1, inertia: [0.2, 0.3, 0.4]}', 'free', '',
        'gravity_gradient: {mu: 90, position: [0, 3, 0]}',
        '{rotation_vector: [0, 0, 1.5708963267948966]}', 2.0),    # 1e-4 rad beyond upright
    'force at a point': (
        DISK, 'free', '', 'force: {value: [0, 0.3, 0], at: [0.5, 0, 0]}', '{spin: 3.0}', 2.0),
    'fall by the key quadratic': (
        DISK, 'free', '', 'gravity: {g: 9.81}}, {drag: {quadratic: 0.7}', '{}', 3.0),
    'disk by the key angular_quadratic': (
        DISK, 'free', '', 'drag: {angular_quadratic: 0.7}', '{spin: 3.0}', 2.0),
    'drag by a matrix': (
        DISK, 'free', '', 'drag: {linear: [[3, 0, 0], [0, 1, 0], [0, 0, 1]], '
        'angular: [[0.1, 0, 0], [0, 0.2, 0], [0, 0, 0.3]]}', '{spin: 3.0}', 2.0),
    'thrown aslant': (DISK, 'free', '', 'gravity: {g: [1, 2, -3]}', '{velocity: [4, 0, 0]}', 2.0),
    'gyrostat': (DISK, 'free', '', 'rotor: {axis: [0, 0, 2], momentum: 0.4}',
                 '{angular_velocity: [0.3, 0.1, 1.5]}', 2.0),
    'reaction wheel': (
        DISK, 'free', '', 'rotor: {axis: [0, 0, 1], inertia: 0.01, rate: 30, torque: 0.1}',
        '{angular_velocity: [0.3, 0.1, 1.5]}', 2.0),
    'torsion spring': (
        DISK, '{hinge: {axis: [0, 0, 2]}}', '', 'spring: {stiffness: 50, angle: 0.4, damping: 3}',
        '{orientation: [0, 0, 1, 1], angle: 0.5}', 0.2),
    'torque of time on a hinge': (
        DISK, '{hinge: {axis: [0, 0, 1]}}', 'Gamma: 0.1, w0: 12.0',
        "torque: {value: [0, 0, 'Gamma*sin(w0*t)']}", '{rate: 3.0}', 2.0),
    # what has none: the ledger balances, potential and force fit together
    'body axes': (SKEW, 'free', 'k: 0.02, w0: 12.0',
                  "torque: {value: ['-k*wx', 0, '0.1*sin(w0*t)']}", TURNING, 0.5),
    'pivoted, body axes': (SKEW, 'pivot', 'k: 0.02, w0: 12.0',
                           "torque: {value: ['-k*wx', 0, '0.1*sin(w0*t)']}", TURNING, 0.5),
    'potential of place and attitude': (
        SKEW, 'free', 'k: 0.7', "potential: {energy: '0.5*k*(z - 1)^2 + 0.1*qx*qw*x'}", TURNING,
        0.5),
    'potential at a pivot': (SKEW, 'pivot', '', "potential: {energy: '0.3*qx*qw*qz^2'}", TURNING,
                             0.5),
    'push of the world': (SKEW, 'pivot', '', "force: {value: [0, 0.2, '3*cos(t)'], "
                          'at: [0.1, 0, 0], frame: world}', TURNING, 0.5),
    'spring off the middle': (
        SKEW, 'free', '', 'spring: {at: [0.1, 0, 0], anchor: [0, 0, 1], stiffness: 4.0, '
        'damping: 0.1, length: 0.2}', TURNING, 0.5),
    'field that turns': (SKEW, 'free', '', "magnetic: {moment: [0, 0.1, 1.2], "
                         "field: ['cos(3*t)', 'sin(3*t)', '0.4 - 0.1*z*t']}", TURNING, 0.5),
    # a needle along the field follows it as it turns
    'synchronous needle': (
        '{mass: 1, inertia: [0.3, 0.3, 0.5]}', '{hinge: {axis: [0, 0, 1]}}', 'w: 1.3',
        "magnetic: {moment: [2, 0, 0], field: ['0.5*cos(w*t)', '0.5*sin(w*t)', 0]}",
        '{rate: 1.3}', 1.0),
    'uneven field': (SKEW, 'free', '', "magnetic: {moment: [0, 0.1, 1.2], "
                     "field: ['0.1*x', 0.2, '0.4 - 0.1*z']}", TURNING, 0.5),
    'at a hinge': (SKEW, '{hinge: {axis: [1, 2, 0.5]}}', 'k: 0.1',
                   "gravity: {g: 9.81}}, {torque: {value: ['-k*wx^3', 0, 0], books: heat}}, "
                   "{potential: {energy: '0.2*qx^2'}", '{angle: 1.0, rate: 2.0}', 0.5),
    'top in a world that is turned': (
        SKEW, 'pivot', '', 'gravity: {g: [0, -9.81, 0]}', '{rotation_vector: '
        '[-1.5707963267948966, 0, 0], angular_velocity: [1, -2, 3]}', 0.5),
    'the same upright': (SKEW, 'pivot', '', 'gravity: {g: 9.81}',
                         '{angular_velocity: [1, -2, 3]}', 0.5),
    'held off its origin': (
        SKEW, '{pivot: {at: [-0.1, -0.2, 0.1]}}', '', 'gravity: {g: 9.8}}, {drag: {linear: 0.1}',
        TURNING, 0.5),
    'the same with its origin there': (
        SKEW.replace('[0.02, -0.03, 0.1]', '[0.12, 0.17, 0.0]'), 'pivot', '',
        'gravity: {g: 9.8}}, {drag: {linear: 0.1}', TURNING, 0.5),
    'all of drag': (SKEW, 'free', '', f'drag: {DRAGGED}', TURNING, 0.5),
    'all of drag at a pivot': (SKEW, 'pivot', '', f'drag: {DRAGGED}', TURNING, 0.5),
    'all of drag at a hinge': (SKEW, '{hinge: {axis: [1, 2, 0.5]}}', '', f'drag: {DRAGGED}',
                               '{angle: 1.0, rate: 2.0}', 0.5),
    'gyrostat on a tip': (
        SKEW, 'pivot', '', 'gravity: {g: 9.81}}, {rotor: {axis: [1, 2, 3], momentum: 0.4}',
        TURNING, 0.5),
    'reaction wheels on a tip': (
        SKEW, 'pivot', '', 'gravity: {g: [0, 1, -9]}}, {rotor: {axis: [1, 2, 3], momentum: 0.4}}, '
        '{rotor: {axis: [1, 0, 0], inertia: 0.01, rate: 30, torque: 0.1}', TURNING, 0.5),
    'everything on a hinge': (
        SKEW, '{hinge: {axis: [1, 2, 0.5]}}', '',
        "gravity: {g: 9.8}}, {torque: {value: ['0.1*sin(3*t)', '0.1*x', '-0.02*rate'], "
        "frame: world}}, {potential: {energy: '0.1*angle^2 + 0.03*x*y'}}, {spring: {at: "
        '[0.1, 0.2, 0.3], anchor: [1, 0, 0], stiffness: 2, length: 0.3, damping: 0.1}',
        '{orientation: [0.1, -0.4, 0.2, 0.888], angle: 1.0, rate: 2.0}', 0.5),
    # 34 digits of both: test/data/make_language.py
    'mixed, free': (
        SKEW, 'free', '', 'gravity: {g: 9.81}}, {spring: {at: [0.1, 0, 0.3], anchor: [0, 0, 1], '
        'stiffness: 4, damping: 0.1, length: 0.2}}, {drag: {linear: 0.1, angular: 0.01}}, '
        "{torque: {value: ['-0.1*wx^3', '0.02*sin(3*t)*qx', '0.01*tanh(Wz)'], books: heat}",
        TURNING, 1.0),
    'mixed, on a moving pivot': (
        SKEW, "{pivot: {motion: ['0.3*sin(2*t)', 0, '0.05*cos(20*t)'], at: [0.1, 0.02, -0.05]}}",
        '', "gravity: {g: [1, 2, -9.8]}}, {magnetic: {moment: [0, 0.1, 0.5], "
        "field: [0.2, '0.1*x', 0.3]}}, {torque: {value: ['-0.02*wx', 0, 0], books: heat}}, "
        '{rotor: {axis: [1, 2, 3], momentum: 0.1}', TURNING, 1.0),
    # small deviations about three axes at once
    'attitude under control': (
        '{mass: 1, inertia: [0.2, 0.3, 0.4]}', 'free', 'p: 5.0, d: 0.4',
        "torque: {value: ['-2*p*qw*qx - d*wx', '-2*p*qw*qy - d*wy', '-2*p*qw*qz - d*wz'], "
        'books: heat}', '{rotation_vector: [1.0e-6, -2.0e-6, 1.5e-6]}', 0.7),
    'on a circular orbit': (
        SATELLITE, 'free', '',
        'gravity_gradient: {orbit: {rate: 1.0, normal: [0, 0, 1], toward: [1, 0, 0]}}',
        '{rotation_vector: [0.3, 0.2, -0.1], angular_velocity: [0.1, -0.2, 1.1]}', 1.0),
    # the pivot moves: seen from it, -M a acts at the centre of mass
    'on a moving pivot': (
        SKEW, "{pivot: {motion: ['0.3*sin(2*t)', 0, 'A*cos(w*t)'], at: [0.1, 0.02, -0.05]}}",
        'A: 0.05, w: 20.0', 'gravity: {g: 9.81}', TURNING, 0.5),
    'the same in its own axes': (
        SKEW, '{pivot: {at: [0.1, 0.02, -0.05]}}', 'A: 0.05, w: 20.0',
        "gravity: {g: 9.81}}, {force: {value: ['1.3*1.2*sin(2*t)', 0, '1.3*A*w^2*cos(w*t)'], "
        'frame: world}', TURNING, 0.5),
    'in a lift': (
        SKEW, "{pivot: {motion: [0, 0, '1.5*t^2']}}", '', 'gravity: {g: 9.81}', TURNING, 0.5),
    'under more weight': (SKEW, 'pivot', '', 'gravity: {g: 12.81}', TURNING, 0.5),
    'all on a moving pivot': (
        SKEW, "{pivot: {motion: ['0.3*sin(2*t)', '0.1*t^2', '0.05*cos(20*t)'], "
        'at: [0.1, 0.02, -0.05]}}', '', "gravity: {g: [1, 2, -9.8]}}, {drag: {linear: 0.7, "
        'quadratic: 0.3, angular: 0.01}}, {spring: {at: [0.1, 0.2, 0.3], anchor: [1, 0, 0], '
        "stiffness: 2, length: 0.3, damping: 0.1}}, {force: {value: ['sin(t)', x, '-vz'], "
        "at: [0.1, 0, 0], books: heat}}, {potential: {energy: '0.1*qx*y + x*z'}}, "
        '{rotor: {axis: [1, 2, 3], momentum: 0.1}', TURNING, 0.5),
    'heat at a pivot': (SKEW, 'pivot', '', 'gravity: {g: 9.81}}, {internal_dissipation: '
                        '{coefficient: 0.5}', TURNING, 1.0),
    'heat in a field': (SKEW, 'free', '', 'magnetic: {moment: [1, 2, 3], field: [0.3, 0.1, 0.2]}},'
                        ' {internal_dissipation: {coefficient: 0.5}', TURNING, 0.5),
    'four at once': (
        SKEW, 'free', '', 'gravity: {g: 9.81}}, {spring: {at: [0.1, 0, 0.3], anchor: [0, 0, 1], '
        'stiffness: 4.0}}, {drag: {linear: 0.1, angular: 0.01}}, '
        "{torque: {value: ['-0.1*wx^3', 0, '0.01*tanh(Wz)'], books: heat}", TURNING, 0.5),
}


def text(name):
    """Return the scene of a case."""
    body, constraint, parameters, effects, initial, _ = CASES[name]
    return (f'scene: case\nparameters: {{{parameters}}}\nbody: {body}\nconstraint: {constraint}\n'
            f'effects: [{{{effects}}}]\ninitial: {initial}\n')


def run(name, method='dop8'):
    """Return the state (14 numbers), its acceleration and the ledger of a case at its time."""
    simulation = Simulation(parse_scene(text(name)), method, accuracy=1e-13,
                            rate=1.0 / CASES[name][-1])
    simulation.advance()
    return {'state': simulation.vector.tolist(), 'ledger': simulation.ledger()}


LIKE_OTHERS = ('pivoted, body axes', 'potential at a pivot', 'uneven field',
               'all of drag at a pivot', 'at a hinge', 'gyrostat on a tip', 'heat at a pivot',
               'four at once')
"""What only the soak runs: other cases have the effects, and the constraints."""
# driven at 20 rad/s
DRIVEN = 'mixed, on a moving pivot', 'on a moving pivot', 'the same in its own axes'
BY_TWO = 'all of drag', 'mixed, free', *DRIVEN
BY_SERIES = ('top in a world that is turned', 'potential of place and attitude',
             'attitude under control', 'torsion spring')
if SOAK:    # sixteen seconds of plain Python
    BY_TWO += ('four at once', 'body axes', 'reaction wheels on a tip', 'everything on a hinge',
               'heat at a pivot')
    # none with the angle of a hinge in a force: it jumps, and taylor stops at no kink
    BY_SERIES += ('body axes', 'pivoted, body axes', 'gyrostat on a tip', 'uneven field',
                  'mixed, free')

if __name__ == '__main__':
    print(json.dumps({name: run(name) for name in CASES if SOAK or name not in LIKE_OTHERS}
                     | {f'{name} by gauss16': run(name, 'gauss16')
                        for name in BY_TWO} | {f'{name} by taylor': run(name, 'taylor')
                                               for name in BY_SERIES}))
