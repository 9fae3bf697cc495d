# SPDX-License-Identifier: Apache-2.0
"""Fixtures of all tests."""

import os
import signal

import pytest
import ros

os.environ.update(ros.SETTINGS)
# a shell that starts the tests with & leaves SIGINT ignored, and nohup SIGHUP; processes inherit
# that
for number, usual in (
        (signal.SIGINT, signal.default_int_handler), (signal.SIGHUP, signal.SIG_DFL)):
    if signal.getsignal(number) == signal.SIG_IGN:
        signal.signal(number, usual)


@pytest.fixture
def ros_domain(tmp_path, monkeypatch):
    """Yield a ros.Domain for this test alone.

    This process is in it too, so ``rclpy.init()`` needs no argument.
    """
    with ros.held_domain(tmp_path / 'ros_log') as domain:
        monkeypatch.setenv('ROS_DOMAIN_ID', str(domain.id))
        monkeypatch.setenv('ROS_LOG_DIR', domain.environment['ROS_LOG_DIR'])
        yield domain
