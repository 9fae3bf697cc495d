"""What a peer is given: the numbers of a problem as its user would write them down, by what holds the body."""

from rigid_body_sim.study.precision.peers import ball, body, pendulum

_KINDS = {'free': body.of, 'pivot': body.of, 'hinge': pendulum.of, 'table': ball.of}


def of(problem):
    """Return the Body, Pendulum or Ball of a problem; RefusedError says what is not given to peers."""
    return _KINDS[problem.scene.constraint.kind](problem.scene)
