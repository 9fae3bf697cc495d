"""Wrench: a force at the centre of mass and a couple, held (a command, not an effect of the scene; seen by methods like one)."""

from dataclasses import dataclass

from rigid_body_sim.effects.views import Acting

ELEMENTARY = 'rigid_body_sim.effects.elementary'
ZERO = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Wrench:
    """A zero-order hold.

    Attributes
    ----------
    force, torque : tuple of 3 floats
        N and N m. The force acts at the centre of mass; at a pivot or hinge its torque r x F about the constraint counts.
    frame : {'world', 'body'}
        Axes of the components; body axes turn with the body while it is held.
    """

    force: tuple = ZERO
    torque: tuple = ZERO
    frame: str = 'world'

    def __bool__(self):
        return any(self.force) or any(self.torque)

    def acting(self, frame, time):
        """View `rate`: the force or its moment, and the couple; what is zero does not act."""
        in_body = self.frame == 'body'
        force, torque = (frame.from_body(vector) if in_body else tuple(map(float, vector)) for vector in (self.force, self.torque))
        acting = []
        if any(force) and frame.kind in ('free', 'table'):
            acting.append(Acting(f'{ELEMENTARY}:{"to_world" if in_body else "constant"}', force, 'force', 'work'))
        elif any(force) and in_body:
            (rx, ry, rz), (fx, fy, fz) = frame.arm, force
            acting.append(Acting(f'{ELEMENTARY}:constant', (ry * fz - rz * fy, rz * fx - rx * fz, rx * fy - ry * fx), 'torque', 'work'))
        elif any(force):
            acting.append(Acting(f'{ELEMENTARY}:moment', (*frame.arm, *force), 'torque', 'work'))
        if any(torque):
            acting.append(Acting(f'{ELEMENTARY}:{"constant" if in_body else "to_frame"}', torque, 'torque', 'work'))
        return tuple(acting)
