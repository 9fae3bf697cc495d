# SPDX-License-Identifier: Apache-2.0
"""Internal dissipation: heat at constant L, on the way to rotation about the largest axis.

The double bracket of Bloch, Krishnaprasad, Marsden and Ratiu ("The Euler-Poincare equations and
double bracket dissipation", Commun. Math. Phys. 175, 1996): with m = I omega in body axes,

    m' = m x (omega + c m x omega),        T' = -c (m x omega)^2 <= 0,        (m^2)' = 0.

The momentum L = R m stays in the world when the axes turn with omega + c m x omega. `omega` means
I^-1 m everywhere, in states and in the energy; the axes' own rate differs from it by c m x omega,
the motion of the inner parts that make the heat.

A potential of the attitude, whose torque is Gamma, is part of the energy that falls: the extra
rate is u = c (m x omega + Gamma), along which T + U falls fastest at constant L, and the heat is
u^2/c.
"""

from dataclasses import dataclass
from typing import Any, ClassVar, Self

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.scene.bodies import Body
from rigid_body_sim.scene.constraints.protocol import Constraint, Mechanism
from rigid_body_sim.scene.effects.protocol import Acting, Effect
from rigid_body_sim.scene.frame import Frame
from rigid_body_sim.scene.schema import POSITIVE, described, mapping_of

ENDED = 2.0 ** -54    # rad


@dataclass(frozen=True)
class InternalDissipation(Effect):
    """``internal_dissipation: {coefficient: c}``; c in 1/(kg m^2/s), positive.

    Near the axis of the largest moment a wobble about axis i dies out at the rate
    c L^2 (1/I_i - 1/I_max), 1/s. At a pivot m and I are about the pivot: other effects may
    change L there, the dissipation does not.
    """

    coefficient: float
    name: ClassVar[str] = 'internal_dissipation'
    SCHEMA: ClassVar[dict] = described(mapping_of(
        ['coefficient'],
        coefficient=described(POSITIVE, 'c in 1/(kg m^2/s)')),
        "m' = m x (omega + u) + Gamma, the axes turn with omega + u, u = c (m x omega + "
        'Gamma of potentials): heat u^2/c at a constant L')
    mechanisms: ClassVar = (Mechanism.FREE, Mechanism.POINT)

    @classmethod
    def from_scene(cls, settings: dict[str, Any], body: Body, constraint: Constraint,
                   where: str) -> Self:
        """Return the effect of its settings in a scene file."""
        return cls(float(settings['coefficient']))

    @property
    def inner_dissipation(self) -> float:
        """The coefficient."""
        return self.coefficient

    def acting(self, frame: Frame, time: float) -> tuple[Acting, ...]:
        """Return the extra rate at which the axes turn; nothing for a sphere."""
        if len(set(frame.moments)) == 1:
            return ()
        values = self.coefficient, *frame.moments
        return Acting(f'{__name__}:turning', values, 'turning', 'heat',
                      polynomial=True),


@compiled
def turning(c, I1, I2, I3, qx, qy, qz, qw, wx, wy, wz, vx, vy, vz):
    """Return c m x omega, rad/s: component 1 is c (I2 - I3) omega2 omega3.

    The rest of a wobble (m within ENDED of its end, too small to show in the attitude) would keep
    the steps of a strong dissipation at 1/c for ever. So the rates fade out there, smoothly,
    because an abrupt end would make the steps chatter. A rate with a component of omega along an
    axis of the least moment fades with that component, which always decays; the others fade with
    the part of m across the axes of the largest moment.
    """
    m1, m2, m3 = I1 * wx, I2 * wy, I3 * wz
    s1, s2, s3 = m1 * m1, m2 * m2, m3 * m3
    most, least = max(I1, I2, I3), min(I1, I2, I3)
    across = (s1 if most > I1 else 0.0) + (s2 if most > I2 else 0.0) + (s3 if most > I3 else 0.0)
    along = (
        (s1 if least == I1 else 0.0) + (s2 if least == I2 else 0.0) + (s3 if least == I3 else 0.0))
    ended = ENDED * ENDED * (s1 + s2 + s3)
    free = c * (across / (across + ended)) if across > 0.0 else 0.0
    held = c * (along / (along + ended)) if along > 0.0 else 0.0
    return ((free if least == I1 else held) * (I2 - I3) * wy * wz,
            (free if least == I2 else held) * (I3 - I1) * wz * wx,
            (free if least == I3 else held) * (I1 - I2) * wx * wy)
