# SPDX-License-Identifier: Apache-2.0
"""Make plane_scenes.json: the shipped scenes of bodies on a plane, to 34 digits, with events.

    PYTHONPATH=. .venv-peers/bin/python test/data/make_plane_scenes.py [--references]

With --references it makes the references of the study instead, for those problems of the suite
(rigid_body_sim/study/precision/suite.py) that are on a plane, with the floors that half an ulp on
every input sets.

The method is heyoka's Taylor series with quadruple numbers, and the equations differ from the
package's. Without slip the unknown is the angular momentum M about the point of contact,

    M' = M x omega + m r' x (omega x r) + m g r x gamma - c (S s') x gamma.

With slip they are omega and the velocity of the centre of mass along the plane. The second
derivative of its height -gamma . r is N/m - g, which gives N. The slip u dies in the time tau with
dt = |u| dtau; below 1e-32 m/s it has died. Only the doubles of the scenes are shared.
"""

import json
import pathlib
import sys
from concurrent.futures import ProcessPoolExecutor

import heyoka as hy
import numpy as np
from mpmath import mp, mpf

from rigid_body_sim.mechanics.contact.parameters import FLAT
from rigid_body_sim.scene.scene import load_scene
from rigid_body_sim.study.precision import inputs, suite
from rigid_body_sim.study.precision import reference as references

REAL = hy.real128
SCENES = {'rolling_disk': 10, 'euler_disk': 3, 'rattleback': 10, 'tippe_top': 5, 'rising_egg': 5,
          'routh_sphere': 10, 'chaplygin_sphere': 10}    # until when, s
SAMPLES = 20
# tolerance, and the slip (m/s) that has died: of the truth, of its check, of the floors
TRUTH, CHECK, ROUGH = (1e-33, '1e-32'), (1e-30, '1e-28'), (1e-24, '1e-21')
DRAWS = 8    # random choices of signs for a floor
NEWTON = 8    # steps of Newton's method for the time of a sample: dt/dtau = |u|


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def plus(*vectors):
    return [sum(entries[1:], entries[0]) for entries in zip(*vectors)]


def times(factor, vector):
    return [factor * entry for entry in vector]


def apply(matrix, vector):
    return [dot(row, vector) for row in matrix]


def inverse(m):
    """Return the inverse of a symmetric 3 x 3 matrix."""
    (a, b, c), (_, d, e), (_, _, f) = m
    adjugate = [[d * f - e * e, c * e - b * f, b * e - c * d],
                [c * e - b * f, a * f - c * c, b * c - a * e],
                [b * e - c * d, b * c - a * e, a * d - b * b]]
    det = a * adjugate[0][0] + b * adjugate[0][1] + c * adjugate[0][2]
    return [[entry / det for entry in row] for row in adjugate]


class Body:
    """The numbers and the geometry of a scene; `move` is applied to each of its doubles."""

    def __init__(self, scene, move=inputs.exactly, fine=TRUTH):
        def number(x):
            return REAL(mp.nstr(move(x), 40))
        body, self.scene, self.tolerance = scene.body, scene, fine[0]
        self.dead = REAL(fine[1])
        self.m, self.g = number(body.mass), number(scene.effect('gravity').g)
        self.rolls = scene.contact.mu > 1e300
        self.mu = REAL(0) if self.rolls else number(scene.contact.mu)
        self.viscous = number(scene.contact.rolling_viscous)
        self.inertia = [[number(x) for x in row] for row in body.about_center.matrix]
        self.kind, self.size = body.surface.kind, [number(x) for x in body.surface.size]
        self.middle = [number(a) - number(b)
                       for a, b in zip(body.surface.center, body.center_of_mass)]
        q = [number(x) for x in scene.initial.orientation]
        size = sum((x * x for x in q[1:]), q[0] * q[0]) ** REAL('0.5')
        self.q = [x / size for x in q]
        self.omega = [number(x) for x in scene.initial.angular_velocity]
        # the state is that of the body's origin
        carried = cross(self.omega, [number(x) for x in body.center_of_mass])
        self.v = [number(x) + dot(axis, carried)
                  for x, axis in zip(scene.initial.velocity, axes(self.q))]

    def lowest(self, n):
        """Return the lowest point from the centre of mass."""
        if self.kind == 'sphere':
            s = times(-self.size[0], n)
        elif self.kind == 'ellipsoid':
            pulled = [d * d * x for d, x in zip(self.size, n)]
            s = times(-1.0 / root(dot(n, pulled)), pulled)
        else:    # the edge of a disk
            flat = root(n[0] * n[0] + n[1] * n[1])
            s = [-self.size[0] * n[0] / flat, -self.size[0] * n[1] / flat, n[2] * REAL(0)]
        return plus(self.middle, s)

    def moved(self, n, x):
        """Return the derivative of the lowest point where n moves along x."""
        if self.kind == 'sphere':
            return times(-self.size[0], x)
        if self.kind == 'ellipsoid':
            squares = [d * d for d in self.size]
            pulled = [d * a for d, a in zip(squares, n)]
            square = dot(n, pulled)
            change = [d * a for d, a in zip(squares, x)]
            return plus(times(-1.0 / root(square), change),
                        times(dot(pulled, x) / (square * root(square)), pulled))
        square = n[0] * n[0] + n[1] * n[1]
        along = (n[0] * x[0] + n[1] * x[1]) / square
        return [-self.size[0] * (x[0] - n[0] * along) / root(square),
                -self.size[0] * (x[1] - n[1] * along) / root(square), x[2] * REAL(0)]

    def heavy(self, r):
        """Return the inertia about the point of contact."""
        square = dot(r, r)
        return [[self.inertia[i][j] + self.m * ((square if i == j else REAL(0)) - r[i] * r[j])
                 for j in range(3)] for i in range(3)]


def root(x):
    return hy.sqrt(x) if isinstance(x, hy.expression) else x ** REAL('0.5')


def axes(q):
    """Return the axes of the world in those of the body."""
    x, y, z, w = q
    two = REAL(2)
    return ([w * w + x * x - y * y - z * z, two * (x * y - z * w), two * (x * z + y * w)],
            [two * (x * y + z * w), w * w - x * x + y * y - z * z, two * (y * z - x * w)],
            [two * (x * z - y * w), two * (y * z + x * w), w * w - x * x - y * y + z * z])


def turning(q, omega):
    x, y, z, w = q
    a, b, c = omega
    half = REAL('0.5')
    return [half * (w * a + y * c - z * b), half * (w * b + z * a - x * c),
            half * (w * c + x * b - y * a), half * (-x * a - y * b - z * c)]


def rolling(body):
    """Return the equations of a body that rolls: (symbols, rates)."""
    q = hy.make_vars('qx', 'qy', 'qz', 'qw')
    M = hy.make_vars('Mx', 'My', 'Mz')
    n = axes(q)[2]
    r = body.lowest(n)
    omega = apply(inverse(body.heavy(r)), M)
    shift = body.moved(n, cross(n, omega))
    rate = plus(cross(M, omega), times(body.m, cross(shift, cross(omega, r))),
                times(body.m * body.g, cross(r, n)),
                times(-body.viscous, cross(body.moved(n, shift), n)))
    return [*q, *M], [*turning(q, omega), *rate]


def sliding(body):
    """Return the equations of a body that slides, by tau: (symbols, rates, |u|)."""
    q = hy.make_vars('qx', 'qy', 'qz', 'qw')
    omega = hy.make_vars('wx', 'wy', 'wz')
    vx, vy, t = hy.make_vars('vx', 'vy', 't')
    e1, e2, n = axes(q)
    r = body.lowest(n)
    carried = cross(omega, r)
    ux, uy = vx + dot(e1, carried), vy + dot(e2, carried)
    speed = hy.sqrt(ux * ux + uy * uy)
    mu = body.mu
    push = plus(n, times(-mu * ux / speed, e1), times(-mu * uy / speed, e2))    # f = N push
    upside = inverse(body.inertia)
    free = apply(upside, cross(apply(body.inertia, omega), omega))
    pushed = apply(upside, cross(r, push))
    slope = cross(n, omega)
    shift = body.moved(n, slope)
    # h'' = -(n' x omega + n x omega').r - n'.r' = known + N grown = N/m - g
    known = -dot(plus(cross(slope, omega), cross(n, free)), r) - dot(slope, shift)
    grown = -dot(cross(n, pushed), r)
    N = (known + body.g) / (REAL(1) / body.m - grown)
    rates = [*turning(q, omega), *plus(free, times(N, pushed)),
             -mu * N * ux / (speed * body.m), -mu * N * uy / (speed * body.m), hy.expression(1.0)]
    return [*q, *omega, vx, vy, t], [rate * speed for rate in rates]


def integrator(equations, start, tolerance):
    symbols, rates = equations
    return hy.taylor_adaptive([(s, e + 0.0 * symbols[0]) for s, e in zip(symbols, rates)],
                              np.array(start, dtype=REAL), fp_type=REAL, tol=REAL(tolerance),
                              compact_mode=True)


def orientation(q):
    size = sum((x * x for x in q[1:]), q[0] * q[0]) ** REAL('0.5')
    return [str(x / size) for x in q]


def roll(body, q, omega, begin, samples, found):
    """Go on without slip; fill `found` with q and omega at the samples. Return the integrator."""
    r = body.lowest(axes(q)[2])
    one = integrator(rolling(body), [*q, *apply(body.heavy(r), omega)], body.tolerance)
    one.time = begin
    for time in samples:
        if REAL(time) >= begin:
            one.propagate_until(REAL(time))
            q = list(one.state[:4])
            heavy = body.heavy(body.lowest(axes(q)[2]))
            found[time] = q, apply(inverse(heavy), list(one.state[4:]))
    return one


def flat(body, one):
    """Return when a disk that rolls is inclined by FLAT."""
    now = one

    def low():
        n = axes(list(now.state[:4]))[2]
        return (n[0] * n[0] + n[1] * n[1]) ** REAL('0.5') - REAL(FLAT)

    while True:
        state, time = now.state.copy(), now.time
        now.step()
        if low() < 0:
            break
    high, least = now.time, time
    for _ in range(115):
        middle = (least + high) / REAL(2)
        now.state[:], now.time = state, time
        now.propagate_until(middle)
        if low() < 0:
            high = middle
        else:
            least = middle
    return high


def slide(body, samples, found):
    """Slide until the slip has died; return (q, omega, time)."""
    one = integrator(sliding(body), [*body.q, *body.omega, body.v[0], body.v[1], REAL(0)],
                     body.tolerance)
    left = list(samples)

    def speed():
        q, omega, v = list(one.state[:4]), list(one.state[4:7]), list(one.state[7:9])
        e1, e2, n = axes(q)
        carried = cross(omega, body.lowest(n))
        return ((v[0] + dot(e1, carried)) ** 2 + (v[1] + dot(e2, carried)) ** 2) ** REAL('0.5')

    while speed() > body.dead:
        state, tau = one.state.copy(), one.time
        one.step()
        while left and one.state[9] > REAL(left[0]):
            ended, beyond = one.time, one.state.copy()
            for _ in range(NEWTON):
                aim = one.time - (one.state[9] - REAL(left[0])) / speed()
                one.state[:], one.time = state, tau
                one.propagate_until(min(max(aim, tau), ended))
            found[left.pop(0)] = list(one.state[:4]), list(one.state[4:7])
            one.state[:], one.time = beyond, ended
    return list(one.state[:4]), list(one.state[4:7]), one.state[9]


def motion(body, samples):
    """Return q and omega at the samples, and the events."""
    found, events = {}, []
    if body.rolls:
        one = roll(body, body.q, body.omega, REAL(0), samples, found)
        if float(body.viscous) > 0.0:
            events.append(('rest', str(flat(body, one))))
    else:
        q, omega, time = slide(body, samples, found)
        events.append(('rolling began', str(time)))
        roll(body, q, omega, time, samples, found)
    return [found[time] for time in samples], events


def reference(name):
    """Write the reference of a problem of the study; return a report of one line."""
    problem = suite.problem(name)
    samples = [problem.duration * (k + 1) / references.SAMPLES for k in range(references.SAMPLES)]

    def run(move, fine):
        rows, _ = motion(Body(problem.scene, move, fine), samples)
        return ([tuple(mpf(x) for x in orientation(q)) for q, _ in rows],
                [tuple(mpf(str(x)) for x in omega) for _, omega in rows])

    with mp.workprec(references.BITS):
        best = run(inputs.exactly, TRUTH)
        bare = references.Reference(np.array(samples), *best, None, None, 0.0)
        apart = max(one.max() for one in bare.distances(*run(inputs.exactly, CHECK)))
        floors = np.max([bare.distances(*run(inputs.Moved(seed), ROUGH))
                         for seed in range(DRAWS)], axis=0)
        references.save(name, problem, references.Reference(
            bare.times, *best, *floors, float(-np.log10(max(apart, 1e-34)))))
    return (f'{name}: two runs apart by {apart:.0e}, floor at the end {floors[0][-1]:.1e} rad, '
            f'{floors[1][-1]:.1e} rad/s')


def main():
    """Write plane_scenes.json."""
    made = {}
    for name, end in SCENES.items():
        samples = [end * (k + 1) / SAMPLES for k in range(SAMPLES)]
        rows, events = motion(Body(load_scene(name)), samples)
        made[name] = {'times': samples, 'events': events,
                      'orientations': [orientation(q) for q, _ in rows]}
        print(name, events, made[name]['orientations'][-1], flush=True)
    path = pathlib.Path(__file__).with_name('plane_scenes.json')
    path.write_text(json.dumps(made, indent=1) + '\n')


if __name__ == '__main__':
    if sys.argv[1:] == ['--references']:
        with ProcessPoolExecutor(2) as pool:
            for line in pool.map(reference, suite.ON_A_PLANE):
                print(line, flush=True)
    else:
        main()
