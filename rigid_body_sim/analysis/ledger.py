"""The energy ledger of a recorded run, from its rerun: what the body had, what it was given, what became heat."""

import numpy as np

from rigid_body_sim.analysis.rerun import Rerun

POINTS = 400
TERMS = ('kinetic', 'potential', 'dissipated', 'work', 'energy_residual', 'momentum_residual')


def ledger(source):
    """Return (times in s since the first tick, dict of TERMS -> array) of a Source at evenly spaced ticks; BadInput where there is no rerun."""
    first, end = source.stamps or (source.start, source.end)
    rerun = Rerun(source.entries, {}, source.stamps and first)
    last = rerun.ticks(np.array([end]))[0]
    ticks = np.unique(np.linspace(0, last, POINTS).astype(int))
    rows = []
    for tick in ticks.tolist():
        rerun.to(tick)
        balance = rerun.simulation.ledger()
        rows.append([balance[term] for term in TERMS])
    times = (np.array([rerun.stamp(tick) for tick in ticks.tolist()]) - first) * 1e-9
    return times, dict(zip(TERMS, np.array(rows).T, strict=True))
