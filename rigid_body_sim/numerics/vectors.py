# SPDX-License-Identifier: Apache-2.0
"""Vectors as tuples of three floats, and matrices as tuples of three rows.

Every sum is written out, so the source fixes its order: a matrix product of numpy goes through
BLAS, whose kernels round differently from one processor to the next. Kernels inline these
functions, and Python calls them as they stand; arrays of three numbers serve as well as tuples.
"""

from rigid_body_sim.compilation.jit import inlined


@inlined
def dot(a, b):
    """Return a . b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@inlined
def cross(a, b):
    """Return a x b."""
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


@inlined
def plus(a, b):
    """Return a + b."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


@inlined
def minus(a, b):
    """Return a - b."""
    return a[0] - b[0], a[1] - b[1], a[2] - b[2]


@inlined
def scaled(s, a):
    """Return s a."""
    return s * a[0], s * a[1], s * a[2]


@inlined
def product(a, b):
    """Return the vector of the products of the components of a and b."""
    return a[0] * b[0], a[1] * b[1], a[2] * b[2]


@inlined
def transposed(matrix):
    """Return the rows of the transposed matrix."""
    a, b, c = matrix
    return (a[0], b[0], c[0]), (a[1], b[1], c[1]), (a[2], b[2], c[2])


@inlined
def apply(matrix, a):
    """Return the product of a matrix, given by its rows, and a vector."""
    return dot(matrix[0], a), dot(matrix[1], a), dot(matrix[2], a)


@inlined
def across(n, a):
    """Return the part of a that is perpendicular to the unit vector n."""
    return minus(a, scaled(dot(n, a), n))
