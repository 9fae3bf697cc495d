# SPDX-License-Identifier: Apache-2.0
"""Damage that no checksum shows: analysis and resimulation run, or refuse in one line."""

import random

import numpy as np
import pytest
from analysis import made
from recording.damage import damaged_copy, without_checksums
from soak import SOAK

from rigid_body_sim.analysis.measure import measure
from rigid_body_sim.analysis.resimulate import resimulate
from rigid_body_sim.analysis.source import sources
from rigid_body_sim.analysis.spectrum import Spectrum
from rigid_body_sim.analysis.summary import lines, summary
from rigid_body_sim.errors import BadInput, NotConverged
from rigid_body_sim.recording.reader import Recording

pytestmark = pytest.mark.without_numba

DAMAGED = 3000 if SOAK else 40


@pytest.fixture(scope='module')
def content(tmp_path_factory):
    """Return the bytes of a recording with commands, neither compressed nor with checksums."""
    path = tmp_path_factory.mktemp('damaged') / 'run'
    made.record(
        path, 'tennis_racket', 120,
        acts={50: [('cmd_impulse', (0.0, 0.0, 0.0), (0.5, 0.0, 0.0), 'world')], 80: [('reset',)]})
    without_checksums(path / 'run_0.mcap')
    return (path / 'run_0.mcap').read_bytes()


def analysed(path):
    with Recording(path) as recording:
        for one in measure(recording, sources(recording)):
            assert lines(summary(one, Spectrum(one) if one.motion else None))


def tried(function, path):
    """Return whether a function ran; if it refused, it did so in one line."""
    objection = None
    try:
        function(path)
    except (BadInput, NotConverged) as error:
        objection = str(error)
    assert objection is None or (objection and '\n' not in objection
                                 and len(objection) < 2000), objection
    return objection is None


def test_nothing_worse_than_a_line(content, tmp_path):
    rng, path = random.Random(3), tmp_path / 'damaged.mcap'
    good = 0
    for _ in range(DAMAGED):
        path.write_bytes(damaged_copy(content, rng))
        good += tried(analysed, path)
        tried(resimulate, path)
    assert good > 0


@pytest.mark.parametrize(('old', 'new', 'said'),
                         [(b'"kind": "commands", "tick": 50', b'"kind": "commands", "tock": 50',
                           'the journal makes no sense'),
                          (b'"kind": "reset", "tick": 80', b'"kind": "reset", "tick": []',
                           'the journal makes no sense'),
                          (rb'inertia:\n  - 1.0', rb'inertia:\n  - -.0', 'scene'),
                          (np.float64(25.0002).tobytes(), np.float64(np.nan).tobytes(),
                           '/energy: holds a number that is not finite')])
def test_what_makes_no_sense_is_named(content, tmp_path, old, new, said):
    assert len(old) >= len(new) and old in content
    path = tmp_path / 'damaged.mcap'
    path.write_bytes(content.replace(old, new.ljust(len(old))))
    with pytest.raises(BadInput, match=said):
        _ = analysed(path), resimulate(path)
