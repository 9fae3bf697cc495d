# SPDX-License-Identifier: Apache-2.0
"""From scene text to a mapping: YAML as data only, of bounded size and depth, with overrides."""

import collections.abc
import functools
import json
import re

import yaml

from rigid_body_sim.errors import BadInput

MAXIMUM_BYTES = 256 * 1024
MAXIMUM_DEPTH = 12
KEPT = 16    # texts
NUMBERS = re.compile(r' *\[?[-+0-9.eE, ]*\]? *')
ALTERNATIVES = (
    ('orientation', 'euler_zyz', 'euler', 'rotation_vector', 'tilt'),
    ('angular_velocity', 'angular_velocity_world', 'angular_momentum', 'spin'),
    ('mass', 'density'),
    ('through', 'distance'),
    ('point', 'height', 'distance'),
    ('impulse', 'speed'),
)
"""Keys that say the same thing: an override by one of them takes the place of the others."""


class _SceneLoader(yaml.SafeLoader):
    """YAML without aliases, tags and repeated keys, with 1e-3 read as a number.

    Aliases can grow a small file to any size.
    """

    def compose_node(self, parent, index):
        self.depth = getattr(self, 'depth', 0) + 1
        if self.depth > MAXIMUM_DEPTH:
            raise yaml.constructor.ConstructorError(
                None,
                None,
                f'nested deeper than {MAXIMUM_DEPTH} levels',
                self.peek_event().start_mark,
            )
        if self.check_event(yaml.AliasEvent):
            raise yaml.constructor.ConstructorError(
                None, None, 'an alias (*name) is not allowed here', self.peek_event().start_mark
            )
        event = self.peek_event()
        if getattr(event, 'tag', None) is not None:
            # a scene has words, numbers, lists and mappings, which need none; constructors of
            # tags fail in ways of their own
            raise yaml.constructor.ConstructorError(
                None, None, f'a tag ({event.tag}) is not allowed here', event.start_mark
            )
        node = super().compose_node(parent, index)
        self.depth -= 1
        return node

    def construct_mapping(self, node, deep=False):
        keys = [self.construct_object(key, deep=True) for key, _ in node.value]
        for key, (key_node, _) in zip(keys, node.value, strict=True):
            if not isinstance(key, str):
                raise yaml.constructor.ConstructorError(
                    None, None, f'the key {key!r} is not a word', key_node.start_mark
                )
            if keys.count(key) > 1:
                raise yaml.constructor.ConstructorError(
                    None, None, f'the key {key!r} is given twice', key_node.start_mark
                )
        return super().construct_mapping(node, deep)


_SceneLoader.yaml_implicit_resolvers = {
    first: [(tag, pattern) for tag, pattern in resolvers if tag == 'tag:yaml.org,2002:null']
    for first, resolvers in yaml.SafeLoader.yaml_implicit_resolvers.items()
}
_SceneLoader.add_implicit_resolver(
    'tag:yaml.org,2002:bool', re.compile(r'^(?:true|false)$'), list('tf')
)
_SceneLoader.add_implicit_resolver(
    'tag:yaml.org,2002:int', re.compile(r'^[-+]?[0-9]+$'), list('-+0123456789')
)
_SceneLoader.add_implicit_resolver(
    'tag:yaml.org,2002:float',
    re.compile(
        r'^(?:[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?'
        r'|[-+]?\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN))$'
    ),
    list('-+.0123456789'),
)
_SceneLoader.add_constructor(
    'tag:yaml.org,2002:int', lambda loader, node: int(loader.construct_scalar(node)[:400])
)
_SceneLoader.add_constructor(
    'tag:yaml.org,2002:float', lambda loader, node: _number(loader.construct_scalar(node))
)


def _number(text):
    return float(text.lower().replace('.inf', 'inf').replace('.nan', 'nan'))


def parse(text, where):
    """Return the mapping that a scene text holds; BadInput with the line where it is not one."""
    try:
        text.encode()
    except (AttributeError, UnicodeEncodeError):
        raise BadInput(where, f'got {text!r:.80}', 'the text of a scene (str)') from None
    return copied(_parsed(text, where))


class Written:
    """A value as the key of a cache: values that are written alike are the same."""

    __slots__ = 'text', 'value'

    def __init__(self, value):
        self.value, self.text = value, repr(value)

    def __hash__(self):
        return hash(self.text)

    def __eq__(self, other):
        return isinstance(other, Written) and self.text == other.text


def copied(value):
    """Return a copy of a mapping, list or plain value that shares no mapping or list with it."""
    if isinstance(value, dict):
        return {key: copied(entry) for key, entry in value.items()}
    return [copied(entry) for entry in value] if isinstance(value, list) else value


@functools.lru_cache(maxsize=KEPT)
def _parsed(text, where):
    """Return the mapping of `parse`, cached and to be copied: loops read one text many times."""
    if len(text.encode()) > MAXIMUM_BYTES:
        raise BadInput(
            where, f'{len(text.encode())} bytes', f'a scene has at most {MAXIMUM_BYTES} bytes'
        )
    try:
        mapping = yaml.load(text, Loader=_SceneLoader)
    except yaml.YAMLError as error:
        mark = getattr(error, 'problem_mark', None)
        line = f', line {mark.line + 1}' if mark else ''
        problem = ' '.join(
            str(getattr(error, 'problem', None) or getattr(error, 'reason', None) or error).split()
        )
        raise BadInput(
            f'{where}{line}', problem, 'a scene file is plain YAML (docs/scenes.md)'
        ) from None
    except (ValueError, RecursionError) as error:
        raise BadInput(
            where, ' '.join(str(error).split()), 'a scene file is plain YAML (docs/scenes.md)'
        ) from None
    if not isinstance(mapping, dict):
        raise BadInput(
            where,
            f'got {brief(mapping)}',
            'a scene is a mapping with the keys scene, body, constraint, effects, initial',
        )
    return mapping


def line_of(text, keys):
    """Return the line (from 1) of a scene text in which a key path stands, or None.

    Parameters
    ----------
    text : str
        YAML that parses.
    keys : list of str
        Keys from the top, places in lists as digits, effects also by name. Where the last keys
        are absent it is the line of what should hold them.
    """
    node, line = _SceneLoader(text).get_single_node(), None
    for key in keys:
        found = _child(node, key)
        if found is None:
            break
        line, node = found
    return line


def _child(node, key):
    """Return (line, value node) of a key in a mapping, or of a place or an effect in a list."""
    if isinstance(node, yaml.MappingNode):
        return next(
            ((at.start_mark.line + 1, value) for at, value in node.value if at.value == key), None
        )
    if not isinstance(node, yaml.SequenceNode):
        return None
    if key.isdigit():
        entry = node.value[int(key)] if int(key) < len(node.value) else None
        return entry and (entry.start_mark.line + 1, entry)
    named = [
        (entry.start_mark.line + 1, entry)
        if isinstance(entry, yaml.ScalarNode)
        else _child(entry, key)
        for entry in node.value
        if getattr(entry, 'value', None) == key or _child(entry, key)
    ]
    # several effects of one name: the message says no line rather than a wrong one
    return named[0] if len(named) == 1 else None


def assignments(overrides):
    """Return overrides as lines ``key.path=value``; given are such lines, or a mapping.

    Parameters
    ----------
    overrides : mapping of str to value, or sequence of str
        Values are numbers, words, lists, mappings or NumPy arrays. A single line stands for a
        sequence of one.

    Raises
    ------
    BadInput
        For anything else.
    """
    if isinstance(overrides, str):
        return (overrides,)
    try:
        if not isinstance(overrides, collections.abc.Mapping):
            return tuple(one.strip() for one in overrides)
        return tuple(
            f'{key}={json.dumps(value, default=lambda array: array.tolist())}'
            for key, value in overrides.items()
        )
    except (AttributeError, TypeError, ValueError):
        raise BadInput(
            'overrides',
            f'got {brief(overrides)}',
            "a mapping like {'body.mass': 2.0}, or lines like body.mass=2.0",
        ) from None


def override(mapping, assignment, where):
    """Set one value in a scene mapping.

    Parameters
    ----------
    mapping : dict
        A parsed scene, changed in place.
    assignment : str
        ``key.path=value``: keys from the top (``body.mass=2``), a number for a place in a list
        (``initial.angular_velocity.1=3``), or from the name of an effect (``strike.height=0.02``).
        The value is read as YAML. A key takes the place of its ALTERNATIVES: ``initial.tilt=1`` of
        an ``initial.euler_zyz``.
    """
    path, equals, value = assignment.partition('=')
    keys = [key for key in path.strip().replace('[', '.').replace(']', '').split('.') if key]
    where = f'{where}: {path.strip() or assignment!r}'
    if not equals or not keys:
        raise BadInput(
            where,
            f'got {assignment!r}',
            'an override is key.path=value, for example body.mass=2.0',
        )
    if keys[0] == 'effects':
        keys = keys[1:]
        if not keys:
            mapping['effects'] = _value(value, where)
            return
        target = _effect(mapping, keys, where)
    elif keys[0] not in mapping and any(keys[0] in _names(effect) for effect in _effects(mapping)):
        target = _effect(mapping, keys, where)
    else:
        target = mapping
    for key in keys[:-1]:
        target = _step(target, key, where)
    _put(target, keys[-1], _value(value, where), where)


def _value(text, where):
    if NUMBERS.fullmatch(text):
        try:
            return json.loads(text)    # JSON reads numbers and lists of them alike, and faster
        except ValueError:
            pass    # as 1. or +1
    return parse(f'value: {text}', where)['value']


def _effects(mapping):
    effects = mapping.get('effects')
    return effects if isinstance(effects, list) else []


def _names(effect):
    return (
        [effect] if isinstance(effect, str) else list(effect) if isinstance(effect, dict) else []
    )


def _effect(mapping, keys, where):
    """Return the list entry that holds the effect keys[0]; a number counts entries."""
    effects = _effects(mapping)
    for place, effect in enumerate(effects):
        if keys[0] in _names(effect) or keys[0] == str(place):
            if isinstance(effect, str):
                effects[place] = {effect: {}}
            if keys[0] == str(place):
                keys[0] = next(iter(effects[place]))
            if effects[place][keys[0]] is None:
                effects[place][keys[0]] = {}
            return effects[place]
    raise BadInput(
        where,
        f'no effect {keys[0]!r} in this scene',
        f'it lists {[name for effect in effects for name in _names(effect)]}',
    )


def _step(target, key, where):
    if isinstance(target, list):
        return target[_place(target, key, where)]
    if not isinstance(target, dict):
        raise BadInput(
            where, f'{key!r} lies inside a plain value', 'end the path at the value itself'
        )
    return target.setdefault(key, {})


def _put(target, key, value, where):
    if isinstance(target, list):
        target[_place(target, key, where)] = value
    elif isinstance(target, dict):
        for other in {other for way in ALTERNATIVES if key in way for other in way}:
            target.pop(other, None)
        target[key] = value
    else:
        raise BadInput(
            where, f'{key!r} lies inside a plain value', 'end the path at the value itself'
        )


def _place(target, key, where):
    if not key.isdigit() or int(key) >= len(target):
        raise BadInput(
            where,
            f'no place {key!r} in a list of {len(target)}',
            f'places run from 0 to {len(target) - 1}',
        )
    return int(key)


def brief(value):
    """Return the value as it is shown in an error line."""
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + '...'
