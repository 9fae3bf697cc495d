# SPDX-License-Identifier: Apache-2.0
"""The common parts of all commands: Ctrl-C at any time, and the line about compiling."""

import multiprocessing
import os
import signal
import subprocess
import sys
import threading
import types

import pytest

from rigid_body_sim import BadInput, command_line
from rigid_body_sim.study import check_scenes

COMMAND = """
import os, signal, sys, threading, time, types
from rigid_body_sim import __main__ as shell
from rigid_body_sim import command_line

def interrupt():
    os.kill(os.getpid(), signal.SIGINT)
    time.sleep(60.0)        # the signal is heard in here

{code}

shell.SUBCOMMANDS['strange'] = ('strange:main', '')
sys.modules['strange'] = types.SimpleNamespace(main=main)
sys.exit(shell.{entry})
"""
WHERE = {
    'a command': """
def main(arguments=None):
    return command_line.run(lambda _: interrupt(), None)
""",
    'an import': """
def main(arguments=None):
    sys.path.insert(0, os.environ['FOLDER'])
    shell.interrupt = interrupt
    import slow_to_import
""",
    'a library that makes another error of it': """
def main(arguments=None):
    def work(_):
        try:
            interrupt()
        except KeyboardInterrupt:
            raise RuntimeError('no compiled object yet') from None
    return command_line.run(work, None)
""",
    'a library that swallows it': """
def main(arguments=None):
    def work(_):
        try:
            interrupt()
        except BaseException:
            pass
        time.sleep(60.0)
    return command_line.run(work, None)
""",
    'a destructor': """
class Library:
    def __del__(self):
        interrupt()

def main(arguments=None):
    def work(_):
        Library()
        time.sleep(60.0)
    return command_line.run(work, None)
""",
    'a thread that fails of it': """
def main(arguments=None):
    def work(_):
        broken = threading.Event()
        def fail():
            broken.wait(60.0)
            raise RuntimeError('broken pool')
        thread = threading.Thread(target=fail)
        thread.start()
        try:
            interrupt()
        finally:
            broken.set()
            thread.join()
    return command_line.run(work, None)
""",
}


@pytest.mark.parametrize('code', WHERE.values(), ids=WHERE)
@pytest.mark.parametrize('entry', ["main(['strange'])", 'strange()'], ids=['shell', 'ros2 run'])
def test_an_interrupt_ends_a_command_in_one_line(tmp_path, code, entry):
    (tmp_path / 'slow_to_import.py').write_text(
        'from rigid_body_sim import __main__\n__main__.interrupt()\n')
    done = subprocess.run([sys.executable, '-c', COMMAND.format(code=code, entry=entry)],
                          capture_output=True, text=True, timeout=55, check=False,
                          env={**os.environ, 'FOLDER': str(tmp_path)})
    assert (done.returncode, done.stdout, done.stderr) == (130, '', 'interrupted\n')


def test_what_must_be_finished_is_finished(tmp_path):
    code = """
def main(arguments=None):
    def work(_):
        try:
            interrupt()
        finally:
            for _ in range(3):
                os.kill(os.getpid(), signal.SIGINT)     # impatience
            time.sleep(2.0 * command_line.LOOK)
            print('finished')
    return command_line.run(work, None)
"""
    done = subprocess.run([sys.executable, '-c', COMMAND.format(code=code, entry='strange()')],
                          capture_output=True, text=True, timeout=55, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (130, 'finished\n', 'interrupted\n')


def test_an_ignored_interrupt_stays_ignored():
    """So it is in the background of a shell script."""
    code = """
signal.signal(signal.SIGINT, signal.SIG_IGN)

def main(arguments=None):
    os.kill(os.getpid(), signal.SIGINT)
    return 0
"""
    done = subprocess.run([sys.executable, '-c', COMMAND.format(code=code, entry='strange()')],
                          capture_output=True, text=True, timeout=55, check=False)
    assert (done.returncode, done.stderr) == (0, '')


def test_children_leave_the_interrupt_to_their_parent():
    process = multiprocessing.get_context('spawn').Process(target=signal.pause)
    with command_line.deaf_children():
        process.start()
    os.kill(process.pid, signal.SIGINT)
    process.join(0.5)
    assert process.is_alive()
    process.terminate()
    process.join(20.0)
    assert process.exitcode == -signal.SIGTERM
    assert signal.getsignal(signal.SIGINT) is signal.default_int_handler


def test_check_scenes_leaves_no_process_behind():
    with pytest.raises(BadInput, match='no scene'):
        list(check_scenes._tables({'no_such_scene': False, 'neither': True}, ()))
    assert multiprocessing.active_children() == []


def busy(module):
    """Return a thread that runs in a function of a module until its `end` is set."""
    namespace = {'__name__': module}
    exec('def work(begun, end):\n    begun.set()\n    end.wait(60.0)\n', namespace)
    begun, end = threading.Event(), threading.Event()
    thread = threading.Thread(target=namespace['work'], args=(begun, end))
    thread.start()
    assert begun.wait(60.0)
    return types.SimpleNamespace(ident=thread.ident, end=end, join=thread.join)


@pytest.mark.parametrize(('module', 'compiles'), [('numba.core.compiler', True),
                                                  ('numba.core.caching', False),
                                                  ('rigid_body_sim.motions.solver', False)])
def test_it_is_said_that_kernels_are_compiled_only_while_they_are(module, compiles):
    thread = busy(module)
    try:
        assert command_line._compiles(thread.ident) is compiles
    finally:
        thread.end.set()
        thread.join()


def test_the_compiler_is_where_it_is_looked_for():
    numba = pytest.importorskip('numba')
    seen = []

    class Looks(numba.core.event.Listener):
        def on_start(self, event):
            seen.append(command_line._compiles(threading.get_ident()))

        def on_end(self, event):
            pass
    if numba.config.DISABLE_JIT:
        pytest.skip('numba compiles nothing here')
    with numba.core.event.install_listener('numba:compiler_lock', Looks()):
        numba.njit(lambda x: x + 1.0)(1.0)
    assert any(seen)


@pytest.mark.parametrize('ctrl_c', [signal.default_int_handler, signal.SIG_IGN])
def test_sigterm_ends_as_ctrl_c_does_in_the_background_too(ctrl_c):
    before = signal.signal(signal.SIGINT, ctrl_c), signal.getsignal(signal.SIGTERM)
    try:
        with command_line.ending_like_ctrl_c(), pytest.raises(KeyboardInterrupt):
            signal.raise_signal(signal.SIGTERM)
        assert signal.getsignal(signal.SIGTERM) is before[1]
    finally:
        signal.signal(signal.SIGINT, before[0])


def test_patience_says_it_once(monkeypatch, capsys):
    said = threading.Event()
    monkeypatch.setattr(command_line, 'PATIENCE', 0.0)
    monkeypatch.setattr(command_line, 'LOOK', 0.01)
    monkeypatch.setattr(command_line, '_compiles', lambda thread: said.set() or True)
    with command_line.patience('the report'):
        assert said.wait(60.0)
    for thread in threading.enumerate():
        if thread.name == 'patience':
            thread.join(60.0)
    told = capsys.readouterr().err
    assert told.startswith('compiling the kernels of the report, once')
    assert told.count('\n') == 1
