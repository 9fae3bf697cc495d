# SPDX-License-Identifier: Apache-2.0
"""The common parts of all subcommands.

These are the parser, the exit statuses, JSON with 17 digits, Ctrl-C, and the line about slow
steps. Importing this module is fast.
"""

import argparse
import contextlib
import json
import os
import signal
import sys
import threading
import time

from rigid_body_sim.errors import BadInput, NotConverged

GOOD, CHECK_FAILED, BAD_INPUT, INTERRUPTED = 0, 1, 2, 130
SIGNALLED = 128
"""An exit status above it says the number of the signal that ended a subcommand."""
PATIENCE, LOOK = 4.0, 0.5
"""Time after which a subcommand says that it compiles, and time between its checks, s."""
COMPILER = 'numba.core.compiler'
"""The module whose functions run while a kernel is compiled, not while it comes from the cache."""


class _Parser(argparse.ArgumentParser):
    def error(self, message):
        print(f'{self.prog}: {message}; {self.prog} --help shows how', file=sys.stderr)
        sys.exit(BAD_INPUT)


def parser(name, about, example):
    """Return an argument parser for a subcommand, whose help ends with an example."""
    return _Parser(prog=name, description=about, epilog=f'example:\n  {example}',
                   formatter_class=argparse.RawDescriptionHelpFormatter, allow_abbrev=False)


def run(function, arguments, kernels='this scene'):
    """Run a subcommand's function on its parsed arguments; return the exit status.

    `kernels` says whose kernels the subcommand may have to compile.
    """
    try:
        with patience(kernels):
            return function(arguments)
    except BadInput as error:
        print(error, file=sys.stderr)
        return BAD_INPUT
    except NotConverged as error:
        print(error, file=sys.stderr)
        return CHECK_FAILED
    except KeyboardInterrupt:
        print('interrupted', file=sys.stderr)
        return INTERRUPTED
    except BrokenPipeError:
        # the reader of the output has gone: nothing can be told to it
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return GOOD


def interruptible(function, *arguments):
    """Call a function; Ctrl-C ends the process with one line, whenever it comes.

    It may come during an import, before a subcommand could handle it, or in libraries that turn it
    into another error or print it. The function may still handle SIGINT in its own way.
    """
    if signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
        # in the background, or within a program that handles SIGINT itself
        return function(*arguments)
    heard = []

    def hear(number, _):
        if heard and sys.exc_info()[0] is not None:
            return    # the subcommand is ending already, and may finish what it has to
        if not heard:
            # messages of threads and destructors from here on are about the interrupt
            sys.unraisablehook = threading.excepthook = lambda _: None
            threading.Thread(target=_insist, name='interrupt', daemon=True).start()
        heard.append(number)
        raise KeyboardInterrupt

    signal.signal(signal.SIGINT, hear)
    try:
        status = function(*arguments)
        if heard or (status or 0) > SIGNALLED:    # a subcommand may answer a signal by itself
            _leave(status)
        return status
    except BaseException:
        if not heard:
            raise
        with contextlib.suppress(OSError, ValueError):
            print('interrupted', file=sys.stderr)
        # the process ends here: freeing the memory of an interrupted compiler may crash
        _leave(INTERRUPTED)
    finally:
        signal.signal(signal.SIGINT, signal.default_int_handler)


def _insist():
    """Interrupt the main thread until it ends: a library may swallow a KeyboardInterrupt."""
    while True:
        time.sleep(LOOK)
        signal.pthread_kill(threading.main_thread().ident, signal.SIGINT)


def _leave(status):
    """End the process at once: with numba loaded the usual way out takes up to a second."""
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(OSError, ValueError):
            stream.flush()
    os._exit(status)


@contextlib.contextmanager
def deaf_children():
    """Start child processes here that ignore Ctrl-C.

    The terminal sends it to all processes of a subcommand; the parent alone answers, and ends its
    children. An ignored signal stays ignored in a child, forked or not; a signal mask does not,
    since multiprocessing changes it. Only a main thread can do this.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


@contextlib.contextmanager
def ending_like_ctrl_c():
    """Let SIGTERM end what runs here as Ctrl-C does, with what it has to finish.

    That holds in the background of a script too, where Ctrl-C is ignored.
    """
    ctrl_c = signal.getsignal(signal.SIGINT)
    before = signal.signal(signal.SIGTERM,
                           ctrl_c if callable(ctrl_c) else signal.default_int_handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


@contextlib.contextmanager
def patience(kernels='this scene'):
    """Say in one line if kernels are being compiled in this thread for longer than PATIENCE."""
    done, thread, began = threading.Event(), threading.get_ident(), time.monotonic()

    def watch():
        while not done.wait(LOOK):
            if time.monotonic() - began > PATIENCE and _compiles(thread):
                with contextlib.suppress(OSError, ValueError):
                    print(f'compiling the kernels of {kernels}, once for this machine and '
                          'version ...', file=sys.stderr, flush=True)
                return
    threading.Thread(target=watch, name='patience', daemon=True).start()
    try:
        yield
    finally:
        done.set()


def _compiles(thread):
    """Return whether a thread is compiling a kernel now."""
    frame = sys._current_frames().get(thread)
    while frame is not None:
        if frame.f_globals.get('__name__') == COMPILER:
            return True
        frame = frame.f_back
    return False


def print_json(value):
    """Print a value as JSON; Python's repr of a double has the 17 digits that restore it."""
    print(json.dumps(value, indent=2, allow_nan=False))
