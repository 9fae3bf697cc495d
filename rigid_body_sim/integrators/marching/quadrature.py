# SPDX-License-Identifier: Apache-2.0
"""The ledger of methods that are not Runge-Kutta: Gauss's quadrature within a step.

The states are steps of the same method from the same point, each shorter; so the ledger does not
use the impulses of the method itself, and what they sum is an independent check. Nodes and
weights:
NIST DLMF 3.5(v).
"""

from rigid_body_sim.numerics.gauss import rule


def step_source(order, n, extra):
    """Return the source of ``step(p, y, c, k0, h) -> (y, c)``.

    It calls a kernel ``advance(p, y, c, k0, h)`` of n unknowns.

    `extra` quadratures stand behind the unknowns; they get the order of the method.
    """
    head = ['', '', '@compiled', 'def step(p, y, c, k0, h):']
    if not extra:
        return '\n'.join([*head, '    return advance(p, y, c, k0, h)', ''])
    nodes, weights = rule((order + 1) // 2)
    lines = [*head, f'    z, d = y[:{n}], c[:{n}]', '    after, lost = advance(p, z, d, k0, h)']
    for k, place in enumerate(nodes):
        lines += [
            f'    inner, _ = advance(p, z, d, k0, {place!r} * h)',
            f'    r{k} = rate(p, inner)',
        ]
    sums = [
        ' + '.join(f'{weight!r} * r{k}[{u}]' for k, weight in enumerate(weights))
        for u in range(n, n + extra)
    ]
    lines += [f'    i{u} = h * ({total}) + c[{n + u}]' for u, total in enumerate(sums)]
    lines += [f'    s{u} = y[{n + u}] + i{u}' for u in range(extra)]
    after = ''.join(f's{u}, ' for u in range(extra))
    lost = ''.join(f'i{u} - (s{u} - y[{n + u}]), ' for u in range(extra))
    return '\n'.join([*lines, f'    return (*after, {after}), (*lost, {lost})', ''])
