# SPDX-License-Identifier: Apache-2.0
"""Dormand-Prince 8(5,3): the work-horse for every smooth scene.

Twelve stages, order 8, error estimates of orders 5 and 3 (Hairer, Norsett and Wanner, Solving
Ordinary Differential Equations I, 2nd edition, section II.5, and their program DOP853): the
coefficients are in marching/dormand_prince.py.

Caveat: energy and momentum are kept to the accuracy of the method only; the norm of the quaternion
is restored after each step.
"""

from rigid_body_sim.integrators.families import runge_kutta as FAMILY  # noqa: F401, N812
from rigid_body_sim.integrators.marching.dormand_prince import (  # noqa: F401
    E3,
    E5,
    ORDER,
    A,
    B,
)

NAME = 'dop8'
PRESERVES = ()
NEEDS = 'acting'
HEAT = True
FIELD = True
STIFF = ('dissipation',)
TABLE = True
TAKES = ('accuracy', 'step')
SOURCE = 'Hairer, Norsett, Wanner, Solving ODEs I (1993), II.5, DOP853'
