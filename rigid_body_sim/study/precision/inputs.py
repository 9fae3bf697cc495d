# SPDX-License-Identifier: Apache-2.0
"""The numbers of a scene in multiple precision, as the reference integrators take them.

They are exact doubles, or doubles moved by half an ulp. Only these inputs are shared with the
package's own methods; the equations and the arithmetic of a reference are its own.
"""

import math
import random
from dataclasses import dataclass

import yaml
from mpmath import mp, mpf

from rigid_body_sim.errors import BadInput
from rigid_body_sim.scene.constraints.protocol import Mechanism
from rigid_body_sim.scene.effects.drag import KEYS, Drag, ShapedDrag
from rigid_body_sim.scene.effects.gravity import Gravity
from rigid_body_sim.scene.effects.internal_dissipation import InternalDissipation
from rigid_body_sim.scene.effects.sliding_friction import SlidingFriction
from rigid_body_sim.scene.effects.spring import Spring
from rigid_body_sim.scene.effects.strike import Strike
from rigid_body_sim.scene.effects.torque import Torque
from rigid_body_sim.study.precision import suite

KINDS = 'free', 'pivot', 'hinge', 'table'
LAWS = Drag, Gravity, InternalDissipation, ShapedDrag, SlidingFriction, Spring, Strike, Torque
"""Constraints, and kinds of effects, that references know."""
ZERO = (mpf(0),) * 3


def exactly(x):
    """Return a double unchanged."""
    return mpf(float(x))


class Moved:
    """Random shift of every double by half an ulp, up or down.

    Equal numbers move together, so that symmetric bodies stay symmetric. Zero does not move.
    """

    def __init__(self, seed):
        self._source, self._signs = random.Random(seed), {}

    def __call__(self, x):
        """Return the shifted double."""
        x = float(x)
        if x == 0.0:
            return mpf(0)
        sign = self._signs.setdefault(abs(x), self._source.choice((-1, 1)))
        return mpf(x) + sign * mpf(math.ulp(x)) / 2


@dataclass(frozen=True)
class Inputs:
    """The numbers of a scene.

    Attributes
    ----------
    kind : str
        free, pivot, hinge or table.
    mass, g, linear, angular, inner, mu, radius : mpf
        Units kg and m/s^2, coefficients of drag, internal dissipation and sliding friction, and
        m; 0 where the scene has none. The damper of a torsion spring is part of `angular`.
    moments : tuple of 3 mpf
        Principal moments about the point of reference, kg m^2.
    axes : tuple of 4 mpf
        Unit quaternion from principal to body axes.
    arm : tuple of 3 mpf
        Vector from the point of reference to the centre of mass, body axes, m.
    axis : tuple of 3 mpf or None
        Direction of a hinge, body axes, unit length.
    couples : tuple
        Torque effects: (times (floats), values (mpf), 'body' or 'world').
    strikes : tuple
        Strikes by time: (time (float), impulse (mpf), lever from the centre of mass (mpf, body
        axes), height (mpf), 'body' or 'world').
    orientation, omega, velocity : tuples of mpf
        Start: unit quaternion from body to world, rad/s in body axes, m/s in the world.
    stiffness, slack : mpf
        Of a torsion spring at a hinge, N m/rad: the torque -stiffness (phi - slack), phi (rad)
        counted from the orientation at the start.
    quadratic, angular_quadratic : mpf
        Coefficients of drag by squares at a bearing, N s^2/m^2 and N m s^2.
    ties : tuple
        Springs at a pivot: (point (m, body axes), anchor from the pivot (m, world axes),
        stiffness (N/m), length (m)).
    """

    kind: str
    mass: object
    moments: tuple
    axes: tuple
    arm: tuple
    axis: tuple | None
    g: object
    linear: object
    angular: object
    inner: object
    mu: object
    radius: object
    couples: tuple
    strikes: tuple
    orientation: tuple
    omega: tuple
    velocity: tuple
    stiffness: object
    slack: object
    quadratic: object
    angular_quadratic: object
    ties: tuple


def unit(vector):
    """Return a vector or quaternion divided by its length."""
    size = mp.sqrt(mp.fsum(x * x for x in vector))
    return tuple(x / size for x in vector)


def of(scene, move):
    """Return the Inputs of a scene at mpmath's current precision.

    `move` is applied to each of its doubles: `exactly` or Moved(seed). BadInput for effects and
    constraints that the references do not know.
    """
    body, constraint, kind = scene.body, scene.constraint, scene.constraint.kind
    inertia, held = constraint.inertia(body), constraint.holds_a_point
    center = tuple(map(move, body.center_of_mass))
    through = tuple(map(move, constraint.point(body))) if held else ZERO
    arm = tuple(c - p for c, p in zip(center, through)) if held else ZERO
    refuse_unknown(scene)
    stiffness, slack, damping = torsion(scene, move)
    gravity, inner, friction = map(
        scene.effect, ('gravity', 'internal_dissipation', 'sliding_friction'))
    drag = dict(zip(KEYS, map(move, drags(scene)), strict=True))
    couples = tuple((effect.times, tuple(tuple(map(move, value)) for value in effect.values),
                     effect.frame)
                    for effect in scene.effects if effect.name == 'torque')
    strikes = []
    for strike in sorted((effect for effect in scene.effects if effect.name == 'strike'),
                         key=lambda effect: effect.time):
        lever = (ZERO if strike.point is None
                 else tuple(p - c for p, c in zip(map(move, strike.point), center)))
        strikes.append((strike.time, tuple(map(move, strike.impulse)), lever, move(strike.height),
                        strike.frame))
    initial = scene.initial
    return Inputs(
        kind, move(body.mass), tuple(map(move, inertia.moments)),
        unit(tuple(map(move, inertia.axes))), arm,
        unit(tuple(map(move, constraint.axis))) if kind == 'hinge' else None,
        move(gravity.g if gravity else friction.g if friction else 0.0),
        drag['linear'], drag['angular'] + damping,
        move(inner.coefficient if inner else 0.0), move(friction.mu if friction else 0.0),
        move(body.radius if kind == 'table' else 0.0), couples, tuple(strikes),
        unit(tuple(map(move, initial.orientation))), tuple(map(move, initial.angular_velocity)),
        tuple(map(move, initial.velocity)), stiffness, slack,
        drag['quadratic'], drag['angular_quadratic'], ties(scene, move))


def refuse_unknown(scene):
    """Raise BadInput for effects and constraints that the references do not know."""
    held = scene.constraint.kind
    if held not in KINDS:
        raise BadInput(f'{scene.name}: constraint', f'no reference is made for {held!r}',
                       ', '.join(KINDS))
    if scene.constraint.mechanism is Mechanism.PLANE:
        raise BadInput(f'{scene.name}: constraint',
                       'no reference is made for a body with a surface on a plane',
                       f'the problems {", ".join(suite.ON_A_PLANE)}, whose references are kept')
    for effect in scene.effects:
        if (not isinstance(effect, LAWS)
                or (isinstance(effect, Spring) and effect.at is not None and held != 'pivot')
                or (isinstance(effect, ShapedDrag) and held not in ('pivot', 'hinge'))
                or (isinstance(effect, InternalDissipation) and held != 'free')):
            raise _unknown(scene, effect.name)


def _unknown(scene, name):
    return BadInput(
        f'{scene.name}: effects', f'no reference is made for {name} as it is here',
        'gravity downward, torques in numbers, strikes, drag by numbers (by squares at a bearing '
        'only), internal dissipation of a free body, a torsion spring, undamped springs at a '
        'pivot, sliding friction')


def drags(scene):
    """Return the coefficients of drag, in the order of KEYS; those that a scene lacks are 0."""
    effect = scene.effect('drag')
    if not isinstance(effect, ShapedDrag):
        return (effect.linear, effect.angular, 0.0, 0.0) if effect else (0.0,) * 4
    found = [getattr(effect, key) for key in KEYS]
    if any(matrix != tuple(tuple(matrix[0][0] if i == k else 0.0 for k in range(3))
                           for i in range(3)) for matrix in found):
        raise _unknown(scene, 'drag by matrices')
    return tuple(matrix[0][0] for matrix in found)


def ties(scene, move):
    """Return the springs between a point of a body at a pivot and one of the world (Inputs).

    The numbers are read from the scene's text, as those of a torsion spring.
    """
    found = []
    for settings in _springs(scene):
        if 'at' not in settings:
            continue
        if settings.get('damping'):
            raise _unknown(scene, 'a spring with damping')
        anchor = tuple(move(a) - move(b) for a, b in zip(
            settings['anchor'], scene.initial.position, strict=True))
        found.append((tuple(map(move, settings['at'])), anchor, move(settings['stiffness']),
                      move(settings.get('length', 0.0))))
    return tuple(found)


def _springs(scene):
    return [one['spring'] for one in yaml.safe_load(scene.text).get('effects', ())
            if isinstance(one, dict) and 'spring' in one]


def torsion(scene, move):
    """Return stiffness, slack and friction of a torsion spring, 0 where there is none.

    Slack is the angle from the start at which the spring pulls nothing. The effect keeps its law
    as trees, so the numbers are read from the scene's text.
    """
    read = yaml.safe_load(scene.text)
    settings = [one for one in _springs(scene) if 'at' not in one]
    if not settings:
        return ZERO
    if len(settings) > 1:
        raise _unknown(scene, 'several torsion springs')
    k, angle, c = (move(settings[0].get(key, 0.0)) for key in ('stiffness', 'angle', 'damping'))
    return k, angle - move((read.get('initial') or {}).get('angle', 0.0)), c


def cross(a, b):
    """Return a x b."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def dot(a, b):
    """Return a . b."""
    return mp.fsum(x * y for x, y in zip(a, b))


def product(p, q):
    """Return the quaternion p q, (x, y, z, w)."""
    (ax, ay, az, aw), (bx, by, bz, bw) = p, q
    return (
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
        aw * bw - ax * bx - ay * by - az * bz,
    )


def turned(q, v):
    """Return R v for a unit quaternion."""
    t = tuple(2 * x for x in cross(q[:3], v))
    return tuple(a + q[3] * b + c for a, b, c in zip(v, t, cross(q[:3], t)))


def turned_back(q, v):
    """Return R^T v for a unit quaternion."""
    return turned((-q[0], -q[1], -q[2], q[3]), v)
