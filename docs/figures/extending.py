# SPDX-License-Identifier: Apache-2.0
"""Energies of the compass needle of docs/extending."""

from figures.more_bodies import energies, installed, needle


def draw():
    """Return the figure."""
    with installed() as folder:
        return energies(needle(folder), 5.0)
