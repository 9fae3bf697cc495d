# SPDX-License-Identifier: Apache-2.0
"""A convex body on a plane: the kernels that march through its phases, and its numbers.

The phases are in equations/contact_rates.py, what follows an event in contact_succession.py.
"""

import bisect
import math

import numpy as np

from rigid_body_sim.compilation.templates import specialise
from rigid_body_sim.errors import BadInput
from rigid_body_sim.integrators.equations import (
    contact_acting,
    contact_pivoting,
    contact_rates,
    equations,
)
from rigid_body_sim.integrators.equations.contact_views import ROW
from rigid_body_sim.integrators.marching import contact_march, contact_step, contact_zero
from rigid_body_sim.integrators.marching.contact_course import PlaneCourse
from rigid_body_sim.mechanics.contact.numbers import contact_parameters, weight
from rigid_body_sim.mechanics.contact.parameters import CONTACT
from rigid_body_sim.numerics.rotations import rotate_back
from rigid_body_sim.numerics.vectors import scaled
from rigid_body_sim.scene.effects.wrench import Wrench


def rates_of(applied, holds, patched):
    """Return contact_rates.py bound to what acts: source lines `applied`, `HOLDS`, `PATCHED`."""
    acting = specialise(contact_acting, applied=applied, HOLDS=holds).__name__
    moved = {name: f'{acting}:{name}' for name in ('posture_after', 'push_on')}
    pivoting = specialise(contact_pivoting, **moved).__name__
    now = {name: f'{acting}:{name}' for name in (
        'applied_at', 'posture_at', 'couples_at', 'hastened')}
    return specialise(contact_rates, pivot=f'{pivoting}:pivot', HOLDS=holds, PATCHED=patched,
                      **moved, **now)


def march_of(rate, step):
    """Return contact_march.py bound to rates, 'module:rate', and to a module of steps."""
    zero = specialise(contact_zero, rate=rate, step_from=f'{step}:step_from').__name__
    return specialise(contact_march, rate=rate, step_from=f'{step}:step_from',
                      error_of=f'{step}:error_of', longest=f'{step}:longest',
                      ORDER=f'from {step} import ORDER\n', first_zero=f'{zero}:first_zero')


class OnPlane:
    """The kernels and the numbers of one scene and wrench.

    The wrench is always in the code, so that no command waits for a compilation.

    Attributes
    ----------
    is_timed : bool
        Whether what acts depends on time other than in pieces.
    """

    KEEPS_ENTRIES = True

    def __init__(self, scene, method, wrench, step):
        if step is not None:
            raise BadInput('step', f'got {step!r} for a body on a plane',
                           'steps end where phases do: give an accuracy')
        self.scene = scene
        self._wrench = wrench or Wrench()
        self._actors = [effect for effect in scene.effects if effect.acting is not None]
        self._frame = scene.frame
        self.breakpoints = sorted({time for one in self._actors for time in one.breakpoints})
        acting = self._acting(-math.inf)
        if any(one.modes or one.gives == 'turning' for one in acting):
            raise BadInput(f'{scene.name}: effects', 'an expression with a kink, or an effect '
                           'that turns the axes, for a body on a plane',
                           'a smooth expression, numbers that hold, or pieces in time')
        self.is_timed = any(one.timed for one in acting)
        if scene.contact.rolling > 0.0 and self.is_timed:
            raise BadInput(f'{scene.name}: effects', 'an expression of time for a body on a plane '
                           'that dry rolling friction may bring to rest',
                           'pieces in time, or viscous rolling friction')
        source = equations.applied_source(acting, CONTACT.size)
        holds = f'HOLDS = {scene.contact.rolling > 0.0}\n'
        patched = f'PATCHED = {scene.contact.patch > 0.0}\n'
        self.rates = rates_of(source, holds, patched)
        rate = f'{self.rates.__name__}:rate'
        self.kernels = march_of(rate, specialise(contact_step, rate=rate).__name__)
        self.work_shape = contact_step.WORK_ROWS, ROW.size
        self._fixed, self._held = contact_parameters(scene), {}
        self.is_disk = scene.body.surface.kind == 'disk'
        self.is_torus = scene.body.surface.kind == 'torus'
        self.heaviness = max(weight(scene), 1e-3)

    def _acting(self, time):
        return [one for actor in [*self._actors, self._wrench]
                for one in actor.acting(self._frame, time)]

    def parameters(self, time):
        """Return the parameters that hold just after a time (s), an array of the caller's own."""
        k = bisect.bisect_right(self.breakpoints, time)
        if k not in self._held:
            values = [value for one in self._acting(time) for value in one.values]
            self._held[k] = np.concatenate((self._fixed, values))
        return self._held[k].copy()

    def kernels_of(self, mode, low=False):
        """Return the module that marches through a phase (contact_march.py).

        `low` says that the body is a ring that is almost flat.
        """
        return self.kernels

    def at(self, stepped):
        """Return the Bound of a solver that differs in its accuracy: this one."""
        return self

    def runner(self, stepped, slow):
        """Return None: runs are those of a course."""

    def course(self, stepped):
        """Return the course of a started solver."""
        return PlaneCourse(stepped, self)


class UnderWeight(OnPlane):
    """The same where nothing but uniform fields acts besides the contact, and no wrench."""

    def __init__(self, scene, method, step):
        super().__init__(scene, method, None, step)
        x, y, z = rotate_back(*scene.constraint.axes, *scene.field)
        self._weight = np.array(scaled(scene.body.mass, (x, y, z)))

    def parameters(self, time):
        """Return the parameters that hold just after a time (s); the last three are the weight."""
        return np.concatenate((super().parameters(time), self._weight))
