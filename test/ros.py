# SPDX-License-Identifier: Apache-2.0
"""Domains and processes for tests on real ROS: each test has its own, and they die with it.

Domain ids are 1 to 101: a user's own nodes live in 0, and from 102 on the ports of a domain
collide with ephemeral ones. A lock on a file holds an id for as long as its test runs, against
other test runs on the machine too; the system releases it when the process dies.
"""

import contextlib
import fcntl
import os
import pathlib
import random
import signal
import subprocess
import sys
import tempfile
import typing

FIRST_DOMAIN, LAST_DOMAIN = 1, 101
ROOT = pathlib.Path(__file__).resolve().parent.parent

# They are read when rclpy and the message classes are imported, so conftest.py sets them for this
# process too, and the profile for this process only.
PROFILE = dict.fromkeys(    # Fast DDS 2 reads the first, Fast DDS 3 the second
    ('FASTRTPS_DEFAULT_PROFILES_FILE', 'FASTDDS_DEFAULT_PROFILES_FILE'),
    str(ROOT / 'test' / 'fastdds.xml'))
SETTINGS = {'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST', 'ROS_PYTHON_CHECK_FIELDS': '1'}


def participants():
    """Return the number of participants of DDS in this process: each has a thread for events."""
    found = 0
    for thread in pathlib.Path('/proc/self/task').glob('*/comm'):
        with contextlib.suppress(OSError):    # it has ended
            found += thread.read_text().startswith('dds.ev')
    return found


class Domain(typing.NamedTuple):
    """A domain id held by a test, and the environment in which its processes run."""

    id: int
    environment: dict

    @contextlib.contextmanager
    def process(self, *arguments, **options):
        """Run ``python ARGUMENTS`` from the root of the source tree; yield the Popen.

        The process is in this domain, and its group is killed at the end. Its output arrives as
        text in ``stdout`` and ``stderr`` unless ``options`` (of Popen) say otherwise.
        """
        options = {'stdout': subprocess.PIPE, 'stderr': subprocess.PIPE, 'text': True, 'cwd': ROOT,
                   'env': self.environment, **options}
        with subprocess.Popen([sys.executable, *map(str, arguments)], start_new_session=True,
                              **options) as process:
            try:
                yield process
            finally:
                with contextlib.suppress(ProcessLookupError):
                    os.killpg(process.pid, signal.SIGKILL)

    def run(self, *arguments, timeout=60, **options):
        """Run ``python ARGUMENTS`` to its end; return a CompletedProcess.

        After ``timeout`` seconds it raises TimeoutExpired and leaves no process.
        """
        with self.process(*arguments, **options) as process:
            stdout, stderr = process.communicate(timeout=timeout)
            return subprocess.CompletedProcess(process.args, process.returncode, stdout, stderr)


@contextlib.contextmanager
def held_domain(log_folder):
    """Yield a Domain that nobody else who uses this function holds.

    Raises
    ------
    RuntimeError
        If all ids are held.
    """
    folder = pathlib.Path(tempfile.gettempdir()) / f'rigid_body_sim-domains-{os.getuid()}'
    folder.mkdir(exist_ok=True)
    ids = list(range(FIRST_DOMAIN, LAST_DOMAIN + 1))
    random.Random(os.getpid()).shuffle(ids)
    for domain_id in ids:
        with open(folder / str(domain_id), 'w') as lock:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                continue
            inherited = {key: value for key, value in os.environ.items() if key not in PROFILE}
            yield Domain(domain_id, {**inherited, **SETTINGS, 'ROS_DOMAIN_ID': str(domain_id),
                                     'ROS_LOG_DIR': str(log_folder)})
            return
    raise RuntimeError(f'all domain ids from {FIRST_DOMAIN} to {LAST_DOMAIN} are in use by tests: '
                       'wait for other test runs to end')
