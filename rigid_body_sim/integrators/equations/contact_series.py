# SPDX-License-Identifier: Apache-2.0
"""The Taylor series of a convex body on a plane: the source of their recurrences, by phase.

The equations are those of contact_rates.py under a uniform field, in a form with few products of
series. Symbols: mechanics/contact/laws.py, scene/surfaces.py. Besides, R is the matrix of q, with
the rows e1, e2, e3 = gamma; c = omega x r, h = (I - i 1) omega, which has the gyroscopic torque of
I omega (mechanics/contact/parameters.py: uneven), V velocity of the centre of mass, F the weight;
f, r, c, omega and h have components along the axes of the body. Primes are derivatives by the
variable of the phase: the time t, or where the body slides s with dt = P ds, P = |u|.

    FLIGHT    q' = q omega/2,  I omega' = h x omega,  m V' = F,  gap from z + gamma . r
    ROLLING   q' = q omega/2,  f = -m (c' + omega x c) - R^T F,  I omega' = r x f + h x omega
    SLIDING   w = P omega,  q' = q w/2,  g = P f = (-mu N u_1, -mu N u_2, N P) along the plane,
              I omega' = r x R^T g + h x w,  V = u - R c,  m V' = g + P F
    GLIDING   SLIDING with P = 1 and mu = 0

The part of r x f by what is along gamma, N and the weight, goes with r x gamma, of which the part
of r along gamma has been left out (scene/surfaces.py: tilted): its rounding would be much beside a
small friction.

Viscous rolling friction and a film of air add a couple to I omega'. In each phase of contact, with
S = dr/dgamma (scene/surfaces.py), it and its heat are

    -(c + c_film/sin a) d,   (c + c_film/sin a) d . omega,   d = (S r') x gamma

The coefficient k - 1 of r' is k times that of r, which is known without the coefficient k of
omega.

A pass of the loop makes the coefficients k of q, omega, u and of what follows from them without a
derivative, and the coefficients k - 1 of rates and forces. Of these the coefficient k of omega in
c', and N in g, are found last: what is known without them leaves a linear equation, whose matrix
is that of order 0.

Every product of series has a column. Its sum without the coefficients that the pass makes is taken
for all columns at once, in vector code. The factor that is wanted one order before the other one
stands one row later.
"""

from typing import NamedTuple

from rigid_body_sim.compilation.lanes import LANES
from rigid_body_sim.integrators.equations.contact_views import FLIGHT, ROLLING, SLIDING, UNKNOWNS
from rigid_body_sim.integrators.marching.taylor_series import ORDER
from rigid_body_sim.scene.surfaces import ELLIPSOID, TORUS

MOST, MORE = 96, 112        # columns of a work space; of one with couples of friction
CYCLE = (1, 2), (2, 0), (0, 1)
Q, OMEGA, U, PLACE, GAP, TIME = (UNKNOWNS.part(name).first for name in (
    'q', 'omega', 'u', 'place', 'gap', 'time'))
SLID, ROLLED, FILMED = (UNKNOWNS.part('ledger').part(name).first
                        for name in ('slid', 'rolled', 'filmed'))
IMPULSE = UNKNOWNS.part('ledger').part('impulse').first
NORMAL, FRICTION, INCLINED = range(UNKNOWNS.size, UNKNOWNS.size + 3)
"""Watched series: N, the square of the rest of f, and the sine of the inclination of a ring."""
WIDTH = LANES * -(-(UNKNOWNS.size + 3) // LANES)    # series of a row, in whole vectors
HEAD = """
import math

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.integrators.equations.contact_views import SLIDING, UNKNOWNS
from rigid_body_sim.mechanics.contact.forces import posture
from rigid_body_sim.mechanics.contact.parameters import CONTACT
from rigid_body_sim.numerics.vectors import (
    apply, cross, dot, minus, plus, product, scaled)
from rigid_body_sim.scene.painleve import inverse_of
from rigid_body_sim.scene.surfaces import TINY

load_contact, load_unknowns = CONTACT.load, UNKNOWNS.load


@compiled
def sums(L, M, P, k):
    for n in range({count}):
        P[n] = 0.0
    for j in range(1, k):
        a, b = L[j], M[k - j]
        for n in range({count}):
            P[n] += a[n] * b[n]


@compiled
def expand(p, L, M, P, S, y):"""
STARTS = """
c, now = load_contact(p), load_unknowns(y)
at = posture(c, now.q, now.omega)
q, omega, r, carried = at.q, at.omega, at.r, at.carried
e1, e2, e3 = at.axes
Fx, Fy, Fz = p[-3], p[-2], p[-1]
lightness = 1.0 / c.mass
h = apply(c.uneven, omega)
"""
OF_SURFACE = {ELLIPSOID: """
pulled = product(product(c.size, c.size), e3)
squares = product(c.size, c.size)
sigma = math.sqrt(dot(e3, pulled))
inverse_sigma = 1.0 / sigma
half_sigma = 0.5 * inverse_sigma
over = scaled(inverse_sigma, pulled)
a, b, d = c.size
differs = (b - d) * (b + d) / (b * b), (d - a) * (d + a) / (d * d), (a - b) * (a + b) / (a * a)
""", TORUS: """
across = math.sqrt(e3[0] * e3[0] + e3[1] * e3[1]) + TINY
inverse_across = 1.0 / across
half_across = 0.5 * inverse_across
along = scaled(inverse_across, e3)
"""}
OF_FLIGHT = """
v, a = now.u, scaled(lightness, (Fx, Fy, Fz))
"""
OF_ROLLING = """
square = c.mass * dot(r, r)
solved = inverse_of((
    minus(plus(c.inertia[0], (square, 0.0, 0.0)), scaled(c.mass * r[0], r)),
    minus(plus(c.inertia[1], (0.0, square, 0.0)), scaled(c.mass * r[1], r)),
    minus(plus(c.inertia[2], (0.0, 0.0, square)), scaled(c.mass * r[2], r))))
"""
OF_SLIDING = """
u, mu, pace, half_pace = now.u, 0.0, 1.0, 0.0
if c.mode == SLIDING:
    mu, pace = c.mu, math.sqrt(u[0] * u[0] + u[1] * u[1])
    half_pace = 0.5 / pace
v = u[0] - dot(e1, carried), u[1] - dot(e2, carried)
# what N = 1 does
unit = (-mu * u[0], -mu * u[1], pace)
pushed = plus(scaled(unit[0], e1), scaled(unit[1], e2))
wrung = plus(cross(r, pushed), scaled(pace, at.tilting))
spun = apply(c.inverse, wrung)
swung = cross(spun, r)
rolled = apply(at.axes, swung)
yielding = 1.0 / (lightness * pace + rolled[2])
"""
"""What the coefficients of order 0 give, once in a step."""


class Friction(NamedTuple):
    """The couples of friction on a body in contact, and what they need to know of its surface.

    Attributes
    ----------
    viscous, film : bool
        Whether viscous rolling friction and a film of air act.
    sharp : bool
        Whether a ring is a disk: its tube has the radius 0.
    """

    viscous: bool
    film: bool
    sharp: bool


NO_FRICTION = Friction(False, False, False)


class Part(NamedTuple):
    """A series in the source: the texts of its first coefficient and of the one that a pass has.

    In a product with a factor of lower order that is the coefficient of that order.
    """

    first: str
    now: str


class Recurrences:
    """The lines of a pass, and the columns of its products.

    Attributes
    ----------
    lines : list of str
    """

    def __init__(self):
        self.lines, self._columns, self._late, self._count = [], [], {}, 0

    def let(self, text):
        """Return the name of a new number."""
        self._count += 1
        self.lines.append(f't{self._count} = {text}')
        return f't{self._count}'

    def put(self, name, texts):
        """Return the names of numbers that a pass makes: `name` with 0, 1, ..."""
        self.lines += [f'{name}{i} = {text}' for i, text in enumerate(texts)]
        return [f'{name}{i}' for i in range(len(texts))]

    def vector(self, first, texts):
        """Return the Parts of a vector whose first coefficients are called `first`."""
        return tuple(Part(f'{first}[{i}]', self.let(text)) for i, text in enumerate(texts))

    def late(self, parts):
        """Return the names of the coefficients k - 1 of series."""
        return [self._late.setdefault(part.now, (f'late{len(self._late)}', part.first))[0]
                for part in parts]

    def column(self, a=None, b=None):
        """Return (text of its sum, number) of a new column, given its factors' coefficients."""
        self._columns.append((a, b))
        place = len(self._columns) - 1
        return f'P[{place}]', place

    def fill(self, place, a, b):
        """Give a column its factors' coefficients."""
        self._columns[place] = a, b

    def product(self, a, b):
        """Return the text of the coefficient k of a product, both known at that order."""
        return f'{self.column(a.now, b.now)[0]} + {a.first} * {b.now} + {a.now} * {b.first}'

    def before(self, a, b):
        """Return the text of the coefficient k - 1 of a product of a Part and a name."""
        return f'{self.column(a.now, b)[0]} + {a.first} * {b}'

    def summed(self, one, other, product):
        """Return the text of a scalar product."""
        return ' + '.join(product(a, b) for a, b in zip(one, other, strict=True))

    def crossed(self, a, b):
        """Return the texts of the coefficients k - 1 of a x b, of Parts and names."""
        return [f'{self.before(a[i], b[j])} - ({self.before(a[j], b[i])})' for i, j in CYCLE]

    def root(self, square, first, half):
        """Return the Part of a root, given its square and 1/2 over its first coefficient."""
        inner, place = self.column()
        found = Part(first, self.let(f'({square} - {inner}) * {half}'))
        self.fill(place, found.now, found.now)
        return found

    def quotient(self, a, b, first, inverse):
        """Return the Part of a/b; `inverse` is 1 over the first coefficient of b."""
        inner, place = self.column()
        found = Part(first, self.let(f'({a.now} - {inner} - {b.now} * {first}) * {inverse}'))
        self.fill(place, b.now, found.now)
        return found

    def quotient_before(self, text, b, inverse):
        """Return the name of the coefficient k - 1 of a/b, given the text of that of a."""
        inner, place = self.column()
        found = self.let(f'({text} - ({inner})) * {inverse}')
        self.fill(place, b.now, found)
        return found

    def replace(self, found):
        """Let columns hold other coefficients, name -> name, than those in the lines so far."""
        self._columns = [(found.get(a, a), found.get(b, b)) for a, b in self._columns]

    def source(self, starts, values):
        """Return the source of ``expand(p, L, M, P, S, y)``, which fills S.

        Parameters
        ----------
        starts : str
            Lines before the loop.
        values : dict
            Place of an unknown -> the text of its coefficient k; the other ones do not change.
        """
        again = {late: now for now, (late, _) in self._late.items()}
        before = [*starts.splitlines(),
                  *(f'{late} = {first}' for late, first in self._late.values())]
        passes = [
            'share = 1.0 / k', 'sums(L, M, P, k)', *self.lines,
            *(f'S[k, {place}] = {values.get(place, "0.0")}' for place in range(UNKNOWNS.size)),
            *(f'{side}[k, {n}] = {one}' for n, pair in enumerate(self._columns)
              for side, one in zip('LM', pair, strict=True)),
            *(f'{late} = {now}' for late, now in again.items())]
        return '\n'.join([
            HEAD.format(count=LANES * -(-len(self._columns) // LANES)),
            *(f'    {line}' for line in before if line),
            f'    for k in range(1, {ORDER + 1}):',
            *(f'        {line}' for line in passes), ''])


SPIN = [Part(f'omega[{i}]', f'omega{i}') for i in range(3)]
UNEVEN = [Part(f'h[{i}]', f'h{i}') for i in range(3)]


def _transformed(matrix, texts):
    """Return the texts of a matrix of numbers times a vector."""
    return [' + '.join(f'{matrix}[{i}][{j}] * {text}' for j, text in enumerate(texts))
            for i in range(3)]


def _places(first, texts):
    """Return place -> text."""
    return dict(enumerate(texts, first))


def _halved(texts):
    return [f'share * ({text})' for text in texts]


def _turned(made, w):
    """Let a pass make q, of q' = q w/2; return its Parts. w are names."""
    q = x, y, z, v = [Part(f'q[{i}]', f'q{i}') for i in range(4)]
    a, b, c = w
    terms = (((v, a), (y, c), (z, b)), ((v, b), (z, a), (x, c)), ((v, c), (x, b), (y, a)),
             ((x, a), (y, b), (z, c)))
    *ones, last = [[f'({made.before(*pair)})' for pair in row] for row in terms]
    made.put('q', [f'0.5 * share * ({one} + {two} - {three})' for one, two, three in ones]
             + [f'-0.5 * share * ({" + ".join(last)})'])
    return q


def _axes(made, q, rows):
    """Return the Parts of e1, e2, e3, or of e3 alone."""
    x, y, z, w = q

    def twice(one, other):
        return made.let(made.product(one, other))
    xz, yw, yz, xw, xx, yy = (twice(*pair) for pair in (
        (x, z), (y, w), (y, z), (x, w), (x, x), (y, y)))
    third = made.vector('e3', (f'2.0 * ({xz} - {yw})', f'2.0 * ({yz} + {xw})',
                               f'-2.0 * ({xx} + {yy})'))
    if rows == 1:
        return [third]
    zz, xy, zw = twice(z, z), twice(x, y), twice(z, w)
    first = made.vector('e1', (f'-2.0 * ({yy} + {zz})', f'2.0 * ({xy} - {zw})',
                               f'2.0 * ({xz} + {yw})'))
    second = made.vector('e2', (f'2.0 * ({xy} + {zw})', f'-2.0 * ({xx} + {zz})',
                                f'2.0 * ({yz} - {xw})'))
    return [first, second, third]


def _lever(made, kind, gamma):
    """Return the Parts of r, and those that its derivative is made of.

    The latter are a vector and its divisor: over and sigma of an ellipsoid, along and across of a
    ring. The divisor of a ring is the sine of its inclination.
    """
    if kind == ELLIPSOID:
        pulled = made.vector('pulled', [f'squares[{i}] * {one.now}'
                                        for i, one in enumerate(gamma)])
        sigma = made.root(made.summed(gamma, pulled, made.product), 'sigma', 'half_sigma')
        over = [made.quotient(one, sigma, f'over[{i}]', 'inverse_sigma')
                for i, one in enumerate(pulled)]
        return made.vector('r', [f'-{one.now}' for one in over]), (over, sigma)
    if kind == TORUS:
        level = gamma[:-1]
        across = made.root(made.summed(level, level, made.product), 'across', 'half_across')
        along = [made.quotient(one, across, f'along[{i}]', 'inverse_across')
                 for i, one in enumerate(level)]
        texts = [f'-c.size[1] * {one.now} - c.size[0] * {other.now}'
                 for one, other in zip(level, along, strict=True)]
        return made.vector('r', [*texts, f'-c.size[1] * {gamma[2].now}']), (along, across)
    return made.vector('r', [f'-c.size[0] * {one.now}' for one in gamma]), None


def _tilting(made, kind, gamma, outline):
    """Return the Parts of r x gamma, given what `_lever` returns."""
    texts = [f'c.middle[{i}] * {gamma[j].now} - c.middle[{j}] * {gamma[i].now}' for i, j in CYCLE]
    if kind == ELLIPSOID:
        over, _ = outline
        texts = [f'{text} - differs[{n}] * ({made.product(over[i], gamma[j])})'
                 for n, (text, (i, j)) in enumerate(zip(texts, CYCLE, strict=True))]
    if kind == TORUS:
        (x, y), _ = outline
        texts[0] += f' - c.size[0] * ({made.product(y, gamma[2])})'
        texts[1] += f' + c.size[0] * ({made.product(x, gamma[2])})'
    return made.vector('at.tilting', texts)


def _dual(made, kind, sharp, gamma, moved, outline):
    """Return the names of d, in the order k - 1; `moved` are those of r'."""
    if kind == ELLIPSOID:
        over, sigma = outline
        along = made.let(made.summed(over, moved, made.before))
        moved = [made.quotient_before(f'squares[{i}] * {one} - ({made.before(over[i], along)})',
                                      sigma, 'inverse_sigma') for i, one in enumerate(moved)]
        return [made.let(text) for text in made.crossed(gamma, moved)]
    if kind != TORUS:
        return [made.let(f'c.size[0] * ({text})') for text in made.crossed(gamma, moved)]
    # S r' = -b r' - n t,  n = (a/sin a) t . r',  t = (-along_2, along_1, 0)
    along, across = outline
    rim = made.let(f'c.size[0] * ({made.before(along[0], moved[1])} - '
                   f'({made.before(along[1], moved[0])}))')
    bent = made.let(made.before(gamma[2], made.quotient_before(rim, across, 'inverse_across')))
    texts = [*(f'-({made.before(one, bent)})' for one in along), rim]
    if not sharp:
        texts = [f'{one} + c.size[1] * ({other})'
                 for one, other in zip(texts, made.crossed(gamma, moved), strict=True)]
    return [made.let(text) for text in texts]


def _couples(made, kind, friction, gamma, r, outline):
    """Let a pass make the couples of friction.

    Returns
    -------
    couple : list of str
        What they add to a sum of couples: texts of the coefficients k - 1, or empty.
    heats : dict
        Place in the ledger -> text of the coefficient k.
    """
    couple, heats = ['', '', ''], {}
    if not (friction.viscous or friction.film):
        return couple, heats
    dual = _dual(made, kind, friction.sharp, gamma, [made.let(f'k * {one.now}') for one in r],
                 outline)
    parts = []
    if friction.viscous:
        parts.append(('c.rolling_viscous', ROLLED, dual))
    if friction.film:
        parts.append(('c.film', FILMED, [made.quotient_before(one, outline[1], 'inverse_across')
                                         for one in dual]))
    for coefficient, place, names in parts:
        couple = [f'{text} - {coefficient} * {one}'
                  for text, one in zip(couple, names, strict=True)]
        heats[place] = f'share * {coefficient} * ({made.summed(SPIN, names, made.before)})'
    return couple, heats


def _carried(made, r):
    """Return the texts of c at order k without omega at that order."""
    made_of = []
    for i, j in CYCLE:
        one, other = (made.column(SPIN[a].now, r[b].now)[0] + f' + {SPIN[a].first} * {r[b].now}'
                      for a, b in ((i, j), (j, i)))
        made_of.append(f'{one} - ({other})')
    return made_of


def _grown(names):
    """Return the texts of what a coefficient k of omega adds to c."""
    return [f'{names[i]} * r[{j}] - {names[j]} * r[{i}]' for i, j in CYCLE]


def _watch(made, kind, normal, square, outline):
    """Let a pass store the watched series: N and the square at the orders that it has of them."""
    made.lines.append(f'S[k - 1, {NORMAL}] = {normal}')
    if square:
        made.lines.append(f'S[max(k - 2, 0), {FRICTION}] = {square}')
    _incline(made, kind, outline)


def _incline(made, kind, outline):
    """Let a pass store the series of the inclination of a ring."""
    if kind == TORUS:
        made.lines += [f'S[0, {INCLINED}] = across', f'S[k, {INCLINED}] = {outline[1].now}']


def flight(kind, friction):
    """Return the source for a FLIGHT: nothing rubs."""
    made = Recurrences()
    w = made.late(SPIN)
    q = _turned(made, w)
    gyro = [made.let(text) for text in made.crossed(UNEVEN, w)]
    omega = made.put('omega', _halved(_transformed('c.inverse', gyro)))
    made.put('h', _transformed('c.uneven', omega))
    gamma, = _axes(made, q, 1)
    r, outline = _lever(made, kind, gamma)
    _incline(made, kind, outline)
    # the motion of the centre of mass is a parabola
    x, y, z = (f'(v[{i}] if k == 1 else 0.5 * a[{i}] if k == 2 else 0.0)' for i in range(3))
    height = f'{z} + {made.summed(gamma, r, made.product)}'
    grown = [f'a[{i}] if k == 1 else 0.0' for i in range(3)]
    return made.source(STARTS + OF_SURFACE.get(kind, '') + OF_FLIGHT, {
        **_places(Q, [one.now for one in q]), **_places(OMEGA, omega), **_places(U, grown),
        **_places(PLACE, (x, y)), GAP: height, TIME: '1.0 if k == 1 else 0.0'})


def rolling(kind, friction):
    """Return the source for ROLLING."""
    made = Recurrences()
    w = made.late(SPIN)
    q = _turned(made, w)
    axes = _axes(made, q, 3)
    r, outline = _lever(made, kind, axes[2])
    couple, heats = _couples(made, kind, friction, axes[2], r, outline)
    part = [made.let(text) for text in _carried(made, r)]
    carried = [Part(f'carried[{i}]', f'c{i}') for i in range(3)]
    before = made.late(carried)
    turned = made.crossed(SPIN, before)
    e1, e2, _ = axes
    weight = [' + '.join(f'{force} * {late}' for force, late in zip(
        ('Fx', 'Fy'), made.late(column), strict=True)) for column in zip(e1, e2, strict=True)]
    tilting = made.late(_tilting(made, kind, axes[2], outline))
    # f without what the coefficient k of omega does and the weight along gamma, then with both
    known = [made.let(f'-(c.mass * (k * {one} + {other}) + {down})')
             for one, other, down in zip(part, turned, weight, strict=True)]
    torque = [made.let(f'{text} - Fz * {tilt}{more}') for text, tilt, more in zip(
        made.crossed(r, known), tilting, couple, strict=True)]
    gyro = [made.let(text) for text in made.crossed(UNEVEN, w)]
    omega = made.put('omega', _halved(_transformed(
        'solved', [f'({one} + {other})' for one, other in zip(torque, gyro, strict=True)])))
    made.put('h', _transformed('c.uneven', omega))
    grown = [made.let(text) for text in _grown(omega)]
    made.put('c', [f'{one} + {more}' for one, more in zip(part, grown, strict=True)])
    push = [made.let(f'-c.mass * k * {more}') for more in grown]
    along = [made.let(f'{one} + {more}') for one, more in zip(known, push, strict=True)]
    made.replace(dict(zip(known, along, strict=True)))
    force = [made.let(f'{one} - Fz * {down}')
             for one, down in zip(along, made.late(axes[2]), strict=True)]
    whole = [made.let(f'{torque[n]} + r[{i}] * {push[j]} - r[{j}] * {push[i]}')
             for n, (i, j) in enumerate(CYCLE)]
    normal = made.let(made.summed(axes[2], force, made.before))
    square = ' + '.join(made.column(one, one)[0] for one in force)
    _watch(made, kind, normal, f'{square} - {made.column(normal, normal)[0]}', outline)
    moved = [f'-share * ({made.summed(row, before, made.before)})' for row in axes[:-1]]
    impulse = _halved(made.summed(row, whole, made.before) for row in axes)
    return made.source(STARTS + OF_SURFACE.get(kind, '') + OF_ROLLING, {
        **_places(Q, [one.now for one in q]), **_places(OMEGA, omega), **_places(PLACE, moved),
        TIME: '1.0 if k == 1 else 0.0', **heats, **_places(IMPULSE, impulse)})


def sliding(kind, friction):
    """Return the source for SLIDING and GLIDING.

    More than forty lines: N stands in most of them.
    """
    made = Recurrences()
    pace, u = Part('pace', 'pace_k'), [Part(f'u[{i}]', f'u{i}') for i in range(2)]
    late_pace, = made.late([pace])
    w = [made.let(made.before(pace, one)) for one in made.late(SPIN)]
    q = _turned(made, w)
    axes = _axes(made, q, 3)
    r, outline = _lever(made, kind, axes[2])
    couple, heats = _couples(made, kind, friction, axes[2], r, outline)
    part = [made.let(text) for text in _carried(made, r)]
    # all that follows from g without the coefficient of N, then with it
    pressed = [made.column(one.now, 'normal')[0] for one in (*u, pace)]
    *along, across = g = [
        made.let(text) for text in (f'-mu * {pressed[0]}', f'-mu * {pressed[1]}', pressed[2])]
    tilting = _tilting(made, kind, axes[2], outline)
    e1, e2, _ = axes
    rubs = [made.let(made.summed(column, along, made.before))
            for column in zip(e1, e2, strict=True)]
    torque = [made.let(f'{text} + {made.before(tilt, across)}{more}') for text, tilt, more in zip(
        made.crossed(r, rubs), tilting, couple, strict=True)]
    gyro = made.crossed(UNEVEN, w)
    spun = [made.let(text) for text in _halved(_transformed('c.inverse', [
        made.let(f'{one} + {other}') for one, other in zip(torque, gyro, strict=True)]))]
    carried = [made.let(f'{one} + {more}')
               for one, more in zip(part, _grown(spun), strict=True)]
    of_c = [Part(f'carried[{i}]', one) for i, one in enumerate(carried)]
    rolled = [made.let(made.summed(row, of_c, made.product)) for row in axes]
    made.lines.append(f'normal = -(lightness * ({across} + {late_pace} * Fz) + k * {rolled[2]}) '
                      '* yielding')
    found = {}
    for name, parts, share in (('unit', g, ''), ('pushed', rubs, ''), ('wrung', torque, ''),
                               ('spun', spun, 'share * '), ('swung', carried, 'share * '),
                               ('rolled', rolled, 'share * ')):
        for i, one in enumerate(parts):
            found[one] = made.let(f'{one} + normal * {share}{name}[{i}]')
    made.replace(found)
    omega = made.put('omega', [found[one] for one in spun])
    made.put('h', _transformed('c.uneven', omega))
    *rolls, _ = rolled
    made.put('u', [f'share * lightness * ({found[one]} + {late_pace} * {weight}) + {found[turn]}'
                   for one, turn, weight in zip(along, rolls, ('Fx', 'Fy'), strict=True)])
    root = made.root(made.summed(u, u, made.product), 'pace', 'half_pace')
    made.lines.append(f'pace_k = {root.now}')
    velocity = made.vector('v', [f'u{i} - {found[rolled[i]]}' for i in range(2)])
    moved = _halved(made.before(pace, one) for one in made.late(velocity))
    heat = f'share * mu * ({made.before(pace, found[across])})'
    impulse = _halved(made.summed(row, [found[one] for one in torque], made.before)
                      for row in axes)
    _watch(made, kind, 'normal', None, outline)
    return made.source(STARTS + OF_SURFACE.get(kind, '') + OF_SLIDING, {
        **_places(Q, [one.now for one in q]), **_places(OMEGA, omega),
        **_places(U, [one.now for one in u]), **_places(PLACE, moved),
        TIME: f'share * {late_pace}', SLID: heat, **heats, **_places(IMPULSE, impulse)})


SOURCES = {FLIGHT: flight, ROLLING: rolling, SLIDING: sliding}
"""Phase -> the function that writes its source, for a kind of surface and a Friction."""
