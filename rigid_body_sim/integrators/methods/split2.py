# SPDX-License-Identifier: Apache-2.0
"""split2: the Strang composition, order 2.

The only composition that runs scenes with drag or internal dissipation.

One step is kick and drift in turn by the fractions KICKS and DRIFTS of it, which composition.py
explains.
"""

from rigid_body_sim.integrators.families import composition as FAMILY  # noqa: F401, N812
from rigid_body_sim.integrators.families.composition import (  # noqa: F401
    FIELD,
    NEEDS,
    PRESERVES,
    STIFF,
    TABLE,
    TAKES,
)

NAME = 'split2'
ORDER = 2
HEAT = True
SOURCE = 'G. Strang, SIAM J. Numer. Anal. 5 (1968) 506'

DRIFTS = (1.0,)
KICKS = (0.5, 0.5)
