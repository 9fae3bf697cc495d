# SPDX-License-Identifier: Apache-2.0
"""A convex body on a plane by Taylor series, phase by phase; contact.py has the events.

A slip that has just begun, whose direction is a finite difference, a ring that is almost flat, and
rest are those of dop8.
"""

from rigid_body_sim.compilation.templates import module_of, specialise
from rigid_body_sim.errors import BadInput
from rigid_body_sim.integrators.equations import contact_series
from rigid_body_sim.integrators.equations.contact_views import FLIGHT, GLIDING, ROLLING, SLIDING
from rigid_body_sim.integrators.marching import contact_series_step
from rigid_body_sim.integrators.marching.contact import UnderWeight, march_of
from rigid_body_sim.mechanics.contact.parameters import FILMY, FLAT, FLATTER
from rigid_body_sim.scene.painleve import may_meet_paradox, painleve_bound
from rigid_body_sim.scene.surfaces import KINDS

SERIES_OF = {FLIGHT: FLIGHT, ROLLING: ROLLING, SLIDING: SLIDING, GLIDING: SLIDING}
"""Phases that have series: those of which phase."""


class OnPlaneBySeries(UnderWeight):
    """The kernels and the numbers of one scene.

    Raises
    ------
    BadInput
        Where Painleve's paradox may be met: the force of a slip has a pole there, at which no
        series arrives.
    """

    def __init__(self, scene, method, step):
        super().__init__(scene, method, step)
        mu = scene.contact.mu
        if may_meet_paradox(scene.body, mu):
            raise BadInput('integrator', f'taylor cannot run the scene {scene.name}: with '
                           f"mu = {mu!r} it may meet Painleve's paradox",
                           f'mu below {painleve_bound(scene.body):.4g}, or dop8')
        laws, surface = scene.contact, scene.body.surface
        self._kind, self._marches = KINDS[surface.kind], {}
        self._friction = contact_series.Friction(
            laws.rolling_viscous > 0.0, laws.film > 0.0, surface.kind == 'disk')
        rubs = self._friction.viscous or self._friction.film
        self._flat = FILMY if self._friction.film else FLAT if rubs else FLATTER
        self.work_shape = (contact_series_step.WORK_ROWS,
                           contact_series.MORE if rubs else contact_series.MOST)

    def kernels_of(self, mode, low=False):
        """Return the module that marches through a phase (contact_march.py).

        `low` says that the body is a ring that is almost flat.
        """
        if mode not in SERIES_OF or low:
            return self.kernels
        phase = SERIES_OF[mode]
        if phase not in self._marches:
            source = contact_series.SOURCES[phase](self._kind, self._friction)
            expand = module_of(source, 'contact_expansion').__name__
            step = specialise(contact_series_step, expand=f'{expand}:expand',
                              FLAT=f'FLAT = {self._flat!r}\n').__name__
            self._marches[phase] = march_of(f'{self.rates.__name__}:rate', step)
        return self._marches[phase]
