# SPDX-License-Identifier: Apache-2.0
"""Family of the step that game and robotics engines take: velocities first, then positions.

With the rates at the start of the step (torques and the gyroscopic term alike taken there,
explicitly):

    omega1 = omega + h omega'(q, omega),    q1 = q exp(h omega1)
    v1 = v + h F/M,                         x1 = x + h v1
    on a hinge:  phi'1 = phi' + h phi''(phi, phi'),    phi1 = phi + h phi'1

exp is the rotation by the vector h omega1 (frame axes); q1 is made unit again. Sums are plain,
nothing is compensated. Under internal dissipation the axes turn with omega1 + c m1 x omega1, as
the equations have it.
"""

from rigid_body_sim.integrators.equations import flying, hinged
from rigid_body_sim.integrators.families.one_step import (  # noqa: F401
    begin,
    bind,
    equations_of,
    march,
)

TAKES_WRENCH = True
LANES = False
KINKS = True
ROOTS = True

TURN = """
    w1, w2, w3 = y[4] + h * k0[4], y[5] + h * k0[5], y[6] + h * k0[6]
    ux, uy, uz = axes_rate(p, y[0], y[1], y[2], y[3], w1, w2, w3, {velocity})
    turn = from_rotation_vector(h * ux, h * uy, h * uz)
    q1, q2, q3, q4 = normalised(*multiply(y[0], y[1], y[2], y[3], *turn))
"""
ON_HINGE = """
    speed = y[1] + h * k0[1]
    return (y[0] + h * speed, speed), c
"""
TURNING = TURN.format(velocity='0.0, 0.0, 0.0') + """
    return (q1, q2, q3, q4, w1, w2, w3), c
"""
FLYING = """
    v1, v2, v3 = y[10] + h * k0[10], y[11] + h * k0[11], y[12] + h * k0[12]
""" + TURN.format(velocity='v1, v2, v3') + """
    return (q1, q2, q3, q4, w1, w2, w3, y[7] + h * v1, y[8] + h * v2, y[9] + h * v3, v1, v2, v3), c
"""


def step_source(method, equations):
    """Return the source of ``step(p, y, c, k0, h) -> (y, c)`` for equations."""
    lines = {hinged: ON_HINGE, flying: FLYING}.get(equations.kind, TURNING)
    imports = (
        ''
        if equations.kind is hinged
        else (
            f'from {equations.kernels.__name__} import axes_rate\n'
            'from rigid_body_sim.numerics.rotations import '
            'from_rotation_vector, multiply, normalised\n'
        )
    )
    return f'{imports}\n\n@compiled\ndef step(p, y, c, k0, h):{lines}'
