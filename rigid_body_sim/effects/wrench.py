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
        """View `rate`: the force or its moment, and the couple.

        Whatever is held, it is one kind for a scene, so that no command meets kernels that are not compiled yet.
        """
        held = (*map(float, (*self.force, *self.torque)), *ZERO, *ZERO)
        if self.frame == 'body':
            held = (*ZERO, *ZERO, *frame.from_body(self.force), *frame.from_body(self.torque))
        if frame.kind in ('free', 'table'):
            return (Acting(f'{ELEMENTARY}:held_force', (*held[0:3], *held[6:9]), 'force', 'work'),
                    Acting(f'{ELEMENTARY}:held_torque', (*held[3:6], *held[9:12]), 'torque', 'work'))
        return Acting(f'{ELEMENTARY}:held_about_point', (*frame.arm, *held), 'torque', 'work'),
