# SPDX-License-Identifier: Apache-2.0
"""split8: McLachlan's symmetric composition of seventeen Strang steps, order 8.

For kicks that depend on the attitude alone.

One step is kick and drift in turn by the fractions KICKS and DRIFTS of it, which composition.py
explains.
"""

import math
from itertools import pairwise

from rigid_body_sim.integrators.families import composition as FAMILY  # noqa: F401, N812
from rigid_body_sim.integrators.families.composition import (  # noqa: F401
    FIELD,
    HEAT,
    NEEDS,
    PRESERVES,
    STIFF,
    TABLE,
    TAKES,
)

NAME = 'split8'
ORDER = 8
SOURCE = 'R. I. McLachlan, SIAM J. Sci. Comput. 16 (1995) 151, table 2, SS 17 stages of order 8'

_W = (
    0.12886597938144329897,
    0.5815140871052509624,
    -0.41017537146985013753,
    0.1851469357165877327,
    -0.40955234342085141934,
    0.14440594108001204106,
    0.27833550039367965131,
    0.31495668391629485789,
)
DRIFTS = (*_W, 1.0 - 2.0 * math.fsum(_W), *_W[::-1])
_K = (0.5 * _W[0], *(0.5 * (first + second) for first, second in pairwise(_W)))
_K9 = math.fsum((0.5, *(-kick for kick in _K)))    # all are 1 together, without rounding
KICKS = (*_K, _K9, _K9, *_K[::-1])
