# SPDX-License-Identifier: Apache-2.0
"""Messages as bytes: little-endian CDR (XCDR1), the wire format of ROS 2.

The package encodes them itself, so padding is zero and bytes are repeatable.

A message begins with four bytes of encapsulation (00 01 00 00). The fields follow in order, each
aligned to its size (counted after the encapsulation). A string is its length including the final
zero byte, its UTF-8 text and that zero; a sequence is its length and its elements. (OMG DDS-RTPS
2.3, section 10; ROS 2 design, "Interface definition mapping".)
"""

import struct

from rigid_body_sim.errors import BadInput
from rigid_body_sim.messages.definitions import SEQUENCE, SIZES, schema

ENCAPSULATION = b'\x00\x01\x00\x00'
CODES = {
    'bool': '?',
    'byte': 'B',
    'char': 'B',
    'int8': 'b',
    'uint8': 'B',
    'int16': 'h',
    'uint16': 'H',
    'int32': 'i',
    'uint32': 'I',
    'int64': 'q',
    'uint64': 'Q',
    'float32': 'f',
    'float64': 'd',
}


def encode(type_name, values):
    """Return the bytes of a message of a known type.

    `values` is a nested dict; fields that it leaves out are zero, empty or "".

    Raises
    ------
    BadInput
        If a field does not exist or a value does not fit.
    """
    out = bytearray(ENCAPSULATION)
    try:
        _encode_fields(schema(type_name), type_name, values, out)
    except (struct.error, TypeError, AttributeError, OverflowError) as error:
        raise BadInput(type_name, f'a value does not fit its field ({error})',
                       'values of the types in the definition') from error
    return bytes(out)


def _align(out, size):
    out.extend(bytes(-(len(out) - 4) % size))


def _encode_fields(schemas, type_name, values, out):
    fields = schemas[type_name]
    unknown = set(values) - {field.name for field in fields}
    if unknown:
        raise BadInput(type_name, f'no field {sorted(unknown)[0]!r}',
                       f'one of {", ".join(field.name for field in fields)}')
    for field in fields:
        value = values.get(field.name)
        if field.array is None:
            _encode_elements(schemas, field, (value,), out)
        elif field.array == SEQUENCE:
            elements = () if value is None else value
            _align(out, 4)
            out.extend(struct.pack('<I', len(elements)))
            _encode_elements(schemas, field, elements, out)
        else:
            elements = (None,) * field.array if value is None else value
            if len(elements) != field.array:
                raise BadInput(f'{type_name}: {field.name}', f'{len(elements)} elements',
                               f'{field.array} elements')
            _encode_elements(schemas, field, elements, out)


def _encode_elements(schemas, field, elements, out):
    base = field.base
    if base in SIZES:
        if len(elements):
            _align(out, SIZES[base])
            out.extend(struct.pack(f'<{len(elements)}{CODES[base]}',
                                   *(0 if element is None else element for element in elements)))
    elif base == 'string':
        for element in elements:
            text = (element or '').encode() + b'\0'
            _align(out, 4)
            out.extend(struct.pack('<I', len(text)) + text)
    else:
        for element in elements:
            _encode_fields(schemas, base, element or {}, out)


def decode(schemas, type_name, data, leaves=None):
    """Return a message as a nested dict.

    `schemas` comes from :mod:`rigid_body_sim.messages.definitions`. If `leaves` is a list, the
    parts of the message are appended in wire order as (path, code, offset, count): `code` as in
    :mod:`struct`, ``'#'`` for the length of a string or sequence, ``'s'`` for the bytes of a
    string. Text that is not UTF-8 (ROS does not forbid it) gets replacement characters.

    Raises
    ------
    BadInput
        If the bytes are not such a message.
    """
    if bytes(data[:2]) != ENCAPSULATION[:2]:
        raise BadInput(type_name, f'a message that starts with {bytes(data[:4]).hex()}',
                       'little-endian CDR (00 01)')
    reader = _Reader(schemas, data, leaves)
    try:
        return reader.fields(type_name, '')
    except struct.error as error:
        problem = f'a message of {len(data)} bytes that cannot be decoded ({error})'
        raise BadInput(type_name, problem, 'a message that matches its definition') from error


class _Reader:
    def __init__(self, schemas, data, leaves):
        self.schemas, self.data, self.position, self.leaves = schemas, data, 4, leaves

    def fields(self, type_name, above):
        return {field.name: self.field(field, above + field.name)
                for field in self.schemas[type_name]}

    def field(self, field, path):
        if field.array is None:
            return self.elements(field.base, 1, path, (path,))[0]
        count = self.length(path) if field.array == SEQUENCE else field.array
        if count > len(self.data) - self.position:
            raise struct.error(f'{path} claims {count} elements')
        return self.elements(
            field.base, count, path, (f'{path}[{index}]' for index in range(count)))

    def length(self, path):
        return self.numbers('I', 1, path, '#')[0]

    def numbers(self, code, count, path, kind=None):
        size = struct.calcsize('<' + code)
        if count:
            self.position += -(self.position - 4) % size
        values = struct.unpack_from(f'<{count}{code}', self.data, self.position)
        self.note(path, kind or code, count)
        self.position += size * count
        return values

    def note(self, path, code, count):
        if self.leaves is not None:
            self.leaves.append((path, code, self.position, count))

    def elements(self, base, count, path, paths):
        if base in SIZES:
            return list(self.numbers(CODES[base], count, path))
        if base == 'string':
            return [self.string(element) for element in paths]
        return [self.fields(base, f'{element}.') for element in paths]

    def string(self, path):
        count = self.length(path)
        if count > len(self.data) - self.position:
            raise struct.error(f'{path} claims {count} bytes')
        text = bytes(self.data[self.position : self.position + max(0, count - 1)])
        self.note(path, 's', max(0, count - 1))
        self.position += count
        return text.decode(errors='replace')
