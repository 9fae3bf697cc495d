# SPDX-License-Identifier: Apache-2.0
"""Taylor series of a scene's own equations: recurrences from trees, for eight lanes (lanes.py).

equations/plan.py makes a plan of the trees of the rates: a list of steps, each of which makes
a series of those before it. With v = sum of i u_i t^i, which is t u', and u without its first
coefficient written u~:

    a b:        (a b)_k = sum over i of a_i b_(k - i)
    c = a/b:    c_k = (a_k - (c b~)_k)/b_0
    e = exp u:  k e_k = (e v)_k
    s = sin u:  k s_k = (c v)_k,    c = cos u:  k c_k = -(s v)_k
    T = tanh u: k T_k = ((1 - T^2) v)_k
    l = log u:  k u_0 l_k = k u_k - (m u~)_k,    m_i = i l_i
    c = sqrt u: 2 c_0 c_k = u_k - (c~ c~)_k
    c = u^a:    k u_0 c_k = a (c v)_k - (n u~)_k,    n_i = i c_i

(Jorba, Zou, Experimental Mathematics 14 (2005) 99). The first coefficients come with the call;
of the others none needs more than products, which are summed eight orders at once as in
taylor_series.py.
"""

from rigid_body_sim.compilation.lanes import IN_HALVES, LANES, compiled_lanes
from rigid_body_sim.integrators.marching.taylor_series import ORDER, Products, Series

OWN, REST, GROWTH = 'own', 'rest', 'growth'
"""What a product takes of a series u: u, u~ or v."""


def places(size):
    """Return the places of an order's coefficients: those of `size` unknowns, in whole vectors."""
    return LANES * -(-size // LANES)


class _Delayed:
    """The product of two series, b with a first coefficient of 0: a_k follows from (a b)_k."""

    def __init__(self, operations, a, b):
        self._operations, self._a, self._b, self._sums = operations, a, b, operations.none()

    def at(self, k):
        """Return the coefficient k, a being known to order k - 1 and b to order k."""
        o = self._operations
        self._sums = o.gather(self._b.spread[k], self._a.low[k - 1], o.next(self._sums))
        return o.first(self._sums)

    def close(self, k):
        """Take the coefficient k of a, k > 0, which is known now."""
        self._sums = self._operations.gather(self._a.spread[k], self._b.low[k], self._sums)


class _OwnSquare:
    """The square of a series c~, of which c_k follows from (c~ c~)_k."""

    def __init__(self, operations, c):
        self._operations, self._c, self._sums = operations, c, operations.none()

    def at(self, k):
        """Return the coefficient k, c being known to order k - 1."""
        self._sums = self._operations.next(self._sums)
        return self._operations.first(self._sums)

    def close(self, k):
        """Take the coefficient k of c, which is known now."""
        o, c = self._operations, self._c
        self._sums = o.gather(c.spread[k], c.low[k - 1], self._sums)
        self._sums = o.gather(c.spread[k], c.low[k], self._sums)


class _Column:
    """The coefficients of a series, and the series that products make of it."""

    def __init__(self, operations, first):
        self._operations, self.coefficients, self._roles = operations, [first], {}

    def role(self, name):
        """Return the series OWN, REST or GROWTH; only before there is a second coefficient."""
        if name not in self._roles:
            o = self._operations
            first = self.coefficients[0] if name == OWN else o.number(0.0)
            self._roles[name] = Series(o, first)
        return self._roles[name]

    def add(self, coefficient):
        """Append the next coefficient."""
        o, k = self._operations, len(self.coefficients)
        self.coefficients.append(coefficient)
        for name, series in self._roles.items():
            series.add(o.times(o.number(float(k)), coefficient) if name == GROWTH
                       else coefficient)


class _Recurrence:
    """The series of a plan, order by order.

    Parameters
    ----------
    o : operations
    plan : tuple
        Steps, as plan.py writes them. An operand is the number of a step, or -1 - j for the
        number j of `fixed`.
    firsts, fixed : lists of numbers
        The first coefficient of each step; what the steps take beside them.
    """

    def __init__(self, o, plan, firsts, fixed):
        self._o, self._plan, self._fixed = o, plan, fixed
        self.columns = [_Column(o, first) for first in firsts]
        self._products = [self._made(number, *step) for number, step in enumerate(plan)]

    def _made(self, number, op, *args):
        """Return the products that a step needs."""
        o, own = self._o, self.columns[number]

        def of(which, role):
            return self.columns[which].role(role)
        match op:
            case '*':
                product = Products(o, (1, of(args[0], OWN), of(args[1], OWN)))
                product.at(0)
                return product,
            case '/':
                return _Delayed(o, own.role(OWN), of(args[1], REST)),
            case 'exp':
                return _Delayed(o, own.role(OWN), of(args[0], GROWTH)),
            case 'sin':    # the cosine is the next step
                return _Delayed(o, of(number + 1, OWN), of(args[0], GROWTH)),
            case 'cos':
                return _Delayed(o, of(number - 1, OWN), of(args[0], GROWTH)),
            case 'tanh':
                square = Products(o, (1, own.role(OWN), own.role(OWN)))
                bound = _Column(o, o.plus(o.number(1.0), o.minus(square.at(0))))
                return square, bound, _Delayed(o, bound.role(OWN), of(args[0], GROWTH))
            case 'log':
                return _Delayed(o, own.role(GROWTH), of(args[0], REST)),
            case 'sqrt':
                return _OwnSquare(o, own.role(REST)),
            case '^':
                return (_Delayed(o, own.role(OWN), of(args[0], GROWTH)),
                        _Delayed(o, own.role(GROWTH), of(args[0], REST)))
        return ()

    def coefficient(self, which, k):
        """Return the coefficient k of an operand."""
        if which >= 0:
            return self.columns[which].coefficients[k]
        return self._fixed[-1 - which] if k == 0 else None

    def advance(self, k, unknowns):
        """Make the coefficients k > 0 of all steps; those of the unknowns are given."""
        for number, (op, *args) in enumerate(self._plan):
            if op == 'unknown':
                self.columns[number].add(unknowns[args[0]])
            elif op == 'sin':    # sine and cosine need each other
                found = [self._next(number + which, k) for which in (0, 1)]
                for which in (0, 1):
                    self.columns[number + which].add(found[which])
                for which in (0, 1):
                    self._products[number + which][0].close(k)
            elif op != 'cos':
                self.columns[number].add(self._next(number, k))
                for product in self._products[number]:
                    if isinstance(product, _Delayed | _OwnSquare):
                        if op == 'tanh':
                            bound = self._products[number][1]
                            bound.add(self._o.minus(self._products[number][0].at(k)))
                        product.close(k)

    def _next(self, number, k):
        """Return the coefficient k of a step.

        More than forty lines: a table of rules, one for each operation.
        """
        o, (op, *args), products = self._o, self._plan[number], self._products[number]
        a = self.coefficient(args[0], k)
        share = o.number(1.0 / k)
        match op:
            case '+' | '-':
                b = self.coefficient(args[1], k)
                if b is None:
                    return a
                b = o.minus(b) if op == '-' else b
                return b if a is None else o.plus(a, b)
            case 'negative':
                return o.minus(a)
            case 'scaled':
                return o.times(self._fixed[-1 - args[1]], a)
            case '*':
                return products[0].at(k)
            case '/':
                rest = o.minus(products[0].at(k))
                return o.times(rest if a is None else o.plus(a, rest), self._fixed[-1 - args[2]])
            case 'exp' | 'sin':
                return o.times(share, products[0].at(k))
            case 'cos':
                return o.times(o.number(-1.0 / k), products[0].at(k))
            case 'tanh':
                return o.times(share, products[2].at(k))
            case 'log':
                own = o.gather(o.number(-1.0 / k), products[0].at(k), a)
                return o.times(own, self._fixed[-1 - args[1]])
            case 'sqrt':
                return o.times(o.plus(a, o.minus(products[0].at(k))), self._fixed[-1 - args[1]])
            case '^':
                power, rest = (product.at(k) for product in products)
                found = o.gather(self._fixed[-1 - args[1]], power, o.minus(rest))
                return o.times(o.times(share, found), self._fixed[-1 - args[2]])
        raise AssertionError(op)


def expansion(plan, rates, width):
    """Return the kernel that fills S with the coefficients of the unknowns, order by order.

    Its signature is ``(S, (unknowns, firsts, fixed)) -> ()``: the unknowns, the first coefficient
    of each step of the plan, and the other numbers that the plan takes.

    Parameters
    ----------
    plan : tuple
        Steps (op, operands ...).
    rates : tuple
        The operand that is the rate of each unknown, None for a rate of 0.
    width : int
        Places of an order in S.
    """
    def recurrence(o, S, unknowns, firsts, fixed):
        for place, value in enumerate(unknowns):
            o.store(value, S, place)
        made = _Recurrence(o, plan, firsts, fixed)
        for k in range(ORDER):
            following = []
            for place, rate in enumerate(rates):
                found = None if rate is None else made.coefficient(rate, k)
                found = (o.number(0.0) if found is None
                         else o.times(o.number(1.0 / (k + 1)), found))
                following.append(found)
                o.store(found, S, width * (k + 1) + place)
            if k + 1 < ORDER:
                made.advance(k + 1, following)
        return []
    return compiled_lanes(recurrence, 0, narrow=IN_HALVES)


def along(size, width):
    """Return the kernel ``(S, (h,)) -> tuple``: by how much `size` unknowns change in a time h.

    `width` is that of `expansion`.
    """
    def moved(o, S, h):
        found = []
        for block in range(0, places(size), LANES):
            terms = [o.load(S, width * k + block) for k in range(1, ORDER + 1)]
            power = o.everywhere(h)
            step = power
            while len(terms) > 1:
                terms = [o.gather(after, power, before)
                         for before, after in zip(terms[::2], terms[1::2], strict=True)]
                power = o.times(power, power)
            # the sign of a coefficient of zero is not the same everywhere (lanes.Halves)
            change = o.plus(o.times(terms[0], step), o.everywhere(o.number(0.0)))
            for _ in range(LANES):
                found.append(o.first(change))
                change = o.next(change)
        return found[:size]
    return compiled_lanes(moved, size)
