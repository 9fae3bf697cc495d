# SPDX-License-Identifier: Apache-2.0
"""The ledger in a report is that of the simulation that was recorded."""

import pytest
from analysis import made

from rigid_body_sim.analysis.ledger import ledger
from rigid_body_sim.analysis.source import sources
from rigid_body_sim.recording.reader import Recording


@pytest.mark.without_numba
def test_the_last_row_is_the_simulation_s_own_ledger(tmp_path):
    acts = {100: [('cmd_wrench', (0.0, 0.0, 0.0), (0.0, 2.0, 0.5), 'body')],
            300: [('cmd_impulse', (0.0, 0.0, 1.0), (0.0, 0.0, 0.1), 'world')]}
    simulation = made.record(
        tmp_path / 'run', 'tennis_racket', 1000, acts=acts, left_out=range(500, 600))
    with Recording(tmp_path / 'run') as recording:
        [source] = sources(recording)
        times, terms = ledger(source)
    assert (times[0], times[-1], len(times)) == (0.0, 1.0, 400)
    own = simulation.ledger()
    assert {name: float(values[-1]) for name, values in terms.items()} == {name: own[name]
                                                                           for name in terms}
    assert terms['work'][0] == 0.0 and abs(terms['work'][-1]) > 0.1
    # what was given is what came: the residual stays small while energies change
    assert (abs(terms['energy_residual']).max() < 1e-10
            and terms['kinetic'][-1] - terms['kinetic'][0] == pytest.approx(terms['work'][-1]))
