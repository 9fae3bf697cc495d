# SPDX-License-Identifier: Apache-2.0
"""The potential energy of a scene: the sum over the effects that have one, written as source.

A scene without potentials has none of this in its code.
"""

import functools

from rigid_body_sim.compilation.templates import imported, specialise
from rigid_body_sim.mechanics import energy
from rigid_body_sim.mechanics.parameters import SCENE, momenta, potentials
from rigid_body_sim.scene.scene import kept


@kept
def energies(scene):
    """Return the kernels of energy.py, `diagnose` and `diagnose_many`, for a scene."""
    parts = tuple((one.kernel, len(one.values)) for one in potentials(scene))
    carried = tuple((one.kernel, len(one.values)) for one in momenta(scene))
    return _bound(parts, carried, scene.constraint.axis is not None)


@functools.cache
def _bound(parts, carried, on_axis):
    at = SCENE.size + sum(size for _, size in parts)
    return specialise(energy, potential=_source(parts),
                      with_parts=_carried(carried, at, on_axis))


def _source(parts):
    """Return the source of ``potential(p, scene, q, position)``, the sum of the parts.

    A part is its kernel and the number of values that it takes.
    """
    head = ['@compiled', 'def potential(p, scene, q, position):']
    if not parts:
        return '\n'.join([*head, '    return 0.0', ''])
    lines, terms, at = [], [], SCENE.size
    for number, (kernel, size) in enumerate(parts):
        values = ''.join(f'p[{at + k}], ' for k in range(size))
        lines += [imported(kernel, f'potential_{number}')]
        terms += [f'potential_{number}({values}*axes, *center)']
        at += size
    return '\n'.join([
        'from rigid_body_sim.numerics.rotations import multiply', *lines, '', '', *head,
        '    axes = multiply(*q, *scene.frame_axes)',
        '    center = plus(position, rotate(*q, *scene.center))',
        f'    return {" + ".join(terms)}', ''])


def _carried(parts, at, on_axis):
    """Return the source of ``with_parts(p, scene, time, momentum)``; values from `at` on in p.

    A part is its kernel and the number of values that it takes.
    """
    head = ['@compiled', 'def with_parts(p, scene, time, momentum):']
    lines, imports = [], []
    for number, (kernel, size) in enumerate(parts):
        values = ''.join(f'p[{at + k}], ' for k in range(size))
        at += size
        imports.append(imported(kernel, f'carried_{number}'))
        lines += [f'    h = rotate(*scene.frame_axes, *carried_{number}({values}time))']
        if on_axis:    # the rest is the bearing's
            lines += ['    h = scaled(dot(scene.hinge_axis, h), scene.hinge_axis)']
        lines += ['    momentum = plus(momentum, h)']
    return '\n'.join([*imports, '', '', *head, *lines, '    return momentum', ''])
