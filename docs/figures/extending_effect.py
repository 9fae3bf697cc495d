# SPDX-License-Identifier: Apache-2.0
"""Energies of a free body under the compass of docs/extending."""

from figures.more_bodies import energies, free, installed


def draw():
    """Return the figure."""
    with installed():
        return energies(free('compass: {moment: [0.0, 0.1, 0.3], field: [0.0, 0.2, 1.0]}'), 3.0)
