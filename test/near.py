# SPDX-License-Identifier: Apache-2.0
"""Comparison by relative error alone."""

import pytest


def near(expected, rel):
    """Return what equals a number or an array within rel of `expected`.

    ``pytest.approx(rel=...)`` accepts differences of 1e-12 for any rel.
    """
    return pytest.approx(expected, rel=rel, abs=0.0)
