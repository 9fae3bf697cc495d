# SPDX-License-Identifier: Apache-2.0
"""The work-precision figure: error against CPU time per simulated second, one line per method.

It is readable in print and by the colour-blind. Lines that are the cheapest of ours, or of the
peers, at some accuracy are thick; fixed steps of a method that also controls its error are dotted.
Variants of one line are drawn as their front (table.py).
"""

import math
import textwrap

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from rigid_body_sim.study.precision import table

# Okabe and Ito's colours (https://jfly.uni-koeln.de/color/); markers tell the lines apart without
# colour, dashes mark the peers
COLOURS = ('#0072B2', '#D55E00', '#009E73', '#CC79A7', '#E69F00', '#56B4E9', '#000000', '#7F7F7F')
MARKERS = 'osD^v<>PXh'
SHADE = '#E3E3E3'
LEAST, MOST = 1e-16, 4.0
FIXED, ONE_MORE = ', fixed step', ', one more state'


def draw(results):
    """Return the Figure of a list of results (work_precision.py), a panel for each problem."""
    columns = min(2, len(results))
    rows = math.ceil(len(results) / columns)
    figure = Figure(figsize=(4.6 * columns, 3.5 * rows + 1.6), dpi=160, layout='constrained')
    FigureCanvasAgg(figure)
    looks = {}    # method -> number; a method looks the same in all panels
    for peers in (False, True):
        names = dict.fromkeys(family(line['name']) for result in results
                              for line in result['lines'] if line['is_peer'] == peers)
        looks |= {name: number for number, name in enumerate(names)}
    for result, axes in zip(results, figure.subplots(rows, columns, squeeze=False).flat):
        panel(axes, result, looks)
    for axes in figure.axes[len(results):]:
        axes.remove()
    seen = {name: handle for axes in figure.axes
            for handle, name in zip(*axes.get_legend_handles_labels(), strict=True)}
    figure.legend(seen.values(), seen.keys(), loc='outside lower center', ncols=2 * columns,
                  frameon=False, fontsize=8, handlelength=3.0, labelspacing=0.3)
    return figure


def panel(axes, result, looks):
    """Draw one problem; `looks` gives the number that selects a method's colour and marker."""
    floor = result['floor']
    axes.axhspan(LEAST / 4.0, floor, color=SHADE, linewidth=0.0, zorder=0)
    axes.text(0.99, LEAST / 3.0, 'grey: half an ulp on the inputs', ha='right', fontsize=8,
              transform=axes.get_yaxis_transform())
    shown = table.fronts(result['lines'])
    ours = [line for line in shown if not line['is_peer']]
    peers = [line for line in shown if line['is_peer']]
    for lines, dashes, filled in ((ours, '-', True), (peers, (0, (4, 2)), False)):
        leading = leaders(lines)
        for line in lines:
            k, fixed = looks[family(line['name'])], line['name'].endswith(FIXED)
            colour = COLOURS[k % len(COLOURS)]
            times = [point['cpu']['median'] for point in line['points']]
            spread = [[t - point['cpu']['least'] for t, point in zip(times, line['points'])],
                      [point['cpu']['most'] - t for t, point in zip(times, line['points'])]]
            errors = [min(MOST, max(LEAST, point['error'])) for point in line['points']]
            single = line['control'] == 'none'
            size = 13 if line['name'] == 'exact' else 8 if single else 2.5 if fixed else 4
            axes.errorbar(
                times, errors, xerr=spread, linestyle=':' if fixed else dashes, color=colour,
                label=line['name'], marker='*' if single else MARKERS[k % len(MARKERS)],
                markersize=size, markerfacecolor=colour if filled else 'white',
                linewidth=2.0 if line['name'] in leading else 0.8, elinewidth=0.6,
                zorder=4 if single else 3)
    axes.set_xscale('log')
    axes.set_yscale('log')
    axes.set_ylim(LEAST / 4.0, MOST)
    axes.set_title(textwrap.fill(f'{result["problem"]}: {result["about"]}'.rstrip(': '), 50),
                   fontsize=9, loc='left')
    axes.set_xlabel('CPU seconds per simulated second')
    axes.set_ylabel(f'error of the attitude after {result["duration"]:g} s (rad)')
    axes.grid(color='#dddddd', linewidth=0.5)
    axes.spines[['top', 'right']].set_visible(False)


def family(name):
    """Return the name of a method without its variant, as variants share a colour."""
    return name.removesuffix(FIXED).removesuffix(ONE_MORE)


def leaders(lines):
    """Return the names of the lines to draw thick: the cheapest at some level of the table."""
    names = set()
    for level in table.LEVELS:
        costs = [(cost, line['name'])
                 for line in lines if (cost := table.cost_at(line, level)) is not None]
        names |= {min(costs)[1]} if costs else set()
    return names
