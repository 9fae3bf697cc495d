# SPDX-License-Identifier: Apache-2.0
"""Recurrences on eight numbers at a time, for the vector unit of the processor.

A recurrence is written once, as a function of an object that has the operations. With a
:class:`Plain` it runs as ordinary Python; with a :class:`Written` the same lines append vector
instructions to a function that numba is compiling. Sums are made in the order in which they are
written; a product and the sum that takes it (`gather`) round once, on every processor.
"""

from itertools import chain

import numpy as np

from rigid_body_sim.compilation.fused import python_fma
from rigid_body_sim.compilation.jit import HAVE_NUMBA

LANES = 8
NARROW = 4    # numbers in a register of a processor without AVX-512
IN_TURN, IN_HALVES = 'in turn', 'in halves'    # eight lanes there
ONE_BITS = 1023 << 52    # the bits of the double 1.0


class Plain:
    """The operations on floats and on arrays of eight floats."""

    def number(self, value):
        """Return a constant."""
        return value

    def none(self):
        """Return eight zeros."""
        return np.zeros(LANES)

    def times(self, a, b):
        """Return a b."""
        return a * b

    def plus(self, a, b):
        """Return a + b."""
        return a + b

    def minus(self, a):
        """Return -a."""
        return -a

    def gather(self, a, b, c):
        """Return a b + c, rounded once."""
        if isinstance(a, np.ndarray) or isinstance(b, np.ndarray) or isinstance(c, np.ndarray):
            lanes = [one.tolist() if isinstance(one, np.ndarray) else [one] * LANES
                     for one in (a, b, c)]
            return np.array(list(map(python_fma, *lanes)))
        return python_fma(a, b, c)

    def everywhere(self, x):
        """Return an array of eight times x."""
        return np.full(LANES, x)

    def next(self, v):
        """Return the lanes moved one place down, with 0 in the last."""
        return np.append(v[1:], 0.0)

    def keep(self, v, count):
        """Return v; of its lanes only the first `count` are asked for from here on."""
        return v

    def first(self, v):
        """Return the number in the first lane."""
        return float(v[0])

    def with_lane(self, v, lane, x):
        """Return v with x in one lane."""
        return np.where(np.arange(LANES) == lane, x, v)

    def load(self, array, at):
        """Return the eight numbers of an array that begin at a place."""
        return np.asarray(array[at:at + LANES])

    def store(self, x, array, at):
        """Write one number into an array."""
        array[at] = x

    def put(self, v, array, at):
        """Write eight numbers into an array."""
        array[at:at + LANES] = v

    def divided(self, a, b):
        """Return a / b."""
        return a / b

    def root(self, a):
        """Return the square root of a."""
        return np.sqrt(a)

    def power(self, a, exponent):
        """Return a to an exponent between 0 and 1, for a > 0, to 6 % of the exponent.

        The bits of a double, read as an integer, grow as its logarithm.
        """
        bits = (a.view(np.int64) - ONE_BITS) * exponent
        return (bits.astype(np.int64) + ONE_BITS).view(np.float64)

    def where_less(self, a, b, x, y):
        """Return x where a < b, else y."""
        return np.where(a < b, x, y)

    def place(self, at, stride, i):
        """Return the place at + stride i in an array."""
        return at + stride * i

    def repeat(self, first, last, values, act):
        """Apply ``values = act(i, values)`` for i = first ... last - 1 and return the values."""
        for i in range(first, last):
            values = act(i, values)
        return values

    def groups(self, portions):
        """Return the lists whose sums are made in one loop: one of all portions."""
        return [[*chain.from_iterable(portions)]]


if HAVE_NUMBA:
    from llvmlite import ir
    from numba.core import cgutils

    DOUBLE, INDEX, PLACE = ir.DoubleType(), ir.IntType(64), ir.IntType(32)

    class Written:
        """The operations of Plain as LLVM instructions; an array is its first number's address.

        There are eight lanes, or fewer of a recurrence whose lanes are apart.
        """

        def __init__(self, builder, lanes=LANES):
            self.lanes, self._builder = lanes, builder
            self._vector = ir.VectorType(DOUBLE, lanes)

        def number(self, value):
            """Return a constant."""
            return ir.Constant(DOUBLE, value)

        def none(self):
            """Return eight zeros."""
            return self._each(0.0)

        def times(self, a, b):
            """Return a b."""
            return self._builder.fmul(a, b)

        def plus(self, a, b):
            """Return a + b."""
            return self._builder.fadd(a, b)

        def minus(self, a):
            """Return -a."""
            return self._builder.fneg(a)

        def gather(self, a, b, c):
            """Return a b + c, rounded once."""
            return self._function('fma', a, b, c)

        def everywhere(self, x):
            """Return a vector of eight times x."""
            absent = ir.Constant(self._vector, ir.Undefined)
            one = self._builder.insert_element(absent, x, ir.Constant(PLACE, 0))
            return self._shuffled(one, absent, [0] * self.lanes)

        def next(self, v):
            """Return the lanes moved one place down, with 0 in the last."""
            return self._shuffled(v, self._each(0.0), range(1, self.lanes + 1))

        def keep(self, v, count):
            """Return v; of its lanes only the first `count` are asked for from here on."""
            return v

        def first(self, v):
            """Return the number in the first lane."""
            return self._builder.extract_element(v, ir.Constant(PLACE, 0))

        def with_lane(self, v, lane, x):
            """Return v with x in one lane."""
            return self._builder.insert_element(v, x, ir.Constant(PLACE, lane))

        def load(self, array, at):
            """Return the eight numbers of an array that begin at a place."""
            found = self._builder.load(
                self._builder.bitcast(self._place(array, at), self._vector.as_pointer()))
            found.align = 8    # the alignment of a double: arrays begin anywhere
            return found

        def store(self, x, array, at):
            """Write one number into an array."""
            self._builder.store(x, self._place(array, at))

        def put(self, v, array, at):
            """Write eight numbers into an array."""
            address = self._builder.bitcast(self._place(array, at), self._vector.as_pointer())
            self._builder.store(v, address).align = 8

        def divided(self, a, b):
            """Return a / b."""
            return self._builder.fdiv(a, b)

        def root(self, a):
            """Return the square root of a."""
            return self._function('sqrt', a)

        def power(self, a, exponent):
            """Return a to an exponent between 0 and 1, for a > 0, to 6 % of the exponent.

            The bits of a double, read as an integer, grow as its logarithm.
            """
            builder, one = self._builder, ir.Constant(
                ir.VectorType(INDEX, self.lanes), [ONE_BITS] * self.lanes)
            bits = builder.sitofp(builder.sub(builder.bitcast(a, one.type), one), self._vector)
            bits = builder.fptosi(builder.fmul(bits, self._each(exponent)), one.type)
            return builder.bitcast(builder.add(bits, one), self._vector)

        def where_less(self, a, b, x, y):
            """Return x where a < b, else y."""
            return self._builder.select(self._builder.fcmp_ordered('<', a, b), x, y)

        def place(self, at, stride, i):
            """Return the place at + stride i in an array."""
            return self._builder.add(
                self._index(at), self._builder.mul(self._index(stride), self._index(i)))

        def repeat(self, first, last, values, act):
            """Append a loop ``values = act(i, values)`` for i = first ... last - 1."""
            builder, first, last = self._builder, self._index(first), self._index(last)
            before, body, after = (builder.block, builder.append_basic_block('body'),
                                   builder.append_basic_block('after'))
            builder.cbranch(builder.icmp_signed('<', first, last), body, after)
            builder.position_at_end(body)
            i, running = builder.phi(INDEX), [builder.phi(value.type) for value in values]
            made = act(i, running)
            following, end = builder.add(i, self._index(1)), builder.block
            builder.cbranch(builder.icmp_signed('<', following, last), body, after)
            for phi, begin, then in zip(
                    [i, *running], [first, *values], [following, *made], strict=True):
                phi.add_incoming(begin, before)
                phi.add_incoming(then, end)
            builder.position_at_end(after)
            results = []
            for begin, then in zip(values, made, strict=True):
                phi = builder.phi(begin.type)
                phi.add_incoming(begin, before)
                phi.add_incoming(then, end)
                results.append(phi)
            return results

        def groups(self, portions):
            """Return the lists whose sums are made in one loop: the registers hold these."""
            return portions if self.lanes < LANES else [[*chain.from_iterable(portions)]]

        def share(self, array, i):
            """Return the address of the i-th lanes of an array: as many as a register holds."""
            return self._place(array, self.place(0, self.lanes, i))

        def _each(self, value):
            return ir.Constant(self._vector, [value] * self.lanes)

        def _function(self, name, *values):
            kind = values[0].type
            of = f'v{self.lanes}f64' if kind == self._vector else 'f64'
            return self._builder.call(cgutils.get_or_insert_function(
                self._builder.module, ir.FunctionType(kind, [kind] * len(values)),
                f'llvm.{name}.{of}'), values)

        def _index(self, i):
            return ir.Constant(INDEX, i) if isinstance(i, int) else i

        def _place(self, array, at):
            return self._builder.gep(array, [self._index(at)])

        def _shuffled(self, u, v, places):
            return self._builder.shuffle_vector(
                u, v, ir.Constant(ir.VectorType(PLACE, self.lanes), list(places)))

    class Halves(Written):
        """The operations on eight numbers as two vectors of four.

        The upper one is None where it is zero, or not asked for: nothing is computed there. That
        may change the sign of a zero. Quotients, roots, comparisons, loops and whole vectors
        written are not there.
        """

        def __init__(self, builder):
            super().__init__(builder, NARROW)

        def none(self):
            """Return eight zeros."""
            return super().none(), None

        def times(self, a, b):
            """Return a b."""
            return self._halves(super().times, a, b)

        def plus(self, a, b):
            """Return a + b."""
            return self._halves(super().plus, a, b, absent=lambda a, b: a or b)

        def minus(self, a):
            """Return -a."""
            return self._halves(super().minus, a)

        def gather(self, a, b, c):
            """Return a b + c, rounded once."""
            return self._halves(super().gather, a, b, c, absent=lambda a, b, c: (
                super(Halves, self).times(a, b) if a and b else c))

        def everywhere(self, x):
            """Return a vector of eight times x."""
            four = super().everywhere(x)
            return four, four

        def next(self, v):
            """Return the lanes moved one place down, with 0 in the last."""
            lower, upper = v
            if not upper:
                return super().next(lower), None
            return self._shuffled(lower, upper, range(1, NARROW + 1)), super().next(upper)

        def keep(self, v, count):
            """Return v; of its lanes only the first `count` are asked for from here on."""
            return v if count > NARROW else (v[0], None)

        def first(self, v):
            """Return the number in the first lane."""
            return super().first(v[0])

        def with_lane(self, v, lane, x):
            """Return v with x in one lane."""
            lower, upper = v
            if lane < NARROW:
                return super().with_lane(lower, lane, x), upper
            return lower, super().with_lane(upper or super().none(), lane - NARROW, x)

        def load(self, array, at):
            """Return the eight numbers of an array that begin at a place."""
            return super().load(array, at), super().load(array, at + NARROW)

        @staticmethod
        def _halves(act, *values, absent=lambda *_: None):
            """Return what an operation gives of numbers or halves; upper ones may be absent."""
            if not isinstance(values[0], tuple):
                return act(*values)
            lower, upper = zip(*values, strict=True)
            return act(*lower), act(*upper) if all(upper) else absent(*upper)


    def _is_narrow(context):
        """Return whether a register of the processor compiled for holds four numbers at most."""
        _, _, features = context.codegen().magic_tuple()
        return '+avx512f' not in features.split(',')


def compiled_lanes(recurrence, results, narrow=None):
    """Return a kernel ``(array, numbers) -> tuple`` that runs a recurrence on eight lanes.

    Eight numbers in each of many vectors fit into the registers of a processor with AVX-512. Where
    a register holds four, `narrow` says how it is done.

    Parameters
    ----------
    recurrence : function (operations, array, *numbers)
        It may load from the array and store into it, and returns a list of `results` numbers.
        Each of the numbers is a float, or a tuple of floats that it sees as a list.
    results : int
    narrow : IN_TURN, IN_HALVES or None
        Four lanes after the other four, if no lane takes anything from another and there are no
        results; each vector as two, of which one may be absent; or as if a register held eight.
    """
    if not HAVE_NUMBA:
        return lambda array, numbers: tuple(recurrence(Plain(), array, *numbers))
    from numba import types
    from numba.extending import intrinsic

    @intrinsic
    def kernel(typing, array, numbers):
        def write(context, builder, signature, given):
            address = context.make_array(signature.args[0])(context, builder, given[0]).data
            values = [
                cgutils.unpack_tuple(builder, one) if isinstance(kind, types.BaseTuple) else one
                for kind, one in zip(
                    signature.args[1], cgutils.unpack_tuple(builder, given[1]), strict=True)]
            how = narrow if _is_narrow(context) else None
            if how == IN_TURN:
                o = Written(builder, NARROW)
                found = o.repeat(0, LANES // NARROW, [], lambda i, _: recurrence(
                    o, o.share(address, i), *values))
            else:
                o = Halves(builder) if how == IN_HALVES else Written(builder)
                found = recurrence(o, address, *values)
            return context.make_tuple(builder, signature.return_type, found)
        return types.UniTuple(types.float64, results)(array, numbers), write
    return kernel
