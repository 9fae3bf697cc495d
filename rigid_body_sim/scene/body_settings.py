# SPDX-License-Identifier: Apache-2.0
"""The settings `body` of a scene file: their schema, and the body that they describe.

A body is given by its tensor, by a shape, or by parts.
"""

import dataclasses
import functools

from rigid_body_sim.errors import BadInput
from rigid_body_sim.scene import bodies, composites, shapes
from rigid_body_sim.scene.initial import unit_quaternion
from rigid_body_sim.scene.schema import MATRIX, POSITIVE, QUATERNION, VECTOR, check, mapping_of
from rigid_body_sim.scene.surfaces import SURFACE, surface_of, surface_of_shape
from rigid_body_sim.scene.yaml_text import Written

KEPT = 64    # bodies


def _lengths(*names):
    return mapping_of(names, **dict.fromkeys(names, POSITIVE))


SHAPE = mapping_of(
    rod=_lengths('length'), lamina=_lengths('width', 'height'), hoop=_lengths('radius'),
    disk=_lengths('radius'), spherical_shell=_lengths('radius'), solid_sphere=_lengths('radius'),
    box=mapping_of(['size'], size={**VECTOR, 'items': POSITIVE}),
    cylinder=_lengths('radius', 'length'), cone=_lengths('radius', 'height'),
    ellipsoid=mapping_of(['semi_axes'], semi_axes={**VECTOR, 'items': POSITIVE}),
    torus=_lengths('radius', 'tube'))
SHAPE |= {'minProperties': 1, 'maxProperties': 1}
NOT_ZERO = {'type': 'number', 'not': {'const': 0}}
PART = mapping_of(mass=NOT_ZERO, density=NOT_ZERO, shape=SHAPE, inertia={'type': 'array'},
                  point=VECTOR, at=VECTOR, orientation=QUATERNION)
BODY = mapping_of(
    mass=POSITIVE, density=POSITIVE, inertia={'type': 'array'},
    inertia_about={'enum': ['center_of_mass', 'origin']}, center_of_mass=VECTOR, shape=SHAPE,
    radius=POSITIVE, surface=SURFACE,
    parts={'type': 'array', 'items': PART, 'minItems': 1, 'maxItems': 1000})


def body_of(mapping, where):
    """Return the Body of the settings `body` of a scene file, which satisfy BODY.

    Raises
    ------
    BadInput
        For what the schema cannot say. `where` is file and key path.
    """
    return _body(Written(mapping), where)


@functools.lru_cache(maxsize=KEPT)
def _body(written, where):
    """Return the Body of settings; loops over effects and starts have the same one each time."""
    mapping = written.value
    body = _inert_body(mapping, where)
    if 'surface' in mapping:
        return dataclasses.replace(body, surface=surface_of(mapping['surface'],
                                                            f'{where}.surface'))
    if 'shape' in mapping and body.radius is None:
        (name, dimensions), = mapping['shape'].items()
        surface = surface_of_shape(name, dimensions, body.center_of_mass, f'{where}.shape')
        return dataclasses.replace(body, surface=surface)
    return body


def _inert_body(mapping, where):
    """Return the body without its surface."""
    way = _one_of(mapping, ('inertia', 'shape', 'parts'), where)
    if way == 'parts':
        surplus = [key for key in mapping if key not in ('parts', 'surface')]
        if surplus:
            raise BadInput(f'{where}.{surplus[0]}', 'is given together with parts',
                           'a composite takes mass and centre of mass from its parts')
        return composites.composite([_part(part, f'{where}.parts.{place}')
                                 for place, part in enumerate(mapping['parts'])], where)
    M = _mass(mapping, where)
    center = [float(x) for x in mapping.get('center_of_mass', (0.0, 0.0, 0.0))]
    if way == 'shape':
        for key in ('inertia_about', 'radius'):
            if key in mapping:
                raise BadInput(f'{where}.{key}', 'is given together with shape',
                               'the shape already says it')
        (name, dimensions), = mapping['shape'].items()
        return bodies.of_shape(name, M, dimensions, center, where)
    body = bodies.make_body(M, _tensor(mapping['inertia'], where), center,
                            mapping.get('inertia_about', 'center_of_mass'),
                            mapping.get('radius'), where)
    moments = body.about_center.moments
    if body.radius is not None and len(set(moments)) != 1:
        raise BadInput(f'{where}.radius', f'got {body.radius!r} with moments {list(moments)}',
                       'only a sphere has a radius here: three equal moments')
    return body


def _one_of(mapping, ways, where):
    """Return the only key of those that is given."""
    given = [way for way in ways if way in mapping]
    if len(given) != 1:
        raise BadInput(where, f'got {", ".join(given) or "none of them"}',
                       f'give exactly one of {", ".join(ways)}')
    return given[0]


def _mass(mapping, where):
    """Return the mass (kg) of a body or a part, given as such or as the density of its shape."""
    if 'mass' not in mapping and 'density' not in mapping:
        raise BadInput(where, "the key 'mass' is missing", 'a mass in kg')
    if 'density' not in mapping:
        return float(mapping['mass'])
    if 'mass' in mapping:
        raise BadInput(f'{where}.density', 'is given together with mass', 'give one of them')
    if 'shape' not in mapping:
        raise BadInput(f'{where}.density', 'is given without a shape',
                       'a density needs the volume of a shape: give mass')
    (name, dimensions), = mapping['shape'].items()
    return float(mapping['density']) * shapes.EXTENTS[name](**dimensions)


def _tensor(inertia, where):
    """Return the entry `inertia`, three moments or a matrix, checked."""
    schema = MATRIX if inertia and isinstance(inertia[0], list) else VECTOR
    check(inertia, schema, f'{where}.inertia')
    return inertia


def _part(mapping, where):
    """Return a part of a body: its Body, place and orientation. A negative mass is a hole."""
    way = _one_of(mapping, ('shape', 'inertia', 'point'), where)
    M = _mass(mapping, where)
    if way == 'shape':
        (name, dimensions), = mapping['shape'].items()
        part = bodies.of_shape(name, abs(M), dimensions, where=where)
    elif way == 'inertia':
        part = bodies.make_body(abs(M), _tensor(mapping['inertia'], where), where=where)
    else:
        for key in ('at', 'orientation'):
            if key in mapping:
                raise BadInput(f'{where}.{key}', 'is given together with point',
                               'point: [x, y, z] says where it is')
        nothing = bodies.Inertia((0.0, 0.0, 0.0))
        part = bodies.Body(abs(M), (0.0, 0.0, 0.0), nothing, nothing)
        return composites.hole(part) if M < 0.0 else part, mapping['point'], bodies.IDENTITY
    turn = unit_quaternion(mapping.get('orientation', bodies.IDENTITY), f'{where}.orientation')
    at = mapping.get('at', (0.0, 0.0, 0.0))
    return composites.hole(part) if M < 0.0 else part, at, turn
