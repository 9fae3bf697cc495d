# SPDX-License-Identifier: Apache-2.0
"""Energies of a free body under the paddle of docs/extending."""

from figures.more_bodies import energies, free, installed


def draw():
    """Return the figure."""
    with installed():
        return energies(free('paddle: {coefficient: 1.0e-4}'), 10.0)
