# SPDX-License-Identifier: Apache-2.0
"""Error against time of a heavy top: our closed form and best stepped method, three best peers.

The data are docs/work_precision.json, as `make study-full` wrote them.
"""

import json

from figures.page_tables import DOCS
from figures.style import BLACK, BLUE, GREEN, GREY, ORANGE, label, panels, plain_ticks
from rigid_body_sim.study.precision import table

PROBLEM = 'heavy_symmetric_top'
COARSE = table.LEVELS[0]    # the best are the cheapest at this error, rad
PEERS = 3
LOOKS = ({'color': ORANGE, 'marker': 'D', 'linestyle': '--'},
         {'color': GREEN, 'marker': 'v', 'linestyle': '--'},
         {'color': BLACK, 'marker': 's', 'linestyle': '--'})
LEAST, MOST = 1e-17, 1.0    # rad


def best(lines):
    """Return the cheapest lines that reach the coarse error, one of each program."""
    costs = sorted((cost, line['name']) for line in lines
                   if (cost := table.cost_at(line, COARSE)) is not None)
    programs, named = {}, {line['name']: line for line in lines}
    for _, name in costs:
        programs.setdefault(name.split()[0].strip(','), named[name])
    return list(programs.values())


def points(line):
    """Return times (us for each simulated second) and errors (rad), from fast to slow."""
    found = sorted((1e6 * point['cpu']['median'], point['error']) for point in line['points'])
    return zip(*(one for one in found if one[1] < MOST), strict=True)


def draw():
    """Return the figure."""
    [result] = [one for one in json.loads((DOCS / 'work_precision.json').read_text())['results']
                if one['problem'] == PROBLEM]
    lines = table.fronts(result['lines'])
    [exact] = [line for line in lines if line['name'] == 'exact']
    stepped, *_ = best([line for line in lines
                        if not line['is_peer'] and line['control'] == 'accuracy'])
    peers = best([line for line in lines if line['is_peer']])[:PEERS]

    figure, [axes] = panels(height=3.6)
    axes.axhspan(LEAST, result['floor'], color='#e3e3e3', linewidth=0.0, zorder=0)
    axes.text(0.99, 2.0 * LEAST, 'half an ulp on the inputs', transform=axes.get_yaxis_transform(),
              ha='right', fontsize=8, color=GREY)
    [time], [error] = points(exact)
    axes.plot(time, error, color=BLUE, marker='*', markersize=16, linestyle='')
    axes.annotate('closed form, at any time and accuracy', (time, error), xytext=(12, -3),
                  textcoords='offset points', color=BLUE)
    for line, look in ((stepped, {'color': BLUE, 'marker': 'o'}), *zip(peers, LOOKS, strict=True)):
        times, errors = points(line)
        axes.plot(times, errors, markersize=4, **look)
        place = max(k for k, one in enumerate(errors) if one > 1e-6 or k == 0)
        axes.annotate(f'{line["name"]}, stepped' if line is stepped else line['name'],
                      (times[place], errors[place]), textcoords='offset points',
                      **({'xytext': (-8, -4), 'ha': 'right'} if line is stepped
                         else {'xytext': (8, 2)}), color=look['color'])
    axes.set(xscale='log', yscale='log', ylim=(LEAST, MOST),
             xlim=(time / 2.0, 1e4))
    plain_ticks(axes.xaxis, (0.1, 1, 10, 100, 1000, 10000))
    label(axes, 'CPU time for each simulated second (µs)',
          f'error of a heavy top after {result["duration"]:g} s (rad)', legend=False)
    return figure
