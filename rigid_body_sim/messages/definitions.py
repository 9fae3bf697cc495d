"""Message definitions: the types we publish, as data (definitions.json), and a parser of ``ros2msg`` text for those of strangers.

A schema is a dict from type name (``geometry_msgs/msg/Pose``) to its fields in wire order.
"""

import functools
import json
import pathlib
import re
import typing

from rigid_body_sim.errors import BadInput

SIZES = {'bool': 1, 'byte': 1, 'char': 1, 'int8': 1, 'uint8': 1, 'int16': 2, 'uint16': 2, 'int32': 4, 'uint32': 4, 'int64': 8, 'uint64': 8,
         'float32': 4, 'float64': 8}
SEQUENCE = -1
_SEPARATOR = re.compile(r'^={80}\s*$', re.MULTILINE)
_FIELD = re.compile(r'(?P<base>[A-Za-z]\w*(?:/\w+){0,2})(?P<bound><=\d+)?(?P<array>\[(?:<=)?\d*\])?\s+(?P<name>[A-Za-z]\w*)'
                    r'\s*(?P<constant>=(?!=))?')
_MAX_FIXED_ARRAY = 1_000_000


class Field(typing.NamedTuple):
    """One field: `base` is a primitive's name, ``string`` or a type name; `array` is None, the fixed length, or SEQUENCE."""

    name: str
    base: str
    array: int | None


class Definition(typing.NamedTuple):
    """A message type: its complete ``ros2msg`` text and its RIHS01 hash, both as rosbag2 records them."""

    type_name: str
    text: str
    hash: str


@functools.cache
def _shipped():
    return json.loads((pathlib.Path(__file__).parent / 'definitions.json').read_text())


def definition(type_name):
    """Return the Definition of a type we ship; BadInput for another."""
    if type_name not in _shipped():
        raise BadInput(type_name, 'is not among the message types this package knows', f'one of {", ".join(sorted(_shipped()))}')
    return Definition(type_name, **_shipped()[type_name])


@functools.cache
def schema(type_name):
    """Return the schema of a type we ship."""
    return parse(type_name, definition(type_name).text)


def parse(type_name, text):
    """Return the schema in a complete ``ros2msg`` text; BadInput where the text makes no sense.

    Every type that is reached from `type_name` must be there, and none may contain itself.
    """
    schemas = {}
    current = type_name
    for part in _SEPARATOR.split(text):
        if schemas:
            head, _, part = part.lstrip('\r\n').partition('\n')
            if not head.startswith('MSG:'):
                raise BadInput(f'definition of {type_name}', f'{head[:60]!r} after a separator', 'a line "MSG: package/Name"')
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
            raise BadInput(f'definition of {type_name}', f'the line {line[:80]!r}', 'a field like "float64 x"')
        if match['constant']:
            continue
        base, array = match['base'], None
        if match['array']:
            length = match['array'][1:-1]
            array = int(length) if length.isdigit() else SEQUENCE
            if array > _MAX_FIXED_ARRAY:
                raise BadInput(f'definition of {type_name}', f'an array of {array} elements', f'at most {_MAX_FIXED_ARRAY}')
        if base not in SIZES and base != 'string':
            base = _full_name(base, type_name.split('/')[0])
        fields.append(Field(match['name'], base, array))
    return fields or [Field('structure_needs_at_least_one_member', 'uint8', None)]


def _check(schemas, type_name, above):
    if type_name not in schemas:
        raise BadInput(f'definition of {(above or (type_name,))[0]}', f'{type_name} is missing', 'a text with all the types it depends on')
    if type_name in above or len(above) > 32:
        raise BadInput(f'definition of {above[0]}', f'{type_name} contains itself or lies too deep', 'a finite type')
    for field in schemas[type_name]:
        if field.base not in SIZES and field.base != 'string':
            _check(schemas, field.base, (*above, type_name))
