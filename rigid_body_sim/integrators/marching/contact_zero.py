# SPDX-License-Identifier: Apache-2.0
"""Template: where in a step of a convex body on a plane a watched number falls below zero.

It is bound to the rates of equations/contact_rates.py and to a step (contact_step.py).
"""

import math

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.compilation.layout import layout
from rigid_body_sim.compilation.templates import UNBOUND
from rigid_body_sim.integrators.equations.contact_views import FLIGHT, ROW, Watched
from rigid_body_sim.integrators.marching import contact_step
from rigid_body_sim.mechanics.contact.parameters import CONTACT

rate = UNBOUND
step_from = UNBOUND

END, FRESH, WATCHED = contact_step.END, contact_step.FRESH, ROW.part('watched').first
NORMAL, MODE = layout(Watched).part('normal').first, CONTACT.part('mode').first
PARTS = 16                   # parts of a step that is looked through
SEARCHES = 24                # golden sections for a dip
GOLDEN = 0.6180339887498949
BISECTIONS = 120


@compiled
def look(p, w, y, lost, h, k):
    """Return the watched number k after a step h from y, whose rates are in row 0."""
    step_from(p, w, y, lost, h)
    rate(p, w[FRESH], w[END])
    return w[END, WATCHED + k]


@compiled
def first_zero(p, w, y, lost, h, k, begin):
    """Return the part of the step h at which a watched number first falls below zero.

    More than forty lines: each function that calls a step compiles it once more, half a second.

    Parameters
    ----------
    begin : float
        The watched number k at y.

    Returns
    -------
    float
        The first part (same unit as h) for which it is negative, to round-off; -1 if it stays
        above.
    """
    low, value_low = 0.0, begin
    least, at, falls = math.inf, 0.0, begin > 0.0    # what begins at zero has to rise first
    high, value_high = -1.0, 0.0
    flies = p[MODE] == FLIGHT and k == NORMAL
    for n in range(1, PARTS + 1):
        part = h * n / PARTS
        value = look(p, w, y, lost, part, k)
        if value < 0.0:
            high, value_high = part, value
            break
        if flies and value == 0.0 and value_low > 0.0:
            # a gap below zero that grows again is watched as 0: it went below before
            under = part
            for _ in range(BISECTIONS):
                middle = 0.5 * (low + under)
                if high > 0.0 or not low < middle < under:
                    break
                value = look(p, w, y, lost, middle, k)
                if value < 0.0:
                    high, value_high = middle, value
                elif value > 0.0:
                    low, value_low = middle, value
                else:
                    under = middle
            if high > 0.0:
                break
            value = 0.0
        falls = falls or value < value_low
        if falls and value < least:
            least, at = value, part
        low, value_low = part, value
    if high < 0.0 and falls:
        # the least of the values may hide a dip: golden section around it
        left, right = max(0.0, at - h / PARTS), min(h, at + h / PARTS)
        for _ in range(SEARCHES):
            first = right - GOLDEN * (right - left)
            second = left + GOLDEN * (right - left)
            one, other = (look(p, w, y, lost, first, k), look(p, w, y, lost, second, k))
            if one < 0.0 or other < 0.0:
                high, value_high = (first, one) if one < 0.0 else (second, other)
                low, value_low = max(0.0, at - h / PARTS), least
                break
            if one == 0.0 or other == 0.0:
                # as above: the zero is before it
                right = first if one == 0.0 else second
            elif one < other:
                right = second
            else:
                left = first
    if high < 0.0:
        return -1.0
    # Illinois, kept within the bracket, until no double lies between
    side = 0
    for n in range(BISECTIONS):
        middle = 0.5 * (low + high)
        if n % 3 != 2 and value_low > value_high and math.isfinite(value_low):
            middle = (low * value_high - high * value_low) / (value_high - value_low)
        if not low < middle < high:
            middle = 0.5 * (low + high)
        if not low < middle < high:
            break
        value = look(p, w, y, lost, middle, k)
        if value < 0.0:
            high, value_high = middle, value
            if side == 1:
                value_low *= 0.5
            side = 1
        else:
            low, value_low = middle, value
            if side == -1:
                value_high *= 0.5
            side = -1
    return high
