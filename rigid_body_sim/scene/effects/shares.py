# SPDX-License-Identifier: Apache-2.0
"""The share of a drive's largest torque that turns a body as if it were about its least moment."""

from collections.abc import Iterable

from rigid_body_sim.numerics.functions import hypot3


def share_of_least(torques: Iterable[float], moments: Iterable[float], size: float) -> float:
    """Return Bounds.share of a drive, from its largest torques about principal axes.

    `size` is what all are together at most. About an axis without a moment nothing turns.
    """
    least = min(moment for moment in moments if moment > 0.0)
    if not 0.0 < size < float('inf'):
        return 1.0
    pushes = (torque / size * (least / moment) if moment > 0.0 else 0.0
              for torque, moment in zip(torques, moments, strict=True))
    return min(1.0, hypot3(*pushes))
