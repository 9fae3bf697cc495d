# SPDX-License-Identifier: Apache-2.0
"""Fixtures of all tests."""

import fcntl
import gc
import hashlib
import itertools
import json
import os
import pathlib
import signal
import subprocess
import sys
import tempfile

import pytest
import ros
from soak import SOAK

from rigid_body_sim.compilation.jit import HAVE_NUMBA

TEST = pathlib.Path(__file__).resolve().parent
TEMPORARY = tempfile.gettempdir()
os.environ.update(ros.SETTINGS | ros.PROFILE)
# numba makes millions of small objects while it compiles, and keeps most of them: looking for
# circles among them every 700 objects takes a tenth of its time
gc.set_threshold(100_000, 50, 50)
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


@pytest.fixture(scope='module', autouse=True)
def leaves_no_participant():
    """Fail where a module's tests leave a node behind.

    With forty nodes alive in one process and domain, Fast DDS 2.14 may never end the next one.
    """
    before = ros.participants()
    yield
    assert ros.participants() <= before


SHARED = pytest.StashKey()
"""Of a session: the folder that its workers share."""


@pytest.fixture(scope='session', autouse=True)
def shared(request, tmp_path_factory):
    """Return the folder that the workers share."""
    folder = tmp_path_factory.getbasetemp()
    if 'PYTEST_XDIST_WORKER' in os.environ:
        folder = folder.parent
    request.session.stash[SHARED] = folder
    return folder


def done_once(folder, words, do):
    """Return the text of do(), which only the first worker that asks for these words calls."""
    name = hashlib.sha256('\0'.join(words).encode()).hexdigest()
    kept = folder / f'{name}.json'
    with open(folder / f'{name}.lock', 'w', encoding='utf-8') as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not kept.exists():
            kept.write_text(do(), encoding='utf-8')
    return kept.read_text(encoding='utf-8')


@pytest.fixture(scope='session')
def plain(shared):
    """Return a function that runs a script of test/ in plain Python, and returns its JSON.

    Plain Python compiles nothing. Workers share what one of them has run.
    """
    environment = os.environ | {'NUMBA_DISABLE_JIT': '1',
                                'PYTHONPATH': os.pathsep.join((str(TEST.parent), str(TEST)))}

    def run(script, *arguments):
        def do():
            done = subprocess.run(
                [sys.executable, '-W', 'ignore', TEST / script, *arguments],
                env=environment, capture_output=True, text=True, timeout=280)
            assert done.returncode == 0, done.stderr
            return done.stdout
        return json.loads(done_once(shared, (script, *arguments), do))
    return run


WITHOUT_NUMBA = pytest.StashKey()
"""Of a session: the results of the tests that ran without numba, by name."""
IN_ONE_PROCESS = 12
"""Files, in the order of their paths, whose tests run without numba in one process.

Starting one takes a second.
"""
LONGEST = 7000 if SOAK else 560
"""Limit of such a process, s.

One took 274 s beside others on a slow machine, and 287 s of the processor in the soak.
"""
OUTCOMES = 'RIGID_BODY_SIM_TEST_OUTCOMES'
"""Variable with the path of the file in which a process without numba leaves its results."""


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report(collector):
    """Let other workers wait while one reads a test file for the first time.

    pytest rewrites its asserts, which takes longer than all else, and keeps the result for them.
    """
    if not isinstance(collector, pytest.Module):
        return (yield)
    with open(collector.path, 'rb') as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        return (yield)


WAITING = 'node'
"""Folder of the tests that mostly wait: for ticks, messages and processes."""


def pytest_collection_modifyitems(items):
    """Let a test wait for the process without numba, in which its own time limit holds.

    Files of tests that mostly wait are spread among the others, so that workers do not all come to
    them at the same time, and leave the processor idle.
    """
    for item in items:
        if HAVE_NUMBA and item.get_closest_marker('without_numba') is not None:
            item.add_marker(pytest.mark.timeout(LONGEST + 20), append=False)
    waiting, others = {}, {}
    for item in items:
        files = waiting if item.path.parent.name == WAITING else others
        files.setdefault(item.path, []).append(item)
    ends = itertools.accumulate(map(len, others.values()))
    total, made = sum(map(len, others.values())), []
    queue = [(total * (place + 0.5) / len(waiting), tests)
             for place, tests in enumerate(waiting.values())]
    for end, tests in zip(ends, others.values(), strict=True):
        made += tests
        while queue and queue[0][0] <= end:
            made += queue.pop(0)[1]
    items[:] = [*made, *itertools.chain(*(tests for _, tests in queue))]


@pytest.hookimpl(tryfirst=True)
def pytest_pyfunc_call(pyfuncitem):
    """Run the tests of some files marked `without_numba` in one process that does not compile.

    They run a kind of scene for a second or less: plain Python takes less than compiling it would,
    and gives the same bits (test_digests.py).
    """
    if not HAVE_NUMBA or pyfuncitem.get_closest_marker('without_numba') is None:
        return None
    found = pyfuncitem.session.stash.setdefault(WITHOUT_NUMBA, {})
    if pyfuncitem.nodeid not in found:
        found |= _without_numba(pyfuncitem)
    if found[pyfuncitem.nodeid]:
        pytest.fail(found[pyfuncitem.nodeid], pytrace=False)
    return True


def _without_numba(wanted):
    """Return name -> what failed, '' if nothing, of a test and those like it in some files.

    Workers share what one of them has run.
    """
    plain = {item.nodeid: item.path for item in wanted.session.items
             if item.get_closest_marker('without_numba') is not None}
    files = sorted(set(plain.values()))
    first = files.index(wanted.path) // IN_ONE_PROCESS * IN_ONE_PROCESS
    names = [name for name, path in plain.items()
             if path in files[first:first + IN_ONE_PROCESS]]
    return json.loads(done_once(wanted.session.stash[SHARED], names,
                                lambda: json.dumps(_run_without_numba(names, wanted.config))))


def _run_without_numba(names, config):
    """Run tests in a process that does not compile; return as `_without_numba` does."""
    # it is no worker, and has folders of its own
    environment = {key: value for key, value in os.environ.items() if 'XDIST' not in key}
    # the test that asks may have changed what tempfile answers
    with tempfile.TemporaryDirectory(dir=TEMPORARY) as folder:
        outcomes = pathlib.Path(folder) / 'outcomes'
        outcomes.touch()
        # the plugins of other packages take a second to import
        done = subprocess.run(
            [sys.executable, '-m', 'pytest', '-q', '-p', 'no:cacheprovider', '-p',
             'pytest_timeout', *names], cwd=config.rootpath, capture_output=True,
            text=True, timeout=LONGEST, env=environment | {
                'NUMBA_DISABLE_JIT': '1', 'PYTEST_DISABLE_PLUGIN_AUTOLOAD': '1',
                OUTCOMES: str(outcomes)})
        found = [json.loads(line) for line in outcomes.read_text().splitlines()]
    return dict.fromkeys(names, f'did not run\n{done.stdout}{done.stderr}') | dict(found)


def pytest_runtest_logreport(report):
    """Write the result of a test to a file if another process asks for it."""
    if OUTCOMES in os.environ and (report.failed or report.when == 'call'):
        with open(os.environ[OUTCOMES], 'a', encoding='utf-8') as file:
            file.write(json.dumps([report.nodeid, report.longreprtext if report.failed else ''])
                       + '\n')
