# SPDX-License-Identifier: Apache-2.0
"""Drag: resistance in proportion to velocity (creeping flow; Stokes's law), or to its square."""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.errors import BadInput
from rigid_body_sim.numerics.functions import hypot3
from rigid_body_sim.numerics.rotations import rotate, rotate_back
from rigid_body_sim.numerics.vectors import apply, cross, plus, scaled, transposed
from rigid_body_sim.scene.bodies import Body
from rigid_body_sim.scene.constraints.protocol import Constraint, Mechanism
from rigid_body_sim.scene.effects.protocol import Acting, Effect, Formulas, Pull
from rigid_body_sim.scene.expressions import formulas, tree, vectors
from rigid_body_sim.scene.expressions.source import RATES, VELOCITY
from rigid_body_sim.scene.frame import Frame
from rigid_body_sim.scene.schema import MATRIX, described, mapping_of

COEFFICIENT = {**MATRIX, 'type': ['number', 'array'], 'minimum': 0}
KEYS = 'linear', 'angular', 'quadratic', 'angular_quadratic'
SHAPED = 'a number or a symmetric matrix in body axes'
SYMMETRY = 1e-12    # asymmetry, relative to the size of a matrix, that counts as rounding


@dataclass(frozen=True)
class Drag(Effect):
    """``drag: {linear: c, angular: k}``; either may be left out (0).

    With a matrix, or with drag in proportion to squares, it is a :class:`ShapedDrag`.

    F = -c v at the centre of mass (c in N s/m = kg/s, v its velocity) and the couple -k omega (k
    in N m s). At a pivot or hinge F acts by its torque about the constraint. It does not act on
    the table, where rolling resistance would be another effect.
    """

    linear: float
    angular: float
    name: ClassVar[str] = 'drag'
    SCHEMA: ClassVar[dict] = described(mapping_of(
        linear=described(COEFFICIENT, f'C in N s/m, {SHAPED}', 0),
        angular=described(COEFFICIENT, f'K in N m s, {SHAPED}', 0),
        quadratic=described(COEFFICIENT, f'D in N s^2/m^2, {SHAPED}', 0),
        angular_quadratic=described(COEFFICIENT, f'Q in N m s^2, {SHAPED}', 0)),
        'F = -(C + |v| D) v at the centre of mass, Gamma = -(K + |omega| Q) omega; '
        'booked as heat')
    mechanisms: ClassVar = (Mechanism.FREE, Mechanism.POINT, Mechanism.AXIS, Mechanism.PLANE)

    @classmethod
    def from_scene(cls, settings: dict[str, Any], body: Body, constraint: Constraint,
                   where: str) -> Effect:
        """Return the effect of its settings in a scene file; it needs a coefficient."""
        if not settings:
            raise BadInput(where, 'no coefficient', 'give linear (N s/m), angular (N m s), '
                           'quadratic (N s^2/m^2), angular_quadratic (N m s^2), or some of them')
        if set(settings) - {'linear', 'angular'} or any(
                isinstance(value, list) for value in settings.values()):
            return ShapedDrag.from_scene(settings, body, constraint, where)
        return cls(float(settings.get('linear', 0.0)), float(settings.get('angular', 0.0)))

    def acting(self, frame: Frame, time: float) -> tuple[Acting, ...]:
        """Return force and couple; a coefficient of zero does not act."""
        if frame.path is not None:    # the kernels of a shape know a moving pivot
            return self._shaped.acting(frame, time)
        acting = []
        if self.linear and frame.moves:
            acting.append(Acting(f'{__name__}:force', (self.linear,), 'force', 'heat',
                                 polynomial=True))
        elif self.linear and any(frame.arm):
            values = self.linear, *frame.arm
            acting.append(Acting(f'{__name__}:moment', values, 'torque', 'heat', polynomial=True))
        if self.angular:
            acting.append(Acting(f'{__name__}:couple', (self.angular,), 'torque', 'heat',
                                 polynomial=True))
        return tuple(acting)

    @property
    def _shaped(self) -> 'ShapedDrag':
        return ShapedDrag(*(_matrix(c, '') for c in (self.linear, self.angular, 0.0, 0.0)))

    def series(self, frame: Frame, time: float) -> Pull:
        """Return the couple, and the force as a moment about a bearing or as it slows a flight."""
        if frame.path is not None:
            return self._shaped.series(frame, time)
        (x, y, z), a, c = frame.arm, self.angular, self.linear
        # the matrices of the kernels `couple` and `moment`, without the difference r^2 - z^2
        xy, yz, zx = c * (x * y), c * (y * z), c * (x * z)
        drag = ((-a - c * (y * y + z * z), xy, zx),
                (xy, -a - c * (z * z + x * x), yz),
                (zx, yz, -a - c * (x * x + y * y)))
        return Pull(drag=drag if any(map(any, drag)) else None,
                    slowing=self.linear if frame.moves else 0.0)

    def damping(self, frame: Frame) -> Pull:
        """Return the same; a moving pivot changes nothing of it."""
        return self.series(frame, 0.0) if frame.path is None else self._shaped.damping(frame)


Matrix = tuple[tuple[float, ...], ...]


def _matrix(value, where: str) -> Matrix:
    """Return a coefficient as a matrix; BadInput unless it takes energy from every motion."""
    if not isinstance(value, list):
        c = float(value)
        return (c, 0.0, 0.0), (0.0, c, 0.0), (0.0, 0.0, c)
    rows = np.array(value, dtype=float)
    size = np.abs(rows).max()
    if np.abs(rows - rows.T).max() > SYMMETRY * size:
        raise BadInput(where, f'got {value}, which is not symmetric',
                       'a symmetric matrix, or a force in expressions for the rest')
    (a, b, c), (_, d, e), (_, _, f) = rows
    minors = a * d - b * b, a * f - c * c, d * f - e * e
    third = a * (d * f - e * e) - b * (b * f - c * e) + c * (b * e - c * d)
    slack = SYMMETRY * size
    if (min(a, d, f) < -slack or min(minors) < -slack * size
            or third < -slack * size * size):
        raise BadInput(where, f'got {value}, which drives some motions',
                       'a matrix that is positive semidefinite: drag takes energy')
    return tuple(tuple(0.5 * (rows[i] + rows[:, i])) for i in range(3))


def _rows(matrix: Matrix, frame: Frame) -> Matrix:
    """Return the rows of a matrix given in body axes by its components in the frame."""
    columns = [frame.from_body(row) for row in matrix]
    return tuple(frame.from_body(column) for column in transposed(tuple(columns)))


def _flat(matrix: Matrix, frame: Frame) -> tuple[float, ...]:
    """Return the nine components in the frame of a matrix given in body axes."""
    return tuple(part for row in _rows(matrix, frame) for part in row)


@dataclass(frozen=True)
class ShapedDrag(Effect):
    """``drag: {linear: C, angular: K, quadratic: D, angular_quadratic: Q}``, numbers or matrices.

    In body axes, with v the velocity of the centre of mass and omega:

        F = -(C + |v| D) v,    Gamma = -(K + |omega| Q) omega

    A number is that times the identity. C is in N s/m, D in N s^2/m^2, K in N m s, Q in N m s^2;
    matrices are symmetric and positive semidefinite. At a pivot or hinge F acts by its torque.
    """

    linear: Matrix
    angular: Matrix
    quadratic: Matrix
    angular_quadratic: Matrix
    name: ClassVar[str] = 'drag'
    SCHEMA: ClassVar[dict] = Drag.SCHEMA
    mechanisms: ClassVar = Drag.mechanisms

    @classmethod
    def from_scene(cls, settings: dict[str, Any], body: Body, constraint: Constraint,
                   where: str) -> Effect:
        """Return the effect of its settings in a scene file; a Drag where it acts as one."""
        shaped = cls(*(_matrix(settings.get(key, 0.0), f'{where}.{key}') for key in KEYS))
        squares = *shaped.quadratic, *shaped.angular_quadratic
        if any(map(any, squares)) or not (_is_number(shaped.linear)
                                          and _is_number(shaped.angular)):
            return shaped
        return Drag(shaped.linear[0][0], shaped.angular[0][0])

    def acting(self, frame: Frame, time: float) -> tuple[Acting, ...]:
        """Return force and couple; zero ones are left out."""
        acting = []
        for matrix, square in ((self.linear, 0.0), (self.quadratic, 1.0)):
            if not any(map(any, matrix)):
                continue
            values = square, *_flat(matrix, frame)
            rooted = square == 1.0
            if frame.path is not None:
                values = *values, *frame.arm
                acting += [Acting(f'{__name__}:carried_force', values, 'force', 'heat',
                                  rooted=rooted, polynomial=not rooted),
                           Acting(f'{__name__}:carried_moment', values, 'torque', 'heat',
                                  rooted=rooted, polynomial=not rooted)]
            elif frame.moves:
                acting.append(Acting(f'{__name__}:shaped_force', values, 'force', 'heat',
                                     rooted=rooted, polynomial=not rooted))
            elif any(frame.arm):
                acting.append(Acting(f'{__name__}:shaped_moment', (*values, *frame.arm),
                                     'torque', 'heat', rooted=rooted, polynomial=not rooted))
        for matrix, square in ((self.angular, 0.0), (self.angular_quadratic, 1.0)):
            if any(map(any, matrix)):
                values, rooted = (square, *_flat(matrix, frame)), square == 1.0
                acting.append(Acting(f'{__name__}:shaped_couple', values, 'torque', 'heat',
                                     rooted=rooted, polynomial=not rooted))
        return tuple(acting)

    def series(self, frame: Frame, time: float) -> Pull:
        """Return force and couple."""
        omega, v = vectors.named(RATES), vectors.named(VELOCITY)
        torque = _resisted(self.angular, self.angular_quadratic, omega, frame)
        if frame.moves and _is_number(self.linear) and _is_number(self.quadratic):
            force = _resisted(self.linear, self.quadratic, v)    # in world axes: shorter
            return Pull(formulas=(Formulas(torque, force, of_frame=True),))
        arm, v = vectors.constant(frame.arm), vectors.to_body(v)
        if not frame.moves:
            carried = vectors.cross(omega, arm)
            v = carried if frame.path is None else vectors.total(v, carried)
        force = _resisted(self.linear, self.quadratic, v, frame)
        if frame.moves:
            return Pull(formulas=(Formulas(torque, vectors.to_world(force), of_frame=True),))
        torque = vectors.total(torque, vectors.cross(arm, force))
        return Pull(formulas=(Formulas(torque, of_frame=True),))

    def damping(self, frame: Frame) -> Pull:
        """Return the part in proportion to velocity; of a flight only a scalar drag."""
        angular, linear = _rows(self.angular, frame), _rows(self.linear, frame)
        columns = []
        for omega in np.eye(3).tolist():
            against = apply(angular, omega)
            if not frame.moves:
                force = apply(linear, cross(omega, frame.arm))
                against = plus(against, cross(frame.arm, force))
            columns.append(against)
        matrix = -0.5 * (np.array(columns) + np.array(columns).T)
        first, second, third = matrix.tolist()
        return Pull(drag=(tuple(first), tuple(second), tuple(third)) if matrix.any() else None,
                    slowing=linear[0][0] if frame.moves and _is_number(self.linear) else 0.0)


def _is_number(matrix: Matrix) -> bool:
    """Return whether a matrix is a number times the identity."""
    return matrix == _matrix(matrix[0][0], '')


def _resisted(linear, square, v, frame=None):
    """Return -(C + |v| D) v, trees, for matrices in body axes and v along the frame's."""
    def times_v(matrix):
        if not any(map(any, matrix)):
            return formulas.NONE
        if _is_number(matrix):
            return vectors.scaled(tree.number(-matrix[0][0]), v)
        three = iter(_flat(matrix, frame))
        rows = zip(three, three, three, strict=True)
        return tuple(map(tree.negative, vectors.apply(rows, v)))
    by_square = times_v(square)
    if by_square is not formulas.NONE:
        by_square = vectors.scaled(tree.term('sqrt', vectors.dot(v, v)), by_square)
    return vectors.total(times_v(linear), by_square)


@compiled
def shaped(square, a, b, c, d, e, f, g, h, i, v):
    """Return -C v, or -|v| C v where square is 1, for a vector along the axes of C."""
    pace = hypot3(v[0], v[1], v[2]) if square == 1.0 else 1.0
    return scaled(-pace, apply(((a, b, c), (d, e, f), (g, h, i)), v))


@compiled
def shaped_force(square, a, b, c, d, e, f, g, h, i, qx, qy, qz, qw, wx, wy, wz, vx, vy, vz):
    """Return the force, N, world components."""
    v = rotate_back(qx, qy, qz, qw, vx, vy, vz)
    return rotate(qx, qy, qz, qw, *shaped(square, a, b, c, d, e, f, g, h, i, v))


@compiled
def shaped_couple(square, a, b, c, d, e, f, g, h, i, qx, qy, qz, qw, wx, wy, wz, vx, vy, vz):
    """Return the couple, N m."""
    return shaped(square, a, b, c, d, e, f, g, h, i, (wx, wy, wz))


@compiled
def shaped_moment(square, a, b, c, d, e, f, g, h, i, rx, ry, rz,
                  qx, qy, qz, qw, wx, wy, wz, vx, vy, vz):
    """Return r x F for the velocity omega x r, N m."""
    v = cross((wx, wy, wz), (rx, ry, rz))
    return cross((rx, ry, rz), shaped(square, a, b, c, d, e, f, g, h, i, v))


@compiled
def carried_force(square, a, b, c, d, e, f, g, h, i, rx, ry, rz,
                  qx, qy, qz, qw, wx, wy, wz, vx, vy, vz):
    """Return the force at r from a pivot with the velocity v, N, world components."""
    of_center = plus(rotate_back(qx, qy, qz, qw, vx, vy, vz),
                     cross((wx, wy, wz), (rx, ry, rz)))
    return rotate(qx, qy, qz, qw, *shaped(square, a, b, c, d, e, f, g, h, i, of_center))


@compiled
def carried_moment(square, a, b, c, d, e, f, g, h, i, rx, ry, rz,
                   qx, qy, qz, qw, wx, wy, wz, vx, vy, vz):
    """Return the moment of that force about the pivot, N m."""
    of_center = plus(rotate_back(qx, qy, qz, qw, vx, vy, vz),
                     cross((wx, wy, wz), (rx, ry, rz)))
    return cross((rx, ry, rz), shaped(square, a, b, c, d, e, f, g, h, i, of_center))


@compiled
def force(c, qx, qy, qz, qw, wx, wy, wz, vx, vy, vz):
    """Return -c v, N, world components."""
    return -c * vx, -c * vy, -c * vz


@compiled
def couple(k, qx, qy, qz, qw, wx, wy, wz, vx, vy, vz):
    """Return -k omega, N m."""
    return -k * wx, -k * wy, -k * wz


@compiled
def moment(c, rx, ry, rz, qx, qy, qz, qw, wx, wy, wz, vx, vy, vz):
    """Return r x (-c omega x r), N m.

    Two cross products round less than r^2 omega - (r . omega) r, whose component along the axis
    of a slim body is a small difference.
    """
    ux, uy, uz = wy * rz - wz * ry, wz * rx - wx * rz, wx * ry - wy * rx
    return -c * (ry * uz - rz * uy), -c * (rz * ux - rx * uz), -c * (rx * uy - ry * ux)
