# SPDX-License-Identifier: Apache-2.0
"""A real browser drags the body of a running node: the push is recorded and runs again.

::

    browser --drag--> view --cmd_wrench--> sim_node --> recording --> resimulate: the same bits
"""

import contextlib
import json
import signal
import time
import types

import numpy as np
import pytest

pytest.importorskip('rclpy')

from rigid_body_sim.recording.reader import Recording
from rigid_body_sim.simulation.command_rows import HOLD, row_of
from rigid_body_sim.view.node_source import NodeSource

START = 200.0
"""Time for a process that imports rclpy and numba on a loaded machine, s."""
SCENE = """
scene: still_ball
body: {mass: 1.0, shape: {solid_sphere: {radius: 0.1}}}
constraint: free
effects: []
initial: {}
"""


def test_commands_in_body_axes_name_the_node_s_body_frame():
    from geometry_msgs.msg import Vector3Stamped
    sent, source = [], NodeSource.__new__(NodeSource)
    source._held = types.SimpleNamespace(publish=sent.append)
    turning = Vector3Stamped()
    turning.header.frame_id = 'left/body'
    source._last = {'angular_velocity': turning}
    for frame in ('body', 'world'):
        source.command(row_of(HOLD, (1.0, 2.0, 3.0), (0.0, 0.0, 0.5), frame))
        assert source._wrench.frame == frame
    assert [message.header.frame_id for message in sent] == ['left/body', '']
    assert sent[0].wrench.force.z == 3.0
    assert sent[0].wrench.torque.z == 0.5


def test_a_push_through_a_node_is_recorded_and_runs_again_to_the_same_bits(
        ros_domain, tmp_path, open_tab, address_of):
    scene = tmp_path / 'still_ball.yaml'
    scene.write_text(SCENE)
    parameters = {'scene': scene, 'rate': 200.0, 'recording.directory': tmp_path,
                  'recording.name': 'pushed'}
    assignments = [word for key, value in parameters.items() for word in ('-p', f'{key}:={value}')]
    arguments = '-m', 'rigid_body_sim', 'sim_node', '--ros-args', *assignments
    with ros_domain.process(*arguments) as node, contextlib.ExitStack() as stack:
        # a page looks for its node for some seconds only, and a loaded machine takes longer
        deadline = time.monotonic() + START
        while not (tmp_path / 'pushed').exists():
            assert node.poll() is None, node.stderr.read()
            assert time.monotonic() < deadline
            time.sleep(0.1)
        view = stack.enter_context(ros_domain.process(
            '-m', 'rigid_body_sim', 'view', '--node', '/sim_node', '--port', '0'))
        tab = open_tab(address_of(view))
        tab.see('still ball')
        tab.see('rad/s')       # frames have come
        tab.drag((270, 250), (340, 215))
        time.sleep(1.0)
        view.send_signal(signal.SIGTERM)
        assert view.wait(30) == 0, view.stderr.read()
        node.send_signal(signal.SIGINT)
        assert node.wait(60) == 0, node.stderr.read()
    assert tab.outside == []
    recording = Recording(tmp_path / 'pushed')
    commands = [command for entry in recording.journal() if entry['kind'] == 'commands'
                for command in entry['commands']]
    pulls = [command for command in commands if any(command['force'])]
    assert len(pulls) > 5 and any(np.linalg.norm(pull['torque']) > 0.0 for pull in pulls)
    assert commands[-1]['force'] == [0.0, 0.0, 0.0]        # it let go
    done = ros_domain.run('-m', 'rigid_body_sim', 'resimulate', tmp_path / 'pushed', '--json')
    assert done.returncode == 0, done.stdout + done.stderr
    [body] = json.loads(done.stdout)['bodies']
    assert body['identical']
