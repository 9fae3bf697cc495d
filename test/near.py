"""Comparison by relative error alone."""

import pytest


def near(expected, rel):
    """Return what a number or an array within rel of `expected` equals; ``pytest.approx(rel=...)`` lets pass 1e-12 whatever rel says."""
    return pytest.approx(expected, rel=rel, abs=0.0)
