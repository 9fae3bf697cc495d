"""Turning points of the axis of a symmetric top with a fixed point, from one state, without cancellation.

Symbols (rates in rad/s, everything divided by I1): u = cos(beta), n = P_gamma/I1, k = M g h/I1 >= 0 with h > 0 towards the centre of mass, so
that u = -1 is hanging; omega_c = omega_2 - i omega_1 across the axis, gamma the vertical in body axes, c = omega . gamma across the axis.

    u'^2 = 2 k (u - u1)(u - u2)(u - u3) = |omega_c|^2 (1 - u^2) - c^2,     -1 <= u1 <= u <= u2 <= 1 <= u3     (notes, "Symmetric Top", V_eff)

Three squares of moduli, linear in u, decide the motion; at the three roots each has a product that the conserved quantities give:

    x = 1 + u:          x1 x2 (2 k x3) = sigma^2,     sigma = (P_alpha + P_gamma)/I1 = c + n x
    y = 1 - u:          y1 y2 (2 k y3) = delta^2,     delta = (P_alpha - P_gamma)/I1 = c - n y,       y3 counted as u3 - 1
    w = |omega_c|^2:    w1 w2 w3 = chi^2,             chi = 2 k c - n w,                              w3 counted as 2 k u3 - 2 E/I1

From the product comes the factor that a subtraction would lose. What belongs to the third root carries the factor 2 k, so that k = 0 is an
ordinary value: x3, y3 below are 2 k (1 + u3), 2 k (u3 - 1).
"""

import math

from rigid_body_sim.compiled import compiled

# layout of what `turning_points` fills; index 1, 2, 3: value at that root
X1, X2, X3, Y1, Y2, Y3, W1, W2, W3 = range(9)
GAP, WIDE, NARROW = 9, 10, 11          # u2 - u1, 2 k (u3 - u1), 2 k (u3 - u2)
LOWER, UPPER, ABOVE = 12, 13, 14       # u - u1, u2 - u, 2 k (u3 - u)
SIGMA, DELTA, CHI, C, RISE = 15, 16, 17, 18, 19
X, Y, W = 20, 21, 22                   # at the state itself
SEPARATE, STEADY = 23, 24              # 1.0: u1 is the root apart from the other two (else u3 is); 1.0: u stays where it is
SIZE = 25


@compiled
def largest_root(b, c, d):
    """Return the largest root of r^3 + b r^2 - c r + d, all roots real, the largest well apart from the others.

    Newton's method from above, where the cubic is convex: it falls towards the root.
    """
    root = (-b + 2.0 * math.sqrt(max(b * b + 3.0 * c, 0.0))) / 3.0
    step = root
    while abs(step) > 1e-9 * root:
        slope = (3.0 * root + 2.0 * b) * root - c
        if slope <= 0.0:
            break
        step = (((root + b) * root - c) * root + d) / slope
        root -= step
    return root


@compiled
def parts(difference, product):
    """Return p, m >= 0 with p - m = difference and p m = product >= 0, and p + m."""
    half = 0.5 * difference
    root = math.sqrt(half * half + product)
    larger = abs(half) + root
    smaller = product / larger if larger > 0.0 else 0.0
    if half >= 0.0:
        return larger, smaller, 2.0 * root
    return smaller, larger, 2.0 * root


@compiled
def quotient(a, b):
    """Return a / b, or 0 where b is 0."""
    return a / b if b != 0.0 else 0.0


@compiled
def turning_points(a_re, a_im, b_re, b_im, o_re, o_im, n, k, out):
    """Fill out (layout above) for one state.

    Parameters
    ----------
    a_re, a_im, b_re, b_im : float
        Cayley-Klein parameters a = w + i z, b = y - i x of the attitude, |a|^2 + |b|^2 = 1.
    o_re, o_im : float
        omega_c.
    """
    x, y, w = 2.0 * (a_re * a_re + a_im * a_im), 2.0 * (b_re * b_re + b_im * b_im), o_re * o_re + o_im * o_im
    # c + i u' = -2 i a conj(b) omega_c
    z_re, z_im = a_re * b_re + a_im * b_im, a_im * b_re - a_re * b_im
    c, rise = 2.0 * (z_re * o_im + z_im * o_re), 2.0 * (z_im * o_im - z_re * o_re)
    sigma, delta, chi = c + n * x, c - n * y, 2.0 * k * c - n * w
    # u'^2 = rise^2 + 2 fall (-s) + bend s^2 ... in s = distance from the nearest pole, less its present value
    top = y <= x
    h, near, c_near = (k, y, c) if top else (-k, x, -c)
    bend = (4.0 * h - n * n) - (4.0 * h * near + w)
    fall = 2.0 * h * near + w - n * c_near - near * (h * near + w)
    square = rise * rise
    steady = fall == 0.0 and square == 0.0
    if steady or bend * (bend * bend + 18.0 * h * fall) + 54.0 * h * h * square < 0.0:
        out[SEPARATE] = 0.0
        # where u stays as it is, any positive number serves
        above = max(w + n * n + 4.0 * k, 1e-300) if steady else largest_root(bend, 4.0 * h * fall, 4.0 * k * k * square)
        product = quotient(square, above)
        outward, inward, gap = parts(quotient(2.0 * (fall - h * product), above), product)
        lower, upper = (outward, inward) if top else (inward, outward)
        y1 = y + lower
        y2, y3 = max(y - upper, 0.0), max(above - 2.0 * k * y, 0.0)
        if 2.0 * k * y2 >= y3:
            y3 = quotient(delta * delta, y1 * y2)
        else:
            y2 = quotient(delta * delta, y1 * y3)
        wide, narrow = above + 2.0 * k * lower, above - 2.0 * k * upper
    else:
        out[SEPARATE] = 1.0
        energy = 0.5 * w - k * y
        linear = 2.0 * energy - n * delta
        r1 = largest_root(2.0 * energy - (4.0 * k - n * n), 4.0 * k * linear, 4.0 * k * k * delta * delta)
        y1 = r1 / (2.0 * k)
        product = delta * delta / r1
        y2, y3, narrow = parts(2.0 * (k * product - linear) / r1, product)
        y3, narrow = 2.0 * k * y3, 2.0 * k * narrow
        above, wide, gap = 2.0 * k * y + y3, r1 + y3, y1 - y2
        if 2.0 * y > y1 + y2:
            upper = max(y - y2, 0.0)
            lower = quotient(square, upper * above)
        else:
            lower = y1 - y
            upper = quotient(square, lower * above)
    x2, x3 = x + upper, 2.0 * k * x + above
    w1, w2, w3 = w + 2.0 * k * lower, max(w - 2.0 * k * upper, 0.0), max(above - w, 0.0)
    if w2 >= w3:
        w3 = quotient(chi * chi, w1 * w2)
    else:
        w2 = quotient(chi * chi, w1 * w3)
    out[X1], out[X2], out[X3] = quotient(sigma * sigma, x2 * x3), x2, x3
    out[Y1], out[Y2], out[Y3], out[W1], out[W2], out[W3] = y1, y2, y3, w1, w2, w3
    out[GAP], out[WIDE], out[NARROW], out[LOWER], out[UPPER], out[ABOVE] = gap, wide, narrow, lower, upper, above
    out[SIGMA], out[DELTA], out[CHI], out[C], out[RISE], out[X], out[Y], out[W] = sigma, delta, chi, c, rise, x, y, w
    out[STEADY] = 1.0 if steady else 0.0
