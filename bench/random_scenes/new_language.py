# SPDX-License-Identifier: Apache-2.0
"""Random scenes whose effects are in the scene's own words: those added after the first six.

Forces, torques and potentials in expressions, springs, rotors, magnets, gravity gradients (in
place and on an orbit), shaped drag, gravity as a vector, friction of a hinge, internal dissipation
at a pivot; pivots off the origin and on a path. Each scene has one to four of them, and numbers
of expressions are parameters.
"""

import json
import math

import numpy as np

from random_scenes.chance import Chance
from random_scenes.draw import ENERGIES, FIELDS, FORCES, GROUND, KINKED_TURNS, KINKS, TORQUES

TURNS = 12.0    # rad/s times s, at most
FALL = 20.0     # sizes, at most: fields have the size of the body
CONSTRAINTS = {'free': 4, 'pivot': 2, 'displaced': 2, 'moving': 2, 'hinge': 3}
MOTIONS = (
    (('d*sin(w0*t)', 0, 'd*cos(k*w0*t)'),
     ('d*w0*cos(w0*t)', 0, '-d*k*w0*sin(k*w0*t)'),
     ('-d*w0^2*sin(w0*t)', 0, '-d*(k*w0)^2*cos(k*w0*t)')),
    ((0, 'd*exp(-k*t)', 'd*k*t^2'), (0, '-d*k*exp(-k*t)', '2*d*k*t'),
     (0, 'd*k^2*exp(-k*t)', '2*d*k')),
    (('d*cos(w0*t)', 'd*sin(w0*t)', 0), ('-d*w0*sin(w0*t)', 'd*w0*cos(w0*t)', 0),
     ('-d*w0^2*cos(w0*t)', '-d*w0^2*sin(w0*t)', 0)))
"""Paths of a pivot, their velocities and their accelerations, differentiated by hand."""
ON_A_HINGE = {
    'torque': (['T*cos(angle)', '-k*T/w0*rate', 'T*sin(w0*t)'], [0, 'T*sin(angle + w0*t)', 'T']),
    'potential': ('-T*cos(angle - k)', '0.5*k*T*angle^2 + T*sin(2*angle)')}


def drawn(number, seed):
    """Return (YAML text, duration in s) of a random scene."""
    return _Scene(Chance(f'{seed} {number} new language')).drawn(number)


class _Scene:
    """One scene, drawn piece by piece."""

    def __init__(self, chance):
        self.chance, self.between, self.vector = chance, chance.between, chance.vector
        self.constraint = chance.choices([*CONSTRAINTS], [*CONSTRAINTS.values()])[0]
        self.mass, self.size = self.between(0.01, 10.0), self.between(0.02, 2.0)
        self.slim = chance.random() < 0.15
        a, b, c = (chance.uniform(0.2, 1.0) for _ in range(3))
        if self.slim:
            c *= self.between(1e-4, 1e-1)
            a, b = 1.0, 1.0 + 0.9 * c
        else:    # semi-axes of an ellipsoid
            a, b, c = b * b + c * c, a * a + c * c, a * a + b * b
        self.inertia = [self.mass * self.size * self.size * x for x in (a, b, c)]
        self.least, self.spin = min(self.inertia), self.between(0.1, 30.0)
        self.duration = round(min(self.between(0.5, 30.0), TURNS / self.spin), 3)
        self.kinked = False
        spin, size = self.spin, self.size
        self.parameters = {
            'k': chance.uniform(0.2, 2.0), 'w0': spin * chance.uniform(0.2, 2.0), 's': size,
            'd': size * self.between(0.01, 0.3),
            'f': self.mass * size * spin * spin * self.between(1e-3, 0.1),
            'T': self.least * spin * spin * self.between(1e-3, 0.1)}

    def matrix(self, size):
        """Return a symmetric matrix that takes energy from every motion."""
        a = np.array([self.vector(1.0) for _ in range(3)])
        return ((a @ a.T + (a @ a.T).T) * (size / 2)).tolist()

    def drawn(self, number):
        """Return the text and the duration."""
        effects, laws = [], ['force', 'torque', 'potential', 'spring', 'magnetic', 'rotor',
                             'drag', 'field', 'kinks']
        if self.constraint == 'hinge':
            laws += ['torsion', 'friction']
        elif self.constraint != 'moving':
            laws.append('dissipation')
        if self.constraint == 'free':
            laws += ['gradient']
        if self.chance.random() < 0.5:
            effects.append('gravity: {g: 9.81}')
            laws.remove('field')
        for law in self.chance.sample(laws, self.chance.choice((1, 2, 2, 3, 4))):
            if law == 'dissipation' and any('rotor' in one for one in effects):
                continue
            if law == 'rotor' and any('dissipation' in one for one in effects):
                continue
            effects.append(getattr(self, f'_{law}')())
        if any('*t)' in one for one in effects):    # at rest it could break loose at any time
            effects = [one for one in effects if 'dry_friction' not in one]
        if self.kinked:
            self.duration = round(min(self.duration, KINKED_TURNS / self.spin), 3)
        if self.constraint == 'free' and any('gravity: ' in one for one in effects):
            falling = math.sqrt(2.0 * FALL * self.size / 9.81)
            self.duration = round(min(self.duration, falling), 3)
        place = self.vector(self.size * self.chance.uniform(0.1, 0.8))
        return (f'scene: new_{number}\nparameters: {json.dumps(self.parameters)}\n'
                f'body: {{mass: {self.mass!r}, inertia: {self.inertia}, '
                f'center_of_mass: {place}}}\nconstraint: {self._held()}\n'
                f'effects: [{", ".join(one for one in effects if one)}]\n'
                f'initial: {self._start()}\n'), self.duration

    def _held(self):
        at = self.vector(self.size * self.chance.uniform(0.1, 0.5))
        match self.constraint:
            case 'displaced':
                return f'{{pivot: {{at: {at}}}}}'
            case 'moving':
                motion = json.dumps(self.chance.choice(MOTIONS)[0])
                held = self.chance.choice(('', f', at: {at}'))
                return f'{{pivot: {{motion: {motion}{held}}}}}'
            case 'hinge':
                return f'{{hinge: {{axis: {self.vector(1.0)}, through: {at}}}}}'
        return self.constraint

    def _start(self):
        chance, spin = self.chance, self.spin
        if self.constraint == 'hinge':
            return f'{{angle: {chance.uniform(-2.0, 2.0)!r}, rate: {spin!r}}}'
        angles = [chance.uniform(0.05, 3.0) for _ in range(3)]
        turn = chance.choice((f'euler_zyz: {angles}', f'euler: {angles}',
                              f'rotation_vector: {angles}', f'tilt: {angles[0]!r}'))
        omega = chance.choice((
            f'angular_velocity: {self.vector(spin)}', f'angular_velocity_world: '
            f'{self.vector(spin)}', f'angular_momentum: {self.vector(spin * self.least)}'))
        place = ''
        if self.constraint == 'free':
            place = (f', position: {self.vector(self.size)}, '
                     f'velocity: {self.vector(0.3 * self.size * spin)}')
        return f'{{{turn}, {omega}{place}}}'

    def _at(self):
        return self.vector(self.size * self.chance.uniform(0.1, 1.0))

    def _one(self, texts):
        return json.dumps(self.chance.choice(texts))

    def _axes(self):
        return f'frame: {self.chance.choice(("body", "world"))}'

    def _force(self):
        return f'force: {{value: {self._one(FORCES)}, {self._axes()}, at: {self._at()}}}'

    def _torque(self):
        more = ON_A_HINGE['torque'] if self.constraint == 'hinge' else ()
        return (f'torque: {{value: {self._one((*TORQUES, *more))}, {self._axes()}, '
                f'books: {self.chance.choice(("work", "heat"))}}}')

    def _potential(self):
        more = ON_A_HINGE['potential'] if self.constraint == 'hinge' else ()
        return f'potential: {{energy: {self._one((*ENERGIES, *more))}}}'

    def _spring(self):
        stiffness, chance = self.parameters['f'] / self.size, self.chance
        length = chance.choice(('', f', length: {self.size * chance.uniform(0.2, 1.0)!r}'))
        damping = chance.choice(('', f', damping: {stiffness * self.between(1e-3, 0.1)!r}'))
        return (f'spring: {{at: {self._at()}, anchor: {self.vector(3.0 * self.size)}, '
                f'stiffness: {stiffness!r}{length}{damping}}}')

    def _magnetic(self):
        return f'magnetic: {{moment: {self.vector(1.0)}, field: {self._one(FIELDS)}}}'

    def _rotor(self):
        h, motor = self.least * self.spin * self.between(0.01, 1.0), ''
        if self.chance.random() < 0.5:
            motor = f', torque: {self.least * self.spin * self.between(0.01, 1.0)!r}'
        return self.chance.choice((
            f'rotor: {{axis: {self.vector(1.0)}, momentum: {h!r}}}',
            f'rotor: {{axis: {self.vector(1.0)}, inertia: {self.least / 50!r}, '
            f'rate: {h / self.least * 50!r}{motor}}}'))

    def _gradient(self):
        rate, (normal, other) = self.spin * self.between(0.01, 0.3), (self.vector(1.0), self._at())
        if self.chance.random() < 0.5:
            return (f'gravity_gradient: {{mu: {rate * rate * 7e6 ** 3!r}, '
                    f'position: {self.vector(7e6)}}}')
        toward = np.cross(normal, other).tolist()
        return (f'gravity_gradient: {{orbit: {{rate: {rate!r}, normal: {normal}, '
                f'toward: {toward}}}}}')

    def _drag(self):
        mass, least = self.mass, self.least
        return (f'drag: {{linear: {self.matrix(mass * self.between(1e-3, 0.1))}, '
                f'angular: {least * self.between(1e-3, 0.3)!r}, '
                f'quadratic: {mass / self.size * self.between(1e-3, 0.1)!r}, '
                f'angular_quadratic: {self.matrix(least * self.between(1e-3, 0.1))}}}')

    def _field(self):
        return f'gravity: {{g: {self.vector(9.81)}}}'

    def _dissipation(self):
        largest = self.spin * max(self.inertia)
        return f'internal_dissipation: {{coefficient: {self.between(0.01, 1.0) / largest!r}}}'

    def _torsion(self):
        stiffness = 2.0 * self.mass * (self.size * self.spin) ** 2 * self.between(0.2, 2.0)
        return (f'spring: {{stiffness: {stiffness!r}, angle: {self.chance.uniform(-1.0, 1.0)!r}, '
                f'damping: {self.least * self.between(1e-3, 0.3)!r}}}')

    def _friction(self):
        self.kinked = True
        return f'dry_friction: {{torque: {self.parameters["T"] * self.between(0.3, 30.0)!r}}}'

    def _kinks(self):
        if self.slim:    # too fast to be followed from kink to kink
            return ''
        self.kinked = True
        of = ('hinge', 'attitude') if self.constraint == 'hinge' else (
            'time', 'attitude', 'rates', 'ground')
        which = self.chance.choice(of)
        if which == 'ground':
            return f'potential: {{energy: {json.dumps(GROUND)}}}'
        return f'torque: {{value: {json.dumps(KINKS[which])}}}'
