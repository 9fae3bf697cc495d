# SPDX-License-Identifier: Apache-2.0
"""The sum of everything that acts in a scene, whatever effects it comes from."""

import functools
import operator
from fractions import Fraction
from typing import NamedTuple

from rigid_body_sim.compilation.layout import Matrix, Vector
from rigid_body_sim.numerics.vectors import plus, scaled
from rigid_body_sim.scene.effects.protocol import Pull, Twist
from rigid_body_sim.scene.principal_axes import ULPS
from rigid_body_sim.scene.scene import kept

NOTHING = (0.0, 0.0, 0.0)


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
        Torque = drag . omega in the frame of the scene, N m s. Its skew part is that of
        `carried`.
    slowing : float
        c of the force -c v at the centre of mass of a free body, N s/m.
    """

    torque: Vector
    couple: Vector
    force: Vector
    drag: Matrix
    slowing: float

    @property
    def carried(self):
        """The h of the torque h x omega in the frame of the scene, kg m^2/s: that of rotors."""
        (_, xy, xz), (yx, _, yz), (zx, zy, _) = self.drag
        return 0.5 * (zy - yz), 0.5 * (xz - zx), 0.5 * (yx - xy)

    @property
    def is_carried_only(self):
        """Whether the drag is but what rotors carry."""
        return all(one == -other for row, column in zip(self.drag, zip(*self.drag, strict=True),
                                                        strict=True)
                   for one, other in zip(row, column, strict=True))


@kept
def total_pull(scene):
    """Return the Total of what acts in a scene, wherever the ledger books it.

    Forces that cancel each other to the rounding of the scene are none.

    Returns
    -------
    Total or None
        None where something acts that is not of this kind, or changes in time, and where the
        point that is held moves.
    """
    return _total_of(scene, scene.acting)


@kept
def twisted(scene):
    """Return the Twist of all torsion springs of a scene, and the Total of what acts besides.

    Returns
    -------
    (Twist, Total) or None
        The Twist has Fractions, exactly what the doubles of the scene say. None where no spring
        twists the body, and where there is no such Total.
    """
    rest = _total_of(scene, [effect for effect in scene.acting if effect.twist is None])
    stiffness = torque = damping = Fraction(0)
    for effect in scene.acting:
        if effect.twist is not None:
            k, angle, c = map(Fraction, effect.twist)
            stiffness, torque, damping = stiffness + k, torque + k * angle, damping + c
    if rest is None or not stiffness:
        return None
    return Twist(stiffness, torque / stiffness, damping), rest


def _total_of(scene, effects):
    """Return the Total of some effects of a scene, or None as `total_pull` does."""
    frame, pulls = scene.frame, []
    if frame.path is not None:
        return None
    for effect in effects:
        field = effect.uniform_field
        if field is not None:
            pulls.append(Pull(force=scaled(frame.mass, field)))
            continue
        if effect.series is None or effect.acting is None:
            return None
        pull = effect.series(frame, 0.0)
        if pull.formulas or any(effect.series(frame, time) != pull for time in effect.breakpoints):
            return None
        pulls.append(pull)
    return total_of(pulls)._replace(force=_sums([pull.force for pull in pulls if pull.force]))


def _sums(vectors):
    """Return the sum of vectors; components that cancel to the rounding of the scene are 0."""
    if not vectors:
        return NOTHING
    totals = []
    for column in zip(*vectors, strict=True):
        total = functools.reduce(operator.add, column, 0)
        is_left = abs(total) > ULPS * functools.reduce(operator.add, map(abs, column))
        totals.append(total if is_left else total - total)
    return tuple(totals)


@kept
def load_of(scene):
    """Return the force at the centre of mass of a held body, if besides it only rotors act.

    Returns
    -------
    tuple of 3 Fractions or None
        N, world components, exactly what the doubles of the scene say. None where anything else
        acts.
    """
    total = total_pull(scene)
    if total is None or any(total.torque) or any(total.couple) or not total.is_carried_only:
        return None
    # a field pulls at a bearing even where it turns nothing
    forces = [effect.series(scene.frame, 0.0).force for effect in scene.acting
              if effect.uniform_field is None]
    weight = scaled(Fraction(scene.body.mass), tuple(map(Fraction, scene.field)))
    return _sums([weight, *(tuple(map(Fraction, force)) for force in forces if force)])


@kept
def weight_of(scene):
    """Return g (m/s^2, exactly) of a held body whose load is M g along -z, else None."""
    if scene.weight is not None:    # one product, no exact sums
        return scene.weight if scene.frame.path is None else None
    load = load_of(scene)
    if load is None or load[0] or load[1] or load[2] > 0:
        return None
    return -load[2] / Fraction(scene.body.mass)


def total_of(pulls):
    """Return the Total of Pulls (effects/protocol.py), their formulas left out."""
    torque = couple = force = NOTHING
    drag, slowing = (NOTHING, NOTHING, NOTHING), 0.0
    for pull in pulls:
        torque = plus(torque, pull.constant)
        if pull.couple:
            couple = plus(couple, pull.couple)
        if pull.force:
            force = plus(force, pull.force)
        if pull.drag:
            drag = tuple(map(plus, drag, pull.drag))
        slowing += pull.slowing
    return Total(torque, couple, force, drag, slowing)
