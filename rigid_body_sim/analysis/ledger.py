# SPDX-License-Identifier: Apache-2.0
"""The energy ledger of a recorded run, from its rerun: energies, work and heat."""

import numpy as np

from rigid_body_sim.analysis.rerun import Rerun

POINTS = 400
TERMS = ('kinetic', 'potential', 'dissipated', 'work', 'energy_residual', 'momentum_residual')


def ledger(source):
    """Return the ledger of a Source at evenly spaced ticks.

    Returns
    -------
    times : array
        s since the first tick.
    terms : dict of TERMS -> array

    Raises
    ------
    BadInput
        If the run cannot be run again.
    """
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
