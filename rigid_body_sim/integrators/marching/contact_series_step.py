# SPDX-License-Identifier: Apache-2.0
"""Template: one step of a convex body on a plane by its Taylor series, and its error.

It is bound to an expansion (equations/contact_series.py). It takes the place of contact_step.py,
whose rows it fills: END, FRESH, TRIED, and in those of stages the watched numbers at equal parts
of the step. After them the work space keeps the series of the last point, so that steps of any
length from there cost no other expansion.
"""

import math

from rigid_body_sim.compilation.jit import compiled, compiled_inline
from rigid_body_sim.compilation.templates import UNBOUND
from rigid_body_sim.integrators.equations.contact_series import (
    FRICTION,
    INCLINED,
    NORMAL,
    WIDTH,
)
from rigid_body_sim.integrators.equations.contact_views import FLIGHT, ROLLING, ROW, UNKNOWNS
from rigid_body_sim.integrators.marching import contact_step, taylor_series
from rigid_body_sim.mechanics.contact.parameters import CONTACT
from rigid_body_sim.numerics.functions import power
from rigid_body_sim.scene.surfaces import TORUS

expand = UNBOUND
# a line FLAT = the inclination below which a ring counts as flat, rad
FLAT = UNBOUND

ORDER, STAGES = taylor_series.ORDER, contact_step.STAGES
add, normalise, weight_of, COUPLED, nears_flat = (
    contact_step.add, contact_step.normalise, contact_step.weight_of, contact_step.COUPLED,
    contact_step.nears_flat)
FRESH, TRIED, SIZE = contact_step.FRESH, contact_step.TRIED, UNKNOWNS.size
KEY, TOTALS, SERIES = range(contact_step.WORK_ROWS, contact_step.WORK_ROWS + 3)
LEFT, RIGHT = SERIES + ORDER + 1, SERIES + 2 * (ORDER + 1)
WORK_ROWS = SERIES + 3 * (ORDER + 1)
"""Rows of the work space: the point and the phase of the series, sums of products, the series, and
the factors of products."""
WATCHED, WATCHES = ROW.part('watched').first, ROW.part('watched').size
PRESSING, GRIPPING, MOTION = (ROW.part('watched').part(name).first
                              for name in ('normal', 'grip', 'motion'))
GAP = UNKNOWNS.part('gap').first
MODE, MU, KIND = (CONTACT.part(name).first for name in ('mode', 'mu', 'kind'))
BEFORE = 0.25    # share of the last term but one that the last one has at least
SQUARED = 1e150  # squares of larger coefficients overflow
SAFETY = 4.0     # times the rest of the series that the error may be


@compiled
def step_from(p, w, y, lost, h):
    """Fill row FRESH with the unknowns after a step h from y.

    Returns
    -------
    float
        0, or infinite: numbers did not stay small, a ring would turn through the plane, or the
        step may pass a kink of the gap.
    """
    if nears_flat(p, y, h, 1.0):
        return math.inf    # the terms of the series need not show it
    key, S = w[KEY], w[SERIES:LEFT]
    known = key[SIZE] == p[MODE] + 1.0
    for n in range(SIZE):
        known = known and key[n] == y[n]
    if not known:
        expand(p, w[LEFT:RIGHT], w[RIGHT:], w[TOTALS], S, y)
        for n in range(SIZE):
            key[n] = y[n]
        key[SIZE] = p[MODE] + 1.0
    for n in range(WIDTH):
        w[TRIED, n] = h * S[ORDER, n]
    for k in range(1, ORDER):
        for n in range(WIDTH):
            w[TRIED, n] = h * (w[TRIED, n] + S[ORDER - k, n])
    for n in range(SIZE):
        d = lost[n] + w[TRIED, n]
        if not add(w, y, n, d):
            return math.inf
    normalise(w)
    return 0.0 if _sample(p, w, y, S, h) >= 0.0 else math.inf


@compiled_inline
def _sample(p, w, y, S, h):
    """Fill the rows of stages with the watched numbers at equal parts of a step.

    In flight the rate of the gap is there, too.

    Returns
    -------
    float
        The inclination of a ring at the end, rad. It is negative past lying flat: no rate is.
    """
    mode, mu, inclined = p[MODE], p[MU], 0.0
    if p[KIND] == TORUS:
        for k in range(ORDER + 1):
            inclined = h * inclined + S[ORDER - k, INCLINED]
    ends = inclined
    for i in range(1, STAGES):
        t = h * i / STAGES
        first = FRICTION if mode == ROLLING and mu < 1e300 else NORMAL
        normal = second = inclined = gap = rising = 0.0
        if mode == FLIGHT:
            for k in range(ORDER):
                gap = t * (gap + S[ORDER - k, GAP])
                rising = t * rising + (ORDER - k) * S[ORDER - k, GAP]
            normal, w[i, GAP] = y[GAP] + gap, rising
        else:
            for k in range(ORDER + 1):
                normal = t * normal + S[ORDER - k, NORMAL]
                second = t * second + S[ORDER - k, first]
        grip = motion = 1.0
        if first == FRICTION:
            grip = mu * normal - math.sqrt(max(0.0, second))
        if p[KIND] == TORUS:
            for k in range(ORDER + 1):
                inclined = t * inclined + S[ORDER - k, INCLINED]
            motion = inclined - FLAT
        for n in range(WATCHED, WATCHED + WATCHES):
            w[i, n] = w[0, n]
        w[i, PRESSING], w[i, GRIPPING], w[i, MOTION] = normal, grip, motion
    return ends


@compiled_inline
def longest(w, h):
    """Return the longest step that may follow one of size h: any."""
    return math.inf


@compiled
def error_of(w, h, scales):
    """Return the estimated error of the step in the rows, as contact_step.error_of does.

    It is the rest of the series, whose terms are taken to fall as they do from 1 rad to the last.
    """
    last = before = 0.0
    for n in range(COUPLED):
        weight = weight_of(n, scales)
        one, other = weight * w[SERIES + ORDER, n], weight * w[SERIES + ORDER - 1, n]
        if not (abs(one) < SQUARED and abs(other) < SQUARED):
            return math.inf
        last += one * one
        before += other * other
    factor = h
    for _ in range(ORDER - 2):
        factor *= h
    term = factor * max(h * math.sqrt(last), BEFORE * math.sqrt(before))
    if not term < 0.5:
        return term
    # a geometric series that begins with 1 rad
    quotient = power(term, 1.0 / ORDER)
    return SAFETY * term * quotient / (1.0 - quotient)
