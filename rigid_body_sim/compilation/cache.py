# SPDX-License-Identifier: Apache-2.0
"""The place where numba keeps compiled kernels: one for all copies of the same sources."""

import contextlib
import fcntl
import functools
import pathlib
import time
import warnings

import numba
from numba.core.caching import FunctionCache, NullCache
from numba.core.compiler_lock import global_compiler_lock

from rigid_body_sim.compilation import callees
from rigid_body_sim.compilation.environment import PACKAGE, cache_folder

try:
    from numba.core.caching import UserProvidedCacheLocator
except ImportError:
    # numba before 0.61, as in Ubuntu 24.04
    from numba.core.caching import _UserProvidedCacheLocator as UserProvidedCacheLocator


PATIENCE = 120.0    # s: beside a process that is stopped while it compiles, others go on then
AGAIN = 0.02        # s, from one look at a lock to the next


class Place(UserProvidedCacheLocator):
    """A folder below ``numba.config.CACHE_DIR``, named by the file's path inside the package.

    numba's own locator names the folder by the absolute path, so an installed copy would compile
    again what its source tree has compiled.
    """

    @classmethod
    def get_suitable_cache_subpath(cls, py_file):
        """Return the folder for the kernels of a file."""
        path = pathlib.Path(py_file).resolve()
        if path.is_relative_to(PACKAGE):
            return str(path.relative_to(PACKAGE).with_suffix(''))
        return super().get_suitable_cache_subpath(py_file)


@contextlib.contextmanager
def _going_on():
    """Let a full disk, or a folder that somebody removes meanwhile, not end what is computed."""
    try:
        yield
    except (OSError, RuntimeError) as error:    # the second one is numba's: no folder for a cache
        warnings.warn(f'compiled kernels are not kept for the next process: {error}',
                      RuntimeWarning, stacklevel=2)


class DeferredCache:
    """The cache of one kernel, which makes numba's own cache only when the kernel is compiled.

    numba makes the cache folder when a function is decorated: importing the package would hash
    its sources and write to the disk even if no kernel is ever called.
    """

    def __init__(self, function):
        self._function = function

    @functools.cached_property
    def _cache(self):
        return _cache_of(self._function, FunctionCache)

    @functools.cached_property
    def _cache_as_callee(self):
        return _cache_of(self._function, callees.CalleeCache)

    @property
    def _present(self):
        return self._cache_as_callee if callees.has_caller() else self._cache

    @contextlib.contextmanager
    def alone(self):
        """Keep other processes from compiling the kernel meanwhile: they wait, and then load it.

        Where the folder cannot be written, each process compiles for itself.
        """
        with contextlib.ExitStack() as held:
            # first the lock between threads: each has it while it waits for another process
            held.enter_context(global_compiler_lock)
            with contextlib.suppress(OSError, RuntimeError):
                if self.cache_path:    # numba's cache that keeps nothing has none
                    _wait_for(held.enter_context(self._lock_file()))
            yield

    def _lock_file(self):
        code = self._function.__code__
        return pathlib.Path(
            self.cache_path, f'{code.co_name}-{code.co_firstlineno}.lock').open('wb')

    def load_overload(self, signature, target_context):
        """Return the compiled code for the types of a call, or None."""
        with _going_on():
            return self._present.load_overload(signature, target_context)
        return None

    def save_overload(self, signature, data):
        """Keep the compiled code for the types of a call."""
        with _going_on():
            self._present.save_overload(signature, data)

    def flush(self):
        """Remove the compiled code."""
        self._cache.flush()
        self._cache_as_callee.flush()

    @property
    def cache_path(self):
        """Folder of the compiled code."""
        return self._cache.cache_path


def _wait_for(file):
    """Wait for the lock of a file, which goes with the file; no longer than PATIENCE."""
    began = time.monotonic()
    while time.monotonic() - began < PATIENCE:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            return
        except BlockingIOError:
            time.sleep(AGAIN)


def _cache_of(function, cache):
    folder = cache_folder()
    if folder is None:
        return NullCache()
    settings = {'CACHE_DIR': str(folder), 'CACHE_LOCATOR_CLASSES': f'{__name__}.{Place.__name__}'}
    # a numba that does not know a setting works without it: each copy of the package then
    # compiles for itself
    before = {name: getattr(numba.config, name)
              for name in settings if hasattr(numba.config, name)}
    for name in before:
        setattr(numba.config, name, settings[name])
    try:
        return cache(function)
    finally:
        for name, value in before.items():
            setattr(numba.config, name, value)
