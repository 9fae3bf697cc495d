# SPDX-License-Identifier: Apache-2.0
"""A real browser drags the body of a running node: the push is recorded and runs again.

::

    browser --drag--> view --cmd_wrench--> sim_node --> recording --> resimulate: the same bits
"""

import contextlib
import itertools
import json
import os
import signal
import time
import types

import numpy as np
import pytest
from soak import IN_SOAK

pytest.importorskip('rclpy')

from rigid_body_sim.recording.reader import Recording
from rigid_body_sim.simulation.command_rows import HOLD, row_of
from rigid_body_sim.view import node_source
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
    source._last, source._asked = {'angular_velocity': turning}, True
    for frame in ('body', 'world'):
        source.command(row_of(HOLD, (1.0, 2.0, 3.0), (0.0, 0.0, 0.5), frame))
        assert source._wrench.frame == frame
    assert [message.header.frame_id for message in sent] == ['left/body', '']
    assert sent[0].wrench.force.z == 3.0
    assert sent[0].wrench.torque.z == 0.5


def test_a_page_says_that_its_node_is_gone(monkeypatch):
    """A node that had ended looked as if its body had come to rest."""
    clock, publishers = [100.0], [1]
    monkeypatch.setattr(node_source.time, 'monotonic', lambda: clock[0])
    source = NodeSource.__new__(NodeSource)
    source._name, source.messages, source._heard, source._gone = '/sim_node', [], 100.0, False
    source._subscriptions = {'scene': types.SimpleNamespace(topic_name='/scene')}
    source._node = types.SimpleNamespace(count_publishers=lambda topic: publishers[0])

    def later(fresh=False):
        clock[0] += 2.0 * node_source.GONE_AFTER
        source._miss(fresh)
        return len(source.messages)
    assert later() == 0    # a node that is paused is there
    publishers[0] = 0
    assert later() == later() == 1
    assert '/sim_node is gone' in source.messages[0]
    assert later(fresh=True) == 1
    assert later() == 2


def pulled(tab, scene, wanted):
    """Wait until a page shows whether a force acts on the body; one that rolls shows nothing."""
    if scene == 'still_ball':
        tab.cell('0 N').wait_for(state='detached' if wanted else 'attached',
                                 timeout=1000.0 * START)
    else:
        time.sleep(2.0)


@IN_SOAK
@pytest.mark.parametrize('scene', ['still_ball', 'rolling_disk'])
def test_a_push_through_a_node_is_recorded_and_runs_again_to_the_same_bits(
        scene, ros_domain, tmp_path, other_chromium, open_tab, address_of):
    """One page drags and lets go, a browser is killed while it drags, and then the page itself."""
    (tmp_path / 'still_ball.yaml').write_text(SCENE)
    file = tmp_path / 'still_ball.yaml' if scene == 'still_ball' else scene
    parameters = {'scene': file, 'rate': 200.0, 'recording.directory': tmp_path,
                  'recording.name': 'pushed', 'command_timeout': 0.5}
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
        address = address_of(view)
        tab = open_tab(address)
        tab.see('rad/s')       # snapshots have come
        tab.drag((270, 250), (340, 215))
        pulled(tab, scene, False)
        browser, number = other_chromium
        second = open_tab(address, browser)
        second.see('rad/s')
        time.sleep(1.0)        # the body glides back into the middle
        second.grab((270, 250), (340, 215))
        pulled(tab, scene, True)
        os.kill(number, signal.SIGKILL)
        pulled(tab, scene, False)
        tab.grab((270, 250), (340, 215))
        pulled(tab, scene, True)
        view.kill()
        time.sleep(3.0)        # the timeout of the node
        node.send_signal(signal.SIGINT)
        assert node.wait(60) == 0, node.stderr.read()
    assert tab.outside == second.outside == []
    recording = Recording(tmp_path / 'pushed')
    entries = [entry for entry in recording.journal() if entry['kind'] == 'commands']
    commands = [command for entry in entries for command in entry['commands']]
    pulls = [command for command in commands if any(command['force'])]
    assert len(pulls) > 5 and any(np.linalg.norm(pull['torque']) > 0.0 for pull in pulls)
    # three times something let go: the mouse, the page of the dead browser, the node's timeout
    held = [any(command.get('force', ())) for command in commands]
    assert sum(one and not later for one, later in itertools.pairwise(held)) == 3
    assert not held[-1]
    done = ros_domain.run('-m', 'rigid_body_sim', 'resimulate', tmp_path / 'pushed', '--json')
    assert done.returncode == 0, done.stdout + done.stderr
    [body] = json.loads(done.stdout)['bodies']
    assert body['identical']
