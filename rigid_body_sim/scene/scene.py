# SPDX-License-Identifier: Apache-2.0
"""Scenes: a YAML file -> a validated Scene (docs/scenes.md shows how to write one).

A scene names a body, what holds it (constraint), what else acts (effects) and how it starts (initial). Everything is checked here, before
anything runs, and refused with the file, the key path, the value and what would be right.
"""

import difflib
import math
import pathlib
import sys
from dataclasses import dataclass

import jsonschema
import yaml

from rigid_body_sim.errors import BadInput
from rigid_body_sim.numerics import rotations
from rigid_body_sim.numerics.functions import hypot3
from rigid_body_sim.numerics.vectors import across, cross, minus, plus, scaled
from rigid_body_sim.scene import bodies, yaml_text
from rigid_body_sim.scene.effects import EFFECTS
from rigid_body_sim.scene.state import State

NUMBER = {'type': 'number'}
POSITIVE = {'type': 'number', 'exclusiveMinimum': 0}
VECTOR = {'type': 'array', 'items': NUMBER, 'minItems': 3, 'maxItems': 3}
QUATERNION = {'type': 'array', 'items': NUMBER, 'minItems': 4, 'maxItems': 4}
MATRIX = {'type': 'array', 'items': VECTOR, 'minItems': 3, 'maxItems': 3}
CONSTRAINTS = ('free', 'pivot', 'hinge', 'table')


def _mapping(required=(), **properties):
    return {'type': 'object', 'properties': properties, 'required': list(required), 'additionalProperties': False}


def _lengths(*names):
    return _mapping(names, **dict.fromkeys(names, POSITIVE))


SHAPE = _mapping(
    rod=_lengths('length'), lamina=_lengths('width', 'height'), hoop=_lengths('radius'), disk=_lengths('radius'),
    spherical_shell=_lengths('radius'), solid_sphere=_lengths('radius'),
    box=_mapping(['size'], size={**VECTOR, 'items': POSITIVE}), cylinder=_lengths('radius', 'length'), cone=_lengths('radius', 'height'),
    ellipsoid=_mapping(['semi_axes'], semi_axes={**VECTOR, 'items': POSITIVE}), torus=_lengths('radius', 'tube'))
SHAPE |= {'minProperties': 1, 'maxProperties': 1}
PART = _mapping(['mass', 'shape'], mass=POSITIVE, shape=SHAPE, at=VECTOR, orientation=QUATERNION)
BODY = _mapping(
    mass=POSITIVE, inertia={'type': 'array'}, inertia_about={'enum': ['center_of_mass', 'origin']}, center_of_mass=VECTOR, shape=SHAPE,
    radius=POSITIVE, parts={'type': 'array', 'items': PART, 'minItems': 1, 'maxItems': 1000})
INITIAL = _mapping(
    orientation=QUATERNION, euler_zyz=VECTOR, tilt=NUMBER, spin=NUMBER, angle=NUMBER, rate=NUMBER, angular_velocity=VECTOR, position=VECTOR,
    velocity=VECTOR)
SCENE = _mapping(
    ['scene', 'body', 'constraint', 'effects', 'initial'], scene={'type': 'string', 'pattern': r'^[A-Za-z][A-Za-z0-9_]{0,63}$'},
    about={'type': 'string'}, body=BODY, constraint={'type': ['string', 'object']}, effects={'type': 'array', 'maxItems': 32}, initial=INITIAL,
    commands={'enum': ['accept', 'refuse']})
HINGE = _mapping(['axis'], axis=VECTOR, through=VECTOR, distance=NUMBER)


@dataclass(frozen=True)
class Constraint:
    """What holds the body: free | pivot (body origin fixed) | hinge (axis through a point, both in body axes) | table (sphere on a plane)."""

    kind: str
    axis: tuple = (0.0, 0.0, 1.0)
    through: tuple = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Scene:
    """A validated scene.

    Attributes
    ----------
    name, about : str
    body : bodies.Body
    constraint : Constraint
    effects : tuple
        One object per effect, of the classes in rigid_body_sim/effects.
    initial : State
        At time 0.
    accepts_commands : bool
    text : str
        YAML of the scene as it runs, overrides included: enough to make it again.
    """

    name: str
    about: str
    body: bodies.Body
    constraint: Constraint
    effects: tuple
    initial: State
    accepts_commands: bool
    text: str

    @property
    def notes(self):
        """What is allowed but hardly meant, a list of lines."""
        held = {'pivot': 'pivot', 'hinge': 'hinge'}.get(self.constraint.kind)
        if not held or self.effect('gravity') is None:
            return []
        arm = minus(self.body.center_of_mass, self.constraint.through)
        arm = across(self.constraint.axis, arm) if held == 'hinge' else arm
        return [] if any(arm) else [f'the {held} holds the body at its centre of mass: gravity does nothing there']

    def effect(self, name):
        """Return the effect of that name, or None if the scene does not list it."""
        return next((effect for effect in self.effects if effect.name == name), None)


def scene_folder():
    """Return the folder of the scenes that ship: config/scenes of the source tree, or of the installed package's share folder."""
    beside = pathlib.Path(__file__).resolve().parents[2] / 'config' / 'scenes'
    if beside.is_dir():
        return beside
    for parent in pathlib.Path(__file__).resolve().parents:
        installed = parent / 'share' / 'rigid_body_sim' / 'config' / 'scenes'
        if installed.is_dir():
            return installed
    raise BadInput('scenes', 'the folder config/scenes is not installed', 'install the package with its data files')


def scene_names():
    """Return the names of the scenes that ship, sorted."""
    return sorted(path.stem for path in scene_folder().glob('*.yaml'))


def load_scene(name_or_path, overrides=()):
    """Return the validated scene of a file (``.yaml``) or of a name that ships.

    Parameters
    ----------
    name_or_path : str or path
    overrides : mapping of str to value, or sequence of str
        ``{'key.path': value}`` or ``key.path=value``, see :func:`yaml_text.override`.

    Raises
    ------
    BadInput
        One line: file, key path, value, what would be right.
    """
    text = str(name_or_path)
    path = pathlib.Path(text)
    if path.suffix not in ('.yaml', '.yml') and '/' not in text:
        path = scene_folder() / f'{text}.yaml'
        if not path.is_file():
            near = difflib.get_close_matches(text, scene_names(), 1)
            hint = f'did you mean {near[0]}?' if near else f'the scenes are {", ".join(scene_names())}'
            raise BadInput('scene', f'no scene {text!r}', f'{hint} (or give the path of a .yaml file)')
    try:
        content = path.read_text(encoding='utf-8')
    except (OSError, ValueError) as error:
        raise BadInput('scene', f'cannot read {text!r}: {getattr(error, "strerror", None) or "not UTF-8 text"}',
                       'give a name that `scenes` lists, or the path of a readable .yaml file') from None
    return parse_scene(content, overrides, path.name)


def parse_scene(text, overrides=(), where='scene'):
    """Return the validated scene of a YAML text; `where` names it in error lines."""
    mapping = yaml_text.parse(text, where)
    overrides = yaml_text.assignments(overrides)
    for assignment in overrides:
        yaml_text.override(mapping, assignment, where)
    try:
        return _scene(mapping, where)
    except BadInput as error:
        # what an override set stands in no line, nor need a fault be where it shows
        raise error if overrides else _with_line(error, text, where) from None


def _with_line(error, text, where):
    """Return an error of a key path with the line of the text in which the key stands."""
    path = error.where.removeprefix(f'{where}: ')
    line = yaml_text.line_of(text, path.split('.')) if path != error.where else None
    return error if line is None else \
        BadInput(f'{where}, line {line}: {path}', error.problem, error.remedy)


def _scene(mapping, where):
    """Return the validated scene of a mapping."""
    _check(mapping, SCENE, where)
    body = _body(mapping['body'], f'{where}: body')
    constraint = _constraint(mapping['constraint'], body, f'{where}: constraint')
    effects = tuple(_effects(mapping['effects'], body, constraint, f'{where}: effects'))
    initial = _initial(mapping['initial'], body, constraint, f'{where}: initial')
    return Scene(mapping['scene'], ' '.join(mapping.get('about', '').split()), body, constraint, effects, initial,
                 mapping.get('commands', 'accept') == 'accept', yaml.safe_dump(mapping, sort_keys=False, allow_unicode=True))


def _check(value, schema, where):
    """Validate against a JSON schema and refuse the first fault in one line; every number must be finite."""
    _refuse_non_finite(value, where)
    errors = sorted(jsonschema.Draft202012Validator(schema).iter_errors(value), key=lambda error: (len(error.absolute_path), str(error.path)))
    if not errors:
        return
    error = errors[0]
    where = _at(where, *error.absolute_path)
    found = yaml_text.brief(error.instance)
    if error.validator == 'additionalProperties':
        known = sorted(error.schema['properties'])
        unknown = next(key for key in error.instance if key not in known)
        near = difflib.get_close_matches(unknown, known, 1)
        raise BadInput(where, f'unknown key {unknown!r}', f'did you mean {near[0]!r}?' if near else f'the keys are {", ".join(known)}')
    if error.validator == 'required':
        missing = next(key for key in error.validator_value if key not in error.instance)
        raise BadInput(where, f'the key {missing!r} is missing', f'needed: {", ".join(error.validator_value)}')
    remedies = {
        'type': lambda: f'the type is {error.validator_value}' if isinstance(error.validator_value, str) else
        f'the type is {" or ".join(error.validator_value)}',
        'exclusiveMinimum': lambda: f'needs a number above {error.validator_value}',
        'minimum': lambda: f'needs a number of at least {error.validator_value}',
        'exclusiveMaximum': lambda: f'needs a number below {error.validator_value}',
        'maximum': lambda: f'needs a number of at most {error.validator_value}',
        'minItems': lambda: f'needs at least {error.validator_value} entries',
        'maxItems': lambda: f'takes at most {error.validator_value} entries',
        'enum': lambda: f'one of {", ".join(map(str, error.validator_value))}',
        'pattern': lambda: 'a name is letters, digits and underscores, at most 64, a letter first',
        'minProperties': lambda: f'needs one of {", ".join(sorted(error.schema.get("properties", {})))}',
        'maxProperties': lambda: 'takes only one key'}
    remedy = remedies.get(error.validator, lambda: ' '.join(error.message.split())[:200])()
    raise BadInput(where, f'got {found}', remedy)


def _at(where, *keys):
    """Return the place of a key: `file: key.path`."""
    path = '.'.join(map(str, keys))
    return where if not path else f'{where}.{path}' if ': ' in where else f'{where}: {path}'


def _refuse_non_finite(value, where):
    if isinstance(value, dict):
        for key, entry in value.items():
            _refuse_non_finite(entry, _at(where, key))
    elif isinstance(value, list):
        for place, entry in enumerate(value):
            _refuse_non_finite(entry, _at(where, place))
    elif isinstance(value, float) and not math.isfinite(value):
        raise BadInput(where, f'got {value!r}', 'needs a finite number')
    elif isinstance(value, int) and not isinstance(value, bool) and abs(value) > 1e300:
        raise BadInput(where, f'got {yaml_text.brief(value)}', 'needs a number that a double can hold')


def _body(mapping, where):
    ways = [way for way in ('inertia', 'shape', 'parts') if way in mapping]
    if len(ways) != 1:
        raise BadInput(where, f'got {", ".join(ways) or "none of them"}', 'give exactly one of inertia, shape, parts')
    way = ways[0]
    if way == 'parts':
        surplus = [key for key in mapping if key != 'parts']
        if surplus:
            raise BadInput(f'{where}.{surplus[0]}', 'stands beside parts', 'a composite takes mass and centre of mass from its parts')
        return bodies.composite([_part(part, f'{where}.parts.{place}') for place, part in enumerate(mapping['parts'])])
    if 'mass' not in mapping:
        raise BadInput(where, "the key 'mass' is missing", 'a mass in kg')
    M, center = float(mapping['mass']), [float(x) for x in mapping.get('center_of_mass', (0.0, 0.0, 0.0))]
    if way == 'shape':
        for key in ('inertia_about', 'radius'):
            if key in mapping:
                raise BadInput(f'{where}.{key}', 'stands beside shape', 'the shape already says it')
        (name, dimensions), = mapping['shape'].items()
        return bodies.of_shape(name, M, dimensions, center, where)
    inertia = mapping['inertia']
    schema = MATRIX if inertia and isinstance(inertia[0], list) else VECTOR
    _check(inertia, schema, f'{where}.inertia')
    body = bodies.make_body(M, inertia, center, mapping.get('inertia_about', 'center_of_mass'), mapping.get('radius'), where)
    if body.radius is not None and len(set(body.about_center.moments)) != 1:
        raise BadInput(f'{where}.radius', f'got {body.radius!r} with moments {list(body.about_center.moments)}',
                       'only a sphere has a radius here: three equal moments')
    return body


def _part(mapping, where):
    (name, dimensions), = mapping['shape'].items()
    part = bodies.of_shape(name, float(mapping['mass']), dimensions, where=where)
    return part, mapping.get('at', (0.0, 0.0, 0.0)), _unit_quaternion(mapping.get('orientation', bodies.IDENTITY), f'{where}.orientation')


def _constraint(value, body, where):
    kind, settings = (value, {}) if isinstance(value, str) else next(iter(value.items())) if len(value) == 1 else (None, None)
    if kind not in CONSTRAINTS:
        raise BadInput(where, f'got {yaml_text.brief(value)}', 'one of free, pivot, table, or hinge: {axis: [x, y, z], through: [x, y, z]}')
    if kind == 'table' and body.radius is None:
        raise BadInput(where, 'a table needs a sphere', 'give body.shape solid_sphere or spherical_shell, or body.radius with equal moments')
    if kind == 'table' and any(body.center_of_mass):
        raise BadInput(where, f'the centre of mass {list(body.center_of_mass)} is off the middle', 'a ball on a table is balanced')
    if kind != 'hinge':
        if settings:
            raise BadInput(where, f'{kind} takes no settings, got {yaml_text.brief(settings)}', f'write constraint: {kind}')
        return Constraint(kind)
    if not isinstance(settings, dict):
        raise BadInput(where, f'got {yaml_text.brief(settings)}', 'hinge: {axis: [x, y, z], through: [x, y, z]}')
    _check(settings, HINGE, f'{where}.hinge')
    axis = tuple(float(x) for x in settings['axis'])
    length = hypot3(*axis)
    if not length > 0.0 or not math.isfinite(length):
        raise BadInput(f'{where}.hinge.axis', f'got {settings["axis"]}', 'a direction: three numbers, not all zero')
    axis = tuple(x / length for x in axis)
    through = (_suspension(settings, axis, body, f'{where}.hinge') if 'distance' in settings
               else tuple(float(x) for x in settings.get('through', (0.0, 0.0, 0.0))))
    bodies.refuse_beyond(body.mass * bodies.square_of(through), f'{where}.hinge')
    return Constraint('hinge', axis, through)


def _suspension(settings, axis, body, where):
    """Return the point (body axes, m) at a distance from the centre of mass along body axis z, made square to the hinge's axis."""
    distance, upward = float(settings['distance']), across(axis, (0.0, 0.0, 1.0))
    if 'through' in settings:
        raise BadInput(f'{where}.distance', 'stands beside through', 'give one of them')
    if distance == 0.0:
        raise BadInput(f'{where}.distance', f'got {settings["distance"]!r}', 'hung at its centre of mass a body does not swing: a distance '
                       'above 0, or below 0 on the other side, in m')
    length = hypot3(*upward)
    if not length > 1e-8:
        raise BadInput(f'{where}.distance', f'got an axis {list(axis)} along z', 'distance is measured along body axis z: give through')
    return plus(body.center_of_mass, scaled(distance / length, upward))


def _effects(entries, body, constraint, where):
    seen = set()
    for place, entry in enumerate(entries):
        name, settings = (entry, {}) if isinstance(entry, str) else next(iter(entry.items())) if isinstance(entry, dict) and len(entry) == 1 \
            else (None, None)
        if name not in EFFECTS:
            near = difflib.get_close_matches(str(name), EFFECTS, 1)
            hint = f'did you mean {near[0]!r}?' if near else f'the effects are {", ".join(EFFECTS)}'
            raise BadInput(f'{where}.{place}', f'got {yaml_text.brief(entry)}', f'{hint} (one effect an entry)')
        effect, at = EFFECTS[name], f'{where}.{name}'
        if name in seen and not getattr(effect, 'repeatable', False):
            raise BadInput(at, 'stands twice', 'list it once')
        seen.add(name)
        if constraint.kind not in effect.constraints:
            raise BadInput(at, f'cannot act on constraint {constraint.kind!r}', f'it can on {", ".join(effect.constraints)}')
        settings = {} if settings is None else settings
        _check(settings, effect.SCHEMA, at)
        yield effect.from_scene(settings, body, constraint, at)


def _unit_quaternion(values, where):
    values = [float(value) for value in values]
    size = max(abs(value) for value in values)
    if not size > 0.0:
        raise BadInput(where, f'got {values}', 'a quaternion (x, y, z, w) of non-zero norm')
    x, y, z, w = (value / size for value in values) if not 1e-100 < size < 1e100 else values
    square = x * x + y * y + z * z + w * w
    if abs(square - 1.0) <= 2.0 * sys.float_info.epsilon:
        return x, y, z, w
    norm = math.sqrt(square)
    return x / norm, y / norm, z / norm, w / norm


def _initial(mapping, body, constraint, where):
    allowed = {'free': ('orientation', 'euler_zyz', 'tilt', 'spin', 'angular_velocity', 'position', 'velocity'),
               'pivot': ('orientation', 'euler_zyz', 'tilt', 'spin', 'angular_velocity', 'position'),
               'hinge': ('orientation', 'euler_zyz', 'angle', 'rate', 'position'),
               'table': ('orientation', 'euler_zyz', 'angular_velocity', 'position', 'velocity')}[constraint.kind]
    for key in mapping:
        if key not in allowed:
            raise BadInput(f'{where}.{key}', f'has no meaning on constraint {constraint.kind!r}', f'the keys there are {", ".join(allowed)}')
    orientation = _orientation(mapping, where)
    omega = tuple(float(x) for x in mapping.get('angular_velocity', (0.0, 0.0, 0.0)))
    if 'spin' in mapping:
        if 'angular_velocity' in mapping:
            raise BadInput(f'{where}.spin', 'stands beside angular_velocity', 'give one of them')
        omega = (0.0, 0.0, float(mapping['spin']))
    position = tuple(float(x) for x in mapping.get('position', (0.0, 0.0, 0.0)))
    velocity = tuple(float(x) for x in mapping.get('velocity', (0.0, 0.0, 0.0)))
    if constraint.kind == 'hinge':
        return _hinged(mapping, constraint, orientation, position, where)
    if constraint.kind == 'table':
        position = position if 'position' in mapping else (0.0, 0.0, body.radius)
        if position[2] != body.radius or velocity[2] != 0.0:
            raise BadInput(where, f'got height {position[2]!r} and vertical velocity {velocity[2]!r}',
                           f'the ball lies on the table: height {body.radius!r} (its radius), vertical velocity 0')
    inertia = body.about_origin if constraint.kind == 'pivot' else body.about_center
    _refuse_spin_without_moment(inertia, omega, where)
    return State.of(0.0, orientation, omega, position, velocity)


def _orientation(mapping, where):
    ways = [way for way in ('orientation', 'euler_zyz', 'tilt') if way in mapping]
    if len(ways) > 1:
        raise BadInput(f'{where}.{ways[1]}', f'stands beside {ways[0]}', 'give the orientation once')
    if 'euler_zyz' in mapping:
        return rotations.from_euler_zyz(*(float(x) for x in mapping['euler_zyz']))
    if 'tilt' in mapping:
        return rotations.from_euler_zyz(0.0, float(mapping['tilt']), 0.0)
    return _unit_quaternion(mapping.get('orientation', bodies.IDENTITY), f'{where}.orientation')


def _hinged(mapping, constraint, orientation, position, where):
    """Return the state at the angle and rate about the hinge; position is where the hinge point stands in the world."""
    angle, rate = float(mapping.get('angle', 0.0)), float(mapping.get('rate', 0.0))
    turn = rotations.from_rotation_vector(*(angle * component for component in constraint.axis))
    orientation = rotations.multiply(*orientation, *turn)
    omega = tuple(rate * component for component in constraint.axis)
    arm = rotations.rotate(*orientation, *constraint.through)
    velocity = cross(arm, rotations.rotate(*orientation, *omega))
    return State.of(0.0, orientation, omega, tuple(p - a for p, a in zip(position, arm, strict=True)), velocity)


def _refuse_spin_without_moment(inertia, omega, where):
    along = rotations.rotate_back(*inertia.axes, *omega) if inertia.axes != bodies.IDENTITY else omega
    for k, moment in enumerate(inertia.moments):
        if moment == 0.0 and abs(along[k]) > bodies.ULPS * max(abs(x) for x in omega):
            raise BadInput(f'{where}.angular_velocity', f'spin {along[k]!r} rad/s about principal axis {k + 1}, whose moment is zero',
                           'that component must be 0: an axis without moment carries no angular momentum')
