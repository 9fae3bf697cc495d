# SPDX-License-Identifier: Apache-2.0
"""Bounds of the rates of a scene, from its potentials and drives, and of the angle turned."""

import math
from bisect import bisect_right
from functools import reduce
from itertools import accumulate, pairwise
from operator import add

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.mechanics.parameters import moment_about_hinge
from rigid_body_sim.numerics.functions import hypot3
from rigid_body_sim.scene.constraints.protocol import Mechanism
from rigid_body_sim.scene.effects.protocol import Cancelling
from rigid_body_sim.scene.scene import kept

REST = 2.0 ** -60    # rad/s: a body that turns no faster rests; in a year it turns 3e-11 rad


@kept
def swing_rate(scene):
    """Return how much potentials can add to the angular speed of a held body (rad/s).

    It is 2 sqrt(U/I) by conservation of energy, with 2 U the range of the potential: U = M g r for
    the weight, r the arm from the constraint to the centre of mass.
    """
    body, constraint = scene.body, scene.constraint
    energy = reduce(add, (bounds.energy for bounds in _bounds(scene)), 0.0)
    if energy == 0.0:
        return 0.0
    # the moments across the arm of a symmetric body count, whatever the third one is
    across = (sorted(constraint.inertia(body).moments)[1] if constraint.axis is None
              else moment_about_hinge(body, constraint))
    return 2.0 * math.sqrt(energy / across)


def swing_momentum(scene, potential=0.0):
    """Return the largest angular momentum (kg m^2/s) that potentials can give a body.

    Of a body on a plane it is that of a fall by its own size: friction may turn one that did not
    turn, and bring it to rest. Where a potential has no bounds, it is that of a body which has all
    of an energy as kinetic energy: sqrt(2 I U).

    Parameters
    ----------
    potential : float
        The size of the potential energy that the body has or had, J.
    """
    body, moment = scene.body, _largest_moment(scene)
    let_go = math.sqrt(2.0 * moment * potential) if _swings_unbounded(scene) else 0.0
    if scene.constraint.mechanism is Mechanism.PLANE:
        far = max(body.surface.size)
        return max(let_go, body.mass * far * math.sqrt(hypot3(*scene.field) * far))
    return max(let_go, swing_rate(scene) * moment)


def passed(scene, time, potential):
    """Return the energy (J) and angular momentum (kg m^2/s) of a body on its way, about.

    One that is let go, or turned by a torque and stopped by another, is at rest again in the end.
    What torques gave until they jumped, and potentials can give, is the momentum L in between;
    the energy is at least L^2/2I. Both are at least those at the rate REST.

    Parameters
    ----------
    time : float
        The end, s.
    potential : float
        As above, J.
    """
    times, impulses = _given(scene)
    least = resting(scene)[1]
    momentum = max(impulses[bisect_right(times, time)], swing_momentum(scene, potential), least)
    return 0.5 * momentum * momentum / _largest_moment(scene), momentum


def resting(scene):
    """Return the energy (J) and angular momentum (kg m^2/s) of a body that turns at REST."""
    moment = _largest_moment(scene)
    return 0.5 * moment * REST * REST, moment * REST


@kept
def _given(scene):
    """Return the times at which torques jump (s), and what all gave before each of them (N m s).

    The impulses are one more: the last one is that behind the last time.
    """
    ended = sorted((end, torque * (end - begin)) for bounds in _bounds(scene)
                   for (begin, torque), (end, _) in pairwise(bounds.pieces))
    return [end for end, _ in ended], [*accumulate((one for _, one in ended), initial=0.0)]


@kept
def _largest_moment(scene):
    """Return the largest moment of inertia about which a body turns, kg m^2."""
    body, constraint = scene.body, scene.constraint
    if constraint.axis is not None:
        return moment_about_hinge(body, constraint)
    return max(constraint.inertia(body).moments)


def relaxation(scene, L):
    """Return the rate (1/s) at which internal dissipation takes a body to its last axis, at most.

    Near a principal axis the other components of omega grow or fall at rates of this size, by the
    equations of integrators/departure.py.

    Parameters
    ----------
    L : float
        Angular momentum, kg m^2/s.
    """
    moments = scene.constraint.inertia(scene.body).moments
    low, high = min(moments), max(moments)
    return (scene.inner_dissipation * (L * L / high) * ((high - low) / low) if low > 0.0
            else 0.0)


def falling(scene):
    """Return the rate (1/s) at which internal dissipation takes a body down its potentials.

    The axes turn with c times the torque of potentials, which is half their range at most, about;
    infinite where the range of one is not known.
    """
    if scene.inner_dissipation == 0.0:
        return 0.0
    return math.inf if _swings_unbounded(scene) else scene.inner_dissipation * pull(scene)


def pull(scene):
    """Return about the largest torque (N m) of the potentials whose range is known: half of it."""
    return reduce(add, (bounds.energy for bounds in _bounds(scene)), 0.0)


def drive(scene, wrench):
    """Return a bound of the angular acceleration (rad/s^2) by drives and a held wrench.

    It is the sum of their torques over the least moment.
    """
    body, constraint = scene.body, scene.constraint
    torque = reduce(add, (bounds.torque for bounds in _bounds(scene)), 0.0)
    if wrench:
        lever = hypot3(*constraint.arm(body)) if constraint.holds_a_point else 0.0
        torque += hypot3(*wrench.torque) + lever * hypot3(*wrench.force)
    return torque / _least_moment(scene) if torque > 0.0 else 0.0


@kept
def drives(scene):
    """Return the bound that `drive` gives as it changes in time: (time, acceleration) from 0 on.

    Each acceleration (rad/s^2) holds from its time (s) to the next. A drive counts by its share
    (protocol.py): a torque across a slim body does not turn it about its thin axis.
    """
    found = _bounds(scene)
    times = sorted({0.0, *(time for bounds in found for time, _ in bounds.pieces)})
    torques = [reduce(add, (bounds.share * _torque_at(bounds, time) for bounds in found), 0.0)
               for time in times]
    moment = _least_moment(scene) if any(torques) else 1.0
    return [(time, torque / moment) for time, torque in zip(times, torques, strict=True)]


def _torque_at(bounds, time):
    """Return the largest torque (N m) of a drive just after a time (s)."""
    if not bounds.pieces:
        return bounds.torque
    place = bisect_right(bounds.pieces, (time, math.inf)) - 1
    return bounds.pieces[place][1] if place >= 0 else 0.0


def _least_moment(scene):
    """Return the least moment of inertia about which a torque may turn the body, kg m^2."""
    body, constraint = scene.body, scene.constraint
    if constraint.axis is not None:
        return moment_about_hinge(body, constraint)
    return min(moment for moment in constraint.inertia(body).moments if moment > 0.0)


def unbounded(scene):
    """Return whether anything acts whose bounds are not known."""
    return any(effect.acting is not None and effect.bounds is None for effect in scene.effects)


@kept
def _swings_unbounded(scene):
    """Return whether anything whose bounds are not known has a potential."""
    return any(effect.potential is not None and effect.bounds is None for effect in scene.effects)


@kept
def pushed_unbounded(scene):
    """Return whether anything pushes the body whose bounds are not known; heat only slows it."""
    return any(one.books != 'heat' for effect in scene.effects
               if effect.acting is not None and effect.bounds is None
               for one in effect.acting(scene.frame, 0.0))


def borne(scene):
    """Return the largest angular acceleration that dry friction at a hinge prevents, rad/s^2."""
    grip = reduce(add, (effect.grip for effect in scene.effects), 0.0)
    return grip / moment_about_hinge(scene.body, scene.constraint) if grip > 0.0 else 0.0


def cancelling(scene, horizon):
    """Return the accelerations of terms that may cancel each other, rad/s^2 and m/s^2.

    They are potentials, with swing_rate^2 = 4 U/I, springs, and expressions up to a time (s). What
    is left of them is rounding.
    """
    swing, (torque, force) = swing_rate(scene), cancelling_terms(scene, horizon)
    return (swing * swing + (torque / _least_moment(scene) if torque > 0.0 else 0.0),
            force / scene.body.mass if force > 0.0 else 0.0)


def cancelling_terms(scene, horizon):
    """Return the Cancelling of all effects of a scene, N m and N, up to a time (s)."""
    frame = scene.frame
    found = [effect.cancelling(frame, scene.initial, horizon) for effect in scene.effects]
    torque = reduce(add, (one.torque for one in found), 0.0)
    force = reduce(add, (one.force for one in found), 0.0) if frame.moves else 0.0
    return Cancelling(torque, force)


@compiled
def angles_turned(times, rates, first, out):
    """Fill out with bounds of the angles (rad) that a body turns up to times, shape (n,).

    Until each time it counts as turning at its largest rate from then on. Where a rate decays from
    r to r' in proportion to itself, its mean is (r - r')/ln(r/r'), the logarithmic mean, which is
    at most (2 sqrt(r r') + (r + r')/2)/3 (Carlson, The logarithmic mean, Amer. Math. Monthly 79,
    1972); of one that ends at 0 in between a sixth of r counts.

    Parameters
    ----------
    times, rates : array (n,)
        s, from the start on; rad/s.
    first : float
        Rates beyond this one (rad/s) count twice.
    """
    for k in range(len(out)):
        fastest, out[k] = rates[k], 0.0
        for j in range(k - 1, -1, -1):
            later = fastest
            if not rates[j] <= fastest:    # not a number, too
                fastest = rates[j]
            mean = (2.0 * math.sqrt(later * fastest) + 0.5 * (later + fastest)) / 3.0
            out[k] += (mean + max(0.0, mean - first)) * (times[j + 1] - times[j])


@kept
def _bounds(scene):
    return [effect.bounds(scene.body, scene.constraint) for effect in scene.effects
            if effect.bounds is not None]
