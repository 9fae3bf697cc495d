# SPDX-License-Identifier: Apache-2.0
"""Bodies: mass, centre of mass, principal moments and axes of shapes, composites and tensors.

Symbols: M mass (kg), I1, I2, I3 principal moments (kg m^2). Every shape is placed with its centre
of mass at its own origin and its symmetry axis, where it has one, along z. Moments of the shapes:
notes, section "Some inertia tensors"; cone, ellipsoid and torus: Landau and Lifshitz, Mechanics,
section 32.
"""

import math
from dataclasses import dataclass, replace
from decimal import ROUND_HALF_EVEN, Context, Decimal, localcontext
from functools import cached_property, reduce
from itertools import permutations, product
from operator import add

import numpy as np

from rigid_body_sim.errors import BadInput
from rigid_body_sim.numerics.functions import hypot, hypot3
from rigid_body_sim.numerics.rotations import from_matrix, rotate
from rigid_body_sim.numerics.rotations import matrix as rotation_matrix
from rigid_body_sim.numerics.vectors import cross, dot
from rigid_body_sim.scene.surfaces import Surface

IDENTITY = (0.0, 0.0, 0.0, 1.0)
LARGEST_MOMENT = 1e150    # kg m^2: squares of it are doubles
SMALLEST_MOMENT = 1e-150  # kg m^2, of a moment that is not zero: what it divides stays a double
SMALLEST_MASS = 1e-75     # kg
PLANES = (0, 1), (0, 2), (1, 2)
DIGITS, SWEEPS = 40, 20    # of the eigenvectors; four sweeps do for most tensors
NEGLIGIBLE = Decimal('1e-70')    # square of an entry beside the product of the diagonal ones
ULPS = 4.0 * np.finfo(float).eps    # a lamina has I3 = I1 + I2, up to the rounding of the input


def rod(M, length):
    """Return the moments of a thin rod along z about its middle.

    About its end it is M length^2 / 3 (parallel axis).
    """
    return M * length * length / 12.0, M * length * length / 12.0, 0.0


def lamina(M, width, height):
    """Return the moments of a thin rectangle in the xy plane, width along x, height along y.

    I3 = I1 + I2 (perpendicular axes).
    """
    I1, I2 = M * height * height / 12.0, M * width * width / 12.0
    return I1, I2, I1 + I2


def hoop(M, radius):
    """Return the moments of a thin ring in the xy plane."""
    return M * radius * radius / 2.0, M * radius * radius / 2.0, M * radius * radius


def disk(M, radius):
    """Return the moments of a thin disk in the xy plane."""
    return M * radius * radius / 4.0, M * radius * radius / 4.0, M * radius * radius / 2.0


def spherical_shell(M, radius):
    """Return the moments of a thin spherical shell."""
    return (2.0 * M * radius * radius / 3.0,) * 3


def solid_sphere(M, radius):
    """Return the moments of a homogeneous ball."""
    return (2.0 * M * radius * radius / 5.0,) * 3


def box(M, size):
    """Return the moments of a homogeneous box with edges size = (x, y, z)."""
    x, y, z = size
    return M * (y * y + z * z) / 12.0, M * (z * z + x * x) / 12.0, M * (x * x + y * y) / 12.0


def cylinder(M, radius, length):
    """Return the moments of a homogeneous cylinder along z."""
    across = M * (3.0 * radius * radius + length * length) / 12.0
    return across, across, M * radius * radius / 2.0


def cone(M, radius, height):
    """Return the moments of a homogeneous cone along z about its centre of mass.

    The centre of mass lies a quarter of the height above the base.
    """
    across = 3.0 * M * (radius * radius + height * height / 4.0) / 20.0
    return across, across, 3.0 * M * radius * radius / 10.0


def ellipsoid(M, semi_axes):
    """Return the moments of a homogeneous ellipsoid with semi_axes = (a, b, c) along x, y, z."""
    a, b, c = semi_axes
    return M * (b * b + c * c) / 5.0, M * (c * c + a * a) / 5.0, M * (a * a + b * b) / 5.0


def torus(M, radius, tube):
    """Return the moments of a homogeneous torus about z.

    `radius` is that of the circle in the middle of the tube, `tube` the radius of the tube.
    """
    across = M * (radius * radius / 2.0 + 5.0 * tube * tube / 8.0)
    return across, across, M * (radius * radius + 3.0 * tube * tube / 4.0)


SHAPES = {shape.__name__: shape for shape in (
    rod, lamina, hoop, disk, spherical_shell, solid_sphere, box, cylinder, cone, ellipsoid, torus)}
SPHERES = ('spherical_shell', 'solid_sphere')
EXTENTS = {
    'rod': lambda length: length,
    'lamina': lambda width, height: width * height,
    'hoop': lambda radius: 2.0 * math.pi * radius,
    'disk': lambda radius: math.pi * radius * radius,
    'spherical_shell': lambda radius: 4.0 * math.pi * radius * radius,
    'solid_sphere': lambda radius: 4.0 * math.pi / 3.0 * radius * radius * radius,
    'box': lambda size: size[0] * size[1] * size[2],
    'cylinder': lambda radius, length: math.pi * radius * radius * length,
    'cone': lambda radius, height: math.pi / 3.0 * radius * radius * height,
    'ellipsoid':
        lambda semi_axes: 4.0 * math.pi / 3.0 * semi_axes[0] * semi_axes[1] * semi_axes[2],
    'torus': lambda radius, tube: 2.0 * math.pi * math.pi * radius * tube * tube,
}
"""What a density is multiplied by: the volume (m^3) of a solid, the area (m^2) of a thin body, the
length (m) of a rod or a hoop."""


@dataclass(frozen=True)
class Inertia:
    """An inertia tensor: principal moments (kg m^2) and the turn from principal to body axes."""

    moments: tuple
    axes: tuple = IDENTITY

    @classmethod
    def of_matrix(cls, matrix):
        """Diagonalise a symmetric 3 x 3 tensor.

        The order and the signs of the principal axes are those nearest to the body axes; where
        moments are equal, so is the choice within their plane. A diagonal tensor is taken as it
        stands, to the last bit.
        """
        matrix = np.asarray(matrix, dtype=float)
        if np.count_nonzero(matrix - np.diag(np.diagonal(matrix))) == 0:
            return cls(tuple(float(moment) for moment in np.diagonal(matrix)))
        moments, axes = _nearest_where_equal(*_nearest_to_the_body(*eigenvectors(matrix.tolist())))
        return cls(tuple(moments), from_matrix(tuple(zip(*axes, strict=True))))

    @cached_property
    def matrix(self):
        """The tensor in body axes, shape (3, 3)."""
        if self.axes == IDENTITY:
            return np.diag(self.moments)
        return _turned(np.diag(self.moments), self.axes)


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
        Of a sphere, m; None for every other body.
    surface : Surface or None
        What touches a plane (surfaces.py).
    """

    mass: float
    center_of_mass: tuple
    about_center: Inertia
    about_origin: Inertia
    radius: float | None = None
    surface: Surface | None = None


def moved(inertia, M, shift, sign):
    """Return the tensor moved by the parallel-axis theorem.

    It is I + sign M (shift^2 1 - shift shift^T); the sign is +1 away from the centre of mass.
    There no moment is below the least one about the centre: what rounding leaves below zero, on a
    body that is small beside the shift, is that one.
    """
    if not any(shift):
        return inertia
    found = Inertia.of_matrix(inertia.matrix + sign * M * _of_point(shift))
    if sign > 0.0 and min(found.moments) < 0.0:
        least = max(0.0, min(inertia.moments))
        return Inertia(tuple(max(moment, least) for moment in found.moments), found.axes)
    return found


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
              radius=None, where='body'):
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
    given = Inertia.of_matrix(tensor)
    if about == 'origin':
        body = Body(M, center, moved(given, M, center, -1.0), given, radius)
    else:
        body = Body(M, center, given, moved(given, M, center, 1.0), radius)
    _check_moments(body, given, where)
    # what is below zero there is rounding
    return replace(body, about_center=_not_negative(body.about_center),
                   about_origin=_not_negative(body.about_origin))


def _not_negative(inertia):
    """Return an Inertia without negative moments."""
    if min(inertia.moments) >= 0.0:
        return inertia
    return Inertia(tuple(max(moment, 0.0) for moment in inertia.moments), inertia.axes)


def square_of(arm):
    """Return the squared length of an arm, inf where a double holds no more."""
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


def hole(part):
    """Return the part that takes away what another one adds: negative mass and moments."""
    return Body(-part.mass, part.center_of_mass, _negative(part.about_center),
                _negative(part.about_origin), part.radius)


def _negative(inertia):
    return Inertia(tuple(-moment for moment in inertia.moments), inertia.axes)


def composite(parts, where='body'):
    """Return the body made of placed parts.

    Parameters
    ----------
    parts : sequence of (Body, at, orientation)
        `at`: the part's origin in the composite's axes, m; `orientation`: the quaternion that
        turns part axes into the composite's. A part may be a :func:`hole`.
    where : str
        Place for the error line.

    Raises
    ------
    BadInput
        If the holes take away more than there is.
    """
    # sum() of floats rounds otherwise from Python 3.12 on: the same file would be another body
    M = reduce(add, (part.mass for part, _, _ in parts))
    if not M > 0.0:
        raise BadInput(f'{where}.parts', f'have the mass {M!r} kg together',
                       'holes take away less than there is')
    centers = [np.add(at, rotate(*orientation, *part.center_of_mass))
               for part, at, orientation in parts]
    center = reduce(add, (part.mass * at
                          for (part, _, _), at in zip(parts, centers, strict=True))) / M
    with np.errstate(over='ignore', invalid='ignore'):    # make_body refuses what is not finite
        tensor = _about(center, parts, centers)
    return make_body(M, (tensor + tensor.T) / 2.0, center, where=where)


def _about(center, parts, centers):
    """Return the tensor of placed parts about a point."""
    tensor = np.zeros((3, 3))
    for (part, _, orientation), at in zip(parts, centers, strict=True):
        own = part.about_center.matrix
        if tuple(orientation) != IDENTITY:
            own = _turned(own, orientation)
        tensor += own + part.mass * _of_point(at - center)
    return tensor


def eigenvectors(matrix):
    """Return the eigenvalues and eigenvectors of a symmetric 3 x 3 matrix, with 40 digits.

    Jacobi's method keeps the small moments of graded tensors relatively accurate, which the QR
    iteration behind LAPACK does not (Demmel and Veselic, SIAM J. Matrix Anal. Appl. 13, 1992).
    Decimal numbers mean the same on every machine; an extended double of the processor does not.
    """
    with localcontext(Context(prec=DIGITS, rounding=ROUND_HALF_EVEN)):
        a = [[Decimal(entry) for entry in row] for row in matrix]
        vectors = [[Decimal(int(i == j)) for j in range(3)] for i in range(3)]    # in rows
        for _ in range(SWEEPS):
            turns = [_turn_away(a, vectors, i, j) for i, j in PLANES]
            if not any(turns):
                break
        return ([float(a[k][k]) for k in range(3)],
                [[float(x) for x in vector] for vector in vectors])


def _turn_away(a, vectors, i, j):
    """Make a[i][j] zero by a rotation in the plane of two axes; return whether it was not.

    Source: Golub and Van Loan, Matrix Computations, section 8.5.2 (symmetric Schur decomposition).
    """
    if a[i][j] * a[i][j] <= NEGLIGIBLE * abs(a[i][i] * a[j][j]):
        a[i][j] = a[j][i] = Decimal(0)
        return False
    ratio = (a[j][j] - a[i][i]) / (2 * a[i][j])
    tangent = (1 if ratio >= 0 else -1) / (abs(ratio) + (1 + ratio * ratio).sqrt())
    cosine = 1 / (1 + tangent * tangent).sqrt()
    sine, k = tangent * cosine, 3 - i - j
    a[i][i], a[j][j] = a[i][i] - tangent * a[i][j], a[j][j] + tangent * a[i][j]
    a[i][j] = a[j][i] = Decimal(0)
    a[i][k], a[j][k] = cosine * a[i][k] - sine * a[j][k], sine * a[i][k] + cosine * a[j][k]
    a[k][i], a[k][j] = a[i][k], a[j][k]
    first, second = vectors[i], vectors[j]
    vectors[i] = [cosine * x - sine * y for x, y in zip(first, second, strict=True)]
    vectors[j] = [sine * x + cosine * y for x, y in zip(first, second, strict=True)]
    return True


def _nearest_to_the_body(moments, vectors):
    """Return the moments and the axes (right-handed) that lie nearest to the body axes.

    All orders and signs of the axes are compared.
    """
    def turned(order, signs):
        return [[sign * entry for entry in vectors[k]]
                for k, sign in zip(order, signs, strict=True)]

    def trace(choice):
        x, y, z = turned(*choice)
        return x[0] + y[1] + z[2] if dot(cross(x, y), z) > 0.0 else -math.inf
    order, signs = max(product(permutations(range(3)), product((1.0, -1.0), repeat=3)), key=trace)
    return [moments[k] for k in order], turned(order, signs)


def _nearest_where_equal(moments, axes):
    """Make moments equal that agree to rounding, and turn their axes towards the body axes."""
    slack = ULPS * max(moments)
    equal = [(i, j) for i, j in PLANES if abs(moments[i] - moments[j]) <= slack]
    if len(equal) > 1:
        return [(moments[0] + moments[1] + moments[2]) / 3.0] * 3, np.eye(3).tolist()
    for i, j in equal:
        moments[i] = moments[j] = (moments[i] + moments[j]) / 2.0
        sine, cosine = axes[j][i] - axes[i][j], axes[i][i] + axes[j][j]
        length = hypot(sine, cosine)
        sine, cosine = sine / length, cosine / length
        first, second = axes[i], axes[j]
        axes[i] = [cosine * x + sine * y for x, y in zip(first, second, strict=True)]
        axes[j] = [cosine * y - sine * x for x, y in zip(first, second, strict=True)]
    return moments, axes
