# SPDX-License-Identifier: Apache-2.0
"""Write the table at the end of docs/machines.md from the results of `make test-machines`.

::

    .venv/bin/python docs/make_machines.py       # reads .cache/machines/table.json
"""

import json
import pathlib

DOCS = pathlib.Path(__file__).resolve().parent
MEASURED = DOCS.parent / '.cache' / 'machines' / 'table.json'
BEGIN = '## What was measured\n'


def main():
    """Replace the last section of the page."""
    found = json.loads(MEASURED.read_text())
    page = DOCS / 'machines.md'
    lines = [
        BEGIN,
        f'Arithmetic {found["arithmetic"]}, {found["cases"]} cases on a {found["processor"]}.\n',
        '| this machine stands for | digests | numeric tests | time |',
        '| --- | --- | --- | --- |',
        *(f'| {" | ".join(row)} |' for row in found['rows'])]
    page.write_text(page.read_text().partition(BEGIN)[0] + '\n'.join(lines) + '\n')


if __name__ == '__main__':
    main()
