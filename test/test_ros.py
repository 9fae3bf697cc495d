# SPDX-License-Identifier: Apache-2.0
"""The helper of the tests on ROS: no two share a domain, no process outlives its test."""

import os
import pathlib
import select
import subprocess
import sys

import pytest
import ros


def test_two_tests_never_hold_one_domain(tmp_path):
    with ros.held_domain(tmp_path) as first, ros.held_domain(tmp_path) as second:
        assert first.id != second.id
        assert {first.id, second.id} <= set(range(1, 102))


@pytest.fixture
def one_domain(monkeypatch):
    """Leave only one id to hold, which no other test run uses."""
    only = 1000 + os.getpid()
    monkeypatch.setattr(ros, 'FIRST_DOMAIN', only)
    monkeypatch.setattr(ros, 'LAST_DOMAIN', only)
    return only


@pytest.mark.usefixtures('one_domain')
def test_all_domains_held_is_said(tmp_path):
    with ros.held_domain(tmp_path), pytest.raises(
            RuntimeError, match='all domain ids'), ros.held_domain(tmp_path):
        pass


def test_another_process_does_not_get_a_held_domain(tmp_path, one_domain):
    script = f"""
import ros
ros.FIRST_DOMAIN = ros.LAST_DOMAIN = {one_domain}
try:
    with ros.held_domain({str(tmp_path)!r}):
        print('got it')
except RuntimeError:
    print('refused')
"""
    def asked():
        return subprocess.run([sys.executable, '-c', script], capture_output=True, text=True,
                              timeout=30, cwd=ros.ROOT / 'test', check=True).stdout.strip()

    with ros.held_domain(tmp_path):
        assert asked() == 'refused'
    assert asked() == 'got it'


def test_the_profile_is_read_by_the_library_and_stays_in_this_process(ros_domain, tmp_path):
    assert ros.PROFILE.items() <= os.environ.items()
    assert not ros.PROFILE.keys() & ros_domain.environment.keys()
    wrong = tmp_path / 'wrong.xml'
    wrong.write_text(pathlib.Path(*set(ros.PROFILE.values())).read_text().replace('OFF', 'NO'))

    def told(profile):
        script = 'import rclpy; rclpy.init(); rclpy.create_node("node").destroy_node()'
        done = ros_domain.run('-c', script,
                              env=ros_domain.environment | dict.fromkeys(ros.PROFILE, profile))
        assert done.returncode == 0
        return done.stdout + done.stderr
    assert str(wrong) in told(str(wrong))    # the library complains of it
    assert told(next(iter(ros.PROFILE.values()))) == ''


def test_a_node_that_is_left_behind_is_seen(ros_domain):
    import rclpy
    before = ros.participants()
    rclpy.init(domain_id=ros_domain.id)
    node = rclpy.create_node('node')
    assert ros.participants() == before + 1
    node.destroy_node()
    assert ros.participants() == before
    rclpy.shutdown()


def test_the_domain_reaches_this_process_and_its_children(ros_domain):
    child = ros_domain.run('-c',
                           'import os; print(os.environ["ROS_DOMAIN_ID"], '
                           'os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"])')
    assert child.stdout.split() == [str(ros_domain.id), 'LOCALHOST']
    assert os.environ['ROS_DOMAIN_ID'] == str(ros_domain.id)


def test_grandchildren_do_not_outlive_the_test(ros_domain):
    mine, theirs = os.pipe()
    with ros_domain.process(
            '-c', 'import subprocess; subprocess.run(["sleep", "60"], close_fds=False)',
            pass_fds=(theirs,)):
        os.close(theirs)
        assert not select.select([mine], [], [], 1.0)[0]     # open: child or grandchild lives
    # end of file: nobody is left that could write
    assert select.select([mine], [], [], 10.0)[0]
    os.close(mine)


def test_a_process_that_hangs_is_ended(ros_domain):
    with pytest.raises(subprocess.TimeoutExpired):
        ros_domain.run('-c', 'import time; time.sleep(60)', timeout=1)
