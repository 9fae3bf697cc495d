# SPDX-License-Identifier: Apache-2.0
"""Cost of the node compared with the floor, and the lateness of its ticks.

The data are docs/node.json, as written by bench/node.py --json.
"""

import json
import pathlib

import numpy as np

from figures.style import BLACK, BLUE, GREY, ORANGE, label, panels

DATA = pathlib.Path(__file__).resolve().parent.parent / 'node.json'
COLOURS = {'floor': GREY, 'node': BLUE, 'node, recording': ORANGE}
MARKERS = {'floor': 'o', 'node': 's', 'node, recording': '^'}
HATCHES = {'floor': None, 'node': None, 'node, recording': '//'}


def draw():
    """Return the figure."""
    figure, (cost, lateness) = panels(2)
    cases = json.loads(DATA.read_text())['cases']
    places = np.arange(len(cases))
    names = [f'{case["rate"] / 1000:g} kHz\nheard by {case["subscribers"]}' for case in cases]
    for k, (row, colour) in enumerate(COLOURS.items()):
        found = [case['rows'][row] for case in cases]
        at = places + 0.27 * (k - 1)
        cost.bar(at, [one['tick_us'] for one in found], 0.25, color=colour, hatch=HATCHES[row],
                 edgecolor='white', label=row)
        lateness.vlines(at, [one['p50'] for one in found], [one['p99'] for one in found],
                        color=colour, linewidth=3.0)
        lateness.plot(at, [one['p50'] for one in found], color=BLACK, marker='_', linestyle='')
        lateness.plot(at, [one['p99'] for one in found], color=colour, marker=MARKERS[row],
                      linestyle='', label=row)
    for axes in (cost, lateness):
        axes.set_xticks(places, names, fontsize=8)
        axes.set_axisbelow(True)
    lateness.set_yscale('log')
    lateness.set_yticks([30, 100, 300, 1000], ['30', '100', '300', '1000'])
    lateness.minorticks_off()
    label(cost, '', 'processor time of a tick (µs)')
    label(lateness, '', 'lateness, p50 to p99 (µs)', loc='lower center', ncols=3,
          bbox_to_anchor=(0.5, 1.0), columnspacing=1.0, handlelength=1.0)
    return figure
