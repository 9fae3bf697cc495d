# SPDX-License-Identifier: Apache-2.0
"""The equations of the Taylor series: one kind for all scenes, which differ in its numbers.

Torques constant in the body or in the world, the weight on an arm, and drag;
marching/taylor_series.py has the recurrences.
"""

import functools
from typing import NamedTuple

import numpy as np

from rigid_body_sim.compilation.layout import Matrix, Vector, layout
from rigid_body_sim.compilation.templates import specialise
from rigid_body_sim.errors import BadInput
from rigid_body_sim.integrators.equations import euler, falling, turning
from rigid_body_sim.integrators.equations.equations import Equations, refuse_no_moment
from rigid_body_sim.integrators.equations.falling import FallingParameters
from rigid_body_sim.mechanics.parameters import scene_parameters
from rigid_body_sim.mechanics.pulls import total_of
from rigid_body_sim.numerics.rotations import normalised
from rigid_body_sim.numerics.vectors import product, scaled
from rigid_body_sim.scene.frame import turned_back
from rigid_body_sim.scene.scene import kept


class SeriesParameters(NamedTuple):
    """The numbers of the recurrences, after those of a body that turns and falls.

    Attributes
    ----------
    falling : FallingParameters
    constant : Vector
        The constant part of omega', frame components.
    force : Vector
        World components, N.
    pull : tuple of 6 floats
        They make the force's part of omega' from its components in the frame.
    couple : Vector
        World components, N m.
    drag : Matrix
        It makes the drag's part of omega' from omega.
    """

    falling: FallingParameters
    constant: Vector
    force: Vector
    pull: tuple[float, float, float, float, float, float]
    couple: Vector
    drag: Matrix


SERIES = layout(SeriesParameters)
CONSTANT, FORCE, PULL, COUPLE, DRAG = (
    SERIES.part(name).first for name in SeriesParameters._fields[1:])
COUNT = SERIES.size


def refusal(scene):
    """Return the BadInput of a scene without power series."""
    return BadInput('integrator', f'taylor cannot run the scene {scene.name}',
                    'bodies under gravity, torques, drag and formulas without kinks only')


@kept
def has_phases(scene):
    """Return whether the phases of a body on a plane have series (contact_series.py).

    These are the ones that contact_lanes.py has, too.
    All that acts besides the contact is uniform fields, and the contact has neither dry rolling
    friction nor a patch.
    """
    laws = scene.contact
    return (all(effect.uniform_field is not None or effect.contact is not None
                for effect in scene.acting)
            and laws.rolling == laws.patch == 0.0)


@kept
def _pulls(scene):
    """Return the Pulls of the effects of a scene that have series.

    Which parts they have does not depend on the time; their numbers are those before any.
    """
    return [effect.series(scene.frame, -np.inf) for effect in scene.effects
            if effect.acting is not None and effect.series is not None]


def has_formulas(scene):
    """Return whether any effect has formulas in its view `series`."""
    return any(pull.formulas for pull in _pulls(scene))


@functools.cache
def _kernels():
    """Return turning.py without sums of what acts: nothing asks for rates."""
    return specialise(
        turning, **dict.fromkeys(('omega_rate', 'axes_rate'), '# not asked for\n'))


class Series(Equations):
    """The equations of turning as taylor_series.py has them.

    What acts is a constant torque, a force on an arm, a couple, drag.

    A free body's centre of mass falls in closed form (falling.py).
    """

    def __init__(self, scene):
        body = scene_parameters(scene)
        self.frame = _frame(scene, body)
        self._body = body._replace(frame_axes=self.frame.axes)
        self.hinged = scene.constraint.axis is not None
        self._actors = [effect for effect in scene.effects if effect.acting is not None]
        self.modes = []    # nothing with kinks has a series
        self.breakpoints = tuple(
            sorted({time for actor in self._actors for time in actor.breakpoints})
        )
        if not all(actor.series is not None for actor in self._actors):
            raise refusal(scene)
        pulls = _pulls(scene)
        # a body on a hinge turns about the third axis of its frame here, by the same equations
        self.kind, self.on_hinge = turning, False
        forced = any(pull.force is not None for pull in pulls)
        self.pushed = forced and not self.frame.moves
        self.falls = self.frame.moves and (forced or any(pull.slowing for pull in pulls))
        self.coupled = any(pull.couple is not None for pull in pulls)
        self.dragged = any(pull.drag is not None for pull in pulls)
        self.kernels = _kernels()
        self.write = f'{(falling if self.falls else self.kernels).__name__}:write'
        self._equation, self._held = self._equation_parameters(), {}
        self.parameter_count, self.fixed_count = COUNT, euler.FIXED

    def parameters(self, time):
        """Return the parameters that hold just after a time."""
        total = total_of(actor.series(self.frame, time) for actor in self._actors)
        fall, M = falling.NONE, self.frame.mass
        if self.falls:
            x, y, z = total.force
            fall = falling.Fall((x / M, y / M, z / M), total.slowing / M)
        inverse, (rx, ry, rz) = self._equation.inverse, self.frame.arm
        ix, iy, iz = inverse
        return SERIES.array(SeriesParameters(
            falling=FallingParameters(self._equation, fall),
            constant=product(inverse, total.torque), force=total.force,
            pull=(ix * -rz, ix * ry, iy * -rx, iy * rz, iz * -ry, iz * rx),
            couple=total.couple, drag=tuple(map(scaled, inverse, total.drag))))


def _frame(scene, body):
    """Return the frame of a scene's equations; `body` is its SceneParameters.

    That of a hinge has its third axis along it, and takes no torque about the others.
    """
    frame = scene.frame
    if scene.constraint.axis is None:
        return frame
    refuse_no_moment(scene, body)
    nx, ny, nz = scene.constraint.axis
    axes = normalised(-ny, nx, 0.0, 1.0 + nz) if nz >= 0.0 else normalised(ny, -nx, 0.0, 1.0 - nz)
    return frame._replace(
        moments=(0.0, 0.0, body.hinge_moment),
        axes=axes,
        arm=turned_back(axes, frame.arm),
    )
