# SPDX-License-Identifier: Apache-2.0
"""Wrench: a force at the centre of mass and a couple that a command holds.

It is not an effect of the scene, but methods see it as one.
"""

from dataclasses import dataclass
from typing import ClassVar

from rigid_body_sim.scene.effects.protocol import Acting
from rigid_body_sim.scene.frame import Frame

ELEMENTARY = 'rigid_body_sim.scene.effects.elementary'
ZERO = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Wrench:
    """A zero-order hold.

    Attributes
    ----------
    force, torque : tuple of 3 floats
        N and N m. The force acts at the centre of mass; at a pivot or hinge its torque r x F about
        the constraint counts.
    frame : {'world', 'body'}
        Axes of the components; body axes turn with the body while it is held.
    """

    force: tuple[float, ...] = ZERO
    torque: tuple[float, ...] = ZERO
    frame: str = 'world'
    breakpoints: ClassVar[tuple[float, ...]] = ()

    def __bool__(self) -> bool:
        return self.force != ZERO or self.torque != ZERO

    def acting(self, frame: Frame, time: float) -> tuple[Acting, ...]:
        """Return the force or its moment, and the couple.

        The kernels are the same whatever is held, so that no command waits for a compilation.
        """
        in_body = self.frame == 'body'
        given = tuple(map(float, self.force)), tuple(map(float, self.torque))
        world_force, world_torque = (ZERO, ZERO) if in_body else given
        force, torque = map(frame.from_body, given) if in_body else (ZERO, ZERO)
        if frame.moves:
            return (Acting(f'{ELEMENTARY}:held_force', (*world_force, *force), 'force', 'work',
                           polynomial=True),
                    Acting(f'{ELEMENTARY}:held_torque', (*world_torque, *torque), 'torque',
                           'work', polynomial=True))
        (rx, ry, rz), (fx, fy, fz), (tx, ty, tz) = frame.arm, force, torque
        about_point = ry * fz - rz * fy + tx, rz * fx - rx * fz + ty, rx * fy - ry * fx + tz
        values = *frame.arm, *world_force, *world_torque, *about_point
        return Acting(f'{ELEMENTARY}:held_about_point', values, 'torque', 'work', polynomial=True),
