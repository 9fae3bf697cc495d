# SPDX-License-Identifier: Apache-2.0
"""lsoda: SciPy's LSODA, for scenes that may become stiff; scipy_methods.py.

Adams methods of variable order up to 12 give way to BDF up to order 5 where a scene is stiff.
"""

from rigid_body_sim.integrators.families import scipy_methods as FAMILY  # noqa: F401, N812

NAME = 'lsoda'
ORDER = 12
PRESERVES = ()
NEEDS = 'acting'
HEAT = True
FIELD = True
STIFF = ('dissipation', 'drag')
TABLE = False
TAKES = ('accuracy',)
SOLVER = 'LSODA'
SOURCE = 'L. Petzold, SIAM J. Sci. Stat. Comput. 4 (1983) 136; ODEPACK, by SciPy'
