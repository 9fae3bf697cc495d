# SPDX-License-Identifier: Apache-2.0
"""Body on a hinge that torsion springs turn back and forth, in closed form.

It absorbs such a body about whose axis the weight does nothing, under constant torques and drag,
as long as it does not come to an end of its angle. Symbols: n the axis, I the moment about it, phi
the angle of the hinge, k the stiffness of all springs, r I their damping with the drag, N the
torque along n at phi = 0:

    phi'' = N/I - (k/I) phi - r phi',    x = phi - N/k,    gamma = r/2,    Omega^2 = k/I - gamma^2.

Where Omega is real, with x0 and v0 at the start, b = (v0 + gamma x0)/Omega and s, c the sine and
cosine of Omega t,

    x = exp(-gamma t) (x0 c + b s),
    x' = exp(-gamma t) (v0 c - ((k/I) x0 + gamma v0)/Omega s),

and otherwise, with kappa^2 = -Omega^2, l = (k/I)/(gamma + kappa) the slower of the two rates,
y = 2 kappa t and f1 of numerics/relaxation.py,

    x = exp(-l t) (x0 + (v0 + l x0) t f1(y)),    x' = exp(-l t) (v0 + l x0) exp(-y) - l x.

Omega is a pair of doubles, so the phase does not lose digits with time.
"""

import math
from fractions import Fraction
from typing import NamedTuple

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.compilation.layout import Pair, Quaternion, Vector, layout
from rigid_body_sim.mechanics.pulls import twisted
from rigid_body_sim.motions.axle import axle, root_of
from rigid_body_sim.motions.fixed_axis import weight_is_idle
from rigid_body_sim.motions.flight import Field, Flight, field_of, flight_from, flown
from rigid_body_sim.numerics.double_double import two_sum
from rigid_body_sim.numerics.functions import atan2, cos, exp, hypot, sin
from rigid_body_sim.numerics.pairs import TURN, in_integers, quotient, times
from rigid_body_sim.numerics.phase import fraction, sin_cos
from rigid_body_sim.numerics.relaxation import relaxation
from rigid_body_sim.numerics.rotations import multiply, normalised, rotate_back
from rigid_body_sim.numerics.vectors import apply, dot, scaled
from rigid_body_sim.scene.constraints.protocol import Mechanism
from rigid_body_sim.scene.state import STATE

EVENTS = ()
entries = next_event = fill_columns = None
END = 2.0 * math.pi * (1.0 - 2.0 ** -20)    # of the angle, rad: it goes on from the other end


class Law(NamedTuple):
    """Numbers of the scene that each state needs."""

    unit: Vector         # n, body axes
    restoring: float     # k/I, 1/s^2
    gamma: float         # 1/s
    omega: float         # Omega, rad/s; 0 where it is not real
    turns: Pair          # Omega in turns, 1/s
    slower: float        # l, 1/s, where Omega is not real
    apart: float         # 2 kappa, 1/s


class Parameters(NamedTuple):
    """Numbers of the scene."""

    law: Law
    zero: Quaternion     # the attitude at phi = 0
    rest: float          # N/k of what is constant in the body, rad
    couple: Vector       # torque that is constant in the world, over k, world axes, rad
    field: Field


class Anchor(NamedTuple):
    """Numbers that one state determines."""

    start: float             # s
    orientation: Quaternion
    x: float                 # x0, rad
    rate: float              # v0, rad/s
    law: Law
    flight: Flight


PARAMETERS, ANCHOR = layout(Parameters), layout(Anchor)
PARAMETER_SIZE, ANCHOR_SIZE = PARAMETERS.size, ANCHOR.size
load_parameters, load_anchor, store_anchor = PARAMETERS.load, ANCHOR.load, ANCHOR.store
load_state, store_state = STATE.load, STATE.store


def absorbs(scene):
    """Return whether this motion solves the whole scene."""
    return (scene.constraint.mechanism is Mechanism.AXIS and twisted(scene) is not None
            and takes(scene, scene.initial.vector))


def takes(scene, start):
    """Return whether a state, shape (14,), swings within its angle, and its weight is idle."""
    _, rest = twisted(scene)
    if not weight_is_idle(scene, rest, start):
        return False
    p, begin = PARAMETERS.load(parameters(scene).tolist()), STATE.load(start.tolist())
    angle, x, rate = _displaced(p, begin)
    # damping takes energy, so that no later swing is wider than without it
    return abs(angle - x) + hypot(x, rate / math.sqrt(p.law.restoring)) < END


def parameters(scene):
    """Return the numbers of the scene that the kernels take: :class:`Parameters` as an array."""
    (k, angle, damping), rest = twisted(scene)
    held, hinge = axle(scene), scene.frame.hinge
    given, one = in_integers([number for vector in (rest.torque, *rest.drag) for number in vector])
    three = iter(given)
    torque, *drag = zip(three, three, three, strict=True)
    n, moment = held.axis, Fraction(*held.moment)
    along = Fraction(dot(n.integers, torque), n.over * one)
    dragged = Fraction(-dot(n.integers, apply(drag, n.integers)), n.over * n.over * one)
    restoring, gamma = k / moment, (damping + dragged) / (2 * moment)
    square = restoring - gamma * gamma
    root = Fraction(*root_of(*abs(square).as_integer_ratio()))
    omega, kappa = (root, Fraction(0)) if square > 0 else (Fraction(0), root)
    turns = times(quotient(*omega.as_integer_ratio()), TURN)
    law = Law(scene.constraint.axis, float(restoring), float(gamma), float(omega), turns,
              float(restoring / (gamma + kappa)) if square <= 0 else 0.0, float(2 * kappa))
    return PARAMETERS.array(Parameters(
        law, hinge.zero, float(angle + along / k),
        [component / float(k) for component in rest.couple], field_of(scene, rest)))


@compiled
def _displaced(p, begin):
    """Return phi, x (rad) and phi' (rad/s) of a StateView."""
    q, law = normalised(*begin.orientation), p.law
    x, y, z, w = p.zero
    x, y, z, w = multiply(-x, -y, -z, w, *q)
    angle = 2.0 * atan2(dot(law.unit, (x, y, z)), w)
    rest = p.rest + dot(law.unit, rotate_back(*q, *p.couple))
    return angle, angle - rest, dot(law.unit, begin.angular_velocity)


@compiled
def anchor(parameters, start, out):
    """Fill the anchor from a state; of its angular velocity the part along the axis counts."""
    p, begin = load_parameters(parameters), load_state(start)
    _, x, rate = _displaced(p, begin)
    store_anchor(out, Anchor(begin.time, normalised(*begin.orientation), x, rate, p.law,
                             flight_from(p.field, begin)))


@compiled
def state(anchor, time, out):
    """Fill out with the state at a time before or after the anchor."""
    held = load_anchor(anchor)
    law, x0, v0, dt = held.law, held.x, held.rate, two_sum(time, -held.start)
    t = dt[0]
    if law.omega > 0.0:
        sine, cosine = sin_cos(*fraction(*times(law.turns, dt)))
        left, gamma, omega = exp(-law.gamma * t), law.gamma, law.omega
        x = left * (x0 * cosine + (v0 + gamma * x0) / omega * sine)
        rate = left * (v0 * cosine - (law.restoring * x0 + gamma * v0) / omega * sine)
    else:
        left, l = exp(-law.slower * t), law.slower
        e, f1, _ = relaxation(law.apart * t)
        x = left * (x0 + (v0 + l * x0) * t * f1)
        rate = left * (v0 + l * x0) * e - l * x
    half = 0.5 * (x - x0)
    q = normalised(*multiply(*held.orientation, *scaled(sin(half), law.unit), cos(half)))
    store_state(out, flown(held.flight, t, time, q, scaled(rate, law.unit)))
