# SPDX-License-Identifier: Apache-2.0
"""Order conditions of Runge-Kutta methods, one for each rooted tree.

Source: Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I, II.2.
"""

from fractions import Fraction
from functools import cache


@cache
def trees(order):
    """Return the rooted trees with that many nodes, each a sorted tuple of its subtrees."""
    return tuple(sorted(set(_forests(order - 1, order - 1))))


@cache
def _forests(nodes, largest):
    if nodes == 0:
        return ((),)
    found = []
    for size in range(min(nodes, largest), 0, -1):
        for tree in trees(size):
            found += [tuple(sorted((tree, *rest))) for rest in _forests(nodes - size, size)]
    return tuple(set(found))


def nodes(tree):
    return 1 + sum(nodes(subtree) for subtree in tree)


def density(tree):
    """Return gamma(t): the condition is sum_i b_i Phi_i(t) = 1/gamma(t)."""
    result = nodes(tree)
    for subtree in tree:
        result *= density(subtree)
    return result


def weight(tree, A):
    """Return Phi(t), a list with one entry a stage; A: rows {stage: coefficient}, of Fractions."""
    result = [Fraction(1)] * len(A)
    for subtree in tree:
        inner = weight(subtree, A)
        result = [left * sum((a * inner[j] for j, a in row.items()), Fraction(0))
                  for left, row in zip(result, A, strict=True)]
    return result


def defects(order, A, B):
    """Yield |sum b Phi(t) - 1/gamma(t)| for each tree of an order.

    The arithmetic on the given doubles is exact.
    """
    A = [{j: Fraction(a) for j, a in row.items()} for row in A]
    for tree in trees(order):
        phi = weight(tree, A)
        total = sum(Fraction(b) * phi[j] for j, b in B.items())
        yield abs(float(total - Fraction(1, density(tree))))


def largest_defect(order, A, B):
    """Return the largest of the `defects`."""
    return max(defects(order, A, B))
