# SPDX-License-Identifier: Apache-2.0
"""Every number of every scene that ships is a control, and what a control writes is a scene."""

import pytest
import yaml

from rigid_body_sim import load_scene
from rigid_body_sim.scene.scene import parse_scene, scene_names
from rigid_body_sim.view import parameters


@pytest.mark.parametrize('name', scene_names())
def test_every_number_can_be_changed(name):
    scene = load_scene(name)
    entries = list(parameters.numbers(parameters.mapping_of(scene)))
    assert len({parameters.label(path) for path, _ in entries}) == len(entries) > 2
    for path, value in entries:
        text = parameters.changed(scene.text, path, value)
        assert yaml.safe_load(text) == yaml.safe_load(scene.text)


@pytest.mark.parametrize('name', scene_names())
def test_spin_and_tilt_come_back_as_they_were_set(name):
    scene = load_scene(name)
    if scene.body.about_center.moments.count(0.0) == 0:
        # above the other components, so that the spin stays about the same axis
        assert parameters.spin_of(parse_scene(parameters.with_spin(scene, 75.0)))[0] == 75.0
    if scene.constraint.kind != 'table':
        tilted = parse_scene(parameters.with_tilt(scene, 0.3))
        assert parameters.tilt_of(tilted) == pytest.approx(0.3, abs=1e-15)


def scene_of(initial, constraint='free'):
    return parse_scene('scene: s\nbody: {mass: 1, inertia: [1.0, 1.5, 2.0]}\n'
                       f'constraint: {constraint}\neffects: []\ninitial: {{{initial}}}\n')


@pytest.mark.parametrize(('omega', 'spin', 'axis'), [
    ([0.0, -5.0, 0.1], -5.0, 1), ([3.0, 2.0, 1.0], 3.0, 0), ([1.0, 1.0, -4.0], -4.0, 2),
    ([0.0, 0.0, 0.0], 0.0, 2)])
def test_the_spin_is_the_largest_component_and_the_others_stay(omega, spin, axis):
    scene = scene_of(f'angular_velocity: {omega}, tilt: 0.1')
    assert parameters.spin_of(scene) == (spin, axis)
    omega[axis] = 75.0
    other = parse_scene(parameters.with_spin(scene, 75.0)).initial
    assert other.angular_velocity.tolist() == omega
    assert other.orientation.tolist() == scene.initial.orientation.tolist()


def test_a_hinged_body_spins_and_tilts_about_its_axis():
    hinge = '{hinge: {axis: [0, 1, 0]}}'
    scene = scene_of('rate: 3.0, angle: 0.2', hinge)
    assert (parameters.spin_of(scene), parameters.tilt_of(scene)) == ((3.0, None), 0.2)
    assert (parameters.spin_of(scene_of('', hinge))[0],
            parameters.tilt_of(scene_of('', hinge))) == (0.0, 0.0)
    changed = parse_scene(parameters.with_tilt(parse_scene(parameters.with_spin(scene, 4.0)), 0.5))
    assert (parameters.spin_of(changed)[0], parameters.tilt_of(changed)) == (4.0, 0.5)


@pytest.mark.parametrize(('initial', 'tilt'), [
    ('euler_zyz: [0.3, 0.7, 0.2]', 0.7), ('tilt: 2.5', 2.5), ('tilt: 0.0', 0.0),
    ('rotation_vector: [0.3, -0.4, 0.0]', 0.5), ('rotation_vector: [0.0, 0.0, 1.0]', 0.0)])
def test_the_tilt_is_the_angle_from_the_vertical(initial, tilt):
    scene = scene_of(f'{initial}, angular_velocity: [1.0, 2.0, 3.0]')
    assert parameters.tilt_of(scene) == pytest.approx(tilt, abs=1e-15)
    other = parse_scene(parameters.with_tilt(scene, 1.25))
    assert parameters.tilt_of(other) == pytest.approx(1.25, abs=1e-15)
    assert other.initial.angular_velocity.tolist() == [1.0, 2.0, 3.0]
    if 'zyz' in initial:    # the other angles stay
        assert yaml.safe_load(other.text)['initial']['euler_zyz'] == [0.3, 1.25, 0.2]


def test_numbers_have_paths_and_labels_without_the_place_of_their_effect():
    mapping = {'body': {'mass': 2, 'shape': {'on': True}}, 'effects': [
        {'gravity': {'g': 9.81}}, 'drag'], 'list': [1.5, [2.5, 'text']]}
    found = list(parameters.numbers(mapping))
    assert found == [(('body', 'mass'), 2.0), (('effects', 0, 'gravity', 'g'), 9.81),
                     (('list', 0), 1.5), (('list', 1, 0), 2.5)]
    assert [parameters.label(path) for path, _ in found] == [
        'body.mass', 'gravity.g', 'list.0', 'list.1.0']
    assert parameters.label(('effects', 0)) == 'effects.0'
    assert parameters.label(('effects', 0, 'x')) == 'x'
