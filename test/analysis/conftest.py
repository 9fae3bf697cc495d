# SPDX-License-Identifier: Apache-2.0
"""Fixtures of the tests of reports."""

import pytest


@pytest.fixture
def undrawn(monkeypatch):
    """Let the figures of a report be made and named, but empty files.

    Drawing them takes most of the time of a report; it is looked at in test_analyze.py.
    """
    from matplotlib.figure import Figure
    monkeypatch.setattr(Figure, 'savefig', lambda figure, path: path.touch())
