"""Bodies: shapes, composites and given tensors -> mass, centre of mass, principal moments and axes.

Symbols: M mass (kg), I1, I2, I3 principal moments (kg m^2). Every shape is placed with its centre of mass at its own origin and its symmetry
axis, where it has one, along z. Moments of the shapes: notes, section "Some inertia tensors"; cone, ellipsoid and torus: Landau and Lifshitz,
Mechanics, section 32.
"""

import math
from dataclasses import dataclass
from functools import cached_property, reduce
from itertools import permutations, product
from operator import add

import numpy as np
from scipy.spatial.transform import Rotation

from rigid_body_sim.errors import BadInput

IDENTITY = (0.0, 0.0, 0.0, 1.0)
LARGEST_MOMENT = 1e150    # kg m^2: squares of it are doubles
ULPS = 4.0 * np.finfo(float).eps    # a lamina has I3 = I1 + I2, up to the rounding of what the user typed


def rod(M, length):
    """Return the moments of a thin rod along z about its middle; about its end it is M length^2 / 3 (parallel axis)."""
    return M * length * length / 12.0, M * length * length / 12.0, 0.0


def lamina(M, width, height):
    """Return the moments of a thin rectangle in the xy plane, width along x, height along y; I3 = I1 + I2 (perpendicular axes)."""
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
    """Return the moments of a homogeneous cone along z about its centre of mass, a quarter of the height above the base."""
    across = 3.0 * M * (radius * radius + height * height / 4.0) / 20.0
    return across, across, 3.0 * M * radius * radius / 10.0


def ellipsoid(M, semi_axes):
    """Return the moments of a homogeneous ellipsoid with semi_axes = (a, b, c) along x, y, z."""
    a, b, c = semi_axes
    return M * (b * b + c * c) / 5.0, M * (c * c + a * a) / 5.0, M * (a * a + b * b) / 5.0


def torus(M, radius, tube):
    """Return the moments of a homogeneous torus about z: radius to the middle of the tube, tube its own radius."""
    across = M * (radius * radius / 2.0 + 5.0 * tube * tube / 8.0)
    return across, across, M * (radius * radius + 3.0 * tube * tube / 4.0)


SHAPES = {shape.__name__: shape for shape in (rod, lamina, hoop, disk, spherical_shell, solid_sphere, box, cylinder, cone, ellipsoid, torus)}
SPHERES = ('spherical_shell', 'solid_sphere')


@dataclass(frozen=True)
class Inertia:
    """An inertia tensor by its principal moments (kg m^2) and the quaternion that turns principal axes into body axes."""

    moments: tuple
    axes: tuple = IDENTITY

    @classmethod
    def of_matrix(cls, matrix):
        """Diagonalise a symmetric 3 x 3 tensor.

        Among all orders and signs of the principal axes the ones nearest to the body axes are taken; where moments are equal, so is the
        choice within their plane. A diagonal tensor is taken as it stands, to the last bit.
        """
        matrix = np.asarray(matrix, dtype=float)
        if np.count_nonzero(matrix - np.diag(np.diagonal(matrix))) == 0:
            return cls(tuple(float(moment) for moment in np.diagonal(matrix)))
        moments, vectors = _jacobi_eigenvectors(matrix)
        order, signs = max(
            ((order, signs) for order in permutations(range(3)) for signs in product((1.0, -1.0), repeat=3)),
            key=lambda choice: sum(sign * vectors[row, column] for row, (column, sign) in enumerate(zip(*choice, strict=True)))
            if np.linalg.det(vectors[:, choice[0]] * choice[1]) > 0.0 else -np.inf)
        moments, vectors = moments[list(order)], vectors[:, order] * signs
        moments, vectors = _nearest_where_equal(moments, vectors)
        return cls(tuple(float(moment) for moment in moments), tuple(Rotation.from_matrix(vectors).as_quat(canonical=True).tolist()))

    @cached_property
    def matrix(self):
        """The tensor in body axes, shape (3, 3)."""
        if self.axes == IDENTITY:
            return np.diag(self.moments)
        turn = Rotation.from_quat(self.axes).as_matrix()
        return turn @ np.diag(self.moments) @ turn.T


@dataclass(frozen=True)
class Body:
    """A rigid body in its own axes, which are the user's: origin and axes as the scene file names them.

    Attributes
    ----------
    mass : float
        kg, positive.
    center_of_mass : tuple of 3 floats
        From the body's origin, in body axes, m.
    about_center, about_origin : Inertia
        About the centre of mass and about the body's origin; the one that was given is kept to the last bit.
    radius : float or None
        Of a sphere, m; None for every other body.
    """

    mass: float
    center_of_mass: tuple
    about_center: Inertia
    about_origin: Inertia
    radius: float | None = None


def moved(inertia, M, shift, sign):
    """Return the tensor moved by the parallel-axis theorem: I + sign M (shift^2 1 - shift shift^T), sign +1 away from the centre of mass."""
    d = np.asarray(shift, dtype=float)
    if not d.any():
        return inertia
    return Inertia.of_matrix(inertia.matrix + sign * M * (d @ d * np.eye(3) - np.outer(d, d)))


def make_body(M, moments_or_matrix, center_of_mass=(0.0, 0.0, 0.0), about='center_of_mass', radius=None, where='body'):
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
        Mass not positive, tensor not symmetric, a negative moment, a broken triangle inequality about the centre of mass.
    """
    if not M > 0.0:
        raise BadInput(f'{where}.mass', f'got {M!r}', 'a mass is positive, in kg')
    tensor = np.asarray(moments_or_matrix, dtype=float)
    if tensor.shape == (3,):
        tensor = np.diag(tensor)
    if not np.array_equal(tensor, tensor.T, equal_nan=True):
        raise BadInput(f'{where}.inertia', f'got {tensor.tolist()}, which is not symmetric', 'a tensor equals its transpose')
    center = tuple(float(x) for x in center_of_mass)
    refuse_beyond(max(float(np.abs(tensor).max()), M * square_of(center)), where)
    given = Inertia.of_matrix(tensor)
    if about == 'origin':
        body = Body(M, center, moved(given, M, center, -1.0), given, radius)
    else:
        body = Body(M, center, given, moved(given, M, center, 1.0), radius)
    _check_moments(body, given, where)
    return body


def square_of(arm):
    """Return the squared length of an arm, inf where a double holds no more."""
    length = math.hypot(*arm)
    return length * length


def refuse_beyond(moment, where):
    """Refuse a moment of inertia (kg m^2) that is not finite or so large that its square is not."""
    if not moment <= LARGEST_MOMENT:
        raise BadInput(where, f'a moment of inertia of {moment!r} kg m^2, about the middle or where it is held', f'at most {LARGEST_MOMENT:g}')


def _check_moments(body, given, where):
    """Refuse moments that no mass distribution has; rounding is allowed in proportion to the tensor that was given."""
    slack = ULPS * max(abs(moment) for moment in given.moments)
    moments = body.about_center.moments
    point = 'about the centre of mass' + ('' if given is body.about_center else ', moved there by the parallel-axis theorem')
    for k, moment in enumerate(moments):
        others = moments[0] + moments[1] + moments[2] - moment
        if moment < -slack:
            raise BadInput(f'{where}.inertia', f'moment {moment!r} {point} is negative', 'moments of inertia are zero or positive')
        if moment > others + slack:
            raise BadInput(f'{where}.inertia', f'moments {list(moments)} {point} break the triangle inequality (I{k + 1} = {moment!r})',
                           f'I{k + 1} may be at most the sum of the other two, {others!r}')
    if not any(moment > 0.0 for moment in moments) and not any(moment > 0.0 for moment in body.about_origin.moments):
        raise BadInput(f'{where}.inertia', f'got {list(moments)}', 'at least two moments are positive')


def of_shape(name, M, dimensions, center_of_mass=(0.0, 0.0, 0.0), where='body'):
    """Return the body of a homogeneous shape (a key of SHAPES) with its dimensions in metres."""
    radius = dimensions['radius'] if name in SPHERES else None
    return make_body(M, SHAPES[name](M, **dimensions), center_of_mass, radius=radius, where=where)


def composite(parts):
    """Return the body made of placed parts.

    Parameters
    ----------
    parts : sequence of (Body, at, orientation)
        `at`: the part's origin in the composite's axes, m; `orientation`: quaternion that turns part axes into the composite's.
    """
    # sum() of floats rounds otherwise from Python 3.12 on: the same file would be another body
    M = reduce(add, (part.mass for part, _, _ in parts))
    centers = [np.asarray(at) + Rotation.from_quat(orientation).apply(part.center_of_mass) for part, at, orientation in parts]
    center = sum(part.mass * at for (part, _, _), at in zip(parts, centers, strict=True)) / M
    with np.errstate(over='ignore', invalid='ignore'):    # make_body refuses what is not finite
        tensor = _about(center, parts, centers)
    return make_body(M, (tensor + tensor.T) / 2.0, center)


def _about(center, parts, centers):
    """Return the tensor of placed parts about a point."""
    tensor = np.zeros((3, 3))
    for (part, _, orientation), at in zip(parts, centers, strict=True):
        own = part.about_center.matrix
        if tuple(orientation) != IDENTITY:
            turn = Rotation.from_quat(orientation).as_matrix()
            own = turn @ own @ turn.T
        d = at - center
        tensor += own + part.mass * (d @ d * np.eye(3) - np.outer(d, d))
    return tensor


def _jacobi_eigenvectors(matrix):
    """Return eigenvalues and eigenvectors (columns) of a symmetric 3 x 3 matrix by Jacobi rotations in extended precision.

    Jacobi's method keeps small moments of graded tensors relatively accurate, which the QR iteration behind LAPACK does not
    (Demmel and Veselic, SIAM J. Matrix Anal. Appl. 13, 1992).
    """
    a = matrix.astype(np.longdouble)
    vectors = np.eye(3, dtype=np.longdouble)
    for _ in range(12):
        for i, j in ((0, 1), (0, 2), (1, 2)):
            if a[i, j] * a[i, j] == 0.0:    # nothing is left to turn away, and its ratio might overflow
                a[i, j] = a[j, i] = 0.0
                continue
            ratio = (a[j, j] - a[i, i]) / (2.0 * a[i, j])
            tangent = 1.0 / (abs(ratio) + np.hypot(np.longdouble(1.0), ratio))
            tangent = tangent if ratio >= 0.0 else -tangent
            cosine = 1.0 / np.sqrt(1.0 + tangent * tangent)
            turn = np.eye(3, dtype=np.longdouble)
            turn[i, i] = turn[j, j] = cosine
            turn[i, j], turn[j, i] = tangent * cosine, -tangent * cosine
            a = turn.T @ a @ turn
            a[i, j] = a[j, i] = 0.0
            vectors = vectors @ turn
    return np.diagonal(a).astype(float), vectors.astype(float)


def _nearest_where_equal(moments, vectors):
    """Make moments that agree to rounding equal, and turn their axes within their plane to the body axes."""
    slack = ULPS * max(moments)
    equal = [(i, j) for i, j in ((0, 1), (0, 2), (1, 2)) if abs(moments[i] - moments[j]) <= slack]
    if len(equal) > 1:
        return np.full(3, moments.mean()), np.eye(3)
    for i, j in equal:
        moments, vectors = moments.copy(), vectors.copy()
        moments[i] = moments[j] = (moments[i] + moments[j]) / 2.0
        angle = np.arctan2(vectors[i, j] - vectors[j, i], vectors[i, i] + vectors[j, j])
        first, second = vectors[:, i].copy(), vectors[:, j].copy()
        vectors[:, i] = np.cos(angle) * first + np.sin(angle) * second
        vectors[:, j] = np.cos(angle) * second - np.sin(angle) * first
    return moments, vectors
