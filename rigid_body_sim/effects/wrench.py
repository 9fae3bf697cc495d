"""Wrench: a force at the centre of mass and a couple, held (a command, not an effect of the scene; seen by methods like one)."""

from dataclasses import dataclass
from typing import ClassVar

from rigid_body_sim.effects.views import Acting

ZERO = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Wrench:
    """A zero-order hold.

    Attributes
    ----------
    force, torque : tuple of 3 floats
        N and N m. The force acts at the centre of mass; at a pivot or hinge its torque r x F about the constraint counts.
    force_frame, torque_frame : {'world', 'body'}
        Axes of the components; body axes turn with the body while it is held.
    """

    force: tuple = ZERO
    torque: tuple = ZERO
    force_frame: str = 'world'
    torque_frame: str = 'world'
    breakpoints: ClassVar = ()

    def acting(self, frame, time):
        """View `rate`: the force or its moment, and the couple; what is zero does not act."""
        module = 'rigid_body_sim.effects.elementary'
        force, torque = tuple(map(float, self.force)), tuple(map(float, self.torque))
        acting = []
        if any(force):
            components = frame.from_body(force) if self.force_frame == 'body' else force
            if frame.kind in ('free', 'table'):
                acting.append(Acting(f'{module}:{"to_world" if self.force_frame == "body" else "constant"}', components, 'force', 'work'))
            elif self.force_frame == 'world':
                acting.append(Acting(f'{module}:moment', (*frame.arm, *components), 'torque', 'work'))
            else:
                (rx, ry, rz), (fx, fy, fz) = frame.arm, components
                acting.append(Acting(f'{module}:constant', (ry * fz - rz * fy, rz * fx - rx * fz, rx * fy - ry * fx), 'torque', 'work'))
        if any(torque):
            components = frame.from_body(torque) if self.torque_frame == 'body' else torque
            acting.append(Acting(f'{module}:{"to_frame" if self.torque_frame == "world" else "constant"}', components, 'torque', 'work'))
        return tuple(acting)
