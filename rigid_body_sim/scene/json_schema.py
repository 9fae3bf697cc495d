# SPDX-License-Identifier: Apache-2.0
"""The JSON Schema of scene files, for editors and other programs: `scenes --schema`.

It is made from the schemas that :func:`rigid_body_sim.scene.scene.parse_scene` checks with. What
no schema can say (the triangle inequality, what a constraint allows) only parse_scene checks.
"""

import copy

from rigid_body_sim.scene.constraints import CONSTRAINTS
from rigid_body_sim.scene.effects import EFFECTS
from rigid_body_sim.scene.scene import scene_schema
from rigid_body_sim.scene.schema import MATRIX, VECTOR

NOTHING = {'type': 'null'}


def json_schema():
    """Return the schema (draft 2020-12) as plain data."""
    schema = copy.deepcopy(scene_schema())
    properties = schema['properties']
    body = properties['body']['properties']
    body['inertia'] = {'anyOf': [VECTOR, MATRIX]}
    body['parts']['items']['properties']['inertia'] = body['inertia']
    properties['constraint'] = {'anyOf': [
        {'enum': [kind for kind, one in CONSTRAINTS.items() if one.SCHEMA is None]},
        *(_one_key(kind, one.SCHEMA) for kind, word in CONSTRAINTS.items()
          for one in word.variants() if one.SCHEMA)]}
    properties['effects']['items'] = {'anyOf': [
        {'enum': [name for name, effect in EFFECTS.items() if not effect.SCHEMA.get('required')]},
        *(_one_key(name, effect.SCHEMA) for name, effect in EFFECTS.items())]}
    return {'$schema': 'https://json-schema.org/draft/2020-12/schema',
            'title': 'A scene of rigid_body_sim', **schema}


def _one_key(name, settings):
    """Return the schema of a mapping with one key; settings may be absent if none is required."""
    value = settings if settings.get('required') else {'anyOf': [settings, NOTHING]}
    return {'type': 'object', 'properties': {name: value}, 'required': [name],
            'additionalProperties': False}
