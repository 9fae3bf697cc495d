# SPDX-License-Identifier: Apache-2.0
"""Bodies: mass, centre of mass, principal moments and axes, made of shapes, tensors and parts.

Symbols: M mass (kg), I1, I2, I3 principal moments (kg m^2).
"""

from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property
from operator import add

import numpy as np

from rigid_body_sim.errors import BadInput
from rigid_body_sim.numerics.functions import hypot3
from rigid_body_sim.numerics.rotations import from_matrix
from rigid_body_sim.numerics.rotations import matrix as rotation_matrix
from rigid_body_sim.numerics.vectors import dot
from rigid_body_sim.scene.principal_axes import (
    TRACE,
    ULPS,
    eigenvectors,
    nearest_to_the_body,
    nearest_where_equal,
    without_traces,
)
from rigid_body_sim.scene.shapes import SHAPES, SPHERES
from rigid_body_sim.scene.surfaces import Surface

IDENTITY = (0.0, 0.0, 0.0, 1.0)
OWN_AXES = (1, 0, 0), (0, 1, 0), (0, 0, 1)
LARGEST_MOMENT = 1e150    # kg m^2: its square fits a double
SMALLEST_MOMENT = 1e-150  # kg m^2, of a moment that is not zero: quotients by it fit
SMALLEST_MASS = 1e-75     # kg


@dataclass(frozen=True)
class Inertia:
    """An inertia tensor: principal moments (kg m^2) and the turn from principal to body axes.

    `lost` (kg m^2) is what the eigenvalues of a tensor, and the sums of the parallel-axis theorem,
    are more than the moments, which are doubles: a difference of two large moments, over a small
    one, turns the body about its axis. `rows`, the principal axes in body axes as Fractions of 32
    digits, are given if they are not the body's: the rounding of a vector that lies along the
    body, over the small moment, does the same. `entries` are those of the tensor before it was
    diagonalised, if it was.
    """

    moments: tuple
    axes: tuple = IDENTITY
    lost: tuple = (0.0, 0.0, 0.0)
    rows: tuple = ()
    entries: tuple = field(default=(), compare=False, repr=False)

    @classmethod
    def of_matrix(cls, matrix, exact=None):
        """Diagonalise a symmetric 3 x 3 tensor.

        The principal axes nearest to the body axes are taken, of all orders and signs and of all
        choices within the plane of equal moments. They are those of the `exact` entries
        (Fractions), if they are given. A diagonal tensor is kept to the last bit; of one, the
        exact entries tell what its doubles lost.
        """
        matrix = np.asarray(matrix, dtype=float)
        if np.count_nonzero(matrix - np.diag(np.diagonal(matrix))) == 0:
            moments = tuple(float(moment) for moment in np.diagonal(matrix))
            return cls(moments) if exact is None else cls(
                moments, lost=tuple(_lost(moments[k], exact[k][k]) for k in range(3)))
        entries = tuple(map(tuple, matrix.tolist() if exact is None else exact))
        found = eigenvectors(entries)
        moments, axes, lost = nearest_to_the_body(
            *(found if exact is None else without_traces(*found)))
        moments, axes, lost = nearest_where_equal(moments, axes, lost)
        rows = tuple(tuple(map(add, map(Fraction, row), map(Fraction, less)))
                     for row, less in zip(axes, lost.vectors, strict=True))
        if rows == OWN_AXES:
            return cls(tuple(moments), lost=tuple(lost.moments))
        return cls(tuple(moments), from_matrix(tuple(zip(*axes, strict=True))),
                   tuple(lost.moments), rows, entries)

    @property
    def differences(self):
        """I2 - I3, I3 - I1 and I1 - I2 with what rounding lost, kg m^2."""
        (I1, I2, I3), (d1, d2, d3) = self.moments, self.lost
        return (I2 - I3) + (d2 - d3), (I3 - I1) + (d3 - d1), (I1 - I2) + (d1 - d2)

    @property
    def exact(self):
        """The tensor in body axes, rows of Fractions: its entries before any rounding."""
        if self.entries or self.axes != IDENTITY:
            entries = self.entries or self.matrix.tolist()
            return tuple(tuple(map(Fraction, row)) for row in entries)
        x, y, z = map(add, map(Fraction, self.moments), map(Fraction, self.lost))
        return (x, 0, 0), (0, y, 0), (0, 0, z)

    @cached_property
    def matrix(self):
        """The tensor in body axes, shape (3, 3)."""
        if self.axes == IDENTITY:
            return np.diag(self.moments)
        return _turned(np.diag(self.moments), self.axes)


def _lost(moment, exact):
    """Return what an exact moment is more than its double; 0 where only rounding says so."""
    less = float(Fraction(exact) - Fraction(moment))
    return less if abs(less) > TRACE * abs(moment) else 0.0


@dataclass(frozen=True)
class Body:
    """A rigid body in the user's axes: origin and axes are those of the scene file.

    Attributes
    ----------
    mass : float
        kg, positive.
    center_of_mass : tuple of 3 floats
        From the body's origin, in body axes, m.
    about_center, about_origin : Inertia
        About the centre of mass and about the body's origin; the one that was given is kept to the
        last bit.
    radius : float or None
        Radius of a sphere, m; None for every other body.
    surface : Surface or None
        What touches a plane (surfaces.py).
    center_lost : tuple of 3 floats
        What the centre of mass is more than the doubles above, m: parts may have theirs anywhere.
    """

    mass: float
    center_of_mass: tuple
    about_center: Inertia
    about_origin: Inertia
    radius: float | None = None
    surface: Surface | None = None
    center_lost: tuple = (0.0, 0.0, 0.0)

    @property
    def exact_center(self):
        """The centre of mass before it was rounded: Fractions, m."""
        return tuple(map(add, map(Fraction, self.center_of_mass), map(Fraction, self.center_lost)))


def moved(inertia, M, shift, sign, exactly=None):
    """Return the tensor moved by the parallel-axis theorem.

    It is I + sign M (shift^2 1 - shift shift^T); the sign is +1 away from the centre of mass. No
    moment is then below the least one about the centre. That one replaces a moment that rounding
    leaves at zero or below, on a body that is small beside the shift. The shift as Fractions is
    `exactly`, if doubles round it.
    """
    if not any(shift):
        return inertia
    sums = inertia.matrix + sign * M * _of_point(shift)
    exact = _summed(inertia, M, exactly or shift, sign) if np.isfinite(sums).all() else None
    found = Inertia.of_matrix(sums, exact)
    least = max(0.0, min(inertia.moments))
    if sign > 0.0 and (min(found.moments) < 0.0 or min(found.moments) == 0.0 < least):
        return _at_least(found, least)
    return found


def _summed(inertia, M, shift, sign):
    """Return the sums of the parallel-axis theorem, rows of Fractions."""
    d, mass = [Fraction(part) for part in shift], Fraction(sign * M)
    square = dot(d, d)
    # a product by 0 takes as long as any other, and most shifts lie along an axis
    return [[entry + mass * ((square if i == j else 0) - d[i] * d[j])
             if i == j or (d[i] and d[j]) else entry
             for j, entry in enumerate(row)] for i, row in enumerate(inertia.exact)]


def _of_point(d):
    """Return the inertia tensor of a unit mass at the place d: d^2 1 - d d^T."""
    d = np.asarray(d, dtype=float)
    return dot(d, d) * np.eye(3) - np.outer(d, d)


def _turned(tensor, q):
    """Return R tensor R^T for the rotation q, each sum over the indices in ascending order."""
    R, T = rotation_matrix(*q), tensor.tolist()
    half = [[dot(row, column) for column in zip(*T, strict=True)] for row in R]
    return np.array([[dot(row, other) for other in R] for row in half])


def make_body(M, moments_or_matrix, center_of_mass=(0.0, 0.0, 0.0), about='center_of_mass',
              radius=None, where='body', exact=None, center_lost=(0.0, 0.0, 0.0)):
    """Return the body of a given tensor.

    Parameters
    ----------
    M : float
        Mass, kg.
    moments_or_matrix : sequence
        Three moments about the body's axes, or a symmetric 3 x 3 tensor in body axes, kg m^2.
    about : {'center_of_mass', 'origin'}
        The point that the tensor is about.
    where : str
        Place for the error line.
    exact : sequence, optional
        Rows of Fractions: the tensor about the centre of mass, if the one above rounds it.
    center_lost : sequence of 3 floats
        As Body has it.

    Raises
    ------
    BadInput
        If the mass is not positive, the tensor not symmetric, a moment negative, or the triangle
        inequality about the centre of mass broken.
    """
    if not M > 0.0:
        raise BadInput(f'{where}.mass', f'got {M!r}', 'a mass is positive, in kg')
    if M < SMALLEST_MASS:
        raise BadInput(f'{where}.mass', f'got {M!r} kg', f'at least {SMALLEST_MASS:g}')
    tensor = np.asarray(moments_or_matrix, dtype=float)
    if tensor.shape == (3,):
        tensor = np.diag(tensor)
    if not np.array_equal(tensor, tensor.T, equal_nan=True):
        raise BadInput(f'{where}.inertia', f'got {tensor.tolist()}, which is not symmetric',
                       'a tensor equals its transpose')
    center = tuple(float(x) for x in center_of_mass)
    refuse_beyond(max(float(np.abs(tensor).max()), M * square_of(center)), where)
    given = Inertia.of_matrix(tensor, exact)
    body = Body(M, center, given, given, radius, center_lost=tuple(center_lost))
    if about == 'origin':
        body = replace(body, about_center=moved(given, M, center, -1.0))
    else:
        body = replace(body, about_origin=moved(given, M, center, 1.0, body.exact_center))
    _check_moments(body, given, where)
    # a moment below zero there is rounding
    return replace(body, about_center=_not_negative(body.about_center),
                   about_origin=_not_negative(body.about_origin))


def _not_negative(inertia):
    """Return an Inertia without negative moments."""
    return inertia if min(inertia.moments) >= 0.0 else _at_least(inertia, 0.0)


def _at_least(inertia, least):
    """Return an Inertia whose moments are at least so much."""
    return replace(inertia, moments=tuple(max(moment, least) for moment in inertia.moments),
                   lost=tuple(less if moment >= least else 0.0 for moment, less in zip(
                       inertia.moments, inertia.lost, strict=True)))


def square_of(arm):
    """Return the squared length of an arm, or inf if it overflows."""
    length = hypot3(*arm)
    return length * length


def refuse_beyond(moment, where):
    """Refuse a moment of inertia (kg m^2) that is not finite, or whose square is not."""
    if not moment <= LARGEST_MOMENT:
        raise BadInput(where, f'a moment of inertia of {moment!r} kg m^2, about the middle or '
                       'where it is held', f'at most {LARGEST_MOMENT:g}')


def _check_moments(body, given, where):
    """Refuse moments that no mass distribution has, up to the rounding of the `given` tensor."""
    slack = ULPS * max(abs(moment) for moment in given.moments)
    moments = body.about_center.moments
    point = 'about the centre of mass'
    if given is not body.about_center:
        point += ', moved there by the parallel-axis theorem'
    for k, moment in enumerate(moments):
        others = moments[0] + moments[1] + moments[2] - moment
        if moment < -slack:
            raise BadInput(f'{where}.inertia', f'moment {moment!r} {point} is negative',
                           'moments of inertia are zero or positive')
        if moment > others + slack:
            raise BadInput(f'{where}.inertia', f'moments {list(moments)} {point} break the '
                           f'triangle inequality (I{k + 1} = {moment!r})',
                           f'I{k + 1} may be at most the sum of the other two, {others!r}')
        if 0.0 < moment < SMALLEST_MOMENT:
            raise BadInput(f'{where}.inertia', f'moment {moment!r} {point} is too small',
                           f'zero, or at least {SMALLEST_MOMENT:g}')
    if not any(moment > 0.0 for moment in (*moments, *body.about_origin.moments)):
        raise BadInput(f'{where}.inertia', f'got {list(moments)}',
                       'at least two moments are positive')


def of_shape(name, M, dimensions, center_of_mass=(0.0, 0.0, 0.0), where='body'):
    """Return the body of a homogeneous shape (a key of SHAPES) with its dimensions in metres."""
    radius = dimensions['radius'] if name in SPHERES else None
    return make_body(M, SHAPES[name](M, **dimensions), center_of_mass, radius=radius, where=where)
