# SPDX-License-Identifier: Apache-2.0
"""Marks tests that run with numba only; plain Python gives the same bits (test_digests.py)."""

import pytest

from rigid_body_sim.compilation.jit import HAVE_NUMBA

LONG_IN_PYTHON = pytest.mark.skipif(not HAVE_NUMBA, reason='takes minutes in plain Python')
