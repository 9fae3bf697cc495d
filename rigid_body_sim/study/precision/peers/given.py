# SPDX-License-Identifier: Apache-2.0
"""The numbers given to a peer: those of a problem as its user would write them down."""

from rigid_body_sim.study.precision.peers import ball, body, pendulum

_KINDS = {'free': body.of, 'pivot': body.of, 'hinge': pendulum.of, 'table': ball.of}


def of(problem):
    """Return the Body, Pendulum or Ball of a problem, by what holds the body.

    Raises
    ------
    RefusedError
        If peers are not asked to run such a problem.
    """
    return _KINDS[problem.scene.constraint.kind](problem.scene)
