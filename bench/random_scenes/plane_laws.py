# SPDX-License-Identifier: Apache-2.0
"""A convex body on a plane, for the truth: Newton and Euler in the world frame, 64-bit mantissas.

Symbols: n unit normal of the plane (away from it), e1, e2 along it, gamma = n along the body, r
from the centre of mass to the lowest point P, s' the velocity of P over the surface, u = v + omega
x r the velocity of the body's point at P, w = n . omega. Unknowns, a row each: q (4), L (3,
angular momentum about the centre of mass), v and x (3 and 3, of the centre of mass), all along the
world.

What the plane can exert is a list of loads, each a force at P and a couple: N with all that goes
with it, and what holds a slip or a rolling. Each load changes the accelerations of P in
proportion, and the loads are those for which n . u' and what is held stay 0. Vectors are arrays
(3, rows).
"""

from typing import NamedTuple

import numpy as np

from random_scenes.laws import STEP, Laws, array
from random_scenes.wide import WIDE, inverse

ONE, OTHER = np.array([1, 2, 0]), np.array([2, 0, 1])
Z = np.array([0, 0, 1], dtype=WIDE)
CONTACTS = 'sliding_friction', 'rolling_friction', 'spinning_friction', 'air_film', 'strike'
SLIDE, STICK, SMOOTH = 'slide', 'stick', 'smooth'     # of P; without friction
MOVES, HELD, FREE = 'moves', 'held', 'free'           # of the rolling; without dry friction


def cross(a, b):
    """Return a x b of arrays (3, rows)."""
    return a[ONE] * b[OTHER] - a[OTHER] * b[ONE]


def dot(a, b):
    """Return a . b of arrays (3, rows)."""
    return (a * b).sum(0)


class Motion(NamedTuple):
    """How a body moves: vectors along the world, and gamma along the body."""

    R: np.ndarray
    omega: np.ndarray
    L: np.ndarray
    v: np.ndarray
    x: np.ndarray
    gamma: np.ndarray
    r: np.ndarray
    moved: np.ndarray     # s'
    u: np.ndarray


class Found(NamedTuple):
    """What acts, and how the body is accelerated.

    N, A (how N changes n . u', 1/kg), friction (2 or 3 numbers per row, N: along e1, e2, and about
    n over rho), holds (the force against a rolling that is held, N), slip and its rate (as
    friction).
    """

    rates: np.ndarray
    N: np.ndarray
    A: np.ndarray
    friction: np.ndarray
    holds: np.ndarray
    slip: np.ndarray
    grows: np.ndarray
    turned: np.ndarray    # omega', world


class Body:
    """The body of a scene, its plane, and the laws between them.

    Parameters
    ----------
    scene : Scene
    read : dict
        The scene file.
    """

    kind, axis, motion = 'free', None, None

    def __init__(self, scene, read):
        body = scene.body
        self.mass, self.center = WIDE(body.mass), array(body.center_of_mass)
        tensor = np.array(body.about_center.matrix, dtype=float).astype(WIDE)
        self.about_center = self.I = tensor[None]
        self.tensor, self.inverse = tensor[:, :, None], inverse(tensor[None])[0][:, :, None]
        self.arm = np.zeros(3, dtype=WIDE)
        (self.shape, size), = read['body']['surface'].items()
        self.size = array(size['semi_axes'] if self.shape == 'ellipsoid' else
                          [size['radius'], size.get('tube', 0.0), 0.0])
        self.middle = (array(size.get('center', [0.0] * 3)) - self.center)[:, None]
        plane = read['constraint'] if isinstance(read['constraint'], dict) else {}
        plane = plane.get('table') or {}
        normal = array(plane.get('normal', [0.0, 0.0, 1.0]))
        self.n = (normal / np.sqrt(normal @ normal))[:, None]
        self.restitution = WIDE(plane.get('restitution', 0.0))
        side = np.eye(3, dtype=WIDE)[int(np.argmin(np.abs(self.n[:, 0])))][:, None]
        self.e1 = cross(side, self.n) / size_of(cross(side, self.n))
        self.e2 = cross(self.n, self.e1)
        effects = [next(iter(one.items())) for one in read['effects']]
        laws = {name: one or {} for name, one in effects if name in CONTACTS}
        self.strikes = [one for name, one in effects if name == 'strike']
        self.jumps = sorted({x for name, one in effects if name == 'torque'
                             for x in one.get('times', ())}
                            | {one.get('time', 0.0) for one in self.strikes})
        self.mu = WIDE(laws.get('sliding_friction', {}).get('mu', 0.0))
        rolling = laws.get('rolling_friction', {})
        self.dry, self.viscous = (WIDE(rolling.get(key, 0.0)) for key in ('dry', 'viscous'))
        self.rho = WIDE(laws.get('spinning_friction', {}).get('radius', 0.0))
        self.film = WIDE(laws.get('air_film', {}).get('viscosity', 0.0))
        self.laws = Laws([one for one in effects if one[0] not in CONTACTS],
                         read.get('parameters', {}), self)
        self.since = WIDE(0)

    @property
    def is_disk(self):
        """Whether the surface is the sharp edge of a disk."""
        return self.shape == 'disk'

    @property
    def length(self):
        """A length of the body, m."""
        return self.size.max() + np.sqrt((self.middle ** 2).sum())

    def lowest(self, gamma):
        """Return the lowest point from the middle of the surface, along the body."""
        if self.shape == 'sphere':
            return -self.size[0] * gamma
        if self.shape == 'ellipsoid':
            D = (self.size * self.size)[:, None]
            return -D * gamma / np.sqrt((gamma * D * gamma).sum(0))
        around = gamma * np.array([1, 1, 0], dtype=WIDE)[:, None]
        return -self.size[1] * gamma - self.size[0] * around / size_of(around)

    def drawn(self, gamma, by):
        """Return how the lowest point moves over the body as gamma changes by a vector."""
        if self.shape == 'sphere':
            return -self.size[0] * by
        if self.shape == 'ellipsoid':
            D = (self.size * self.size)[:, None]
            wide = np.sqrt((gamma * D * gamma).sum(0))
            return -D * by / wide + D * gamma * ((gamma * D * by).sum(0) / wide ** 3)
        flat = np.array([1, 1, 0], dtype=WIDE)[:, None]
        around, turn = gamma * flat, by * flat
        wide = size_of(around)
        return -self.size[1] * by - self.size[0] * (
            turn / wide - around * ((around * turn).sum(0) / wide ** 3))

    def inclination(self, y):
        """Return the sine of the angle between the axis of a ring and the normal."""
        gamma = self.motion_of(y).gamma
        return size_of(gamma[:2])

    def motion_of(self, y):
        """Return the Motion of rows of unknowns."""
        y = y.T
        x, s = y[:3], y[3]
        double = 2 / (y[:4] ** 2).sum(0)
        R = double * (x[:, None] * x[None])
        for i in range(3):
            a, b = ONE[i], OTHER[i]
            R[i, i] += 1 - double * (x * x).sum(0)
            R[b, a] += double * s * x[i]
            R[a, b] -= double * s * x[i]
        L, v, place = y[4:7], y[7:10], y[10:13]
        omega = along(R, apply(self.inverse, back(R, L)))
        gamma = back(R, self.n)
        r = along(R, self.middle + self.lowest(gamma))
        moved = along(R, self.drawn(gamma, cross(gamma, back(R, omega))))
        return Motion(R, omega, L, v, place, gamma, r, moved, v + cross(omega, r))

    def gap(self, y):
        """Return how high the lowest point is above the plane, m."""
        at = self.motion_of(y)
        return dot(self.n, at.x + at.r)

    def spun(self, at, L):
        """Return how the angular velocity changes with the angular momentum."""
        return along(at.R, apply(self.inverse, back(at.R, L)))

    def slip(self, at, u=None, omega=None):
        """Return (u_1, u_2) or (u_1, u_2, rho w), or of accelerations given."""
        u, omega = at.u if u is None else u, at.omega if omega is None else omega
        rows = [dot(self.e1, u), dot(self.e2, u)]
        return np.stack(rows + [self.rho * dot(self.n, omega)] * int(self.rho > 0))

    def along_rim(self, at):
        """Return the unit vector along a disk's rim at P, along the body."""
        g = at.gamma
        wide = size_of(g[:2])
        return np.stack([-g[1] / wide, g[0] / wide, 0 * wide])

    def rolls(self, at):
        """Return s' along e1 and e2."""
        return np.stack([dot(self.e1, at.moved), dot(self.e2, at.moved)])

    def rolling_grows(self, y, rates):
        """Return how s' grows along e1 and e2, by a step along the imaginary axis."""
        return self.rolls(self.motion_of(y + 1j * STEP * rates)).imag / STEP

    def rim_rate(self, at):
        """Return e . (gamma x omega) of a disk, which is 0 when its rolling is held."""
        return dot(self.along_rim(at), cross(at.gamma, back(at.R, at.omega)))

    def wrench_of(self, at, h):
        """Return the couple of a force h (world) against the velocity s': its power is h . s'."""
        h = back(at.R, h)
        return along(at.R, cross(self.drawn(at.gamma, h), at.gamma))

    def free(self, at, y, t):
        """Return force and couple of all that does not go with N, world."""
        rows = np.concatenate((y[:, :4], back(at.R, at.omega).T, at.v.T, at.x.T), axis=1)
        rows[:, :4] /= np.sqrt((rows[:, :4] ** 2).sum(1))[:, None]
        force, torque, _ = self.laws.acting(rows, t, self.since)
        return force.T, along(at.R, torque.T)

    def rates(self, y, t):
        """Return y' of a body in flight."""
        at = self.motion_of(y)
        F, T = self.free(at, y, t)
        return self._packed(y, at, F / self.mass, T)

    def _packed(self, y, at, grown, turned):
        x, s = y.T[:3], y.T[3]
        return np.concatenate(((s * at.omega + cross(at.omega, x)) / 2, [-dot(at.omega, x) / 2],
                               turned, grown, at.v)).T

    def touching(self, y, t, mode, d=None, way=None):
        """Return Found of a body on the plane.

        Parameters
        ----------
        mode : tuple of 2 str
            Of the slip and of the rolling.
        d : array (2 or 3, rows), optional
            Direction of a slip; without it that of the unknowns.
        way : array (3, rows) or float, optional
            Direction of s' along the world; of a disk its sign.
        """
        at = self.motion_of(y)
        F, T = self.free(at, y, t)
        damped = self.viscous + 0 * at.x[0]
        if self.film > 0:
            damped = damped + self.film * PI * self.size[0] / (4 * size_of(at.gamma[:2]))
        T = T + self.wrench_of(at, -damped * at.moved)
        slip, ways = self.slip(at), []
        force, couple = self.n + 0 * at.r, 0 * at.r
        if mode[0] == SLIDE:
            d = slip / size_of(slip) if d is None else d
            force = force - self.mu * (d[0] * self.e1 + d[1] * self.e2)
            if self.rho > 0:
                couple = couple - self.mu * self.rho * d[2] * self.n
        if mode[1] == MOVES:
            couple = couple + self.wrench_of(at, -self.dry * self._way(at, way))
        ways.append((force, couple))
        if mode[0] == STICK:
            ways += [(self.e1 + 0 * at.r, 0 * at.r), (self.e2 + 0 * at.r, 0 * at.r)]
            if self.rho > 0:
                ways.append((0 * at.r, self.rho * self.n + 0 * at.r))
        if mode[1] == HELD and self.is_disk:
            ways.append((0 * at.r, self.wrench_of(at, along(at.R, self.along_rim(at)))))
        elif mode[1] == HELD:
            ways += [(0 * at.r, self.e1 + 0 * at.r), (0 * at.r, self.e2 + 0 * at.r)]
        return self._held(y, at, (F, T), ways, mode)

    def _way(self, at, way):
        if self.is_disk:
            sign = -self.rim_sign(at) if way is None else way
            return sign * along(at.R, self.along_rim(at))
        return at.moved / size_of(at.moved) if way is None else way

    def rim_sign(self, at):
        """Return the sign of -s' along the rim of a disk."""
        return np.sign(self.rim_rate(at))

    def _held(self, y, at, acts, ways, mode):
        """Find the loads for which what is held stays at rest; return Found."""
        F, T = acts
        carried = cross(at.omega, cross(at.omega, at.r) + at.moved)

        def asked(grown, omega, drift):
            u = grown + cross(omega, at.r) + drift * carried
            rows = [dot(self.n, u)]
            if mode[0] == STICK:
                rows += list(self.slip(at, u, omega))
            if mode[1] == HELD and self.is_disk:
                rows.append(self._rim_growth(at, omega, drift))
            elif mode[1] == HELD:
                rows += [dot(self.e1, omega), dot(self.e2, omega)]
            return np.stack(rows)
        omega0 = self.spun(at, T - cross(at.omega, at.L))
        b = asked(F / self.mass, omega0, 1)
        turns = [cross(at.r, f) + c for f, c in ways]
        M = np.stack([asked(f / self.mass, self.spun(at, turn), 0)
                      for (f, _), turn in zip(ways, turns, strict=True)], axis=1)
        loads = solved(M, -b)
        total = sum(z * f for z, (f, _) in zip(loads, ways, strict=True)) + F
        turned = sum(z * turn for z, turn in zip(loads, turns, strict=True)) + T
        omega = self.spun(at, turned - cross(at.omega, at.L))
        u = total / self.mass + cross(omega, at.r) + carried
        count = len(self.slip(at))
        friction = loads[1:1 + count] if mode[0] == STICK else 0 * self.slip(at)
        holds = loads[:1] * 0
        if mode[1] == HELD:
            holds = loads[-1:] if self.is_disk else self._against(at, loads[-2:])
        return Found(self._packed(y, at, total / self.mass, turned), loads[0], M[0, 0], friction,
                     holds, self.slip(at), self.slip(at, u, omega), omega)

    def _rim_growth(self, at, grown, drift):
        """Return the rate of rim_rate under omega' (world)."""
        e, g, omega = self.along_rim(at), at.gamma, back(at.R, at.omega)
        turned = cross(g, back(at.R, grown))
        if not drift:
            return dot(e, turned)
        g1 = cross(g, omega)
        wide = size_of(g[:2])
        raw = np.stack([-g1[1] / wide, g1[0] / wide, 0 * wide])
        e1 = raw - e * dot(e, raw)
        return dot(e, turned) + dot(e1, g1) + dot(e, cross(g1, omega))

    def _against(self, at, couple):
        """Return h along the plane of which couple (e1, e2) is the wrench: n x couple = S h."""
        c = couple[0] * self.e1 + couple[1] * self.e2
        wanted = cross(self.n, c)
        by = [along(at.R, self.drawn(at.gamma, back(at.R, e + 0 * at.r)))
              for e in (self.e1, self.e2)]
        M = np.stack([np.stack([dot(self.e1, s), dot(self.e2, s)]) for s in by], axis=1)
        return solved(M, np.stack([dot(self.e1, wanted), dot(self.e2, wanted)]))


def apply(matrix, v):
    """Return a matrix (3, 3, rows) times v."""
    return (matrix * v[None]).sum(1)


along = apply


def back(matrix, v):
    """Return the transposed matrix (3, 3, rows) times v."""
    return (matrix * v[:, None]).sum(0)


def size_of(v):
    """Return |v| of an array (n, rows)."""
    return np.sqrt((v * v).sum(0))


def solved(M, b):
    """Solve M x = b of arrays (n, n, rows) and (n, rows), by Gauss with pivots row by row."""
    n = len(b)
    M = np.concatenate((M, b[:, None]), axis=1)
    rows = np.arange(M.shape[2])
    for k in range(n):
        best = k + np.abs(M[k:, k]).argmax(0)
        if (best != k).any():
            here, there = M[k].copy(), M[best, :, rows].T
            M[best, :, rows], M[k] = here.T, there
        M[k] = M[k] / M[k, k]
        for i in range(n):
            if i != k:
                M[i] = M[i] - M[i, k] * M[k]
    return M[:, n]


PI = 4 * np.arctan(WIDE(1))
