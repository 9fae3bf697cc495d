# SPDX-License-Identifier: Apache-2.0
"""The URDF of a scene has the links, the joint and the inertia of the scene."""

import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest
from near import near
from scipy.spatial.transform import Rotation

from rigid_body_sim.messages.robot_description import urdf
from rigid_body_sim.messages.state_topics import Frames
from rigid_body_sim.scene.scene import load_scene
from rigid_body_sim.simulation.simulation import Simulation

FRAMES = Frames('left/map', 'left/racket', 'left/')


def robot(scene, *overrides):
    return ElementTree.fromstring(urdf(load_scene(scene, list(overrides)), FRAMES))


def numbers(element, name):
    return [float(word) for word in element.get(name).split()]


def place(joint):
    """Return rotation and translation of a joint's origin."""
    origin = joint.find('origin')
    return Rotation.from_euler('xyz', numbers(origin, 'rpy')), np.array(numbers(origin, 'xyz'))


def test_a_free_body_floats_and_has_the_mass_and_the_tensor_of_the_scene():
    found, body = robot('tennis_racket'), load_scene('tennis_racket').body
    assert [link.get('name') for link in found.iter('link')] == ['left/map', 'left/racket']
    [joint] = found.iter('joint')
    assert joint.get('type') == 'floating'
    [inertia] = found.iter('inertia')
    tensor = body.about_center.matrix
    assert [float(inertia.get(name)) for name in ('ixx', 'iyy', 'izz', 'ixy')] == [
        *np.diag(tensor), tensor[0][1]]
    assert float(found.find('.//mass').get('value')) == body.mass


def test_the_inertia_has_all_six_moments_about_the_centre_of_mass():
    link = robot('free_body', 'body={mass: 12.0, inertia: [[4, 1, 0.5], [1, 5, 0.25], '
                              '[0.5, 0.25, 6]], center_of_mass: [1, -0.0, 3]}')
    found = link.find('.//inertial')
    assert found.find('origin').attrib == {'xyz': '1.0 0.0 3.0', 'rpy': '0.0 0.0 0.0'}
    six = {name: float(value) for name, value in found.find('inertia').items()}
    assert six == pytest.approx({'ixx': 4.0, 'ixy': 1.0, 'ixz': 0.5, 'iyy': 5.0, 'iyz': 0.25,
                                 'izz': 6.0}, abs=1e-14)    # 9e-16


@pytest.mark.parametrize(('angle', 'overrides'), [
    (0.4, ['initial.angle=0.4']), (0.0, ['initial={rate: 0.5}']),
    (0.4, ['initial.angle=0.4',
           'constraint.hinge={axis: [0, 0, 1], through: [0.1, 0.0, 0.3]}'])])
def test_a_hinge_at_its_angle_puts_the_body_where_the_simulation_has_it(angle, overrides):
    """The chain of world, hinge and body gives the position and the attitude of the state."""
    scene = load_scene('kater_pendulum', overrides)
    found = ElementTree.fromstring(urdf(scene, FRAMES))
    hinge, fixed = found.iter('joint')
    assert (hinge.get('name'), hinge.get('type'), fixed.get('type')) == (
        'left/hinge', 'continuous', 'fixed')
    simulation, axis = Simulation(scene), np.array(numbers(hinge.find('axis'), 'xyz'))
    (unturned, at), (of_body, offset) = place(hinge), place(fixed)
    assert of_body.magnitude() == 0.0
    for time in (0.0, 0.31):
        [state] = [simulation.states([time])[0]]
        start = Rotation.from_quat(scene.initial.orientation)
        turned = (start.inv() * Rotation.from_quat(state.orientation)).as_rotvec() @ axis
        attitude = unturned * Rotation.from_rotvec((angle + turned) * axis)
        np.testing.assert_allclose(
            (attitude.inv() * Rotation.from_quat(state.orientation)).magnitude(), 0.0, atol=1e-12)
        np.testing.assert_allclose(at + attitude.apply(offset), state.position, atol=1e-12)


@pytest.mark.parametrize(
    ('body', 'tags'),
    [('{mass: 1.0, shape: {solid_sphere: {radius: 0.1}}}', ['sphere']),
     ('{mass: 1.0, shape: {cylinder: {radius: 0.1, length: 1}}}', ['cylinder']),
     ('{mass: 1.0, shape: {torus: {radius: 0.5, tube: 0.1}}}', ['box']),
     ('{parts: [{mass: 1.0, shape: {rod: {length: 1.0}}}, '
      '{mass: 2.0, shape: {box: {size: [1, 2, 3]}}, at: [0, 0, 1]}]}',
      ['cylinder', 'box'])])
def test_what_is_seen_is_the_true_shape_where_urdf_has_it(body, tags):
    found = robot('free_body', f'body={body}')
    assert [geometry[0].tag for geometry in found.iter('geometry')] == tags


VISUALS = """
    <visual>
      <origin xyz="1.0 0.0 0.5" rpy="0.0 0.0 1.2870022175865687" />
      <geometry>
        <box size="1.0 2.0 3.0" />
      </geometry>
    </visual>
    <visual>
      <origin xyz="0.0 0.0 0.0" rpy="0.0 0.0 0.0" />
      <geometry>
        <cylinder radius="0.1" length="1.0" />
      </geometry>
    </visual>
    <visual>
      <origin xyz="0.0 1.0 2.0" rpy="0.0 0.0 0.0" />
      <geometry>
        <sphere radius="0.2" />
      </geometry>
    </visual>
    <visual>
      <origin xyz="0.0 0.0 0.0" rpy="0.0 0.0 0.0" />
      <geometry>
        <cylinder radius="0.5" length="0.01" />
      </geometry>
      <material name="surface">
        <color rgba="0.2 0.5 0.9 0.35" />
      </material>
    </visual>
"""


def test_of_a_composite_each_solid_stands_in_its_place_and_a_surface_around_it_is_translucent():
    text = urdf(load_scene('free_body', [
        'body={surface: {disk: {radius: 0.5}}, parts: [{mass: 2.0, shape: {box: '
        '{size: [1, 2, 3]}}, at: [1, 0, 0.5], orientation: [0, 0, 0.6, 0.8]}, '
        '{mass: 1.0, shape: {cylinder: {radius: 0.1, length: 1.0}}}, '
        '{mass: 3.0, shape: {solid_sphere: {radius: 0.2}}, at: [0, 1, 2]}]}']), FRAMES)
    assert text[text.index('\n    <visual>'):text.index('  </link>\n</robot>')] == VISUALS


@pytest.mark.parametrize(('body', 'edges'), [
    ('{mass: 12.0, inertia: [4, 9, 13]}', (3.0, 2.0, 0.06)),
    ('{mass: 15.0, shape: {ellipsoid: {semi_axes: [1, 2, 3]}}}',
     (12.0**0.5 / 5.0**0.5, 48.0**0.5 / 5.0**0.5, 108.0**0.5 / 5.0**0.5)),
    ('{parts: [{mass: 1.0, shape: {box: {size: [1, 2, 3]}}}, '
     '{mass: 2.0, shape: {ellipsoid: {semi_axes: '
     '[0.6454972243679028, 1.2909944487358056, 1.9364916731037085]}}}]}', (1.0, 2.0, 3.0))])
def test_what_urdf_does_not_have_is_a_box_of_equal_inertia(body, edges):
    """An ellipsoid has the moments of a box of edges 2 a sqrt(3 / 5).

    A lamina is 2 % of its longest edge thick.
    """
    [geometry] = robot('free_body', f'body={body}').iter('geometry')
    assert geometry[0].tag == 'box'
    assert numbers(geometry[0], 'size') == near(edges, rel=1e-12)
