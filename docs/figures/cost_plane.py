# SPDX-License-Identifier: Apache-2.0
"""Error against time of a run, for bodies on a plane by three methods."""

from figures.error_time import panels_of

SHOWN = 'tippe top', 'rattleback', "Euler's disk", 'Routh sphere'


def draw():
    """Return the figure."""
    return panels_of('methods/plane', {name: name for name in SHOWN}, 'ms',
                     (0.1, 0.3, 1, 3, 10, 30))
