# SPDX-License-Identifier: Apache-2.0
"""Rotation of a body whose angular velocity changes linearly with time.

In world axes omega(t) = omega0 + w t. A sphere sliding on a table with side spin turns like this.
In the frame e1 = w/|w|, e2 along the part of omega0 across w, e3 = e1 x e2, the angular velocity
is (c + |w| t, p, 0), and the turn U (dU/dt = omega U / 2 as quaternions, U(0) = 1) is made of
parabolic-cylinder functions: it is the Landau-Zener problem of quantum mechanics. With
T = omega_1/sqrt|w|, P = p/sqrt|w|, rho^2 = T^2 + P^2 there are two regions:

- Inside the ellipse T^2 + (pi/2) P^2 = 100 the turn is a product of steps of at most 3 rad of
  half-angle, each a Taylor series about its middle; ten steps reach from the middle to the rim.
- Outside, one step of any length suffices. Let theta be the angle from e1 to omega,
  s = sin(theta) = P/rho, x = cos(theta). Seen from axes that follow omega, the turn keeps a slowly
  moving axis, whose stereographic coordinate is the series of Riccati's equation

      z = s sum_n i^(n-1) p_n(x)/rho^(2n),
      p_1 = -1/2,  p_(n+1) = -(2n + 1) x p_n + (1 - x^2) (p_n' - sum_(a+b=n) p_a p_b/2),

  and it turns about that axis by the integral of |omega| dt, which is elementary, plus the
  integral of Re z dtheta. The terms are below (2n - 1)!!/(T^2 + (pi/2) P^2)^n: on the rim 22 of
  them reach 5e-18, and far from it two do.

Source: M. V. Berry, Histories of adiabatic quantum transitions, Proc. R. Soc. Lond. A 429 (1990)
61-72 (the series and its useful length).
"""

import math

import numpy as np

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.compilation.memory import table
from rigid_body_sim.numerics.functions import asinh, cos, hypot, sin
from rigid_body_sim.numerics.rotations import multiply

RIM = 10.0              # T on the rim
WIDER = 0.5 * math.pi   # weight of P^2
TERMS = 22
HALF_STEP = 1.5         # half-angle of half a Taylor step, rad
SMALLEST = 1e-18        # terms below this are left out


def _product(first, second):
    result = [0] * (len(first) + len(second) - 1)
    for i, left in enumerate(first):
        for j, right in enumerate(second):
            result[i + j] += left * right
    return result


def _sum(*polynomials):
    result = [0] * max(map(len, polynomials))
    for each in polynomials:
        for power, value in enumerate(each):
            result[power] += value
    return result


def _axis_polynomials():
    """Return 2^n p_n, n = 1 ... TERMS, as lists of coefficients of powers of x: integers."""
    polynomials = [[-1]]
    for n in range(1, TERMS):
        last = polynomials[-1]
        derivative = [2 * power * value for power, value in enumerate(last)][1:] or [0]
        pairs = [_product(polynomials[a], polynomials[n - 2 - a]) for a in range(n - 1)]
        bracket = _sum(derivative, *[[-value for value in pair] for pair in pairs])
        polynomials.append(_sum(_product([0, -4 * n - 2], last), _product([1, 0, -1], bracket)))
    return polynomials


def _turn_polynomial(axis_polynomial, n):
    """Return the coefficients of r, a polynomial in 1 - x, from those of 2^n p_n.

    It is defined by integral_x^1 (1 - x^2)^n p_n dx = (1 - x)^(n + 1) r(1 - x).
    """
    integrand, power_of_x = [0], [1]
    for value in axis_polynomial:
        integrand = _sum(integrand, [value * each for each in power_of_x])
        power_of_x = _product(power_of_x, [1, -1])
    for _ in range(n):
        integrand = _product(integrand, [2, -1])
    return [value / (2 ** n * (n + 1 + power)) for power, value in enumerate(integrand)]


def _tables():
    """Return the coefficients of p_n and of r_n with the signs of i^(n-1).

    Those of p_n belong to powers of x^2 (for even n without a factor x); r_n is for odd n only.
    """
    axis, turn = np.zeros((TERMS, (TERMS + 1) // 2)), np.zeros((TERMS, 2 * TERMS))
    for index, polynomial in enumerate(_axis_polynomials()):
        n, sign = index + 1, -1 if index % 4 >= 2 else 1
        coefficients = [sign * value / 2 ** n for value in polynomial[index % 2:n:2]]
        axis[index, :len(coefficients)] = coefficients
        if index % 2 == 0:
            coefficients = [sign * value for value in _turn_polynomial(polynomial[:n], n)]
            turn[index, :len(coefficients)] = coefficients
    return axis, turn


AXIS, TURN = map(table, _tables())
RECIPROCALS = table(np.array([0.0] + [1.0 / n for n in range(1, 41)]))


@compiled
def ramped_rotation(c, p, w, time):
    """Return the turn of a body from time 0 to ``time``, a quaternion (x, y, z, w).

    Its components belong to the frame e1, e2, e3 of the module's docstring.

    Parameters
    ----------
    c, p : float
        The angular velocity at time 0 is (c, p, 0), rad/s; p >= 0.
    w : float
        Its rate of change is (w, 0, 0), rad/s^2; w >= 0.
    time : float
        In seconds, of either sign.
    """
    if p <= SMALLEST * math.sqrt(w):
        # turning about one axis: over all times p adds less than 3 p/sqrt(w)
        half = 0.5 * time * (c + 0.5 * w * time)
        return sin(half), 0.0, 0.0, cos(half)
    if w == 0.0:
        rate = hypot(c, p)
        half = 0.5 * rate * time
        sine = sin(half) / rate
        return sine * c, sine * p, 0.0, cos(half)
    end = c + w * time
    if 0.25 * abs(time) * max(hypot(c, p), hypot(end, p)) <= HALF_STEP:
        return _step(c, p, w, time)
    if c >= 0.0 and end >= 0.0:
        return _on_one_side(c, p, w, time)
    if c <= 0.0 and end <= 0.0:
        x, y, z, s = _on_one_side(-c, p, w, -time)
        return x, -y, -z, s
    middle = -c / w
    if c < 0.0:
        x, y, z, s = _on_one_side(-c, p, w, -middle)
        ux, uy, uz, us = _on_one_side(0.0, p, w, time - middle)
        return multiply(ux, uy, uz, us, x, -y, -z, s)
    x, y, z, s = _on_one_side(c, p, w, middle)
    ux, uy, uz, us = _on_one_side(0.0, p, w, middle - time)
    return multiply(ux, -uy, -uz, us, x, y, z, s)


@compiled
def _on_one_side(c, p, w, time):
    """Return the turn if omega_1 >= 0 at both ends; the path is cut where it crosses the rim."""
    end = max(c + w * time, 0.0)
    rim, width = RIM * math.sqrt(w), math.sqrt(WIDER) * p
    start_outside, end_outside = hypot(c, width) >= rim, hypot(end, width) >= rim
    if start_outside and end_outside:
        return _outside(c, p, w, time)
    if not start_outside and not end_outside:
        return _inside(c, p, w, time)
    crossing = math.sqrt((rim - width) * (rim + width))
    first = (crossing - c) / w
    if start_outside:
        x, y, z, s = _outside(c, p, w, first)
        ux, uy, uz, us = _inside(crossing, p, w, time - first)
    else:
        x, y, z, s = _inside(c, p, w, first)
        ux, uy, uz, us = _outside(crossing, p, w, time - first)
    return multiply(ux, uy, uz, us, x, y, z, s)


@compiled
def _inside(c, p, w, time):
    x, y, z, s = 0.0, 0.0, 0.0, 1.0
    direction = 1.0 if time >= 0.0 else -1.0
    remaining = abs(time)
    while remaining > 0.0:
        # step solves (speed + w step / 2) step / 2 = 2 HALF_STEP if c and w step have one sign
        speed = hypot(c, p)
        step = min(8.0 * HALF_STEP / (speed + math.sqrt(speed * speed + 8.0 * w * HALF_STEP)),
                   remaining)
        remaining -= step
        step *= direction
        ux, uy, uz, us = _step(c, p, w, step)
        x, y, z, s = multiply(ux, uy, uz, us, x, y, z, s)
        c += w * step
    return x, y, z, s


@compiled
def _step(c, p, w, time):
    """Return the turn over a time that is short enough for the series about its middle."""
    half = 0.5 * time
    return _taylor(0.5 * (c + w * half) * half, 0.5 * p * half, 0.5 * w * half * half)


@compiled
def _taylor(a, b, ramp):
    """Return the turn over a step, from the series about its middle.

    The series is (n + 1) u_(n+1) = (a e1 + b e2) u_n + ramp e1 u_(n-1). Its sums of even and of
    odd terms, E and O, give both halves: U = (E + O) (E - O)^-1.
    """
    size, bound, bound_before = hypot(a, b), 1.0, 0.0
    x, y, z, s = 0.0, 0.0, 0.0, 1.0
    bx, by, bz, bs = 0.0, 0.0, 0.0, 0.0
    ex, ey, ez, es = 0.0, 0.0, 0.0, 1.0
    ox, oy, oz, os = 0.0, 0.0, 0.0, 0.0
    for n in range(1, len(RECIPROCALS), 2):
        an, bn, rn = a * RECIPROCALS[n], b * RECIPROCALS[n], ramp * RECIPROCALS[n]
        bx, by, bz, bs = (an * s + bn * z + rn * bs, bn * s - an * z - rn * bz,
                          an * y - bn * x + rn * by, -an * x - bn * y - rn * bx)
        ox += bx
        oy += by
        oz += bz
        os += bs
        an, bn, rn = a * RECIPROCALS[n + 1], b * RECIPROCALS[n + 1], ramp * RECIPROCALS[n + 1]
        x, y, z, s = (an * bs + bn * bz + rn * s, bn * bs - an * bz - rn * z,
                      an * by - bn * bx + rn * y, -an * bx - bn * by - rn * x)
        ex += x
        ey += y
        ez += z
        es += s
        bound_before = (size * bound + abs(ramp) * bound_before) * RECIPROCALS[n]
        bound = (size * bound_before + abs(ramp) * bound) * RECIPROCALS[n + 1]
        if bound + bound_before < SMALLEST:
            break
    return multiply(ex + ox, ey + oy, ez + oz, es + os, ox - ex, oy - ey, oz - ez, es - os)


@compiled
def _outside(c, p, w, time):
    """Return the turn between two points outside the rim with omega_1 >= 0.

    It is the rotation from the slow axis at the start to e1, a turn about e1, and the rotation
    from e1 to the slow axis at the end.
    """
    end = max(c + w * time, 0.0)
    speed, end_speed = hypot(c, p), hypot(end, p)
    root = math.sqrt(w)
    x, y, z, s, turn = _slow_axis(c, p, root / speed, speed)
    ex, ey, ez, es, end_turn = _slow_axis(end, p, root / end_speed, end_speed)
    half = 0.5 * (_angle(c, end, p, speed, end_speed, w * time, time) + (end_turn - turn))
    if not abs(half) < math.inf:
        half = 0.0    # it overflows: within an ulp of omega the angle can be anything
    x, y, z, s = multiply(sin(half), 0.0, 0.0, cos(half), -x, -y, -z, s)
    return multiply(ex, ey, ez, es, x, y, z, s)


@compiled
def _angle(c, end, p, speed, end_speed, gain, time):
    """Return the integral of |omega| dt, from differences that do not cancel."""
    both = c + end
    if both == 0.0:
        return speed * time
    both_cosines = c / speed + end / end_speed
    straight = end_speed + c * (both / (speed + end_speed))
    mean = both / end_speed
    argument = (gain / speed) * mean / both_cosines
    quotient = 1.0 if abs(argument) < 1e-8 else asinh(argument) / argument
    return 0.5 * time * (straight + p * (p / speed) * (mean / both_cosines) * quotient)


@compiled
def _slow_axis(c, p, inverse_rho, speed):
    """Return the quaternion from e1 to the slow axis and the integral of Re z dtheta from 0."""
    x, s = c / speed, p / speed
    square = x * x
    e = inverse_rho * inverse_rho
    # 1 - x without cancellation
    versed = s * s / (1.0 + x)
    power, turn_power, bound, shrink = 1.0, 1.0, 1.0, e / (1.0 + (WIDER - 1.0) * s * s)
    real, imaginary, turn = 0.0, 0.0, 0.0
    for n in range(1, TERMS + 1):
        power *= e
        turn_power *= e / (1.0 + x)
        bound *= (2 * n - 1) * shrink
        if bound < SMALLEST:
            break
        value = AXIS[n - 1, (n - 1) // 2]
        for k in range((n - 1) // 2 - 1, -1, -1):
            value = value * square + AXIS[n - 1, k]
        if n % 2 == 0:
            imaginary += value * x * power
        else:
            real += value * power
            value = TURN[n - 1, 2 * n - 1]
            for k in range(2 * n - 2, -1, -1):
                value = value * versed + TURN[n - 1, k]
            turn += value * turn_power
    real *= s
    imaginary *= s
    scale = 1.0 / math.sqrt(1.0 + real * real + imaginary * imaginary)
    cosine = math.sqrt(0.5 * (1.0 + x))
    sine = 0.5 * s / cosine
    # (cosine + sine e3) (1 + real e2 - imaginary e3) scale
    return (-sine * real * scale, cosine * real * scale, (sine - cosine * imaginary) * scale,
            (cosine + sine * imaginary) * scale, versed * turn)
