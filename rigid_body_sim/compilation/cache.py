"""Where numba keeps the compiled code of a kernel: the same place for every copy of the package with the same sources."""

import pathlib

from numba.core.caching import UserProvidedCacheLocator

PACKAGE = pathlib.Path(__file__).resolve().parents[1]


class Place(UserProvidedCacheLocator):
    """A folder below ``numba.config.CACHE_DIR``, named by the place of the source file in the package.

    numba's own locator names it by the whole path, so that an installed copy would compile anew what the sources beside it have compiled.
    """

    @classmethod
    def get_suitable_cache_subpath(cls, py_file):
        """Return the folder for the kernels of a file."""
        path = pathlib.Path(py_file).resolve()
        return str(path.relative_to(PACKAGE).with_suffix('')) if path.is_relative_to(PACKAGE) else super().get_suitable_cache_subpath(py_file)
