# SPDX-License-Identifier: Apache-2.0
"""Template: the slip of a patch of contact that pivots.

It is bound to what acts besides the contact (contact_acting.py). u is, but for a lag, the one that
Coulomb's law has for the force that u' asks for. u' is the rate of that u to the second order in
its time of relaxation, and u is drawn to it at the pace of the body, so that force, heat and v are
those of one motion. Symbols: mechanics/contact/laws.py, patch.py.
"""

from typing import NamedTuple

from rigid_body_sim.compilation.jit import compiled, compiled_inline
from rigid_body_sim.compilation.layout import Vector
from rigid_body_sim.compilation.templates import UNBOUND
from rigid_body_sim.mechanics.contact.forces import patch_of
from rigid_body_sim.mechanics.contact.parameters import LOW
from rigid_body_sim.mechanics.contact.patch import patch_following, patch_pivoting
from rigid_body_sim.mechanics.contact.touch import inclination
from rigid_body_sim.numerics.functions import hypot
from rigid_body_sim.numerics.vectors import dot, minus, plus, scaled
from rigid_body_sim.scene.surfaces import TORUS

posture_after = UNBOUND    # contact_acting.py
push_on = UNBOUND

ZERO = (0.0, 0.0, 0.0)


class Balance(NamedTuple):
    """A patch that pivots, with the friction that some u' asks for.

    Attributes
    ----------
    slip, growth : Vector
        The slip u that Coulomb's law has for this friction, m/s, and u', m/s^2.
    friction : Vector
        Its three components, N; the third is 0 where friction cannot hold u'.
    f, touch : Vector
        Force and couple of the contact (axes of the plane, of the body), N and N m.
    """

    slip: Vector
    growth: Vector
    friction: Vector
    f: Vector
    touch: Vector


@compiled
def _balance(c, at, push, growth):
    """Return the Balance of a patch whose slip grows by a vector (m/s^2)."""
    friction, N = patch_pivoting(patch_of(c, at, push), c.mu, c.side, growth)
    slip = ZERO
    if friction[2] != 0.0:
        share = c.patch * dot(at.axes[2], at.omega) / friction[2]
        slip = share * friction[0], share * friction[1], 0.0
    touch = plus(plus(push.viscous, scaled(N, push.wrung)),
                 scaled(c.patch * friction[2], at.axes[2]))
    return Balance(slip, growth, friction, (friction[0], friction[1], N), touch)


@compiled
def _settled(p, c, now, at, push, slip, since):
    """Return the Balance of a patch whose u' is the rate of the slip without u'.

    The rate is a difference to both sides. `slip` and `since` are those of `posture_after`.
    """
    still, wide = _balance(c, at, push, ZERO), c.wide
    ahead = posture_after(p, c, now, at, still.f, still.touch, slip, since, wide)
    after = _balance(c, ahead, push_on(p, c, now, ahead, slip, since + wide), ZERO)
    behind = posture_after(p, c, now, at, still.f, still.touch, slip, since, -wide)
    before = _balance(c, behind, push_on(p, c, now, behind, slip, since - wide), ZERO)
    return _balance(c, at, push, scaled(0.5 / wide, minus(after.slip, before.slip)))


@compiled
def _beside(p, c, now, at, slip, settled, short):
    """Return the slip of the Balance `settled` a short time (s) later."""
    later = posture_after(p, c, now, at, settled.f, settled.touch, slip, 0.0, short)
    slipped = plus(slip, scaled(short, settled.growth))
    pushed = push_on(p, c, now, later, slipped, short)
    return _settled(p, c, now, later, pushed, slipped, short).slip


@compiled_inline
def pivot(p, c, now, at, push):
    """Return the Balance with which a patch pivots, and how far its slip is off that, m/s.

    The rate of its slip is a difference of the fourth order of slips whose own error is of the
    second order in the time of relaxation. A slip that is not drawn to that of its Balance is off
    by all the speed.
    """
    slip, wide = (now.u[0], now.u[1], 0.0), c.wide
    settled = _settled(p, c, now, at, push, slip, 0.0)
    first, second, third, last = ZERO, ZERO, ZERO, ZERO
    for times in (-2.0, -1.0, 1.0, 2.0):    # a loop, so that compiled code has its body once
        first, second, third, last = second, third, last, _beside(
            p, c, now, at, slip, settled, times * wide)
    rate = scaled(1.0 / (12.0 * wide),
                  minus(scaled(8.0, minus(third, second)), minus(last, first)))
    drawn = scaled(c.swift / c.size[0], minus(slip, settled.slip))
    goes = _balance(c, at, push, minus(rate, drawn))
    friction, N = goes.friction, goes.f[2]
    low = c.kind == TORUS and inclination(at.axes[2]) < LOW    # its lowest point may jump
    if not low and friction[2] != 0.0 and patch_following(
            patch_of(c, at, push), c.mu, scaled(-1.0 / (c.mu * N), friction)):
        off = minus(slip, goes.slip)
        return goes, hypot(off[0], off[1])
    return goes, c.swift
