# SPDX-License-Identifier: Apache-2.0
"""Parameter overrides of a command line, merged so that the last one of a name wins.

rcl keeps one value of each type for a name: given ``rate: 500`` in a file and ``-p rate:=200.5``
it keeps both, and rclpy takes the integer, whichever came last. rclpy also prefers an entry of a
file for the node's own name to a later ``-p``. So the overrides are merged here, before rcl reads
them. Values are moved as text, so rcl decides on their types.
"""

import contextlib
import os
import re
import tempfile

import yaml

from rigid_body_sim.node.parameter_table import ENTRIES

PARAMETERS = 'ros__parameters'
EVERY_NODE = '/**'
RULE, FILE = ('-p', '--param'), ('--params-file',)
TEXT = 'tag:yaml.org,2002:str'


@contextlib.contextmanager
def settled(arguments):
    """Yield arguments that set each parameter once, and the names that are meant for any node.

    A command line that cannot be understood stays as it is, for rcl to refuse in its own words.

    Parameters
    ----------
    arguments : list of str
        The command line, with ``--ros-args``.

    Yields
    ------
    list of str
        The command line, with one file of parameters, which exists until the end of the context.
    frozenset of str
        Names that come from a file's section for several nodes (``/**``) only: they may be
        parameters of another node.
    """
    rest, sources = _taken_apart(arguments)
    try:
        sections = [section for source in sources for section in _sections(*source)]
    except (OSError, ValueError, yaml.YAMLError):
        sections = None
    if not sections:
        yield arguments, frozenset()
        return
    merged, shared = _merged(sections)
    handle, path = tempfile.mkstemp(suffix='.yaml', text=True)
    try:
        with os.fdopen(handle, 'w', encoding='utf-8') as file:
            file.write(_text(merged))
        yield [*rest, '--ros-args', *FILE, path], shared
    finally:
        os.unlink(path)


def _taken_apart(arguments):
    """Return the arguments without parameters, and (flag, text) of the parameters in order."""
    rest, sources, ours, place = [], [], False, 0
    while place < len(arguments):
        one = arguments[place]
        ours = one == '--ros-args' or (ours and one != '--')
        if ours and one in RULE + FILE and place + 1 < len(arguments):
            sources.append((one, arguments[place + 1]))
            place += 1
        else:
            rest.append(one)
        place += 1
    return rest, sources


def _sections(flag, text):
    """Return a list of (from a file, {node: {name: YAML node}}), one for each YAML document.

    It raises ValueError if the source is unclear.
    """
    if flag in FILE:
        with open(text, encoding='utf-8') as file:
            return [(True, dict(_nodes(document, ''))) for document in _composed(file)]
    name, equals, value = text.partition(':=')
    node, colon, own = name.rpartition(':')
    [value, *more] = _composed(value)
    if more or not (equals and own):
        raise ValueError(text)
    return [(False, {f'/{node.lstrip("/")}' if colon else EVERY_NODE: {own: value}})]


def _composed(text):
    documents = list(yaml.compose_all(text, Loader=yaml.SafeLoader))
    if not documents:
        raise ValueError('empty')
    return documents


def _nodes(node, path):
    """Yield (node name, {parameter name: YAML node}) of a file."""
    for key, value in _entries(node):
        if key == PARAMETERS:
            yield path or EVERY_NODE, dict(_flat(value, ''))
        else:
            yield from _nodes(value, f'{path}/{key.strip("/")}')


def _flat(node, before):
    """Yield (parameter name, YAML node); nested names are joined by dots."""
    for key, value in _entries(node):
        if isinstance(value, yaml.MappingNode):
            yield from _flat(value, f'{before}{key}.')
        else:
            yield f'{before}{key}', value


def _entries(node):
    if not isinstance(node, yaml.MappingNode):
        raise ValueError('no mapping')
    for key, value in node.value:
        if not isinstance(key, yaml.ScalarNode):
            raise ValueError('no word')
        yield key.value, value


def _merged(sections):
    """Return {node: {name: YAML node}} without what a later source replaces, and the shared names.

    Within one source rclpy decides: it prefers the name of a node to a pattern.
    """
    merged, whence = {}, {}
    for from_file, section in sections:
        for node, parameters in section.items():
            for other in [other for other in merged if _covers(node, other)]:
                for name in parameters:
                    merged[other].pop(name, None)
        for node, parameters in section.items():
            merged.setdefault(node, {}).update(parameters)
            for name in parameters:
                whence[node, name] = from_file
    named = [(name, from_file and node.rpartition('/')[2].startswith('*'))
             for (node, name), from_file in whence.items() if name in merged[node]]
    meant = {name for name, shared in named if not shared}
    return merged, frozenset({name for name, shared in named if shared} - meant)


def _covers(pattern, node):
    """Return whether all nodes that a name or pattern stands for are covered by a pattern."""
    parts = re.split(r'(/\*\*|\*)', pattern)
    meanings = {'/**': '(?:/.*)?', '*': '[^/]*'}
    return re.fullmatch(''.join(meanings.get(part, re.escape(part)) for part in parts), node)


def _text(merged):
    def mapping(entries):
        return yaml.MappingNode('tag:yaml.org,2002:map', [
            (yaml.ScalarNode(TEXT, key), value) for key, value in entries.items()])
    nodes = {node: mapping({PARAMETERS: mapping({name: _quoted(name, value)
                                                 for name, value in parameters.items()})})
             for node, parameters in merged.items() if parameters}
    return yaml.serialize(mapping(nodes), Dumper=yaml.SafeDumper, allow_unicode=True,
                          width=float('inf'))


def _quoted(name, value):
    """Return the YAML node of a parameter, in quotes where it is a text that rcl would change.

    rcl reads 1e3 as a number and y as true. PyYAML, which ``ros2 param dump`` writes with, takes
    both for texts and leaves out the quotes.
    """
    if isinstance(getattr(ENTRIES.get(name), 'default', None), str) and value.tag == TEXT:
        return yaml.ScalarNode(TEXT, value.value, style="'")
    return value
