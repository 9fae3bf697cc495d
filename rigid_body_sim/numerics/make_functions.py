# SPDX-License-Identifier: Apache-2.0
"""Print the constants of functions.py: ``python rigid_body_sim/numerics/make_functions.py``.

Each polynomial is fitted to what a function is beyond its leading terms, which functions.py
adds with more than a double's digits. The fit interpolates at the Chebyshev nodes of an interval,
which comes within a small factor of the best uniform approximation (L. N. Trefethen, Approximation
Theory and Approximation Practice, theorem 16.1); fits in z = x^2 serve odd and even functions. The
script needs mpmath, functions.py does not.
"""

import mpmath as mp

DIGITS = 80


def fit(function, first, last, count):
    """Return `count` coefficients, lowest power first, of the interpolant at Chebyshev nodes."""
    middle, half = (first + last) / 2, (last - first) / 2
    nodes = [middle + half * mp.cos(mp.pi * (2 * k + 1) / (2 * count)) for k in range(count)]
    powers = mp.matrix(count, count)
    for row, node in enumerate(nodes):
        for column in range(count):
            powers[row, column] = node ** column
    return [float(c) for c in mp.lu_solve(powers, mp.matrix([function(x) for x in nodes]))]


def even(function):
    """Return the function of z that takes the value function(sqrt z)."""
    return lambda z: function(mp.sqrt(z))


def coefficients():
    """Return {names: values}: the constants of functions.py, by the names they have there."""
    with mp.workdps(DIGITS):
        eighth = (mp.pi / 4) ** 2
        return {
            # sin x = x - x^3/6 + x^5 (S5 + S7 z + ...) and cos x = 1 - z/2 + z^2 (C4 + C6 z + ...)
            'S5 S7 S9 S11 S13 S15': fit(
                even(lambda x: (mp.sin(x) - x + x**3 / 6) / x**5), 0, eighth, 6),
            'C4 C6 C8 C10 C12 C14': fit(
                even(lambda x: (mp.cos(x) - 1 + x**2 / 2) / x**4), 0, eighth, 6),
            # exp r = 1 + r + r^2 (E2 + E3 r + ...) for |r| <= log 2/256
            'E2 E3 E4 E5': fit(
                lambda r: (mp.exp(r) - 1 - r) / r**2, -mp.log(2) / 256, mp.log(2) / 256, 4),
            # log(1 + r) = r - r^2/2 + r^3 (L3 + L4 r + ...) for -0.00399 < r < 0.00403
            'L3 L4 L5 L6 L7 L8': fit(
                lambda r: (mp.log(1 + r) - r + r**2 / 2) / r**3, -0.00399, 0.00403, 6),
            # atan u = u + u^3 (A3 + A5 z + ...) for |u| <= 1/128
            'A3 A5 A7': fit(
                even(lambda u: (mp.atan(u) - u) / u**3), 0, mp.mpf(1) / 128**2, 3),
            # asinh x = x + x^3 (H3 + H5 z + ...) for |x| <= 1/8
            'H3 H5 H7 H9 H11 H13 H15': fit(
                even(lambda x: (mp.asinh(x) - x) / x**3), 0, mp.mpf(1) / 64, 7)}


def parts(value, *bits):
    """Return parts of a value, multiples of 2^-bits, and the double nearest to the rest."""
    found = []
    for places in bits:
        found.append(float(mp.nint(value * mp.mpf(2)**places) / mp.mpf(2)**places))
        value -= found[-1]
    return [*found, float(value)]


def pair(value):
    """Return the double nearest to a value, and the one nearest to the rest."""
    return [float(value), float(value - float(value))]


def constants():
    """Return {names: values} of the other constants of functions.py."""
    with mp.workdps(400):
        return {
            'SIXTH SIXTH_LOW': pair(mp.mpf(1) / 6),
            'TURN TURN_LOW': pair(2 * mp.pi),
            'HALF_TURN HALF_TURN_LOW': pair(mp.pi),
            'QUARTER_TURN QUARTER_TURN_LOW': pair(mp.pi / 2),
            # at most 33 bits each
            'QUARTER_1 QUARTER_2 QUARTER_3 QUARTER_4': parts(mp.pi / 2, 32, 65, 98),
            # 35 and 42 bits
            'PART PART_LOW': parts(mp.log(2) / 128, 42),
            'DOUBLING DOUBLING_LOW': parts(mp.log(2), 42)}


def turn_digits():
    """Return the first 51 * 24 bits of 1/(2 pi) in hexadecimal."""
    with mp.workdps(400):
        return f'{int(mp.floor(mp.mpf(2)**(51 * 24) / (2 * mp.pi))):0306x}'


def listing():
    """Return all constants as lines of Python."""
    lines = []
    for names, values in (coefficients() | constants()).items():
        lines.append(f'{", ".join(names.split())} = (')
        lines.append('    ' + ',\n    '.join(map(repr, values)) + ')')
    digits = turn_digits()
    lines += ['TURN_DIGITS = (', *(f"    '{digits[k:k + 90]}'" for k in range(0, 306, 90))]
    return '\n'.join(lines) + ')'


if __name__ == '__main__':
    print(listing())
