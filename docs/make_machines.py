# SPDX-License-Identifier: Apache-2.0
"""Write the table at the end of docs/machines.md from what `make test-machines` found.

::

    .venv/bin/python docs/make_machines.py       # reads docs/machines.json
"""

import json
import pathlib

from rigid_body_sim.simulation import arithmetic

DOCS = pathlib.Path(__file__).resolve().parent
BEGIN = '## What was measured\n'
HEAD = ('this machine stands for', 'digests', 'numeric tests', 'seconds', 'processor', 'commit',
        'date')


def section(rows, version):
    """Return the last section of the page."""
    old = sum(row.get('arithmetic', version) != version for row in rows)
    about = ('A row is what was found when a machine was last visited. A visit with `--digests`\n'
             'runs no numeric tests (-).\n'
             'Visits share the processor with other work, so their times are upper bounds.')
    about += f'\nThe arithmetic is `{version}`' + (
        f' but for {old} rows, which are of the version that they\nname.' if old else '.')
    lines = [BEGIN, about + '\n']
    cells = [HEAD, ('---',) * len(HEAD)]
    for row in rows:
        made = row.get('arithmetic', version)
        verdict = row['verdict'] + f' (`{made}`)' * (made != version)
        cells.append((row['name'], verdict, row.get('tests') or '-', str(row.get('seconds', '-')),
                      row.get('processor', '-'), row.get('commit', '-'), row.get('date', '-')))
    return '\n'.join([*lines, *(f'| {" | ".join(row)} |' for row in cells)]) + '\n'


def main():
    """Replace the last section of the page."""
    rows = json.loads((DOCS / 'machines.json').read_text(encoding='utf-8'))
    page = DOCS / 'machines.md'
    page.write_text(page.read_text(encoding='utf-8').partition(BEGIN)[0]
                    + section(rows, arithmetic.version()), encoding='utf-8')


if __name__ == '__main__':
    main()
