# SPDX-License-Identifier: Apache-2.0
"""The potential energy of a scene: the sum over the effects that have one, written as source.

A scene without potentials has none of this in its code.
"""

from rigid_body_sim.compilation.templates import imported, specialise
from rigid_body_sim.mechanics import energy
from rigid_body_sim.mechanics.parameters import SCENE, momenta, potentials


def energies(scene):
    """Return the kernels of energy.py, `diagnose` and `diagnose_many`, for a scene."""
    parts = potentials(scene)
    at = SCENE.size + sum(len(one.values) for one in parts)
    return specialise(energy, potential=_source(parts), with_parts=_carried(scene, at))


def _source(parts):
    """Return the source of ``potential(p, scene, q, position)``, the sum of the parts."""
    head = ['@compiled', 'def potential(p, scene, q, position):']
    if not parts:
        return '\n'.join([*head, '    return 0.0', ''])
    lines, at = [], SCENE.size
    for number, part in enumerate(parts):
        values = ''.join(f'p[{at + k}], ' for k in range(len(part.values)))
        lines += [imported(part.kernel, f'potential_{number}')]
        at += len(part.values)
        parts[number] = f'potential_{number}({values}*axes, *center)'
    return '\n'.join([
        'from rigid_body_sim.numerics.rotations import multiply', *lines, '', '', *head,
        '    axes = multiply(*q, *scene.frame_axes)',
        '    center = plus(position, rotate(*q, *scene.center))',
        f'    return {" + ".join(parts)}', ''])


def _carried(scene, at):
    """Return the source of ``with_parts(p, scene, time, momentum)``; values from `at` on in p."""
    head = ['@compiled', 'def with_parts(p, scene, time, momentum):']
    lines, imports = [], []
    for number, one in enumerate(momenta(scene)):
        values = ''.join(f'p[{at + k}], ' for k in range(len(one.values)))
        at += len(one.values)
        imports.append(imported(one.kernel, f'carried_{number}'))
        lines += [f'    h = rotate(*scene.frame_axes, *carried_{number}({values}time))']
        if scene.constraint.axis is not None:    # the rest is the bearing's
            lines += ['    h = scaled(dot(scene.hinge_axis, h), scene.hinge_axis)']
        lines += ['    momentum = plus(momentum, h)']
    return '\n'.join([*imports, '', '', *head, *lines, '    return momentum', ''])
