# SPDX-License-Identifier: Apache-2.0
"""radau: SciPy's Radau IIA of order 5, implicit, for stiff scenes; scipy_methods.py."""

from rigid_body_sim.integrators.families import scipy_methods as FAMILY  # noqa: F401, N812

NAME = 'radau'
ORDER = 5
PRESERVES = ()
NEEDS = 'acting'
HEAT = True
FIELD = True
STIFF = ('dissipation', 'drag')
TABLE = False
TAKES = ('accuracy',)
SOLVER = 'Radau'
SOURCE = 'Hairer, Wanner, Solving ODEs II (1996), IV.8, by SciPy'
