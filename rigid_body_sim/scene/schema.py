# SPDX-License-Identifier: Apache-2.0
"""JSON schemas of the parts of a scene file, and the check that refuses a fault in one line."""

import functools
import itertools
import math
from collections.abc import Iterable
from typing import Any

import jsonschema

from rigid_body_sim.errors import BadInput, nearest
from rigid_body_sim.scene import yaml_text

Schema = dict[str, Any]

LARGEST = 1e75
"""Largest size of a number in a scene, SI units: a product of four of them is a finite double."""

NUMBER: Schema = {'type': 'number'}
POSITIVE: Schema = {'type': 'number', 'exclusiveMinimum': 0}
VECTOR: Schema = {'type': 'array', 'items': NUMBER, 'minItems': 3, 'maxItems': 3}
QUATERNION: Schema = {'type': 'array', 'items': NUMBER, 'minItems': 4, 'maxItems': 4}
INFINITE = 'sliding_friction.mu'
"""The key whose number may be infinite: the body then always rolls."""
MATRIX: Schema = {'type': 'array', 'items': VECTOR, 'minItems': 3, 'maxItems': 3}


ABOUT = 'type', 'description', 'default'
OF_MAPPINGS = frozenset((*ABOUT, 'properties', 'required', 'additionalProperties'))
OF_LISTS = frozenset((*ABOUT, 'items', 'minItems', 'maxItems'))
OF_NUMBERS = frozenset((*ABOUT, 'minimum', 'maximum', 'exclusiveMinimum'))
"""The words of schemas of mappings, lists and numbers that `_fits` knows."""
KEPT = 512    # entries of scenes that are known to satisfy their schemas, or not to


def mapping_of(required: Iterable[str] = (), **properties: Schema) -> Schema:
    """Return the schema of a mapping that has these keys and no others."""
    return {'type': 'object', 'properties': properties, 'required': list(required),
            'additionalProperties': False}


def described(schema: Schema, text: str, default: Any = None) -> Schema:
    """Return a schema with what it means: the law of an effect; unit, axes and sign of a key.

    docs/reference/effects.md and the JSON Schema of scene files have these words.
    """
    found = {**schema, 'description': text}
    return found if default is None else {**found, 'default': default}


def check(value: Any, schema: Schema, where: str) -> None:
    """Check a part of a scene against a schema; every number must be finite.

    Raises
    ------
    BadInput
        For the first fault: file and key path, the value, what would be right.
    """
    if _fits(value, schema):
        return
    _refuse_non_finite(value, where)
    errors = sorted(jsonschema.Draft202012Validator(schema).iter_errors(value),
                    key=lambda error: (len(error.absolute_path), _last(error), str(error.path)))
    if not errors:
        return
    error: Any = errors[0]    # its attributes are typed as perhaps unset, which here they are not
    where = at(where, *error.absolute_path)
    if error.validator == 'additionalProperties':
        known = sorted(error.schema['properties'])
        unknown = next(key for key in error.instance if key not in known)
        near = nearest(unknown, known)
        raise BadInput(where, f'unknown key {unknown!r}', f'did you mean {near!r}?' if near
                       else f'the keys are {", ".join(known)}')
    if error.validator == 'required':
        missing = next(key for key in error.validator_value if key not in error.instance)
        raise BadInput(where, f'the key {missing!r} is missing',
                       f'needed: {", ".join(error.validator_value)}')
    raise BadInput(where, f'got {yaml_text.brief(error.instance)}', _remedy(error))


def _fits(value: Any, schema: Schema) -> bool:
    """Return whether a value satisfies a schema, and its numbers are within LARGEST.

    Loops over scenes change a number at a time. Mappings, lists and numbers are looked at here,
    since the validator takes 0.1 ms for a scene; of what it is asked the answers are kept.
    """
    kind, words, of = schema.get('type'), schema.keys(), value.__class__
    if kind == 'number' and (of is float or of is int) and words <= OF_NUMBERS:
        return (-LARGEST <= value <= LARGEST
                and schema.get('minimum', value) <= value <= schema.get('maximum', value)
                and value > schema.get('exclusiveMinimum', -math.inf))
    if kind == 'array' and of is list and words <= OF_LISTS:
        entries = schema.get('items', {})
        return (schema.get('minItems', 0) <= len(value) <= schema.get('maxItems', math.inf)
                and all(map(_fits, value, itertools.repeat(entries))))
    if kind == 'object' and of is dict and words <= OF_MAPPINGS:
        known, others = schema.get('properties', {}), schema.get('additionalProperties', True)
        for key in schema.get('required', ()):
            if key not in value:
                return False
        for key, entry in value.items():
            allowed = known.get(key, others)
            if allowed is False or not _fits(entry, {} if allowed is True else allowed):
                return False
        return True
    return _bounded(value) and (not schema or _satisfies(_Entry(value, schema)))


def _bounded(value: Any) -> bool:
    """Return whether all numbers of a value are within LARGEST."""
    if isinstance(value, dict):
        return all(map(_bounded, value.values()))
    if isinstance(value, list):
        return all(map(_bounded, value))
    return not isinstance(value, int | float) or -LARGEST <= value <= LARGEST


class _Entry(yaml_text.Written):
    """A value and its schema as the key of a cache: the same text, and the same schema object."""

    __slots__ = 'schema',
    __hash__ = yaml_text.Written.__hash__

    def __init__(self, value: Any, schema: Schema) -> None:
        super().__init__(value)
        self.schema = schema

    def __eq__(self, other: object) -> bool:
        return (isinstance(other, _Entry) and self.schema is other.schema
                and super().__eq__(other))


@functools.lru_cache(maxsize=KEPT)
def _satisfies(entry: _Entry) -> bool:
    return jsonschema.Draft202012Validator(entry.schema).is_valid(entry.value)


def _last(error: Any) -> bool:
    """Return whether a fault is reported after the other ones of its place.

    A misspelt key is unknown, and the right one is missing: the first says more.
    """
    return error.validator != 'additionalProperties'


def _remedy(error: Any) -> str:
    """Return what would be right."""
    limit = error.validator_value
    match error.validator:
        case 'type':
            return f'the type is {limit if isinstance(limit, str) else " or ".join(limit)}'
        case 'exclusiveMinimum':
            return f'needs a number above {limit}'
        case 'minimum':
            return f'needs a number of at least {limit}'
        case 'exclusiveMaximum':
            return f'needs a number below {limit}'
        case 'maximum':
            return f'needs a number of at most {limit}'
        case 'minItems':
            return f'needs at least {limit} entries'
        case 'maxItems':
            return f'takes at most {limit} entries'
        case 'enum':
            return f'one of {", ".join(map(str, limit))}'
        case 'not':
            return 'needs a number that is not 0'
        case 'pattern':
            return 'a name is letters, digits and underscores, at most 64, a letter first'
        case 'minProperties':
            return f'needs one of {", ".join(sorted(error.schema.get("properties", {})))}'
        case 'maxProperties':
            return 'takes only one key'
    return ' '.join(error.message.split())[:200]


def at(where: str, *keys: object) -> str:
    """Return the place of a key: `file: key.path`."""
    path = '.'.join(map(str, keys))
    return where if not path else f'{where}.{path}' if ': ' in where else f'{where}: {path}'


def _refuse_non_finite(value: Any, where: str, *path: object) -> None:
    if isinstance(value, dict):
        for key, entry in value.items():
            _refuse_non_finite(entry, where, *path, key)
        return
    if isinstance(value, list):
        for place, entry in enumerate(value):
            _refuse_non_finite(entry, where, *path, place)
        return
    if _bounded(value):    # nan is not
        return
    where = at(where, *path)
    if isinstance(value, float) and not math.isfinite(value):
        if value > 0.0 and where.endswith(INFINITE):
            return
        raise BadInput(where, f'got {value!r}', 'needs a finite number')
    raise BadInput(where, f'got {yaml_text.brief(value)}',
                   f'needs a number from {-LARGEST:g} to {LARGEST:g}, whose products fit a double')
