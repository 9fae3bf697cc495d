"""Wrench: a force at the centre of mass and a couple, held (a command, not an effect of the scene; seen by methods like one)."""

from dataclasses import dataclass

from rigid_body_sim.scene.effects.views import Acting

ELEMENTARY = 'rigid_body_sim.scene.effects.elementary'
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
        return self.force != ZERO or self.torque != ZERO

    def acting(self, frame, time):
        """View `rate`: the force or its moment, and the couple.

        Whatever is held, it is one kind for a scene, so that no command meets kernels that are not compiled yet.
        """
        in_body = self.frame == 'body'
        given = (*map(float, self.force), *map(float, self.torque))
        world_force, world_torque = (ZERO, ZERO) if in_body else (given[:3], given[3:])
        force, torque = (frame.from_body(given[:3]), frame.from_body(given[3:])) if in_body else (ZERO, ZERO)
        if frame.kind in ('free', 'table'):
            return (Acting(f'{ELEMENTARY}:held_force', (*world_force, *force), 'force', 'work'),
                    Acting(f'{ELEMENTARY}:held_torque', (*world_torque, *torque), 'torque', 'work'))
        (rx, ry, rz), (fx, fy, fz), (tx, ty, tz) = frame.arm, force, torque
        about_point = ry * fz - rz * fy + tx, rz * fx - rx * fz + ty, rx * fy - ry * fx + tz
        return Acting(f'{ELEMENTARY}:held_about_point', (*frame.arm, *world_force, *world_torque, *about_point), 'torque', 'work'),
