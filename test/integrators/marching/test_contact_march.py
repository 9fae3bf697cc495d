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
from soak import SOAK

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
from rigid_body_sim.scene.surfaces import TORUS
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


def test_the_end_of_the_last_step_is_within_it_however_often_it_is_asked_for():
    phase = Phase()
    phase.sizes = phase.sizes[:3]    # no size of a fourth step can be read
    assert phase.march(9.0) == contact_march.RUNNING
    end = phase.front[TIME]
    first = phase.at(end)
    assert known(first) == pytest.approx(true(end), abs=1e-11)
    assert phase.at(end).tobytes() == first.tobytes()
    phase.at(end - 1.01 * phase.sizes[2])    # in the step before
    assert phase.at(end).tobytes() == first.tobytes()


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


# -- the march on made-up steps -------------------------------------------------------------------

WATCHED = contact_march.WATCHED


def driven(monkeypatch, phase, took=lambda h: h, errors=(), watched=lambda time: {},
           pace=lambda time: 1.0, omega=(1.0, 0.0, 0.0), most=math.inf, bad=()):
    """Let a phase march by made-up steps; return (list of the sizes that it tries, phase).

    A step of size h goes on by `took` (s), to this omega; the tries tell these errors, and those
    whose number is in `bad` are impossible. Numbers that are watched are 1, but for k -> number
    at a time. A number that falls below zero does so at 0.5 s.
    """
    tried, told = [], iter(errors)

    def row_of(time, row):
        row[:] = 0.0
        row[WATCHED:WATCHED + WATCHES], row[PACE] = 1.0, pace(time)
        for k, number in watched(time).items():
            row[WATCHED + k] = number

    def step_from(p, w, y, lost, h):
        tried.append(h)
        fresh = w[contact_march.FRESH]
        fresh[:SIZE], fresh[OMEGA:U], elapsed = y, omega, took(h)
        fresh[TIME] = y[TIME] + elapsed
        for i in range(1, contact_march.STAGES):
            row_of(y[TIME] + elapsed * i / contact_march.STAGES, w[i])
        return math.inf if len(tried) - 1 in bad else 0.0

    def first_zero(p, w, y, lost, h, k, begin):
        assert begin == watched(y[TIME])[k]
        return 0.5 - y[TIME]
    for name, does in (('step_from', step_from), ('error_of', lambda *_: next(told, 0.0)),
                       ('rate', lambda p, y, row: row_of(y[TIME], row)),
                       ('longest', lambda w, h: most * h), ('first_zero', first_zero)):
        monkeypatch.setattr(KERNELS, name, does)
    return tried, phase


def short(mode, planned, room=1, **numbers):
    """Return a phase with room for so many steps, and these numbers of its meta and p."""
    phase = Phase(mode)
    phase.sizes = phase.sizes[:room]
    phase.meta[contact_march.PLANNED] = planned
    for name, number in numbers.items():
        given = phase.p if name in ('SWIFT', 'KIND', 'DRY', 'VISCOUS', 'FILM') else phase.meta
        given[getattr(contact_march, name)] = number
    return phase


SLOW = 1e-12


@pytest.mark.parametrize(('mode', 'took', 'pace', 'faded', 'allowed'), [
    (ROLLING, 1.0, 1.0, 0, 2e-12 + 2e-17), (SLIDING, 0.5, 1.0, 0, 1e-12 + 2e-17),
    (SLIDING, 100.0, 1.0, 0, 64.0 * 2e-12 + 2e-17), (SLIDING, 100.0, 0.5, 0, 64e-12 + 2e-17),
    (SLIDING, 1e-9, 1e-3, 2000, 2e-17 + 2e-21),
    (SLIDING, 1e-9, 1e-3, 2001, 2e-17 + 2e-21 + 2.0 ** -52 * 2.0 * 4.0 * 3.0),
    (SLIDING, SLOW, SLOW, 2001, 2e-17 + 2.0 * SLOW * SLOW + 1e-3 * SLOW / 3.0)])
def test_a_step_may_err_by_its_share_of_the_time(mode, took, pace, faded, allowed, monkeypatch):
    """1e-12 a second and 2e-17; a step of a slip that grows up to 64 times the time at its start.

    A slip that fades for more than 2000 steps may err by the rounding of its pace, too, beside
    4 rad/s and 3 m/s, and by a thousandth of what it is.
    """
    for share, again in ((0.999, []), (1.001, [1.8 * 1.001 ** (-1.0 / 7.0)])):
        tried, phase = driven(monkeypatch, short(mode, 2.0, SWIFT=3.0, RATE=4.0, FADED=faded),
                              lambda h: took * h, [share * allowed],
                              pace=lambda time: 2.0 * pace if time else pace)
        assert phase.march(0.0) == contact_march.RUNNING
        assert tried == near([2.0, *again], rel=1e-12)


@pytest.mark.parametrize(('errors', 'most', 'tried', 'planned'), [
    ([], math.inf, [1.0], 4.0), ([], 1.5, [1.0], 1.5), ([math.inf], 0.3, [1.0, 0.1], 0.03),
    ([math.inf], 0.05, [1.0, 0.05], 0.0025), ([1e-12 + 2e-17], 1.0, [1.0], 0.9),
    ([math.nan], 1.0, [1.0, 0.1], 0.1)])
def test_the_next_step_is_no_longer_than_the_method_takes(errors, most, tried, planned,
                                                          monkeypatch):
    found, phase = driven(monkeypatch, short(ROLLING, 1.0), errors=errors, most=most)
    assert phase.march(0.0) == contact_march.RUNNING
    assert found == near(tried, rel=1e-14)
    assert phase.meta[contact_march.PLANNED] == near(planned, rel=1e-14)


def test_a_phase_fails_where_no_step_is_small_enough_or_time_stands_still(monkeypatch):
    """Time may stand still in a slip, where it is an unknown; that one ends where no room is."""
    for tell in ({'errors': [math.inf] * 100}, {'bad': range(100)}):
        tried, phase = driven(monkeypatch, short(ROLLING, 1.0), **tell)
        assert phase.march(0.0) == contact_march.FAILED
        assert tried == near(0.1 ** np.arange(contact_march.TRIALS), rel=1e-12)
        assert phase.meta[contact_march.STEPS] == 0.0
    for mode, status, steps in ((ROLLING, contact_march.FAILED, 0),
                                (SLIDING, contact_march.RUNNING, 3)):
        _, phase = driven(monkeypatch, short(mode, 1.0, 3), lambda h: 0.0)
        assert phase.march(0.0) == status
        assert phase.meta[[contact_march.STEPS, contact_march.JAMMED]].tolist() == [steps, 0.0]


@pytest.mark.parametrize(('kept', 'steps'), [(4096, 2), (2, 9)])
def test_a_march_ends_where_no_point_can_be_kept_but_where_others_can_be_dropped(
        kept, steps, monkeypatch):
    monkeypatch.setattr(KERNELS, 'KEPT', kept)
    _, phase = driven(monkeypatch, short(ROLLING, 1.0, 9), most=1.0)
    phase.store = phase.store[:2]
    assert phase.march(99.0) == contact_march.RUNNING
    assert phase.meta[contact_march.STEPS] == steps


def test_in_flight_only_the_gap_is_looked_at_for_dips(monkeypatch):
    """A number that begins at zero and ends above it is no event, as in other phases."""
    _, phase = driven(monkeypatch, short(FLIGHT, 1.0), watched=lambda time: {
        contact_march.GRIP: 0.0 if time == 0.0 else -1.0 if time < 1.0 else 1.0})
    assert phase.march(0.0) == contact_march.RUNNING


@pytest.mark.parametrize('tell', [{'errors': [0.0, 1.01e-12]}, {'bad': [2]}])
def test_a_part_of_a_step_that_errs_is_gone_in_two(tell, monkeypatch):
    """Up to an event at 0.5 s; each step that is looked through is made once more."""
    tried, phase = driven(monkeypatch, short(ROLLING, 1.0, 9), **tell,
                          watched=lambda time: {contact_march.GRIP: 1.5 - 3.0 * time})
    assert phase.march(9.0) == contact_march.LET_GO
    assert tried == [1.0, 1.0, 0.5, 0.25, 1.0, 1.0, 0.25]
    assert phase.front[TIME] == 0.5
    assert phase.sizes[:2].tolist() == [0.25, 0.25]
    assert phase.meta[[contact_march.STEPS, contact_march.COUNT]].tolist() == [2.0, 2.0]


def test_an_event_at_the_end_of_a_step_ends_the_phase(monkeypatch):
    tried, phase = driven(monkeypatch, short(ROLLING, 0.5, 9),
                          watched=lambda time: {contact_march.GRIP: 1.5 - 3.0 * time})
    assert phase.march(9.0) == contact_march.LET_GO
    assert (tried, phase.front[TIME]) == ([0.5] * 3, 0.5)


@pytest.mark.parametrize(('dry', 'why'), [
    (0.1, contact_march.HELD), (0.0, contact_march.RUNNING)])
def test_only_dry_friction_holds_a_rolling(dry, why):
    phase = Phase(watch5=(1.0, -2.0, 0.0))
    phase.p[contact_march.DRY] = dry
    assert phase.march(3.0) == why
    assert why != contact_march.HELD or phase.front[TIME] == near(0.5, rel=4e-16)


@pytest.mark.parametrize(('numbers', 'low', 'took', 'tilt', 'steps'), [
    ({'DRY': 1.0}, 4.0, [3.6e-6] * 9, 0.0, 4), ({'VISCOUS': 1.0}, 4.0, [3.6e-6] * 9, 0.0, 4),
    ({'FILM': 1.0}, -4.0, [3.6e-6] * 9, 0.0, 4), ({'DRY': 1.0}, 4.0, [4.4e-6] * 9, 0.0, 0),
    ({}, 4.0, [3.6e-6] * 9, 0.0, 0), ({'DRY': 1.0, 'KIND': 0.0}, 4.0, [3.6e-6] * 9, 0.0, 0),
    ({'DRY': 1.0}, 4.0, [3.6e-6] * 9, 1e-3, 0), ({'DRY': 1.0}, 4.0, [3.6e-6] * 9, 2.5e-4, 4),
    ({'DRY': 1.0}, 4.0, ([3.6e-6] * 3 + [4.4e-6]) * 2 + [3.6e-6], 0.0, 0)])
def test_a_ring_that_is_almost_flat_is_left_after_many_steps_in_a_row_that_are_short(
        numbers, low, took, tilt, steps, monkeypatch):
    """Below 1e-5 of the time sqrt(4)/(5 rad/s) in which it falls; only where a rolling rubs."""
    monkeypatch.setattr(KERNELS, 'CROWD', 3)
    sizes, numbers = iter(took), {'KIND': TORUS, 'RATE': 5.0} | numbers
    _, phase = driven(monkeypatch, short(ROLLING, 1.0, 9, **numbers), lambda h: next(sizes),
                      watched=lambda time: {contact_march.STOPS: low}, most=1.0)
    phase.front[0] = tilt    # half of the inclination
    assert phase.march(9.0) == (contact_march.FAILED if steps else contact_march.RUNNING)
    assert phase.meta[contact_march.STEPS] == (steps or 9)


@pytest.mark.parametrize(('mode', 'before', 'after', 'stuck'), [
    (SLIDING, 9.0, 0.9, True), (SLIDING, 9.0, 1.0, True), (SLIDING, 9.0, 1.1, False),
    (SLIDING, 0.5, 0.9, False), (SLIDING, 0.9, 0.9, False), (ROLLING, 9.0, 0.9, False)])
def test_a_slip_that_falls_below_the_rounding_of_the_speeds_is_dead(mode, before, after, stuck,
                                                                    monkeypatch):
    """At 2^-56 of 3 m/s or below; one that does not fall any more is not."""
    least = 3.0 * 2.0 ** -56
    _, phase = driven(monkeypatch, short(mode, 1.0, SWIFT=3.0),
                      pace=lambda time: least * (after if time else before))
    assert phase.march(0.0) == (contact_march.STUCK if stuck else contact_march.RUNNING)


@pytest.mark.parametrize(('mode', 'share', 'fades', 'dies'), [
    (SLIDING, 0.9e-3, 6, 0), (SLIDING, 1e-3, 6, 0), (SLIDING, 1.1e-3, 0, 0),
    (ROLLING, 0.9e-3, 0, 0), (SLIDING, 0.9 * 2.0 ** -50, 6, 6), (SLIDING, 2.0 ** -50, 6, 6),
    (SLIDING, 1.1 * 2.0 ** -50, 6, 0),
    (ROLLING, 0.9 * 2.0 ** -50, 0, 0)])
def test_steps_in_a_row_of_a_slip_that_fades_are_counted(mode, share, fades, dies, monkeypatch):
    """Not above a thousandth of 3 m/s at its end; where it dies, not above 2^-50 of that."""
    _, phase = driven(monkeypatch, short(mode, 1.0, SWIFT=3.0, FADED=5.0, CROWDED=5.0),
                      pace=lambda time: 3.0 * share if time else 1.0)
    phase.march(0.0)
    assert phase.meta[[contact_march.FADED, contact_march.CROWDED]].tolist() == [fades, dies]


@pytest.mark.parametrize(('mode', 'ratio', 'jams'), [
    (SLIDING, 1100.0, 6), (SLIDING, 900.0, 0), (ROLLING, 1100.0, 0)])
def test_steps_in_a_row_that_are_too_short_for_a_jam_are_counted(mode, ratio, jams, monkeypatch):
    """Shorter than a thousandth of the time until A = 0: that is `ratio` times the step."""
    _, phase = driven(
        monkeypatch, short(mode, 1.0, JAMMED=5.0),
        watched=lambda time: {contact_march.FIRMNESS: 5e-4 * (ratio if time else ratio + 1.0)
                              / (ratio + 1.0)})
    phase.march(0.0)
    assert phase.meta[contact_march.JAMMED] == jams


@pytest.mark.parametrize(('omega', 'fastest'), [((2.0, -3.0, 6.0), 7.0), ((2.0, -1.0, 2.0), 5.0)])
def test_the_scale_of_the_rates_is_the_fastest_turn_so_far(omega, fastest, monkeypatch):
    _, phase = driven(monkeypatch, short(ROLLING, 1.0, RATE=5.0), omega=omega)
    phase.march(0.0)
    assert phase.meta[contact_march.RATE] == near(fastest, rel=1e-15)


def test_a_state_within_a_step_is_there_where_its_stages_do_not_settle():
    """A body that hardly turns: rounding moves its stages on beside their own size.

    Such parts of a step were left out: states were those of other times, by up to 0.25 s.
    """
    mu = 1e-9
    scene = parse_scene('scene: s\nconstraint: table\n'
                        'body: {mass: 0.2, shape: {solid_sphere: {radius: 0.03}}, '
                        'surface: {sphere: {radius: 0.03}}}\n'
                        f'effects: [gravity: {{g: 9.81}}, sliding_friction: {{mu: {mu}}}]\n'
                        'initial: {velocity: [1, 0, 0]}\n')
    # the last three were left out
    times = np.array([10.0, 330.0, 460.0, 500.0] if SOAK else [10.0, 330.0])
    found = Simulation(scene, 'gauss16', accuracy=1e-9, horizon=1000.0).states(times)
    place = times - 0.5 * mu * 9.81 * times * times
    assert np.abs(found.position[:, 0] - place).max() < 1e-10    # measured: 1.3e-12
