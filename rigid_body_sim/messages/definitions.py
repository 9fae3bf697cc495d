# SPDX-License-Identifier: Apache-2.0
"""Message definitions, from the installed ROS 2 or kept here, and a parser of their text.

``definitions.json`` keeps those of the types that this package publishes and records, as ROS 2
Jazzy has them (common_interfaces, Apache 2.0; tf2_msgs), for installations without ROS.
``python -m rigid_body_sim.messages.definitions > rigid_body_sim/messages/definitions.json`` makes
it anew where a ROS 2 Jazzy is installed; types that it lacks stay as they are.

The text is ``ros2msg``, as recordings contain it, so the parser reads foreign recordings as well.
A schema is a dict from type name (``geometry_msgs/msg/Pose``) to its fields in wire order.
"""

import functools
import importlib.util
import json
import pathlib
import re
import typing

from rigid_body_sim.errors import BadInput

SIZES = {'bool': 1, 'byte': 1, 'char': 1, 'int8': 1, 'uint8': 1, 'int16': 2, 'uint16': 2,
         'int32': 4, 'uint32': 4, 'int64': 8, 'uint64': 8, 'float32': 4, 'float64': 8}
SEQUENCE = -1
_SEPARATOR = re.compile(r'^={80}\s*$', re.MULTILINE)
_FIELD = re.compile(r'(?P<base>[A-Za-z]\w*(?:/\w+){0,2})(?P<bound><=\d+)?'
                    r'(?P<array>\[(?:<=)?\d*\])?\s+(?P<name>[A-Za-z]\w*)'
                    r'\s*(?P<constant>=(?!=))?')
_FIELD_TYPE = re.compile(r'(?:^|\n)\s*([a-zA-Z0-9_/]+)(?:\[[^\]]*\])?\s+')
_MAX_FIXED_ARRAY = 1_000_000


class Field(typing.NamedTuple):
    """One field of a message.

    `base` is a primitive's name, ``string`` or a type name; `array` is None, the fixed length, or
    SEQUENCE.
    """

    name: str
    base: str
    array: int | None


class Definition(typing.NamedTuple):
    """A message type: its complete ``ros2msg`` text and its RIHS01 hash, as rosbag2 has them."""

    type_name: str
    text: str
    hash: str


@functools.cache
def definition(type_name):
    """Return the Definition of a type, from the installed ROS 2 or else from those kept here.

    Raises
    ------
    BadInput
        If neither knows the type.
    """
    found = _of_ros(type_name) or _kept().get(type_name)
    if found is None:
        raise BadInput(type_name, 'is a message type that is not installed here',
                       f'a ROS 2 package that defines it, or one of {", ".join(sorted(_kept()))}')
    return found


@functools.cache
def _kept():
    """Return {type name: Definition} of the types kept here."""
    text = pathlib.Path(__file__).with_suffix('.json').read_text(encoding='utf-8')
    return {name: Definition(name, ''.join(one['text']), one['hash'])
            for name, one in json.loads(text).items()}


def _of_ros(type_name):
    """Return the Definition in the share folder of the installed ROS 2, or None."""
    path = _message_file(type_name)
    if path is None:
        return None
    described = json.loads(path.with_suffix('.json').read_text(encoding='utf-8'))
    hashes = {entry['type_name']: entry['hash_string'] for entry in described['type_hashes']}
    return Definition(type_name, _complete_text(type_name, set()), hashes[type_name])


def _message_file(type_name):
    """Return the path of the .msg file of a type, or None.

    ROS keeps it in the share folder of the prefix that contains the package's Python modules. This
    holds for ROS from apt, for wheels and for a colcon workspace, sourced or not.
    """
    match = re.fullmatch(r'(\w+)/msg/(\w+)', type_name)
    spec = importlib.util.find_spec(match[1]) if match else None
    # spec.origin is prefix/lib/python3.12/site-packages/package/__init__.py
    for prefix in pathlib.Path(spec.origin).parents[4:5] if spec and spec.origin else ():
        path = prefix / 'share' / match[1] / 'msg' / f'{match[2]}.msg'
        if path.is_file() and path.with_suffix('.json').is_file():
            return path
    return None


def _complete_text(type_name, seen):
    """Return the text of a .msg file and of those it depends on, as rosbag2 writes it.

    The latter are sorted, depth first, and come once each (`seen` collects the names), after a
    line of 80 ``=`` and a line ``MSG: package/Name``.
    """
    text = _message_file(type_name).read_text(encoding='utf-8')
    package = type_name.split('/')[0]
    needed = {name for name in _FIELD_TYPE.findall(text) if name not in {*SIZES, 'string'}}
    for name in sorted(_full_name(name, package) for name in needed):
        if name not in seen:
            seen.add(name)
            short = name.replace('/msg/', '/')
            text += f'\n{"=" * 80}\nMSG: {short}\n' + _complete_text(name, seen)
    return text


@functools.cache
def schema(type_name):
    """Return the schema of a type, see :func:`definition`."""
    return parse(type_name, definition(type_name).text)


def parse(type_name, text):
    """Return the schema in a complete ``ros2msg`` text.

    Every type that is reached from `type_name` must be there, and none may contain itself.

    Raises
    ------
    BadInput
        If the text is not such a definition.
    """
    schemas = {}
    current = type_name
    for part in _SEPARATOR.split(text):
        if schemas:
            head, _, part = part.lstrip('\r\n').partition('\n')
            if not head.startswith('MSG:'):
                raise BadInput(f'definition of {type_name}', f'{head[:60]!r} after a separator',
                               'a line "MSG: package/Name"')
            current = _full_name(head[4:].strip(), '')
        schemas[current] = _fields(current, part)
    _check(schemas, type_name, ())
    return schemas


def _full_name(name, package):
    """Turn ``Name``, ``package/Name`` or ``package/msg/Name`` into the last form."""
    parts = name.split('/')
    return '/'.join((parts[0] if len(parts) > 1 else package, 'msg', parts[-1]))


def _fields(type_name, text):
    fields = []
    for line in text.splitlines():
        line = line.split('#', 1)[0].strip()
        if not line:
            continue
        match = _FIELD.match(line)
        if not match:
            raise BadInput(f'definition of {type_name}', f'the line {line[:80]!r}',
                           'a field like "float64 x"')
        if match['constant']:
            continue
        base, array = match['base'], None
        if match['array']:
            length = match['array'][1:-1]
            array = int(length) if length.isdigit() else SEQUENCE
            if array > _MAX_FIXED_ARRAY:
                raise BadInput(f'definition of {type_name}', f'an array of {array} elements',
                               f'at most {_MAX_FIXED_ARRAY}')
        if base not in SIZES and base != 'string':
            base = _full_name(base, type_name.split('/')[0])
        fields.append(Field(match['name'], base, array))
    return fields or [Field('structure_needs_at_least_one_member', 'uint8', None)]


def _check(schemas, type_name, above):
    if type_name not in schemas:
        raise BadInput(f'definition of {(above or (type_name,))[0]}', f'{type_name} is missing',
                       'a text with all the types it depends on')
    if type_name in above or len(above) > 32:
        raise BadInput(f'definition of {above[0]}',
                       f'{type_name} contains itself or is nested too deeply', 'a finite type')
    for field in schemas[type_name]:
        if field.base not in SIZES and field.base != 'string':
            _check(schemas, field.base, (*above, type_name))


if __name__ == '__main__':
    print(json.dumps({name: {'hash': found.hash, 'text': found.text.splitlines(keepends=True)}
                      for name, found in ((name, definition(name)) for name in sorted(_kept()))},
                     indent=1))
