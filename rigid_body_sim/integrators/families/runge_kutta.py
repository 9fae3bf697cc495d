# SPDX-License-Identifier: Apache-2.0
"""Family of the Runge-Kutta methods.

A method is a module with a table of coefficients A, B, and E3, E5 if it estimates its error
(dop8.py).
"""

from rigid_body_sim.integrators.families import one_step
from rigid_body_sim.integrators.families.one_step import begin, equations_of, march  # noqa: F401
from rigid_body_sim.integrators.marching import table, unroll
from rigid_body_sim.integrators.protocols import FINEST  # noqa: F401
from rigid_body_sim.scene.constraints.protocol import Mechanism

ASKS = {'accuracy': ('A', 'B', 'E5', 'E3'), 'step': ('A', 'B')}
TABLE = True
TAKES_WRENCH = True
LANES = False
KINKS = True
ROOTS = True


def bind(method, stepped):
    """Return the method's kernels on the equations of a scene."""
    if stepped.scene.constraint.mechanism is Mechanism.TABLE:
        return table.OnTable(stepped.scene, method, stepped.wrench, stepped.step)
    if stepped.scene.constraint.mechanism is Mechanism.PLANE:
        # only now: a dozen modules of contact, which no other scene needs
        from rigid_body_sim.integrators.marching import contact
        return contact.OnPlane(stepped.scene, method, stepped.wrench, stepped.step)
    return one_step.bind(method, stepped)


def step_source(method, equations):
    """Return the source of ``step(p, y, c, k0, h) -> (y, c)``: marching/unroll.py."""
    return unroll.step_source(method, equations.kind.UNKNOWNS, 0)
