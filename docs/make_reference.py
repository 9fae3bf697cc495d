# SPDX-License-Identifier: Apache-2.0
"""Make the tables of docs/reference from the tables of the package.

A page marks the place of a table by ``<!-- table: NAME -->``; the lines up to ``<!-- end -->`` are
generated. test/test_docs.py fails if a page is not as this makes it.

::

    python docs/make_reference.py
"""

import pathlib
import re

from rigid_body_sim.cli.subcommands import COMMANDS
from rigid_body_sim.messages import state_topics

FOLDER = pathlib.Path(__file__).resolve().parent / 'reference'
MARK = re.compile(r'(<!-- table: (\w+) -->\n).*?(<!-- end -->)', re.DOTALL)


def parameters():
    """Return the parameters of the node."""
    from rigid_body_sim.node import parameters  # needs ROS, the other tables do not
    return parameters.table()


def topics():
    """Return the topics that states fill."""
    rows = ['| topic | type | holds | when |', '|---|---|---|---|']
    for output in (*state_topics.EVERY_TICK, *state_topics.ON_REQUEST):
        when = ('every tick' if output in state_topics.EVERY_TICK
                else 'when named in `publish`, at `display_rate`' if output.paced
                else 'when named in `publish`, every tick')
        rows.append(f'| `{"/" * output.absolute}{output.name}` | {output.type} | {output.about} '
                    f'| {when} |')
    return '\n'.join(rows)


def commands():
    """Return the subcommands."""
    return '\n'.join(['| name | does |', '|---|---|',
                      *(f'| `{name}` | {about} |' for name, (_, about) in COMMANDS.items())])


def filled(text):
    """Return a page with its tables made anew."""
    tables = {'parameters': parameters, 'topics': topics, 'commands': commands}
    return MARK.sub(lambda match: f'{match[1]}{tables[match[2]]()}\n{match[3]}', text)


if __name__ == '__main__':
    for page in sorted(FOLDER.glob('*.md')):
        page.write_text(filled(page.read_text()))
