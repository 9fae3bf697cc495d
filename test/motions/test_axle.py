# SPDX-License-Identifier: Apache-2.0
"""The exact numbers of a body on a hinge (motions/axle.py), beside the same in Fractions."""

from fractions import Fraction

import pytest
from near import near

from rigid_body_sim.motions.axle import axle_of
from rigid_body_sim.numerics.pairs import in_integers, quotient_of
from rigid_body_sim.numerics.vectors import apply, cross, dot, minus
from rigid_body_sim.scene.bodies import IDENTITY, Inertia

TURNED = (0.1, -0.7, 0.5, 0.5)
HINGES = [((0.0, 1.0, 0.0), (0.1, 0.0, 0.0), (0.0, 0.0, 0.0), IDENTITY),
          ((0.6, 0.0, -0.8), (0.1, -0.2, 0.3), (0.7, 0.1, 1e-9), IDENTITY),
          ((0.48, 0.6, 0.64), (0.0, 0.3, -0.1), (1e3, -0.1, 0.2), TURNED)]


def fractions(numbers):
    """Return doubles as Fractions."""
    return [Fraction(number) for number in numbers]


def matrix_of(moments, axes):
    """Return the rows of the tensor with these principal moments and axes, exactly."""
    x, y, z, w = fractions(axes)
    norm = x * x + y * y + z * z + w * w
    columns = ((w * w + x * x - y * y - z * z, 2 * (x * y + z * w), 2 * (x * z - y * w)),
               (2 * (x * y - z * w), w * w + y * y - z * z - x * x, 2 * (y * z + x * w)),
               (2 * (x * z + y * w), 2 * (y * z - x * w), w * w + z * z - x * x - y * y))
    diagonal = fractions(moments)
    return [[sum(diagonal[k] * columns[k][i] * columns[k][j] for k in range(3)) / norm / norm
             for j in range(3)] for i in range(3)]


@pytest.mark.parametrize(('axis', 'center', 'point', 'axes'), HINGES)
def test_the_numbers_of_a_hinge_are_those_of_fractions(axis, center, point, axes):
    moments, mass = (0.02, 0.03, 0.011), 0.7
    held = axle_of(axis, center, point, mass, Inertia(moments, axes))
    n, r, momentum = ([Fraction(x, one.over) for x in one.integers]
                      for one in (held.axis, held.arm, held.momentum))
    assert not any(cross(n, fractions(axis)))
    assert abs(dot(n, n) - 1) < Fraction(1, 10 ** 39)
    assert r == list(minus(fractions(center), fractions(point)))
    across = cross(n, r)
    assert Fraction(*held.distance) ** 2 == near(dot(across, across), rel=1e-39)
    spun = apply(matrix_of(moments, axes), n)
    expected = minus(spun, [Fraction(mass) * x for x in cross(r, cross(r, n))])
    assert momentum == list(expected)
    assert Fraction(*held.moment) == dot(n, expected)
    assert held.momentum.rounded() == tuple(map(float, expected))


def test_a_quotient_and_integers_of_doubles_are_exact():
    high, low = quotient_of(1.0, 3.0)
    assert high == 1.0 / 3.0
    assert low == float(Fraction(1, 3) - Fraction(high))
    numbers = [0.1, -3.5, 0.0, 1e-30, 2.0 ** 80]
    integers, one = in_integers(numbers)
    assert [Fraction(integer, one) for integer in integers] == fractions(numbers)
