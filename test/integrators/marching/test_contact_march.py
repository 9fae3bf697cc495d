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
    GLIDING,
    LEDGER,
    PIVOTING,
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


# -- its parts, beside their formulas ------------------------------------------------------------

def rows(begin=1.0, end=1.0, others=1.0, k=1, **at):
    """Return rows in which the number k is so large at the stages; `at`: s3 is that at stage 3."""
    w, place = np.zeros((contact_step.WORK_ROWS, ROW.size)), ROW.part('watched').first + k
    w[1:contact_march.STAGES, place] = others
    w[0, place], w[contact_march.END, place] = begin, end
    for name, value in at.items():
        w[int(name[1:]), place] = value
    return w


LAST = f's{contact_march.STAGES - 1}'


@pytest.mark.parametrize(('numbers', 'falls'), [
    ({}, False), ({'end': -1e-9}, True), ({'s1': -1e-9}, True), ({LAST: -1e-9}, True),
    ({'end': 0.099}, True), ({'end': 0.101}, False), ({'s5': 0.099}, True),
    ({'s5': 0.101}, False), ({'s5': 0.101, 'end': 1.1}, True),
    ({'begin': 0.05}, False),                     # it rises from small on
    ({'begin': 0.05, 's1': 0.04}, True), ({'begin': 0.05, 's1': 0.05}, False),
    ({'begin': 0.0, 's1': -0.1, 'end': -0.1}, True), ({'begin': 0.0, 's1': -0.1}, False),
    ({'begin': -0.1, 'end': -0.2}, True), ({'begin': -0.1, 'end': 0.0}, False),
    ({'begin': 0.0, 'end': -0.1, 'k': contact_march.STOPS}, False),
    ({'begin': 1.0, 'end': -0.1, 'k': contact_march.STOPS}, True)])
def test_a_number_may_fall_below_zero_where_it_does_so_at_a_stage_or_comes_close(numbers, falls):
    """Within a tenth of the larger end, and below its beginning; from zero on only at the end."""
    assert bool(KERNELS._falls(rows(**numbers), numbers.get('k', 1))) is falls


@pytest.mark.parametrize(('numbers', 'rates', 'dips'), [
    ({}, {}, False), ({'end': -1e-9}, {}, True), ({'s1': -1e-9}, {}, True),
    ({LAST: -1e-9}, {}, True), ({'begin': 1e-6, 's1': 2e-6}, {}, False),
    ({'begin': 1e-6, 's1': 2e-6}, {0: -1.0}, True),
    ({'begin': 1e-6, 's1': 2e-6}, {contact_march.END: -1.0}, True),
    ({'begin': 1e-6, 's1': 2e-6}, {1: -1.0}, True),
    ({'begin': 1e-6, 's1': 2e-6}, {contact_march.STAGES - 1: -1.0}, True),
    ({'begin': 0.05, 's4': 0.04}, {}, True), ({'end': 0.099}, {}, True),
    ({'end': 0.101}, {0: -1.0}, False), ({'s4': 0.101}, {0: -1.0}, False),
    ({'begin': 0.1, 'end': 0.2, 's4': 0.05}, {0: -1.0}, True),
    ({'begin': 0.1, 'end': 0.2, 's4': 0.05, 'others': 0.3}, {0: -1.0}, False),
    ({'begin': 0.1, 'end': 0.2, 'others': 0.3, 's4': 0.05, 's6': 0.6}, {0: -1.0}, True)])
def test_a_gap_may_dip_below_zero_where_it_falls_at_a_stage_and_comes_close(numbers, rates, dips):
    """Within a tenth of the most that it is in the step; one that only grows does not."""
    if numbers.get('s4') == 0.05 and 'others' not in numbers:
        numbers = numbers | {'others': 0.6}
    w = rows(**numbers, k=contact_march.NORMAL)
    for row, rate in rates.items():
        w[row, GAP] = rate
    assert bool(KERNELS._dips(w)) is dips


@pytest.mark.parametrize(('error', 'factor'), [
    (0.0, 4.0), (1e-9, 0.9), (1e-9 * 1.5 ** 7, 0.6), (1e-9 * 0.3 ** 7, 3.0), (1e-20, 4.0),
    (1.0, 0.1), (math.inf, 0.1), (math.nan, 0.1)])
def test_the_next_step_is_so_much_longer_that_its_error_is_what_is_allowed(error, factor):
    """Errors go with its eighth power, what is allowed with the first; nine tenths to be sure."""
    assert contact_step.ORDER == 8
    assert KERNELS._factor(error, 1e-9) == near(factor, rel=1e-14)


def test_a_phase_has_the_name_of_what_fell_below_zero():
    """A number in each mode: load or gap, grip, firmness, what jumps, stops or rolls."""
    march = contact_march
    others = [march.PARADOX, march.JUMP, march.STOPPED, march.HELD]
    for mode, first in ((FLIGHT, [march.TOUCHED, march.LET_GO]),
                        (ROLLING, [march.LOST_CONTACT, march.LET_GO]),
                        (SLIDING, [march.LOST_CONTACT, march.LET_GO]),
                        (GLIDING, [march.LOST_CONTACT, march.LET_GO]),
                        (CREEPING, [march.LOST_CONTACT, march.FASTER]),
                        (PIVOTING, [march.LOST_CONTACT, march.FASTER])):
        assert [KERNELS._named(mode, k) for k in range(WATCHES)] == first + others


@pytest.mark.parametrize(('before', 'after', 'ahead'), [
    (5e-4, 4e-4, 8.0), (9e-4, 3e-4, 1.0), (1.1e-3, 4e-4, 0.0), (4e-4, 5e-4, 0.0),
    (4e-4, 4e-4, 0.0), (4e-4, -1e-4, 0.0), (4e-4, 0.0, 0.0)])
def test_a_firmness_that_goes_on_falling_jams_when_it_would_be_zero(before, after, ahead):
    """In steps of 2 s, below 1e-3."""
    w = rows(before, after, k=contact_march.FIRMNESS)
    assert KERNELS._until_jam(w, 2.0) == near(ahead, rel=1e-14)


@pytest.mark.parametrize(('mode', 'pace', 'slip', 'dies'), [
    (SLIDING, 0.9, (-1.0, 0.5), True), (SLIDING, 1.1, (-1.0, 0.5), False),
    (ROLLING, 0.9, (-1.0, 0.5), False), (SLIDING, 0.9, (1.0, -0.5), False),
    (SLIDING, 0.9, (0.5, 1.0), False), (SLIDING, 0.9, (0.0, -1.0), True)])
def test_a_slip_dies_that_shrinks_and_is_no_more_than_an_error(mode, pace, slip, dies):
    """The slip is (2, 1), its rate as given; 2^-50 of the speeds, 3 m/s, may be an error."""
    p, w, y = np.zeros(CONTACT.size), rows(), np.zeros(SIZE)
    p[contact_march.MODE], p[contact_march.SWIFT] = mode, 3.0
    y[U:U + 2], w[0, U:U + 2] = (2.0, 1.0), slip
    w[0, PACE] = pace * 3.0 * 2.0 ** -50
    assert bool(KERNELS._dies(p, w, y)) is dies


@pytest.mark.parametrize(('spin', 'lag', 'grip', 'settles'), [
    (4.0, 1e-3, 6e-4, True), (4.0, 1e-3, 4e-4, False), (-4.0, 1e-3, 6e-4, True),
    (-1e-3, 1.0, 3e-5, True), (1e-3, 1.0, 2e-5, False), (0.0, 1.0, 0.0, False)])
def test_a_slip_settles_where_pivoting_leaves_half_of_its_room_free(spin, lag, grip, settles):
    """Of the lag, or of the spin of the patch, 0.05 m times its rate, if that is less."""
    p, w, y = np.zeros(CONTACT.size + 3 * WATCHES), rows(), np.zeros(SIZE)
    y[3], y[OMEGA + 2] = 1.0, spin
    p[contact_march.MODE], p[contact_march.SIDE] = SLIDING, 0.0
    p[contact_march.PATCH], p[contact_march.LAG] = 0.05, lag
    p[CONTACT.size + 3 * contact_march.GRIP] = grip
    assert bool(KERNELS._settles(p, w, y)) is settles
    assert (p[contact_march.MODE], p[contact_march.SIDE]) == (SLIDING, 0.0)


def test_the_first_step_is_what_the_fastest_change_allows():
    """2 rad/s of the body with 5/2 rad/s^2 per rad/s, and the turn of its slip at 0.5 m/s."""
    y, row, front = np.arange(1.0, SIZE + 1.0), np.zeros(ROW.size), np.ones(contact_march.POINT)
    row[OMEGA:OMEGA + 3], row[U:U + 2], row[PACE] = (3.0, 0.0, 4.0), (0.3, 0.4), 0.5
    for mode, fastest in ((SLIDING, 2.0 * 0.5 + 2.5 + 1.0), (ROLLING, 2.0 * 0.5 + 2.5)):
        p, meta = np.zeros(CONTACT.size), np.full(contact_march.META, 7.0)
        p[contact_march.MODE] = mode
        meta[contact_march.TOLERANCE], meta[contact_march.RATE] = 2.0 ** -24, 2.0
        KERNELS.begin(p, row, front, meta, y)
        assert meta[contact_march.PLANNED] == near(0.125 / fastest, rel=1e-14)
        assert front.tolist() == [*y, *[0.0] * SIZE]
        assert meta[[contact_march.COUNT, contact_march.STRIDE, contact_march.STORED,
                     contact_march.STATUS, contact_march.STEPS, contact_march.PLACED,
                     contact_march.CROWDED, contact_march.FADED, contact_march.JAMMED,
                     contact_march.AHEAD]].tolist() == [0, 1, 0, 0, 0, -1, 0, 0, 0, 0]


def test_a_slip_that_jams_for_many_steps_is_at_the_paradox(monkeypatch):
    """A falls by 1e-9/s from 5e-4: steps of less than a second tell 5e5 s, so long that it is."""
    monkeypatch.setattr(KERNELS, 'STALLED', 3)
    phase = Phase(SLIDING, watch2=(5e-4, -1e-9, 0.0))
    assert phase.march(0.9) == contact_march.PARADOX
    assert phase.meta[[contact_march.STEPS, contact_march.JAMMED]].tolist() == [4.0, 4.0]
    assert phase.meta[contact_march.AHEAD] == near(5e5, rel=1e-5)
    assert Phase(SLIDING, watch2=(2e-3, -1e-9, 0.0)).march(0.9) == contact_march.RUNNING
    assert Phase(ROLLING, watch2=(5e-4, -1e-9, 0.0)).march(3.0) == contact_march.RUNNING


def test_a_slip_that_dies_for_many_steps_is_dead(monkeypatch):
    """Where it is never small enough for that by itself: below 2^-50 so many steps are enough."""
    monkeypatch.setattr(KERNELS, 'STALLED', 3)
    monkeypatch.setattr(KERNELS, 'DEAD', 0.0)
    phase = Phase(SLIDING, slip=2.0 ** -48)
    assert phase.march(2.0) == contact_march.STUCK
    assert phase.meta[contact_march.CROWDED] == 4.0
    assert phase.w[contact_march.END, PACE] < 2.0 ** -50


def test_a_slip_that_fades_pivots_after_so_many_steps_if_it_settles(monkeypatch):
    """Where it has a patch; slower than 1e-3 of the speeds it fades."""
    monkeypatch.setattr(KERNELS, 'STALLED', 3)
    for slip, patch, status in ((9e-4, 0.1, contact_march.SETTLED),
                                (9e-4, 0.0, contact_march.RUNNING),
                                (1.0, 0.1, contact_march.RUNNING)):
        phase = Phase(SLIDING, slip=slip)
        phase.p[contact_march.PATCH] = patch
        assert phase.march(0.9 * slip) == status
        assert bool(phase.meta[contact_march.FADED]) is (slip < 1.0)
        if status == contact_march.SETTLED:
            assert phase.meta[[contact_march.STEPS, contact_march.FADED]].tolist() == [3.0, 3.0]
