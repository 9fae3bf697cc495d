# SPDX-License-Identifier: Apache-2.0
"""Every set of keys that the schema of an effect allows is read, or refused in one line."""

import itertools
import json
import random

import pytest
from hard_cases.random_scenes import in_one_line

from rigid_body_sim.errors import BadInput
from rigid_body_sim.scene.effects import EFFECTS
from rigid_body_sim.scene.scene import parse_scene

NUMBERS = 0.0, 1.0, 1.0, 0.3, 2.5, -0.2, 1e-9, 1e40, 7e74
TEXTS = 'k*t', 'qx', 'x', 'angle', 'rate', 'wx', '1/t', 'log(-k)', 'abs(wx)', 'vx^0.5'
HELD = {'FREE': ('free', {'inertia': [1.0, 2.0, 2.5]}),
        'POINT': ('pivot', {'inertia': [1.0, 2.0, 2.5], 'center_of_mass': [0.0, 0.0, 0.1]}),
        'AXIS': ({'hinge': {'axis': [1, 0, 0]}},
                 {'inertia': [1.0, 2.0, 2.5], 'center_of_mass': [0.0, 0.3, 0.1]}),
        'TABLE': ('table', {'shape': {'solid_sphere': {'radius': 0.3}}}),
        'PLANE': ({'table': {}}, {'shape': {'disk': {'radius': 0.3}}})}
BESIDE = {'TABLE': {'sliding_friction': {'mu': 0.2, 'g': 9.8}},
          'PLANE': {'gravity': {'g': 9.8}, 'sliding_friction': {'mu': 0.2}}}
LEAST = 16      # draws of an effect


def drawn(schema, chance):
    """Return a random value that a schema allows, of words not the default."""
    if 'enum' in schema:
        return chance.choice([word for word in schema['enum'] if word != schema.get('default')])
    for either in ('oneOf', 'anyOf'):
        if either in schema:
            return drawn(chance.choice(schema[either]), chance)
    if schema.get('type') == 'object':
        return {key: drawn(one, chance) for key, one in schema['properties'].items()
                if key in schema['required'] or chance.random() < 0.4}
    if schema.get('type') == 'array':
        most = schema.get('maxItems', schema['minItems'] + 2)
        return [drawn(schema['items'], chance)
                for _ in range(chance.randint(schema['minItems'], most))]
    if schema.get('type') == 'number':
        number = chance.choice(NUMBERS)
        return number if {'minimum', 'exclusiveMinimum'}.isdisjoint(schema) else abs(number)
    return chance.choice(NUMBERS + TEXTS)    # an expression


def key_sets(schema):
    """Yield the required keys with every set of the others."""
    others = [key for key in schema['properties'] if key not in schema['required']]
    for count in range(len(others) + 1):
        for some in itertools.combinations(others, count):
            yield *schema['required'], *some


@pytest.mark.parametrize('name', EFFECTS)
def test_every_set_of_keys_is_read_or_refused_in_one_line(name):
    schema, read, chance = EFFECTS[name].SCHEMA, 0, random.Random(name)
    sets = list(key_sets(schema))
    for keys in itertools.islice(itertools.cycle(sets), max(LEAST, len(sets))):
        mechanism = chance.choice([one.name for one in EFFECTS[name].mechanisms])
        constraint, body = HELD[mechanism]
        settings = BESIDE.get(mechanism, {}) | {
            name: {key: drawn(schema['properties'][key], chance) for key in keys}}
        text = json.dumps({
            'scene': 's', 'parameters': {'k': chance.choice(NUMBERS)}, 'initial': {},
            'body': body | {'mass': 1.0}, 'constraint': constraint,
            'effects': [{key: value} for key, value in settings.items()]})
        try:
            parse_scene(text)
            read += 1
        except BadInput as refusal:
            in_one_line(refusal)
    assert read > 0
