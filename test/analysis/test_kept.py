# SPDX-License-Identifier: Apache-2.0
"""The figures and pages of two short recordings are those that were looked at (kept.py)."""

import base64
import functools

import kept
import numpy as np
import pytest
from analysis import made

from rigid_body_sim.analysis import page, panels, plots
from rigid_body_sim.analysis.analyze import _ledger
from rigid_body_sim.analysis.measure import measure
from rigid_body_sim.analysis.source import sources
from rigid_body_sim.analysis.space import spaces
from rigid_body_sim.analysis.spectrum import Spectrum
from rigid_body_sim.analysis.summary import lines, summary
from rigid_body_sim.recording.reader import Recording

pytestmark = pytest.mark.without_numba

LATE = np.random.default_rng(2).integers(30_000, 90_000, 201)
ACTS = {50: [('cmd_impulse', (0.0, 0.0, 0.0), (0.5, 0.0, 0.0), 'world')],
        75: [('cmd_wrench', (0.0, 0.0, 0.0), (0.0, 2.0, 0.0), 'body')],
        100: [('cmd_wrench', (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 'body')], 175: [('reset',)]}
RECORDINGS = {
    'racket': {'scene': 'tennis_racket', 'acts': ACTS, 'late': LATE, 'left_out': range(125, 130)},
    'ball': {'scene': 'billiard_follow'}, 'top': {'scene': 'heavy_top'}}


@pytest.fixture(scope='module', params=RECORDINGS)
def analysed(request, tmp_path_factory):
    """Return what returns (name, Measured, summary, Spectrum, ledger) of 4 s at 50 Hz.

    They are made when it is called, for a test without numba has its fixtures in two processes.
    """
    return functools.cache(lambda: _analysed(request.param, tmp_path_factory.mktemp('kept')))


def _analysed(name, folder):
    made.record(folder / name, ticks=200, rate=50.0, **RECORDINGS[name])
    with Recording(folder / name) as recording:
        [one] = measure(recording, sources(recording))
        spectrum = Spectrum(one)
        return name, one, summary(one, spectrum), spectrum, _ledger(one.source)


def plain(figure):
    """Return what a figure of Plotly shows."""
    def numbers(part):
        """Return a part with the arrays that Plotly has encoded."""
        if isinstance(part, dict) and 'bdata' in part:
            return np.frombuffer(base64.b64decode(part['bdata']), part['dtype'])
        if isinstance(part, dict):
            return {key: numbers(one) for key, one in part.items()}
        return list(map(numbers, part)) if isinstance(part, (list, tuple)) else part
    found = figure.to_dict()
    found['layout'].pop('template')
    return numbers(found)


def test_figures_for_print(analysed):
    name, one, _, spectrum, balance = analysed()
    figures = {'overview': plots.stack(panels.overview(one), 'title', one.source),
               'motion': plots.stack(panels.motion(one), 'title', one.source),
               **{space.name: plots.space(space) for space in spaces(one)}}
    if balance:
        figures['ledger'] = plots.stack(panels.energies(balance), 'title', one.source)
    if spectrum.amplitudes:
        figures['spectrum'] = plots.spectra(spectrum, 'title')
    kept.check(f'print_{name}', {key: kept.drawn(figure) for key, figure in figures.items()})


@pytest.mark.skipif(not page.available(), reason='needs plotly')
def test_the_interactive_page(analysed, monkeypatch):
    name, *others = analysed()
    packed = {'figures': {}, 'bodies': {}}
    monkeypatch.setattr(page, '_plain', plain)
    text = list(page._section(3, packed, name, *others))
    kept.check(f'page_{name}', {'text': text, **packed})


def test_the_numbers(analysed):
    name, _, found, *_ = analysed()
    kept.check(f'numbers_{name}', {'found': found, 'lines': len(lines(found))})
