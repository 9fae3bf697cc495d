# SPDX-License-Identifier: Apache-2.0
"""Forces, torques and potentials for power series: what actions.py has as kernels.

They are trees, but for a constant force or torque that numbers can say.
"""

from rigid_body_sim.numerics.vectors import cross, minus
from rigid_body_sim.scene.effects.protocol import Formulas, Pull
from rigid_body_sim.scene.expressions import actions, tree, vectors

NONE = (tree.ZERO,) * 3


def torque(trees, axes, parameters, frame):
    """Return the Pull of a torque; arguments as those of :func:`actions.torque`."""
    value = _numbers(trees)
    if value is not None:
        return Pull(couple=value) if axes == 'world' else Pull(constant=frame.from_body(value))
    about = vectors.to_body(trees) if axes == 'world' else tuple(trees)
    return Pull(formulas=(Formulas(about, parameters=parameters),))


def force(trees, axes, parameters, at, frame):
    """Return the Pull of a force at a point; arguments as those of :func:`actions.force`."""
    value, reach = _numbers(trees), minus(at, frame.point)
    if value is not None:
        if axes == 'world' and frame.from_body(reach) == frame.arm:
            return Pull(force=value)
        if axes == 'body' and not frame.moves:
            return Pull(constant=frame.from_body(cross(reach, value)))
    arm = vectors.constant(reach)
    in_body = vectors.to_body(trees) if axes == 'world' else tuple(trees)
    pushing = NONE
    if frame.moves:
        pushing = tuple(trees) if axes == 'world' else vectors.to_world(trees)
    return Pull(formulas=(Formulas(vectors.cross(arm, in_body), pushing, parameters),))


def _numbers(trees):
    """Return the components of trees that are numbers, else None."""
    if any(one.op != 'number' for one in trees):
        return None
    x, y, z = (one.args[0] for one in trees)
    return x, y, z


def pulls(energy, parameters, frame, turn=None):
    """Return the Pull of a potential; arguments as those of :func:`actions.pulls`."""
    place, turn = actions.gradient(energy, frame, turn)
    arm = vectors.constant(minus((0.0, 0.0, 0.0), frame.point))
    about = vectors.total(turn, vectors.cross(arm, vectors.to_body(place)))
    return Pull(formulas=(Formulas(about, place if frame.moves else NONE, parameters),))
