# SPDX-License-Identifier: Apache-2.0
"""Scene files: those that ship load, and each mistake gets one line.

The line has the file, the key path, the value and what would be right.
"""

import dataclasses
import math
import pathlib

import numpy as np
import pytest

from rigid_body_sim.cli import simulate
from rigid_body_sim.cli.scenes import describe
from rigid_body_sim.errors import BadInput
from rigid_body_sim.scene.effects.drag import Drag
from rigid_body_sim.scene.effects.torque import Torque
from rigid_body_sim.scene.scene import (
    changed_scene,
    load_scene,
    parse_scene,
    scene_folder,
    scene_names,
)

RACKET = pathlib.Path(scene_folder(), 'tennis_racket.yaml').read_text()


@pytest.mark.parametrize('name', scene_names())
def test_scene_that_ships_loads_and_can_be_made_again_from_its_text(name):
    scene = load_scene(name)
    assert scene.name == name
    assert scene.about
    again = parse_scene(scene.text)
    assert again.body == scene.body
    assert again.effects == scene.effects
    assert again.initial.vector.tobytes() == scene.initial.vector.tobytes()


def test_racket_is_the_one_of_the_notes():
    scene = load_scene('tennis_racket')
    assert scene.body.about_center.moments == (1.0, 2.0, 3.0)
    assert scene.initial.angular_velocity.tolist() == [0.01, 5.0, 0.01]


@pytest.mark.parametrize(
    ('assignment', 'line'),
    [('body.mass=-1', 'racket.yaml: body.mass: got -1; needs a number above 0'),
     ('body.mass=0', 'racket.yaml: body.mass: got 0; needs a number above 0'),
     ('body.mass=1e999', 'racket.yaml: body.mass: got inf; needs a finite number'),
     ('body.inertia.0=.nan', 'racket.yaml: body.inertia.0: got nan; needs a finite number'),
     ('bodi.mass=1', "racket.yaml: unknown key 'bodi'; did you mean 'body'?"),
     ('initial.angular_velocity=[1, 2, a]',
      "racket.yaml: initial.angular_velocity.2: got 'a'; the type is number"),
     ('initial.angular_velocity=[1, 2]',
      'racket.yaml: initial.angular_velocity: got [1, 2]; needs at least 3 entries'),
     ('initial.orientation=[0, 0, 0, 0]',
      'racket.yaml: initial.orientation: got [0.0, 0.0, 0.0, 0.0]; a quaternion (x, y, z, w) of '
      'non-zero norm'),
     ('initial.rate=3', "racket.yaml: initial.rate: has no meaning on constraint 'free'"),
     ('effects=[gravty]', "racket.yaml: effects.0: got 'gravty'; did you mean 'gravity'?"),
     ('effects=[sliding_friction: {mu: 0.1}]',
      "racket.yaml: effects.sliding_friction: cannot act on constraint 'free'"),
     ('constraint=pivoted',
      "racket.yaml: constraint: got 'pivoted'; one of free, pivot, table, or hinge"),
     ('constraint=table', 'racket.yaml: constraint: a table needs a sphere'),
     ('constraint=[1]', 'racket.yaml: constraint: got [1]; the type is string or object'),
     ('body={mass: 1, shape: {rodd: {length: 2}}}',
      "racket.yaml: body.shape: unknown key 'rodd'; did you mean 'rod'?"),
     ('body={mass: 1, shape: {rod: {length: 2}}}',
      'racket.yaml: initial.angular_velocity: spin 0.01 rad/s about principal axis 3'),
     ('body={inertia: [1, 1, 1]}', "racket.yaml: body: the key 'mass' is missing; a mass in kg"),
     ('scene=7 of 9', "racket.yaml: scene: got '7 of 9'; a name is letters"),
     ('body.inertia.3=1',
      "racket.yaml: 'body.inertia.3': no place '3' in a list of 3; places run from 0 to 2"),
     ('strike.height=1', "racket.yaml: unknown key 'strike'"),
     ('body.mass', "racket.yaml: 'body.mass': got 'body.mass'; an override is key.path=value")])
def test_mistake_gets_one_line(assignment, line):
    with pytest.raises(BadInput) as caught:
        parse_scene(RACKET, [assignment], 'racket.yaml')
    assert str(caught.value).startswith(line)
    assert '\n' not in str(caught.value)


@pytest.mark.parametrize(
    ('text', 'words'),
    [('a: *b', 'racket.yaml, line 1'), ('a: {b: 1', 'racket.yaml, line'),
     ('a: 1\na: 2', 'is given twice'), ('- 1', 'a scene is a mapping'),
     ('a: ' + '[' * 50 + ']' * 50, 'nested deeper'),
     ('a: !!python/object:os.system x', 'python/object'), ('\x00', 'special characters'),
     ('a: &x [1]\nb: *x', 'alias'), ('a: ' + 'x' * 300_000, 'at most 262144 bytes'),
     ('', 'a scene is a mapping')])
def test_what_is_no_scene_gets_one_line(text, words):
    with pytest.raises(BadInput, match=words) as caught:
        parse_scene(text, (), 'racket.yaml')
    assert '\n' not in str(caught.value)


def test_unknown_scene_names_the_nearest():
    with pytest.raises(BadInput, match='did you mean tennis_racket'):
        load_scene('tenis_racket')


@pytest.mark.parametrize(('scene', 'words'), [
    ({'scene': 'mine'}, 'got a dict that is no name and no path'),
    ('scene: mine\nconstraint: free\n', '`parse_scene` takes the text of a scene'),
    ('a' * 300, 'no scene'), ('nul\0', 'no scene')])
def test_what_is_no_name_gets_one_line(scene, words):
    with pytest.raises(BadInput, match=words) as caught:
        load_scene(scene)
    assert '\n' not in str(caught.value)


def test_missing_file_is_said(tmp_path):
    with pytest.raises(BadInput, match='cannot read'):
        load_scene(tmp_path / 'none.yaml')


def test_own_scene_outside_the_package(tmp_path):
    path = tmp_path / 'mine.yaml'
    path.write_text(RACKET.replace('scene: tennis_racket', 'scene: mine'))
    assert load_scene(path, ['body.inertia=[2, 3, 4]']).body.about_center.moments == (
        2.0, 3.0, 4.0)


def test_numbers_as_people_write_them():
    scene = parse_scene(RACKET, ['body.mass=1e-3', 'initial.position=[1, .5, -2E+1]'])
    assert scene.body.mass == 1e-3
    assert scene.initial.position.tolist() == [1.0, 0.5, -20.0]


def test_quaternion_is_normalised_and_a_unit_one_kept():
    for given, kept in (('[0, 0, 0, 1e75]', [0.0, 0.0, 0.0, 1.0]),
                        ('[0, 0, 0, 1e-200]', [0.0, 0.0, 0.0, 1.0]),
                        ('[0.6, 0, 0, 0.8]', [0.6, 0.0, 0.0, 0.8])):
        scene = parse_scene(RACKET, [f'initial.orientation={given}'])
        assert scene.initial.orientation.tolist() == kept


def test_hinge_starts_at_its_angle_about_its_axis():
    text = """
scene: door
body: {mass: 2.0, shape: {rod: {length: 1.0}}, center_of_mass: [0, 0, -0.4]}
constraint: {hinge: {axis: [0, 2, 0], through: [0, 0, 0.1]}}
effects: [gravity: {g: 9.81}]
initial: {angle: 0.5, rate: 2.0}
"""
    scene = parse_scene(text)
    assert scene.constraint.axis == (0.0, 1.0, 0.0)
    assert scene.initial.orientation.tolist() == pytest.approx(
        [0.0, math.sin(0.25), 0.0, math.cos(0.25)], abs=1e-16)
    # by hand: the origin hangs 0.1 m below the axis, turned by 0.5 rad about y
    assert scene.initial.position.tolist() == pytest.approx(
        [-0.1 * math.sin(0.5), 0.0, -0.1 * math.cos(0.5)], abs=1e-16)
    assert scene.initial.velocity.tolist() == pytest.approx(
        [-0.2 * math.cos(0.5), 0.0, 0.2 * math.sin(0.5)], abs=1e-16)


def test_ball_starts_on_the_table():
    text = """
scene: ball
body: {mass: 0.17, shape: {solid_sphere: {radius: 0.028575}}}
constraint: table
effects: []
initial: {velocity: [1, 0, 0]}
"""
    assert parse_scene(text).initial.position.tolist() == [0.0, 0.0, 0.028575]
    with pytest.raises(BadInput, match='the ball lies on the table'):
        parse_scene(text, ['initial.position=[0, 0, 1]'])


@pytest.mark.parametrize(('scene', 'assignment', 'found', 'expected'), [
    ('billiard_follow', 'strike.speed=2.0', lambda scene: scene.effect('strike').impulse,
     (0.34, 0.0, 0.0)),
    ('billiard_follow', 'strike.height=-0.02', lambda scene: scene.effect('strike').height, -0.02),
    ('billiard_follow', 'strike.impulse=[0, 0.1, 0]', lambda scene: scene.effect('strike').impulse,
     (0.0, 0.1, 0.0)),
    ('baseball_bat', 'strike.distance=0.3', lambda scene: scene.effect('strike').point,
     (0.3, 0.0, 0.0)),
    ('baseball_bat', 'strike.point=[0.4, 0, 0]', lambda scene: scene.effect('strike').point,
     (0.4, 0.0, 0.0)),
    ('kater_pendulum', 'constraint.hinge.distance=0.25', lambda scene: scene.constraint.through,
     (0.0, 0.0, -0.15)),
    ('kater_pendulum_from_p', 'constraint.hinge.distance=-0.25',
     lambda scene: scene.constraint.through, (0.0, 0.0, -0.65)),
    ('kater_pendulum', 'constraint.hinge.through=[0, 0, 0.1]',
     lambda scene: scene.constraint.through, (0.0, 0.0, 0.1)),
    ('heavy_top', 'initial.spin=80', lambda scene: scene.initial.angular_velocity,
     (0.0, 0.0, 80.0)),
    ('heavy_top', 'initial.tilt=0.6', lambda scene: scene.initial.orientation,
     (0.0, math.sin(0.3), 0.0, math.cos(0.3))),
])
def test_what_a_reader_turns_is_one_override(scene, assignment, found, expected):
    """A key replaces another one with the same meaning: tilt or euler_zyz, distance or a point."""
    assert np.atleast_1d(found(load_scene(scene, [assignment]))) == pytest.approx(
        expected, abs=1e-16)


@pytest.mark.parametrize(
    ('scene', 'assignment', 'line'),
    [('billiard_follow', 'strike.height=0.03',
      'billiard_follow.yaml: effects.strike.height: got 0.03; at most the radius, 0.028575, above '
      'or below the middle'),
     ('billiard_follow', 'strike.hight=0.01',
      "billiard_follow.yaml: effects.strike: unknown key 'hight'; did you mean 'height'?"),
     ('billiard_follow', 'strik.height=0.01',
      "billiard_follow.yaml: unknown key 'strik'; the keys are"),
     ('billiard_follow', 'strike.distance=0.01',
      "billiard_follow.yaml: effects.strike.distance: has no meaning on constraint 'table'"),
     ('billiard_follow', 'strike={height: 0}',
      'billiard_follow.yaml: effects.strike: got the keys height; give one of impulse (N s) and'),
     ('billiard_follow', 'strike={speed: 1, height: 0, point: [0, 0, 0]}',
      'billiard_follow.yaml: effects.strike.height: is given together with point'),
     ('baseball_bat', 'strike.speed=1',
      "baseball_bat.yaml: effects.strike.speed: has no meaning on constraint 'hinge'"),
     ('baseball_bat', 'strike.height=1',
      "baseball_bat.yaml: effects.strike.height: has no meaning on constraint 'hinge'"),
     ('baseball_bat', 'constraint.hinge.through=[0.55, 0, 0]',
      'baseball_bat.yaml: effects.strike.distance: got 0.6227272727272727 on a hinge'),
     ('kater_pendulum', 'constraint.hinge.distance=0',
      'kater_pendulum.yaml: constraint.hinge.distance: got 0; hung at its centre of mass a body '
      'does not swing'),
     ('kater_pendulum', 'constraint.hinge={axis: [0, 0, 1], distance: 1}',
      'kater_pendulum.yaml: constraint.hinge.distance: got an axis'),
     ('kater_pendulum', 'constraint.hinge={axis: [0, 1, 0], distance: 1, through: [0, 0, 1]}',
      'kater_pendulum.yaml: constraint.hinge.distance: is given together with through'),
     ('heavy_top', 'initial={tilt: 1, euler_zyz: [0, 0, 0]}',
      'heavy_top.yaml: initial.tilt: is given together with euler_zyz')])
def test_a_wrong_turn_gets_one_line(scene, assignment, line):
    with pytest.raises(BadInput) as caught:
        load_scene(scene, [assignment])
    assert str(caught.value).startswith(line)
    assert '\n' not in str(caught.value)


@pytest.mark.parametrize(('scene', 'overrides'),
                         [('heavy_top', ['body.center_of_mass=[0, 0, 0]']),
                          ('kater_pendulum', ['constraint.hinge.through=[0, 0, -0.4]'])])
def test_held_at_its_centre_of_mass_a_body_runs_with_a_note(scene, overrides, capsys):
    assert load_scene(scene).notes == []
    [note] = load_scene(scene, overrides).notes
    assert note.endswith('holds the body at its centre of mass: gravity does nothing there')
    assert simulate.main([
        '--scene', scene, '--set', *overrides, '--duration', '0.1', '--json']) == 0
    said = capsys.readouterr()
    assert note in said.err
    assert '"potential": 0.0' in said.out
    assert describe(load_scene(scene, overrides))['notes'] == [note]


@pytest.mark.parametrize(('fields', 'field', 'weight'), [
    ([], (0.0, 0.0, 0.0), 0.0), (['9.5'], (0.0, 0.0, -9.5), 9.5),
    (['[1, 2, 4]'], (1.0, 2.0, 4.0), None), (['[0, 0, 0.5]'], (0.0, 0.0, 0.5), None),
    (['9.5', '[0, 0, 2]', '1.5'], (0.0, 0.0, -9.0), 9.0),
    (['[1, 2, 4]', '[8, 16, 32]', '[64, 128, 256]'], (73.0, 146.0, 292.0), None),
    (['[1, 2, 4]', '[-1, -2, -9]'], (0.0, 0.0, -5.0), 5.0),
    (['[1, 2, 4]', '[-1, 2, -9]'], (0.0, 4.0, -5.0), None),
    (['[1, 2, 4]', '[1, -2, -9]'], (2.0, 0.0, -5.0), None)])
def test_uniform_fields_add(fields, field, weight):
    """Of effects that ship only gravity is one, and is listed once; others may join it."""
    effects = [effect for one in fields
               for effect in parse_scene(RACKET, [f'effects=[gravity: {{g: {one}}}]']).effects]
    dragged = parse_scene(RACKET, ['effects=[drag: {linear: 1.0}]'])
    scene = dataclasses.replace(dragged, effects=tuple(effects))
    assert scene.field == field
    assert scene.weight == weight
    scene = dataclasses.replace(dragged, effects=(*effects, *dragged.effects))
    assert scene.field == field
    assert scene.weight is None


@pytest.mark.parametrize(('effects', 'classes', 'only'), [
    ('[]', (), True), ('[]', (Drag,), True), ('[drag: {angular: 1}]', (Drag,), True),
    ('[drag: {angular: 1}]', (), False), ('[drag: {angular: 1}]', (Torque,), False),
    ('[drag: {angular: 1}, torque: {value: [1, 0, 0]}]', (Drag,), False),
    ('[drag: {angular: 1}, torque: {value: [1, 0, 0]}]', (Drag, Torque), True),
    # what does nothing does not count
    ('[drag: {angular: 1}, torque: {value: [0, 0, 0]}]', (Drag,), True)])
def test_what_acts_is_all_of_some_classes(effects, classes, only):
    scene = parse_scene('scene: a\nbody: {mass: 1, inertia: [1, 2, 2]}\nconstraint: free\n'
                        f'effects: {effects}\ninitial: {{}}\n')
    assert scene.acts_only(*classes) is only


def test_a_change_elsewhere_leaves_the_very_body():
    scene = changed_scene(load_scene('kater_pendulum'), {'gravity.g': 9.7})
    changed = changed_scene(scene, {'gravity.g': 1.62})
    assert changed.body is scene.body
    assert changed.effects != scene.effects
    assert changed_scene(scene, {'body.mass': 3.0}).body.mass == 3.0
