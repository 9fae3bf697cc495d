# SPDX-License-Identifier: Apache-2.0
"""Check of the symmetric top in a uniform field, at any tilt and spin.

It covers the notes from "Symmetric Top" to "Small oscillations about equilibrium".
"""

import numpy as np

from rigid_body_sim.errors import BadInput
from rigid_body_sim.study.scenes import instruments
from rigid_body_sim.study.scenes.limits import limit
from rigid_body_sim.study.scenes.quantity import Quantity
from rigid_body_sim.theory import euler_angles
from rigid_body_sim.theory import heavy_top as theory

SWINGS = 4
SMALL = (0.04, 0.02, 0.01)          # beta' at the start, over the nutation frequency


class Top:
    """The symbols of the notes, read from a scene and its first state."""

    def __init__(self, run):
        scene = run.scene
        self.I1, I2, self.I3 = scene.body.about_origin.moments
        x, y, length = scene.body.center_of_mass
        self.Mgl = scene.body.mass * scene.effect('gravity').g * length
        if self.I1 != I2 or x or y or not self.Mgl > 0.0:
            raise BadInput(
                scene.name, f'moments {[self.I1, I2, self.I3]}, centre of mass {[x, y, length]}',
                'the formulas are for I1 = I2, a centre of mass above the pivot on axis 3, '
                'and gravity')
        start = run.states([0.0])
        self.beta, self.beta_rate = (
            float(instruments.beta(start)[0]), float(instruments.beta_rate(start)[0]))
        self.P_gamma = float(self.I3 * start.angular_velocity[0, 2])
        self.P_alpha = (
            float(theory.p_alpha(
                instruments.alpha_rate(start)[0], self.beta, self.P_gamma, self.I1))
            if self.beta else self.P_gamma)
        self.momenta = self.P_alpha, self.P_gamma
        self.E = (
            theory.energy(self.beta, self.beta_rate, *self.momenta, self.I1, self.I3, self.Mgl)
            if self.beta else None)

    def moments_of_motion(self, run):
        """Return the instrument that reads (p_alpha, p_gamma) = (L_z, I3 omega3)."""
        def read(states):
            L = instruments.momentum_in_world((self.I1, self.I1, self.I3))(states)
            return np.stack([L[:, 2], self.I3 * states.angular_velocity[:, 2]], axis=1)
        return read


def check(run):
    """Yield the quantities of a nutating top."""
    top = Top(run)
    I1, I3, Mgl, momenta = top.I1, top.I3, top.Mgl, top.momenta
    if (not np.sin(top.beta) > 0.02
            or abs(abs(top.P_alpha) - abs(top.P_gamma)) < 1e-6 * np.sqrt(I1 * Mgl)):
        raise BadInput(
            run.scene.name,
            f'tilt {top.beta:.6g} rad, p_alpha {top.P_alpha:.6g}, p_gamma {top.P_gamma:.6g}',
            'needs a top off the vertical that never reaches it '
            '(sleeping_top is about the upright one)')
    half = theory.time_between_turning_points(
        run.at(0.0).angular_velocity, instruments.axes(run.states([0.0]))[0, 2], I1, I3, Mgl)
    span = 2.0 * SWINGS * half
    kept = (run.read(top.moments_of_motion(run), np.linspace(0.0, 100.0, 501))
            / np.linalg.norm(momenta))
    yield Quantity(
        'p_alpha, p_gamma over 100 s, over their size',
        np.tile(momenta, 501) / np.linalg.norm(momenta), kept.ravel(), 1e-12, absolute=True)
    yield from rates(run, top, half * np.array([0.13, 0.55, 1.31]))
    yield from turning_points(run, top, half, span)
    yield from at_equilibrium(run, top, half)
    yield from _curvature(run, top, 0.3 * half)
    yield from in_euler_angles(run, top, 0.37 * half)


def window(run, top, time):
    """Return the width (s) of a window around `time` in which angles change little.

    It serves differentiation and does not reach back before the start.
    """
    state = run.states([time])
    pace = (np.abs(instruments.alpha_rate(state))
            + np.abs(instruments.beta_rate(state)) / np.sin(instruments.beta(state)))[0]
    pace = max(pace, np.hypot(top.P_gamma / top.I1, np.sqrt(top.Mgl / top.I1)))
    return min(0.4 / pace, time)


def rates(run, top, times):
    """Yield alpha', gamma', beta'' by differentiation, and E, compared with the notes."""
    I1, I3, Mgl = top.I1, top.I3, top.Mgl
    states = run.states(times)
    beta = instruments.beta(states)

    def slope(angle):
        return [run.derivative(lambda s: np.unwrap(angle(s)), time, window(run, top, time))
                for time in times]

    yield Quantity("alpha' at 3 times", theory.alpha_rate(beta, *top.momenta, I1),
                   slope(instruments.alpha), 1e-9, 'rad/s')
    yield Quantity("gamma' at 3 times", theory.gamma_rate(beta, *top.momenta, I1, I3),
                   slope(instruments.gamma), 1e-9, 'rad/s')
    yield Quantity(
        "beta'' at 3 times", theory.beta_acceleration(beta, *top.momenta, I1, Mgl),
        [run.derivative(instruments.beta_rate, time, window(run, top, time)) for time in times],
        1e-9, 'rad/s^2')
    many = run.states(np.linspace(0.0, 20.0 * times[-1], 301))
    energies = theory.energy(
        instruments.beta(many), instruments.beta_rate(many), *top.momenta, I1, I3, Mgl)
    yield Quantity(
        "E = I1 beta'^2/2 + V_eff at 301 times", np.full(301, top.E), energies, 1e-12, 'J')


def turning_points(run, top, half, span):
    """Yield the least and the greatest tilt and the time between them."""
    turns = run.crossings(instruments.beta_rate, 0.02 * half, span + 0.02 * half, 60 * SWINGS)
    tilts = run.read(instruments.beta, turns)
    predicted = theory.turning_points(top.E, *top.momenta, top.I1, top.I3, top.Mgl)
    yield Quantity(
        'least and greatest tilt, V_eff = E', predicted, [tilts.min(), tilts.max()], 1e-9, 'rad')
    yield Quantity('time between turning points (elliptic)', np.full(len(turns) - 1, half),
                   np.diff(turns), 1e-9, 's')


def at_equilibrium(run, top, half):
    """Yield the quantities where beta' is largest: V_eff is least there, at any amplitude."""
    I1, I3, Mgl, momenta = top.I1, top.I3, top.Mgl, top.momenta
    beta_0 = theory.equilibrium_tilt(*momenta, I1, Mgl)
    [time] = run.crossings(lambda s: instruments.beta(s) - beta_0, 0.0, half, 20)[:1]
    width = window(run, top, time)
    time = where_beta_rate_turns(run, time, width)
    states = run.states([time])
    beta, beta_rate = instruments.beta(states)[0], instruments.beta_rate(states)[0]
    yield Quantity("tilt at which beta' is largest: beta_0", beta_0, beta, 1e-9, 'rad')
    yield Quantity("least V_eff = E - I1 beta'^2/2 there",
                   theory.effective_potential(beta_0, *momenta, I1, I3, Mgl),
                   top.E - 0.5 * I1 * beta_rate**2, 1e-12, 'J')
    yield Quantity('cos(beta_0) in the quartic, over its scale', 0.0,
                   abs(np.polyval(theory.equilibrium_quartic(*momenta, I1, Mgl), np.cos(beta)))
                   / (top.P_alpha**2 + top.P_gamma**2 + I1 * Mgl),
                   1e-9, absolute=True)
    yield Quantity(
        "V_eff'' at beta_0", theory.curvature_at_equilibrium(beta_0, *momenta, I1, Mgl),
        -I1 * run.derivative(instruments.beta_rate, time, width, 2) / beta_rate, 1e-8, 'J/rad^2')
    yield Quantity("main precession alpha' at beta_0", theory.alpha_rate(beta_0, *momenta, I1),
                   instruments.alpha_rate(states)[0], 1e-9, 'rad/s')
    yield Quantity("variation of precession d alpha'/d beta at beta_0",
                   theory.precession_variation(beta_0, *momenta, I1),
                   run.derivative(instruments.alpha_rate, time, width) / beta_rate, 1e-9, '1/s')


def where_beta_rate_turns(run, near, width):
    """Return the time of the nearest extreme of beta', s."""
    for _ in range(4):
        near -= (run.derivative(instruments.beta_rate, near, width)
                 / run.derivative(instruments.beta_rate, near, width, 2))
    return near


def _curvature(run, top, time):
    """Yield V_eff'' off equilibrium; the notes' formula holds at equilibrium only."""
    states = run.states([time])
    beta, beta_rate = instruments.beta(states)[0], instruments.beta_rate(states)[0]
    measured = (-top.I1 * run.derivative(instruments.beta_rate, time, window(run, top, time), 2)
                / beta_rate)
    yield Quantity(
        f"V_eff'' off equilibrium, at {beta:.4f} rad",
        theory.curvature(beta, *top.momenta, top.I1, top.Mgl), measured, 1e-8, 'J/rad^2',
        as_written=theory.curvature_at_equilibrium(beta, *top.momenta, top.I1, top.Mgl))


def in_euler_angles(run, top, time):
    """Yield omega and T from differentiated Euler angles, and R and e3 from the angles."""
    states = run.states([time])
    angles = [angle(states)[0]
              for angle in (instruments.alpha, instruments.beta, instruments.gamma)]
    rates = [run.derivative(
                 lambda s, angle=angle: np.unwrap(angle(s)), time, window(run, top, time))
             for angle in (instruments.alpha, instruments.beta, instruments.gamma)]
    yield Quantity(
        'R = Rz(alpha) Ry(beta) Rz(gamma)', euler_angles.rotation_matrix(*angles).ravel(),
        instruments.axes(states).ravel(), 1e-14)
    e3 = instruments.axes(states)[0, :, 2]
    yield Quantity(
        'e3 in the world by its polar angles (beta, alpha)',
        euler_angles.axis_direction(angles[0], angles[1]),
        [np.arctan2(np.hypot(e3[0], e3[1]), e3[2]), np.arctan2(e3[1], e3[0])], 1e-13, 'rad')
    omega = states.angular_velocity[0]
    yield Quantity("omega from alpha', beta', gamma'",
                   euler_angles.body_rates(*rates, angles[1], angles[2]), omega, 1e-10, 'rad/s')
    T = 0.5 * (top.I1 * (omega[0] ** 2 + omega[1] ** 2) + top.I3 * omega[2] ** 2)
    yield Quantity(
        "T from alpha', beta', gamma'",
        euler_angles.kinetic_energy_symmetric(*rates, angles[1], top.I1, top.I3), T, 1e-10, 'J')


def small_nutation(run, top, rate):
    """Yield how the nutation frequency approaches its limit as the nutation becomes small.

    The top is in steady precession. `rate` is alpha' of that precession at the tilt and spin of
    the run; a push in beta changes neither p_alpha nor p_gamma.
    """
    tilt, Omega = top.beta, theory.nutation_frequency(top.beta, *top.momenta, top.I1, top.Mgl)
    ratios = []
    for small in SMALL:
        pushed = run.variant({
            'initial.euler_zyz': [0.0, tilt, 0.0],
            'initial.angular_velocity': [
                -rate * np.sin(tilt), small * Omega * tilt, top.P_gamma / top.I3]})
        rises = pushed.crossings(instruments.beta_rate, 0.1 / Omega,
                                 (SWINGS + 1.2) * 2.0 * np.pi / Omega, 60 * SWINGS, rising=True)
        ratios.append(2.0 * np.pi * (len(rises) - 1) / (rises[-1] - rises[0]) / Omega)
    yield from limit(
        "nutation sqrt(V_eff''/I1)", "the push in beta'", SMALL, ratios, 2, 0.05, 1e-8)
