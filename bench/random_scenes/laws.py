# SPDX-License-Identifier: Apache-2.0
"""Forces and torques of a scene's effects, for the truth: Newton's and Euler's right-hand sides.

Python evaluates expressions. What has a kink (abs, sign, min, max, where, comparisons, dry
friction) asks ``Sides`` on which side of it the body is, so that each right-hand side is smooth.
"""

import ast
import re

import numpy as np

from random_scenes.wide import WIDE, back, cross, rotated, times

Z = np.array([0, 0, 1], dtype=WIDE)
SMOOTH = 'sin', 'cos', 'exp', 'log', 'sqrt', 'tanh'
STEP = WIDE(1e-40)      # along the imaginary axis

QUARTER = 2 * np.arctan(WIDE(1))    # of a turn, rad


class Sides:
    """On which side of its kinks a body is.

    Attributes
    ----------
    modes : list of int
        1, -1, or 0 of what rests; in the order in which the kinks are met.
    found : list of float
        The switches at the last evaluation: a side changes where one passes zero.
    """

    def __init__(self):
        self.modes, self.found = [], []

    def begin(self):
        """Forget the switches of the last evaluation."""
        self.found = []

    def side(self, switch):
        """Return the side of the next kink; at first the sign of its switch."""
        side = self.of_next(switch)
        self.found.append(switch[0].real)
        return side

    def of_next(self, switch):
        """Return what `side` will return, of a switch that has the same sign at first."""
        k = len(self.found)
        if k == len(self.modes):
            self.modes.append(1 if switch[0].real > 0 else -1)
        return self.modes[k]

    @property
    def functions(self):
        """What expressions call, by name."""
        def pick(x, y, first):
            return x + 0 * y if first else y + 0 * x

        def sign(x):
            return self.side(x) + 0 * x

        def where(found, x, y):
            return found * x + (1 - found) * y
        return {'abs': lambda x: self.side(x) * x, 'sign': sign, 'where': where,
                'max': lambda x, y: pick(x, y, self.side(x - y) > 0),
                'min': lambda x, y: pick(x, y, self.side(x - y) < 0),
                'less': lambda x, y: (1 + sign(y - x)) / 2}


class _Compared(ast.NodeTransformer):
    """Comparisons as calls of ``less``."""

    def visit_Compare(self, node):
        self.generic_visit(node)
        pair = [node.left, node.comparators[0]]
        if isinstance(node.ops[0], ast.Gt | ast.GtE):
            pair.reverse()
        return ast.Call(ast.Name('less', ast.Load()), pair, [])


def code(text):
    """Return an expression of a scene, compiled."""
    tree = _Compared().visit(ast.parse(text.replace('^', '**'), mode='eval'))
    return compile(ast.fix_missing_locations(tree), text, 'eval')


def array(numbers):
    """Return numbers as doubles, then as 80-bit ones: what the scene has, to the bit."""
    return np.array(numbers, dtype=float).astype(WIDE)


def is_text(one):
    """Return whether the value or field of an effect is an expression."""
    return any(isinstance(part, str) for part in one.get('value', one.get('field', ())))


def timed(one):
    """Return whether the field of a magnet depends on the time."""
    return any(re.search(r'\bt\b', str(part)) for part in one['field'])


def value_at(one, t):
    """Return the torque just after a time."""
    if 'value' in one:
        return one['value']
    later = [value for begin, value in zip(one['times'], one['values'], strict=True) if begin <= t]
    return later[-1] if later else [0.0, 0.0, 0.0]


class Laws:
    """The effects of a scene.

    Parameters
    ----------
    effects : list of (str, dict)
    parameters : dict of str to float
    held : object
        Has mass, center, arm, about_center, I and axis of the body (truth.py).
    """

    def __init__(self, effects, parameters, held):
        self.effects, self.held, self.sides = effects, held, Sides()
        self.parameters = {name: WIDE(value) for name, value in parameters.items()}
        self._codes = {}
        self.friction, self.grip = None, None    # its place among the sides; the torque it bears
        self.wound = 0    # the energy of torsion springs at the last evaluation, J
        self.point = 0    # where the held point is, less its path
        if held.kind != 'free':
            behind, first = (held.arm - held.center)[None], held.y[:1]
            self.point = (held.origin - rotated(first[:, :4], behind)[0]
                          - self._moved(first[:, 4:7], WIDE(0))[0])

    def acting(self, y, t, since):
        """Return force (world), torque about the centre of mass (body) and extra turning.

        `t` is a time or one for each row, `since` that from which pieces of torques act.
        """
        q, w, v, c = y[:, :4], y[:, 4:7], y[:, 7:10], y[:, 10:]
        held, known, loosened, pulled = self.held, None, None, 0
        force, torque = np.zeros_like(w), np.zeros_like(w)
        moved = self._moved(w, t)
        if held.kind != 'free':
            v = rotated(q, cross(w, held.arm[None])) + moved[1]
        self.sides.begin()
        self.wound = 0
        for name, one in self.effects:
            if name == 'gravity':
                g = one['g']
                weight = held.mass * (array(g) if isinstance(g, list) else -WIDE(g) * Z) + 0 * w
                force, pulled = force + weight, pulled + self._about(q, weight)
            elif name == 'torque' and not is_text(one):
                value = array(value_at(one, since))[None] + 0 * w
                torque = torque + (back(q, value) if one.get('frame') == 'world' else value)
            elif name == 'drag':
                force = force + rotated(q, _dragged(one, '', 'linear', back(q, v)))
                torque = torque + _dragged(one, 'angular_', 'angular', w)
            elif name == 'internal_dissipation':
                loosened = WIDE(one['coefficient'])
            elif name == 'gravity_gradient':
                n, share = _away(one, t, w)
                n = back(q, n)
                tensor = held.about_center    # less a sphere, which adds terms that cancel
                sphere = tensor[:, :1, :1] * np.eye(3, dtype=WIDE)
                G = share * cross(n, times(tensor - sphere, n))
                torque, pulled = torque + G, pulled + ('mu' in one) * G
            elif name == 'rotor':
                torque = torque + _rotor(one, w, t)
            elif name == 'dry_friction':
                self.friction, self.grip = len(self.sides.found), WIDE(one['torque'])
                side = self.sides.side((w * held.axis).sum(1))
                torque = torque - side * WIDE(one['torque']) * held.axis
            elif name == 'spring' and 'at' not in one:
                torque = torque + self._torsion(one, q, w)
            elif name != 'strike':
                known = known or self._known(q, w, v, c, t, moved)
                F, G = self._field(name, one, known)    # world at the centre of mass, body
                force, torque = force + F, torque + G
                if name == 'spring' and one.get('damping'):
                    F, G = self._field(name, one | {'damping': 0.0}, known)
                if name in ('potential', 'spring') or (name == 'magnetic' and not timed(one)):
                    pulled = pulled + G + self._about(q, F)
        if held.motion is not None:
            force = force - held.mass * moved[2]    # seen from the pivot
        if loosened is None:
            return force, torque, 0
        return force, torque, loosened * (cross(times(held.I, w), w) + pulled)

    def _about(self, q, force):
        """Return the moment of a force at the centre of mass about the held point, body axes."""
        return cross(self.held.arm[None], back(q, force))

    def _moved(self, w, t):
        """Return place, velocity and acceleration of the held point, from where it began."""
        if self.held.motion is None:
            return (0 * w,) * 3
        return [self._vector(texts, {'t': t + 0 * w[:, 0]}) for texts in self.held.motion]

    def _torsion(self, one, q, w):
        n, k = self.held.axis, WIDE(one['stiffness'])
        turned, rate = self.turned(q) - WIDE(one.get('angle', 0.0)), (w * n).sum(1)
        self.wound += k / 2 * turned[0] ** 2
        pull = k * turned + WIDE(one.get('damping', 0.0)) * rate
        return -pull[:, None] * n

    def turned(self, q):
        """Return the angle of a hinge, rad.

        Where a law jumps at its ends, -2 pi and 2 pi, each is a kink: the side 1 continues the
        angle by 2 pi/3 beyond 2 pi, and up to there beyond -2 pi/3, where the side changes too.
        """
        s, c = (q[:, :3] * self.held.axis).sum(1), q[:, 3]
        angle = 2 * np.arctan2(s, c)
        if not self.held.winds:
            return angle
        side = self.sides.of_next(s)
        self.sides.side(np.where(c < 0.5, s, side))
        return angle + np.where((c < -0.5) & (side * s < 0), 8 * QUARTER * side, 0)

    def _known(self, q, w, v, c, t, moved):
        """Return what expressions know, by name; o and vo are place and velocity of the origin."""
        held = self.held
        center = held.center[None] + 0 * w
        if held.kind == 'free':
            o = c - rotated(q, center)
            vo = v - rotated(q, cross(w, center))
        else:
            behind = (held.arm - held.center)[None] + 0 * w    # from the held point to the origin
            o = self.point + moved[0] + rotated(q, behind)
            vo = moved[1] + rotated(q, cross(w, behind))
        W = rotated(q, w)
        names = {'t': t + 0 * w[:, 0], 'q': q, 'w': w, 'o': o, 'vo': vo}
        for group, of in (('x y z', o), ('vx vy vz', vo), ('qx qy qz qw', q), ('wx wy wz', w),
                          ('Wx Wy Wz', W)):
            names |= {name: of[:, k] for k, name in enumerate(group.split())}
        if held.axis is not None:
            names |= {'angle': self.turned(q), 'rate': (w * held.axis).sum(1)}
        return names

    def _vector(self, texts, known):
        """Return expressions, evaluated row by row."""
        names = {name: getattr(np, name) for name in SMOOTH}
        names |= known | self.parameters | self.sides.functions
        zero, parts = 0 * known['t'], []
        for one in texts:
            if isinstance(one, str):
                if one not in self._codes:
                    self._codes[one] = code(one)
                parts.append(zero + eval(self._codes[one], {}, names))
            else:
                parts.append(zero + WIDE(one))
        return np.stack(parts, axis=1)

    def _field(self, name, one, known):
        """Return force (world) and its torque about the centre of mass and others (body)."""
        q = known['q']
        if name == 'potential' or (name == 'magnetic' and is_text(one)):
            return self._by_steps(name, one, known)
        if name == 'torque':
            value = self._vector(one['value'], known)
            return 0, back(q, value) if one.get('frame') == 'world' else value
        if name == 'magnetic':
            field = self._vector(one['field'], known)
            return 0 * known['o'], cross(array(one['moment'])[None], back(q, field))
        if name == 'force':
            at = array(one['at']) if 'at' in one else self.held.center
            F = self._vector(one['value'], known)
            F = F if one.get('frame') == 'world' else rotated(q, F)
        else:
            at = array(one['at'])
            F = _pull(one, at, known)
        return F, cross((at - self.held.center)[None], back(q, F))

    def _by_steps(self, name, one, known):
        """Return force and torque of an energy, by steps along the imaginary axis."""
        q, o = known['q'], known['o']

        def slope(turned, moved, along=0):
            inner = dict(zip(('t', 'qx', 'qy', 'qz', 'qw', 'x', 'y', 'z'),
                             (known['t'], *turned.T, *moved.T), strict=True))
            if 'angle' in known:
                inner['angle'] = known['angle'] + 1j * STEP * along
            if name == 'potential':
                energy = self._vector([one['energy']], inner)[:, 0]
            else:
                m = array(one['moment'])[None] + 0 * o
                energy = -(rotated(turned, m) * self._vector(one['field'], inner)).sum(1)
            return -energy.imag / STEP
        wide = np.clongdouble
        F = np.stack([slope(q.astype(wide), o + 1j * STEP * np.eye(3, dtype=WIDE)[k])
                      for k in range(3)], axis=1)
        G = []
        for e in np.eye(3, dtype=WIDE):
            u = cross(q[:, :3], e) + q[:, 3:] * e
            by = np.concatenate((u, -(q[:, :3] @ e)[:, None]), axis=1) / 2
            along = 0 if self.held.axis is None else e @ self.held.axis
            G.append(slope(q + 1j * STEP * by, o.astype(wide), along))
        # the force acts at the origin
        return F, np.stack(G, axis=1) - cross(self.held.center[None], back(q, F))


def _dragged(one, prefix, first, v):
    """Return -(C + |v| D) v for the coefficients of one kind."""
    total = 0 * v
    for key, size in ((first, 1), (f'{prefix}quadratic', np.sqrt((v * v).sum(1))[:, None])):
        matrix = array(one.get(key, 0.0))
        if matrix.ndim:
            total = total - size * times((matrix + matrix.T)[None] / 2, v)
        else:
            total = total - matrix * size * v
    return total


def _away(one, t, w):
    """Return the direction from what attracts, world axes, and 3 mu/r^3."""
    if 'orbit' not in one:
        place = array(one['position'])
        r = np.sqrt(place @ place)
        return place[None] / r + 0 * w, 3 * WIDE(one['mu']) / r ** 3
    orbit = one['orbit']
    rate = WIDE(orbit['rate'])
    normal, toward = (array(orbit[key]) for key in ('normal', 'toward'))
    normal, toward = normal / np.sqrt(normal @ normal), toward / np.sqrt(toward @ toward)
    angle = (rate * t + 0 * w[:, 0])[:, None]
    return np.cos(angle) * toward + np.sin(angle) * cross(normal, toward), 3 * rate ** 2


def _rotor(one, w, t):
    """Return the torque of a flywheel on its body."""
    a = array(one['axis'])
    a = a / np.sqrt(a @ a)
    motor = WIDE(one.get('torque', 0.0))
    h = (WIDE(one['momentum']) if 'momentum' in one
         else WIDE(one['inertia']) * WIDE(one['rate']) + motor * t)
    h = np.zeros(len(w), dtype=WIDE) + h
    return -cross(w, h[:, None] * a) - motor * a


def _pull(one, at, known):
    """Return the force of a spring on its point, world axes."""
    q, k, c = known['q'], WIDE(one['stiffness']), WIDE(one.get('damping', 0.0))
    arm = at[None] + 0 * known['w']
    d = known['o'] + rotated(q, arm) - array(one['anchor'])
    v = known['vo'] + rotated(q, cross(known['w'], arm))
    if 'length' not in one:
        return -k * d - c * v
    size = np.sqrt((d * d).sum(1))[:, None]
    n = d / size
    return -(k * (size - WIDE(one['length'])) + c * (n * v).sum(1)[:, None]) * n
