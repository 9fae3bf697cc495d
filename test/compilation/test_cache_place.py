# SPDX-License-Identifier: Apache-2.0
"""The cache of kernels works with the numba of each distribution."""

import subprocess
import sys

import pytest
import ros

pytest.importorskip('numba')

OLDER = """
import numba.core.caching as caching
if hasattr(caching, 'UserProvidedCacheLocator'):
    caching._UserProvidedCacheLocator = caching.UserProvidedCacheLocator
    del caching.UserProvidedCacheLocator
from rigid_body_sim.compilation import cache
assert issubclass(cache.Place, caching._UserProvidedCacheLocator)
"""


def test_a_numba_before_0_61_names_its_locator_otherwise():
    done = subprocess.run([sys.executable, '-c', OLDER], cwd=ros.ROOT, capture_output=True,
                          text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stderr
