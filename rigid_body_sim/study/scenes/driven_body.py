# SPDX-License-Identifier: Apache-2.0
"""Check of Euler's equations with a torque (notes, "Euler's Equations").

An axial torque has a closed form; for any other body the terms of the equations are compared.
"""

import numpy as np

from rigid_body_sim.study.scenes import instruments
from rigid_body_sim.study.scenes.quantity import Quantity
from rigid_body_sim.theory import driven_body as theory
from rigid_body_sim.theory import euler_equations

SECONDS = 10.0
ASYMMETRIC = {'body.inertia': [0.8, 1.0, 1.3], 'torque.value': [0.1, -0.2, 0.5]}


def check(run):
    """Yield the quantities of a symmetric body under axial torque and of an asymmetric one.

    The torque is constant in body axes; for the asymmetric body it is oblique.
    """
    I1, I2, I3 = run.scene.body.about_center.moments
    Gamma = np.array(run.scene.effect('torque').values[0])
    start = run.at(0.0).angular_velocity.copy()
    if I1 == I2 and not Gamma[:2].any():
        times = np.linspace(0.0, SECONDS, 41)
        predicted = theory.angular_velocity(times, start, Gamma[2], I1, I3)
        yield Quantity(
            'omega at 41 times', predicted.ravel(),
            run.read(lambda states: states.angular_velocity, times).ravel(), 1e-12, 'rad/s')
        yield from _turn(run, start, Gamma[2], I1, I3)
    yield from equations_of_euler(run, Gamma, SECONDS)
    yield from momentum(run, Gamma, SECONDS)
    other = run.variant(ASYMMETRIC)
    Gamma = np.array(other.scene.effect('torque').values[0])
    yield from equations_of_euler(other, Gamma, SECONDS, ' (1, 2, 3 different, oblique torque)')
    yield from momentum(other, Gamma, SECONDS, ' (1, 2, 3 different, oblique torque)')


def _turn(run, start, Gamma3, I1, I3):
    """Yield the time when the spin passes through zero, and the angle that omega has turned."""
    reversal = theory.spin_reversal_time(start[2], Gamma3, I3)
    if 0.0 < reversal < SECONDS:
        yield Quantity('omega3 runs through zero', reversal,
                       run.crossings(instruments.omega(2), 0.0, SECONDS, 50)[0], 1e-12, 's')
    times = np.linspace(0.0, SECONDS, 2001)
    omega = run.states(times).angular_velocity
    turned = np.unwrap(np.arctan2(omega[:, 1], omega[:, 0]))
    yield Quantity(
        'angle that omega turned in the body', theory.phase(SECONDS, start[2], Gamma3, I1, I3),
        turned[-1] - turned[0], 1e-11, 'rad')


def equations_of_euler(run, Gamma, seconds, about=''):
    """Yield omega' by differentiation of the motion, compared with Euler's equations."""
    moments = np.array(run.scene.body.about_center.moments)
    times = seconds * np.array([0.21, 0.53, 0.88])
    predicted = euler_equations.angular_acceleration(
        moments, run.states(times).angular_velocity, Gamma)
    pace = np.linalg.norm(run.states(times).angular_velocity, axis=1).max()
    measured = [[run.derivative(instruments.omega(k), time, 0.3 / pace) for k in range(3)]
                for time in times]
    yield Quantity(f"omega'/omega^2 by Euler's equations, 3 times{about}",
                   predicted.ravel() / pace**2, np.ravel(measured) / pace**2, 1e-10, absolute=True)


def momentum(run, Gamma, seconds, about=''):
    """Yield the change of L in the world, compared with the integral of R Gamma over the motion.

    The integral is made by Gauss-Legendre quadrature in short pieces.
    """
    points, weights = np.polynomial.legendre.leggauss(12)
    edges = np.linspace(0.0, seconds, 161)
    half = 0.5 * np.diff(edges)[:, np.newaxis]
    times = (0.5 * (edges[1:] + edges[:-1]))[:, np.newaxis] + half * points
    torque = instruments.axes(run.states(times.ravel())) @ Gamma
    integral = np.sum(torque * (half * weights).ravel()[:, np.newaxis], axis=0)
    L = run.read(
        instruments.momentum_in_world(run.scene.body.about_center.moments), [0.0, seconds])
    yield Quantity(
        f'change of L in {seconds:g} s{about}', integral, L[1] - L[0], 1e-11, 'kg m^2/s')
