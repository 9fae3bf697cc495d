# SPDX-License-Identifier: Apache-2.0
"""Bounds of the rates of a scene, from its potentials and drives, and of the angle turned."""

import math
from functools import reduce
from operator import add

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.mechanics.parameters import moment_about_hinge
from rigid_body_sim.numerics.functions import hypot3
from rigid_body_sim.scene.constraints.protocol import Mechanism
from rigid_body_sim.scene.scene import kept


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


def swing_momentum(scene):
    """Return the largest angular momentum (kg m^2/s) that potentials can give a held body.

    Of a body on a plane it is that of a fall by its own size: friction may turn one that did not
    turn, and bring it to rest.
    """
    body, constraint = scene.body, scene.constraint
    if constraint.mechanism is Mechanism.PLANE:
        far = max(body.surface.size)
        return body.mass * far * math.sqrt(hypot3(*scene.field) * far)
    moment = (max(constraint.inertia(body).moments) if constraint.axis is None
              else moment_about_hinge(body, constraint))
    return swing_rate(scene) * moment


def drive(scene, wrench):
    """Return a bound of the angular acceleration (rad/s^2) by drives and a held wrench.

    It is the sum of their torques over the least moment.
    """
    body, constraint = scene.body, scene.constraint
    torque = reduce(add, (bounds.torque for bounds in _bounds(scene)), 0.0)
    if wrench:
        lever = hypot3(*constraint.arm(body)) if constraint.holds_a_point else 0.0
        torque += hypot3(*wrench.torque) + lever * hypot3(*wrench.force)
    if torque == 0.0:
        return 0.0
    if constraint.axis is not None:
        return torque / moment_about_hinge(body, constraint)
    return torque / min(moment for moment in constraint.inertia(body).moments if moment > 0.0)


def unbounded(scene):
    """Return whether anything acts whose bounds are not known."""
    return any(effect.acting is not None and effect.bounds is None for effect in scene.effects)


def borne(scene):
    """Return the largest angular acceleration that dry friction at a hinge prevents, rad/s^2."""
    grip = reduce(add, (effect.grip for effect in scene.effects), 0.0)
    return grip / moment_about_hinge(scene.body, scene.constraint) if grip > 0.0 else 0.0


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


def _bounds(scene):
    return [effect.bounds(scene.body, scene.constraint) for effect in scene.effects
            if effect.bounds is not None]
