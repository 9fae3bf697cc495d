# SPDX-License-Identifier: Apache-2.0
"""The response of a body to an impulse: the free directions move, the rest is reaction.

Symbols: M mass, c centre of mass from the body's origin, I inertia tensor about the point of
reference P (parameters.py), r arm from P to the centre of mass, n unit vector along a hinge, R
rotation from body to world; J impulse of force at the centre of mass and K impulse of torque
(world axes), G = R^T K + r x R^T J their moment about P. The jump d of the angular velocity, the
work W and the reaction (force A, couple B) under each constraint:

    free     d = I^-1 G,  M dV = J                              A = 0
    table    d = I^-1 G,  M dV = J without its z component      A = -J_z
    pivot    d = I^-1 G                                         A = M R (d x r) - J
    hinge    d = n (n . G)/(n . I n)                            A = M R (d x r) - J,
                                                                B = R (I d - G)

with V the velocity of the centre of mass, r = 0 for a free body and on the table, and I about the
hinge's point in the formula of B. Vectors that are turned by R are written in body axes.
"""

from typing import NamedTuple

import numpy as np

from rigid_body_sim.compilation.jit import compiled, compiled_allocating
from rigid_body_sim.compilation.layout import Vector, layout
from rigid_body_sim.mechanics.ledger import ENTRIES, Entries
from rigid_body_sim.mechanics.parameters import CARRIED, FREE, HINGE, PIVOT, SCENE, SKEW, TABLE
from rigid_body_sim.numerics.pair_vectors import cross as cross_pairs
from rigid_body_sim.numerics.pair_vectors import difference, turned_back, with_low
from rigid_body_sim.numerics.pair_vectors import dot as dot_pairs
from rigid_body_sim.numerics.pair_vectors import plus as plus_pairs
from rigid_body_sim.numerics.rotations import rotate, rotate_back
from rigid_body_sim.numerics.vectors import cross, dot, minus, plus, product, scaled
from rigid_body_sim.scene.state import STATE

ZERO = (0.0, 0.0, 0.0)


class Response(NamedTuple):
    """The effects of an impulse besides the change of the state.

    Attributes
    ----------
    work : float
        J.
    angular_impulse : Vector
        About the point of reference, world axes, N m s.
    reaction_force, reaction_couple : Vector
        Impulse of the reaction (N s, N m s), world axes: at the fixed point, at `through` of a
        hinge, at the contact with the table.
    """

    work: float
    angular_impulse: Vector
    reaction_force: Vector
    reaction_couple: Vector


class Given(NamedTuple):
    """An impulse of force or torque (N s or N m s), and what rounding took from it."""

    rounded: Vector
    lost: Vector


GIVEN, RESPONSE = layout(Given), layout(Response)
GIVEN_SIZE = GIVEN.size
load_rounded, load_lost = GIVEN.part('rounded').load, GIVEN.part('lost').load
RESPONSE_SIZE = RESPONSE.size
WORK = RESPONSE.part('work').first
SKEW_SIZE = SKEW.size
load_scene, load_skew, load_state = SCENE.load, SKEW.load, STATE.load
load_response, store_response = RESPONSE.load, RESPONSE.store
load_entries, store_entries = ENTRIES.load, ENTRIES.store
store_omega = STATE.part('angular_velocity').store
store_velocity = STATE.part('velocity').store


@compiled
def apply_impulse(p, state, force, couple, out):
    """Change a state by an impulse.

    Parameters
    ----------
    p : array
        SceneParameters.
    state : array (14,)
        StateView, changed in place.
    force : array (3,) or (6,)
        Impulse of force J (N s) at the centre of mass, world axes; three more numbers are what
        rounding took from it.
    couple : array (3,) or (6,)
        Impulse of torque K (N m s), world axes, likewise.
    out : array (10,)
        Filled with the Response.

    Returns
    -------
    bool
        False if G has a part along an axis of zero moment, beyond its rounding; the body does not
        respond to that part.
    """
    scene, now = load_scene(p), load_state(state)
    q, omega = now.orientation, now.angular_velocity
    J, arm = (force[0], force[1], force[2]), _arm(scene)
    moment = _moment(scene, q, force, couple)
    G = (moment[0][0], moment[1][0], moment[2][0])
    solvable, turns = True, G
    if scene.kind == HINGE:
        along = dot(scene.hinge_axis, G)
        d = scaled(along / scene.hinge_moment, scene.hinge_axis)
        turns = scaled(along, scene.hinge_axis)
    else:
        solvable, d = _jump(p, scene, moment)
    # the work of an impulse goes with the mean of the velocities before and after
    work = dot(turns, plus(omega, scaled(0.5, d)))
    store_omega(state, plus(omega, d))
    reaction, bearing = ZERO, ZERO
    if scene.kind == FREE or scene.kind == TABLE:
        along_table = (J[0], J[1], J[2] if scene.kind == FREE else 0.0)
        work += _push_center(scene, now, state, along_table, d)
        reaction = (0.0, 0.0, along_table[2] - J[2])
    else:
        # M dV of the centre of mass: the bearing supplies the rest of it
        pushed = scaled(scene.mass, rotate(*q, *cross(d, arm)))
        reaction = minus(pushed, J)
        if scene.kind == CARRIED:    # what moves the pivot does work, too
            work += dot(pushed, plus(now.velocity, rotate(*q, *cross(omega, scene.through))))
        # the body's origin moves about what is held
        store_velocity(state, minus(now.velocity, rotate(*q, *cross(d, scene.through))))
    if scene.kind == HINGE:
        bearing = rotate(*q, *minus(_momentum_at_hinge(scene, d, arm), G))
    store_response(out, Response(work, rotate(*q, *turns), reaction, bearing))
    return solvable


@compiled_allocating
def push(p, state, force, couple, entries):
    """Change a state by an impulse as `apply_impulse` does, and add to the entries of the ledger.

    Parameters
    ----------
    p, state, force, couple : array
        See `apply_impulse`.
    entries : array (5,)
        Entries of ledger.py, changed in place.

    Returns
    -------
    bool, float
        What `apply_impulse` returned, and the work (J).
    """
    if not (force[0] != 0.0 or force[1] != 0.0 or force[2] != 0.0
            or couple[0] != 0.0 or couple[1] != 0.0 or couple[2] != 0.0):
        return True, 0.0
    out = np.empty(RESPONSE_SIZE)
    solvable = apply_impulse(p, state, force, couple, out)
    add_entries(out, entries)
    return solvable, out[WORK]


@compiled
def add_entries(response, entries):
    """Add the Response to an impulse, shape (10,), to the entries of the ledger, shape (5,)."""
    before, added = load_entries(entries), load_response(response)
    store_entries(entries, Entries(
        before.work + added.work, before.dissipated,
        plus(before.angular_impulse, added.angular_impulse)))


@compiled
def _arm(scene):
    """Return r, from the point of reference to the centre of mass."""
    if scene.kind == PIVOT or scene.kind == HINGE or scene.kind == CARRIED:
        return minus(scene.center, scene.through)
    return ZERO


@compiled
def _moment(scene, q, force, couple):
    """Return G, the moment of the impulses about the point of reference, in pairs."""
    J, K = turned_back(*q, _in_pairs(force)), turned_back(*q, _in_pairs(couple))
    if scene.kind == FREE or scene.kind == TABLE:
        return K
    return plus_pairs(K, cross_pairs(difference(scene.center, scene.through), J))


@compiled
def _push_center(scene, now, state, J, d):
    """Change the velocity of a body that moves by M dV = J; return the work of J.

    The origin moves with the centre of mass, less the change of omega x c between them.
    """
    q, half = now.orientation, 0.5 / scene.mass
    of_center = plus(now.velocity, rotate(*q, *cross(now.angular_velocity, scene.center)))
    between = rotate(*q, *cross(d, scene.center))
    gained = (J[0] / scene.mass, J[1] / scene.mass, J[2] / scene.mass)
    store_velocity(state, plus(now.velocity, minus(gained, between)))
    return dot(J, plus(of_center, scaled(half, J)))


@compiled
def _jump(p, scene, moment):
    """Return (whether G has no part along an axis of zero moment, I^-1 G of the rest).

    `moment` is G in pairs.
    """
    along = _along_axes(p, scene, moment)
    # rounding of a given torque, or of an arm along the axis: 5e-16 of G (20,000 random ones each)
    slack = 1e-14 * (abs(moment[0][0]) + abs(moment[1][0]) + abs(moment[2][0]))
    I1, I2, I3 = scene.moments
    solvable = (_turns(I1, along[0], slack) and _turns(I2, along[1], slack)
                and _turns(I3, along[2], slack))
    principal = _quotient(along[0], I1), _quotient(along[1], I2), _quotient(along[2], I3)
    return solvable, rotate(*scene.axes, *principal)


@compiled
def _along_axes(p, scene, moment):
    """Return the components of a vector of pairs along the principal axes, rounded."""
    if scene.skew != 0.0:
        axes = load_skew(p, len(p) - SKEW_SIZE)
        return (dot_pairs(with_low(axes.rows[0], axes.lost[0]), moment)[0],
                dot_pairs(with_low(axes.rows[1], axes.lost[1]), moment)[0],
                dot_pairs(with_low(axes.rows[2], axes.lost[2]), moment)[0])
    return moment[0][0], moment[1][0], moment[2][0]


@compiled
def _in_pairs(given):
    """Return an array of an impulse, shape (3,) or (6,), as a vector of pairs."""
    return with_low(load_rounded(given), load_lost(given) if len(given) == GIVEN_SIZE else ZERO)


@compiled
def _turns(moment, m, slack):
    """Return whether a momentum m belongs to some rotation about an axis of that moment."""
    return moment > 0.0 or abs(m) <= slack


@compiled
def _quotient(m, moment):
    return m / moment if moment > 0.0 else 0.0


@compiled
def _momentum_at_hinge(scene, d, r):
    """Return I d about the hinge's point: that about the centre of mass, and M r x (d x r)."""
    principal = product(scene.moments, rotate_back(*scene.axes, *d))
    return plus(rotate(*scene.axes, *principal), scaled(scene.mass, cross(r, cross(d, r))))
