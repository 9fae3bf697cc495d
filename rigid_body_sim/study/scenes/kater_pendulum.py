# SPDX-License-Identifier: Apache-2.0
"""Check of the reversible pendulum (notes, "Reversible (Kater's) Pendulum").

It measures the periods about both edges, at the amplitude of the scene and in the limit.
"""

import numpy as np

from rigid_body_sim.errors import BadInput
from rigid_body_sim.numerics.rotations import from_rotation_vector, multiply
from rigid_body_sim.study.scenes import instruments
from rigid_body_sim.study.scenes.limits import limit
from rigid_body_sim.study.scenes.quantity import Quantity
from rigid_body_sim.theory import kater_pendulum as theory

AMPLITUDES = (0.2, 0.1, 0.05)       # rad
PERIODS = 3


class Pendulum:
    """The symbols of the notes, read from a scene: hinge, arm and lengths.

    The arm goes from the hinge to the centre of mass, in body axes.
    """

    def __init__(self, scene):
        self.axis = np.array(scene.constraint.axis)
        arm = np.subtract(scene.body.center_of_mass, scene.constraint.through)
        self.arm = arm - self.axis * (self.axis @ arm)
        self.length, self.g, self.mass = (
            float(np.linalg.norm(self.arm)),
            scene.effect('gravity').g,
            scene.body.mass,
        )
        if not self.length * self.g > 0.0:
            raise BadInput(
                scene.name,
                f'the suspension distance l is {self.length!r} m, g is {self.g!r} m/s^2',
                'it swings only if both are above 0')
        self.a = float(np.sqrt(self.axis @ scene.body.about_center.matrix @ self.axis / self.mass))

    def angle(self, states):
        """Return phi, the angle about the hinge from where the arm hangs straight down, rad."""
        down = -instruments.axes(states)[:, 2, :]
        return np.arctan2(np.cross(down, self.arm) @ self.axis, down @ self.arm)

    def rate(self, states):
        """Return phi', rad/s."""
        return states.angular_velocity @ self.axis

    def period(self, run, guess):
        """Return the mean period, from one rise through the lowest point to a later one, s."""
        rises = run.crossings(self.angle, 0.0, (PERIODS + 1.1) * guess, 200, rising=True)
        return (rises[-1] - rises[0]) / (len(rises) - 1)

    def amplitude(self, run, guess):
        """Return the angle at a turning point, rad."""
        turns = run.crossings(self.rate, 0.1 * guess, 1.1 * guess, 200)
        return abs(self.angle(run.states(turns[:1]))[0])


def check(run):
    """Yield the quantities of a swinging pendulum, and of the same one turned over."""
    scene, here = run.scene, Pendulum(run.scene)
    g, length, a, n = here.g, here.length, here.a, here.axis
    conjugate = theory.conjugate_length(length, a)
    Omega = theory.frequency_from_q(g, length, a)
    turned = run.variant({
        'constraint.hinge.through': np.array(scene.constraint.through)
        + here.arm / length * conjugate,
        'initial.orientation': multiply(*scene.initial.orientation, *n, 0.0), 'initial.angle': 0.0,
        'initial.rate': n @ scene.initial.angular_velocity})
    reach = _reach(here, run, Omega)
    amplitude = here.amplitude(run, theory.period(Omega, reach))
    period = here.period(run, theory.period(Omega, reach))
    other = Pendulum(turned.scene).period(turned, theory.period(Omega, reach))
    yield Quantity('period at this amplitude', theory.period(Omega, amplitude), period, 1e-11, 's')
    yield Quantity("Omega_P over Omega_Q, P at l' = l + a^2/l",
                   theory.frequency_from_p(g, length, a, conjugate) / Omega, period / other, 1e-11)
    yield Quantity("l' Omega^2/g at this amplitude: the bias of g", theory.gravity_bias(amplitude),
                   theory.gravity_recovered(conjugate, 2.0 * np.pi / period) / g, 1e-11)
    small = 2.0 * np.pi / period * theory.period(1.0, amplitude) / (2.0 * np.pi)
    yield Quantity('I_Q = M g l/Omega^2', theory.moment_about_suspension(here.mass, length, a),
                   here.mass * g * length / small**2, 1e-11, 'kg m^2',
                   as_written=theory.moment_about_suspension_as_written(here.mass, length, a))
    time = 0.3 * period
    yield Quantity("phi'' 0.3 periods after the start",
                   theory.angular_acceleration(here.angle(run.states([time]))[0], Omega),
                   run.derivative(here.rate, time, 0.02 * period), 1e-10, 'rad/s^2')
    yield from _small_swings(run, here, Omega)


def _reach(pendulum, run, Omega):
    """Return the approximate amplitude, rad, from the energy."""
    start = run.states([0.0])
    reach = (np.sin(0.5 * pendulum.angle(start)[0]) ** 2
             + (pendulum.rate(start)[0] / (2.0 * Omega)) ** 2)
    if not 0.0 < reach < 1.0:
        raise BadInput(run.scene.name, 'the pendulum does not swing to and fro',
                       'release it at an angle, with less rate')
    return 2.0 * np.arcsin(np.sqrt(reach))


def _small_swings(run, pendulum, Omega):
    """Yield how the small-swing formulas are approached."""
    back = from_rotation_vector(*(-pendulum.angle(run.states([0.0]))[0] * pendulum.axis))
    hanging = list(multiply(*run.scene.initial.orientation, *back))
    ratios = []
    for amplitude in AMPLITUDES:
        swing = run.variant({
            'initial.orientation': hanging, 'initial.angle': amplitude, 'initial.rate': 0.0})
        ratios.append(2.0 * np.pi / pendulum.period(swing, 2.0 * np.pi / Omega) / Omega)
    ratios = np.array(ratios)
    yield from limit('Omega', 'the amplitude', AMPLITUDES, ratios, 2, 0.02, 1e-8)
    yield from limit("g = l' Omega^2", 'the amplitude', AMPLITUDES, ratios**2, 2, 0.02, 1e-8)
