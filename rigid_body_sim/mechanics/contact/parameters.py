# SPDX-License-Identifier: Apache-2.0
"""The numbers of a convex body on a plane, as the kernels take them."""

from typing import NamedTuple

from rigid_body_sim.compilation.layout import Matrix, Pair, Quaternion, Vector, layout

FLAT = 1e-6              # rad: a ring that is inclined by less lies flat, where friction stops it
FILMY = 1e-4             # rad: and where a film of air does
FLATTER = 1e-10          # rad: and where neither does
HELD = (0.0, 0.0)        # `way` of what does not roll
SLOW = 1e-13             # share of the speeds below which a body does not roll
TIPS = 1e-5              # rad: error of a low torus that tips, where no step follows its friction
LOW = 1e-3               # rad: below it rolling friction jams a ring that no step can follow


class ContactParameters(NamedTuple):
    """A body and its plane; the values of what else acts follow it.

    Attributes
    ----------
    mode : float
        The phase (integrators/equations/contact_rates.py).
    mass : float
        kg.
    center : Vector
        Body's origin -> centre of mass, body axes, m.
    middle : Vector
        Centre of mass -> middle of the surface, body axes, m.
    kind, size : float, Vector
        Those of the surface (surfaces.py).
    inertia, inverse : Matrix
        I about the centre of mass, and its inverse, body axes.
    uneven : Matrix
        I - i 1 with the middle one i of the diagonal entries of I. The gyroscopic torque -omega x
        I omega is that of this matrix; the part along a slim body would cancel with I.
    inclined : float
        1 if the plane is not level, else 0.
    plane : Quaternion
        Turns components along the axes of the plane into those of the world.
    mu, restitution : float
        mu is infinite if the body always rolls.
    rolling, rolling_viscous, film : float
        Coefficient C of dry rolling friction, c of viscous rolling friction (N s/m), pi eta R/4
        of a film of air (N s/m).
    patch : float
        Radius rho of the patch of contact, m; 0 for a point.
    way : Pair
        HELD while dry rolling friction holds the point of contact where it is on the body; else
        the direction in which it begins to move, along the plane, or (1, 0) or (-1, 0) for a disk,
        along its rim (touch.py: tangent).
    swift : float
        A speed beside which what is left of a slip is rounding, m/s.
    creep : float
        Largest speed of a slip that has just begun and follows its direction, m/s.
    side : float
        Sign of the spin of a patch that pivots; 0 in other phases.
    lag : float
        By how much its slip may differ from that of Coulomb's law, m/s.
    wide : float
        Time of a difference of its slip, s.
    onset : float
        Speed up to which the friction against a rolling that has just begun is along `way`, which
        turns, m/s; 0 in other phases.
    turn, since : float
        The rate at which it turns, rad/s, and the time of the unknowns from which on, s.
    slack : float
        Share of what dry rolling friction can hold that it holds beyond it: above 0 in a phase
        that begins, but for rounding, with just what it can hold.
    rim : float
        Above 0 while dry rolling friction holds the point of contact of a low torus where it is
        along the ring, and the torus tips (holding.py): the error that this may have, rad. The
        sign of the rolling is in `way`, as for a disk.
    level : float
        1 in a flight of a ring that begins flat or turns through it, else 0: the unknown gap is
        then the one that the ring would have if it were flat, which has no kink there (touch.py).
    until : float
        Time at which what acts jumps, since the start of the course, s; infinite if never.
    began : float
        Time of that start, s.
    origin : Pair
        Where the centre of mass was then, along the plane, m.
    """

    mode: float
    mass: float
    center: Vector
    middle: Vector
    kind: float
    size: Vector
    inertia: Matrix
    inverse: Matrix
    uneven: Matrix
    inclined: float
    plane: Quaternion
    mu: float
    restitution: float
    rolling: float
    rolling_viscous: float
    film: float
    patch: float
    way: Pair
    swift: float
    creep: float
    side: float
    lag: float
    wide: float
    onset: float
    turn: float
    since: float
    slack: float
    rim: float
    level: float
    until: float
    began: float
    origin: Pair


CONTACT = layout(ContactParameters)
