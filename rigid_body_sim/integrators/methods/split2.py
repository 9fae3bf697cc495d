# SPDX-License-Identifier: Apache-2.0
"""split2: the Strang composition, order 2.

The only composition that runs scenes with drag or internal dissipation.

One step is kick and drift in turn by the fractions KICKS and DRIFTS of it; what these are says
composition.py. Fixed steps only: it needs `step`.
"""

from rigid_body_sim.integrators.families import composition as FAMILY  # noqa: F401, N812

NAME = 'split2'
ORDER = 2
PRESERVES = ('symplectic form', 'reversal of time')
NEEDS = 'acting'
HEAT = True
FIELD = False
STIFF = ()
TABLE = False
TAKES = ('step',)
SOURCE = 'G. Strang, SIAM J. Numer. Anal. 5 (1968) 506'

DRIFTS = (1.0,)
KICKS = (0.5, 0.5)
