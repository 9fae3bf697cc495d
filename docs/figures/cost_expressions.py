# SPDX-License-Identifier: Apache-2.0
"""Error against time of a run, for effects that are formulas, by three methods and heyoka."""

from figures.error_time import panels_of

TITLES = {'on a spring': 'spring', 'gravity gradient': 'gravity gradient',
          'drag by the square': 'drag by the square', 'attitude under control': 'control'}


def draw():
    """Return the figure."""
    return panels_of('methods/expressions', TITLES, 'µs', (20, 50, 100, 200))
