# SPDX-License-Identifier: Apache-2.0
"""Instructions of a step with all effects known, and with the listed ones known."""

from figures import bars


def draw():
    """Return the figure."""
    return bars.draw('methods/absent_effects', ('all effects known', 'listed ones known'),
                     'instructions of a step of dop8')
