# SPDX-License-Identifier: Apache-2.0
"""rk4: the classical Runge-Kutta method, the accurate one of general engines.

Here for comparison.

Four stages, order 4, fixed steps only: it has no error estimate, so it needs `step`.
"""

from rigid_body_sim.integrators.families import runge_kutta as FAMILY  # noqa: F401, N812

NAME = 'rk4'
ORDER = 4
PRESERVES = ()
NEEDS = 'acting'
HEAT = True
FIELD = True
STIFF = ()
TABLE = False
TAKES = ('step',)
SOURCE = 'W. Kutta, Z. Math. Phys. 46 (1901) 435'

A = ({}, {0: 0.5}, {1: 0.5}, {2: 1.0})
_SIXTH, _THIRD = 1.0 / 6.0, 1.0 / 3.0
# the second 1/3 is rounded up: the sum is 1
B = {0: _SIXTH, 1: _THIRD, 2: 1.0 - (_SIXTH + _THIRD + _SIXTH), 3: _SIXTH}
