# SPDX-License-Identifier: Apache-2.0
"""Exact operations on the exponents of doubles: compiled code and plain Python give the same bits.

Compiled code reads and writes the exponent field of the double; plain Python calls ``math.frexp``
and ``math.ldexp``, which round nothing here.
"""

import math

from rigid_body_sim.compilation.jit import HAVE_NUMBA, compiled_inline

LOWER = 181 / 256     # about sqrt(1/2)

if HAVE_NUMBA:
    from llvmlite import ir
    from numba.core import types
    from numba.extending import intrinsic

    @intrinsic
    def _bits(typing_context, x):
        """Return the 64 bits of a double as an integer."""
        def generate(context, builder, signature, arguments):
            return builder.bitcast(arguments[0], ir.IntType(64))
        return types.int64(types.float64), generate

    @intrinsic
    def _double(typing_context, bits):
        """Return the double of 64 bits."""
        def generate(context, builder, signature, arguments):
            return builder.bitcast(arguments[0], ir.DoubleType())
        return types.float64(types.int64), generate

    LOWER_BITS = 0x3FE6A00000000000     # the bits of LOWER

    @compiled_inline
    def _balanced(x):
        bits = _bits(x)
        e = (bits - LOWER_BITS) >> 52
        return _double(bits - (e << 52)), e

    @compiled_inline
    def _power_of_two(k):
        return _double((k + 1023) << 52)
else:
    def _balanced(x):
        m, e = math.frexp(x)
        return (m, e) if m >= LOWER else (m + m, e - 1)

    def _power_of_two(k):
        return math.ldexp(1.0, k)


@compiled_inline
def balanced(x):
    """Return (m, e) with x = m 2^e and 181/256 <= m < 181/128, for a normal x > 0."""
    return _balanced(x)


@compiled_inline
def power_of_two(k):
    """Return 2^k for an integer -1022 <= k <= 1023."""
    return _power_of_two(k)
