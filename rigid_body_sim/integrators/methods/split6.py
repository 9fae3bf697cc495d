# SPDX-License-Identifier: Apache-2.0
"""split6: Blanes and Moan's SRKN 14a, order 6, fifteen drifts a step.

For kicks that depend on the attitude alone.

One step is kick and drift in turn by the fractions KICKS and DRIFTS of it, which composition.py
explains.
"""

import math

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

NAME = 'split6'
ORDER = 6
SOURCE = (
    'S. Blanes, P. C. Moan, J. Comput. Appl. Math. 142 (2002) 313, table 3, S14 of order 6 (a)'
)

_A = (
    0.0378593198406116,
    0.102635633102435,
    -0.0258678882665587,
    0.314241403071447,
    -0.130144459517415,
    0.106417700369543,
    -0.00879424312851058,
)
_B = (
    0.09171915262446165,
    0.183983170005006,
    -0.05653436583288827,
    0.004914688774712854,
    0.143761127168358,
    0.328567693746804,
)
_B7 = 0.5 - math.fsum(_B)
DRIFTS = (*_A, 1.0 - 2.0 * math.fsum(_A), *_A[::-1])
KICKS = (0.0, *_B, _B7, _B7, *_B[::-1], 0.0)
