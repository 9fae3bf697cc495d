# SPDX-License-Identifier: Apache-2.0
"""Kernels of forces, torques and potentials that expressions give (scene/effects/protocol.py).

Symbols: R turns body components into world components, q is its quaternion; c is the centre of
mass, o the body's origin, P the point of reference of the equations.
"""

import functools

from rigid_body_sim.numerics.vectors import minus, plus
from rigid_body_sim.scene.effects.protocol import Acting, Potential
from rigid_body_sim.scene.expressions import tree, winding
from rigid_body_sim.scene.expressions.source import (
    ATTITUDE,
    IDENTITY,
    PLACE,
    RATES,
    STATE_NAMES,
    TIME,
    VELOCITY,
    WORLD_RATES,
    Lines,
    frame_matrix,
    kernel,
    prelude,
)

STATE = 'qx, qy, qz, qw, wx, wy, wz, vx, vy, vz'
IN_FIELD = {*TIME, *PLACE, *VELOCITY}
OF_MOTION = {*VELOCITY, *RATES, *WORLD_RATES, 'rate'}


def _lines(trees, parameters, frame):
    """Return the Lines of trees, not computed yet; a jump of the angle has a switch."""
    lines = Lines(dict(parameters))
    if frame.hinge is not None:
        lines.jumps = winding.jumps(trees, parameters)
        if lines.jumps and frame.hinge.winds:
            lines.wind()
    return lines


def _acting(lines, trees, frame, result, gives, books):
    """Return the Acting whose kernel computes trees and returns a result."""
    used = tree.names(*trees)
    in_field = bool(used & IN_FIELD)
    begin = prelude(lines, used, frame)
    arguments = STATE + ', t, x, y, z' * in_field
    made, switching, modes = kernel(gives, arguments, lines, begin, result), '', ()
    if lines.switches:
        found = f'({", ".join(lines.switches.values())},)'
        switching = kernel('switches', arguments, lines, begin, found).name
        order = list(lines.values)
        modes = tuple(order.index(mode) for mode in lines.switches)
    moving = books != 'heat' and bool(used & OF_MOTION)
    return Acting(made.name, made.values, gives, books, in_field, moving,
                  switching=switching, modes=modes, timed=bool(used & {*TIME}),
                  rooted=_rooted(trees), winding=lines.jumps)


def _rooted(trees):
    """Return whether trees take a root or a fractional power of something that changes."""
    moving = set()
    for one in tree.parts(*trees):
        if one.args[0] in moving and (
                one.op == 'sqrt' or (one.op == '^' and not _is_whole(one.args[1]))):
            return True
        if one.args[0] in STATE_NAMES or not moving.isdisjoint(one.args):
            moving.add(one)
    return False


def _is_whole(exponent):
    return exponent.op == 'number' and exponent.args[0] == int(exponent.args[0])


@functools.lru_cache(maxsize=256)
def torque(trees, axes, parameters, frame, books):
    """Return the Acting of a torque by three trees.

    Parameters
    ----------
    trees : tuple of 3 Terms
        Components, N m.
    axes : str
        ``body`` or ``world``: of the components.
    parameters : tuple of (str, float)
    frame : Frame
    books : str
    """
    lines = _lines(trees, parameters, frame)
    components = ', '.join(lines.of(*trees))
    return _acting(lines, trees, frame, _to_frame(lines, components, axes, frame), 'torque', books)


@functools.lru_cache(maxsize=256)
def force(trees, axes, parameters, at, frame, books):
    """Return the Actings of a force by three trees at a point: force and moment, or the moment.

    A force of zero does not act.

    Parameters
    ----------
    at : tuple of 3 floats
        The point, body axes, m.
    trees, axes, parameters, frame, books
        As those of `torque`, in N.
    """
    arm = minus(frame.from_body(at), frame.from_body(frame.point))
    found = []
    if all(one == tree.ZERO for one in trees):
        return ()
    if frame.pushed:
        lines = _lines(trees, parameters, frame)
        components = ', '.join(lines.of(*trees))
        found.append(_acting(lines, trees, frame, _to_world(lines, components, axes, frame),
                             'force', books))
    if any(arm):
        lines = _lines(trees, parameters, frame)
        components = ', '.join(lines.of(*trees))
        r = ', '.join(lines.value(f'arm{k}', part) for k, part in enumerate(arm))
        turned = _to_frame(lines, components, axes, frame)
        found.append(_acting(lines, trees, frame, f'cross(({r}), {turned})', 'torque', books))
    return tuple(found)


def _to_frame(lines, components, axes, frame):
    """Return the text of components along the frame's axes."""
    if axes == 'world':
        return f'rotate_back(qx, qy, qz, qw, {components})'
    if frame.axes == IDENTITY:
        return f'({components})'
    return f'apply({frame_matrix(lines, frame, back=True)}, ({components}))'


def _to_world(lines, components, axes, frame):
    """Return the text of world components."""
    if axes == 'world':
        return f'({components})'
    return f'rotate(qx, qy, qz, qw, *{_to_frame(lines, components, axes, frame)})'


def gradient(energy, frame, turn=None):
    """Return force and torque about the body's origin, three trees each, as `pulls` has them."""
    x, y, z, w = (tree.term('name', name) for name in ATTITUDE)
    place = [tree.negative(one) for one in tree.derivatives(energy, PLACE)]
    by_q = tree.derivatives(energy, ATTITUDE)
    columns = ((w, z, tree.negative(y), tree.negative(x)),
               (tree.negative(z), w, x, tree.negative(y)),
               (y, tree.negative(x), w, tree.negative(z)))
    half = tree.number(-0.5)
    turn = turn or [tree.times(half, functools.reduce(tree.plus, map(tree.times, by_q, column)))
                    for column in columns]
    if frame.hinge is not None:
        along, = tree.derivatives(energy, ['angle'])
        turn = [tree.minus(one, tree.times(tree.number(part), along))
                for one, part in zip(turn, frame.hinge.axis, strict=True)]
    return tuple(place), tuple(turn)


@functools.lru_cache(maxsize=256)
def pulls(energy, parameters, frame, turn=None, books='potential'):
    """Return the Actings of a potential: force and torque by differentiation.

        F = -dU/do,    torque about o: Gamma_i = -dU/dq . (q e_i)/2

    (a turn by the small angle a about body axis i changes q by q e_i a/2, and the angle of a hinge
    about n by a n_i, which adds -dU/d(angle) n). The force acts at o; so
    about the point of reference P the torque is Gamma + (o - P) x F.

    Parameters
    ----------
    energy : Term
        U in J, of place and attitude.
    parameters : tuple of (str, float)
    frame : Frame
    turn : tuple of 3 Terms, optional
        Gamma, body axes, from an effect that has it without terms that cancel: the rounding of
        such terms would spin a slim body about its axis.
    books : str
        ``work`` where U depends on the time and is not a potential.
    """
    place, turn = gradient(energy, frame, turn)
    found, moved = [], any(one is not tree.ZERO for one in place)
    if frame.pushed and moved:
        lines = _lines(place, parameters, frame)
        found.append(_acting(lines, place, frame, f'({", ".join(lines.of(*place))})', 'force',
                             books))
    if (moved and any(frame.point)) or any(one is not tree.ZERO for one in turn):
        lifted = moved and any(frame.point)
        used = (*turn, *place) if lifted else tuple(turn)
        lines = _lines(used, parameters, frame)
        about = _to_frame(lines, ', '.join(lines.of(*turn)), 'body', frame)
        if lifted:
            at_origin = _to_frame(lines, ', '.join(lines.of(*place)), 'world', frame)
            r = ', '.join(lines.value(f'arm{k}', -part)
                          for k, part in enumerate(frame.from_body(frame.point)))
            about = f'plus({about}, cross(({r}), {at_origin}))'
        found.append(_acting(lines, used, frame, about, 'torque', books))
    return tuple(found)


@functools.lru_cache(maxsize=256)
def potential(energy, parameters, frame):
    """Return the Potential of a tree; arguments as those of `pulls`."""
    lines = Lines(dict(parameters))
    result, = lines.of(energy)
    point = plus(frame.from_body(frame.point), frame.arm)
    before, used = [], tree.names(energy)
    if used & {*ATTITUDE, 'angle'}:
        before += prelude(lines, {*ATTITUDE, 'angle'} & used, frame)
    if used & {*PLACE}:
        r = ', '.join(lines.value(f'back{k}', part) for k, part in enumerate(point))
        before.append('    the_x, the_y, the_z = '
                      f'minus((x, y, z), rotate(qx, qy, qz, qw, {r}))')
    made = kernel('energy', 'qx, qy, qz, qw, x, y, z', lines, before, result)
    return Potential(made.name, made.values)
