# SPDX-License-Identifier: Apache-2.0
"""The body as a robot: the URDF text of a scene, for RViz and robot_state_publisher.

The links have the names of the frames. A hinge is a continuous joint with the name and the angle
of ``joint_states``; any other body has a floating joint, whose place ``tf`` gives.
"""

import xml.etree.ElementTree as ElementTree

import numpy as np
import yaml

from rigid_body_sim.drawing.body import THINNEST, box_of
from rigid_body_sim.messages import cdr
from rigid_body_sim.messages.marker import CLEAR, COLOUR
from rigid_body_sim.messages.shapes import BOX, SPHERE, equal_box, solids_of
from rigid_body_sim.scene.constraints.protocol import Mechanism

TOPIC = 'robot_description'
TYPE = 'std_msgs/msg/String'


def message(scene, frames) -> bytes:
    """Return the bytes of the message ``robot_description``."""
    return cdr.encode(TYPE, {'data': urdf(scene, frames)})


def urdf(scene, frames) -> str:
    """Return the URDF text of a scene."""
    robot = ElementTree.Element('robot', name=scene.name)
    ElementTree.SubElement(robot, 'link', name=frames.world)
    if scene.constraint.mechanism is Mechanism.AXIS:
        _hinge(robot, scene, frames)
    else:
        _joint(robot, f'{frames.body}_joint', 'floating', frames.world, frames.body)
    link = ElementTree.SubElement(robot, 'link', name=frames.body)
    _inertial(link, scene.body)
    for solid in _solids(scene):
        visual = ElementTree.SubElement(link, 'visual')
        _origin(visual, solid.at, solid.orientation)
        geometry = ElementTree.SubElement(visual, 'geometry')
        if solid.kind == BOX:
            ElementTree.SubElement(geometry, 'box', size=_numbers(solid.size))
        elif solid.kind == SPHERE:
            ElementTree.SubElement(geometry, 'sphere', radius=repr(0.5 * solid.size[0]))
        else:
            ElementTree.SubElement(
                geometry, 'cylinder', radius=repr(0.5 * solid.size[0]), length=repr(solid.size[2]))
        if solid.clear:
            material = ElementTree.SubElement(visual, 'material', name='surface')
            rgba = [*(COLOUR[key] for key in 'rgb'), CLEAR]
            ElementTree.SubElement(material, 'color', rgba=_numbers(rgba))
    ElementTree.indent(robot)
    return ElementTree.tostring(robot, encoding='unicode') + '\n'


def _solids(scene):
    """Return the solids of the visual: the true shape if URDF has them, otherwise a box."""
    solids = solids_of(scene)
    if solids and all(one.kind != SPHERE or len(set(one.size)) == 1 for one in solids):
        return solids
    edges = np.array(box_of(scene.body))
    return [equal_box(scene, tuple(np.maximum(edges, THINNEST * edges.max()).tolist()))]


def _hinge(robot, scene, frames):
    """Add the hinge: a joint at the held point, and the origin at a fixed place from there."""
    from scipy.spatial.transform import Rotation  # here, as in _roll_pitch_yaw
    axis = np.array(scene.constraint.axis)
    through = np.array(scene.constraint.point(scene.body))
    start = yaml.safe_load(scene.text)['initial'].get('angle', 0.0)
    attitude = Rotation.from_quat(scene.initial.orientation)
    place = scene.initial.position + attitude.apply(through)
    unturned = attitude * Rotation.from_rotvec(-start * axis)
    turning = f'{frames.prefix}hinge_link'
    ElementTree.SubElement(robot, 'link', name=turning)
    joint = _joint(robot, f'{frames.prefix}hinge', 'continuous', frames.world, turning)
    _origin(joint, place, unturned.as_quat())
    ElementTree.SubElement(joint, 'axis', xyz=_numbers(axis))
    _origin(_joint(robot, f'{frames.body}_joint', 'fixed', turning, frames.body), -through,
            (0.0, 0.0, 0.0, 1.0))


def _joint(robot, name, kind, parent, child):
    joint = ElementTree.SubElement(robot, 'joint', name=name, type=kind)
    ElementTree.SubElement(joint, 'parent', link=parent)
    ElementTree.SubElement(joint, 'child', link=child)
    return joint


def _inertial(link, body):
    inertial = ElementTree.SubElement(link, 'inertial')
    _origin(inertial, body.center_of_mass, (0.0, 0.0, 0.0, 1.0))
    ElementTree.SubElement(inertial, 'mass', value=repr(float(body.mass)))
    tensor = np.asarray(body.about_center.matrix, float)
    names = {
        'ixx': (0, 0),
        'ixy': (0, 1),
        'ixz': (0, 2),
        'iyy': (1, 1),
        'iyz': (1, 2),
        'izz': (2, 2),
    }
    ElementTree.SubElement(
        inertial, 'inertia', {name: repr(float(tensor[place])) for name, place in names.items()})


def _origin(element, at, orientation):
    turn = _roll_pitch_yaw(orientation)
    ElementTree.SubElement(element, 'origin', xyz=_numbers(at), rpy=_numbers(turn))


def _roll_pitch_yaw(orientation):
    if not any(orientation[:3]):
        return 0.0, 0.0, 0.0
    # to import it takes a fifth of what a node needs to start, and few scenes have turned parts
    from scipy.spatial.transform import Rotation
    return Rotation.from_quat(orientation).as_euler('xyz')


def _numbers(values):
    return ' '.join(repr(float(value) + 0.0) for value in values)
