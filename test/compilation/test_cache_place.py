# SPDX-License-Identifier: Apache-2.0
"""The cache of kernels works with the numba of each distribution, and where nothing is kept."""

import fcntl
import os
import subprocess
import sys

import pytest
import ros
from made_clock import clock_of

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


REMOVED = """
import shutil, sys, warnings
from rigid_body_sim.compilation import environment
from rigid_body_sim.numerics.rotations import angle_between
shutil.rmtree(environment.cache_folder())
open(environment.cache_folder(), 'x').close()
with warnings.catch_warnings(record=True) as heard:
    warnings.simplefilter('always')
    print(angle_between(0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0))
print(*{f'{one.category.__name__}: {one.message}' for one in heard})
"""


def test_a_folder_that_is_gone_does_not_end_what_is_computed(tmp_path):
    settings = {name: value for name, value in os.environ.items() if name != 'NUMBA_DISABLE_JIT'}
    done = subprocess.run([sys.executable, '-c', REMOVED], cwd=ros.ROOT, capture_output=True,
                          text=True, timeout=120, check=False,
                          env=settings | {'XDG_CACHE_HOME': str(tmp_path)})
    assert done.returncode == 0, done.stderr
    value, heard = done.stdout.splitlines()
    assert value == '0.0'
    assert heard.startswith('RuntimeWarning: compiled kernels are not kept for the next process: ')


def test_nobody_waits_for_a_lock_longer_than_is_patient(tmp_path, monkeypatch):
    """Looks at it 0, 1/4, 1/2 and 3/4 s after it began; without a holder one is enough."""
    from rigid_body_sim.compilation import cache
    _, slept = clock_of(monkeypatch, cache)
    monkeypatch.setattr(cache, 'PATIENCE', 1.0)
    monkeypatch.setattr(cache, 'AGAIN', 0.25)
    with (tmp_path / 'lock').open('wb') as other, (tmp_path / 'lock').open('wb') as mine:
        fcntl.flock(other, fcntl.LOCK_EX)
        cache._wait_for(mine)
        assert slept == [0.25] * 4
        fcntl.flock(other, fcntl.LOCK_UN)
        cache._wait_for(mine)
        assert slept == [0.25] * 4
        with pytest.raises(BlockingIOError):    # it is held now
            fcntl.flock(other, fcntl.LOCK_EX | fcntl.LOCK_NB)
