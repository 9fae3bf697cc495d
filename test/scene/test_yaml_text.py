# SPDX-License-Identifier: Apache-2.0
"""Scene texts as strangers write them: tags, misspelt keys, characters that a terminal obeys."""

import pytest

from rigid_body_sim import BadInput, Simulation, parse_scene
from rigid_body_sim.scene import yaml_text

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


EFFECTS = """
scene: s
body: {mass: 1.0, inertia: [1, 2, 2.5]}
constraint: free
effects: [gravity: {g: 9.81}, internal_dissipation: {coefficient: 0.5}, drag: {linear: 1}]
initial: {}
"""


@pytest.mark.parametrize(('override', 'place', 'effect'), [
    ('effects.0.g=3', 0, {'gravity': {'g': 3}}), ('gravity.g=3', 0, {'gravity': {'g': 3}}),
    ('effects.gravity.g=3', 0, {'gravity': {'g': 3}}),
    ('effects[2].linear=3', 2, {'drag': {'linear': 3}}),
    ('effects.2.angular=3', 2, {'drag': {'linear': 1, 'angular': 3}}),
    ('effects.1={coefficient: 0.1}', 1, {'internal_dissipation': {'coefficient': 0.1}}),
    ('effects.internal_dissipation={coefficient: 0.1}', 1,
     {'internal_dissipation': {'coefficient': 0.1}})])
def test_an_effect_is_changed_by_its_place_or_its_name(override, place, effect):
    effects = parse_scene(EFFECTS, [override]).mapping['effects']
    expected = yaml_text.parse(EFFECTS, 's')['effects']
    assert effects == [*expected[:place], effect, *expected[place + 1:]]


@pytest.mark.parametrize(('before', 'override', 'after'), [
    (['a'], 'effects.0.k=3', [{'a': {'k': 3}}]), (['a'], 'a.k=3', [{'a': {'k': 3}}]),
    (['b', {'a': None}], 'effects.1.k=3', ['b', {'a': {'k': 3}}]),
    (['b', {'a': None}], 'effects.a.k.l=3', ['b', {'a': {'k': {'l': 3}}}]),
    ([{'a': {}, 'b': {}}], 'effects.b.k=3', [{'a': {}, 'b': {'k': 3}}]),
    ([{'a': {}, 'b': {}}], 'effects.0.k=3', [{'a': {'k': 3}, 'b': {}}])])
def test_an_effect_that_is_a_name_or_stands_beside_others_is_changed(before, override, after):
    mapping = {'effects': before}
    yaml_text.override(mapping, override, 's')
    assert mapping == {'effects': after}


def test_an_effect_at_a_place_beyond_the_last_is_refused():
    assert "no effect '3' in this scene; it lists ['gravity', 'internal_dissipation', 'drag']" in (
        refusal(EFFECTS, ['effects.3.g=1']))


@pytest.mark.parametrize('override', ['body.mass', '=3', '', '.=3'])
def test_an_override_has_a_path_and_a_value(override):
    assert 'an override is key.path=value' in refusal(EFFECTS, [override])
