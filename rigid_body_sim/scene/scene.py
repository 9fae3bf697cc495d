# SPDX-License-Identifier: Apache-2.0
"""Read scenes: a YAML file becomes a validated Scene (docs/scenes.md shows how to write one).

A scene names a body, what holds it (constraint), what else acts (effects) and how it starts
(initial). Everything is checked here, before anything runs, and refused with the file, the key
path, the value and what would be right.
"""

import dataclasses
import functools
import math
import operator
import os
import pathlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import yaml

from rigid_body_sim.errors import BadInput, nearest, printable
from rigid_body_sim.scene import yaml_text
from rigid_body_sim.scene.bodies import Body
from rigid_body_sim.scene.body_settings import BODY, body_of
from rigid_body_sim.scene.constraints import CONSTRAINTS
from rigid_body_sim.scene.constraints.allowed import refuse_forbidden
from rigid_body_sim.scene.constraints.protocol import Constraint, Mechanism
from rigid_body_sim.scene.effects import EFFECTS, effect_class
from rigid_body_sim.scene.effects.carrying import Carrying
from rigid_body_sim.scene.effects.protocol import Contact, Effect, Vector
from rigid_body_sim.scene.expressions.expression import (
    PARAMETERS,
    checked_parameters,
    with_expressions,
)
from rigid_body_sim.scene.frame import Frame
from rigid_body_sim.scene.initial import Start
from rigid_body_sim.scene.schema import check, mapping_of
from rigid_body_sim.scene.state import State
from rigid_body_sim.scene.winding import energy_at_ends, may_reach_ends

Overrides = Mapping[str, Any] | Sequence[str]


def scene_schema():
    """Return the schema of a scene; `initial` may have the keys of every constraint."""
    return _schema_with(tuple(CONSTRAINTS.values()))


@functools.lru_cache(maxsize=1)
def _schema_with(constraints):
    initial = {key: schema for word in constraints for constraint in word.variants()
               for key, schema in constraint.INITIAL.items()}
    return mapping_of(
        ['scene', 'body', 'constraint', 'effects', 'initial'],
        scene={'type': 'string', 'pattern': r'^[A-Za-z][A-Za-z0-9_]{0,63}$'},
        about={'type': 'string'}, parameters=PARAMETERS, body=BODY,
        constraint={'type': ['string', 'object']},
        effects={'type': 'array', 'maxItems': 32}, initial=mapping_of(**initial),
        commands={'enum': ['accept', 'refuse']})


@dataclass(frozen=True)
class Scene:
    """A validated scene.

    Attributes
    ----------
    name, about : str
    body : bodies.Body
    constraint : Constraint
        An object of a class in rigid_body_sim/scene/constraints.
    effects : tuple of Effect
        One object per effect, of the classes in rigid_body_sim/scene/effects.
    initial : State
        At time 0.
    accepts_commands : bool
    mapping : dict
        The scene as it runs, overrides included, as YAML would have it.
    """

    name: str
    about: str
    body: Body
    constraint: Constraint
    effects: tuple[Effect, ...]
    initial: State
    accepts_commands: bool
    mapping: dict[str, Any] = dataclasses.field(repr=False, hash=False)

    def __getstate__(self):
        return {field.name: getattr(self, field.name) for field in dataclasses.fields(self)}

    @functools.cached_property
    def text(self) -> str:
        """YAML of the scene as it runs, overrides included: enough to make it again."""
        return yaml.safe_dump(self.mapping, sort_keys=False, allow_unicode=True)

    @functools.cached_property
    def frame(self) -> Frame:
        """The frame in which the equations of motion of the body are written."""
        return self.constraint.frame(self.body)

    @functools.cached_property
    def energy_at_ends(self) -> float:
        """The lower potential at the two ends of a hinge's angle, J: see winding.py."""
        return energy_at_ends(self)

    @functools.cached_property
    def wound(self) -> 'Scene':
        """The scene with a kink where what acts jumps at an end of a hinge's angle.

        It is the scene itself where nothing that acts jumps there.
        """
        if self.energy_at_ends == math.inf:
            return self
        return dataclasses.replace(self, constraint=self.constraint.wound())

    @property
    def notes(self) -> list[str]:
        """Warnings about settings that are legal but probably unintended, one line each."""
        return [line for effect in self.effects
                for line in effect.notes(self.body, self.constraint)]

    @functools.cached_property
    def acting(self) -> tuple[Effect, ...]:
        """The effects that do something to this body under this constraint, impulses apart.

        One that is listed may do nothing: a coefficient of zero, gravity on a body whose pivot is
        its centre of mass, one of two that cancel each other.
        """
        frame = self.frame
        acting: list[Effect] = []
        for effect in self.effects:
            if effect.contact is None and (effect.acting is None or not any(
                    effect.acting(frame, time) for time in (0.0, *effect.breakpoints))):
                continue
            opposite = effect.opposite if acting else None
            if opposite is not None and opposite in acting:
                acting.remove(opposite)
            else:
                acting.append(effect)
        return tuple(acting)

    @functools.cached_property
    def strikes(self) -> tuple[Effect, ...]:
        """The effects that act at one instant, in the order of their times."""
        struck = (effect for effect in self.effects if effect.as_impulse is not None)
        return tuple(sorted(struck, key=operator.attrgetter('time')))

    @property
    def field(self) -> Vector:
        """The acceleration of a free fall, world components, m/s^2: the sum of uniform fields."""
        x = y = z = 0.0
        for effect in self.effects:
            one = effect.uniform_field
            if one is not None:
                x, y, z = x + one[0], y + one[1], z + one[2]
        return x, y, z

    @functools.cached_property
    def weight(self) -> float | None:
        """The g of a uniform field along -z, m/s^2, if that is all that acts; else None.

        It is 0 where nothing acts.
        """
        x, y, z = self.field
        if x != 0.0 or y != 0.0 or z > 0.0:
            return None
        falls = all(effect.uniform_field is not None for effect in self.acting)
        return 0.0 - z if falls else None

    @property
    def inner_dissipation(self) -> float:
        """The sum of the effects' coefficients of inner dissipation, 1/(kg m^2/s)."""
        # sum() of floats rounds otherwise from Python 3.12 on
        return functools.reduce(
            operator.add, [effect.inner_dissipation for effect in self.effects], 0.0)

    @functools.cached_property
    def contact(self) -> Contact:
        """How body and table touch: the sums of what the effects declare."""
        total = Contact()
        for effect in self.effects:
            if effect.contact is not None:
                total = Contact(*map(operator.add, total, effect.contact))
        return total

    def acts_only(self, *classes: type[Effect]) -> bool:
        """Return whether all effects that act are of these classes."""
        return all(isinstance(effect, classes) for effect in self.acting)

    def effect(self, name: str) -> Effect | None:
        """Return the effect of that name, or None if the scene does not list it."""
        return next((effect for effect in self.effects if effect.name == name), None)


def kept(function):
    """Cache the result of a function of a scene with the scene, which never changes.

    The result must not change either.
    """
    @functools.wraps(function)
    def of(scene):
        found = scene.__dict__.setdefault('_kept', {})
        if of not in found:
            found[of] = function(scene)
        return found[of]
    return of


def scene_folder() -> pathlib.Path:
    """Return the folder of the scenes that ship.

    It is config/scenes of the source tree, or of the share folder of the installed package.
    """
    beside = pathlib.Path(__file__).resolve().parents[2] / 'config' / 'scenes'
    if beside.is_dir():
        return beside
    for parent in pathlib.Path(__file__).resolve().parents:
        installed = parent / 'share' / 'rigid_body_sim' / 'config' / 'scenes'
        if installed.is_dir():
            return installed
    raise BadInput('scenes', 'the folder config/scenes is not installed',
                   'install the package with its data files')


def scene_names() -> list[str]:
    """Return the names of the scenes that ship, sorted."""
    return sorted(path.stem for path in scene_folder().glob('*.yaml'))


def load_scene(name_or_path: str | pathlib.Path,
               overrides: Overrides = ()) -> Scene:
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
    if not isinstance(name_or_path, str | os.PathLike) or '\n' in str(name_or_path):
        raise BadInput('scene', f'got a {type(name_or_path).__name__} that is no name and no path',
                       'a name or a path; `parse_scene` takes the text of a scene')
    text = str(name_or_path)
    path = pathlib.Path(text)
    if path.suffix not in ('.yaml', '.yml') and '/' not in text:
        path = scene_folder() / f'{text}.yaml'
        if not os.path.isfile(path):    # False also for a name too long for a file
            near = nearest(text, scene_names())
            hint = f'did you mean {near}?' if near else \
                f'the scenes are {", ".join(scene_names())}'
            raise BadInput('scene', f'no scene {text!r}',
                           f'{hint} (or give the path of a .yaml file)')
    try:
        content = path.read_text(encoding='utf-8')
    except (OSError, ValueError) as error:
        problem = getattr(error, 'strerror', None) or 'not UTF-8 text'
        raise BadInput('scene', f'cannot read {text!r}: {problem}',
                       'give a name that `scenes` lists, '
                       'or the path of a readable .yaml file') from None
    return parse_scene(content, overrides, path.name)


def parse_scene(text: str, overrides: Overrides = (), where: str = 'scene') -> Scene:
    """Return the validated scene of a YAML text.

    Parameters
    ----------
    text : str
    overrides : mapping of str to value, or sequence of str
        As for :func:`load_scene`.
    where : str
        Name of the text in error lines.

    Raises
    ------
    BadInput
        One line: `where`, the line of the text, key path, value, what would be right.
    """
    mapping = yaml_text.parse(text, where)
    if overrides:
        return _overridden(mapping, overrides, where)
    try:
        return _scene(mapping, where)
    except BadInput as error:
        raise _with_line(error, text, where) from None


def changed_scene(scene: Scene, overrides: Overrides) -> Scene:
    """Return a validated scene with changes; it raises what :func:`parse_scene` raises."""
    return _overridden(yaml_text.copied(scene.mapping), overrides, scene.name)


def _overridden(mapping, overrides, where):
    """Return the validated scene of a mapping, which is changed, with overrides.

    A value that an override sets is in no line of the text, and its fault may show elsewhere.
    """
    for assignment in yaml_text.assignments(overrides):
        yaml_text.override(mapping, assignment, where)
    return _scene(mapping, where)


def _with_line(error, text, where):
    """Return an error of a key path with the line of the text in which the key stands."""
    path = error.where.removeprefix(f'{where}: ')
    line = yaml_text.line_of(text, path.split('.')) if path != error.where else None
    return error if line is None else \
        BadInput(f'{where}, line {line}: {path}', error.problem, error.remedy)


def _scene(mapping, where):
    """Return the validated scene of a mapping."""
    check(mapping, scene_schema(), where)
    body = body_of(mapping['body'], f'{where}: body')
    parameters = checked_parameters(mapping.get('parameters', {}), f'{where}: parameters')
    constraint = _constraint(mapping['constraint'], body, parameters, f'{where}: constraint')
    start = _start(mapping['initial'], body, constraint, f'{where}: initial')
    constraint = constraint.begun(start)
    effects = tuple(_effects(mapping['effects'], body, constraint, parameters,
                             f'{where}: effects'))
    if constraint.path is not None:
        effects = *effects, Carrying.of(constraint.path, body)
    _refuse_beside_turning(effects, body, constraint, f'{where}: effects')
    initial = constraint.initial(start, body, f'{where}: initial')
    refuse_forbidden(initial, constraint, start, body, f'{where}: initial')
    about = printable(' '.join(mapping.get('about', '').split()))
    scene = Scene(mapping['scene'], about, body, constraint, effects, initial,
                  mapping.get('commands', 'accept') == 'accept', mapping)
    return scene.wound if may_reach_ends(scene, initial.vector) else scene


def _constraint(value, body, parameters, where):
    kind, settings = (value, None) if isinstance(value, str) else \
        next(iter(value.items())) if len(value) == 1 else (None, None)
    if kind not in CONSTRAINTS:
        every = sorted(CONSTRAINTS.values(), key=lambda one: one.SCHEMA is not None)
        *others, last = (one.usage for one in every)
        raise BadInput(where, f'got {yaml_text.brief(value)}',
                       f'one of {", ".join(others)}, or {last}')
    constraint = CONSTRAINTS[kind].variant(body, settings)
    if constraint.SCHEMA is None:
        if settings:
            raise BadInput(where, f'{kind} takes no settings, got {yaml_text.brief(settings)}',
                           f'write constraint: {constraint.usage}')
        return constraint.from_scene({}, body, where)
    if settings is None:
        settings = {}
    if not isinstance(settings, dict):
        raise BadInput(where, f'got {yaml_text.brief(settings)}', constraint.usage)
    check(settings, constraint.SCHEMA, f'{where}.{kind}')
    settings = with_expressions(settings, constraint.SCHEMA, parameters)
    return constraint.from_scene(settings, body, f'{where}.{kind}')


def _effects(entries, body, constraint, parameters, where):
    seen = set()
    for place, entry in enumerate(entries):
        name, settings = _named(entry)
        effect, at = effect_class(name), f'{where}.{name}'
        if effect is None:
            near = nearest(name, EFFECTS)
            hint = f'did you mean {near!r}?' if near else \
                f'the effects are {", ".join(EFFECTS)}'
            raise BadInput(f'{where}.{place}', f'got {yaml_text.brief(entry)}',
                           f'{hint} (one effect per entry)')
        if name in seen and not effect.repeatable:
            raise BadInput(at, 'is listed twice', 'list it once')
        seen.add(name)
        if constraint.mechanism not in effect.mechanisms:
            able = [kind for kind, one in CONSTRAINTS.items()
                    if one.mechanism in effect.mechanisms]
            if Mechanism.PLANE in effect.mechanisms:
                able.append('table with a body that has a surface')
            raise BadInput(at, f'cannot act on constraint {constraint.kind!r}',
                           f'it can on {", ".join(able)}')
        check(settings, effect.SCHEMA, at)
        settings = with_expressions(settings, effect.SCHEMA, parameters)
        yield effect.from_scene(settings, body, constraint, at)


def _refuse_beside_turning(effects, body, constraint, where):
    """Refuse a rotor or a moving pivot beside internal dissipation.

    Dissipation would turn neither the rotor's momentum nor the velocity given by the pivot.
    """
    carrying = [effect.name for effect in effects if effect.momentum is not None]
    frame = constraint.frame(body)
    if frame.path is not None:
        carrying.append('a pivot that moves')
    if not carrying:
        return
    for effect in effects:
        if effect.acting is not None and any(one.gives == 'turning'
                                             for one in effect.acting(frame, 0.0)):
            raise BadInput(f'{where}.{effect.name}', f'is given together with {carrying[0]}',
                           'heat at constant momentum is that of the body alone: leave one out')


def _named(entry):
    """Return name and settings of an entry of the list of effects, None where it has no name."""
    if isinstance(entry, str):
        return entry, {}
    if not isinstance(entry, dict) or len(entry) != 1:
        return None, None
    (name, settings), = entry.items()
    return name, {} if settings is None else settings


def _start(mapping, body, constraint, where):
    for key in mapping:
        if key not in constraint.INITIAL:
            raise BadInput(f'{where}.{key}', f'has no meaning on constraint {constraint.kind!r}',
                           f'the keys there are {", ".join(constraint.INITIAL)}')
    return Start.of(mapping, constraint.inertia(body), where)
