# SPDX-License-Identifier: Apache-2.0
"""Runs with strikes, beside a body that coasts."""

import math

import numpy as np
import pytest
from choice.known_bodies import Coasting, coasting_scene
from scipy.spatial.transform import Rotation

from rigid_body_sim.choice import runs
from rigid_body_sim.integrators.marching.work import TooMuchWork

TIMES = np.array([1.0, 2.0, 3.0, 4.0])


def test_looks_are_spread_up_to_the_time_one_in_the_second_half_of_each_part():
    found = runs.looks(6.0)
    assert len(found) == runs.LOOKS
    assert found[-1] == 6.0
    parts = found * (runs.LOOKS / 6.0)
    assert np.ceil(parts) == pytest.approx(np.arange(1, runs.LOOKS + 1))
    assert (np.ceil(parts) - parts).max() < runs.EARLIER


@pytest.mark.parametrize('periods', [1, 2, 4, 8, 16, 32, 48, 64, 96, 128, 192, 256])
def test_looks_do_not_see_a_motion_at_the_same_phase_each_time(periods):
    """Even looks would: the largest of |sin| or |cos| over them would be 0.

    The least one found is 0.998.
    """
    phases = math.tau * periods * runs.looks(1.0)
    assert np.abs(np.sin(phases)).max() > 0.99
    assert np.abs(np.cos(phases)).max() > 0.99


def test_a_run_begins_anew_at_each_strike():
    """J at y = 1 along x takes J/4 from the rate about z; one after the last look does nothing."""
    one = coasting_scene((2.5, -4.0), (1.0, 8.0), (9.0, 1.0))
    assert [strike.time for strike in one.strikes] == [1.0, 2.5, 9.0]
    prototype = Coasting()
    states = runs.run(one, prototype, one.initial.vector, TIMES)
    assert [start[0] for start in prototype.starts] == [0.0, 1.0, 2.5]
    assert [start[7] for start in prototype.starts] == pytest.approx([3.0, 1.0, 2.0])
    # a look at the time of a strike sees the state after it
    assert states[:, 7] == pytest.approx([1.0, 1.0, 2.0, 2.0])
    angles = Rotation.from_quat(states[:, 1:5]).as_rotvec()[:, 2] % (2.0 * math.pi)
    assert angles == pytest.approx([3.0, 4.0, 5.5, 7.5 - 2.0 * math.pi])
    assert runs.struck_rate(one) == pytest.approx(2.0 + 1.0 + 0.25)


def test_a_run_that_begins_after_a_strike_leaves_it_out():
    one, prototype = coasting_scene((2.5, -4.0), (1.0, 8.0)), Coasting()
    states = runs.run(one, prototype, one.initial.vector, TIMES)
    begun = runs.run(one, prototype, states[0], TIMES, over=1.0)
    assert [start[0] for start in prototype.starts[3:]] == [1.0, 2.5]
    assert begun == pytest.approx(states, abs=1e-15)


def test_what_does_not_converge_is_not_a_number_and_too_much_work_is_said():
    still = coasting_scene()
    found = runs.run(still, Coasting(2.5), still.initial.vector, TIMES)
    assert np.isnan(found).all()
    with pytest.raises(TooMuchWork):
        runs.run(still, Coasting(2.5, TooMuchWork), still.initial.vector, TIMES)


def test_what_each_solver_allows_itself_is_noted_up_to_where_it_ends(monkeypatch):
    one, noted = coasting_scene((2.5, -4.0), (1.0, 8.0), (3.0, 1.0)), []
    # the one that begins at 2.5 s allows itself nothing
    monkeypatch.setattr(Coasting, 'allowance', lambda self, until: None if self.vector[0] == 2.5
                        else (1e-9 * until, float(self.vector[0])))
    runs.run(one, Coasting(), one.initial.vector, TIMES, noted)
    assert noted == [(1e-9, 0.0), (2.5e-9, 1.0), (4e-9, 3.0)]
    runs.run(one, Coasting(), one.initial.vector, TIMES)    # nobody asks


def test_a_strike_at_the_last_look_counts():
    one = coasting_scene((4.0, 8.0))
    states = runs.run(one, Coasting(), one.initial.vector, TIMES)
    assert states[:, 7] == pytest.approx([3.0, 3.0, 3.0, 1.0])


def test_a_strike_before_the_first_look_acts_at_its_time():
    one = coasting_scene((0.25, 8.0))
    states = runs.run(one, Coasting(), one.initial.vector, TIMES)
    angles = Rotation.from_quat(states[:2, 1:5]).as_rotvec()[:, 2]
    assert angles == pytest.approx([3.0 * 0.25 + 0.75, 3.0 * 0.25 + 1.75])
