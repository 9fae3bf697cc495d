# SPDX-License-Identifier: Apache-2.0
"""Errors in scene files name the line, even where only the meaning of the YAML is wrong."""

import pytest

from rigid_body_sim import BadInput, load_scene, parse_scene

TEXT = """\
scene: top                       # line 1
body:
  mass: 1.0
  inertia: [1.0, 1.0, 1.5]       # line 4
constraint: pivot
effects:
  - gravity:
      g: 9.81                    # line 8
  - torque: {value: [0, 0, 1], frame: body}
initial:
  tilt: 0.1
  spin: 3.0                      # line 12
"""


@pytest.mark.parametrize(('old', 'new', 'place'), [
    ('[1.0, 1.0, 1.5]', '[1.0, 1.0, 3.5]', 'line 4: body.inertia'),
    ('[1.0, 1.0, 1.5]', '[1.0, .nan, 1.5]', 'line 4: body.inertia.1'),
    ('mass: 1.0', 'mass: -1.0', 'line 3: body.mass'),
    ('mass: 1.0', 'mas: 1.0', 'line 2: body'),
    ('g: 9.81', 'g: much', 'line 8: effects.gravity.g'),
    ('frame: body}', 'frame: space}', 'line 9: effects.torque.frame'),
    ('pivot', 'hung', 'line 5: constraint'),
    ('spin: 3.0', 'velocity: [1, 0, 0]', 'line 12: initial.velocity'),
])
def test_the_line_of_the_value_is_named(old, new, place):
    assert old in TEXT
    with pytest.raises(BadInput) as refused:
        parse_scene(TEXT.replace(old, new), where='top.yaml')
    assert refused.value.where == f'top.yaml, {place}'
    assert '\n' not in str(refused.value)


def test_a_missing_top_level_key_has_no_line():
    with pytest.raises(BadInput, match=r'^top.yaml: the key .initial. is missing'):
        parse_scene(TEXT[:TEXT.index('initial')], where='top.yaml')


def test_of_two_effects_with_one_name_none_is_accused():
    text = TEXT.replace('torque: {value: [0, 0, 1], frame: body}',
                        'strike: {time: 1, point: [0, 0, 1], impulse: [1, 0, 0]}\n'
                        '  - strike: {time: -1, point: [0, 0, 1], impulse: [1, 0, 0]}')
    with pytest.raises(BadInput) as refused:
        parse_scene(text, where='top.yaml')
    assert refused.value.where.startswith('top.yaml, line 6: effects.strike')


@pytest.mark.parametrize('overrides', [['body.mass=-1'], {'body.mass': -1}])
def test_an_override_is_not_blamed_on_the_file(overrides):
    with pytest.raises(BadInput) as refused:
        parse_scene(TEXT, overrides, where='top.yaml')
    assert refused.value.where == 'top.yaml: body.mass'


def test_overrides_are_a_mapping_or_lines():
    by_lines = load_scene('heavy_top', ['body.mass=2.5', 'initial.tilt=0.3'])
    assert load_scene('heavy_top', {'body.mass': 2.5, 'initial.tilt': 0.3}).text == by_lines.text
