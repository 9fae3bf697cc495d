# SPDX-License-Identifier: Apache-2.0
"""The path of a point that moves as a scene says: its place, velocity and acceleration."""

import functools
from dataclasses import dataclass

from rigid_body_sim.compilation.jit import in_python
from rigid_body_sim.scene.expressions import tree
from rigid_body_sim.scene.expressions.source import KINKED, TIME, Kernel, Lines, kernel, prelude


def kinks(trees: tuple[tree.Term, ...]) -> list[str]:
    """Return the functions with kinks that trees contain, sorted."""
    return sorted({one.op for one in tree.parts(*trees)} & {*KINKED, 'where'})


@dataclass(frozen=True)
class Path(Kernel):
    """The path of a point: a kernel, and the trees that it is made of.

    The kernel is ``(value, ..., value, t)`` -> place (m), velocity (m/s), acceleration (m/s^2):
    nine floats.

    Attributes
    ----------
    trees : tuple of 3 Terms
        Place as a function of the time (s), m, world axes.
    parameters : tuple of (str, float)
    """

    trees: tuple[tree.Term, ...]
    parameters: tuple[tuple[str, float], ...]


def velocities(trees: tuple[tree.Term, ...]) -> tuple[tree.Term, ...]:
    """Return the derivatives of trees by time."""
    return tuple(tree.derivatives(one, TIME)[0] for one in trees)


def accelerations(trees: tuple[tree.Term, ...]) -> tuple[tree.Term, ...]:
    """Return the second derivatives of trees by time."""
    return velocities(velocities(trees))


@functools.lru_cache(maxsize=256)
def path(trees: tuple[tree.Term, ...], parameters: tuple[tuple[str, float], ...]) -> Path:
    """Return the Path of a place as a function of the time; arguments as its attributes."""
    lines = Lines(dict(parameters))
    found = lines.of(*trees, *velocities(trees), *accelerations(trees))
    made = kernel('path', 't', lines, prelude(lines, {*TIME}, None), f'({", ".join(found)},)')
    return Path(made.name, made.values, trees, parameters)


def along(found: Kernel, time: float) -> tuple[tuple[float, ...], ...]:
    """Return place, velocity and acceleration of a path at a time (s), in plain Python."""
    nine = in_python(found.name)(*found.values, time)
    return nine[:3], nine[3:6], nine[6:]
