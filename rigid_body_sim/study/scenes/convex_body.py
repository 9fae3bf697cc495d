# SPDX-License-Identifier: Apache-2.0
"""Bodies that roll or slip on a plane: disks, a coin, balls, the rattleback, tops that rise."""

import math

import numpy as np

from rigid_body_sim.numerics.rotations import rotate, rotate_back
from rigid_body_sim.study.scenes.quantity import Quantity
from rigid_body_sim.theory import rattleback as rattleback_theory
from rigid_body_sim.theory import rising, rolling_sphere
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
    """Yield constants, the steady motion, and both sides of thresholds; also of a hoop."""
    A, _, m, R, g = _numbers(run)
    hoop = run.variant({}, {'body.shape': f'{{hoop: {{radius: {R!r}}}}}'})
    for one, name in ((run, ''), (hoop, ', hoop')):
        constants = _legendre_constants(one)
        for k, symbol in enumerate(('c1', 'c2')):
            yield Quantity(f'{symbol} of the Legendre functions, 100 s{name}', constants[0, k],
                           constants[-1, k], 1e-12, 'rad/s')
    yield Quantity('largest drift of the energy, 100 s', 1e-13, _energy_drift(run, 100.0), 0.0,
                   bound=True)
    yield from _steady(run, A, m, R, g)
    for one, name in ((run, ''), (hoop, ', hoop')):
        yield from _upright(one, name)


def _legendre_constants(run):
    """Return c1 and c2 along 100 s, shape (21, 2)."""
    A, C, m, R, _ = _numbers(run)
    states = run.states(np.linspace(0.0, 100.0, 21))
    constants = []
    for n, omega in zip(normals(states), states.angular_velocity, strict=True):
        flat = np.hypot(n[0], n[1])
        s = float((omega[:2] @ n[:2]) / flat)
        constants.append(theory.legendre_constants(float(np.arccos(n[2])), s, float(omega[2]),
                                                   A, C, m, R))
    return np.array(constants)


def _upright(run, name):
    """Yield that an upright disk rolls, and spins, stably above a threshold only."""
    A, C, m, R, g = _numbers(run)
    rolls = theory.speed_of_upright_stability(A, C, m, R, g) / R
    spins = theory.rate_of_upright_stability(A, m, R, g)
    for omega, threshold in (([0.0, 1e-6, rolls], 'speed of upright stability'),
                             ([-spins, 1e-6, 0.0], 'rate of upright stability, spinning')):
        for share, stable in ((1.01, True), (0.99, False)):
            upright = run.variant({
                'initial.euler_zyz': [0.0, 0.5 * np.pi, 0.0],
                'initial.angular_velocity': [share * omega[0], omega[1], share * omega[2]]})
            tilt = np.abs(normals(upright.states(np.linspace(0.0, 40.0, 401)))[:, 2]).max()
            yield Quantity(f'tilt grows beyond 1e-4 rad at {share:g} of the {threshold}{name}',
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
    _, _, m, R, g = _numbers(run)
    c = run.scene.effect('rolling_friction').viscous
    start = float(np.hypot(*normals(run.states([0.0]))[0, :2]))
    end = theory.time_to_end_viscous(start, m, c)
    rest = run.simulation.at_event('rest', 3.0 * end).time
    yield Quantity('time to the end', end, rest, 1e-3, 's', detail='3 m a^2/(16 c), as a -> 0')
    spin = -2.0 * math.sqrt(0.5 * g * start / R)
    half = run.variant({'initial.euler_zyz': [0.0, 0.5 * start, 0.0],
                        'initial.angular_velocity': [spin, 0.0, 0.0]})
    between = rest - half.simulation.at_event('rest', end).time
    yield Quantity('time between two inclinations, a and a/2', 0.75 * end, between,
                   start * start, 's', detail='the end itself, where the disk falls freely, '
                   'drops out')
    left = np.array([0.5, 0.25, 0.1]) * rest
    tilts = np.hypot(*normals(run.states(rest - left)).T[:2])
    for share, tilt in zip((0.5, 0.25, 0.1), tilts, strict=True):
        yield Quantity(f'time left at {share:g} of it', share * rest,
                       theory.time_to_end_viscous(tilt, m, c), 3e-2, 's')
    slope = np.polyfit(np.log(left), np.log(tilts), 1)[0]
    yield Quantity('exponent of the inclination', 0.5, slope, 2e-2)
    state = run.at(0.5 * rest)
    n = rotate_back(*state.orientation, 0.0, 0.0, 1.0)
    flat = math.hypot(n[0], n[1])
    rate = abs(float(state.angular_velocity[:2] @ n[:2])) / flat**2
    yield Quantity('ringing: turns of the point of contact', math.sqrt(4.0 * g / (R * flat)), rate,
                   1e-2, 'rad/s', detail='W^2 = 4 g/(R sin(a))')


def rattleback(run):
    """Yield both modes of small rocking at small spins, and that the spin is reversed."""
    body, surface = run.scene.body, run.scene.body.surface
    g = run.scene.effect('gravity').g
    given = body.mass, body.about_center.matrix, np.array(body.center_of_mass)
    at_rest = rattleback_theory.modes(given, surface.size, g, 0.0)
    for name, mode in zip(('slow', 'fast'), at_rest, strict=True):
        yield Quantity(f'frequency of the {name} mode without spin', mode.imag,
                       _frequency(run, mode.imag, name), 1e-5, 'rad/s')
    for spin in (-0.5, 0.5):
        modes = rattleback_theory.modes(given, surface.size, g, spin)
        for name, mode in zip(('slow', 'fast'), modes, strict=True):
            yield Quantity(f'growth of the {name} mode at {spin:g} rad/s', mode.real,
                           _growth(run, spin, mode.imag, name), 2e-2, '1/s')
    yield Quantity('largest drift of the energy, 10 s', 1e-12, _energy_drift(run, 10.0), 0.0,
                   bound=True)
    began, times = run.scene.initial.angular_velocity[2], np.linspace(0.0, 10.0, 1001)
    slips = run.variant({'effects.sliding_friction.mu': 0.3})
    for one, name, least in ((run, '', -0.9), (slips, ' with mu = 0.3, where it slips', -0.3)):
        spins = one.states(times).angular_velocity[:, 2] / began
        yield Quantity(f'the spin reverses{name}: least of it over that at the start', least,
                       float(spins.min()), 0.0, bound=True)


def _growth(run, spin, frequency, name):
    """Return the growth (1/s) of small rocking along a principal direction at a small spin."""
    tilt = 1e-6
    axis = [0.0, tilt, 0.0] if name == 'slow' else [0.5 * np.pi, tilt, -0.5 * np.pi]
    rocking = run.variant({'initial.euler_zyz': axis,
                           'initial.angular_velocity': [0.0, 0.0, spin]})
    sizes = []
    for middle in (2.0, 6.0):
        times = middle + np.linspace(-2.0, 2.0, 4001)
        signal = normals(rocking.states(times))[:, 0 if name == 'slow' else 1]
        sizes.append(abs(np.sum(np.blackman(4001) * signal * np.exp(-1j * frequency * times))))
    return math.log(sizes[1] / sizes[0]) / 4.0


def _top(run):
    """Return A, C, m, g, R, a of a top with a round foot."""
    body = run.scene.body
    A, _, C = np.diag(body.about_center.matrix).tolist()
    a = body.surface.center[2] - body.center_of_mass[2]
    return A, C, body.mass, run.scene.effect('gravity').g, body.surface.size[0], float(a)


def _inclinations(states):
    return np.arccos(normals(states)[:, 2])


def tippe_top(run):
    """Yield Jellett's integral, the time to turn over, the groups, and the effect of sticking."""
    A, C, m, g, R, a = _top(run)
    times = np.linspace(0.0, 3.0, 1501)
    states = run.states(times)
    constants = np.array([rising.jellett(omega, n, A, C, R, a) for omega, n in zip(
        states.angular_velocity, normals(states), strict=True)])
    yield Quantity("drift of Jellett's integral, 3 s", 1e-13,
                   float(np.abs(constants / constants[0] - 1.0).max()), 0.0, bound=True)
    start, mu = float(_inclinations(states[:1])[0]), run.scene.effect('sliding_friction').mu
    rise = rising.time_to_rise(constants[0], mu * m * g, lambda theta: R - a * math.cos(theta),
                               start, 0.5 * math.pi)
    over = run.crossings(lambda states: normals(states)[:, 2], 0.0, 3.0, 300)
    yield Quantity('time until its axis is level', rise, over[0], 5e-2, 's',
                   detail='J/(mu m g) times the integral of 1/h^2, for a fast spin')
    stuck = run.simulation.at_event('rolling began', 3.0).time
    rolls = run.states(np.linspace(stuck, stuck + 1.0, 21))
    routh = [rolling_sphere.routh_constant(float(omega[2]), float(theta), A, C, m, R, a)
             for omega, theta in zip(rolls.angular_velocity, _inclinations(rolls), strict=True)]
    yield Quantity("drift of Routh's integral in the second after it sticks", 1e-12,
                   float(np.abs(np.array(routh) / routh[0] - 1.0).max()), 0.0, bound=True)
    for share, group in ((0.75, 'I: it stays'), (1.0, 'II: it turns over'),
                         (1.35, 'III: it stops on the way')):
        yield from _group(run, share, group, times)


def _group(run, share, group, times):
    """Yield the inclination that a top of a group reaches, on a point and on a small patch."""
    _, C, m, g, R, a = _top(run)
    A = share * C
    other = run.variant({'body.inertia': [A, A, C]})
    first = other.states([0.0])
    constant = rising.jellett(first.angular_velocity[0], normals(first)[0], A, C, R, a)
    rests = (float(_inclinations(first)[0]) if share < 1.0 else
             rising.inclination_of_least_energy(constant, A, C, m, g, R, a))
    largest = np.degrees(_inclinations(other.states(times)).max())
    name = f'largest inclination, A/C = {share}, group {group}'
    yield Quantity(f'{name}; on a point', np.degrees(rests), largest, 1e-9, '°', bound=True,
                   detail='friction at a point lets it stick before' if share >= 1.0 else '')
    mu = run.scene.effect('sliding_friction').mu
    patch = other.variant({}, {'effects': (
        f'[gravity: {{g: {g!r}}}, sliding_friction: {{mu: {mu!r}}}, '
        'spinning_friction: {radius: 1.0e-4}]')})
    largest = np.degrees(_inclinations(patch.states(times)).max())
    yield Quantity(f'{name}; on a patch of 0.1 mm', np.degrees(rests), largest, 1e-2, '°')


def rising_egg(run):
    """Yield the time in which an egg rises and how far, and that its ledger is balanced."""
    body, g = run.scene.body, run.scene.effect('gravity').g
    A, _, _ = np.diag(body.about_center.matrix).tolist()
    b, _, c = body.surface.size
    mu = run.scene.effect('sliding_friction').mu

    def height(theta):
        return math.hypot(b * math.sin(theta), c * math.cos(theta))

    states = run.states(np.linspace(0.0, 3.0, 1501))
    theta = _inclinations(states)
    spin = float(np.linalg.norm(states.angular_velocity[0]))
    rise = rising.time_to_rise(A * spin * height(theta[0]), mu * body.mass * g, height,
                               float(theta[0]), 0.25 * math.pi)
    half = run.crossings(lambda states: _inclinations(states) - 0.25 * math.pi, 0.0, 3.0, 300)
    yield Quantity('time until its axis is halfway up', rise, half[0], 5e-2, 's',
                   detail='J/(mu m g) times the integral of 1/h^2, for a fast spin')
    n = normals(states)
    about = (states.angular_velocity @ body.about_center.matrix.T * n).sum(1)
    heights = np.array([height(x) for x in theta])
    yield Quantity("drift of Jellett's adiabatic constant L_z h until it is halfway up", 0.05,
                   float(np.abs(about * heights / (about[0] * heights[0]) - 1.0)[
                       states.time < half[0]].max()), 0.0, bound=True)
    yield Quantity('least inclination', 0.0, float(np.degrees(theta.min())), 5.0, '°',
                   absolute=True, detail='it sticks before it stands quite upright')
    run.simulation.advance(3000)
    yield Quantity('residual of the energy through slip, flight and roll, 3 s', 1e-12,
                   abs(run.simulation.ledger()['energy_residual']), 0.0, bound=True)


def routh_sphere(run):
    """Yield the three integrals, and the other turning point and when it comes."""
    A, C, m, g, R, a = _top(run)
    states = run.states(np.linspace(0.0, 100.0, 101))
    n, omega = normals(states), states.angular_velocity
    jellett = np.array([rising.jellett(w, v, A, C, R, a) for w, v in zip(omega, n, strict=True)])
    routh = np.array([rolling_sphere.routh_constant(float(w[2]), float(np.arccos(v[2])), A, C, m,
                                                    R, a) for w, v in zip(omega, n, strict=True)])
    for name, values in (('Jellett', jellett), ('Routh', routh)):
        yield Quantity(f"drift of {name}'s integral, 100 s", 1e-13,
                       float(np.abs(values / values[0] - 1.0).max()), 0.0, bound=True)
    yield Quantity('largest drift of the energy, 100 s', 1e-13, _energy_drift(run, 100.0), 0.0,
                   bound=True)
    flat = math.hypot(n[0, 0], n[0, 1])
    s = float((omega[0, :2] @ n[0, :2]) / flat)
    other, time = rolling_sphere.swing(math.acos(n[0, 2]), s, float(omega[0, 2]), A, C, m, R, a,
                                       g)
    yield Quantity('the other turning point', other,
                   float(_inclinations(run.states([time]))[0]), 1e-12, 'rad')
    yield Quantity('inclination after a hundred swings', math.acos(n[0, 2]),
                   float(_inclinations(run.states([100.0 * time]))[0]), 1e-10, 'rad')


def chaplygin_sphere(run):
    """Yield that the momentum about the contact keeps its size and direction, and the energy."""
    body = run.scene.body
    states = run.states(np.linspace(0.0, 100.0, 101))
    n, omega = normals(states), states.angular_velocity
    r = -body.surface.size[0] * n
    M = omega @ body.about_center.matrix.T + body.mass * np.cross(r, np.cross(omega, r))
    world = np.array([rotate(*q, *one) for q, one in zip(states.orientation, M, strict=True)])
    size = float(np.linalg.norm(world[0]))
    for k, name in enumerate('xyz'):
        yield Quantity(f'M_{name} in the world after 100 s, over |M|', world[0, k] / size,
                       world[-1, k] / size, 1e-12)
    yield Quantity('largest drift of the energy, 100 s', 1e-13, _energy_drift(run, 100.0), 0.0,
                   bound=True)


def tossed_coin(run):
    """Yield when a coin hits the table, and that it rests with its energy accounted for."""
    body, start = run.scene.body, run.scene.initial
    R, g = body.surface.size[0], run.scene.effect('gravity').g
    A, _, C = body.about_center.moments
    first = run.simulation.at_event('impact', 5.0).time
    # free flight: the axis turns about L at the rate L/A
    omega = start.angular_velocity
    L = np.array([A * omega[0], A * omega[1], C * omega[2]])
    L = np.array(rotate(*start.orientation, *L))
    size = float(np.linalg.norm(L))
    pole, axis = L / size, np.array(rotate(*start.orientation, 0.0, 0.0, 1.0))

    def gap(time):
        angle = size / A * time
        turned = (axis * math.cos(angle) + np.cross(pole, axis) * math.sin(angle)
                  + pole * (pole @ axis) * (1.0 - math.cos(angle)))
        return (start.position[2] + start.velocity[2] * time - 0.5 * g * time * time
                - R * math.sqrt(1.0 - turned[2] ** 2))

    from scipy.optimize import brentq
    yield Quantity('first impact', brentq(gap, first - 1e-3, first + 1e-3, xtol=1e-15), first,
                   1e-12, 's')
    rest = run.simulation.at_event('rest', 10.0).time
    run.simulation.advance(math.ceil(rest * run.simulation.rate) + 1)
    ledger = run.simulation.ledger()
    energy, _ = run.simulation.diagnose(run.states([0.0]))
    yield Quantity('heat of slip, roll and impacts until it rests', float(energy[0]),
                   ledger['dissipated'], 1e-7, 'J',
                   detail='it counts as flat at 1e-6 rad')
    yield Quantity('residual of the energy', 1e-12, abs(ledger['energy_residual']), 0.0,
                   bound=True)
    yield Quantity('motion that is left', 0.0,
                   float(np.abs(run.states([rest + 1.0]).angular_velocity).max()), 0.0, 'rad/s',
                   absolute=True)


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
