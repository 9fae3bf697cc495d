# SPDX-License-Identifier: Apache-2.0
"""Our time over that of the best peer on a second processor, which has AVX2 only."""

from figures import cost_peers


def draw():
    """Return the figure."""
    return cost_peers.draw('accuracy/second_processor')
