# SPDX-License-Identifier: Apache-2.0
"""CPU time of first runs: machine code for every kernel, or for those that Python calls."""

from figures import bars


def draw():
    """Return the figure."""
    return bars.draw('methods/first_run',
                     ('each kernel with machine code', 'only those that Python calls'),
                     'CPU time of a first run of 1 s (s)')
