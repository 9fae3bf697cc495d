# SPDX-License-Identifier: Apache-2.0
"""The examples run as they are shown."""

import pathlib
import re

import pytest
from near import near

pytest.importorskip('rclpy')

EXAMPLE = pathlib.Path(__file__).resolve().parent.parent / 'examples' / 'command_and_listen.py'
NODE = ('-m', 'rigid_body_sim', 'sim_node', '--ros-args', '-p', 'scene:=tennis_racket',
        '-p', 'rate:=200.0', '-p', 'record:=false')


@pytest.mark.parametrize('namespace', ['', '/left'])
def test_the_example_hears_the_body_and_strikes_it(ros_domain, namespace):
    remap = ('-r', f'__ns:={namespace}') if namespace else ()
    with ros_domain.process(*NODE, *remap) as node:
        done = ros_domain.run(EXAMPLE, '--torque', '0', '0', '0.5', '--patience', '60',
                              '--ros-args', *remap, timeout=200)
        assert node.poll() is None
    assert done.returncode == 0, done.stderr
    before, after = done.stdout.split('after the impulse')
    energies = [float(re.search(r'energy +([\d.]+) J', part)[1]) for part in (before, after)]
    assert energies[0] == near(25.0, rel=1e-3)
    assert energies[1] != energies[0]


def test_the_example_says_that_no_node_is_there(ros_domain):
    done = ros_domain.run(EXAMPLE, '--patience', '1')
    assert done.returncode == 1
    [line] = done.stderr.splitlines()
    assert 'is sim_node running' in line
