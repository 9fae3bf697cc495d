# SPDX-License-Identifier: Apache-2.0
"""An expression of a scene file with the parameters that it may use."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from rigid_body_sim.errors import BadInput
from rigid_body_sim.scene.expressions import reader, tree
from rigid_body_sim.scene.expressions.source import STATE_NAMES
from rigid_body_sim.scene.schema import Schema

EXPRESSION: Schema = {'type': ['number', 'string'], 'expression': True}
EXPRESSIONS: Schema = {'type': 'array', 'items': EXPRESSION, 'minItems': 3, 'maxItems': 3}
"""Schemas of an expression and of a vector of them; the keyword `expression` marks them."""
PARAMETERS: Schema = {'type': 'object', 'additionalProperties': {'type': 'number'},
                      'maxProperties': 100}
NAME = re.compile(r'[A-Za-z][A-Za-z0-9_]{0,31}')


@dataclass(frozen=True)
class Expression:
    """An expression as it stands in a scene file.

    Attributes
    ----------
    text : str or float
    parameters : tuple of (str, float)
        Those of the scene.
    """

    text: str | float
    parameters: tuple[tuple[str, float], ...]

    def tree(self, where: str, names: Sequence[str] = STATE_NAMES) -> tree.Term:
        """Return its tree, which may use these names of the state.

        Raises
        ------
        BadInput
            One line.
        """
        return reader.read(self.text, {*names, *dict(self.parameters)}, where)


def is_constant(value: Any) -> bool:
    """Return whether a setting contains no expression that is a text."""
    if isinstance(value, Expression):
        return not isinstance(value.text, str)
    if isinstance(value, list):
        return all(map(is_constant, value))
    return True


def checked_parameters(mapping: Mapping[str, float],
                       where: str) -> tuple[tuple[str, float], ...]:
    """Return the parameters of a scene; BadInput if a name cannot be one."""
    for name in mapping:
        if not NAME.fullmatch(str(name)):
            raise BadInput(f'{where}.{name}', f'got the name {str(name)[:40]!r}',
                           'a name is letters, digits and underscores, at most 32, a letter first')
        if name in STATE_NAMES or name in tree.FUNCTIONS:
            raise BadInput(f'{where}.{name}', f'{name} means something else in expressions',
                           f'another name than {", ".join((*STATE_NAMES, *tree.FUNCTIONS))}')
    return tuple((name, float(value)) for name, value in mapping.items())


def with_expressions(value: Any, schema: Schema,
                     parameters: tuple[tuple[str, float], ...]) -> Any:
    """Return settings in which what the schema marks as an expression is an Expression."""
    if schema.get('expression'):
        return Expression(value, parameters)
    if isinstance(value, list) and 'items' in schema:
        return [with_expressions(entry, schema['items'], parameters) for entry in value]
    if isinstance(value, dict):
        known = schema.get('properties', {})
        return {key: with_expressions(entry, known.get(key, {}), parameters)
                for key, entry in value.items()}
    return value
