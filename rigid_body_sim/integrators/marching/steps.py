# SPDX-License-Identifier: Apache-2.0
"""Template: single steps of a Runge-Kutta method, for what is marched from Python."""

import math  # noqa: F401 (for the bound steps)

from rigid_body_sim.compilation.jit import compiled  # noqa: F401
from rigid_body_sim.compilation.templates import UNBOUND

rate = UNBOUND
step = UNBOUND
trial = UNBOUND
