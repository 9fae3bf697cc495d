# SPDX-License-Identifier: Apache-2.0
"""The JSON Schema of scene files: an editor and this package judge a file alike."""

import json
import pathlib

import jsonschema
import pytest
import yaml

from rigid_body_sim import BadInput, parse_scene
from rigid_body_sim.cli.scenes import main
from rigid_body_sim.scene import yaml_text
from rigid_body_sim.scene.json_schema import json_schema
from rigid_body_sim.scene.scene import scene_folder, scene_names

CONFIG = pathlib.Path(__file__).resolve().parents[2] / 'config'
SCENE = {'scene': 'top', 'body': {'mass': 1.0, 'inertia': [1.0, 1.0, 1.5]}, 'constraint': 'pivot',
         'effects': [{'gravity': {'g': 9.81}}], 'initial': {'tilt': 0.1, 'spin': 3.0}}


def faults(mapping):
    return list(jsonschema.Draft202012Validator(json_schema()).iter_errors(mapping))


def test_it_is_a_schema():
    jsonschema.Draft202012Validator.check_schema(json_schema())


@pytest.mark.parametrize('name', scene_names())
def test_every_scene_that_ships_fits(name):
    text = (scene_folder() / f'{name}.yaml').read_text()
    # this package reads 5.972e24 as a number; plain YAML 1.1 takes it for a word
    assert not faults(yaml_text.parse(text, name))


@pytest.mark.parametrize('change', [
    {'body': {'mass': -1.0, 'inertia': [1.0, 1.0, 1.0]}},
    {'body': {'mass': 1.0, 'inertia': [1.0, 1.0]}},
    {'constraint': 'hung'}, {'constraint': {'hinge': {}}},
    {'effects': [{'gravity': {'gg': 1.0}}]}, {'effects': ['levity']}, {'effects': ['gravity']},
    {'initial': {'tilt': '0.1'}}, {'extra': 1}])
def test_it_refuses_what_the_parser_refuses(change):
    mapping = {**SCENE, **change}
    assert faults(mapping)
    with pytest.raises(BadInput):
        parse_scene(yaml.safe_dump(mapping))


@pytest.mark.parametrize('change', [
    {}, {'effects': []}, {'initial': {'euler_zyz': [0, 1, 0]}},
    {'body': {'mass': 1.0, 'inertia': [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.5]]}},
    {'constraint': {'hinge': {'axis': [1, 0, 0]}}, 'initial': {'angle': 0.2}}])
def test_it_accepts_what_the_parser_accepts(change):
    mapping = {**SCENE, **change}
    parse_scene(yaml.safe_dump(mapping))
    assert not faults(mapping)


def test_the_installed_file_is_what_the_command_prints(capsys):
    assert main(['--schema']) == 0
    shown = capsys.readouterr().out
    assert (CONFIG / 'scene.schema.json').read_text() == shown, (
        'run: python -m rigid_body_sim scenes --schema > config/scene.schema.json')
    assert json.loads(shown)['$schema'].endswith('2020-12/schema')
