"""Turning points of the axis of a symmetric top with a fixed point, from one state, to more digits than a double has.

Symbols (rates divided by I1): u = cos(beta), n = P_gamma/I1, k = M g h/I1 >= 0 with h > 0 towards the centre of mass, so that u = -1 is
hanging; omega_c = omega_2 - i omega_1 across the axis, gamma the vertical in body axes, c = omega . gamma across the axis.

    u'^2 = 2 k (u - u1)(u - u2)(u - u3) = |omega_c|^2 (1 - u^2) - c^2,   -1 <= u1 <= u <= u2 <= 1 <= u3   (notes, "Symmetric Top", V_eff)

Three squares of moduli, linear in u, decide the motion; at the three roots each has a product that the conserved quantities give:

    x = 1 + u:          x1 x2 x3 = sigma^2,     sigma = (P_alpha + P_gamma)/I1 = c + n x,     x3 = 2 k (1 + u3)
    y = 1 - u:          y1 y2 y3 = delta^2,     delta = (P_alpha - P_gamma)/I1 = c - n y,     y3 = 2 k (u3 - 1)
    w = |omega_c|^2:    w1 w2 w3 = chi^2,       chi = 2 k c - n w,                            w3 = 2 k u3 - 2 E/I1

From the product comes the factor that a subtraction would lose. What belongs to the third root carries the factor 2 k, so that k = 0 is an
ordinary value. Everything is a pair of doubles (pairs.py): differences like 4 k - n^2 decide region and modulus, and the mean rates, whose
errors would grow with time, need all digits. What comes after these takes the high parts.
"""

import math

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.numerics.double_double import multiply_double, quick_two_sum
from rigid_body_sim.numerics.pairs import (
    minus,
    not_negative,
    over,
    plus,
    products,
    put,
    root_of,
    scaled,
    times,
)

# layout of what `turning_points` fills: pairs, then their like as single doubles; index 1, 2, 3: value at that root
X1, X2, X3, Y1, Y2, Y3, X, Y, WIDE, NARROW, SIGMA, DELTA = range(0, 24, 2)     # X, Y at the state; 2 k (u3 - u1), 2 k (u3 - u2)
W1, W2, W3, W, CHI, C, RISE = range(24, 31)                                    # W, C, RISE = u' at the state
GAP, LOWER, UPPER, ABOVE = range(31, 35)                                       # u2 - u1, u - u1, u2 - u, 2 k (u3 - u)
SEPARATE, STEADY = 35, 36       # 1.0: u1 is the root apart from the other two (else u3 is); 1.0: u stays where it is
SIZE = 37


@compiled
def largest_root(b, c, d):
    """Return the largest root of r^3 + b r^2 - c r + d (pairs), all roots real, the largest well apart from the others.

    Newton's method from above, where the cubic is convex: it falls towards the root. The last step is made in pairs.
    """
    bh, ch, dh = b[0], c[0], d[0]
    r = (-bh + 2.0 * math.sqrt(max(bh * bh + 3.0 * ch, 0.0))) / 3.0
    step, slope = r, 0.0
    while abs(step) > 1e-9 * r:
        slope = (3.0 * r + 2.0 * bh) * r - ch
        if slope <= 0.0:
            return r, 0.0
        step = (((r + bh) * r - ch) * r + dh) / slope
        r -= step
    if slope == 0.0:
        return r, 0.0
    slope = (3.0 * r + 2.0 * bh) * r - ch
    value = plus(b, (r, 0.0))
    value = minus(multiply_double(value[0], value[1], r), c)
    value = plus(multiply_double(value[0], value[1], r), d)
    return quick_two_sum(r, -value[0] / slope)


@compiled
def parts(difference, product):
    """Return p, m >= 0 with p - m = difference and p m = product >= 0, and p + m (pairs)."""
    half = scaled(difference, 0.5)
    square = plus(times(half, half), product)
    mean = root_of(square)
    if half[0] >= 0.0:
        larger = plus(mean, half)
        return larger, over(product, larger), scaled(mean, 2.0)
    larger = minus(mean, half)
    return over(product, larger), larger, scaled(mean, 2.0)


@compiled
def shared(first, second, product, weight):
    """Return two numbers >= 0 (pairs) of known product, the smaller one (the first counted `weight` times) recomputed from the larger."""
    if weight * first[0] >= second[0]:
        return first, over(product, first)
    return over(product, second), second


@compiled
def turning_points(a_re, a_im, b_re, b_im, unit_a, unit_b, o_re, o_im, n, k, out):
    """Fill out (layout above) for one state.

    Parameters
    ----------
    a_re, a_im, b_re, b_im, unit_a, unit_b : float
        Cayley-Klein parameters a = w + i z, b = y - i x of the attitude, of any norm; a is counted in unit_a, b in unit_b (powers of two).
    o_re, o_im : float
        omega_c.
    n, k : pair
    """
    a2, b2, w = products(a_re, a_re, a_im, a_im), products(b_re, b_re, b_im, b_im), products(o_re, o_re, o_im, o_im)
    per = over((2.0, 0.0), plus(scaled(a2, unit_a * unit_a), scaled(b2, unit_b * unit_b)))
    x, y = times(a2, per), times(b2, per)
    # c + i u' = -2 i a conj(b) omega_c
    z_re, z_im = products(a_re, b_re, a_im, b_im), products(a_im, b_re, -a_re, b_im)
    c = times(plus(multiply_double(z_re[0], z_re[1], o_im), multiply_double(z_im[0], z_im[1], o_re)), per)
    rise = times(minus(multiply_double(z_im[0], z_im[1], o_im), multiply_double(z_re[0], z_re[1], o_re)), per)
    sigma, delta, chi = plus(c, times(n, x)), minus(c, times(n, y)), minus(scaled(times(k, c), 2.0), times(n, w))
    k2, square = scaled(k, 2.0), times(rise, rise)
    limit = minus(scaled(k, 4.0), times(n, n))
    top = y[0] <= x[0]
    # u'^2 = square + 2 fall s + bend s^2 - 2 h s^3, s the distance from the nearest pole less its present value
    sign, near = (1.0, y) if top else (-1.0, x)
    h, hw = scaled(k, sign), plus(scaled(times(k, near), sign), w)
    bend = limit if top else minus(scaled(k, -4.0), times(n, n))
    bend = minus(bend, plus(scaled(times(k, near), 4.0 * sign), w))
    fall = minus(plus(scaled(times(k, near), 2.0 * sign), w), plus(scaled(times(n, c), sign), times(near, hw)))
    steady = fall[0] == 0.0 and square[0] == 0.0
    if steady or bend[0] * (bend[0] * bend[0] + 18.0 * h[0] * fall[0]) + 54.0 * h[0] * h[0] * square[0] < 0.0:
        out[SEPARATE] = 0.0
        # where u stays as it is, any positive number serves
        above = (max(w[0] + n[0] * n[0] + 4.0 * k[0], 1e-300), 0.0) if steady else largest_root(
            bend, scaled(times(h, fall), 4.0), times(times(k2, k2), square))
        product = over(square, above)
        outward, inward, gap = parts(over(scaled(minus(fall, times(h, product)), 2.0), above), product)
        lower, upper = (outward, inward) if top else (inward, outward)
        y1 = plus(y, lower)
        y2, y3 = shared(not_negative(minus(y, upper)), not_negative(minus(above, times(k2, y))), over(times(delta, delta), y1), k2[0])
        wide, narrow = plus(above, times(k2, lower)), minus(above, times(k2, upper))
    else:
        out[SEPARATE] = 1.0
        energy2 = minus(w, times(k2, y))
        linear, d2 = minus(energy2, times(n, delta)), times(delta, delta)
        r1 = largest_root(minus(energy2, limit), scaled(times(k, linear), 4.0), times(times(k2, k2), d2))
        y1, product = over(r1, k2), over(d2, r1)
        y2, y3, narrow = parts(over(scaled(minus(times(k, product), linear), 2.0), r1), product)
        y3, narrow = times(k2, y3), times(k2, narrow)
        above, wide, gap = plus(times(k2, y), y3), plus(r1, y3), minus(y1, y2)
        if 2.0 * y[0] > y1[0] + y2[0]:
            upper = not_negative(minus(y, y2))
            lower = over(square, times(upper, above))
        else:
            lower = minus(y1, y)
            upper = over(square, times(lower, above))
    x2, x3 = plus(x, upper), plus(times(k2, x), above)
    w1 = plus(w, times(k2, lower))
    w2, w3 = shared(not_negative(minus(w, times(k2, upper))), not_negative(minus(above, w)), over(times(chi, chi), w1), 1.0)
    put(out, X1, over(times(sigma, sigma), times(x2, x3)))
    put(out, X2, x2)
    put(out, X3, x3)
    put(out, Y1, y1)
    put(out, Y2, y2)
    put(out, Y3, y3)
    put(out, WIDE, wide)
    put(out, NARROW, narrow)
    put(out, SIGMA, sigma)
    put(out, DELTA, delta)
    put(out, X, x)
    put(out, Y, y)
    out[W1], out[W2], out[W3], out[GAP], out[LOWER], out[UPPER], out[ABOVE] = w1[0], w2[0], w3[0], gap[0], lower[0], upper[0], above[0]
    out[CHI], out[C], out[RISE], out[W], out[STEADY] = chi[0], c[0], rise[0], w[0], 1.0 if steady else 0.0
