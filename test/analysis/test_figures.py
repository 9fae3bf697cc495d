# SPDX-License-Identifier: Apache-2.0
"""Which figures a report has, and their files."""

import pathlib
import types

import pytest

from rigid_body_sim.analysis import figures


class Figure:
    """Stands for a figure: it notes where it was saved, and by which layout."""

    saved: list

    def __init__(self, *of):
        self.of, self.layout = of, 'constrained'

    def savefig(self, path):
        self.saved.append((*self.of, str(path), self.layout))

    def set_layout_engine(self, engine):
        self.layout = engine


@pytest.fixture
def saved(monkeypatch):
    """Return what was saved: of each file what it shows, its path, the layout."""
    Figure.saved = []
    for module, names in ((figures.plots, ('stack', 'spectra', 'space')),
                          (figures.panels, ('overview', 'motion', 'energies'))):
        for name in names:
            monkeypatch.setattr(module, name, Figure if module is figures.plots
                                else lambda of, name=name: of and name)
    monkeypatch.setattr(figures, 'spaces', lambda measured: [types.SimpleNamespace(name='path')])
    return Figure.saved


def measured(namespace=''):
    return types.SimpleNamespace(source=types.SimpleNamespace(namespace=namespace))


def test_the_overview_is_a_png_named_after_its_body(saved):
    one = measured('/left/arm')
    path = figures.draw_overview(pathlib.Path('out'), one, 'a title')
    assert path == pathlib.Path('out/overview_left_arm.png')
    assert saved == [('overview', 'a title', one.source, str(path), 'constrained')]


@pytest.mark.parametrize(('spectrum', 'balance', 'more'), [
    (None, None, []), (types.SimpleNamespace(amplitudes={}), None, []),
    (types.SimpleNamespace(amplitudes={'body': 1}), 'balance', ['ledger', 'spectrum']),
    (None, 'balance', ['ledger'])])
def test_a_report_has_a_figure_of_all_that_there_is_as_png_and_svg(
        spectrum, balance, more, saved):
    found = figures.draw_all(pathlib.Path('out'), measured(), spectrum, balance, 'a title')
    names = ['overview', 'motion', *more, 'path']
    assert [str(path) for path in found] == [f'out/{name}.png' for name in names]
    assert [path for *_, path, _ in saved] == [
        f'out/{name}.{suffix}' for name in names for suffix in ('png', 'svg')]
    # the layout is made once
    assert [layout for *_, layout in saved] == ['constrained', None] * len(names)


def test_a_recording_without_motion_has_no_figure_of_it(saved, monkeypatch):
    monkeypatch.setattr(figures.panels, 'motion', lambda measured: [])
    found = figures.draw_all(pathlib.Path(), measured(), None, None, '')
    assert [str(path) for path in found] == ['overview.png', 'path.png']
