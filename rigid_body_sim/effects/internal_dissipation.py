"""Internal dissipation: heat at constant angular momentum, on the way to rotation about the largest axis.

The double bracket of Bloch, Krishnaprasad, Marsden and Ratiu ("The Euler-Poincare equations and double bracket dissipation", Commun.
Math. Phys. 175, 1996): with m = I omega in body axes,

    m' = m x (omega + c m x omega),        T' = -c (m x omega)^2 <= 0,        (m^2)' = 0.

The momentum L = R m stays in the world when the axes turn with omega + c m x omega. `omega` means I^-1 m everywhere, in states and in the
energy; the axes' own rate differs from it by c m x omega, the motion of the inner parts that make the heat.
"""

import math
from dataclasses import dataclass
from typing import ClassVar

from rigid_body_sim.compiled import compiled
from rigid_body_sim.effects.views import Acting

ENDED = 2.0 ** -54    # rad


@dataclass(frozen=True)
class InternalDissipation:
    """``internal_dissipation: {coefficient: c}``; c in 1/(kg m^2/s), positive.

    Near the axis of the largest moment a wobble about axis i dies out at the rate c L^2 (1/I_i - 1/I_max), 1/s. Free bodies only: at a
    pivot the momentum about it is not the body's own.
    """

    coefficient: float
    name: ClassVar = 'internal_dissipation'
    SCHEMA: ClassVar = {
        'type': 'object', 'properties': {'coefficient': {'type': 'number', 'exclusiveMinimum': 0}}, 'required': ['coefficient'],
        'additionalProperties': False}
    constraints: ClassVar = ('free',)
    repeatable: ClassVar = False
    breakpoints: ClassVar = ()

    @classmethod
    def from_scene(cls, mapping, body, constraint, where):
        """Make it of its mapping in a scene file."""
        return cls(float(mapping['coefficient']))

    def acting(self, frame, time):
        """View `rate`: the extra rate at which the axes turn."""
        return Acting(f'{__name__}:turning', (self.coefficient, *frame.moments), 'turning', 'heat'),


@compiled
def turning(c, I1, I2, I3, qx, qy, qz, qw, wx, wy, wz, vx, vy, vz):
    """Return c m x omega, rad/s: component 1 is c (I2 - I3) omega2 omega3.

    At the end state (m within ENDED of the largest axis, less than the attitude can show) it is 0: what is left there would only keep the
    steps of a strong dissipation at 1/c for ever.
    """
    m1, m2, m3 = I1 * wx, I2 * wy, I3 * wz
    most = max(I1, I2, I3)
    across = (m1 * m1 if most > I1 else 0.0) + (m2 * m2 if most > I2 else 0.0) + (m3 * m3 if most > I3 else 0.0)
    if across <= ENDED * ENDED * (m1 * m1 + m2 * m2 + m3 * m3):
        return 0.0, 0.0, 0.0
    return c * (I2 - I3) * wy * wz, c * (I3 - I1) * wz * wx, c * (I1 - I2) * wx * wy


@compiled
def relaxed(c, I1, I2, I3, time, m1, m2, m3):
    """Return m after the dissipation alone has acted for a time: exact.

    m' = c m x (m x omega) = c (2 T m - m^2 I^-1 m) is the gradient flow of T on the sphere of constant m^2; its solution is
    m(t) = |m| u/|u|, u_i = m_i exp(-c m^2 (1/I_i - 1/I_last) t), I_last the largest moment among the axes with m_i != 0 (so that u never
    vanishes altogether). A component of zero moment is zero and stays.
    """
    square = m1 * m1 + m2 * m2 + m3 * m3
    last = max(I1 if m1 != 0.0 else 0.0, I2 if m2 != 0.0 else 0.0, I3 if m3 != 0.0 else 0.0)
    slowest = 1.0 / last if last > 0.0 else 0.0
    rate = c * square * time
    u1 = m1 * math.exp(-rate * (1.0 / I1 - slowest)) if I1 > 0.0 else 0.0
    u2 = m2 * math.exp(-rate * (1.0 / I2 - slowest)) if I2 > 0.0 else 0.0
    u3 = m3 * math.exp(-rate * (1.0 / I3 - slowest)) if I3 > 0.0 else 0.0
    norm = math.sqrt(u1 * u1 + u2 * u2 + u3 * u3)
    scale = math.sqrt(square) / norm if norm > 0.0 else 0.0
    return u1 * scale, u2 * scale, u3 * scale
