# SPDX-License-Identifier: Apache-2.0
"""Make the pictures and the tables of docs/accuracy, and the README's picture.

They show what `work_precision --suite --peers --output DIR` wrote.

::

    .venv-peers/bin/python -m rigid_body_sim work_precision --suite --peers --output study-full
    .venv/bin/python docs/make_accuracy.py study-full/work_precision.json

The tables stand in problems.md between ``<!-- work_precision -->`` and ``<!-- end -->``, and in
plane.md from ``<!-- on_a_plane -->`` on.
`make study-full` does both. The arguments may be several files, studies of single problems for
example; the last one with a problem counts. docs/work_precision.json may be one of them: what it
has stands. With ``--second`` they are studies on a second processor: second_processor.md has their
table, docs/work_precision_second.json their data.
"""

import json
import pathlib
import re
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from rigid_body_sim.study.precision import figure, runner, suite, table

DOCS = pathlib.Path(__file__).resolve().parent
COARSE = 1e-1, 1e-2, 1e-3, 1e-6, 1e-9    # levels of the table of bodies on a plane, rad
ONE_MORE = runner.ONE_MORE


def rows(result):
    """Yield the rows of a problem: its best cost at each accuracy, ours and the peers'.

    Costs are CPU microseconds per simulated second.
    """
    about = f'{result["problem"].replace("_", " ")}, {result["duration"]:g} s'
    ours = [line for line in result['lines'] if not line['is_peer'] and line['name'] != ONE_MORE]
    theirs = [line for line in result['lines'] if line['is_peer']]
    more = [line for line in result['lines'] if line['name'] == ONE_MORE]
    for label, lines in ((f'**{about}**: ours', ours), (ONE_MORE, more), ('best peer', theirs)):
        if lines:
            yield label, [_cell(lines, level, label.endswith(('ours', 'peer')), result['floor'])
                          for level in table.LEVELS]


def _cell(lines, level, named, floor):
    found = min(((cost, line['name']) for line in lines
                 if (cost := table.cost_at(line, level)) is not None), default=None)
    if found is None:
        return 'not reached' if level > floor else 'below the floor'
    return f'{found[0] * 1e6:.2g}' + (f' ({found[1]})' if named else '')


def _study(one, limit):
    machine, peers = one['machine'], ', '.join(
        f'{name} {version}' for name, version in one['peers'].items())
    return (f'{one["cores"]} cores ({machine["processor"].split()[0]}), '
            f'Python {machine["python"].split()[0]}, numba {machine["numba"]}, '
            f'{one["made"][:10]}; medians of {one["repeats"]}; '
            f'sweeps end at runs of {limit:g} s. Peers: {peers}.')


def rows_of_each(result):
    """Yield the rows of a problem on a plane: the cost of ours, and that of each peer.

    The last cell is the least error of all settings, with its setting.
    """
    about = f'{result["problem"].replace("_", " ")}, {result["duration"]:g} s'
    lines = table.fronts(result['lines'])
    ours = [line for line in lines if not line['is_peer']]
    for label, of in ((f'**{about}**: ours', ours),
                      *((line['name'], [line]) for line in lines if line['is_peer'])):
        least, setting = min((point['error'], point['setting']) for line in of
                             for point in line['points'])
        said = f' ({setting})' if isinstance(setting, str) else ''
        yield label, [*(_cell(of, level, of is ours, result['floor']) for level in COARSE),
                      f'{least:.0e}{said}']


def _conditions(studies, results):
    """Return the lines that say how the problems of these results were measured."""
    measured, limits = {}, {one['problem']: one.get('limit') for one in results}
    for study in studies:
        for name in study['problems']:
            if name in limits:
                measured.setdefault(_study(study, limits[name] or study['limit']), []).append(name)
    return [said if len(measured) == 1
            else f'- {", ".join(name.replace("_", " ") for name in problems)}: {said}'
            for said, problems in measured.items()]


def _refusals(results):
    """Return the lines that say what was refused, and why."""
    refusals = {}
    for result in results:
        for name, reason in result['refused'].items():
            refusals.setdefault((name, reason.split('. ')[0]), []).append(
                result['problem'].replace('_', ' '))
    return ['', 'What was refused, and why:', '',
            *(f'- {name}: {reason} ({", ".join(problems)})'
              for (name, reason), problems in refusals.items())]


def on_a_plane(found):
    """Return the table of bodies on a plane, and the conditions of its measurement."""
    heads = *(f'{level:.0e}' for level in COARSE), 'least error, rad'
    results = [result for result in found['results'] if result['problem'] in suite.ON_A_PLANE]
    return '\n'.join([
        *_conditions(found['studies'], results), '', f'| | {" | ".join(heads)} |',
        f'|---|{"---|" * len(heads)}',
        *(f'| {label} | {" | ".join(cells)} |'
          for result in results for label, cells in rows_of_each(result)),
        *_refusals([{**result, 'refused': {
            name: reason for name, reason in result['refused'].items()
            if not name.endswith(figure.FIXED)}} for result in results])])


def text(found):
    """Return the table, and the conditions of its measurement."""
    studies = found['studies']
    found = [result for result in found['results'] if result['problem'] in suite.NAMES]
    lines = [*_conditions(studies, found), '',
             f'| | {" | ".join(f"{level:.0e}" for level in table.LEVELS)} |',
             f'|---|{"---|" * len(table.LEVELS)}']
    for result in found:
        lines += [f'| {label} | {" | ".join(cells)} |' for label, cells in rows(result)]
    lines += _refusals(found)
    notes = {}    # one note of each kind
    for line in (line for result in found
                 for line in result['lines'] if line['is_peer']):
        for note in line['notes']:
            notes.setdefault((line['name'], re.sub(r'[0-9.e+-]*[0-9]', '', note)),
                             note.split('. ')[0])
    lines += ['', 'What peers get wrong, or give up on, at some settings:', '']
    lines += [f'- {name}: {note}' for (name, _), note in notes.items()]
    return '\n'.join(lines)


def _short(value):
    """Return JSON whose numbers have six digits, more than are reproduced."""
    if isinstance(value, dict):
        return {key: _short(one) for key, one in value.items()}
    if isinstance(value, list):
        return [_short(one) for one in value]
    return float(f'{value:.6g}') if isinstance(value, float) else value


def main(*arguments):
    """Write the pages, the pictures and the data; or those of the second processor."""
    second = '--second' in arguments
    found = _joined([json.loads(pathlib.Path(path).read_text())
                     for path in arguments if path != '--second'])
    if second:
        _write('second_processor', 'work_precision', text(found))
        _keep('work_precision_second', found)
        return
    _write('problems', 'work_precision', text(found))
    _write('plane', 'on_a_plane', on_a_plane(found))
    _keep('work_precision', found)
    for name, chosen in (('work_precision', suite.QUICK),
                         ('work_precision_suite', set(suite.NAMES) - set(suite.QUICK)),
                         ('work_precision_plane', suite.ON_A_PLANE)):
        drawn = [result for result in found['results'] if result['problem'] in chosen]
        figure.draw(drawn).savefig(
            DOCS / 'images' / f'{name}.png', dpi=150, metadata={'Software': None})


def _joined(read):
    """Return the results of several files, the last of each problem, with their studies."""
    measured, from_study, studies = {}, {}, []
    for one in read:
        # each study with the problems that it measured; a file of these pages has several
        parts = one.get('studies') or [{key: one[key] for key in one if key != 'results'}]
        for study in parts:
            names = study.get('problems') or [result['problem'] for result in one['results']]
            from_study |= dict.fromkeys(names, len(studies))
            studies.append(study)
        measured |= {result['problem']: result for result in one['results']}
    names = [name for name in suite.NAMES + suite.ON_A_PLANE if name in measured]
    return {'studies': [study | {'problems': of} for number, study in enumerate(studies)
                        if (of := [name for name in names if from_study[name] == number])],
            'results': [measured[name] for name in names]}


def _write(page, mark, made):
    """Write a table into its place on a page."""
    path = DOCS / 'accuracy' / f'{page}.md'
    said = path.read_text()
    begin = said.index(f'<!-- {mark} -->\n') + len(f'<!-- {mark} -->\n')
    path.write_text(said[:begin] + made + '\n' + said[said.index('<!-- end -->', begin):])


def _keep(name, found):
    """Keep the data that a page shows."""
    kept = json.dumps(_short(found), separators=(',', ':'))
    (DOCS / f'{name}.json').write_text(kept + '\n')


if __name__ == '__main__':
    main(*sys.argv[1:])
