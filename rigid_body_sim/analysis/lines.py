# SPDX-License-Identifier: Apache-2.0
"""Spectral lines that theory predicts for a scene, from its first state."""

import math
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from rigid_body_sim.mechanics import parameters
from rigid_body_sim.scene.bodies import IDENTITY
from rigid_body_sim.scene.constraints.protocol import Mechanism
from rigid_body_sim.theory import asymmetric_top, heavy_top, kater_pendulum, symmetric_top


@dataclass(frozen=True)
class SpectralLine:
    """A frequency (Hz) of a periodic part of omega, in ``body`` or ``world`` axes.

    `source`: where it comes from; `components`: those of omega in which it shows.
    """

    name: str
    frequency: float
    axes: str
    source: str
    components: tuple = (0, 1, 2)


def predicted_lines(scene):
    """Return the SpectralLines of a scene; () where theory has none in closed form."""
    if scene is None or scene.weight is None or scene.strikes:
        return ()
    mechanism, g = scene.constraint.mechanism, scene.weight
    omega = scene.initial.angular_velocity
    if mechanism is Mechanism.FREE:
        return tuple(_free(scene.body.about_center, omega))
    if mechanism is Mechanism.POINT and not g:
        return tuple(_free(scene.constraint.inertia(scene.body), omega))
    if mechanism is Mechanism.POINT:
        return tuple(_heavy_top(scene, g, omega))
    if mechanism is Mechanism.AXIS and g:
        return tuple(_pendulum(scene, g))
    return ()


def _free(inertia, omega):
    order = np.argsort(inertia.moments)
    I1, I2, I3 = np.array(inertia.moments)[order]
    w1, w2, w3 = Rotation.from_quat(inertia.axes).inv().apply(omega)[order]
    if len({I1, I2, I3}) == 2:
        equal, distinct, along = (I1, I3, w3) if I1 == I2 else (I2, I1, w1)
        section = 'notes, Symmetric top (no gravity)'
        yield SpectralLine(
            'Ω = ω₃(I₃-I₁)/I₁',
            abs(symmetric_top.precession_rate(along, equal, distinct)) / math.tau,
            'body',
            section,
        )
        L = math.hypot(I1 * w1, I2 * w2, I3 * w3)
        yield SpectralLine(
            'L/I₁', symmetric_top.precession_rate_in_space(L, equal) / math.tau, 'world', section
        )
    elif seconds := asymmetric_top.time_between_flips((I1, I2, I3), (w1, w2, w3)):
        # odd harmonics in sn and cn, even ones in dn
        for harmonic in (1, 2, 3):
            yield SpectralLine(
                f'{harmonic}/T',
                0.5 * harmonic / seconds,
                'body',
                'Landau and Lifshitz, Mechanics, section 37',
            )


def _heavy_top(scene, g, omega):
    """Return nutation and precession of a body with its centre of mass on its third axis.

    Nutation shows in the vertical part of omega, precession in the horizontal one.
    """
    body = scene.body
    inertia = scene.constraint.inertia(body)
    I1, I2, I3 = inertia.moments
    x, y, l = scene.constraint.arm(body)
    if I1 != I2 or x or y or not l or inertia.axes != IDENTITY:
        return
    up = Rotation.from_quat(scene.initial.orientation).inv().apply([0.0, 0.0, 1.0])
    top = (omega, up, I1, I3, body.mass * g * l)
    section = 'notes, Symmetric Top: the motion in V_eff'
    half, precession = heavy_top.time_between_turning_points(*top), heavy_top.mean_precession(*top)
    if half and precession is not None:
        yield SpectralLine('nutation', 0.5 / half, 'world', section, (2,))
    if precession:
        yield SpectralLine('precession', abs(precession) / math.tau, 'world', section, (0, 1))


def _pendulum(scene, g):
    """Return the frequency of a pendulum: its period is 4 K(k) sqrt(I/(M g l)), k = sin(a/2).

    a is the amplitude. The axis may be inclined; l sin(inclination) counts then.
    """
    body, constraint = scene.body, scene.constraint
    attitude, n = Rotation.from_quat(scene.initial.orientation), np.array(constraint.axis)
    arm = np.array(constraint.arm(body))
    across = arm - (arm @ n) * n
    Mgl = body.mass * g * np.linalg.norm(across) * np.linalg.norm(attitude.apply(n)[:2])
    moment, rate = (
        parameters.moment_about_hinge(body, constraint),
        scene.initial.angular_velocity @ n,
    )
    if Mgl > 0.0:
        k2 = (0.5 * moment * rate * rate + body.mass * g * attitude.apply(across)[2] + Mgl) / (
            2.0 * Mgl
        )
        if 0.0 < k2 < 1.0:
            seconds = kater_pendulum.period(
                math.sqrt(Mgl / moment), 2.0 * math.asin(math.sqrt(k2))
            )
            yield SpectralLine(
                '1/T',
                1.0 / seconds,
                'body',
                'physical pendulum at this amplitude, T = 4 K(k) sqrt(I/(M g l))',
            )
