# SPDX-License-Identifier: Apache-2.0
"""Pictures for notebooks, and the notebooks of the documentation, cell by cell."""

import json
import pathlib
import re

import numpy as np
import pytest

from rigid_body_sim import BadInput, Recording, Simulation
from rigid_body_sim.cli.simulate import main as simulate

NOTEBOOKS = sorted((pathlib.Path(__file__).resolve().parents[2] / 'docs/notebooks').glob(
    '*.ipynb'))


def shown(page):
    """Return the data of the moving body of a page."""
    return json.loads(re.search(r'player\(0, (\{.*\})\)</script>', page).group(1))


def test_a_simulation_is_shown_from_now_on_and_stays_where_it_is():
    simulation = Simulation('tennis_racket')
    simulation.advance(500)
    picture = simulation.view(2.0)
    data = shown(picture.page())
    assert simulation.tick == 500
    assert (data['times'][0], data['times'][-1]) == (0.5, 2.5)
    expected = simulation.states([2.5]).orientation[0]
    np.testing.assert_allclose(data['orientation'][-1], expected, atol=1e-5)
    assert picture._repr_html_().startswith('<iframe srcdoc="')
    with pytest.raises(BadInput, match='duration'):
        simulation.view(0.0)


def test_a_recording_is_shown_and_saved(tmp_path):
    assert simulate(['--scene', 'heavy_top', '--duration', '1', '--output',
                     str(tmp_path / 'run')]) == 0
    with Recording(tmp_path / 'run') as recording:
        recording.view(0.5).save(tmp_path / 'top.html')
    data = shown((tmp_path / 'top.html').read_text())
    assert data['times'][-1] == pytest.approx(0.5, abs=2e-3)
    assert len(data['holder']) == 1 and not data['follow']
    assert 'http' not in (tmp_path / 'top.html').read_text()


@pytest.mark.parametrize('path', NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs_from_top_to_bottom(path):
    names = {}
    for cell in json.loads(path.read_text())['cells']:
        if cell['cell_type'] == 'code':
            exec(compile(''.join(cell['source']), str(path), 'exec'), names)
