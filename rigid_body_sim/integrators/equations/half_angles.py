# SPDX-License-Identifier: Apache-2.0
"""The equations on a hinge with few products of series, for power series.

The attitude is linear in s = sin(phi/2) and c = cos(phi/2), and what it turns is quadratic:

    s s = (1 - cos phi)/2,    s c = sin(phi)/2,    c c = (1 + cos phi)/2

So what acts is a sum of terms: a number that does not change, times one of 1, s, c, sin phi and
cos phi, times another series (1 where there is none). Where weight and a torsion spring act alone,
no product of series is left.
"""

from rigid_body_sim.integrators.equations.plan import RULES, UNKNOWN
from rigid_body_sim.scene.expressions import tree
from rigid_body_sim.scene.expressions.tree import ONE, ZERO, plus, times

STEADY = ONE, ONE
"""The key of what does not change in a sum."""


class Sums:
    """Trees as sums: (what of the angle, other series) -> number, a term that does not change.

    Parameters
    ----------
    phi : Term
        The angle of the hinge.
    """

    def __init__(self, phi):
        half, share = times(tree.number(0.5), phi), tree.number(0.5)
        sine, cosine = tree.term('sin', half), tree.term('cos', half)
        across, along = tree.term('sin', phi), tree.term('cos', phi)
        self._half = {sine, cosine}
        self._products = {
            (sine, sine): {ONE: share, along: tree.number(-0.5)},
            (sine, cosine): {across: share}, (cosine, sine): {across: share},
            (cosine, cosine): {ONE: share, along: share}}

    def of(self, trees):
        """Return trees, made of operations with recurrences (plan.py), written as sums."""
        sums, made = {}, {}
        for one in tree.parts(*trees):
            sums[one] = self._sum(one, sums, made)
            made[one] = _written(sums[one])
        return [made[one] for one in trees]

    def _sum(self, one, sums, made):
        """Return a term as a sum; `sums` and `made` have those that it is made of."""
        if one.op == 'number':
            return {STEADY: one} if one is not ZERO else {}
        if one.op == 'name':
            return {(ONE, one) if one.args[0].startswith(UNKNOWN) else STEADY:
                    ONE if one.args[0].startswith(UNKNOWN) else one}
        if one in self._half:
            return {(one, ONE): ONE}
        a, b, *_ = *(sums[arg] for arg in one.args), {}
        match one.op:
            case '+':
                return _total(a, b)
            case '-':
                return _total(a, _scaled(b, tree.number(-1.0)))
            case 'negative':
                return _scaled(a, tree.number(-1.0))
            case '*' if _is_steady(a):
                return _scaled(b, _written(a))
            case '*' if _is_steady(b):
                return _scaled(a, _written(b))
            case '*' if self._turns(a, b) or self._turns(b, a):
                return self._product(a, b)
            case '/' if _is_steady(b):
                return _scaled(a, tree.over(ONE, _written(b)))
        args = [made[arg] for arg in one.args]
        found = RULES[one.op](*args) if one.op in RULES else tree.term(one.op, *args)
        return {STEADY: found} if all(_is_steady(sums[arg]) for arg in one.args) else {
            (ONE, found): ONE}

    def _turns(self, a, b):
        """Return whether a is made of half angles alone, and b of nothing beyond them."""
        return (all(of in self._half and other is ONE for of, other in a)
                and all(of in self._half or of is ONE for of, _ in b))

    def _product(self, a, b):
        found = {}
        for (p, u), x in a.items():
            for (q, v), y in b.items():
                other, both = v if u is ONE else u, times(x, y)
                of_angle = self._products.get((p, q)) or {q if p is ONE else p: ONE}
                found = _total(found, {
                    (r, other): times(share, both) for r, share in of_angle.items()})
        return found


def _is_steady(total):
    return set(total) <= {STEADY}


def _scaled(total, factor):
    """Return a sum times a number that does not change."""
    if factor is tree.number(-1.0):
        return {key: tree.negative(share) for key, share in total.items()}
    return {key: found for key, share in total.items()
            if (found := times(factor, share)) is not ZERO}


def _total(a, b):
    found = dict(a)
    for key, share in b.items():
        found[key] = plus(found[key], share) if key in found else share
    return found


def _written(total):
    """Return the tree of a sum: each other series times what belongs to it."""
    belonging = {}
    for (of_angle, other), share in total.items():
        belonging[other] = plus(times(share, of_angle), belonging.get(other, ZERO))
    found = belonging.pop(ONE, ZERO)
    for other, factor in belonging.items():
        found = plus(times(factor, other), found)
    return found
