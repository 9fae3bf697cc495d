# SPDX-License-Identifier: Apache-2.0
"""Gravity gradient: the torque of a distant body, which attracts the near side most."""

from dataclasses import dataclass
from typing import Any, ClassVar, Self

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.errors import BadInput
from rigid_body_sim.numerics.functions import hypot3, sin_cos
from rigid_body_sim.numerics.rotations import rotate_back
from rigid_body_sim.numerics.vectors import apply, cross, dot, plus, scaled
from rigid_body_sim.scene.bodies import Body
from rigid_body_sim.scene.constraints.protocol import Constraint, Mechanism
from rigid_body_sim.scene.effects.protocol import (
    Acting,
    Bounds,
    Effect,
    Formulas,
    Potential,
    Pull,
)
from rigid_body_sim.scene.effects.shares import share_of_least
from rigid_body_sim.scene.expressions import actions, tree, vectors
from rigid_body_sim.scene.expressions.source import TIME
from rigid_body_sim.scene.frame import Frame
from rigid_body_sim.scene.schema import POSITIVE, VECTOR, described, mapping_of

SQUARE = 1e-9    # rad: a deviation from a right angle that counts as rounding


@dataclass(frozen=True)
class GravityGradient(Effect):
    """``gravity_gradient: {mu: 3.986e14, position: [7.0e6, 0, 0]}``.

    The centre of mass is at `position` (m, world axes) from a point that attracts with mu = G M
    (m^3/s^2). To first order in the size of the body

        U = (3 mu/(2 r^3)) n . I n,    Gamma = (3 mu/r^3) n x I n

    with n the direction of the position and I the tensor about the centre of mass (Hughes,
    Spacecraft Attitude Dynamics, section 8.1). It turns the body and does not move it.

    ``gravity_gradient: {orbit: {rate: n, normal: [x, y, z], toward: [x, y, z]}}`` is for a
    circular orbit: n turns with the rate (rad/s) about `normal` (world axes), beginning along
    `toward` (square to it), and mu/r^3 = rate^2. The power of the orbit is booked as work.
    """

    energy: tree.Term | None    # None on an orbit
    share: float
    toward: tuple[float, ...]
    most: float
    ahead: tuple[float, ...] = (0.0, 0.0, 0.0)
    rate: float = 0.0
    tensor: tuple[tuple[float, ...], ...] | None = None    # where the frame's axes are not its own
    name: ClassVar[str] = 'gravity_gradient'
    SCHEMA: ClassVar[dict] = described(mapping_of(
        mu=described(POSITIVE, 'G M in m^3/s^2'),
        position=described(
            VECTOR, 'm, of the centre of mass from the attracting point, world axes'),
        orbit=described(
            mapping_of(['rate', 'normal', 'toward'], rate=POSITIVE, normal=VECTOR, toward=VECTOR),
            'in place of mu and position: n turns with rate (rad/s) about normal from toward on, '
            'world axes; mu/r^3 = rate^2')),
        'Gamma = (3 mu/r^3) n x I n about the centre of mass, n = position/r; booked as '
        'potential, on an orbit as work')
    mechanisms: ClassVar = (Mechanism.FREE, Mechanism.PLANE)

    @classmethod
    def from_scene(cls, settings: dict[str, Any], body: Body, constraint: Constraint,
                   where: str) -> Self:
        """Return the effect of its settings in a scene file."""
        rows = tuple(map(tuple, body.about_center.matrix.tolist()))
        tensor = rows if constraint.mechanism is Mechanism.PLANE else None
        if 'orbit' in settings:
            return cls._on_orbit(settings, body, f'{where}.orbit', tensor)
        for key in ('mu', 'position'):
            if key not in settings:
                raise BadInput(where, f'the key {key!r} is missing',
                               'needed: mu and position, or orbit')
        place = tuple(map(float, settings['position']))
        r = hypot3(*place)
        if not r > 0.0:
            raise BadInput(f'{where}.position', f'got {settings["position"]}',
                           'a place that is not the attracting point itself')
        share = 1.5 * (float(settings['mu']) / r / r / r)
        n = vectors.to_body(vectors.constant(scaled(1.0 / r, place)))
        pulled = tuple(vectors.dot(vectors.constant(row), n) for row in rows)
        energy = tree.times(tree.number(share), vectors.dot(n, pulled))
        return cls(energy, 2.0 * share, scaled(1.0 / r, place),
                   share * (max(body.about_center.moments) - min(body.about_center.moments)),
                   tensor=tensor)

    @classmethod
    def _on_orbit(cls, settings, body, where, tensor):
        """Return the effect on a circular orbit."""
        if len(settings) > 1:
            raise BadInput(where, 'is given together with mu or position', 'give one of the two')
        orbit = settings['orbit']
        rate = float(orbit['rate'])
        unit = []
        for key in ('normal', 'toward'):
            vector = tuple(map(float, orbit[key]))
            size = hypot3(*vector)
            if not size > 0.0:
                raise BadInput(f'{where}.{key}', f'got {orbit[key]}', 'a direction')
            unit.append(scaled(1.0 / size, vector))
        normal, toward = unit
        if abs(dot(normal, toward)) > SQUARE:
            raise BadInput(f'{where}.toward', f'got {orbit["toward"]}',
                           'a direction perpendicular to normal')
        share = 1.5 * rate * rate
        return cls(None, 2.0 * share, toward,
                   share * (max(body.about_center.moments) - min(body.about_center.moments)),
                   cross(normal, toward), rate, tensor)

    def acting(self, frame: Frame, time: float) -> tuple[Acting, ...]:
        """Return the torque."""
        pulled = self._differences(frame)
        if not any(pulled):
            return ()
        if self.tensor is not None:
            values = *(self.share * one for row in self.tensor for one in row), *self.toward
            if self.energy is None:
                return Acting(f'{__name__}:tensor_torque_on_orbit',
                              (*values, *self.ahead, self.rate), 'torque', 'work', in_field=True,
                              timed=True),
            return Acting(f'{__name__}:tensor_torque', values, 'torque', 'potential',
                          polynomial=True),
        if self.energy is None:
            values = *pulled, *self.toward, *self.ahead, self.rate
            return Acting(f'{__name__}:torque_on_orbit', values, 'torque', 'work', in_field=True,
                          timed=True),
        return Acting(f'{__name__}:torque', (*pulled, *self.toward), 'torque', 'potential',
                      polynomial=True),

    def _differences(self, frame: Frame) -> tuple[float, float, float]:
        """Return a, b, c of the torque (a n2 n3, b n3 n1, c n1 n2), N m."""
        a, b, c = (self.share * (0.0 - difference) for difference in frame.differences)
        return a, b, c

    def series(self, frame: Frame, time: float) -> Pull:
        """Return the torque."""
        n = vectors.constant(self.toward)
        if self.energy is None:
            turned = tree.times(tree.number(self.rate), tree.term('name', *TIME))
            n = vectors.total(vectors.scaled(tree.term('cos', turned), n), vectors.scaled(
                tree.term('sin', turned), vectors.constant(self.ahead)))
        n1, n2, n3 = vectors.to_body(n)
        torque = map(tree.times, vectors.constant(self._differences(frame)),
                     (tree.times(n2, n3), tree.times(n3, n1), tree.times(n1, n2)))
        return Pull(formulas=(Formulas(tuple(torque), of_frame=True),))

    @property
    def potential(self):
        """The energy; None on an orbit, where it depends on time."""
        return None if self.energy is None else self._potential

    def _potential(self, frame: Frame) -> Potential:
        assert self.energy is not None    # or there is no such view
        return actions.potential(self.energy, (), frame)

    def bounds(self, body: Body, constraint: Constraint) -> Bounds:
        """Return half of what the energy can change by, and the torque on an orbit."""
        if self.energy is not None:
            return Bounds(0.5 * self.most, 0.0)
        I1, I2, I3 = moments = body.about_center.moments
        share = share_of_least((I2 - I3, I3 - I1, I1 - I2), moments, max(moments) - min(moments))
        return Bounds(0.5 * self.most, self.most, share=share)


@compiled
def torque(a, b, c, ux, uy, uz, qx, qy, qz, qw, wx, wy, wz, vx, vy, vz):
    """Return (a n2 n3, b n3 n1, c n1 n2) with n = R^T u (N m, frame components).

    The differences of the moments in a, b, c are those of the numbers given: a slim body gets no
    torque about its axis from terms that cancel.
    """
    nx, ny, nz = rotate_back(qx, qy, qz, qw, ux, uy, uz)
    return a * (ny * nz), b * (nz * nx), c * (nx * ny)


@compiled
def torque_on_orbit(a, b, c, ux, uy, uz, vx_, vy_, vz_, rate,
                    qx, qy, qz, qw, wx, wy, wz, vx, vy, vz, t, x, y, z):
    """Return the torque with n = R^T (u cos(rate t) + v sin(rate t)), v a quarter turn ahead."""
    sine, cosine = sin_cos(rate * t)
    nx, ny, nz = rotate_back(qx, qy, qz, qw, *plus(scaled(cosine, (ux, uy, uz)),
                                                   scaled(sine, (vx_, vy_, vz_))))
    return a * (ny * nz), b * (nz * nx), c * (nx * ny)


@compiled
def tensor_torque(xx, xy, xz, yx, yy, yz, zx, zy, zz, ux, uy, uz,
                  qx, qy, qz, qw, wx, wy, wz, vx, vy, vz):
    """Return n x I n with n = R^T u (N m, frame components); the share is in the tensor."""
    n = rotate_back(qx, qy, qz, qw, ux, uy, uz)
    return cross(n, apply(((xx, xy, xz), (yx, yy, yz), (zx, zy, zz)), n))


@compiled
def tensor_torque_on_orbit(xx, xy, xz, yx, yy, yz, zx, zy, zz, ux, uy, uz, vx_, vy_, vz_, rate,
                           qx, qy, qz, qw, wx, wy, wz, vx, vy, vz, t, x, y, z):
    """Return that torque with n = R^T (u cos(rate t) + v sin(rate t)), v a quarter turn ahead."""
    sine, cosine = sin_cos(rate * t)
    n = rotate_back(qx, qy, qz, qw, *plus(scaled(cosine, (ux, uy, uz)),
                                          scaled(sine, (vx_, vy_, vz_))))
    return cross(n, apply(((xx, xy, xz), (yx, yy, yz), (zx, zy, zz)), n))
