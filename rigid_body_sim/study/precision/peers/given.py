# SPDX-License-Identifier: Apache-2.0
"""The numbers given to a peer: those of a problem as its user would write them down."""

from rigid_body_sim.study.precision.peers import ball, body, pendulum, plane
from rigid_body_sim.study.precision.runner import RefusedError

_KINDS = {'free': body.of, 'pivot': body.of, 'hinge': pendulum.of, 'table': ball.of}


def of(problem):
    """Return the Body, Pendulum or Ball of a problem, by what holds the body.

    Raises
    ------
    RefusedError
        If peers are not asked to run such a problem, or need contact of their own for it.
    """
    if plane.has_surface(problem.scene):
        raise RefusedError('contact of a body with a surface: it has none, '
                           'and the harness gives the equations of rolling to heyoka')
    return _KINDS[problem.scene.constraint.kind](problem.scene)
