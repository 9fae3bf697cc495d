"""Spectral lines that theory predicts for a scene, from its first state."""

import math
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation
from scipy.special import ellipk

from rigid_body_sim import mechanics
from rigid_body_sim.theory import fast_top, symmetric_top

SLOW_ENOUGH = 0.05
"""Up to this I1 M g l/P_gamma^2 a top is a fast top."""


@dataclass(frozen=True)
class SpectralLine:
    """A frequency (Hz) at which something periodic is to be found in omega, in ``body`` or ``world`` axes; `source`: where it comes from."""

    name: str
    frequency: float
    axes: str
    source: str


def predicted_lines(scene):
    """Return the SpectralLines of a scene; () where theory has none in closed form."""
    if scene is None or any(effect.name != 'gravity' for effect in scene.effects):
        return ()
    kind, gravity = scene.constraint.kind, scene.effect('gravity')
    omega = scene.initial.angular_velocity
    if kind == 'free':
        return tuple(_free(scene.body.about_center, omega))
    if kind == 'pivot' and not gravity:
        return tuple(_free(scene.body.about_origin, omega))
    if kind == 'pivot':
        return tuple(_fast_top(scene, gravity.g, omega))
    if kind == 'hinge' and gravity:
        return tuple(_pendulum(scene, gravity.g))
    return ()


def _free(inertia, omega):
    order = np.argsort(inertia.moments)
    I1, I2, I3 = np.array(inertia.moments)[order]
    w1, w2, w3 = Rotation.from_quat(inertia.axes).inv().apply(omega)[order]
    L = math.hypot(I1 * w1, I2 * w2, I3 * w3)
    if len({I1, I2, I3}) == 2:
        equal, distinct, along = (I1, I3, w3) if I1 == I2 else (I2, I1, w1)
        section = 'notes, Symmetric top (no gravity)'
        yield SpectralLine('Ω = ω₃(I₃-I₁)/I₁', abs(symmetric_top.precession_rate(along, equal, distinct)) / math.tau, 'body', section)
        yield SpectralLine('L/I₁', symmetric_top.precession_rate_in_space(L, equal) / math.tau, 'world', section)
    elif len({I1, I2, I3}) == 3 and I1 > 0.0:
        yield from _asymmetric(I1, I2, I3, w1, w2, w3)


def _asymmetric(I1, I2, I3, w1, w2, w3):
    """Period of omega in the body, T = 4 K(k)/p (Landau and Lifshitz, Mechanics, section 37): odd harmonics in sn and cn, even ones in dn."""
    low = I2 * (I2 - I1) * w2 * w2 + I3 * (I3 - I1) * w3 * w3       # L^2 - 2 E I1
    high = I1 * (I3 - I1) * w1 * w1 + I2 * (I3 - I2) * w2 * w2      # 2 E I3 - L^2
    about_smallest, about_largest = (I2 - I1) * high, (I3 - I2) * low
    large, small = max(about_smallest, about_largest), min(about_smallest, about_largest)
    if 0.0 < small < large:
        frequency = math.sqrt(large / (I1 * I2 * I3)) / (4.0 * ellipk(small / large))
        for harmonic in (1, 2, 3):
            yield SpectralLine(f'{harmonic}/T', harmonic * frequency, 'body', 'Landau and Lifshitz, Mechanics, section 37')


def _fast_top(scene, g, omega):
    body = scene.body
    I1, I2, I3 = body.about_origin.moments
    x, y, l = body.center_of_mass
    if x == y == 0.0 < l and I1 == I2 and omega[2] != 0.0:
        P_gamma, Mgl, section = abs(I3 * omega[2]), body.mass * g * l, 'notes, Fast top: P_gamma/I1 and M g l/P_gamma'
        if fast_top.slowness(P_gamma, I1, Mgl) <= SLOW_ENOUGH:
            yield SpectralLine('nutation', fast_top.nutation_frequency(P_gamma, I1) / math.tau, 'world', section)
            yield SpectralLine('precession', fast_top.precession_rate(P_gamma, Mgl) / math.tau, 'world', section)


def _pendulum(scene, g):
    """Period 4 K(k) sqrt(I/(M g l)), k = sin(amplitude/2), of a pendulum whose axis may be inclined; l sin(inclination) counts then."""
    body, constraint = scene.body, scene.constraint
    attitude, n = Rotation.from_quat(scene.initial.orientation), np.array(constraint.axis)
    arm = np.subtract(body.center_of_mass, constraint.through)
    across = arm - (arm @ n) * n
    Mgl = body.mass * g * np.linalg.norm(across) * np.linalg.norm(attitude.apply(n)[:2])
    moment, rate = mechanics.moment_about_hinge(body, constraint), scene.initial.angular_velocity @ n
    if Mgl > 0.0:
        k2 = (0.5 * moment * rate * rate + body.mass * g * attitude.apply(across)[2] + Mgl) / (2.0 * Mgl)
        if 0.0 < k2 < 1.0:
            frequency = math.sqrt(Mgl / moment) / (4.0 * ellipk(k2))
            yield SpectralLine('1/T', frequency, 'body', 'physical pendulum at this amplitude, T = 4 K(k) sqrt(I/(M g l))')
