# SPDX-License-Identifier: Apache-2.0
"""The unknowns of a convex body on a plane, and a row of their rates, as named views.

All vectors but omega are along the axes of the plane.
"""

from typing import NamedTuple

from rigid_body_sim.compilation.layout import Pair, Quaternion, Vector, layout

# phases (contact_rates.py)
FLIGHT, SLIDING, ROLLING, GLIDING, CREEPING, RESTING, PIVOTING = range(7)


class Ledger(NamedTuple):
    """The ledger since the start of the course, or its rates.

    Attributes
    ----------
    slid, rolled, filmed, struck, damped, spun : float
        Heat of slip, of rolling friction, of the film of air, of impacts, of all else, and of the
        spin of a patch of contact, J.
    work : float
        J.
    impulse : Vector
        Angular impulse about the centre of mass, N m s.
    """

    slid: float
    rolled: float
    filmed: float
    struck: float
    damped: float
    work: float
    impulse: Vector
    spun: float


class Unknowns(NamedTuple):
    """The unknowns of a phase, or their rates.

    Attributes
    ----------
    q : Quaternion
        Attitude, body -> plane.
    omega : Vector
        Body axes, rad/s.
    u : Vector
        Slip, of a flight the velocity of the centre of mass, m/s. Of a creep its size, 0, 0.
    place : Pair
        Displacement of the centre of mass along the plane since the start of the course, m.
    gap : float
        m.
    time : float
        Since the start of the course, s.
    ledger : Ledger
    """

    q: Quaternion
    omega: Vector
    u: Vector
    place: Pair
    gap: float
    time: float
    ledger: Ledger


class Watched(NamedTuple):
    """Numbers of which one falls below zero where a phase ends.

    Attributes
    ----------
    normal : float
        N, of a flight the gap. Of a slip in the paradox, where A < 0, it is -N.
    grip : float
        What friction could hold less what it holds, N; of a creep how much slower it is than a
        slip, m/s, or its speed where that is negative; of a patch that pivots its spin, m/s, or
        how much less its slip errs than it may, if that is less.
    firmness : float
        m A (mechanics/contact/laws.py): where it is not positive, no force meets the laws.
    jump : float
        Time to where what acts jumps, s.
    motion : float
        How far the body is from lying flat (rad), or from standing still (m/s).
    rolling : float
        Under dry rolling friction: what it could hold less what it holds (N), or the speed at
        which a disk rolls the way it does (m/s). Of a torus that tips: the error that it may have
        less the one that it has, N rad.
    """

    normal: float
    grip: float
    firmness: float
    jump: float
    motion: float
    rolling: float


class Row(NamedTuple):
    """The rates of the unknowns, and what else is known at an instant.

    Attributes
    ----------
    rates : Unknowns
    watched : Watched
    force, couple : Vector
        Those of the contact on the body, N and N m.
    slip : Pair
        u along the plane, m/s.
    velocity : Vector
        Velocity of the centre of mass, m/s.
    lever : Vector
        From the centre of mass to the lowest point, m.
    pace : float
        Speed of the slip, with the spin of a patch of contact, m/s; in other phases 1.
    """

    rates: Unknowns
    watched: Watched
    force: Vector
    couple: Vector
    slip: Pair
    velocity: Vector
    lever: Vector
    pace: float


UNKNOWNS, ROW = layout(Unknowns), layout(Row)
LEDGER, WATCHED = UNKNOWNS.part('ledger'), ROW.part('watched')
