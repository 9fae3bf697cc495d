"""Family of the Runge-Kutta methods: modules with a table of coefficients A, B, and E3, E5 if they estimate their error (dop8.py)."""

from rigid_body_sim.integrators.equations.equations import Equations
from rigid_body_sim.integrators.families.one_step import begin, march  # noqa: F401
from rigid_body_sim.integrators.marching import unroll


def equations(scene, wrench, books):
    """Return the equations of a scene that `step_source` is for."""
    return Equations(scene, wrench, books)


def step_source(method, bound):
    """Return the source of ``step(p, y, c, k0, h) -> (y, c)`` for equations: rigid_body_sim/integrators/marching/unroll.py."""
    return unroll.step_source(method, bound.kind.UNKNOWNS, bound.extra)
