"""Template: single steps of a Runge-Kutta method, for what is marched from Python."""

import math  # noqa: F401 (for the bound steps)

from rigid_body_sim.compiled import compiled  # noqa: F401
from rigid_body_sim.specialise import UNBOUND

rate = UNBOUND
step = UNBOUND
trial = UNBOUND
