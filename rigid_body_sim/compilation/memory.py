# SPDX-License-Identifier: Apache-2.0
"""Arrays as kernels take them: without numba they are memoryviews.

Plain Python reads a number of an array as a scalar of NumPy, and one of a memoryview as a float:
its arithmetic has the same bits and takes a fifth of the time. A whole run takes half of it.
"""

from rigid_body_sim.compilation.environment import HAVE_NUMBA

if HAVE_NUMBA:
    def memory(array):
        """Return an array itself: compiled kernels take arrays."""
        return array
else:
    def memory(array):
        """Return a memoryview of an array (n,), or a list of those of the rows of an array (m, n).

        What kernels write there is in the array.
        """
        return memoryview(array) if array.ndim == 1 else [memoryview(row) for row in array]


def table(array):
    """Return an array of constants, or one that kernels only read, of which each is indexed."""
    return array if HAVE_NUMBA else memoryview(array)
