# SPDX-License-Identifier: Apache-2.0
"""Make smooth.json: states and ledger of the cases of smooth_cases.py, to 34 digits.

    PYTHONPATH=. python test/data/make_smooth.py

The method differs from the package's: the unknowns are the attitude and the angular momentum in
the world (there: omega in the body), and Gragg's extrapolation of order 40 (there: Runge-Kutta)
carries 60 digits. Only the input is shared: the doubles of the scene as the package reads them.
For a needle the momentum would be stiff (L/I3 is large), so there the unknown is omega too.
"""

import json
import math
import pathlib
import sys
from concurrent.futures import ProcessPoolExecutor

import mpmath as mp
import smooth_cases

from rigid_body_sim.scene.scene import parse_scene

HERE = pathlib.Path(__file__).resolve().parent
mp.mp.dps = 60
COLUMNS = 20
ZERO = [mp.mpf(0)] * 3


def numbers(values):
    return [mp.mpf(float(x)) for x in values]


def plus(*vectors):
    return [sum(entries) for entries in zip(*vectors)]


def times(factor, vector):
    return [factor * entry for entry in vector]


def dot(a, b):
    return mp.fdot(a, b)


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def turn(q):
    """Return the rows of the matrix of a quaternion (x, y, z, w)."""
    x, y, z, w = q
    n = x * x + y * y + z * z + w * w
    return [
        [(w * w + x * x - y * y - z * z) / n, 2 * (x * y - w * z) / n, 2 * (x * z + w * y) / n],
        [2 * (x * y + w * z) / n, (w * w - x * x + y * y - z * z) / n, 2 * (y * z - w * x) / n],
        [2 * (x * z - w * y) / n, 2 * (y * z + w * x) / n, (w * w - x * x - y * y + z * z) / n]]


def out(R, v):
    """Return R v."""
    return [dot(row, v) for row in R]


def back(R, v):
    """Return R^T v."""
    return [R[0][k] * v[0] + R[1][k] * v[1] + R[2][k] * v[2] for k in range(3)]


def product(q, p):
    (ax, ay, az, aw), (bx, by, bz, bw) = q, p
    return [aw * bx + ax * bw + ay * bz - az * by, aw * by - ax * bz + ay * bw + az * bx,
            aw * bz + ax * by - ay * bx + az * bw, aw * bw - ax * bx - ay * by - az * bz]


def extrapolated(rates, y, h):
    """Return y after h by Gragg's method.

    It is the modified midpoint rule with 2, 4, ... substeps, extrapolated in the squared step.
    """
    first = rates(y)
    rows = []
    for column in range(1, COLUMNS + 1):
        n = 2 * column
        step = h / n
        before, now = y, plus(y, times(step, first))
        for _ in range(n - 1):
            before, now = now, plus(before, times(2 * step, rates(now)))
        rows.append([now])
        for k in range(1, column):
            factor = 1 / (mp.mpf(n * n) / (2 * (column - k)) ** 2 - 1)
            rows[-1].append([a + (a - b) * factor for a, b in zip(rows[-1][-1], rows[-2][k - 1])])
    return rows[-1][-1]


class Body:
    """The equations of one case."""

    def __init__(self, scene, wrench):
        body, constraint = scene.body, scene.constraint
        self.kind = constraint.kind
        inertia = body.about_origin if self.kind == 'pivot' else body.about_center
        self.M, self.I, self.axes = (
            mp.mpf(body.mass), numbers(inertia.moments), numbers(inertia.axes))
        center = numbers(body.center_of_mass)
        self.point = (center if self.kind == 'free' else numbers(constraint.through)
                      if self.kind == 'hinge' else ZERO)
        self.arm = plus(center, times(-1, self.point))    # body axes
        self.axis = numbers(constraint.axis) if self.kind == 'hinge' else ZERO
        self.wrench, self.torques = (
            wrench, [effect for effect in scene.effects if effect.name == 'torque'])
        gravity, drag, inner = (
            scene.effect('gravity'), scene.effect('drag'), scene.effect('internal_dissipation'))
        self.weight = [mp.mpf(0), mp.mpf(0), -self.M * mp.mpf(gravity.g) if gravity else mp.mpf(0)]
        self.linear, self.angular = ((mp.mpf(drag.linear), mp.mpf(drag.angular)) if drag
                                     else (mp.mpf(0), mp.mpf(0)))
        self.inner = mp.mpf(inner.coefficient) if inner else mp.mpf(0)
        self.vector = numbers(scene.initial.vector)
        self.needle = 0 < min(self.I) < max(self.I) / 1000

    def tensor(self, power):
        """Return the map v -> I^power v in body axes (0 where the moment is 0)."""
        A = turn(self.axes)
        return lambda v: out(
            A, [(moment ** power if moment else 0) * c for moment, c in zip(self.I, back(A, v))])

    def start(self):
        """Return q, L, x, v (point of reference), books."""
        q, omega = self.vector[1:5], self.vector[5:8]
        R = turn(q)
        p = out(R, self.point)
        x, v = (
            plus(self.vector[8:11], p), plus(self.vector[11:14], out(R, cross(omega, self.point))))
        if self.kind == 'hinge':
            return [mp.mpf(0), dot(self.axis, omega), *[mp.mpf(0)] * 5], (q, x)
        return [*q, *(omega if self.needle else out(R, self.tensor(1)(omega))), *x, *v,
                *[mp.mpf(0)] * 5], None

    def given(self, time, R):
        """Return force and couple of commands and torque effects, world axes."""
        force, couple = ZERO, ZERO
        for f, c, frame in [(ZERO, torque.value(time), torque.frame)
                            for torque in self.torques] + ([self.wrench] if self.wrench else []):
            f, c = numbers(f), numbers(c)
            force, couple = (plus(force, f if frame == 'world' else out(R, f)),
                             plus(couple, c if frame == 'world' else out(R, c)))
        return force, couple

    def acting(self, time, R, spin, velocity):
        """Return force, torque about the point of reference, and powers of work and heat.

        `spin` is omega in world axes, `velocity` the velocity of the centre of mass.
        """
        r = out(R, self.arm)
        force, couple = self.given(time, R)
        drag, resist = times(-self.linear, velocity), times(-self.angular, spin)
        total = plus(force, drag, self.weight)
        torque = plus(couple, resist, cross(r, total))
        return (total, torque, dot(force, velocity) + dot(couple, spin),
                -dot(drag, velocity) - dot(resist, spin))

    def rates(self, time):
        inverse = self.tensor(-1)

        def free_or_pivoted(y):
            q, L, v = y[0:4], y[4:7], y[10:13]
            R = turn(q)
            m = back(R, L)
            omega = inverse(m)
            spin = out(R, omega)
            u = times(self.inner, cross(m, omega))
            velocity = v if self.kind == 'free' else cross(spin, out(R, self.arm))
            force, torque, work, heat = self.acting(time, R, spin, velocity)
            if not all(self.I):    # no couple about an axis without moment
                A = turn(self.axes)
                torque = out(R, out(A, [
                    c if moment else mp.mpf(0)
                    for moment, c in zip(self.I, back(A, back(R, torque)))]))
                work = dot(torque, spin)
            heat += dot(u, cross(m, omega))
            moving = self.kind == 'free'
            return [*times(mp.mpf(1) / 2, product(q, [*plus(omega, u), mp.mpf(0)])), *torque,
                    *(v if moving else ZERO), *(times(1 / self.M, force) if moving else ZERO),
                    work, heat, *torque]

        def hinged(y):
            phi, speed = y[0], y[1]
            R = turn(self.attitude(phi))
            omega = times(speed, self.axis)
            spin = out(R, omega)
            _, torque, work, heat = self.acting(time, R, spin, out(R, cross(omega, self.arm)))
            along = dot(torque, out(R, self.axis))
            across = cross(self.axis, self.arm)
            moment = dot(self.axis, self.tensor(1)(self.axis)) + self.M * dot(across, across)
            return [speed, along / moment, work, heat, *times(along, out(R, self.axis))]

        def needle(y):    # principal axes are the body's
            q, omega = y[0:4], y[4:7]
            R, spin = turn(q), out(turn(q), omega)
            force, torque, work, heat = self.acting(time, R, spin, y[10:13])
            gyric = cross([moment * w for moment, w in zip(self.I, omega)], omega)
            return [*times(mp.mpf(1) / 2, product(q, [*omega, mp.mpf(0)])),
                    *inverse(plus(gyric, back(R, torque))), *y[10:13], *times(1 / self.M, force),
                    work, heat, *torque]

        return hinged if self.kind == 'hinge' else needle if self.needle else free_or_pivoted

    def attitude(self, phi):
        return product(self.vector[1:5], [*times(mp.sin(phi / 2), self.axis), mp.cos(phi / 2)])

    def state(self, y, hinge):
        """Return q, omega, position, velocity of the body's origin."""
        if hinge:
            q, x, v, omega = self.attitude(y[0]), hinge[1], ZERO, times(y[1], self.axis)
        else:
            q, x, v = y[0:4], y[7:10], y[10:13]
            omega = y[4:7] if self.needle else self.tensor(-1)(back(turn(q), y[4:7]))
        R, size = turn(q), mp.sqrt(dot(q, q))
        return [*times(1 / size, q), *omega, *plus(x, times(-1, out(R, self.point))),
                *plus(v, times(-1, out(R, cross(omega, self.point))))]


def solve(name):
    scene = parse_scene(smooth_cases.text(name))
    _, _, _, _, wrench, asked = smooth_cases.CASES[name]
    body = Body(scene, wrench)
    y, hinge = body.start()
    breaks = {time for torque in body.torques for time in torque.times if time > 0.0}
    now, states = 0.0, {}
    for stop in sorted({*breaks, *asked}):
        while now < stop:
            fastest = (max(abs(x) for x in numbers([
                *scene.initial.vector[5:8], y[1] if hinge else 0])) + 3)
            steps = math.ceil((stop - now) * float(fastest) / 1.2)
            h = (mp.mpf(stop) - mp.mpf(now)) / steps
            for _ in range(steps):
                y = extrapolated(body.rates(now), y, h)
            now = stop
        if stop in asked:
            states[repr(stop)] = {'state': [mp.nstr(x, 34) for x in body.state(y, hinge)],
                                  'entries': [mp.nstr(x, 34) for x in y[-5:]]}
        print(name, stop, flush=True)
    return states


if __name__ == '__main__':
    names = sys.argv[1:] or list(smooth_cases.CASES)
    target = HERE / 'smooth.json'
    kept = json.loads(target.read_text()) if target.exists() else {}
    with ProcessPoolExecutor() as pool:
        kept |= dict(zip(names, pool.map(solve, names)))
    target.write_text(json.dumps(
        {name: kept[name] for name in smooth_cases.CASES if name in kept}, indent=1) + '\n')
