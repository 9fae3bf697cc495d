# SPDX-License-Identifier: Apache-2.0
"""Elementary functions with the same bits on every machine, with and without numba.

They call no function of the C library: they are made of sums, products, quotients and square
roots, each rounded once, in the order of the source, and of exact operations on exponents
(bits.py). Where the rounding of a term would show, the term is an unevaluated sum of two doubles
(double_double.py); a value and its low part are named x and x_low. The bound in each docstring is
above all errors that were measured against mpmath (test/numerics/test_functions.py). One ulp is
the spacing of doubles at the exact result; correct rounding has errors of up to 0.5 ulp.

No argument raises an exception: overflow gives inf, an argument outside the domain nan, as in IEEE
754. Coefficients come from make_functions.py, tables from ``decimal``, whose logarithm and square
root are correctly rounded.

Sources: J.-M. Muller, Elementary Functions, 3rd ed. (2016), ch. 6 (table methods) and 11 (range
reduction); J.-M. Muller et al., Handbook of Floating-Point Arithmetic, 2nd ed. (2018), ch. 4;
W. J. Cody and W. Waite, Software Manual for the Elementary Functions (1980); M. H. Payne and
R. N. Hanek, ACM SIGNUM Newsletter 18 (1983) 19; P. T. P. Tang, ACM TOMS 15 (1989) 144 and 16
(1990) 378 (exponential function and logarithm by tables).
"""

import math
from decimal import ROUND_HALF_EVEN, Context, Decimal, localcontext

import numpy as np

from rigid_body_sim.compilation.jit import HAVE_NUMBA, compiled, compiled_inline
from rigid_body_sim.numerics.bits import balanced, power_of_two
from rigid_body_sim.numerics.double_double import SPLITTER, quick_two_sum, two_product, two_sum
from rigid_body_sim.numerics.phase import nearest

# sin x = x - x^3/6 + x^5 (S5 + S7 x^2 + ...), cos x = 1 - x^2/2 + x^4 (C4 + C6 x^2 + ...)
S5, S7, S9, S11, S13, S15 = (
    0.008333333333333333,
    -0.00019841269841268963,
    2.755731922232509e-06,
    -2.5052107236381626e-08,
    1.6058684400905804e-10,
    -7.595311845794959e-13)
C4, C6, C8, C10, C12, C14 = (
    0.041666666666666664,
    -0.0013888888888887398,
    2.480158729876569e-05,
    -2.7557317271729793e-07,
    2.08761462684032e-09,
    -1.1382632425521717e-11)
SIXTH, SIXTH_LOW = (
    0.16666666666666666,
    9.25185853854297e-18)
# exp r = 1 + r + r^2 (E2 + E3 r + ...)
E2, E3, E4, E5 = (
    0.4999999999999907,
    0.16666666666666533,
    0.04166667684879449,
    0.008333334787922985)
# log(1 + r) = r - r^2/2 + r^3 (L3 + L4 r + ...)
L3, L4, L5, L6, L7, L8 = (
    0.33333333333333337,
    -0.24999999999999936,
    0.19999999998384668,
    -0.1666666668664933,
    0.1428598221503723,
    -0.12498907920717149)
# atan u = u + u^3 (A3 + A5 u^2 + ...)
A3, A5, A7 = (
    -0.33333333333333254,
    0.19999999976718616,
    -0.14284697090256454)
# asinh x = x + x^3 (H3 + H5 x^2 + ...)
H3, H5, H7, H9, H11, H13, H15 = (
    -0.16666666666666666,
    0.07499999999999808,
    -0.044642857140888795,
    0.03038194368755898,
    -0.022372020353798042,
    0.017339684470221984,
    -0.013350438429467357)

# 2 pi, pi and pi/2
TURN, TURN_LOW = (
    6.283185307179586,
    2.4492935982947064e-16)
HALF_TURN, HALF_TURN_LOW = (
    3.141592653589793,
    1.2246467991473532e-16)
QUARTER_TURN, QUARTER_TURN_LOW = (
    1.5707963267948966,
    6.123233995736766e-17)
# pi/2 as three parts of at most 33 bits, whose multiples up to 2^20 are exact, and a rest
QUARTER_1, QUARTER_2, QUARTER_3, QUARTER_4 = (
    1.5707963267341256,
    6.077100506303966e-11,
    2.0222662487111665e-21,
    8.4784276603689e-32)
# log 2 / 128 and log 2, whose first parts have 35 and 42 bits for the same reason
PART, PART_LOW = (
    0.0054152123482253955,
    -1.0082281460997769e-13)
DOUBLING, DOUBLING_LOW = (
    0.6931471805598903,
    5.497923018708371e-14)
# 1/(2 pi) in hexadecimal
TURN_DIGITS = (
    '28be60db9391054a7f09d5f47d4d377036d8a5664f10e4107f9458eaf7aef1586dc91b8e909374b801924bba82'
    '7464873f877ac72c4a69cfba208d7d4baed1213a671c09ad17df904e64758e60d4ce7d272117e2ef7e4a0ec7fe'
    '25fff7816603fbcbc462d6829b47db4d9fb3c9f2c26dd3d18fd9a797fa8b5d49eeb1faf97c5ecf41ce7de294a4'
    'ba9afed7ec47e357421580cc11bf1edaeafc')

PARTS = 184.6649652337873                # 128 / log 2
QUARTERS = 0.6366197723675814            # 2 / pi, quarter turns per radian
COUNTED = 1647099.0                      # rad; smaller angles have at most 2^20 quarter turns
DIGIT = 2.0 ** -24                       # weight of a digit of TURN_DIGITS after the one before it
SIGNIFICANT, WHOLE = 9, 4                # digits from whole turns to 2^-139, and those above 1
SMALLEST_NORMAL = 2.0 ** -1022
# numba compiles a function once more where a constant is handed to it, but not for int(constant)
LARGEST_POWER = 1023                     # of two that a double has
AS_IT_IS, LIFTED = 0, 54                 # power of two by which the base of a power is multiplied
TINY = 2.0 ** -27                        # 1 plus the square of a smaller number rounds to 1
FAR = 2.0 ** -30                         # below it sqrt(1 + ratio^2) is 1, to 2^-61
SPLIT_27 = 1.5 * 2.0 ** 26               # adding and subtracting it rounds to multiples of 2^-26
HUGE, TINIER = 2.0 ** 500, 2.0 ** -400   # squares of the numbers between are exact as pairs
SHRINK, GROW = 2.0 ** -600, 2.0 ** 600   # scale numbers beyond those bounds


def _table(values):
    """Return constants in the form that is indexed fastest: array in numba, tuple in Python."""
    return np.array(values) if HAVE_NUMBA else tuple(values)


def _rounded(value, bits):
    """Return a Decimal as two doubles: rounded to a multiple of 2^-bits, and the rest."""
    high = math.ldexp(round(value * 2 ** bits), -bits)
    return high, float(value - Decimal(high))


def _powers():
    """Return 2^(j/128) as pairs of doubles, for j = 0 ... 127."""
    step = Decimal(2)
    for _ in range(7):
        step = step.sqrt()
    values, table = [step ** j for j in range(128)], []
    for value in values:
        table += [float(value), float(value - Decimal(float(value)))]
    return table


def _logarithms():
    """Return rows of four numbers for c near j/256: 1/c, log c and its low part, 0.

    1/c is a multiple of 1/256, so that products with it are short; the high parts are multiples of
    2^-42, like DOUBLING, so that their sums are exact. There are entries from j = 181 to 362.
    """
    table = [0.0] * (4 * 181)
    for j in range(181, 363):
        inverse = round(Decimal(256 * 256) / j)
        table += [inverse / 256, *_rounded(-(Decimal(inverse) / 256).ln(), 42), 0.0]
    return table


def _arctangents():
    """Return atan(j/64) as pairs of doubles, for j = 0 ... 64.

    atan t - atan s = atan((t - s)/(1 + t s)), whose series converges fast for neighbours.
    """
    angle, table = Decimal(0), []
    for j in range(65):
        table += [float(angle), float(angle - Decimal(float(angle)))]
        u = Decimal(64) / (64 * 64 + j * (j + 1))
        angle += sum((-u * u) ** n * u / (2 * n + 1) for n in range(12))
    return table


with localcontext(Context(prec=50, rounding=ROUND_HALF_EVEN)):
    POWERS, LOGARITHMS, ARCTANGENTS = map(_table, (_powers(), _logarithms(), _arctangents()))
DIGITS = _table([float(int(TURN_DIGITS[at:at + 6], 16)) for at in range(0, len(TURN_DIGITS), 6)])


@compiled_inline
def _pair_plus(high, low, more):
    """Return high + low + more as a pair."""
    high, error = two_sum(high, more)
    return quick_two_sum(high, low + error)


@compiled_inline
def _less_turns(turns):
    """Return turns less a whole number of turns, for |turns| < 2^100."""
    # the first line reduces a huge number to a small one
    turns -= nearest(turns)
    return turns - nearest(turns)


@compiled
def _far_reduced(x):
    """Return the result of _reduced for any finite angle, by the method of Payne and Hanek.

    x is multiplied by those digits of 1/(2 pi) that matter: the digits before give whole turns,
    those after add less than 2^-139 turns, and no double is within 2^-65 turns of a multiple of
    pi/2 (Muller, section 11.3.2). The products of the halves of x and a digit are
    exact.
    """
    skipped = max(balanced(abs(x))[1] - 53, 0) // 24
    x *= power_of_two(-24 * skipped)
    split = SPLITTER * x
    upper = split - (split - x)
    lower = x - upper
    turns, low = 0.0, 0.0
    for j in range(SIGNIFICANT):
        upper *= DIGIT
        lower *= DIGIT
        digit = DIGITS[skipped + j]
        if j < WHOLE:
            turns, low = _pair_plus(turns, low, _less_turns(upper * digit))
            turns, low = _pair_plus(_less_turns(turns), low, _less_turns(lower * digit))
            turns = _less_turns(turns)
        else:
            turns, low = _pair_plus(turns, low, upper * digit)
            turns, low = _pair_plus(turns, low, lower * digit)
    quarters = nearest(4.0 * turns)
    turns, low = quick_two_sum(turns - 0.25 * quarters, low)
    r, error = two_product(turns, TURN)
    r, low = quick_two_sum(r, error + (turns * TURN_LOW + low * TURN))
    return int(quarters), r, low


@compiled_inline
def _reduced(x):
    """Return (n, r, r_low) with x = n pi/2 + r + r_low up to whole turns, |r| <= pi/4."""
    if abs(x) > COUNTED:
        return _far_reduced(x)
    n = nearest(QUARTERS * x)
    r, low = two_sum(x - n * QUARTER_1, -n * QUARTER_2)
    r, lower = two_sum(r, -n * QUARTER_3)
    r, low = quick_two_sum(r, (low + lower) - n * QUARTER_4)
    return int(n), r, low


@compiled_inline
def _sine(r, low):
    """Return sin(r + low) for 2^-62 < |r| <= pi/4."""
    z, z_low = two_product(r, r)
    sixth, sixth_low = two_product(z, SIXTH)
    sixth_low += z * SIXTH_LOW + z_low * SIXTH
    cube, cube_low = two_product(r, sixth)
    cube_low += r * sixth_low
    rest = r * z * z * (S5 + z * (S7 + z * (S9 + z * (S11 + z * (S13 + z * S15)))))
    s, error = quick_two_sum(r, -cube)
    return s + (error + (rest - cube_low + low * (1.0 - 0.5 * z)))


@compiled_inline
def _cosine(r, low):
    """Return cos(r + low) for |r| <= pi/4."""
    z, z_low = two_product(r, r)
    rest = z * z * (C4 + z * (C6 + z * (C8 + z * (C10 + z * (C12 + z * C14)))))
    c, error = quick_two_sum(1.0, -0.5 * z)
    return c + (error + (rest - 0.5 * z_low - r * low))


@compiled_inline
def _sine_of(n, r, low):
    """Return sin(n pi/2 + r + low)."""
    value = _cosine(r, low) if n & 1 else _sine(r, low)
    return -value if n & 2 else value


@compiled
def sin(x):
    """Return the sine of an angle (rad), any double, to 0.6 ulp; nan for inf."""
    if not TINY <= abs(x) < math.inf:
        return x if abs(x) < TINY else math.nan
    n, r, low = _reduced(x)
    return _sine_of(n, r, low)


@compiled
def cos(x):
    """Return the cosine of an angle (rad), any double, to 0.6 ulp; nan for inf."""
    if not TINY <= abs(x) < math.inf:
        return 1.0 if abs(x) < TINY else math.nan
    n, r, low = _reduced(x)
    return _sine_of(n + 1, r, low)


@compiled_inline
def sin_cos(x):
    """Return sine and cosine of an angle (rad): the same bits as sin and cos, in less time."""
    if not TINY <= abs(x) < math.inf:
        return (x, 1.0) if abs(x) < TINY else (math.nan, math.nan)
    n, r, low = _reduced(x)
    s, c = _sine(r, low), _cosine(r, low)
    if n & 1:
        s, c = c, -s
    return (-s, -c) if n & 2 else (s, c)


@compiled_inline
def _exponential(x, low):
    """Return exp(x + low) for -746 <= x <= 710 and |low| < 2^-40, rounded once also if subnormal.

    x = (128 k + j) log 2/128 + r with |r| <= log 2/256.
    """
    n = nearest(PARTS * x)
    r = (x - n * PART) - n * PART_LOW + low
    place = int(n)
    k, j = place >> 7, place & 127
    power = POWERS[2 * j]
    more = POWERS[2 * j + 1] + power * (r + r * r * (E2 + r * (E3 + r * (E4 + r * E5))))
    if k == 1024:
        return 2.0 * ((power + more) * power_of_two(int(LARGEST_POWER)))
    if k > -1022 or (k == -1022 and power + more >= 1.0):
        return (power + more) * power_of_two(k)
    # subnormal doubles are as far apart as doubles between 1 and 2, up to the power of two
    scale = power_of_two(k + 1022)
    s, error = quick_two_sum(1.0, power * scale)
    return ((s + (error + more * scale)) - 1.0) * SMALLEST_NORMAL


@compiled
def exp(x):
    """Return exp(x) to 0.51 ulp; inf above 709.78, 0 below -745.13."""
    if not -746.0 <= x <= 710.0:
        return 0.0 if x < 0.0 else x * math.inf
    return _exponential(x, 0.0)


@compiled_inline
def _reduced_logarithm(m, e):
    """Return (h, h_low, r): h + h_low + log(1 + r) = log(m 2^e), |r| < 0.00403.

    r = m c^-1 - 1 is made of two parts of m, with 27 and 26 bits, whose products with c^-1 are
    exact. So is their sum, for c^-1 has few bits: r is a multiple of 2^-61, and of 2^-60 where it
    is above 2^-8.
    """
    # the mask changes nothing: it shows the compiler that no index is negative
    place = 4 * (int(256.0 * m + 0.5) & 511)
    inverse = LOGARITHMS[place]
    upper = (m + SPLIT_27) - SPLIT_27
    return (e * DOUBLING + LOGARITHMS[place + 1], e * DOUBLING_LOW + LOGARITHMS[place + 2],
            (upper * inverse - 1.0) + (m - upper) * inverse)


@compiled_inline
def _cubic(r, square):
    """Return (log(1 + r) - r + r^2/2) / r^2."""
    return r * L3 + square * ((L4 + r * L5) + square * ((L6 + r * L7) + square * L8))


@compiled_inline
def _logarithm(m, e, more):
    """Return log(m 2^e) + more, for 181/256 <= m < 181/128 and a small correction `more`."""
    h, h_low, r = _reduced_logarithm(m, e)
    square = r * r
    s, low = quick_two_sum(h, r)
    return s + (low + ((h_low + more) + square * (_cubic(r, square) - 0.5)))


@compiled_inline
def _logarithm_pair(m, e):
    """Return log(m 2^e) as a pair, to 2^-68 of itself."""
    h, h_low, r = _reduced_logarithm(m, e)
    square, square_low = two_product(r, r)
    s, low = quick_two_sum(h, r)
    s, lower = quick_two_sum(s, -0.5 * square)
    rest = square * _cubic(r, square)
    return quick_two_sum(s, (low + lower) + (h_low + (rest - 0.5 * square_low)))


@compiled
def _log_of_rest(x):
    """Return the logarithm of a double that is not both normal and positive."""
    if 0.0 < x < math.inf:
        m, e = balanced(x * 2.0 ** 54)
        return _logarithm(m, e - 54, 0.0)
    return -math.inf if x == 0.0 else math.nan if x < 0.0 else x


@compiled
def log(x):
    """Return the natural logarithm to 0.51 ulp; -inf for 0, nan for x < 0."""
    if not SMALLEST_NORMAL <= x < math.inf:
        return _log_of_rest(x)
    m, e = balanced(x)
    return _logarithm(m, e, 0.0)


@compiled_inline
def _power(x, y, shift):
    """Return (x 2^-shift)^y for a normal x > 0 and 2^-70 <= |y| <= 1e19."""
    m, e = balanced(x)
    logarithm, low = _logarithm_pair(m, e - shift)
    z, z_low = two_product(y, logarithm)
    if not -746.0 <= z <= 710.0:
        return 0.0 if z < 0.0 else math.inf
    return _exponential(z, z_low + y * low)


@compiled
def _power_of_rest(x, y):
    """Return x^y for the arguments that power does not treat itself."""
    if y == 0.0 or x == 1.0:
        return 1.0
    if not x >= 0.0 or y != y:
        return math.nan
    if x == 0.0 or x == math.inf:
        return math.inf if (x == 0.0) == (y < 0.0) else 0.0
    if abs(y) < 2.0 ** -70:
        return 1.0
    # |log x| > 1e-16, so a larger exponent overflows or underflows all the same
    y = min(max(y, -1e19), 1e19)
    if x < SMALLEST_NORMAL:
        return _power(x * 2.0 ** 54, y, int(LIFTED))
    return _power(x, y, int(AS_IT_IS))


@compiled
def power(x, y):
    """Return x^y = exp(y log x) for x >= 0, to 0.52 ulp; nan for x < 0 and any y.

    x^0 = 1^y = 1 for any x and y, and limits at 0 and inf, as in C.
    """
    if not (SMALLEST_NORMAL <= x < math.inf and 2.0 ** -70 <= abs(y) <= 1e19):
        return _power_of_rest(x, y)
    return _power(x, y, int(AS_IT_IS))


@compiled
def atan2(y, x):
    """Return the angle (rad) of the point (x, y), -pi to pi, to 0.51 ulp.

    Signs and infinities are treated as in C: the angle has the sign of y, also that of a zero.
    For t = |y|/|x| <= 1 and c = k/64 near t: atan t = atan c + atan u, u = (t - c)/(1 + t c).
    """
    if x != x or y != y:
        return math.nan
    a, b = abs(y), abs(x)
    behind, steep = math.copysign(1.0, x) < 0.0, a > b
    base, base_low, sign = 0.0, 0.0, 1.0
    if steep:
        a, b = b, a
        base, base_low, sign = QUARTER_TURN, QUARTER_TURN_LOW, 1.0 if behind else -1.0
    elif behind:
        base, base_low, sign = HALF_TURN, HALF_TURN_LOW, -1.0
    if a == math.inf:
        a, b = 1.0, 1.0
    t = a / b if b > 0.0 else 0.0
    if t < FAR:
        return math.copysign(base + (base_low + sign * t), y)
    if b > HUGE or b < TINIER:
        scale = SHRINK if b > HUGE else GROW
        a, b = a * scale, b * scale
    k = int(64.0 * t + 0.5) & 127
    c = 0.015625 * k
    # numerator a - c b and denominator b + c a
    p, p_low = two_product(c, b)
    n, n_low = two_sum(a - p, -p_low)
    p, p_low = two_product(c, a)
    d, d_low = quick_two_sum(b, p)
    u = n / d
    p, error = two_product(u, d)
    u_low = (((n - p) - error) + (n_low - u * (d_low + p_low))) / d
    z = u * u
    rest = ARCTANGENTS[2 * k + 1] + (u_low + u * z * (A3 + z * (A5 + z * A7)))
    s, low = two_sum(base, sign * ARCTANGENTS[2 * k])
    s, lower = two_sum(s, sign * u)
    return math.copysign(s + (lower + (low + (base_low + sign * rest))), y)


@compiled
def asinh(x):
    """Return the inverse hyperbolic sine log(x + sqrt(x^2 + 1)) to 0.51 ulp."""
    a = abs(x)
    if a < 0.125:
        if a < TINY:
            return x
        z = x * x
        return x + x * z * (H3 + z * (H5 + z * (H7 + z * (H9 + z * (H11 + z * (H13 + z * H15))))))
    if not a < math.inf:
        return x
    if a > 2.0 ** 28:
        m, e = balanced(a)
        return math.copysign(_logarithm(m, e + 1, 0.0), x)
    p, p_low = two_product(a, a)
    s, s_low = two_sum(p, 1.0)
    w, w_low = _root(s, p_low + s_low)
    v, v_low = quick_two_sum(w, a)
    m, e = balanced(v)
    return math.copysign(_logarithm(m, e, (v_low + w_low) / v), x)


@compiled_inline
def _root(s, low):
    """Return the square root of s + low as a pair."""
    w = math.sqrt(s)
    p, error = two_product(w, w)
    return w, (((s - p) - error) + low) / (w + w)


@compiled_inline
def _length(a, b, c):
    """Return sqrt(a^2 + b^2 + c^2) for a, b, c >= 0, not all of them 0."""
    largest = max(a, max(b, c))
    unscale = 1.0
    if largest > HUGE:
        a, b, c, largest, unscale = a * SHRINK, b * SHRINK, c * SHRINK, largest * SHRINK, GROW
    elif largest < TINIER:
        a, b, c, largest, unscale = a * GROW, b * GROW, c * GROW, largest * GROW, SHRINK
    least = FAR * largest
    a = a if a > least else 0.0
    b = b if b > least else 0.0
    c = c if c > least else 0.0
    p, p_low = two_product(a, a)
    q, q_low = two_product(b, b)
    r, r_low = two_product(c, c)
    s, low = two_sum(p, q)
    s, lower = two_sum(s, r)
    w, w_low = _root(s, (low + lower) + ((p_low + q_low) + r_low))
    return (w + w_low) * unscale


@compiled
def hypot(x, y):
    """Return sqrt(x^2 + y^2) to 0.51 ulp (0.76 if subnormal), however large or small.

    As in C, inf and nan together give inf.
    """
    a, b = abs(x), abs(y)
    if a == math.inf or b == math.inf:
        return math.inf
    if not a + b > 0.0:
        return a + b
    return _length(a, b, 0.0)


@compiled
def hypot3(x, y, z):
    """Return sqrt(x^2 + y^2 + z^2) to 0.51 ulp (0.76 if subnormal), however large or small.

    As in C, inf and nan together give inf.
    """
    a, b, c = abs(x), abs(y), abs(z)
    if a == math.inf or b == math.inf or c == math.inf:
        return math.inf
    if not a + b + c > 0.0:
        return a + b + c
    return _length(a, b, c)


@compiled
def hypot3_of_each(vectors, out):
    """Fill out, shape (n,), with the lengths of n vectors, shape (n, 3)."""
    for k in range(len(out)):
        out[k] = hypot3(vectors[k, 0], vectors[k, 1], vectors[k, 2])
