# SPDX-License-Identifier: Apache-2.0
"""A convex body on a plane by Gauss collocation, phase by phase; contact.py has the events.

It takes the phases in which the body rolls or slides, the long ones. Flight, a slip that has just
begun, a ring that is almost flat, and rest are those of dop8.
"""

from rigid_body_sim.compilation.templates import specialise
from rigid_body_sim.integrators.equations import contact_lanes
from rigid_body_sim.integrators.equations.contact_views import GLIDING, ROLLING, SLIDING
from rigid_body_sim.integrators.marching import contact_gauss_step
from rigid_body_sim.integrators.marching.contact import UnderWeight, march_of
from rigid_body_sim.mechanics.contact.parameters import CONTACT
from rigid_body_sim.scene.painleve import may_meet_paradox
from rigid_body_sim.scene.surfaces import KINDS


class OnPlaneByGauss(UnderWeight):
    """The kernels and the numbers of one scene."""

    def __init__(self, scene, method, step):
        super().__init__(scene, method, step)
        laws = scene.contact
        self._literals = {'kind': KINDS[scene.body.surface.kind], 'rolling': 0.0}
        self._literals |= {name: 0.0 for name in ('rolling_viscous', 'film')
                           if not getattr(laws, name) > 0.0}
        # at the paradox the force of a slip has a pole
        self._phases = (ROLLING,) if may_meet_paradox(scene.body, laws.mu) else (
            ROLLING, SLIDING, GLIDING)
        self._marches = {}
        self.work_shape = contact_gauss_step.WORK_ROWS, contact_gauss_step.WIDTH

    def kernels_of(self, mode, low=False):
        """Return the module that marches through a phase (contact_march.py).

        `low` says that the body is a ring that is almost flat.
        """
        if mode not in self._phases or low:
            return self.kernels
        if mode not in self._marches:
            lanes = specialise(contact_lanes, known=_known(self._literals | {'mode': float(mode)}))
            step = specialise(contact_gauss_step, **{
                name: f'{lanes.__name__}:{name}' for name in ('parameters', 'turned', 'stage')})
            self._marches[mode] = march_of(f'{self.rates.__name__}:rate', step.__name__)
        return self._marches[mode]


def _known(literals):
    """Return the source of ``known(p)``: the parameters as a tuple, some of them literals."""
    given = {CONTACT.part(name).first: repr(value) for name, value in literals.items()}
    numbers = ', '.join(given.get(k, f'p[{k}]') for k in range(CONTACT.size))
    return f'@compiled_inline\ndef known(p):\n    return ({numbers})\n'
