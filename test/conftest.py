# SPDX-License-Identifier: Apache-2.0
"""Fixtures of all tests."""

import os
import signal
import subprocess
import sys

import pytest
import ros

from rigid_body_sim.compilation.jit import HAVE_NUMBA

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


@pytest.hookimpl(tryfirst=True)
def pytest_pyfunc_call(pyfuncitem):
    """Run a test marked `without_numba` in a process of its own that does not compile.

    It runs a kind of scene for a second or less: plain Python takes less than compiling it would,
    and gives the same bits (test_digests.py).
    """
    if not HAVE_NUMBA or pyfuncitem.get_closest_marker('without_numba') is None:
        return None
    command = [sys.executable, '-m', 'pytest', '-q', '-p', 'no:cacheprovider', '-p', 'no:xdist',
               pyfuncitem.nodeid]
    done = subprocess.run(command, cwd=pyfuncitem.config.rootpath, capture_output=True, text=True,
                          timeout=280, env=os.environ | {'NUMBA_DISABLE_JIT': '1'})
    if done.returncode:
        pytest.fail(done.stdout + done.stderr, pytrace=False)
    return True
