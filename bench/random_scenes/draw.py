# SPDX-License-Identifier: Apache-2.0
"""Random scenes of the whole scene language: YAML text and duration by seed and number."""

import json
import re

import numpy as np

from random_scenes.chance import Chance

TURNS = 60.0             # rad/s times s, at most: the truth takes a second for each hundred
KINKED_TURNS = 4.0       # with kinks, which are located for each copy of the start
CONSTRAINTS = 'free', 'pivot', 'hinge', 'table'


def drawn(number, seed):
    """Return (YAML text, duration in s) of a random scene."""
    chance = Chance(f'{seed} {number}')
    between, vector = chance.between, chance.vector
    constraint = chance.choices(CONSTRAINTS, (4, 4, 2, 1))[0]
    mass, size = between(0.01, 10.0), between(0.02, 2.0)
    if constraint == 'table':
        return _ball(chance, between, mass, 0.1 * size)
    shape = chance.choice(('any', 'any', 'slim', 'flat', 'near', 'symmetric'))
    a, b, c = {'any': [chance.uniform(0.1, 1.0) for _ in range(3)],
               'slim': (lambda c: [1.0, 1.0 + 0.9 * c * chance.random(), c])(between(1e-6, 0.1)),
               'flat': [1.0, chance.uniform(0.3, 1.0), between(1e-6, 1e-2)],
               'near': [0.7, 0.7 * (1.0 + between(1e-15, 1e-3)), 0.4],
               'symmetric': [0.5, 0.5, chance.uniform(0.1, 0.9)]}[shape]
    if shape in ('any', 'flat'):    # semi-axes of an ellipsoid
        a, b, c = b * b + c * c, a * a + c * c, a * a + b * b
    inertia = [mass * size * size * x for x in (a, b, c)]
    spin = between(0.1, 40.0)
    duration = round(min(between(0.5, 60.0), TURNS / spin), 3)
    least, effects = min(inertia), []
    place = [0.0, 0.0, size * chance.uniform(0.1, 1.0)]
    if shape not in ('symmetric', 'near') or chance.random() < 0.3:
        place = vector(size * chance.uniform(0.1, 0.8))
    if constraint == 'free':
        place = chance.choice(([0.0, 0.0, 0.0], place))
    g = chance.choice((9.81, 1.62, 3.7))
    if chance.random() < 0.7:
        effects.append(f'gravity: {{g: {g}}}')
    for _ in range(chance.choice((0, 0, 0, 1, 1, 2))):
        torque, frame = vector(least * between(0.01, 3.0)), chance.choice(('body', 'world'))
        if chance.random() < 0.3:
            times = sorted(chance.uniform(0.0, duration) for _ in range(2))
            effects.append(f'torque: {{times: {times}, values: [{torque}, '
                           f'{vector(least)}], frame: {frame}}}')
        else:
            effects.append(f'torque: {{value: {torque}, frame: {frame}}}')
    if chance.random() < 0.3:
        effects.append(f'drag: {{linear: {mass * between(1e-3, 0.3)!r}, '
                       f'angular: {least * between(1e-3, 0.3)!r}}}')
    if constraint == 'free' and chance.random() < 0.15:
        largest = spin * max(inertia)
        effects.append(f'internal_dissipation: {{coefficient: {between(0.01, 1.0) / largest!r}}}')
    parameters = {'k': chance.uniform(0.2, 2.0), 'w0': spin * chance.uniform(0.2, 2.0),
                  's': size, 'f': mass * size * spin * spin * between(1e-3, 0.1),
                  'T': least * spin * spin * between(1e-3, 0.1)}
    if chance.random() < 0.5:
        effects += _fields(chance, between, vector, constraint, parameters)
    for _ in range(chance.choice((0, 0, 0, 1, 1, 2))):
        point = [x + y for x, y in zip(place, vector(0.3 * size), strict=True)]
        impulse = vector(least / size * spin * chance.uniform(0.1, 2.0))
        effects.append(f'strike: {{impulse: {impulse}, point: {point}, '
                       f'time: {chance.uniform(0.0, duration)!r}, '
                       f'frame: {chance.choice(("body", "world"))}}}')
    more = Chance(f'{seed} {number} more')
    if more.random() < 0.4:
        slim = shape in ('slim', 'flat')    # too fast to be followed from kink to kink
        duration = _more(more, effects, constraint, parameters, (least, mass, slim),
                         (spin, duration))
    angles = [chance.uniform(0.05, 3.0) for _ in range(3)]
    held, initial = constraint, _start(chance, vector, constraint, angles, spin, inertia)
    if constraint == 'hinge':
        held = f'{{hinge: {{axis: {vector(1.0)}, through: {vector(0.2 * size)}}}}}'
        initial = f'{{angle: {chance.uniform(-2.0, 2.0)!r}, rate: {spin!r}}}'
    if shape == 'near' and chance.random() < 0.5:    # a nearly upright spin
        initial = f'{{euler_zyz: [0.1, {between(1e-4, 1e-1)!r}, 0.2], ' \
                  f'angular_velocity: [0, 0, {spin!r}]}}'
        if constraint == 'hinge':
            initial = f'{{angle: 3.1, rate: {spin!r}}}'
    return (f'scene: random_{number}\nparameters: {json.dumps(parameters)}\n'
            f'body: {{mass: {mass!r}, inertia: {inertia}, center_of_mass: {place}}}\n'
            f'constraint: {held}\neffects: [{", ".join(effects)}]\n'
            f'initial: {initial}\n'), duration


TORQUES = (['-k*T/w0*wx', '0.5*T*qx', 'T*tanh(wz/w0)'], ['T*sin(w0*t)', 0, 'T*exp(-k*t)'],
           ['T*cos(qz)', '-T/w0*Wy', 0], ['T*x/(s + sqrt(x^2 + y^2 + s^2))', 'T', 0])
FORCES = ([0, '-f*k*qx', '2*f'], ['f*cos(w0*t)', 0, 'f*sin(w0*t)'],
          ['-k*f*x/s', '-f*y/s', '-f*tanh(z/s)'], ['-f*vx/sqrt(1 + vx^2)', 0, 'f'])
ENERGIES = ('f*s*(k*qx^2 + qy*qw)', '0.5*k*f/s*(z - s)^2', 'f*s*log(2 + (x/s)^2 + (y/s)^2)')
FIELDS = ([0, 0, 'T'], ['0.5*T*k', 'T*tanh(y/s)', 'T*(1 + z/s/4)'])
IN_FIELD = {'t', 'x', 'y', 'z', 'vx'}


def _fields(chance, between, vector, constraint, parameters):
    """Return one to three effects as YAML: expressions, springs, magnets, gravity gradients."""
    def one(texts):
        if constraint == 'hinge':    # expressions know attitude and angular velocity only there
            texts = [text for text in texts if not _names(text) & IN_FIELD]
        return json.dumps(chance.choice(texts))

    def at():
        return vector(parameters['s'] * chance.uniform(0.1, 1.0))
    size, f = parameters['s'], parameters['f']
    frame = f'frame: {chance.choice(("body", "world"))}'
    able = [f'torque: {{value: {one(TORQUES)}, {frame}, '
            f'books: {chance.choice(("work", "heat"))}}}',
            f'force: {{value: {one(FORCES)}, {frame}, at: {at()}}}',
            f'potential: {{energy: {one(ENERGIES)}}}',
            f'magnetic: {{moment: {vector(1.0)}, field: {one(FIELDS)}}}']
    if constraint != 'hinge':
        length = chance.choice(('', f', length: {size * chance.uniform(0.2, 1.0)!r}'))
        damping = chance.choice(('', f', damping: {f / size * between(1e-3, 0.1)!r}'))
        able.append(f'spring: {{at: {at()}, anchor: {vector(3.0 * size)}, '
                    f'stiffness: {f / size!r}{length}{damping}}}')
    if constraint == 'free':
        place = vector(7e6)
        able.append(f'gravity_gradient: {{mu: {parameters["k"] * 3e20!r}, position: {place}}}')
    return chance.sample(able, chance.choice((1, 1, 2, 3)))


KINKS = {'time': ['T*sign(cos(w0*t))', 0, 'min(T, T*(1.2 + cos(k*w0*t)))'],
         'attitude': ['T*abs(qx)', 'max(-T, -3*T*qy)', 'where(qz < 0.1, T, -0.5*T)'],
         'rates': ['-k*T/w0^2*wx*abs(wx)', 'T*max(0, tanh(Wz/w0))', 0],
         'hinge': ['T*abs(sin(angle))', 'where(cos(angle) > 0.4, -T, T)',
                   'max(-T, 2*T*sin(angle + k))']}
GROUND = 'where(z < 0.2*s, 0.5*f/s*(z - 0.2*s)^2, 0)'    # a floor that gives way


def _more(chance, effects, constraint, parameters, body, lasting):
    """Add to effects: rotors, shaped drag, a field along a vector, torsion, friction, kinks.

    Return the duration, which is shorter where there are kinks.
    """
    (least, mass, slim), (spin, duration) = body, lasting
    between, vector = chance.between, chance.vector

    def matrix(size):
        a = np.array([vector(1.0) for _ in range(3)])
        return ((a @ a.T + (a @ a.T).T) * (size / 2)).tolist()
    names = {effect.split(':')[0] for effect in effects}
    able = ['gravity', 'drag'] + (['kinks', 'kinks'] if constraint != 'table' else [])
    able += ['rotor'] if 'internal_dissipation' not in names else []
    able += ['torsion', 'dry friction'] if constraint == 'hinge' else []
    for kind in chance.sample(able, chance.choice((1, 1, 2))):
        if kind == 'gravity' and 'gravity' not in names:
            effects.append(f'gravity: {{g: {vector(9.81)}}}')
        elif kind == 'drag' and 'drag' not in names:
            effects.append(
                f'drag: {{linear: {matrix(mass * between(1e-3, 0.1))}, '
                f'angular: {least * between(1e-3, 0.3)!r}, '
                f'quadratic: {mass / parameters["s"] * between(1e-3, 0.1)!r}, '
                f'angular_quadratic: {matrix(least * between(1e-3, 0.1))}}}')
        elif kind == 'rotor':
            h = least * spin * between(0.01, 1.0)
            motor = chance.choice(('', f', torque: {least * spin * between(0.01, 1.0)!r}'))
            effects.append(chance.choice((
                f'rotor: {{axis: {vector(1.0)}, momentum: {h!r}}}',
                f'rotor: {{axis: {vector(1.0)}, inertia: {least / 50!r}, '
                f'rate: {h / least * 50!r}{motor}}}')))
        elif kind == 'torsion':
            stiffness = 2.0 * mass * (parameters['s'] * spin) ** 2 * between(0.2, 2.0)
            effects.append(f'spring: {{stiffness: {stiffness!r}, '
                           f'angle: {chance.uniform(-1.0, 1.0)!r}, '
                           f'damping: {least * between(1e-3, 0.3)!r}}}')
        elif kind == 'dry friction' and not any('*t)' in effect for effect in effects):
            effects.append(f'dry_friction: {{torque: {parameters["T"] * between(0.3, 30.0)!r}}}')
            duration = min(duration, KINKED_TURNS / spin)
        elif kind == 'kinks' and not slim:
            if constraint == 'hinge':
                of = chance.choice(('hinge', 'attitude'))
            else:
                of = chance.choice(('time', 'attitude', 'rates', 'ground'))
            effects.append(f'potential: {{energy: {json.dumps(GROUND)}}}' if of == 'ground' else
                           f'torque: {{value: {json.dumps(KINKS[of])}}}')
            duration = min(duration, KINKED_TURNS / spin)
    return round(duration, 3)


def _names(text):
    """Return the names in expressions."""
    return set(re.findall('[A-Za-z]+', json.dumps(text)))


def _start(chance, vector, constraint, angles, spin, inertia):
    """Return the start of a body that turns, as YAML."""
    turn = chance.choice((f'euler_zyz: {angles}', f'euler_zyz: {angles}', f'euler: {angles}',
                          f'rotation_vector: {angles}', f'tilt: {angles[0]!r}',
                          f'orientation: {[*vector(1.0), chance.gauss(0.0, 1.0)]}'))
    omega = chance.choice((
        f'angular_velocity: {vector(spin)}', f'angular_velocity: {vector(spin)}',
        f'angular_velocity_world: {vector(spin)}', f'spin: {spin!r}',
        f'angular_momentum: {vector(spin * min(inertia))}'))
    place = (f', position: {vector(1.0)}, velocity: {vector(1.0)}'
             if constraint == 'free' and chance.random() < 0.5 else '')
    return f'{{{turn}, {omega}{place}}}'


def _ball(chance, between, mass, radius):
    """Return the text and the duration of a ball that slides on a table."""
    speed, spin = between(0.1, 5.0), [chance.uniform(-1.0, 1.0) for _ in range(3)]
    omega = [x * speed / radius for x in spin]
    duration = round(min(between(0.3, 10.0), TURNS * radius / speed), 3)
    return (f'scene: ball\nbody: {{mass: {mass!r}, shape: {{solid_sphere: {{radius: {radius!r}}}'
            f'}}}}\nconstraint: table\neffects: [sliding_friction: {{mu: '
            f'{chance.uniform(0.05, 0.6)!r}, g: 9.81}}]\ninitial: {{angular_velocity: {omega}, '
            f'velocity: [{speed!r}, {chance.uniform(-1.0, 1.0) * speed!r}, 0]}}\n'), duration
