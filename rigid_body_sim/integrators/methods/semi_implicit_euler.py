# SPDX-License-Identifier: Apache-2.0
"""semi_implicit_euler: the step of general engines, for comparison.

engine_step.py defines the step.

Order 1, fixed steps only: it needs `step`. The name says that the new velocity moves the position;
the gyroscopic term is explicit, so the method is not symplectic for a body that turns, and its
energy grows.
"""

from rigid_body_sim.integrators.families import engine_step as FAMILY  # noqa: F401, N812

NAME = 'semi_implicit_euler'
ORDER = 1
PRESERVES = ()
NEEDS = 'acting'
HEAT = True
FIELD = False
STIFF = ()
TABLE = False
TAKES = ('step',)
SOURCE = ('Hairer, Lubich, Wanner, Geometric Numerical Integration (2006), I.1.2 (symplectic '
          'Euler); the gyroscopic term as engines take it')
