# SPDX-License-Identifier: Apache-2.0
"""The path of a point that moves as a scene says: its place, velocity and acceleration."""

import functools
import importlib

from rigid_body_sim.scene.expressions import tree
from rigid_body_sim.scene.expressions.source import KINKED, TIME, Kernel, Lines, kernel, prelude


def kinks(trees: tuple[tree.Node, ...]) -> list[str]:
    """Return the functions with kinks that stand in trees, sorted."""
    return sorted({one.op for one in tree.parts(*trees)} & {*KINKED, 'where'})


def accelerations(trees: tuple[tree.Node, ...]) -> tuple[tree.Node, ...]:
    """Return the second derivatives of trees by time."""
    rates = [tree.derivatives(one, TIME)[0] for one in trees]
    return tuple(tree.derivatives(one, TIME)[0] for one in rates)


@functools.lru_cache(maxsize=256)
def path(trees: tuple[tree.Node, ...], parameters: tuple[tuple[str, float], ...]) -> Kernel:
    """Return the Kernel of a path.

    Parameters
    ----------
    trees : tuple of 3 Nodes
        Place as a function of the time (s), m, world axes.
    parameters : tuple of (str, float)

    Returns
    -------
    Kernel
        ``(value, ..., value, t)`` -> place (m), velocity (m/s), acceleration (m/s^2): nine floats.
    """
    lines = Lines(dict(parameters))
    rates = tuple(tree.derivatives(one, TIME)[0] for one in trees)
    found = lines.of(*trees, *rates, *accelerations(trees))
    return kernel('path', 't', lines, prelude(lines, {*TIME}, None), f'({", ".join(found)},)')


def along(found: Kernel, time: float) -> tuple[tuple[float, ...], ...]:
    """Return place, velocity and acceleration of a path at a time (s), in plain Python."""
    module, _, name = found.name.partition(':')
    function = getattr(importlib.import_module(module), name)
    nine = getattr(function, 'py_func', function)(*found.values, time)
    return nine[:3], nine[3:6], nine[6:]
