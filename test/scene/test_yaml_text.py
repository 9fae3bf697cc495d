# SPDX-License-Identifier: Apache-2.0
"""Scene texts as strangers write them: tags, misspelt keys, characters that a terminal obeys."""

import pytest

from rigid_body_sim import BadInput, Simulation, parse_scene
from rigid_body_sim.scene.yaml_text import override, parse

SCENE = """\
scene: stone
body: {mass: 1.0, inertia: [1.0, 2.0, 3.0]}
constraint: free
effects: []
initial: {angular_velocity: [0.1, 2.0, 0.1]}
"""
TAGGED = (
    '!!bool x',
    '!!bool',
    '!!bool [1]',
    '!!timestamp x',
    '!!timestamp 2001-13-45',
    '!!map [1]',
    '!!map x',
    '!!set [a]',
    '!!set {a}',
    '!!omap [1]',
    '!!pairs [[1]]',
    '!!seq {a: 1}',
    '!!binary "\\xe9"',
    '!!int x',
    '!!float {}',
    '!!null [1]',
    '!!str 5',
    '!own 1',
    '! 5',
    '!<tag:yaml.org,2002:bool> 7',
    '!!python/object:os.system x',
)


def refusal(text, overrides=()):
    with pytest.raises(BadInput) as refused:
        parse_scene(text, overrides)
    return str(refused.value)


@pytest.mark.parametrize('value', TAGGED)
@pytest.mark.parametrize(
    'text',
    [
        '{value}',
        SCENE + 'about: {value}',
        SCENE + '{value}: 1',
        SCENE.replace('1.0,', '{value},', 1),
        SCENE.replace('[]', '[gravity: {value}]'),
    ],
    ids=['whole', 'text', 'key', 'number', 'effect'],
)
def test_a_tag_is_refused_in_one_line_wherever_it_stands(text, value):
    line = refusal(text.replace('{value}', value))
    assert '\n' not in line
    assert 'a tag (' in line or 'could not find expected' in line or 'expected' in line


@pytest.mark.parametrize('value', TAGGED)
def test_a_tag_in_an_override_is_refused_in_one_line(value):
    assert 'a tag (' in refusal(SCENE, [f'body.mass={value}'])


@pytest.mark.parametrize(
    ('changed', 'line'),
    [
        (
            SCENE.replace('constraint', 'constrain'),
            "unknown key 'constrain'; did you mean 'constraint'?",
        ),
        (SCENE.replace('initial', 'intial'), "unknown key 'intial'; did you mean 'initial'?"),
        (SCENE.replace('effects', 'forces'), "unknown key 'forces'; the keys are about, body"),
        (SCENE.replace('[]', '[gravity: {G: 9.81}]'), "effects.gravity: unknown key 'G'"),
        (
            SCENE.replace(
                'inertia: [1.0, 2.0, 3.0]', 'parts: [{mas: 1, shape: {rod: {length: 1}}}]'
            ),
            "body.parts.0: unknown key 'mas'; did you mean 'mass'?",
        ),
    ],
)
def test_a_stray_key_is_named_though_another_is_missing(changed, line):
    assert line in refusal(changed)


@pytest.mark.parametrize('effect', ['thruster', 'adhesion', 'buoyancy', 'solar_sail'])
def test_an_effect_that_does_not_exist_is_not_taken_for_a_misspelling(effect):
    line = refusal(SCENE.replace('[]', f'[{effect}: {{}}]'))
    assert 'did you mean' not in line
    assert 'the effects are gravity' in line


@pytest.mark.parametrize(
    ('word', 'meant'),
    [
        ('gravty', 'gravity'),
        ('tourqe', 'torque'),
        ('darg', 'drag'), ('dissipation', 'internal_dissipation'),

        ('Gravity', 'gravity'),
        ('sliding-friction', 'sliding_friction'),
    ],
)
def test_a_misspelt_effect_is_understood(word, meant):
    assert f'did you mean {meant!r}?' in refusal(SCENE.replace('[]', f'[{word}]'))


@pytest.mark.parametrize(
    'times',
    [
        '[1, 1]',
        '[1.0, 1]',
        '[0, 2, 2]',
        '[2, 1]',
        '[0, -0.0]',
        '[9007199254740992, 9007199254740993]',
    ],
)
def test_times_of_a_torque_rise(times):
    values = '[' + ', '.join(['[0, 0, 1]'] * (times.count(',') + 1)) + ']'
    effect = f'[torque: {{times: {times}, values: {values}}}]'
    assert 'times rise from one to the next' in refusal(SCENE.replace('[]', effect))


@pytest.mark.parametrize('escape', ['\\e[2J', '\\a', '\\x9b31m', '\\u202e', '\\0', '\\n', '\\r'])
def test_no_unprintable_character_of_a_scene_reaches_the_terminal(escape):
    key = f'"a{escape}b"'
    texts = (
        SCENE + f'{key}: 1\n',
        SCENE.replace('mass', key),
        SCENE.replace('[]', f'[{key}]'),
        SCENE.replace('free', f'{{{key}: 1}}'),
        SCENE.replace('1.0,', f'{{{key}: .nan}},', 1),
        SCENE.replace('[]', f'[gravity: {{g: {{{key}: .inf}}}}]'),
    )
    for text in texts:
        assert refusal(text).isprintable()
    told = parse_scene(SCENE + f'about: {key}\n').about
    assert told.isprintable() and told.startswith('a') and told.endswith('b')


@pytest.mark.parametrize(
    'override', ['\x1b[2J=3', 'body.\x07.x=3', 'body.mass=\x9b', 'gravity.\r=1']
)
def test_no_unprintable_character_of_an_override_reaches_the_terminal(override):
    assert refusal(SCENE, [override]).isprintable()


@pytest.mark.parametrize('overrides', [5, [3], [None], {'body.mass': object()}, object()])
def test_overrides_of_the_wrong_kind_are_refused_in_one_line(overrides):
    assert refusal(SCENE, overrides).startswith('overrides: got ')


def test_one_line_alone_is_an_override():
    assert Simulation('tennis_racket', overrides='body.mass=2.5').scene.body.mass == 2.5


LISTED = """\
scene: stone
body: {mass: 1.0, inertia: [1.0, 2.0, 3.0]}
constraint: free
effects:
- gravity
- {drag: }
- torque: {value: [0, 0, 1], frame: body}
initial: {euler_zyz: [0.1, 0.2, 0.3], spin: 2.0}
"""


@pytest.mark.parametrize(('assignment', 'keys', 'expected'), [
    ('gravity.g=2.5', ['effects', 0], {'gravity': {'g': 2.5}}),
    ('effects.gravity.g=2.5', ['effects', 0], {'gravity': {'g': 2.5}}),
    ('effects.0.g=2.5', ['effects', 0], {'gravity': {'g': 2.5}}),
    ('effects[0].gravity=7', ['effects', 0], {'gravity': {'gravity': 7}}),
    ('drag.linear=2', ['effects', 1], {'drag': {'linear': 2}}),
    ('effects.1.linear=2', ['effects', 1], {'drag': {'linear': 2}}),
    ('effects.drag=2', ['effects', 1], {'drag': 2}),
    ('effects.1=2', ['effects', 1], {'drag': 2}),
    ('torque.body=2', ['effects', 2, 'torque', 'body'], 2),    # a key of the scene, too
    ('torque.value.2=3', ['effects', 2], {'torque': {'value': [0, 0, 3], 'frame': 'body'}}),
    (' effects[2].value[0] = 3', ['effects', 2],
     {'torque': {'value': [3, 0, 1], 'frame': 'body'}}),
    ('effects=[torque]', ['effects'], ['torque']),
    ('body.inertia=[+1, 2., 3]', ['body', 'inertia'], [1, 2.0, 3]),
    ('body.inertia[2]=4', ['body'], {'mass': 1.0, 'inertia': [1.0, 2.0, 4]}),
    ('body.density=3', ['body'], {'density': 3, 'inertia': [1.0, 2.0, 3.0]}),
    ('about=a=b', ['about'], 'a=b'),
    ('initial.tilt=1', ['initial'], {'tilt': 1, 'spin': 2.0}),
    ('initial.angular_velocity=[1, 2, 3]', ['initial'],
     {'euler_zyz': [0.1, 0.2, 0.3], 'angular_velocity': [1, 2, 3]}),
    ('initial.position=[1, 2, 3]', ['initial'],
     {'euler_zyz': [0.1, 0.2, 0.3], 'spin': 2.0, 'position': [1, 2, 3]}),
    ('view.camera.far=true', ['view'], {'camera': {'far': True}})])
def test_an_override_sets_one_value_and_leaves_the_others(assignment, keys, expected):
    mapping, wanted = parse(LISTED, 'stone'), parse(LISTED, 'stone')
    holder = wanted
    for key in keys[:-1]:
        holder = holder[key]
    holder[keys[-1]] = expected
    override(mapping, assignment, 'stone')
    assert mapping == wanted


@pytest.mark.parametrize(('assignment', 'problem'), [
    ('effects.3.g=1', "no effect '3' in this scene; it lists ['gravity', 'drag', 'torque']"),
    ('effects.strike.g=1', "no effect 'strike' in this scene; it lists ['gravity', 'drag'"),
    ('torque.value.3=1', "no place '3' in a list of 3; places run from 0 to 2"),
    ('torque.value.x=1', "no place 'x' in a list of 3; places run from 0 to 2"),
    ('torque.value.-1=1', "no place '-1' in a list of 3; places run from 0 to 2"),
    ('torque.value.3.x=1', "no place '3' in a list of 3; places run from 0 to 2"),
    ('body.mass.x=1', "'x' lies inside a plain value; end the path at the value itself"),
    ('body.mass.x.y=1', "'x' lies inside a plain value; end the path at the value itself"),
    ('=1', "got '=1'; an override is key.path=value, for example body.mass=2.0"),
    ('about=a: b', 'mapping values are not allowed here'),
    ('mass', "got 'mass'; an override is key.path=value, for example body.mass=2.0")])
def test_an_override_of_what_is_not_there_is_refused(assignment, problem):
    mapping = parse(LISTED, 'stone')
    with pytest.raises(BadInput) as refused:
        override(mapping, assignment, 'stone')
    path = assignment.partition('=')[0]
    assert str(refused.value).startswith(f'stone: {path or assignment!r}')
    assert f': {problem}' in str(refused.value)
    assert mapping == parse(LISTED, 'stone')


def test_twelve_levels_are_read_and_the_thirteenth_is_refused_with_its_line():
    """The mapping is the first level."""
    assert parse('a: ' + '[' * 11 + ']' * 11, 'f.yaml')['a'] != []
    with pytest.raises(BadInput, match=r'^f\.yaml, line 2: nested deeper than 12 levels'):
        parse('b: 1\na: ' + '[' * 12 + ']' * 12, 'f.yaml')
