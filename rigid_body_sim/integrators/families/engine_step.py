# SPDX-License-Identifier: Apache-2.0
"""Family of the step that game and robotics engines take: velocities first, then positions.

With the rates at the start of the step (torques and the gyroscopic term alike taken there,
explicitly):

    omega1 = omega + h omega'(q, omega),    q1 = q exp(h omega1)
    v1 = v + h F/M,                         x1 = x + h v1
    on a hinge:  phi'1 = phi' + h phi''(phi, phi'),    phi1 = phi + h phi'1

exp is the rotation by the vector h omega1 (frame axes); q1 is made unit again. Sums are plain,
not compensated. Under internal dissipation the axes turn with omega1 + c m1 x omega1, as
the equations have it.
"""

from rigid_body_sim.integrators.equations import flying, hinged
from rigid_body_sim.integrators.families.one_step import (  # noqa: F401
    begin,
    bind,
    equations_of,
    march,
)
from rigid_body_sim.integrators.protocols import FINEST  # noqa: F401

ASKS = {'step': ()}
TABLE = False
TAKES_WRENCH = True
LANES = False
KINKS = True
ROOTS = True

TURN = """
    omega = plus(y[OMEGA:PLACE], scaled(h, k0[OMEGA:PLACE]))
    turn = scaled(h, axes_rate(p, *y[:OMEGA], *omega, {velocity}))
    q = normalised(*multiply(*y[:OMEGA], *from_rotation_vector(*turn)))
"""
ON_HINGE = """
    (phi, speed), (_, growth) = y, k0
    speed = speed + h * growth
    return (phi + h * speed, speed), c
"""
TURNING = TURN.format(velocity='0.0, 0.0, 0.0') + """
    return (*q, *omega), c
"""
FLYING = """
    velocity = plus(y[DRIFT:CLOCK], scaled(h, k0[DRIFT:CLOCK]))
""" + TURN.format(velocity='*velocity') + """
    return (*q, *omega, *plus(y[PLACE:DRIFT], scaled(h, velocity)), *velocity), c
"""


def step_source(method, equations):
    """Return the source of ``step(p, y, c, k0, h) -> (y, c)`` for equations."""
    lines = {hinged: ON_HINGE, flying: FLYING}.get(equations.kind, TURNING)
    imports = (
        ''
        if equations.kind is hinged
        else (
            f'from {equations.kernels.__name__} import axes_rate\n'
            'from rigid_body_sim.integrators.equations.euler import CLOCK, DRIFT, OMEGA, PLACE\n'
            'from rigid_body_sim.numerics.vectors import plus, scaled\n'
            'from rigid_body_sim.numerics.rotations import '
            'from_rotation_vector, multiply, normalised\n'
        )
    )
    return f'{imports}\n\n@compiled\ndef step(p, y, c, k0, h):{lines}'
