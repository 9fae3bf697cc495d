# SPDX-License-Identifier: Apache-2.0
"""split4: Blanes and Moan's SRKN 6b, order 4, six drifts a step.

For kicks that depend on the attitude alone.

One step is kick and drift in turn by the fractions KICKS and DRIFTS of it, which composition.py
explains.
"""

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

NAME = 'split4'
ORDER = 4
SOURCE = 'S. Blanes, P. C. Moan, J. Comput. Appl. Math. 142 (2002) 313, table 3, S6 of order 4 (b)'

_A2, _A3 = 0.604872665711080, -0.350171622895351
_A1 = 0.5 - (_A2 + _A3)    # without rounding
_B1, _B2, _B3 = 0.0829844064174052, 0.396309801498368, -0.0390563049223486
_B4 = 1.0 - 2.0 * (_B1 + _B2 + _B3)
DRIFTS = (_A1, _A2, _A3, _A3, _A2, _A1)
KICKS = (_B1, _B2, _B3, _B4, _B3, _B2, _B1)
