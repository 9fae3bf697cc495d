# SPDX-License-Identifier: Apache-2.0
"""The command `scenes`: one scene or all that ship, as text and as JSON."""

import json

import pytest

from rigid_body_sim.cli.scenes import main
from rigid_body_sim.scene.json_schema import json_schema
from rigid_body_sim.scene.scene import scene_names

pytestmark = pytest.mark.without_numba
BARE = ('scene: bare\nbody: {mass: 1, inertia: [1, 2, 2.5]}\nconstraint: free\n'
        'effects: []\ninitial: {}\n')
DROPPED = ('scene: dropped\nabout: Falls\nbody: {mass: 1, inertia: [1, 2, 2.5]}\n'
           'constraint: free\neffects: [gravity: {g: 9.81}, drag: {angular: 0.1}]\ninitial: {}\n')
HELD = ('scene: held\nbody: {mass: 1, inertia: [1, 2, 2.5]}\nconstraint: pivot\n'
        'effects: [gravity: {g: 9.81}]\ninitial: {}\n')


@pytest.fixture
def files(tmp_path):
    found = []
    for name, text in (('bare', BARE), ('dropped', DROPPED)):
        (tmp_path / f'{name}.yaml').write_text(text)
        found.append(str(tmp_path / f'{name}.yaml'))
    return found


def test_a_scene_is_two_lines(files, capsys):
    assert main(files) == 0
    first, second, third, fourth = capsys.readouterr().out.splitlines()
    assert first == 'bare: '
    assert second.startswith('    free; effects: none; methods: exact, ')
    assert third == 'dropped: Falls'
    assert fourth.startswith('    free; effects: gravity, drag; methods: ')


def test_json_has_the_same(files, capsys):
    assert main([*files, '--json']) == 0
    bare, dropped = json.loads(capsys.readouterr().out)
    assert bare['methods'][0] == 'exact' and dropped['methods']
    assert bare | {'methods': 0} == {
        'scene': 'bare', 'about': '', 'constraint': 'free', 'effects': [], 'methods': 0,
        'notes': []}
    assert dropped['effects'] == ['gravity', 'drag']


def test_notes_stand_below(tmp_path, capsys):
    (tmp_path / 'held.yaml').write_text(HELD)
    assert main([str(tmp_path / 'held.yaml')]) == 0
    assert capsys.readouterr().out.splitlines()[2:] == [
        '    note: the pivot holds the body at its centre of mass: gravity does nothing there']


def test_all_that_ship_are_listed(capsys):
    assert main(['--json']) == 0
    assert [one['scene'] for one in json.loads(capsys.readouterr().out)] == scene_names()


def test_the_schema_is_printed_alone(capsys):
    assert main(['--schema', '--json']) == 0
    assert json.loads(capsys.readouterr().out) == json.loads(json.dumps(json_schema()))
