# SPDX-License-Identifier: Apache-2.0
"""Forces, torques and potentials as trees, for power series: what actions.py has as kernels."""

from rigid_body_sim.numerics.vectors import minus
from rigid_body_sim.scene.effects.protocol import Formulas, Pull
from rigid_body_sim.scene.expressions import actions, tree, vectors

NONE = (tree.ZERO,) * 3


def torque(trees, axes, parameters):
    """Return the Pull of a torque; arguments as those of :func:`actions.torque`."""
    about = vectors.to_body(trees) if axes == 'world' else tuple(trees)
    return Pull(formulas=(Formulas(about, parameters=parameters),))


def force(trees, axes, parameters, at, frame):
    """Return the Pull of a force at a point; arguments as those of :func:`actions.force`."""
    arm = vectors.constant(minus(at, frame.point))
    in_body = vectors.to_body(trees) if axes == 'world' else tuple(trees)
    pushing = NONE
    if frame.moves:
        pushing = tuple(trees) if axes == 'world' else vectors.to_world(trees)
    return Pull(formulas=(Formulas(vectors.cross(arm, in_body), pushing, parameters),))


def pulls(energy, parameters, frame, turn=None):
    """Return the Pull of a potential; arguments as those of :func:`actions.pulls`."""
    place, turn = actions.gradient(energy, frame, turn)
    arm = vectors.constant(minus((0.0, 0.0, 0.0), frame.point))
    about = vectors.total(turn, vectors.cross(arm, vectors.to_body(place)))
    return Pull(formulas=(Formulas(about, place if frame.moves else NONE, parameters),))
