# SPDX-License-Identifier: Apache-2.0
"""Check of a satellite's librations: pitch of any size, roll and yaw, the conserved energy."""

import math

import numpy as np

from rigid_body_sim.numerics.rotations import multiply
from rigid_body_sim.study.scenes import instruments
from rigid_body_sim.study.scenes.quantity import Quantity
from rigid_body_sim.theory import libration as theory

SMALL = 1e-5    # rad


def seen(run, states):
    """Return the attitudes in the frame of the orbit, quaternions (n, 4)."""
    half = 0.5 * rate_of(run) * states.time
    return np.array([multiply(0.0, 0.0, -math.sin(a), math.cos(a), *q)
                     for a, q in zip(half, states.orientation, strict=True)])


def rate_of(run):
    """Return the rate of the orbit, rad/s."""
    return run.scene.effect('gravity_gradient').rate


def check(run):
    """Yield the period of pitch, the rates of roll and yaw, and the conserved energy."""
    n, moments = rate_of(run), run.scene.body.about_center.moments
    orbit = 2.0 * math.pi / n
    amplitude = 2.0 * math.asin(run.scene.initial.orientation[2])
    predicted = theory.pitch_period(amplitude, n, *moments)
    crossings = run.crossings(lambda states: seen(run, states)[:, 2], 0.0, 2.0 * predicted, 40)
    yield Quantity('half the period of pitch', 0.5 * predicted, crossings[1] - crossings[0],
                   1e-11, 's')
    yield from _roll_yaw(run, n, moments)
    tumbling = run.variant({'initial.rotation_vector': [0.3, 0.2, -0.1],
                            'initial.angular_velocity': [0.2 * n, -0.3 * n, 1.1 * n]})
    energy = _energy(tumbling, n, moments, np.linspace(0.0, 5.0 * orbit, 101))
    yield Quantity('drift of T - n L3 + (3/2) n^2 u.I u, 5 orbits', 1e-12,
                   float(np.abs(energy / energy[0] - 1.0).max()), 0.0, bound=True)
    swapped = run.variant({'body.inertia': [moments[1], moments[0], moments[2]],
                           'initial.rotation_vector': [0.0, 0.0, 0.01]})
    turned = 2.0 * np.arcsin(np.abs(seen(run, swapped.states(np.linspace(0.0, 3.0 * orbit, 301))))
                             [:, 2])
    yield Quantity('a right angle less the largest pitch, middle moment outwards: it turns over',
                   0.0, 0.5 * math.pi - float(turned.max()), 0.0, 'rad', bound=True)


def _roll_yaw(run, n, moments):
    """Yield the remainder of roll and yaw at equal times under the polynomial of both rates."""
    step = 0.7 / n
    times = step * np.arange(9)
    small = run.variant({'initial.rotation_vector': [SMALL, 0.5 * SMALL, 0.0]})
    angles = 2.0 * seen(run, small.states(times))[:, :2] / SMALL
    first, second = (2.0 * math.cos(step * rate)
                     for rate in theory.roll_yaw_rates(n, *moments))
    # (z + 1/z - first)(z + 1/z - second)
    weights = np.array([1.0, -(first + second), 2.0 + first * second, -(first + second), 1.0])
    left = [np.convolve(angle, weights, 'valid') for angle in angles.T]
    yield Quantity('roll and yaw at nine times, less the two rates of the formula', 0.0,
                   np.ravel(left), 1e-7, 'of the tilt', absolute=True)


def _energy(run, n, moments, times):
    """Return the energy in the frame of the orbit, J, shape of the times."""
    states, moments = run.states(times), np.array(moments)
    axes, momentum = instruments.axes(states), moments * states.angular_velocity
    outwards = np.stack([np.cos(n * times), np.sin(n * times), 0.0 * times], axis=1)
    u = np.einsum('nij,ni->nj', axes, outwards)
    L3 = np.einsum('nj,nj->n', axes[:, 2], momentum)
    return (0.5 * np.sum(momentum * states.angular_velocity, axis=1) - n * L3
            + 1.5 * n * n * np.sum(moments * u * u, axis=1))
