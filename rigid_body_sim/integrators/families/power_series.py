"""Family of the methods by power series: taylor. Its equations are not those of a scene but of a few kinds: what acts is in their numbers."""

import dataclasses

import numpy as np

from rigid_body_sim.compilation.templates import specialise
from rigid_body_sim.errors import BadInput
from rigid_body_sim.integrators.equations import euler, falling, turning
from rigid_body_sim.integrators.equations.equations import Equations, moment_on_hinge
from rigid_body_sim.integrators.marching import taylor_march, taylor_series
from rigid_body_sim.numerics.rotations import normalised
from rigid_body_sim.scene.effects.views import Frame, turned_back

CONSTANT, FORCE, PULL, COUPLE, DRAG = (falling.END + k for k in (0, 3, 6, 12, 15))
COUNT = DRAG + 9
SAFETY = 0.25    # steps planned from the node before err by up to four times what is allowed (taylor_march.py)


def equations(scene, wrench, books):
    """Return the equations of a scene that `march` is for; they keep no books and know no wrench (Stepped has dop8 for these).

    Raises
    ------
    BadInput
        An effect or a constraint that they cannot have.
    """
    return Series(scene)


class Series(Equations):
    """The equations of turning as taylor_series.py has them: a constant torque, a force on an arm, a couple, drag.

    A free body's centre of mass falls in closed form (falling.py).

    Behind the parameters of every kind (euler.py) stand those of the fall, the constant part of omega', the force in world components, six
    numbers that make its part of omega' from its components in the frame, the couple in world components, and the matrix that makes the
    part of drag of omega, row by row.
    """

    def __init__(self, scene):
        self.frame = _frame(scene)
        self._actors = [effect for effect in scene.effects if hasattr(effect, 'acting')]
        self.breakpoints = tuple(sorted({time for actor in self._actors for time in actor.breakpoints}))
        if not all(hasattr(actor, 'series') for actor in self._actors):
            raise BadInput('integrator', f'taylor cannot run the scene {scene.name}', 'bodies under gravity, torques and drag only')
        pulls = [actor.series(self.frame, -np.inf) for actor in self._actors]
        self.acts, self.extra, self.kind = bool(pulls), 0, turning
        forced = any(pull.force is not None for pull in pulls)
        self.pushed = forced and self.frame.kind != 'free'
        self.falls = self.frame.kind == 'free' and (forced or any(pull.slowing for pull in pulls))
        self.coupled = any(pull.couple is not None for pull in pulls)
        self.dragged = any(pull.drag is not None for pull in pulls)
        # the sums of what acts stay unbound: nothing asks for rates
        self.kernels = specialise(turning, **dict.fromkeys(('omega_rate', 'axes_rate', 'booked'), '# not asked for\n'))
        self.write = f'{(falling if self.falls else self.kernels).__name__}:write'
        self._fixed, self._held = self._constants(), {}
        self.parameter_count, self.fixed_count = COUNT, len(self._fixed)

    def parameters(self, fixed, time):
        """Return the parameters that hold just after a time."""
        p = np.zeros(COUNT)
        p[:len(fixed)] = fixed
        inverse, (rx, ry, rz) = p[euler.INVERSE:euler.INVERSE + 3], self.frame.arm
        (constant, force, couple), drag, slowing = np.zeros((3, 3)), np.zeros((3, 3)), 0.0
        for pull in (actor.series(self.frame, time) for actor in self._actors):
            constant += pull.constant
            force += pull.force or 0.0
            couple += pull.couple or 0.0
            drag += pull.drag or 0.0
            slowing += pull.slowing
        if self.falls:
            p[falling.FALL:falling.FALL + 3], p[falling.SLOWING] = force / self.frame.mass, slowing / self.frame.mass
        p[CONSTANT:CONSTANT + 3], p[FORCE:FORCE + 3], p[COUPLE:COUPLE + 3] = inverse * constant, force, couple
        p[PULL:PULL + 6] = np.repeat(inverse, 2) * (-rz, ry, -rx, rz, -ry, rx)
        p[DRAG:] = (inverse[:, np.newaxis] * drag).ravel()
        return p


def _frame(scene):
    """Return the frame of a scene's equations; that of a hinge has its third axis along it, and takes no torque about the others."""
    frame = Frame.of(scene.body, scene.constraint)
    if frame.kind != 'hinge':
        return frame
    nx, ny, nz = scene.constraint.axis
    axes = normalised(-ny, nx, 0.0, 1.0 + nz) if nz >= 0.0 else normalised(ny, -nx, 0.0, 1.0 - nz)
    return dataclasses.replace(frame, moments=(0.0, 0.0, moment_on_hinge(scene)), axes=axes, arm=turned_back(axes, frame.arm))


def march(method, bound, adapts):
    """Return the module that marches: taylor_march.py bound to what acts."""
    return specialise(taylor_march, expand=_expand(bound.pushed, bound.coupled, bound.dragged, bound.frame.kind == 'hinge'))


def begin(stepped, kernels):
    """Return (control, node) of a march, to be copied for each start."""
    control = np.zeros(kernels.WORK + kernels.PLACES * (taylor_series.ORDER + 1))
    control[kernels.TOLERANCE] = SAFETY * stepped.accuracy / stepped.horizon if stepped.accuracy is not None else 0.0
    control[kernels.FIXED] = stepped.step or 0.0
    return control, np.zeros(kernels.VALUES + 2 * kernels.SIZE)


def _expand(pushed, coupled, dragged, hinged):
    """Return the source of ``expand(p, S, y)``: the series of y."""
    def numbers(first, count):
        return f'({"".join(f"p[{first + k}], " for k in range(count))})'

    def along_frame(first):
        return f'*rotate_back(y[0], y[1], y[2], y[3], p[{first}], p[{first + 1}], p[{first + 2}])'
    push = f'({along_frame(FORCE)}, *{numbers(PULL, 6)})' if pushed else '()'
    couple = f'({along_frame(COUPLE)}, *{numbers(euler.INVERSE, 3)})' if coupled else '()'
    drag = numbers(DRAG, 9) if dragged else '()'
    return '\n'.join([f'from {taylor_series.__name__} import expansion as kernel_for', '',
                      f'expansion = kernel_for({pushed}, {coupled}, {dragged}, {hinged})', '', '', '@compiled', 'def expand(p, S, y):',
                      f'    expansion(S, (y, {numbers(euler.EULER, 3)}, {numbers(CONSTANT, 3)}, {push}, {couple}, {drag}))', ''])
