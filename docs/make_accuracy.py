"""Make the picture and the table of docs/accuracy.md, and the README's picture, of what `work_precision --suite --peers --output DIR` wrote.

::

    .venv-peers/bin/python -m rigid_body_sim work_precision --suite --peers --output study-full
    .venv/bin/python docs/make_accuracy.py study-full/work_precision.json

The table stands between ``<!-- work_precision -->`` and ``<!-- end -->``. `make study-full` does both.
"""

import json
import pathlib
import re
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent))
from rigid_body_sim.study.precision import figure, suite, table

DOCS = pathlib.Path(__file__).resolve().parent
MARK = re.compile(r'(<!-- work_precision -->\n).*?(<!-- end -->)', re.DOTALL)
ONE_MORE = 'one more state'


def rows(result):
    """Yield the rows of a problem: the best of ours and of the peers at each accuracy, in CPU microseconds per simulated second."""
    about = f'{result["problem"].replace("_", " ")}, {result["duration"]:g} s'
    ours = [line for line in result['lines'] if not line['is_peer'] and ONE_MORE not in line['name']]
    theirs = [line for line in result['lines'] if line['is_peer']]
    more = [line for line in result['lines'] if ONE_MORE in line['name']]
    for label, lines in ((f'**{about}**: ours', ours), ('exact, one more state', more), ('best peer', theirs)):
        if lines:
            yield label, [_cell(lines, level, label.endswith(('ours', 'peer'))) for level in table.LEVELS]


def _cell(lines, level, named):
    found = min(((cost, line['name']) for line in lines if (cost := table.cost_at(line, level)) is not None), default=None)
    if found is None:
        return 'not reached'
    return f'{found[0] * 1e6:.2g}' + (f' ({found[1]})' if named else '')


def text(found):
    """Return the table and what it was measured with."""
    processor = found['machine']['processor'].split()[0]
    lines = [f'{found["cores"]} cores ({processor}), Python {found["machine"]["python"].split()[0]}, numba {found["machine"]["numba"]}, '
             f'{found["made"][:10]}; medians of {found["repeats"]}; sweeps end at runs of {found["limit"]:g} s. Peers: '
             + ', '.join(f'{name} {version}' for name, version in found['peers'].items()) + '.', '',
             f'| | {" | ".join(f"{level:.0e}" for level in table.LEVELS)} |', f'|---|{"---|" * len(table.LEVELS)}']
    for result in found['results']:
        lines += [f'| {label} | {" | ".join(cells)} |' for label, cells in rows(result)]
    refusals = {}
    for result in found['results']:
        for name, reason in result['refused'].items():
            refusals.setdefault((name, reason), []).append(result['problem'].replace('_', ' '))
    lines += ['', 'What was refused, and why:', '']
    lines += [f'- {name}: {reason} ({", ".join(problems)})' for (name, reason), problems in refusals.items()]
    notes = {(line['name'], re.sub(r'[0-9.e+-]*[0-9]', '..', note)): note for result in found['results'] for line in result['lines']
             if line['is_peer'] for note in line['notes']}
    lines += ['', 'What peers get wrong without an error:', '']
    lines += [f'- {name}: {note}' for (name, _), note in notes.items()]
    return '\n'.join(lines) + '\n'


def main(path):
    """Write page, pictures and data."""
    found = json.loads(pathlib.Path(path).read_text())
    page = DOCS / 'accuracy.md'
    page.write_text(MARK.sub(lambda match: f'{match[1]}{text(found)}{match[2]}', page.read_text()))
    DOCS.joinpath('work_precision.json').write_text(json.dumps(found) + '\n')
    quick = [result for result in found['results'] if result['problem'] in suite.QUICK]
    for name, results in (('work_precision', quick), ('work_precision_suite', [one for one in found['results'] if one not in quick])):
        figure.draw(results).savefig(DOCS / 'images' / f'{name}.png', metadata={'Software': None})


if __name__ == '__main__':
    main(*sys.argv[1:])
