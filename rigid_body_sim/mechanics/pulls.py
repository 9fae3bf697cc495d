# SPDX-License-Identifier: Apache-2.0
"""The sum of everything that acts in a scene, whatever effects it comes from."""

from typing import NamedTuple

from rigid_body_sim.compilation.layout import Matrix, Vector
from rigid_body_sim.numerics.vectors import plus
from rigid_body_sim.scene.scene import kept

NOTHING = (0.0, 0.0, 0.0)
BOOKS = {'force': 'potential', 'torque': 'work', 'drag': 'heat'}
"""Where the ledger books each kind of action in a motion in closed form."""


class Total(NamedTuple):
    """Constant forces and torques, and drag in proportion to velocities (effects/protocol.py).

    Attributes
    ----------
    torque : Vector
        About the reference point, components in the frame of the scene, N m.
    couple : Vector
        World components, N m.
    force : Vector
        At the centre of mass, world components, N.
    drag : Matrix
        Torque = drag . omega in the frame of the scene, N m s.
    slowing : float
        c of the force -c v at the centre of mass of a free body, N s/m.
    """

    torque: Vector
    couple: Vector
    force: Vector
    drag: Matrix
    slowing: float


@kept
def total_pull(scene):
    """Return the Total of what acts in a scene.

    Returns
    -------
    Total or None
        None where something acts that is not of this kind, or changes in time, and where another
        point than the body's origin is held.
    """
    frame = scene.frame
    if scene.constraint.axis is None and not frame.moves and any(frame.point):
        return None    # motions about a point hold the body's origin
    pulls = []
    for effect in scene.acting:
        if effect.series is None or effect.acting is None:
            return None
        pull = effect.series(frame, 0.0)
        if any(effect.series(frame, time) != pull for time in effect.breakpoints):
            return None
        if {one.books for one in effect.acting(frame, 0.0)} != _expected(pull):
            return None
        pulls.append(pull)
    return total_of(pulls)


def total_of(pulls):
    """Return the Total of Pulls (effects/protocol.py), their formulas left out."""
    torque = couple = force = NOTHING
    drag, slowing = (NOTHING, NOTHING, NOTHING), 0.0
    for pull in pulls:
        torque, couple = plus(torque, pull.constant), plus(couple, pull.couple or NOTHING)
        force = plus(force, pull.force or NOTHING)
        drag = tuple(map(plus, drag, pull.drag or (NOTHING, NOTHING, NOTHING)))
        slowing += pull.slowing
    return Total(torque, couple, force, drag, slowing)


def _expected(pull):
    """Return the entries of the ledger that belong to the parts of a Pull."""
    parts = {'force': pull.force is not None and any(pull.force),
             'torque': any(pull.constant) or any(pull.couple or NOTHING),
             'drag': pull.drag is not None or pull.slowing != 0.0}
    return {BOOKS[part] for part, is_there in parts.items() if is_there}
