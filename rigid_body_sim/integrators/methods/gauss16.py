# SPDX-License-Identifier: Apache-2.0
"""gauss16: Gauss collocation of order 16, all eight stages advanced together.

The fastest method for smooth scenes.

In a step of size h the unknowns follow the polynomials that meet the equations at the eight Gauss
nodes c_i. The equations of the stages, Y_i = y + h sum_j a_ij f(Y_j), are solved by substitution
(Picard) from the continued polynomial of the step before. One sweep is eight evaluations of f and
one product with the matrix a, both in the vector unit of the processor; it costs about a fifth of
a step of dop8, and a step of two radians takes about a dozen of them.

A body on a plane goes by it where it rolls or slides under uniform fields, sliding friction,
viscous rolling friction and a film of air (marching/contact_gauss.py); flights, and spans under a
held wrench, are those of dop8.

Symmetric; a converged step is symplectic and keeps quadratic invariants, so errors of conservative
scenes grow in proportion to the time. Caveat: substitution converges for steps of a few radians at
most, whatever the accuracy: the method is not for stiff scenes, except those in which only the
linear drag is stiff, whose part of the stage equations is solved (marching/relaxing.py).
"""

from rigid_body_sim.integrators.families import collocation as FAMILY  # noqa: F401, N812

NAME = 'gauss16'
ORDER = 16
PRESERVES = ('symplectic form', 'reversal of time', 'quadratic invariants')
NEEDS = 'acting'
HEAT = True
FIELD = True
STIFF = ('drag',)
TABLE = False
TAKES = ('accuracy', 'step')
SOURCE = (
    'Hairer, Lubich, Wanner, Geometric Numerical Integration (2006), II.1.3, VIII.6; '
    'stages in the vector unit: '
    'Antonana, Makazaga, Murua, arXiv:2511.03655'
)
