# SPDX-License-Identifier: Apache-2.0
"""taylor: the Taylor series of order 16 of a body turned by constant torques, its weight and drag.

A torque is constant in the body or in the world. The centre of mass of a free body moves in closed
form (falling.py), drag or not; a body on a hinge is one that takes no torque across it
(power_series.py). Where an effect gives formulas, the series is that of the scene's own equations
(equations/trees.py, plan.py, marching/recurrences.py).

Coefficients follow one from the other by Cauchy's products, eight orders at once in the vector
unit (taylor_series.py); a step, as long as the last two coefficients allow, is three to five times
cheaper than one of dop8 and twice to thrice as long. The series of a step are also its dense
output.

A body on a plane has a series for each phase (equations/contact_series.py) under uniform fields,
sliding friction, viscous rolling friction and a film of air; what is watched there is looked at
along the sum of the series.

Ensembles have a mode of their own: eight bodies at once (batch.py).

Caveat: no internal dissipation, nothing with kinks. Energy and momentum are kept to the
accuracy of the method; the norm of the quaternion is restored after each step. Spans under a held
wrench are made by dop8, and the ledger's sums, but for those on a plane.
"""

from rigid_body_sim.integrators.families import power_series as FAMILY  # noqa: F401, N812
from rigid_body_sim.integrators.marching.taylor_series import ORDER  # noqa: F401

NAME = 'taylor'
PRESERVES = ()
NEEDS = 'series'
HEAT = True
FIELD = True
STIFF = ()
TABLE = False
TAKES = ('accuracy', 'step')
SOURCE = ('Jorba, Zou, Experimental Mathematics 14 (2005) 99; Cauchy products in blocks: '
          'van der Hoeven, J. Symbolic Computation 34 (2002) 479')
