# SPDX-License-Identifier: Apache-2.0
"""The ledger in a report is that of the simulation that was recorded."""

import types

import numpy as np
import pytest
from analysis import made

from rigid_body_sim.analysis import ledger as ledger_module
from rigid_body_sim.analysis.ledger import TERMS, ledger
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


class Run:
    """Stands for a rerun at 10 Hz: the balance at a tick is told by it."""

    made: list

    def __init__(self, *of):
        self.made.append(of)
        self.simulation = types.SimpleNamespace(ledger=lambda: {
            term: 100.0 * self.tick + k for k, term in enumerate(TERMS)})

    def ticks(self, stamps):
        return (stamps - 500_000_000) // 100_000_000

    def to(self, tick):
        self.tick = tick

    def stamp(self, tick):
        return 500_000_000 + 100_000_000 * tick


@pytest.mark.parametrize(('stamps', 'given'), [
    ((500_000_000, 2_500_000_000), 500_000_000), (None, None)])
@pytest.mark.parametrize(('points', 'ticks'), [
    (6, [0, 4, 8, 12, 16, 20]), (400, list(range(21))), (3, [0, 10, 20])])
def test_rows_are_at_even_ticks_from_the_first_to_the_last(
        stamps, given, points, ticks, monkeypatch):
    monkeypatch.setattr(ledger_module, 'Rerun', Run)
    monkeypatch.setattr(ledger_module, 'POINTS', points)
    Run.made = []
    source = types.SimpleNamespace(
        stamps=stamps, start=500_000_000, end=2_500_000_000, entries='the journal')
    times, terms = ledger(source)
    assert Run.made == [('the journal', {}, given)]
    assert times == pytest.approx(0.1 * np.array(ticks), rel=1e-15, abs=0.0)
    assert {term: values.tolist() for term, values in terms.items()} == {
        term: [100.0 * tick + k for tick in ticks] for k, term in enumerate(TERMS)}
