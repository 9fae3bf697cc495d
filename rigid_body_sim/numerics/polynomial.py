# SPDX-License-Identifier: Apache-2.0
"""The zeros of a polynomial of degree six, or less, in an interval.

Between two neighbouring zeros of its derivative a polynomial is monotone, so bisection finds the
one zero that may lie there. The zeros of the derivative are found in the same way, down to the
first degree.
"""

from rigid_body_sim.compilation.jit import compiled

HALVINGS = 120    # of an interval: zeros that are 1e20 times smaller than it keep their digits


@compiled
def zeros_up_to(p, end):
    """Return the places in (0, end] at which a polynomial of degree six at most may be zero.

    All its zeros there are among them, but such as touch zero without a change of sign need not
    be. The other places are zeros of its derivatives, and the end.

    Parameters
    ----------
    p : tuple of 7 floats
        Its coefficients, that of the constant first; the last ones are 0 of a lower degree.
    end : float

    Returns
    -------
    tuple of 6 floats
    """
    first = _derivative(p)
    second = _derivative(first)
    third = _derivative(second)
    fourth = _derivative(third)
    places = end, end, end, end, end, end
    for q in (_derivative(fourth), fourth, third, second, first, p):
        places = (_zero(q, 0.0, places[0]), _zero(q, places[0], places[1]),
                  _zero(q, places[1], places[2]), _zero(q, places[2], places[3]),
                  _zero(q, places[3], places[4]), _zero(q, places[4], places[5]))
    return places


@compiled
def _derivative(p):
    """Return the coefficients of the derivative."""
    return p[1], 2.0 * p[2], 3.0 * p[3], 4.0 * p[4], 5.0 * p[5], 6.0 * p[6], 0.0


@compiled
def _value(p, x):
    """Return the value of a polynomial (Horner's rule)."""
    return p[0] + x * (p[1] + x * (p[2] + x * (p[3] + x * (p[4] + x * (p[5] + x * p[6])))))


@compiled
def _zero(p, low, high):
    """Return the zero between two arguments of different signs; the higher one without such."""
    below = _value(p, low) < 0.0
    if below == (_value(p, high) < 0.0):
        return high
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        if not low < middle < high:
            break
        if (_value(p, middle) < 0.0) == below:
            low = middle
        else:
            high = middle
    return high
