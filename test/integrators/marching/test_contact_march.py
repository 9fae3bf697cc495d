# SPDX-License-Identifier: Apache-2.0
"""The march through a phase of contact, on made-up rates whose motion and events are known.

The body turns about its x axis at 1 rad/s and moves in a circle; each watched number is a parabola
in time, so that each event has a time that is known to the last bit or two. A slip that dies goes
by s, with dt = u ds and u = e^-s.
"""

import math

import numpy as np
import pytest
from near import near

from rigid_body_sim.compilation.templates import specialise
from rigid_body_sim.integrators.equations.contact_views import (
    CREEPING,
    FLIGHT,
    LEDGER,
    ROLLING,
    ROW,
    SLIDING,
    UNKNOWNS,
)
from rigid_body_sim.integrators.marching import contact_march, contact_step, contact_zero
from rigid_body_sim.mechanics.contact.parameters import CONTACT
from rigid_body_sim.numerics.rotations import rotate
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.simulation.simulation import Simulation

pytestmark = pytest.mark.without_numba

SIZE, WATCHES = UNKNOWNS.size, ROW.part('watched').size
OMEGA, U, PLACE, GAP, TIME = (UNKNOWNS.part(name).first
                              for name in ('omega', 'u', 'place', 'gap', 'time'))
WORK, COUPLED, PACE = LEDGER.part('work').first, LEDGER.first, ROW.part('pace').first
RATES = f"""
def rate(p, y, row):
    for n in range({ROW.size}):
        row[n] = 0.0
    pace = y[{U}] if p[{contact_march.MODE}] == {SLIDING} else 1.0
    row[0], row[3] = 0.5 * pace * y[3], -0.5 * pace * y[0]
    if p[{contact_march.MODE}] == {SLIDING}:
        row[{U}] = -y[{U}]
    row[{PLACE}], row[{PLACE} + 1] = -pace * y[{PLACE} + 1], pace * y[{PLACE}]
    row[{TIME}], row[{PACE}], row[{WORK}] = pace, pace, pace * 2.0 * y[{TIME}]
    for k in range({WATCHES}):
        a, b, c = p[{CONTACT.size} + 3 * k:{CONTACT.size} + 3 * k + 3]
        row[{ROW.part('watched').first} + k] = a + y[{TIME}] * (b + y[{TIME}] * c)
"""
STEP = specialise(contact_step, rate=RATES)
ZERO = specialise(contact_zero, rate=f'{STEP.__name__}:rate',
                  step_from=f'{STEP.__name__}:step_from')
KERNELS = specialise(contact_march, rate=f'{STEP.__name__}:rate',
                     step_from=f'{STEP.__name__}:step_from',
                     error_of=f'{STEP.__name__}:error_of', longest=f'{STEP.__name__}:longest',
                     ORDER=f'from {STEP.__name__} import ORDER\n',
                     first_zero=f'{ZERO.__name__}:first_zero')
ACCURACY = 1e-12


class Phase:
    """One phase of the made-up body, with the parabolas that are watched, k -> (a, b, c)."""

    def __init__(self, mode=ROLLING, kept=512, slip=1.0, **watched):
        self.p = np.zeros(CONTACT.size + 3 * WATCHES)
        self.p[contact_march.MODE], self.p[contact_march.SWIFT] = mode, 1.0
        for k in range(WATCHES):
            first = CONTACT.size + 3 * k
            self.p[first:first + 3] = watched.get(f'watch{k}', (1.0, 0.0, 0.0))
        self.w = np.zeros((contact_step.WORK_ROWS, ROW.size))
        self.meta = np.zeros(contact_march.META)
        self.meta[contact_march.TOLERANCE] = ACCURACY
        self.meta[[contact_march.RATE, contact_march.SPEED, contact_march.LENGTH]] = 1.0
        self.store, self.sizes = np.empty((kept, contact_march.POINT)), np.empty(512)
        self.front = np.empty(contact_march.POINT)
        self.cursor = np.empty((2, contact_march.POINT))
        y = np.zeros(SIZE)
        y[3] = y[OMEGA] = y[PLACE] = 1.0
        y[U] = slip if mode == SLIDING else 0.0
        STEP.rate(self.p, y, self.w[0])
        KERNELS.begin(self.p, self.w[0], self.front, self.meta, y)

    def march(self, end):
        KERNELS.march(self.p, self.w, self.store, self.sizes, self.front, self.meta, end)
        return int(self.meta[contact_march.STATUS])

    def at(self, time):
        y = np.empty(SIZE)
        KERNELS.at(self.p, self.w, self.store, self.sizes, self.meta, self.cursor, time, y)
        return y


def true(time):
    """Return what is known of the unknowns at a time."""
    return [math.sin(0.5 * time), math.cos(0.5 * time), math.cos(time), math.sin(time), time,
            time * time]


def known(y):
    return y[[0, 3, PLACE, PLACE + 1, TIME, WORK]]


@pytest.mark.parametrize(('mode', 'k', 'why'), [
    (FLIGHT, 0, contact_march.TOUCHED), (ROLLING, 0, contact_march.LOST_CONTACT),
    (SLIDING, 0, contact_march.LOST_CONTACT), (ROLLING, 1, contact_march.LET_GO),
    (CREEPING, 1, contact_march.FASTER), (ROLLING, 2, contact_march.PARADOX),
    (SLIDING, 3, contact_march.JUMP), (ROLLING, 3, contact_march.JUMP),
    (ROLLING, 4, contact_march.STOPPED)])
def test_a_phase_ends_where_a_watched_number_falls_below_zero(mode, k, why):
    phase = Phase(mode, **{f'watch{k}': (1.0, -2.0, 0.0)})
    assert phase.march(0.2) == contact_march.RUNNING
    assert phase.front[TIME] < 0.5
    assert phase.march(3.0) == why
    assert phase.front[TIME] == pytest.approx(0.5, abs=2e-16)
    assert known(phase.front) == pytest.approx(true(0.5), abs=2e-12)


def test_the_first_of_two_events_in_a_step_ends_the_phase():
    early, late = (1.0, -10.0, 0.0), (1.0, -9.9, 0.0)
    for first, second, why in ((1, 2, contact_march.LET_GO), (2, 1, contact_march.PARADOX)):
        phase = Phase(**{f'watch{first}': early, f'watch{second}': late})
        assert phase.march(1.0) == why
        assert phase.front[TIME] == pytest.approx(0.1, abs=1e-16)


@pytest.mark.parametrize(('k', 'why'), [
    (0, contact_march.LOST_CONTACT), (2, contact_march.PARADOX), (3, contact_march.JUMP)])
def test_a_slip_that_dies_meets_no_event_of_a_slip_the_other_way(k, why):
    for slip, found in ((1e-12, why), (1e-16, contact_march.JUMP if k == 3 else
                                       contact_march.STUCK)):
        phase = Phase(SLIDING, slip=slip, **{f'watch{k}': (1.0, -2.0 / slip, 0.0)})
        assert phase.march(1.0) == found
        assert 0.0 <= phase.front[TIME] <= 0.51 * slip


def test_what_begins_at_zero_and_rises_is_no_event_but_what_stops_is():
    rises = (0.0, -1e-3, 1.0)
    assert Phase(watch0=rises).march(0.5) == contact_march.RUNNING
    assert Phase(watch4=rises).march(0.5) == contact_march.RUNNING    # no zero is within a step
    returns = Phase(watch1=(0.0, 1.0, -1.0))
    assert returns.march(2.0) == contact_march.LET_GO
    assert returns.front[TIME] == pytest.approx(1.0, abs=4e-16)


@pytest.mark.parametrize(('place', 'depth', 'width'), [
    (0.53, 1.0, 0.01), (0.5, 1e-3, 0.2), (0.97, 0.5, 0.02), (0.02, 1.0, 0.015), (0.53, 0.0, 0.01)])
def test_a_dip_is_found_between_the_parts_of_a_step_to_round_off(place, depth, width):
    """The parabola d ((t - place)^2/width^2 - 1) is below zero from place - width on."""
    c = (depth or 1.0) / width ** 2
    parabola = (c * (place * place - width * width * (1.0 if depth else -1.0)),
                -2.0 * c * place, c)
    phase = Phase(watch0=parabola)
    y, lost = phase.front[:SIZE], phase.front[SIZE:]
    found = ZERO.first_zero(phase.p, phase.w, y, lost, 1.0, 0, parabola[0])
    assert found == (near(place - width, rel=1e-13) if depth else -1.0)
    if depth:
        assert ZERO.look(phase.p, phase.w, y, lost, found, 0) < 0.0
        before = ZERO.look(phase.p, phase.w, y, lost, found * (1.0 - 1e-15), 0)
        assert before >= -1e-15 * parabola[0]    # rounding of the parabola


@pytest.mark.parametrize('mode', [ROLLING, SLIDING])
def test_states_do_not_depend_on_the_order_in_which_they_are_asked_for(mode):
    phase = Phase(mode)
    last = 0.999 if mode == SLIDING else 9.0
    assert phase.march(last) == contact_march.RUNNING
    times = np.linspace(0.0, last, 13)
    forth = np.array([phase.at(time) for time in times])
    for time, y in zip(times, forth, strict=True):
        assert known(y) == pytest.approx(true(time), abs=1e-11)
        assert y[TIME] == near(time, rel=4e-16)
        if mode == SLIDING:
            assert y[U] == near(1.0 - time, rel=1e-9)
    back = np.array([phase.at(time) for time in times[::-1]])[::-1]
    assert back.tobytes() == forth.tobytes()
    for place in np.random.default_rng(1).permutation(len(times)):
        assert phase.at(times[place]).tobytes() == forth[place].tobytes()


def test_a_slip_dies_within_its_time():
    phase = Phase(SLIDING)
    assert phase.march(2.0) == contact_march.STUCK
    assert phase.front[TIME] == pytest.approx(1.0, abs=1e-12)
    assert 0.0 < phase.w[contact_march.END, PACE] <= contact_march.DEAD


def test_a_long_phase_keeps_every_other_point_and_gives_the_same_bits(monkeypatch):
    all_kept = Phase()
    monkeypatch.setattr(KERNELS, 'KEPT', 8)
    few = Phase(kept=8)
    for end in (1.0, 5.0, 30.0):
        for phase in (all_kept, few):
            monkeypatch.setattr(KERNELS, 'KEPT', len(phase.store))
            assert phase.march(end) == contact_march.RUNNING
    count, stride = few.meta[[contact_march.STORED, contact_march.STRIDE]]
    assert all_kept.meta[contact_march.STEPS] == few.meta[contact_march.STEPS] > 32
    assert 4 <= count <= 8
    assert stride >= 8.0
    for n in range(int(count)):
        assert few.store[n].tobytes() == all_kept.store[int(n * stride)].tobytes()
    for time in (0.0, 29.3, 0.7, 12.1, 12.2, 4.4):
        assert few.at(time).tobytes() == all_kept.at(time).tobytes()


def test_the_error_of_a_step_does_not_depend_on_the_units():
    """Of length, of speed and of time: rates go with them, and the times against them."""
    draw = np.random.default_rng(4)
    w = draw.normal(size=(contact_step.WORK_ROWS, ROW.size))
    ones = 1.0, 1.0, 1.0
    first = STEP.error_of(w, 0.1, ones)
    for place, columns in enumerate((slice(OMEGA, U), slice(U, PLACE), slice(PLACE, GAP + 1))):
        other, scales = w.copy(), list(ones)
        other[:, columns] *= 1000.0
        scales[place] *= 1000.0
        if columns.start == OMEGA:
            other[:, TIME] /= 1000.0
        assert STEP.error_of(other, 0.1, tuple(scales)) == near(first, rel=1e-12)
    only = np.zeros_like(w)
    for n in range(COUPLED):    # each unknown counts
        only[:] = 0.0
        only[:, n] = w[:, n]
        assert 0.0 < STEP.error_of(only, 0.1, ones) < first
    only[:] = 0.0
    only[:, COUPLED:] = w[:, COUPLED:]    # the ledger does not
    assert STEP.error_of(only, 0.1, ones) == 0.0
    assert STEP.error_of(np.full_like(w, np.nan), 0.1, ones) == math.inf


BALL = """
scene: slip
body: {mass: 1.0, inertia: [0.001, 0.001, 0.001], surface: {sphere: {radius: 0.05}}}
constraint: table
effects: [gravity: {g: 9.81}, sliding_friction: {mu: 0.2}]
initial: {velocity: [1.0, 0.3, 0], angular_velocity: [3, 2, 1]}
"""


@pytest.mark.parametrize(('accuracy', 'most'), [(1e-12, 2e-15), (1e-6, 1e-11), (1e-2, 1e-7)])
def test_the_slip_of_a_ball_falls_in_proportion_to_time_until_it_dies(accuracy, most):
    """Within steps the time is solved for, to 1e-12 of it before the slip has died.

    Measured: 4e-16, 2e-12 and 6e-9 m/s.
    """
    simulation = Simulation(parse_scene(BALL), 'dop8', accuracy)
    rate = (1.0 + 0.05**2 / 0.001) * 0.2 * 9.81
    ends = math.hypot(1.0 - 2.0 * 0.05, 0.3 + 3.0 * 0.05) / rate
    times = ends * np.concatenate((1.0 - 2.0 ** -np.arange(1.0, 40.0, 3.0), np.arange(12) / 12.0))
    states = simulation.states(times)
    for time, v, q, omega in zip(times, states.velocity, states.orientation,
                                 states.angular_velocity, strict=True):
        slip = v + np.cross(rotate(*q, *omega), [0.0, 0.0, -0.05])
        assert math.hypot(slip[0], slip[1]) == pytest.approx(rate * (ends - time), abs=most)
