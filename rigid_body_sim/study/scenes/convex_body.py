# SPDX-License-Identifier: Apache-2.0
"""Bodies that roll on a plane: the rolling disk, its end, the rattleback."""

import numpy as np

from rigid_body_sim.numerics.rotations import rotate_back
from rigid_body_sim.study.scenes.quantity import Quantity
from rigid_body_sim.theory import rattleback as rattleback_theory
from rigid_body_sim.theory import rolling_disk as theory


def normals(states):
    """Return the upward direction in body axes, shape (n, 3)."""
    return np.array([rotate_back(*q, 0.0, 0.0, 1.0) for q in states.orientation])


def _energy_drift(run, seconds):
    energy, _ = run.simulation.diagnose(run.states(np.linspace(0.0, seconds, 101)))
    return float(np.abs(energy / energy[0] - 1.0).max())


def _numbers(run):
    """Return A, C, m, R, g of a disk."""
    body = run.scene.body
    A, _, C = body.about_center.moments
    return A, C, body.mass, body.surface.size[0], run.scene.effect('gravity').g


def rolling_disk(run):
    """Yield the constants of the motion, the steady motion, and both sides of the threshold."""
    A, C, m, R, g = _numbers(run)
    states = run.states(np.linspace(0.0, 100.0, 21))
    constants = []
    for n, omega in zip(normals(states), states.angular_velocity, strict=True):
        flat = np.hypot(n[0], n[1])
        s = float((omega[:2] @ n[:2]) / flat)
        constants.append(theory.legendre_constants(float(np.arccos(n[2])), s, float(omega[2]),
                                                   A, C, m, R))
    constants = np.array(constants)
    for k, name in enumerate(('c1', 'c2')):
        yield Quantity(f'{name} of the Legendre functions, 100 s', constants[0, k],
                       constants[-1, k], 1e-12, 'rad/s')
    yield Quantity('largest drift of the energy, 100 s', 1e-13, _energy_drift(run, 100.0), 0.0,
                   bound=True)
    yield from _steady(run, A, m, R, g)
    threshold = theory.speed_of_upright_stability(A, C, m, R, g)
    for share, stable in ((1.01, True), (0.99, False)):
        upright = run.variant({
            'initial.euler_zyz': [0.0, 0.5 * np.pi, 0.0],
            'initial.angular_velocity': [0.0, 1e-6, share * threshold / R]})
        tilt = np.abs(normals(upright.states(np.linspace(0.0, 40.0, 401)))[:, 2]).max()
        yield Quantity(
            f'tilt grows beyond 1e-4 rad at {share:g} of the speed of upright stability',
            0.0 if stable else 1.0, float(tilt > 1e-4), 0.0, absolute=True)


def _steady(run, A, m, R, g):
    """Yield that the centre rests at the rate of precession that theory gives."""
    theta = 0.3
    rate = theory.precession_with_centre_at_rest(theta, A, m, R, g)
    steady = run.variant({'initial.euler_zyz': [0.0, theta, 0.0],
                          'initial.angular_velocity': [-rate * np.sin(theta), 0.0, 0.0]})
    states = steady.states(np.linspace(0.0, 5.0, 51))
    yield Quantity('way of the centre in 5 s at W^2 = m g R/(A sin theta)', 0.0,
                   float(np.abs(states.position - states.position[0]).max()), 1e-9, 'm',
                   absolute=True)


def euler_disk(run):
    """Yield the time to the end, and the exponent of the inclination."""
    _, _, m, _, _ = _numbers(run)
    c = run.scene.effect('rolling_friction').viscous
    start = float(np.hypot(*normals(run.states([0.0]))[0, :2]))
    end = theory.time_to_end_viscous(start, m, c)
    rest = run.simulation.at_event('rest', 3.0 * end).time
    yield Quantity('time to the end', end, rest, 1e-2, 's', detail='3 m a^2/(16 c), as a -> 0')
    left = np.array([0.5, 0.25, 0.1]) * rest
    tilts = np.hypot(*normals(run.states(rest - left)).T[:2])
    for share, tilt in zip((0.5, 0.25, 0.1), tilts, strict=True):
        yield Quantity(f'time left at {share:g} of it', share * rest,
                       theory.time_to_end_viscous(tilt, m, c), 3e-2, 's')
    slope = np.polyfit(np.log(left), np.log(tilts), 1)[0]
    yield Quantity('exponent of the inclination', 0.5, slope, 2e-2)


def rattleback(run):
    """Yield both modes of small rocking at small spins, and that the spin is reversed."""
    body, surface = run.scene.body, run.scene.body.surface
    g = run.scene.effect('gravity').g
    given = body.mass, body.about_center.matrix, np.array(body.center_of_mass)
    at_rest = rattleback_theory.modes(given, surface.size, g, 0.0)
    for name, mode in zip(('slow', 'fast'), at_rest, strict=True):
        yield Quantity(f'frequency of the {name} mode without spin', mode.imag,
                       _frequency(run, mode.imag, name), 1e-5, 'rad/s')
    yield Quantity('largest drift of the energy, 10 s', 1e-12, _energy_drift(run, 10.0), 0.0,
                   bound=True)
    began = run.scene.initial.angular_velocity[2]
    spins = run.states(np.linspace(0.0, 10.0, 1001)).angular_velocity[:, 2] / began
    yield Quantity('the spin comes to rest and reverses: least of it over that at the start', -0.5,
                   float(spins.min()), 0.0, bound=True)


def _frequency(run, frequency, name):
    """Return the frequency of small rocking along a principal direction of a mode, rad/s."""
    tilt = 1e-5
    axis = [0.0, tilt, 0.0] if name == 'slow' else [0.5 * np.pi, tilt, -0.5 * np.pi]
    rocking = run.variant({'initial.euler_zyz': axis,
                           'initial.angular_velocity': [0.0, 0.0, 0.0]})
    times = np.arange(2048) * (np.pi / frequency / 8.0)
    n = normals(rocking.states(times))
    signal = n[:, 0] if name == 'slow' else n[:, 1]
    return _peak(signal, times[1], frequency)


def _peak(signal, step, guess):
    """Return the frequency nearest to a guess at which a windowed signal is strongest."""
    from scipy.optimize import minimize_scalar
    times = step * np.arange(len(signal))
    window = np.blackman(len(signal)) * signal

    def power(w):
        return -abs(np.sum(window * np.exp(-1j * w * times)))

    width = 0.02 * guess
    return minimize_scalar(power, bounds=(guess - width, guess + width), method='bounded',
                           options={'xatol': 1e-9 * guess}).x
