# SPDX-License-Identifier: Apache-2.0
"""Messages of a tick, decoded by the message classes of ROS, hold the numbers of the state."""

import importlib
import math

import numpy as np
import pytest
from near import near
from rclpy.serialization import deserialize_message

from rigid_body_sim.drawing.body import drawing_of
from rigid_body_sim.errors import BadInput
from rigid_body_sim.messages import cdr, definitions, state_topics
from rigid_body_sim.messages.tick_messages import TickMessages
from rigid_body_sim.numerics.rotations import from_rotation_vector, multiply
from rigid_body_sim.scene.scene import load_scene
from rigid_body_sim.scene.state import STATE_SIZE, State, States

STAMP = 1_795_263_252_907_662_526
FRAMES = state_topics.Frames('map', 'racket', '')
STATE = State.of(
    2.5, from_rotation_vector(0.3, -1.1, 2.0), (0.1, 0.2, -0.3), (4.0, 5.0, 6.0), (-7.0, 8.0, 9.0))


def ros(kind, data):
    package, _, name = kind.split('/')
    return deserialize_message(data, getattr(importlib.import_module(f'{package}.msg'), name))


def messages(scene, *names, moments=(STATE,), stamp=STAMP):
    """Return the messages of the last of some states, by name, decoded by ROS."""
    outputs = [state_topics.OUTPUTS[name] for name in names]
    made = TickMessages(outputs, load_scene(scene) if isinstance(scene, str) else scene, FRAMES)
    for state in moments:
        [data] = made.messages(state.vector[None], [0.1], [0.2], [stamp])
    assert [len(one) for one in data] == made.sizes
    return [ros(output.type, one) for output, one in zip(outputs, data, strict=True)]


def seconds(stamp):
    return stamp.sec * 10**9 + stamp.nanosec


def values(vector):
    return [getattr(vector, name) for name in 'xyzw' if hasattr(vector, name)]


def test_topics_of_every_tick():
    pose, spin, energy, square = messages(
        'free_body', *(output.name for output in state_topics.EVERY_TICK))
    assert (seconds(pose.header.stamp), pose.header.frame_id) == (STAMP, 'map')
    assert (seconds(spin.header.stamp), spin.header.frame_id) == (STAMP, 'racket')
    assert values(pose.pose.position) == STATE.position.tolist()
    assert values(pose.pose.orientation) == STATE.orientation.tolist()
    assert values(spin.vector) == STATE.angular_velocity.tolist()
    assert (energy.data, square.data) == (0.1, 0.2)


def random_states(count):
    """Return States, energies, squares and stamps with no two numbers alike."""
    random = np.random.default_rng(1)
    states = States(random.normal(size=(count, STATE_SIZE)))
    states.orientation[:] /= np.linalg.norm(states.orientation, axis=1)[:, np.newaxis]
    return states, *random.normal(size=(2, count)), random.integers(0, 2 * 10**18, count)


SCENES = {'joint_states': 'kater_pendulum', 'reaction': 'heavy_top'}
EVERY_TOPIC = pytest.mark.parametrize('name', list(state_topics.OUTPUTS))


@EVERY_TOPIC
def test_a_message_is_what_the_encoder_makes(name):
    output, scene = state_topics.OUTPUTS[name], load_scene(SCENES.get(name, 'free_body'))
    states, energies, squares, stamps = random_states(1)
    [[data]] = TickMessages([output], scene, FRAMES).messages(
        states.vector, energies, squares, stamps)
    values = cdr.decode(definitions.schema(output.type), output.type, data)
    assert cdr.encode(output.type, values) == data


@EVERY_TOPIC
def test_many_at_once_are_the_same_bytes_as_one_by_one(name):
    outputs, scene = ([*state_topics.EVERY_TICK, state_topics.OUTPUTS[name]],
                      load_scene(SCENES.get(name, 'free_body')))
    made = TickMessages(outputs, scene, FRAMES)
    states, energies, squares, stamps = random_states(5)
    ticks = made.messages(states.vector, energies, squares, stamps)
    assert ticks == [made.messages(states.vector[k:k + 1], energies[k:k + 1], squares[k:k + 1],
                                   stamps[k:k + 1])[0]
                     for k in range(5)]
    columns = made.columns(states.vector, energies, squares, stamps)
    assert [(column.dtype, column.shape) for column in columns] == [(np.uint8, (5, size))
                                                                    for size in made.sizes]
    assert [[column[k].tobytes() for column in columns] for k in range(5)] == ticks


def test_odometry_has_its_twist_in_body_axes():
    quarter = State.of(0.0, from_rotation_vector(0.0, 0.0, math.pi / 2), (0.1, 0.2, 0.3),
                       (1.0, 2.0, 3.0), (5.0, 0.0, 0.0))
    [odometry] = messages('free_body', 'odom', moments=[quarter])
    assert (odometry.header.frame_id, odometry.child_frame_id) == ('map', 'racket')
    np.testing.assert_allclose(values(odometry.twist.twist.linear), [0.0, -5.0, 0.0], atol=1e-15)
    assert values(odometry.twist.twist.angular) == [0.1, 0.2, 0.3]
    assert values(odometry.pose.pose.position) == [1.0, 2.0, 3.0]


def test_imu_measures_what_holds_the_body_up():
    """A top stands on its point, so the origin does not accelerate and g is felt upwards.

    Upwards is -x here, of a body turned by 90 degrees about y.
    """
    upset = from_rotation_vector(0.0, math.pi / 2, 0.0)
    [imu] = messages('heavy_top', 'imu', moments=[State.of(0.0, upset)])
    np.testing.assert_allclose(values(imu.linear_acceleration), [-9.81, 0.0, 0.0], atol=1e-14)
    assert imu.linear_acceleration_covariance[0] == imu.orientation_covariance[0] == 0.0
    assert imu.header.frame_id == 'racket'


def test_imu_of_a_held_body_measures_a_skew_field_reversed():
    scene = load_scene('heavy_top', ['effects=[gravity: {g: [1.0, 2.0, -9.0]}]'])
    [imu] = messages(scene, 'imu', moments=[State.of(0.0)])
    np.testing.assert_allclose(values(imu.linear_acceleration), [-1.0, -2.0, 9.0], atol=1e-14)


def test_imu_in_free_fall_measures_nothing_and_on_the_table_the_weight():
    thrown = load_scene('free_body', ['effects=[gravity: {g: 9.81}]'])
    [imu] = messages(thrown, 'imu', moments=[State.of(0.5, velocity=(1.0, 0.0, -4.9))])
    assert values(imu.linear_acceleration) == [0.0, 0.0, 0.0]
    ball = load_scene('billiard_center')
    friction = ball.effect('sliding_friction')
    [imu] = messages(ball, 'imu', moments=[State.of(0.0, velocity=(2.0, 0.0, 0.0))])
    np.testing.assert_allclose(
        values(imu.linear_acceleration), [-friction.mu * friction.g, 0.0, friction.g], rtol=1e-15)


def test_reaction_of_a_top_that_hangs_at_rest_is_its_weight():
    hanging = from_rotation_vector(math.pi, 0.0, 0.0)
    scene = load_scene('heavy_top')
    [reaction] = messages(scene, 'reaction', moments=[State.of(0.0, hanging)])
    np.testing.assert_allclose(
        values(reaction.wrench.force), [0.0, 0.0, 9.81 * scene.body.mass], atol=1e-14)
    assert values(reaction.wrench.torque) == [0.0, 0.0, 0.0]
    assert reaction.header.frame_id == 'map'
    with pytest.raises(BadInput, match='nothing holds a free body'):
        messages('free_body', 'reaction')


@pytest.mark.parametrize('angle', [0.3, 2.9, 3.3, 6.0, -3.3, -6.0])
def test_joint_state_counts_the_angle_as_the_scene_does(angle):
    start = 0.1
    scene = load_scene('kater_pendulum', [f'initial.angle={start}'])
    axis = np.array(scene.constraint.axis)
    turned = from_rotation_vector(*((angle - start) * axis))
    made = TickMessages([state_topics.OUTPUTS['joint_states']], scene, FRAMES)
    vector = State.of(1.0, multiply(*scene.initial.orientation, *turned), 0.7 * axis).vector
    [[data]] = made.messages(vector[None], [0.1], [0.2], [STAMP])
    joint = ros('sensor_msgs/msg/JointState', data)
    assert list(joint.name) == ['hinge']
    assert joint.position[0] == pytest.approx(angle, abs=1e-14)
    assert joint.velocity[0] == pytest.approx(0.7, abs=1e-15)


def test_joint_state_of_a_skew_hinge_that_starts_from_zero():
    """A turn by 0.3 rad about the axis, of a body that stood at 0."""
    scene = load_scene('kater_pendulum', [
        'constraint.hinge={axis: [2, 3, 6], through: [0, 0, 0]}', 'initial={rate: 1.0}'])
    axis = np.array([2.0, 3.0, 6.0]) / 7.0
    turned = State.of(0.0, multiply(*scene.initial.orientation, *from_rotation_vector(
        *(0.3 * axis))), 0.7 * axis)
    [joint] = messages(scene, 'joint_states', moments=[turned])
    assert joint.position[0] == pytest.approx(0.3, abs=1e-15)
    later = load_scene('kater_pendulum', [
        'constraint.hinge={axis: [2, 3, 6], through: [0, 0, 0]}', 'initial={angle: 0.8}'])
    [joint] = messages(later, 'joint_states', moments=[State.of(0.0, from_rotation_vector(
        *(1.1 * axis)), 0.7 * axis)])
    assert joint.position[0] == pytest.approx(1.1, abs=1e-15)


def test_joint_states_of_a_free_body_are_refused():
    with pytest.raises(BadInput, match='only a hinge is a joint'):
        messages('free_body', 'joint_states')


def test_marker_of_a_body_without_a_shape_is_a_box_with_its_moments():
    [marker] = messages('free_body', 'marker')
    x, y, z = values(marker.scale)
    body = load_scene('free_body').body
    assert (np.array([y * y + z * z, x * x + z * z, x * x + y * y]) * body.mass / 12.0
            == near(body.about_center.moments, rel=1e-12))
    assert values(marker.pose.orientation) == STATE.orientation.tolist()
    assert (marker.type, marker.action, marker.color.a) == (1, 0, 1.0)


def test_marker_of_a_body_without_a_shape_stands_at_its_centre_of_mass():
    """The body is turned by 90 degrees about z, so x becomes y and y becomes -x."""
    scene = load_scene('free_body', ['body={mass: 1.0, inertia: [2.0, 3.0, 4.0], '
                                     'center_of_mass: [1.0, 2.0, 3.0]}'])
    turned = State.of(0.0, from_rotation_vector(0.0, 0.0, math.pi / 2),
                      position=(10.0, 20.0, 30.0))
    [marker] = messages(scene, 'marker', moments=[turned])
    np.testing.assert_allclose(values(marker.pose.position), [8.0, 21.0, 33.0], rtol=1e-15)


PARTS = ['constraint=free', 'effects=[]',
         'body={parts: [{mass: 1.0, shape: {rod: {length: 1.0}}}, '
         '{mass: 2.0, shape: {box: {size: [0.2, 0.1, 0.3]}}, at: [0, 0, 0.5]}]}']


@pytest.mark.parametrize(('shape', 'kind', 'scale'),
                         [('solid_sphere: {radius: 0.25}', 2, [0.5, 0.5, 0.5]),
                          ('box: {size: [1, 2, 3]}', 1, [1.0, 2.0, 3.0]),
                          ('ellipsoid: {semi_axes: [1, 2, 3]}', 2, [2.0, 4.0, 6.0]),
                          ('cylinder: {radius: 0.5, length: 3}', 3, [1.0, 1.0, 3.0])])
def test_marker_of_a_solid_is_the_primitive_at_the_centre_of_mass(shape, kind, scale):
    scene = load_scene('free_body', [f'body={{mass: 1.0, shape: {{{shape}}}}}'])
    [marker] = messages(scene, 'marker')
    assert (marker.type, values(marker.scale)) == (kind, scale)
    assert values(marker.pose.position) == STATE.position.tolist()


@pytest.mark.parametrize(
    'overrides', [['body={mass: 1.0, shape: {torus: {radius: 0.5, tube: 0.1}}}'], PARTS])
def test_marker_of_any_other_shape_is_its_surface_in_triangles(overrides):
    scene = load_scene('free_body', overrides)
    [marker] = messages(scene, 'marker')
    surfaces = drawing_of(scene).surfaces
    assert marker.type == 11
    assert (len(marker.points) == len(marker.colors)
            == 3 * sum(len(surface.faces) for surface in surfaces))
    corner = surfaces[0].vertices[surfaces[0].faces[0, 0]]
    assert values(marker.points[0]) == corner.tolist()
    # the points are in body axes
    assert values(marker.pose.position) == STATE.position.tolist()
    assert values(marker.pose.orientation) == STATE.orientation.tolist()


def test_paced_outputs_are_apart_from_those_of_every_tick():
    outputs = state_topics.chosen(['tf', 'odom', 'marker'])
    assert [output.name for output in outputs.paced] == ['marker', 'tf']
    assert [output.name for output in outputs.ticking][-1] == 'odom'
    assert state_topics.scene_messages(
        state_topics.chosen([]), load_scene('free_body'), FRAMES).paced is None


def test_names_outside_the_namespace_and_topics_with_a_rate_of_their_own():
    outputs = state_topics.OUTPUTS.values()
    assert [output.name for output in outputs if output.absolute] == ['tf', 'clock']
    assert [output.name for output in outputs if output.paced] == ['marker', 'tf']
    assert state_topics.DISPLAY_RATE == 30.0


def test_clock_is_the_stamp():
    [clock] = messages('free_body', 'clock')
    assert seconds(clock.clock) == STAMP


def test_transform_is_the_pose():
    """The wheels have no class for tf2_msgs, so our own codec decodes it."""
    kind = 'tf2_msgs/msg/TFMessage'
    made = TickMessages([state_topics.OUTPUTS['energy'], state_topics.OUTPUTS['tf']],
                        load_scene('free_body'), FRAMES)
    [[_, data]] = made.messages(STATE.vector[None], [0.1], [0.2], [STAMP])
    [transform] = cdr.decode(definitions.schema(kind), kind, data)['transforms']
    assert transform['header'] == {
        'stamp': {'sec': STAMP // 10**9, 'nanosec': STAMP % 10**9}, 'frame_id': 'map'}
    assert transform['child_frame_id'] == 'racket'
    assert list(transform['transform']['translation'].values()) == STATE.position.tolist()
    assert list(transform['transform']['rotation'].values()) == STATE.orientation.tolist()


@pytest.mark.parametrize('scene', ['tennis_racket', 'kater_pendulum_from_p'])
def test_bytes_of_a_topic_are_the_same_whatever_else_is_published(scene):
    """All numbers of a tick stand in one row: no topic writes where another one reads."""
    scene, alone, outputs = load_scene(scene), [], []
    for output in state_topics.OUTPUTS.values():
        try:
            made = TickMessages([output], scene, FRAMES)
        except BadInput:    # it has no meaning for the scene
            continue
        outputs.append(output)
        alone += made.messages(STATE.vector[None], [0.1], [0.2], [STAMP])[0]
    assert len(outputs) > 8
    for several in (outputs, outputs[::-1]):
        [together] = TickMessages(several, scene, FRAMES).messages(
            STATE.vector[None], [0.1], [0.2], [STAMP])
        assert dict(zip([one.name for one in several], together, strict=True)) == dict(
            zip([one.name for one in outputs], alone, strict=True))
