# SPDX-License-Identifier: Apache-2.0
"""What `auto` promises on random scenes: error, expected error and ledger beside a truth.

    .venv/bin/python bench/choice_random.py [--seed 11] [--count 300] [--first 0] [--keep FILE]

Scenes are drawn from the whole scene language: bodies from slim to nearly symmetric, all
constraints, gravity, several torques, drag, internal dissipation, friction of a ball, strikes,
forces, potentials, springs, magnets, gravity gradients, expressions of time and state, all ways to
say the start. The truth (TRUTH below) shares no formula with the package: Newton's and Euler's
equations in body axes with the full tensor, by extrapolation with 64-bit mantissas; Python
evaluates the expressions. The floor is what half an ulp on each number of the start does, by
finite differences of the truth. The error is the largest at LOOKS times. With --keep a run that
was stopped goes on where it was. Exit 1 unless on every scene

    the error is at most max(asked, 3 floor),
    the expected error is within a factor of 3 of max(error, floor), or says that nothing is known
        of the attitude (above SENSELESS),
    the ledger's residuals are below max(asked, floor) times 10,
    nothing hangs (LONGEST s of the processor) and nothing is raised.
"""

import argparse
import json
import math
import pathlib
import random
import re
import signal
import sys
import time

import numpy as np

from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.simulation.simulation import Simulation

ACCURACIES = 1e-6, 1e-11
LOOKS = 24               # as often as a trial of `auto`: dense output errs between steps
LONGEST = 120            # s of the processor, a scene with its compilation
TURNS = 60.0             # rad/s times s, at most: the truth takes a second for each hundred
HALF_ULP, MOVED = 2.0 ** -53, 2.0 ** 22
LINEAR = 0.1             # rad
LEVELS = 9               # of the extrapolation
SENSELESS = 1e-2         # rad: a floor above it leaves nothing to be asked
CONSTRAINTS = 'free', 'pivot', 'hinge', 'table'
WIDE = np.longdouble


# ---------------------------------------------------------------------------- scenes

def drawn(number, seed):
    """Return (YAML text, duration in s) of a random scene."""
    chance = random.Random(f'{seed} {number}')

    def between(low, high):
        return math.exp(chance.uniform(math.log(low), math.log(high)))

    def vector(size):
        v = np.array([chance.gauss(0.0, 1.0) for _ in range(3)])
        return [float(x) for x in v / np.linalg.norm(v) * size]
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


# ---------------------------------------------------------------------------- TRUTH
# Arrays of 80-bit numbers; the first axis is the copy: the start itself, then moved ones.

def _rotated(q, v):
    """Return R v, row by row."""
    u, w = q[:, :3], q[:, 3:]
    t = 2 * np.cross(u, v)
    return v + w * t + np.cross(u, t)


def _back(q, v):
    """Return R^T v, row by row."""
    return _rotated(q * np.array([-1, -1, -1, 1], dtype=WIDE), v)


def _inverse(m):
    """Return the inverse of symmetric matrices (n, 3, 3)."""
    a, b, c = m[:, 0], m[:, 1], m[:, 2]
    rows = np.stack([np.cross(b, c), np.cross(c, a), np.cross(a, b)], axis=1)
    return np.swapaxes(rows, 1, 2) / (a * rows[:, 0]).sum(1)[:, None, None]


def _times(m, v):
    return (m * v[:, None, :]).sum(2)


class Truth:
    """Copies of a scene's body, moved on by extrapolation of the modified midpoint rule.

    Unknowns: q (4), omega (3, body), velocity and place of the centre of mass (3 and 3, world).
    """

    def __init__(self, scene, settings, parameters):
        self.scene, body, kind = scene, scene.body, scene.constraint.kind
        self.kind, self.effects = kind, settings
        self.mass = WIDE(body.mass)
        tensor = np.array(body.about_center.matrix, dtype=float).astype(WIDE)
        self.about_center = tensor[None]
        vector = scene.initial.vector
        self.axis = None
        start = np.concatenate((vector[1:8], vector[11:14], vector[8:11])).astype(WIDE)
        self.parameters = parameters
        copies = [start]
        for place in range(13 if kind == 'free' else 7):
            size = 1.0 if place < 4 else abs(float(start[place]))
            if not size > 0.0:
                continue
            if kind == 'hinge' and place > 4:
                continue
            moved = start.copy()
            by = WIDE(HALF_ULP * MOVED)
            if kind == 'hinge' and place == 4:
                moved[4:7] *= 1 + by
            else:
                moved[place] += by * size
            copies.append(moved)
        self.y, tensors = np.array(copies), tensor[None]
        self.y[:, :4] /= np.sqrt((self.y[:, :4] ** 2).sum(1))[:, None]
        self.arm = np.zeros(3, dtype=WIDE)
        if kind in ('pivot', 'hinge'):
            self.arm = np.array(scene.constraint.arm(body), dtype=float).astype(WIDE)
            r = self.arm
            tensors = tensors + self.mass * ((r @ r) * np.eye(3, dtype=WIDE) - np.outer(r, r))
        self.I, self.inverse = tensors, _inverse(tensors)
        if kind == 'hinge':
            n = np.array(scene.constraint.axis, dtype=float).astype(WIDE)
            self.axis = n / np.sqrt(n @ n)
            self.about = _times(tensors, self.axis[None]) @ self.axis
        # the velocity of the centre of mass
        q, w = self.y[:, :4], self.y[:, 4:7]
        center = np.array(body.center_of_mass, dtype=float).astype(WIDE)
        self.y[:, 7:10] += _rotated(q, np.cross(w, center[None]))
        self.y[:, 10:] += _rotated(q, center[None] + 0 * w)
        self.center, self.t, self.struck = center, 0.0, set()

    def rates(self, y, t):
        """Return y' for rows of unknowns at a time (s)."""
        q, w, v, c = y[:, :4], y[:, 4:7], y[:, 7:10], y[:, 10:]
        force, torque, turning = np.zeros_like(w), np.zeros_like(w), 0
        moves = self.kind == 'free'
        if not moves:
            v = _rotated(q, np.cross(w, self.arm[None]))
        known = None
        for name, one in self.effects:
            if name == 'gravity':
                force = force - self.mass * WIDE(one['g']) * np.array([0, 0, 1], dtype=WIDE)
            elif name == 'torque' and not _is_text(one):
                value = np.array(_value(one, self.t), dtype=float).astype(WIDE)[None] + 0 * w
                torque = torque + (_back(q, value) if one.get('frame') == 'world' else value)
            elif name == 'drag':
                force = force - WIDE(one['linear']) * v
                torque = torque - WIDE(one['angular']) * w
            elif name == 'internal_dissipation':
                m = _times(self.I, w)
                turning = WIDE(one['coefficient']) * np.cross(m, w)
            elif name == 'gravity_gradient':
                place = np.array(one['position'], dtype=float).astype(WIDE)
                r = np.sqrt(place @ place)
                n = _back(q, place[None] / r + 0 * w)
                torque = torque + 3 * WIDE(one['mu']) / r ** 3 * np.cross(
                    n, _times(self.about_center, n))
            elif name != 'strike':
                known = known or self._known(q, w, v, c, t)
                F, G = self._field(name, one, known)    # world at the centre of mass, body
                force, torque = force + F, torque + G
        if not moves:
            torque = torque + np.cross(self.arm[None], _back(q, force))
        out = np.empty_like(y)
        if self.axis is not None:
            out[:, 4:7] = ((torque @ self.axis) / self.about)[:, None] * self.axis
        else:
            m = _times(self.I, w)
            out[:, 4:7] = _times(self.inverse, torque + np.cross(m, w + turning))
        rate = w + turning
        x, s = q[:, :3], q[:, 3:]
        out[:, :3] = (s * rate + np.cross(x, rate)) / 2
        out[:, 3] = -(x * rate).sum(1) / 2
        out[:, 7:10] = force / self.mass if moves else 0
        out[:, 10:] = v if moves else 0
        return out

    def _known(self, q, w, v, c, t):
        """Return what expressions know, by name; o and vo are place and velocity of the origin."""
        center = self.center[None] + 0 * w
        if self.kind == 'free':
            o = c - _rotated(q, center)
            vo = v - _rotated(q, np.cross(w, center))
        else:
            back = (self.arm - self.center)[None] + 0 * w    # from the held point to the origin
            o, vo = _rotated(q, back), _rotated(q, np.cross(w, back))
        W = _rotated(q, w)
        names = {'t': t + 0 * w[:, 0], 'q': q, 'w': w, 'o': o, 'vo': vo}
        for group, of in (('x y z', o), ('vx vy vz', vo), ('qx qy qz qw', q), ('wx wy wz', w),
                          ('Wx Wy Wz', W)):
            names |= {name: of[:, k] for k, name in enumerate(group.split())}
        return names

    def _vector(self, texts, known):
        """Return three expressions, evaluated row by row."""
        names = {name: getattr(np, name)
                 for name in ('sin', 'cos', 'exp', 'log', 'sqrt', 'tanh')} | known
        names |= {name: WIDE(value) for name, value in self.parameters.items()}
        zero = 0 * known['t']
        parts = [zero + (eval(one.replace('^', '**'), {}, names)
                         if isinstance(one, str) else WIDE(one)) for one in texts]
        return np.stack(parts, axis=1)

    def _field(self, name, one, known):
        """Return force (world) and its torque about the centre of mass and others (body)."""
        q = known['q']
        if name == 'potential' or (name == 'magnetic' and _is_text(one)):
            return self._by_steps(name, one, known)
        if name == 'torque':
            value = self._vector(one['value'], known)
            return 0, _back(q, value) if one.get('frame') == 'world' else value
        if name == 'magnetic':
            m = np.array(one['moment'], dtype=float).astype(WIDE)
            return 0, np.cross(m[None], _back(q, self._vector(one['field'], known)))
        if name == 'force':
            at = np.array(one.get('at', self.center), dtype=float).astype(WIDE)
            F = self._vector(one['value'], known)
            F = F if one.get('frame') == 'world' else _rotated(q, F)
        else:
            at = np.array(one['at'], dtype=float).astype(WIDE)
            F = self._pull(one, at, known)
        return F, np.cross((at - self.center)[None], _back(q, F))

    def _pull(self, one, at, known):
        """Return the force of a spring on its point, world axes."""
        q, k, c = known['q'], WIDE(one['stiffness']), WIDE(one.get('damping', 0.0))
        arm = at[None] + 0 * known['w']
        d = known['o'] + _rotated(q, arm) - np.array(one['anchor'], dtype=float).astype(WIDE)
        v = known['vo'] + _rotated(q, np.cross(known['w'], arm))
        if 'length' not in one:
            return -k * d - c * v
        size = np.sqrt((d * d).sum(1))[:, None]
        n = d / size
        return -(k * (size - WIDE(one['length'])) + c * (n * v).sum(1)[:, None]) * n

    def _by_steps(self, name, one, known):
        """Return force and torque of an energy, by steps along the imaginary axis."""
        q, o, step = known['q'], known['o'], WIDE(1e-40)

        def slope(turned, moved):
            inner = dict(zip(('t', 'qx', 'qy', 'qz', 'qw', 'x', 'y', 'z'),
                             (known['t'], *turned.T, *moved.T), strict=True))
            if name == 'potential':
                energy = self._vector([one['energy']], inner)[:, 0]
            else:
                m = np.array(one['moment'], dtype=float).astype(WIDE)[None] + 0 * o
                energy = -(_rotated(turned, m) * self._vector(one['field'], inner)).sum(1)
            return -energy.imag / step
        wide = np.clongdouble
        F = np.stack([slope(q.astype(wide), o + 1j * step * np.eye(3, dtype=WIDE)[k])
                      for k in range(3)], axis=1)
        G = []
        for e in np.eye(3, dtype=WIDE):
            u = np.cross(q[:, :3], e) + q[:, 3:] * e
            by = np.concatenate((u, -(q[:, :3] @ e)[:, None]), axis=1) / 2
            G.append(slope(q + 1j * step * by, o.astype(wide)))
        # the force acts at the origin
        return F, np.stack(G, axis=1) - np.cross(self.center[None], _back(q, F))

    def to(self, time):
        """Go on to a time, with the jumps on the way."""
        jumps = sorted({x for name, one in self.effects if name == 'torque'
                        for x in one.get('times', ())}
                       | {one.get('time', 0.0) for name, one in self.effects if name == 'strike'})
        for jump in [*[x for x in jumps if self.t < x <= time], time]:
            self._march(jump)
            for name, one in self.effects:
                if name == 'strike' and one.get('time', 0.0) == jump and jump not in self.struck:
                    self._strike(one)
            self.struck.add(jump)

    def _march(self, end):
        h = end - self.t
        while self.t < end:
            y, k = self.y, self.rates(self.y, self.t)
            rate, growth = (float(np.sqrt((one[0, 4:7] ** 2).sum())) for one in (y, k))
            fastest = rate + math.sqrt(growth)
            h = min(2.0 * h, 1.0 / max(fastest, 1e-3), end - self.t)
            while True:
                after, error = self._extrapolated(y, k, WIDE(h))
                if error < 1e-17 or h < 1e-9:
                    break
                h *= 0.5
            after[:, :4] /= np.sqrt((after[:, :4] ** 2).sum(1))[:, None]
            self.y = after
            self.t = end if h == end - self.t else self.t + h

    def _extrapolated(self, y, k, h):
        """Return y after h, and an estimate of its relative error.

        All levels of the extrapolation go side by side, the one with most steps first.
        """
        size, count = len(y), 2 * np.arange(LEVELS, 0, -1)
        s = np.repeat(h / count.astype(WIDE), size)[:, None]
        before = np.tile(y, (LEVELS, 1))
        now, rows = before + s * np.tile(k, (LEVELS, 1)), []
        for j in range(1, 2 * LEVELS + 1):
            rate = self.rates(now, self.t + j * s[:len(now), 0])
            if j % 2 == 0:    # the last level that is left has arrived
                rows.append([(now[-size:] + before[-size:] + s[len(now) - size:len(now)]
                              * rate[-size:]) / 2])
                now, before, rate = now[:-size], before[:-size], rate[:-size]
            before, now = now, before + 2 * s[:len(now)] * rate
        for level in range(2, LEVELS + 1):
            row = rows[level - 1]
            for j in range(1, level):
                ratio = WIDE(level) ** 2 / WIDE(level - j) ** 2
                row.append(row[-1] + (row[-1] - rows[level - 2][j - 1]) / (ratio - 1))
        best, other = rows[-1][-1], rows[-1][-2]
        size = 1 + np.abs(best[0, 4:7]).max()
        error = max(np.abs(best - other)[0, :4].max(), np.abs(best - other)[0, 4:7].max() / size)
        return best, float(error)

    def _strike(self, one):
        q = self.y[:, :4]
        J = np.array(one['impulse'], dtype=float).astype(WIDE)[None] + 0 * q[:, :3]
        if one.get('frame') == 'body':
            J = _rotated(q, J)
        if 'point' in one:
            lever = np.array(one['point'], dtype=float).astype(WIDE) - self.center
        else:
            lever = np.zeros(3, dtype=WIDE)
        G = np.cross((lever + self.arm)[None], _back(q, J))
        if self.axis is not None:
            self.y[:, 4:7] += ((G @ self.axis) / self.about)[:, None] * self.axis
        else:
            self.y[:, 4:7] += _times(self.inverse, G)
        if self.kind == 'free':
            self.y[:, 7:10] += J / self.mass

    def floor(self):
        """Return what half an ulp on the numbers of the start does, rad."""
        best = self.y[0, :4]
        apart = [_angle(best, other[:4]) for other in self.y[1:]]
        if max(apart) > LINEAR:    # no longer in proportion to the change
            return math.inf
        return math.sqrt(math.fsum(x * x for x in apart)) / MOVED


def _angle(a, b):
    """Return the angle between two attitudes of 80-bit numbers."""
    sign = 1 if a @ b > 0 else -1
    return float(4 * np.arcsin(min(WIDE(1), np.sqrt(((a - sign * b) ** 2).sum()) / 2)))


def _is_text(one):
    """Return whether the value or field of an effect is an expression."""
    return any(isinstance(part, str) for part in one.get('value', one.get('field', ())))


def _value(one, t):
    """Return the torque just after a time."""
    if 'value' in one:
        return one['value']
    later = [value for begin, value in zip(one['times'], one['values'], strict=True) if begin <= t]
    return later[-1] if later else [0.0, 0.0, 0.0]


class BallTruth:
    """A ball that slides, then rolls: v and omega are linear in time, q by extrapolation."""

    def __init__(self, scene, settings, _):
        one, self.radius = dict(settings)['sliding_friction'], WIDE(scene.body.radius)
        vector, base = scene.initial.vector, WIDE(HALF_ULP * MOVED)
        rows = [np.concatenate((vector[5:8], vector[11:13])).astype(WIDE)]
        rows += [rows[0] * (1 + base * np.eye(5, dtype=WIDE)[k]) for k in range(5)]
        self.q = np.tile(vector[1:5].astype(WIDE), (6, 1))
        rows = np.array(rows)
        self.w0 = _rotated(self.q, rows[:, :3])
        u = rows[:, 3:] - self.radius * np.stack([self.w0[:, 1], -self.w0[:, 0]], axis=1)
        slip = np.sqrt((u ** 2).sum(1))
        k = WIDE(scene.body.about_center.moments[0]) / (self.radius ** 2 * WIDE(scene.body.mass))
        a = WIDE(one['mu']) * WIDE(one['g'])
        self.until = slip / (a * (1 + 1 / k))
        f = -a * u / slip[:, None]
        # I omega' = (-a z) x M f
        self.growth = np.stack([f[:, 1], -f[:, 0], 0 * slip], axis=1) / (k * self.radius)
        self.t = 0.0

    def to(self, time):
        """Go on to a time."""
        ends = sorted({float(x) for x in self.until if self.t < x < time} | {time})
        for end in ends:
            n = max(1, math.ceil((end - self.t) * float(np.abs(self.w0).max()) / 0.5))
            begin = WIDE(self.t)
            for step in range(n):
                self._step(begin + (WIDE(end) - begin) * step / n, (WIDE(end) - begin) / n)
            self.t = end

    def _step(self, t, h):
        rows = []

        def rates(q, t):
            w = self.w0 + np.minimum(t, self.until)[:, None] * self.growth
            out = np.empty_like(q)
            out[:, :3] = (q[:, 3:] * w + np.cross(w, q[:, :3])) / 2
            out[:, 3] = -(w * q[:, :3]).sum(1) / 2
            return out
        for level in range(1, 10):
            n = 2 * level
            s, before, now = h / n, self.q, self.q + h / n * rates(self.q, t)
            for j in range(1, n):
                before, now = now, before + 2 * s * rates(now, t + j * s)
            now = (now + before + s * rates(now, t + h)) / 2
            row = [now]
            for j in range(1, level):
                ratio = WIDE(level) ** 2 / WIDE(level - j) ** 2
                row.append(row[-1] + (row[-1] - rows[-1][j - 1]) / (ratio - 1))
            rows.append(row)
        self.q = rows[-1][-1]

    @property
    def y(self):
        """The attitudes, in the place where Truth has them."""
        return self.q

    floor = Truth.floor


# ---------------------------------------------------------------------------- trial

def _late(*_):
    raise TimeoutError(f'it takes more than {LONGEST} s')


def known(scene, duration):
    """Return attitudes at LOOKS times, times, and the largest floor on the way (rad)."""
    import yaml
    read = yaml.safe_load(scene.text)
    settings = [next(iter(one.items())) for one in read['effects']]
    truth = (BallTruth if scene.constraint.kind == 'table' else Truth)(
        scene, settings, read.get('parameters', {}))
    times, attitudes, floors, turned = duration * np.arange(1, LOOKS + 1) / LOOKS, [], [], 0.0
    for end in times:
        truth.to(float(end))
        attitudes.append(truth.y[0, :4].astype(WIDE))
        rate = float(np.sqrt((truth.y[0, 4:7] ** 2).sum())) if truth.y.shape[1] > 4 else 0.0
        turned = max(turned, rate)
        floors.append(max(truth.floor(), HALF_ULP * (4.0 + turned * float(end))))
    return times, attitudes, max(floors)


def tried(number, seed):
    """Yield (text of a line, whether it is good) for one scene at each accuracy."""
    text, duration = drawn(number, seed)
    scene = parse_scene(text)
    times, attitudes, floor = known(scene, duration)
    what = ' '.join([scene.constraint.kind, *(effect.name for effect in scene.effects)])
    for accuracy in ACCURACIES:
        simulation = Simulation(scene, accuracy=accuracy, horizon=duration, rate=1.0 / duration)
        choice, states = simulation.choice, simulation.states(times)
        error = max(_angle(best, own.astype(WIDE))
                    for best, own in zip(attitudes, states.orientation, strict=True))
        simulation.advance(1)
        ledger = simulation.ledger()
        residual = max(abs(ledger['energy_residual']), ledger['momentum_residual'])
        expected, known_size = choice.expected_error, max(error, floor)
        met = error <= max(accuracy, 3.0 * floor)
        fits = known_size / 3.0 <= expected <= 3.0 * known_size or expected > SENSELESS
        balanced = residual <= 10.0 * max(accuracy, floor)
        good = floor > SENSELESS or (met and fits and balanced)
        marks = '' if good else ''.join(
            f'  {word}' for word, right in (('MISSED', met), ('EXPECTED', fits),
                                            ('LEDGER', balanced)) if not right)
        yield (f'{number:4} {what[:44]:44}{duration:7.2f}{accuracy:8.0e}{choice.method:>9}'
               f'{choice.tolerance:8.0e}{expected:9.1e}{error:9.1e}{floor:9.1e}{residual:9.1e}'
               f'{marks}'), met or floor > SENSELESS, fits or floor > SENSELESS, \
            balanced or floor > SENSELESS


def main():
    """Measure and print; return the exit status."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--seed', type=int, default=11)
    parser.add_argument('--count', type=int, default=300)
    parser.add_argument('--first', type=int, default=0)
    parser.add_argument('--keep', type=pathlib.Path, help='lines of JSON: what is in it stands')
    options = parser.parse_args()
    if np.finfo(WIDE).nmant < 63:
        print('no 80-bit numbers here: nothing to compare with')
        return 0
    print(f'{"":5}{"scene":44}{"s":>7}{"asked":>8}{"method":>9}{"told":>8}{"expected":>9}'
          f'{"error":>9}{"floor":>9}{"ledger":>9}')
    results, began = _kept(options.keep, options.seed), time.monotonic()
    signal.signal(signal.SIGVTALRM, _late)
    numbers = range(options.first, options.first + options.count)
    for number in numbers:
        if number in results:
            continue
        results[number] = result = _result(number, options.seed)
        for line, *_ in result:
            print(line, flush=True)
        if options.keep:
            with options.keep.open('a') as file:
                file.write(json.dumps([options.seed, number, result]) + '\n')
    every = [one for number in numbers for one in results[number]]
    for k, accuracy in enumerate(ACCURACIES):
        good = [results[number][k][1:] for number in numbers if len(results[number]) > 1]
        met, fits, balanced = (sum(column) for column in zip(*good, strict=True))
        print(f'{accuracy:g} rad: {met} of {len(good)} met, {fits} foretold within a factor of 3, '
              f'{balanced} ledgers balanced')
    hung = sum(len(results[number]) == 1 for number in numbers)
    print(f'{hung} scenes raised or hung; {time.monotonic() - began:.0f} s, '
          f'{time.process_time():.0f} s of the processor')
    return 0 if all(all(one[1:]) for one in every) else 1


def _kept(path, seed):
    """Return the results of a run before, number -> what _result returns."""
    if path is None or not path.exists():
        return {}
    rows = [json.loads(line) for line in path.read_text().splitlines()]
    return {number: result for own, number, result in rows if own == seed}


def _result(number, seed):
    """Return a line for each accuracy, each with what is met; one line if something is raised."""
    signal.setitimer(signal.ITIMER_VIRTUAL, LONGEST)
    try:
        return [(line, *map(bool, good)) for line, *good in tried(number, seed)]
    except Exception as error:    # whatever a scene raises is a finding, and the next is tried
        return [(f'{number:4} {type(error).__name__}: {error}  RAISED', False, False, False)]
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)


if __name__ == '__main__':
    sys.exit(main())
