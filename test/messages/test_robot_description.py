# SPDX-License-Identifier: Apache-2.0
"""The URDF of a scene has the links, the joint and the inertia of the scene."""

import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest
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


@pytest.mark.parametrize(
    'overrides', [[], ['constraint.hinge={axis: [0, 0, 1], through: [0.1, 0.0, 0.3]}']])
def test_a_hinge_at_its_angle_puts_the_body_where_the_simulation_has_it(overrides):
    """The chain of world, hinge and body gives the position and the attitude of the state."""
    scene = load_scene('kater_pendulum', ['initial.angle=0.4', *overrides])
    found = ElementTree.fromstring(urdf(scene, FRAMES))
    hinge, fixed = found.iter('joint')
    assert (hinge.get('name'), hinge.get('type'), fixed.get('type')) == (
        'left/hinge', 'continuous', 'fixed')
    simulation, axis = Simulation(scene), np.array(numbers(hinge.find('axis'), 'xyz'))
    (unturned, at), (_, offset) = place(hinge), place(fixed)
    for time in (0.0, 0.31):
        [state] = [simulation.states([time])[0]]
        start = Rotation.from_quat(scene.initial.orientation)
        turned = (start.inv() * Rotation.from_quat(state.orientation)).as_rotvec() @ axis
        attitude = unturned * Rotation.from_rotvec((0.4 + turned) * axis)
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
