# SPDX-License-Identifier: Apache-2.0
"""Make the tables of docs/reference from the tables of the package.

A page marks the place of a table by ``<!-- table: NAME -->``; the lines up to ``<!-- end -->`` are
generated. test/test_docs.py fails if a page is not as this makes it.

::

    python docs/make_reference.py
"""

import pathlib
import re

from rigid_body_sim.cli.subcommands import SUBCOMMANDS
from rigid_body_sim.messages import state_topics
from rigid_body_sim.scene.constraints import CONSTRAINTS
from rigid_body_sim.scene.constraints.protocol import Mechanism
from rigid_body_sim.scene.effects import EFFECTS

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


def subcommands():
    """Return the subcommands."""
    return '\n'.join(['| name | does |', '|---|---|',
                      *(f'| `{name}` | {about} |' for name, (_, about) in SUBCOMMANDS.items())])


WHERE = {Mechanism.FREE: 'free', Mechanism.POINT: 'pivot', Mechanism.AXIS: 'hinge',
         Mechanism.TABLE: 'table', Mechanism.PLANE: 'table, with a surface'}


def effects():
    """Return the effects: law, where they may act, and each key with unit, axes and default."""
    lines = []
    for name, effect in EFFECTS.items():
        schema = effect.SCHEMA
        where = '; '.join(word for kind, word in WHERE.items() if kind in effect.mechanisms)
        often = ' A scene may list several.' if effect.repeatable else ''
        lines += [f'### {name}', '', f'`{schema["description"]}`', '', f'On: {where}.{often}', '',
                  *_keys(schema), '']
    return '\n'.join(lines).rstrip()


def constraints():
    """Return the constraints that take settings."""
    lines = []
    for kind, word in CONSTRAINTS.items():
        schemas = [one.SCHEMA for one in word.variants() if one.SCHEMA]
        for schema in schemas:
            name = f'{kind} with {schema["required"][0]}' if len(schemas) > 1 else kind
            lines += [f'### {name}', '', schema['description'] + '.', '', *_keys(schema), '']
    return '\n'.join(lines).rstrip()


def _keys(schema):
    """Return the rows of a table of keys."""
    rows = ['| key | takes | meaning | default |', '|---|---|---|---|']
    for key, one in schema['properties'].items():
        default = 'needed' if key in schema['required'] else f'`{one["default"]}`' \
            if 'default' in one else ''
        rows.append(f'| `{key}` | {_takes(one)} | {one["description"].replace("|", "&#124;")} '
                    f'| {default} |')
    return rows


def _takes(schema):
    """Return what a key takes, in words."""
    if 'enum' in schema:
        return ' or '.join(f'`{word}`' for word in schema['enum'])
    if schema['type'] == 'object':
        return f'`{{{", ".join(schema["properties"])}}}`'
    kinds = [schema['type']] if isinstance(schema['type'], str) else schema['type']
    number = ('number above 0' if 'exclusiveMinimum' in schema else
              'number from 0 on' if 'minimum' in schema else 'number')
    number = f'{number} or expression' if schema.get('expression') else number
    words = [number] * ('number' in kinds)
    if 'array' in kinds:
        entry = schema['items']
        inner = ('vectors' if entry['type'] == 'array' else 'expressions'
                 if entry.get('expression') else 'numbers')
        size = schema.get('maxItems')
        words.append(f'{size or "a list of"} {inner}')
    return ' or '.join(words)


def filled(text):
    """Return a page with its tables made anew."""
    tables = {'parameters': parameters, 'topics': topics, 'subcommands': subcommands,
              'effects': effects, 'constraints': constraints}
    return MARK.sub(lambda match: f'{match[1]}{tables[match[2]]()}\n{match[3]}', text)


if __name__ == '__main__':
    for page in sorted(FOLDER.glob('*.md')):
        page.write_text(filled(page.read_text()))
