# SPDX-License-Identifier: Apache-2.0
"""Where numba keeps the compiled code of a kernel: one place for all copies of the same sources."""

import pathlib

import numba
from numba.core.caching import FunctionCache, NullCache, UserProvidedCacheLocator

from rigid_body_sim.compilation.environment import PACKAGE, cache_folder


class Place(UserProvidedCacheLocator):
    """A folder below ``numba.config.CACHE_DIR``, named by the place of the source file in the package.

    numba's own locator names it by the whole path, so that an installed copy would compile anew what
    the sources beside it have compiled.
    """

    @classmethod
    def get_suitable_cache_subpath(cls, py_file):
        """Return the folder for the kernels of a file."""
        path = pathlib.Path(py_file).resolve()
        if path.is_relative_to(PACKAGE):
            return str(path.relative_to(PACKAGE).with_suffix(''))
        return super().get_suitable_cache_subpath(py_file)


class DeferredCache:
    """The cache of one kernel, in the place of numba's own, which is made when the kernel is compiled.

    numba makes the folder when a function is decorated: importing the package would hash its
    sources and write to the disk of somebody who calls no kernel.
    """

    def __init__(self, function):
        self._function, self._made = function, None

    @property
    def _cache(self):
        if self._made is None:
            self._made = _cache_of(self._function)
        return self._made

    def load_overload(self, signature, target_context):
        """Return the compiled code for the types of a call, or None."""
        return self._cache.load_overload(signature, target_context)

    def save_overload(self, signature, data):
        """Keep the compiled code for the types of a call."""
        self._cache.save_overload(signature, data)

    def flush(self):
        """Forget what is kept."""
        self._cache.flush()

    @property
    def cache_path(self):
        """Folder of the compiled code."""
        return self._cache.cache_path


def _cache_of(function):
    folder = cache_folder()
    if folder is None:
        return NullCache()
    settings = {'CACHE_DIR': str(folder), 'CACHE_LOCATOR_CLASSES': f'{__name__}.{Place.__name__}'}
    # a numba that does not know a setting goes on without it: then each copy of the package compiles
    before = {name: getattr(numba.config, name) for name in settings if hasattr(numba.config, name)}
    for name in before:
        setattr(numba.config, name, settings[name])
    try:
        return FunctionCache(function)
    finally:
        for name, value in before.items():
            setattr(numba.config, name, value)
