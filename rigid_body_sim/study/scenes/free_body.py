# SPDX-License-Identifier: Apache-2.0
"""Check of torque-free motion (notes, "Torque-free Motion", "Euler angles").

E and L^2 are constant and bound omega; p_alpha of an asymmetric body is constant too.
"""

import numpy as np

from rigid_body_sim.study.scenes import instruments
from rigid_body_sim.study.scenes.driven_body import equations_of_euler
from rigid_body_sim.study.scenes.quantity import Quantity
from rigid_body_sim.theory import asymmetric_top, euler_angles
from rigid_body_sim.theory import euler_equations as theory

SECONDS = 100.0


def check(run):
    """Yield the quantities of a free body."""
    moments = np.array(run.scene.body.about_center.moments)
    start = run.at(0.0).angular_velocity
    times = np.linspace(0.0, SECONDS, 2001)
    omega = run.states(times).angular_velocity
    T, L_squared = (
        theory.kinetic_energy(moments, start), theory.angular_momentum_squared(moments, start))
    yield Quantity('E at 2001 times', np.full(len(times), T),
                   theory.kinetic_energy(moments, omega), 1e-12, 'J')
    yield Quantity('L^2 at 2001 times', np.full(len(times), L_squared),
                   theory.angular_momentum_squared(moments, omega), 1e-12, '(kg m^2/s)^2')
    L = run.read(instruments.momentum_in_world(moments), times)
    yield Quantity('L in the world at 2001 times', np.broadcast_to(L[0], L.shape).ravel(),
                   L.ravel(), 1e-12, 'kg m^2/s')
    largest = np.abs(omega).max(axis=0)
    yield Quantity('largest |omega_i| against sqrt(2 T/I_i)',
                   theory.bounds_from_energy(moments, T), largest, 1e-12, 'rad/s', bound=True)
    yield Quantity(
        'largest |omega_i| against L/I_i', theory.bounds_from_angular_momentum(moments, L_squared),
        largest, 1e-12, 'rad/s', bound=True)
    yield from equations_of_euler(run, np.zeros(3), 5.0)
    yield from flips(run, 20.0)
    yield from _in_euler_angles(run, moments, L[0, 2])


def flips(run, seconds, most=6):
    """Yield the time between sign changes of omega2, if there are any."""
    order = np.argsort(run.scene.body.about_center.moments)
    moments = np.array(run.scene.body.about_center.moments)[order]
    expected = asymmetric_top.time_between_flips(moments, run.at(0.0).angular_velocity[order])
    if expected:
        times = run.crossings(
            instruments.omega(order[1]), 0.0, max(seconds, 3.5 * expected), 2000)[:most]
        yield Quantity('time between changes of sign of omega2 (elliptic)',
                       np.full(len(times) - 1, expected), np.diff(times), 1e-10, 's')


def _in_euler_angles(run, moments, L_z):
    """Yield rates, energy and p_alpha in Euler angles; the angles are differentiated for rates."""
    candidates = np.linspace(5.0, 8.0, 31)
    time = candidates[np.argmax(np.sin(run.read(instruments.beta, candidates)))]
    states = run.states([time])
    if not np.sin(instruments.beta(states)[0]) > 0.1:
        return      # e3 stays vertical, where alpha and gamma are not distinct
    beta, gamma = instruments.beta(states)[0], instruments.gamma(states)[0]
    rates = [run.derivative(lambda s, angle=angle: np.unwrap(angle(s)), time,
                            0.1 / np.linalg.norm(states.angular_velocity))
             for angle in (instruments.alpha, instruments.beta, instruments.gamma)]
    omega = states.angular_velocity[0]
    yield Quantity("omega from alpha', beta', gamma' (differentiated angles)",
                   euler_angles.body_rates(*rates, beta, gamma), omega, 1e-10, 'rad/s')
    yield Quantity(
        "T from alpha', beta', gamma'", euler_angles.kinetic_energy(*rates, beta, gamma, *moments),
        theory.kinetic_energy(moments, omega), 1e-10, 'J')
    times = np.linspace(0.0, 20.0, 201)
    many = run.states(times)
    p = euler_angles.p_alpha(
        many.angular_velocity.T, instruments.beta(many), instruments.gamma(many), *moments)
    scale = np.linalg.norm(moments * omega)
    yield Quantity('p_alpha at 201 times, over L', np.full(len(times), L_z / scale), p / scale,
                   1e-12, absolute=True)
