# SPDX-License-Identifier: Apache-2.0
"""The nutation of a heavy symmetric top at any time (symbols: lagrange_top.py)."""

from typing import NamedTuple

from rigid_body_sim.compilation.jit import compiled, compiled_inline
from rigid_body_sim.compilation.layout import Pair, layout
from rigid_body_sim.motions.lagrange_top.theta import (
    CircularSeries,
    HyperbolicSeries,
    Klein,
    circular,
    hyperbolic,
)
from rigid_body_sim.numerics.double_double import two_sum
from rigid_body_sim.numerics.phase import nearest, phase, sin_cos

CIRCULAR, HYPERBOLIC = 0.0, 1.0    # the forms of theta.py


class Beginning(NamedTuple):
    """Where the nutation begins, and the whole numbers of turns; see the functions below."""

    start: float      # phase of nutation, turns; a turn is a period
    winding: float    # turns of omega_c about 0: in a period, or (hyperbolic) in half of one
    side: float       # 1.0 or -1.0: phase factor of omega_c is i side conj(e_a) e_b
    parity: float     # 1.0 if `start` counts from the highest position
    stretch: float    # hyperbolic form: y of a turn of nutation; circular form: 0
    drift_a: float    # hyperbolic form: phases of a and b (turns) per unit of y
    drift_b: float


class Course(NamedTuple):
    """How the motion goes on from its start."""

    form: float            # CIRCULAR or HYPERBOLIC
    begin: Beginning
    rate: Pair             # rate of the nutation, turns/s
    rate_a: Pair           # rates of the phases of a and b, turns/s
    rate_b: Pair
    start_a: float         # phases of a and b at the start, turns
    start_b: float
    nutates: float         # 1.0 if the nutation is large enough to be seen


class Nutation(NamedTuple):
    """The view of the kernels below on an array; only one of the two series is filled."""

    course: Course
    circular: CircularSeries
    hyperbolic: HyperbolicSeries


NUTATION = layout(Nutation)
COURSE, CIRCULAR_PART = NUTATION.part('course'), NUTATION.part('circular')
HYPERBOLIC_PART = NUTATION.part('hyperbolic')
load_course, store_course = COURSE.load, COURSE.store
load_circular, store_circular = CIRCULAR_PART.load, CIRCULAR_PART.store
load_hyperbolic, store_hyperbolic = HYPERBOLIC_PART.load, HYPERBOLIC_PART.store


@compiled_inline
def circular_functions(course, series, dt):
    """Return the Klein at a time (s, a pair) after the start, without the own spin omega_3 - n."""
    turns, low = phase(*course.rate, *dt)
    phase_a, phase_b = phase(*course.rate_a, *dt), phase(*course.rate_b, *dt)
    begin = course.begin
    (c1, s1), periodic = circular(series, (turns + begin.start, low))
    winding = begin.winding
    turn = c1 if winding != 0.0 else 1.0, winding * s1
    return _with_phases(course, periodic, phase_a, phase_b, turn)


@compiled_inline
def hyperbolic_functions(course, series, dt):
    """Return the Klein that :func:`circular_functions` gives, by the hyperbolic form."""
    turns, low = phase(*course.rate, *dt)
    turns_a, low_a = phase(*course.rate_a, *dt)
    turns_b, low_b = phase(*course.rate_b, *dt)
    begin = course.begin
    turns, more = two_sum(turns, begin.start)
    turns -= nearest(turns)
    # half a period on, the highest position stands for the lowest; rate_a and rate_b have the
    # phases' mean rates
    half_turns = nearest(2.0 * turns)
    odd = abs(half_turns)
    along = begin.stretch * ((turns - 0.5 * half_turns) + (more + low))
    stretched = hyperbolic(series, along, odd != begin.parity)
    return _with_phases(course, stretched, (turns_a - begin.drift_a * along, low_a),
                        (turns_b - begin.drift_b * along, low_b),
                        (1.0 - 2.0 * odd * begin.winding, 0.0))


@compiled_inline
def _with_phases(course, klein, phase_a, phase_b, turn):
    """Multiply a Klein by its phase factors.

    That of omega_c is i side conj(e_a) e_b times `turn`, a complex number.
    """
    (ar, ai), (br, bi), (wr, wi) = klein
    turn_re, turn_im = turn
    sa, ca = sin_cos(phase_a[0] + course.start_a, phase_a[1])
    sb, cb = sin_cos(phase_b[0] + course.start_b, phase_b[1])
    side = course.begin.side
    cd, sd = side * (ca * cb + sa * sb), side * (ca * sb - sa * cb)
    to_re, to_im = -(sd * turn_re + cd * turn_im), cd * turn_re - sd * turn_im
    return Klein((ar * ca - ai * sa, ar * sa + ai * ca), (br * cb - bi * sb, br * sb + bi * cb),
                 (wr * to_re - wi * to_im, wr * to_im + wi * to_re))


@compiled
def functions(nutation, dt):
    """Return the Klein at a time by the form that the motion has."""
    course = load_course(nutation)
    if course.form == CIRCULAR:
        return circular_functions(course, load_circular(nutation), dt)
    return hyperbolic_functions(course, load_hyperbolic(nutation), dt)
