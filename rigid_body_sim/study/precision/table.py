# SPDX-License-Identifier: Apache-2.0
"""The table of a study: the cost of each method at some levels of error, and its best error.

The levels are 1e-3, 1e-6, 1e-9 and 1e-12 rad at the end; errors on the way are listed too.
"""

import math

from rigid_body_sim.study.precision.runner import ONE_MORE

LEVELS = (1e-3, 1e-6, 1e-9, 1e-12)


def cost_at(line, level, error='error'):
    """Return the least CPU time per simulated second (s) with an error up to a level, or None."""
    return min((point['cpu']['median'] for point in line['points'] if point[error] <= level),
               default=None)


def fronts(found):
    """Return lines of which those of one name are joined: their best points at each cost.

    Variants of a line differ in what its user sets beside steps or tolerances. A point of the
    joined line is better than all cheaper ones; its setting begins with its variant.
    """
    groups = {}
    for line in found:
        groups.setdefault(line['name'], []).append(line)
    return [lines[0] if len(lines) == 1 else _front(lines) for lines in groups.values()]


def _front(lines):
    points = sorted(((point['cpu']['median'], point['error'], line['variant'], point)
                     for line in lines for point in line['points']), key=lambda one: one[:2])
    kept, least = [], math.inf
    for _, error, variant, point in points:
        if error < least:
            kept.append(point | {'setting': f'{variant}, {lines[0]["control"]} '
                                            f'{point["setting"]:.2g}'})
            least = error
    return lines[0] | {'variant': '', 'points': kept,
                       'notes': [note for line in lines for note in line['notes']]}


def best(line):
    """Return the smallest error of a line, rad."""
    return min(point['error'] for point in line['points'])


def ratios(result, named):
    """Return our best cost over the best peer's at each level.

    It is None where either does not reach the level. Of our lines only those count whose name
    satisfies `named`.
    """
    found = []
    for level in LEVELS:
        ours, theirs = (
            min((cost for line in lines if (cost := cost_at(line, level)) is not None),
                default=None)
            for lines in (
                [line for line in result['lines'] if not line['is_peer'] and named(line['name'])],
                [line for line in result['lines'] if line['is_peer']]))
        found.append(ours / theirs if ours and theirs else None)
    return found


def lines(result):
    """Return the lines of a problem's table."""
    text = [f'{result["problem"]}: {result["about"]}, {result["duration"]:g} s; '
            f'half an ulp on the inputs: {result["floor"]:.1e} rad',
            f'  {"CPU us per simulated second for":34}'
            f'{"".join(f"{level:>10.0e}" for level in LEVELS)}{"best rad":>11}{"on the way":>12}'
            f'{"omega":>10}{"energy":>10}{"L":>10}{"set-up s":>10}']
    shown = fronts(result['lines'])
    for line in shown:
        costs = ''.join(f'{_micro(cost_at(line, level)):>10}' for level in LEVELS)
        point = min(line['points'], key=lambda one: one['error'])
        name = f'{line["name"]}{" (peer)" if line["is_peer"] else ""}'
        text.append(f'  {name:34}{costs}{point["error"]:11.1e}{point["largest_error"]:12.1e}'
                    f'{point["omega_error"]:10.1e}'
                    f'{point["energy_residual"]:10.1e}{point["momentum_residual"]:10.1e}'
                    f'{line["points"][0]["set_up"]:10.2f}')
    text += [f'  {line["name"]}: {note}' for line in shown
             for note in line['notes'][-1:]]
    text += [f'  {name} does not run it: {reason}' for name, reason in result['refused'].items()]
    if any(line['is_peer'] for line in result['lines']):
        for label, named in (('ours of the best peer', lambda name: name != ONE_MORE),
                             (f'{ONE_MORE}, of it', lambda name: name == ONE_MORE)):
            found = ratios(result, named)
            if any(found):
                text.append(f'  {label:34}{"".join(f"{_share(ratio):>10}" for ratio in found)}')
    return text


def _share(ratio):
    return ('-' if ratio is None else f'1/{1.0 / ratio:.3g}' if ratio > 1e-3
            else f'1/{1.0 / ratio:.0f}')


def _micro(seconds):
    return '-' if seconds is None else f'{seconds * 1e6:.3g}'
