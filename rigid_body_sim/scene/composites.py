# SPDX-License-Identifier: Apache-2.0
"""Bodies made of placed parts.

Sums are taken with sixty digits: in a slim body, the rounding of the large entries of a tensor
would be much of the small moment, and that of the centre of mass would turn the body about its
axis.
"""

from dataclasses import replace
from decimal import ROUND_HALF_EVEN, Context, Decimal, localcontext
from fractions import Fraction
from functools import reduce
from operator import add

from rigid_body_sim.errors import BadInput
from rigid_body_sim.numerics.vectors import apply, dot, minus, plus, product, scaled
from rigid_body_sim.scene.bodies import IDENTITY, make_body

DIGITS = 60
TRACE = Decimal('1e-50')    # of the largest: what rounding leaves of an entry that is zero


def hole(part):
    """Return a part with negative mass and moments, which removes what another one adds."""
    return replace(part, mass=-part.mass, about_center=_negative(part.about_center),
                   about_origin=_negative(part.about_origin))


def _negative(inertia):
    return replace(inertia, moments=tuple(-moment for moment in inertia.moments),
                   lost=tuple(-less for less in inertia.lost),
                   entries=tuple(tuple(-entry for entry in row) for row in inertia.entries))


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
    # sum() of floats rounds differently from Python 3.12 on: one file would make two bodies
    M = reduce(add, (part.mass for part, _, _ in parts))
    if not M > 0.0:
        raise BadInput(f'{where}.parts', f'have the mass {M!r} kg together',
                       'holes take away less than there is')
    with localcontext(Context(prec=DIGITS, rounding=ROUND_HALF_EVEN)):
        placed = [(Decimal(part.mass), *_placed(part, at, orientation))
                  for part, at, orientation in parts]
        moment = reduce(plus, (scaled(mass, at) for mass, at, _ in placed))
        center = scaled(1 / reduce(add, (mass for mass, _, _ in placed)), moment)
        center = [_without_trace(x, max(abs(at[k]) for _, at, _ in placed))
                  for k, x in enumerate(center)]
        tensor = reduce(_sum, (_moved(mass, minus(at, center), own) for mass, at, own in placed))
        largest = max(abs(tensor[k][k]) for k in range(3))
        tensor = [[tensor[i][i] if i == j else
                   _without_trace(tensor[min(i, j)][max(i, j)], largest) for j in range(3)]
                  for i in range(3)]
        rounded = [float(x) for x in center]
        lost = [float(x - Decimal(r)) for x, r in zip(center, rounded, strict=True)]
        return make_body(M, [[float(x) for x in row] for row in tensor], rounded, where=where,
                         exact=[[Fraction(x) for x in row] for row in tensor], center_lost=lost)


def _placed(part, at, orientation):
    """Return the centre of mass of a placed part and the tensor about it, in Decimals."""
    own = [[_decimal(x) for x in row] for row in part.about_center.exact]
    center = [_decimal(x) for x in part.exact_center]
    if tuple(orientation) != IDENTITY:
        R = _rotation([Decimal(x) for x in orientation])
        own = [[dot(apply(own, row), other) for other in R] for row in R]
        center = apply(R, center)
    return plus([Decimal(float(x)) for x in at], center), own


def _rotation(q):
    """Return the rotation matrix of a quaternion of any length."""
    x, y, z, w = q
    twice = 2 / (x * x + y * y + z * z + w * w)
    return ((1 - twice * (y * y + z * z), twice * (x * y - w * z), twice * (x * z + w * y)),
            (twice * (x * y + w * z), 1 - twice * (x * x + z * z), twice * (y * z - w * x)),
            (twice * (x * z - w * y), twice * (y * z + w * x), 1 - twice * (x * x + y * y)))


def _moved(mass, d, own):
    """Return a tensor moved away from the centre of mass by d: parallel-axis theorem."""
    x, y, z = product(d, d)
    squares = y + z, z + x, x + y    # d^2 - x^2 would lose y and z beside a large x
    return [[own[i][j] + mass * (squares[i] if i == j else -d[i] * d[j]) for j in range(3)]
            for i in range(3)]


def _sum(one, other):
    return [plus(x, y) for x, y in zip(one, other, strict=True)]


def _without_trace(x, largest):
    return x if abs(x) > TRACE * largest else Decimal(0)


def _decimal(number):
    return Decimal(number.numerator) / Decimal(number.denominator)
