# SPDX-License-Identifier: Apache-2.0
"""Points of a march: its present place, and the step to the next point.

A point is an array that begins with a Head; after it come the unknowns, and what their sums have
lost (as many numbers again). The settings of a march are in its `control`, an array that begins
with a Control. The templates of this folder add to both what their method keeps.
"""

from typing import NamedTuple

from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.compilation.layout import Vector, layout


class Head(NamedTuple):
    """The beginning of every point.

    Attributes
    ----------
    time : float
        s.
    step : float
        The step planned from here, s; where steps are fixed, the number of the point.
    scales : Vector
        Squared scales of the groups of unknowns whose errors are relative.
    """

    time: float
    step: float
    scales: Vector


class Control(NamedTuple):
    """The beginning of the control of every march.

    Attributes
    ----------
    tolerance : float
        Error allowed per second; 0 where steps are fixed.
    fixed : float
        The fixed step, s; 0 where the march chooses its steps.
    origin : float
        The time that fixed steps are counted from, s: that of the first point.
    """

    tolerance: float
    fixed: float
    origin: float


LOST, REACHED, PAUSED = 0, 1, 2
"""How a march ended: no step is good; the time asked for is within the step; no steps are left."""

LEAST_ERROR = 2.0 ** -62
"""Least error asked of a step, as a share of the unknowns, however short it is."""

HEAD = layout(Head)
TIME, STEP, SCALES = (HEAD.part(name).first for name in Head._fields)
VALUES = HEAD.size
CONTROL = layout(Control)
TOLERANCE, FIXED, ORIGIN = (CONTROL.part(name).first for name in Control._fields)


class Standing(NamedTuple):
    """A point of a collocation march in the hands of a kernel.

    Attributes
    ----------
    time, step, scales
        Those of the Head.
    y, lost : tuple of floats
        The unknowns, and what their sums have lost (Kahan).
    last : float
        Size of the step that led here, s; 0 where there was none.
    sweeps : int
        How many substitutions that step was given before its first check.
    """

    time: float
    step: float
    scales: tuple
    y: tuple
    lost: tuple
    last: float
    sweeps: int


@compiled
def onward(point, following, target):
    """Move a point to the following one, unless the target time lies before that.

    The following point is not known while its time is not later.

    Returns
    -------
    int
        1 if the point moved, -1 if it stays, 0 if no following point is known.
    """
    if not following[TIME] > point[TIME]:
        return 0
    if target < following[TIME]:
        return -1
    for k in range(len(point)):
        point[k] = following[k]
    return 1
