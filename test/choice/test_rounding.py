# SPDX-License-Identifier: Apache-2.0
"""What rounding does to a run, computed by hand."""

import math

import numpy as np
import pytest
from choice.known_bodies import Coasting, coasting_scene
from near import near
from scipy.spatial.transform import Rotation

from rigid_body_sim.choice import rounding, runs
from rigid_body_sim.integrators.solver import Stepped
from rigid_body_sim.motions import fixed_axis
from rigid_body_sim.motions.solver import Exact
from rigid_body_sim.scene.scene import load_scene, parse_scene

TIMES = np.array([1.0, 2.0, 3.0, 4.0])
HALF_ULP = 2.0 ** -53


def mean(rate, other):
    """Return the bound of the mean of a rate that decays from one value to another."""
    return (2.0 * math.sqrt(rate * other) + 0.5 * (rate + other)) / 3.0


def test_rounding_is_half_an_ulp_of_the_angle_at_the_largest_rate_from_then_on():
    """Until t a body counts as turning as fast as it does or will by t."""
    states = np.zeros((4, 14))
    states[:, 7] = 3.0, 6.0, 1.0, 2.0
    found = rounding.of_angle_turned(coasting_scene(), None, states, TIMES)
    turned = np.array([3.0, 12.0, 12.0 + mean(6.0, 1.0), 12.0 + mean(6.0, 2.0) + 2.0])
    assert found == near(HALF_ULP * (4.0 + turned), rel=1e-15)
    # what a torque added counts twice
    driven = coasting_scene(effects=('torque: {value: [0, 0, 1]}',))
    found = rounding.of_angle_turned(driven, None, states, TIMES)
    more = [0.0, 6.0, 6.0, 6.0 + mean(6.0, 2.0) - 3.0]
    assert found == near(HALF_ULP * (4.0 + turned + more), rel=1e-15)


SLOWED = """
scene: slowed
body: {mass: 1, inertia: [1, 2, 2.5]}
constraint: {hinge: {axis: [0, 0, 1]}}
effects: [drag: {linear: 0, angular: 5.0}]
initial: {rate: RATE}
"""


@pytest.mark.parametrize('horizon', [0.3, 10.0, 1e3, 1e6])
@pytest.mark.parametrize('rate', [0.1, 40.0, 5e3])
def test_a_body_that_drag_stops_rounds_what_it_turns_until_then(rate, horizon):
    """The rate is w exp(-2 t), the angle w/2 (1 - exp(-2 t)), however long the body rests."""
    one = parse_scene(SLOWED.replace('RATE', repr(rate)))
    times = runs.looks(horizon)
    prototype = Exact(one, fixed_axis)
    states = runs.run(one, prototype, one.initial.vector, times)
    found = rounding.of_angle_turned(one, prototype, states, times) / HALF_ULP - 8.0
    turned = 0.5 * rate * -np.expm1(-2.0 * times)
    # up to the first radian an eighth of a radian more may count; 1.001 to 1.08 here
    assert (found > (1.0 - 1e-12) * turned - 1e-14).all()
    assert (found < 1.1 * turned + 0.2).all()


def test_bodies_that_drag_stops_round_what_each_turns_from_its_own_time():
    one = parse_scene(SLOWED.replace('RATE', '1'))
    starts = np.zeros((5, 14))
    starts[:, 4], starts[:, 0] = 1.0, [0.0, 0.0, 90.0, 0.0, 90.0]
    starts[:, 7] = rates = np.array([40.0, 1e3, 40.0, 1.0, 1e3])
    prototype = Exact(one, fixed_axis)
    found = rounding.of_bodies(one, prototype.many, starts, 100.0) / HALF_ULP - 8.0
    assert found == near(0.5 * rates, rel=0.1)
    # a run that ends before it is slow: no more than its first rate times time
    found = rounding.of_bodies(one, prototype.many, starts[:2], 1e-3) / HALF_ULP - 8.0
    assert found == near(1e-3 * rates[:2], rel=1e-2)


@pytest.mark.parametrize(('rate', 'time', 'times'), [
    (40.0, 1.0, [0.0, *(2.0 ** -n for n in range(6, 0, -1))]), (2.0, 1.0, [0.0, 0.5]),
    (0.0, 8.0, [0.0, 4.0])])
def test_a_slowing_body_is_looked_at_in_each_half_of_the_time_before(rate, time, times):
    """The first of the times lies within the first radian."""
    assert rounding._early(rate, time).tolist() == times


@pytest.mark.parametrize(('share', 'drag', 'again'), [
    (0.5, True, False), (0.49, True, True), (0.49, False, False)])
def test_a_run_is_made_again_where_heat_halves_the_rate_by_the_first_look(share, drag, again,
                                                                          monkeypatch):
    one = parse_scene(SLOWED.replace('RATE', '2.0')) if drag else coasting_scene()
    first, states, asked = one.initial.angular_velocity[2], np.zeros((4, 14)), []
    states[:, 7] = share * first
    early = np.zeros((2, 14))
    early[:, 7] = share * first
    monkeypatch.setattr(rounding, '_early', lambda *given: asked.append(given) or
                        np.array([0.0, 0.25, 0.5]))
    monkeypatch.setattr(rounding, 'run', lambda scene, prototype, start, times: early)
    found = rounding.of_angle_turned(one, None, states, TIMES)
    until = 0.25 if again else 1.0
    turned = mean(first, share * first) * until + share * first * (TIMES - until)
    assert found == near(HALF_ULP * ((8.0 if drag else 4.0) + turned), rel=1e-14)
    assert asked == [(first, 1.0)] * again


STOPPED = """
scene: stopped
body: {mass: 1, inertia: [2, 3, 4]}
constraint: free
effects: [HEAT torque: {times: [0.5, 0.50390625, 0.625, 0.62890625], frame: body,
                   values: [[0, 0, 1e4], [0, 0, 0], [0, 0, -1e4], [0, 0, 0]]}]
initial: {}
"""


@pytest.mark.without_numba
@pytest.mark.parametrize('heat', ['', 'drag: {linear: 0, angular: 1e-6},'])
def test_a_rate_that_torques_give_and_take_between_looks_leaves_its_rounding(heat):
    """It is 9.77 rad/s for an eighth of a second, and turns the body on by half an ulp of it.

    Heat may end that: there it counts as a rate that a torque adds and that decays until a look.
    """
    one = parse_scene(STOPPED.replace('HEAT', heat))
    prototype = Stepped(one, 'dop8', 1e-9, horizon=4.0)
    states = runs.run(one, prototype, one.initial.vector, TIMES)
    assert np.abs(states[:, 5:8]).max() < 1e-4
    found = rounding.of_angle_turned(one, prototype, states, TIMES) / HALF_ULP - 4.0
    rate = 1e4 / 4.0 / 256.0
    if heat:
        assert found == near(2.0 * rate * (0.625 + 0.375 / 6.0), rel=1e-4)
    else:
        assert found[1:] == near(rate * TIMES[1:], rel=1e-12)


@pytest.mark.parametrize(('strikes', 'unseen'), [
    ([], []), ([1.5], []), ([1.25, 1.5], [1.25]), ([1.5, 2.0], [1.5]), ([1.0, 1.5], []),
    ([0.5, 0.75, 1.5, 3.25, 3.5, 3.75], [0.5, 3.25, 3.5]), ([2.25, 4.0], []), ([3.5, 5.0], [])])
def test_the_strikes_that_no_look_tells_of_are_those_soon_followed_by_another(strikes, unseen):
    """A look at the time of a strike tells what it did."""
    one = coasting_scene(*((time, 1.0) for time in strikes))
    assert rounding._unseen(one, TIMES).tolist() == unseen


@pytest.mark.parametrize(('many', 'unseen'), [(65, 64), (66, 0)])
def test_of_more_than_64_jumps_between_looks_the_looks_tell_enough(many, unseen):
    times = [0.5 + k / 1024.0 for k in range(many)]
    one = coasting_scene(effects=(
        f'torque: {{times: {times}, values: {[[0, 0, k % 2] for k in range(many)]}}}',))
    assert len(rounding._unseen(one, TIMES)) == unseen


def test_bodies_that_a_torque_speeds_up_count_what_it_adds_twice():
    """Each turns at 1.5 times its first rate, as fast as at twice that; or at the bound."""
    one = parse_scene(SLOWED.replace('RATE', '1').replace(
        'effects: [', 'effects: [torque: {value: [0, 0, 50], frame: body}, '))
    starts, asked = np.zeros((600, 14)), []
    starts[:, 7] = rates = np.arange(1.0, 601.0)

    def many(starts, times, out):
        asked.append((len(starts), times.tolist()))
        out[:] = 0.0
        out[:, :, 7] = 1.5 * starts[:, None, 7]
    found = rounding.of_bodies(one, many, starts, 4.0) / HALF_ULP - 8.0
    # 50 N m on 2.5 kg m^2 turn by 160 rad in 4 s at most
    assert found == near(np.minimum(2.0 * rates * 4.0, rates * 4.0 + 160.0), rel=1e-12)
    assert [count for count, _ in asked] == [256, 256, 88]
    for (_, times), fastest in zip(asked, (256.0, 512.0, 600.0), strict=True):
        assert times[0] == 0.0 and times[-64:] == runs.looks(4.0).tolist()
        assert 0.5 < fastest * times[1] <= 1.0


def test_bodies_that_start_when_all_is_over_do_not_run_back():
    one = parse_scene(SLOWED.replace('RATE', '1'))
    starts = np.ones((2, 14))
    assert rounding.of_bodies(one, None, starts, 1.0).tolist() == \
        rounding.of_starts(one, starts, 1.0).tolist()


def test_bodies_that_nothing_slows_do_not_run_for_their_rounding():
    one, starts = coasting_scene(), np.ones((2, 14))
    found = rounding.of_bodies(one, None, starts, 8.0)
    assert found.tolist() == rounding.of_starts(one, starts, 8.0).tolist()


@pytest.mark.parametrize(('effects', 'added'), [
    # a torque of 2 N m on moments of 4 kg m^2 turns by 0.25 t^2
    ((), 0.0), (('torque: {value: [0, 0, 2], frame: body}',), 0.25)])
def test_bodies_may_round_half_an_ulp_of_all_they_turn_from_their_starts(effects, added):
    starts = np.zeros((4, 14))
    starts[:, 5:8] = [3, 0, 4], [1, 2, 2], [0, 0, 0], [2, -3, 6]
    found = rounding.of_starts(coasting_scene(effects=effects), starts, 8.0)
    assert found == near(HALF_ULP * (4.0 + 8.0 * np.array([5, 3, 0, 7]) + added * 64.0), rel=1e-15)


def test_bodies_that_hang_may_round_what_their_weight_adds():
    """2 sqrt(M g r/I) = 2 sqrt(1 x 4 x 1/4) = 2 rad/s, with I = 3 + 1 x 1^2 about the pivot."""
    held = parse_scene('scene: s\nbody: {mass: 1, inertia: [3, 3, 4], '
                       'center_of_mass: [0, 0, -1]}\nconstraint: pivot\n'
                       'effects: [gravity: {g: 4}]\ninitial: {angular_velocity: [0, 0, 3]}\n')
    starts = np.zeros((2, 14))
    starts[1, 5:8] = 3, 4, 12
    found = rounding.of_starts(held, starts, 8.0)
    assert found == near(HALF_ULP * (4.0 + 8.0 * np.array([2, 15])), rel=1e-15)


def test_conditioning_is_what_half_an_ulp_of_the_start_does():
    """A body that coasts about z: each number of q counts, and omega by its size times time.

    |G D|^2 = 4 h^2 |dq|^2 + (3 h t)^2 with half an ulp h on each number; what is along q is lost,
    and of the signs of a Hadamard matrix the mixed terms cancel.
    """
    one = coasting_scene()
    prototype = Coasting()
    states = runs.run(one, prototype, one.initial.vector, TIMES)
    found = rounding.conditioning(one, prototype, TIMES, states)
    expected = HALF_ULP * np.sqrt(4.0 * 3.0 + (3.0 * TIMES) ** 2)
    assert found == pytest.approx(expected, rel=0.3, abs=0.0)
    lost = rounding.lost(one, prototype, TIMES, states)
    assert lost == pytest.approx(
        np.maximum(found, rounding.of_angle_turned(one, None, states, TIMES)), abs=0.0)
    struck = coasting_scene((1.5, 1e-12), (3.0, 1e-12))
    twice = rounding.lost(struck, prototype, TIMES, states) / lost
    # what each strike rounds grows from then on
    again = np.square([[0.0, 0.25, 0.5, 0.625], [0.0, 0.0, 0.0, 0.25]]).sum(axis=0)
    again += np.square(4.0 * HALF_ULP / lost) * [0, 1, 2, 2]
    assert twice == pytest.approx(np.sqrt(1.0 + again))


NEARLY_4 = 4.0 - 2.0 ** -20    # half an ulp of it, 2^-53 times 4, is one that moves it


def moved_runs(monkeypatch, angle):
    """Let a run be turned about z by angle(w), w what its start was moved by in half ulps.

    Returns the scene, the run that is not moved, and a list of the moves.
    """
    moves = []
    one = parse_scene('scene: s\nbody: {mass: 1, inertia: [1, 2, 3]}\nconstraint: free\neffects: '
                      f'[]\ninitial: {{angular_velocity: [0, 0, {NEARLY_4!r}]}}\n')

    def run(scene, prototype, start, times):
        moves.append((start[7] - NEARLY_4) * 2.0 ** 51)
        half = 0.5 * angle(moves[-1])
        states = np.zeros((len(times), 14))
        states[:, 3], states[:, 4] = np.sin(half), np.cos(half)
        return states
    monkeypatch.setattr(rounding, 'run', run)
    states = run(one, None, one.initial.vector, TIMES)
    moves.clear()
    return one, states, moves


@pytest.mark.parametrize(('angle', 'enough', 'expected', 'moves'), [
    # |G D|^2 is a mean of four: that the first two or three make it as large is enough
    (lambda w: 0.5e-9 * w, 1e-9, 0.5e-9, [1, 1, 1, 1]),
    (lambda w: 1.5e-9 * w, 1e-9, 1.5e-9 * 2 ** 0.5, [1, 1, 2 ** 16]),
    (lambda w: 1.2e-9 * w, 1e-9, 1.2e-9 * 3 ** 0.5, [1, 1, 1, 2 ** 16]),
    (lambda w: 3e-9 * w, 1e-9, 3e-9, [1, 2 ** 16]),
    # of other steps, whatever the move; a far one is less than 256 times as large
    (lambda w: 3e-9 * np.sign(w), 1e-9, 0.0, [1, 2 ** 16]),
    (lambda w: 3e-9 * np.sign(w) * (1 + 254 * (abs(w) > 2)), 1e-9, 0.0, [1, 2 ** 16]),
    (lambda w: 3e-9 * np.sign(w) * (1 + 256 * (abs(w) > 2)), 1e-9, 3e-9, [1, 2 ** 16]),
    # no longer in proportion: 0.03 rad are as good as 1, and as a far one
    (lambda w: 0.07 * np.sign(w), 1.0, 1.0, [1, 2 ** 16]),
    (lambda w: 0.04 * np.sign(w), 1.0, 1.0, [1, 1, 1, 2 ** 16]),
    (lambda w: 2e-4 * np.sign(w) * (1 + 148 * (abs(w) > 2)), 9e-5, 0.0, [1, 2 ** 16]),
    (lambda w: 2e-4 * np.sign(w) * (1 + 151 * (abs(w) > 2)), 9e-5, 2e-4, [1, 2 ** 16])])
def test_whether_half_an_ulp_does_enough_is_seen_from_few_runs(angle, enough, expected, moves,
                                                               monkeypatch):
    shares = np.array([0.1, 0.3, 1.0, 0.2])
    one, states, seen = moved_runs(monkeypatch, lambda w: shares * angle(w))
    found = rounding.conditioning(one, None, TIMES, states, enough)
    assert np.abs(seen) == near(moves, rel=1e-6)
    assert found.max() == near(expected, rel=1e-6)


@pytest.mark.parametrize(('slopes', 'moves'), [
    # changes above 0.03 rad, and all after them, are found with smaller moves
    ([1e-12, 2e-10, 3e-9, 1e-9], [23]), ([1e-12, 1e-8, 2e-5, 1e-9], [23, 10]),
    ([1e-12, 1e-8, 2e-2, 1e-9], [23, 10, 0]),
    # none is small enough: what half an ulp does
    ([1e-12, 1e-8, 2e-4, 0.1], [23, 10, 0])])
def test_a_change_is_found_by_the_largest_move_to_which_it_is_in_proportion(slopes, moves,
                                                                            monkeypatch):
    """A change bends at 0.03 rad, which would show in what is found with too large a move."""
    def angle(w):
        straight = np.array(slopes) * w
        return np.where(np.abs(straight) > 0.0301, 0.5 * straight, straight)
    one, states, seen = moved_runs(monkeypatch, lambda w: angle(w).clip(-1.0, 1.0))
    found = rounding.conditioning(one, None, TIMES, states)
    assert np.abs(seen) == near(np.exp2(np.repeat(moves, 4)), rel=1e-6)
    assert found == near(slopes if max(slopes) < 0.03 else [*slopes[:3], 0.5 * slopes[3]],
                         rel=1e-5)


def test_signs_are_such_that_mixed_terms_cancel():
    signs = np.array(rounding.SIGNS)
    assert (np.abs(signs) == 1).all()
    for part in rounding.OF_Q, rounding.OF_OMEGA:
        assert (signs[:, part].T @ signs[:, part] == 4 * np.eye(part.stop - part.start)).all()


@pytest.mark.parametrize(('share', 'asked'), [(0.9, False), (1.1, True)])
def test_conditioning_is_not_looked_for_where_the_angle_turned_is_enough(share, asked,
                                                                        monkeypatch):
    one, states, seen = moved_runs(monkeypatch, lambda w: 1e-20 * w + np.zeros(4))
    turned = rounding.of_angle_turned(one, None, states, TIMES)
    found = rounding.lost(one, None, TIMES, states, share * float(turned.max()))
    assert found == near(turned, rel=1e-15)
    assert bool(seen) == asked


def test_a_start_is_moved_by_half_ulps_of_its_numbers():
    one = coasting_scene()
    start = one.initial.vector
    moved = rounding._moved(one, start, (1, 1, -1, 1, 1, -1, -1), 2.0 ** 20)
    by = HALF_ULP * 2.0 ** 20
    assert moved[1:4] == near([by, by, -by], rel=1e-6)
    assert np.linalg.norm(moved[1:5]) == pytest.approx(1.0, abs=1e-15)
    assert moved[5:8] - start[5:8] == pytest.approx([0.0, 0.0, -3.0 * by])
    hinged = parse_scene('scene: s\nbody: {mass: 2, inertia: [1, 2, 2.5]}\n'
                         'constraint: {hinge: {axis: [1, 2, 2]}}\neffects: []\n'
                         'initial: {rate: 3}\n')
    moved = rounding._moved(hinged, hinged.initial.vector, (1, 1, 1, 1, 1, -1, -1), 2.0 ** 20)
    assert moved[5:8] == near(hinged.initial.vector[5:8] * (1.0 + by), rel=1e-15)


@pytest.mark.parametrize('name', ['euler_disk', 'rattleback'])
def test_a_start_on_a_plane_keeps_its_gap_and_the_slip_of_its_lowest_point(name):
    """A disk that was moved by 1e-9 fell through a gap of 1e-12 m, and erred by 2e-7 rad."""
    scene = load_scene(name)
    start = scene.initial.vector
    plane, body = scene.constraint, scene.body
    for signs in rounding.SIGNS:
        moved = rounding._moved(scene, start, signs, 2.0 ** 23)
        for one in start, moved:
            q, omega, velocity = one[1:5], one[5:8], one[11:14]
            arm = np.array(plane.touching(q.tolist(), body))
            lowest = Rotation.from_quat(q)
            gap = plane.normal @ (one[8:11] + lowest.apply(arm))
            slip = velocity + lowest.apply(np.cross(omega, arm))
            # measured: 4e-18 m and 6e-17 m/s
            assert abs(gap) < 2e-17
            assert np.abs(slip).max() < 2e-16
        assert np.abs(moved - start)[8:11].max() > 1e-13


@pytest.mark.parametrize('turn', [0.6, 1e-9])
def test_on_skew_axes_a_rate_is_moved_by_half_ulps_of_the_products_that_mix(turn):
    cos, sin = math.cos(turn), math.sin(turn)
    axes = np.array([[1.0, 0.0, 0.0], [0.0, cos, -sin], [0.0, sin, cos]])    # body from principal
    tensor = axes @ np.diag([1.0, 2.0, 2.5]) @ axes.T
    moved = _rate_moved((0.5 * (tensor + tensor.T)).tolist(), [3.0, 2.0, 0.01])
    expected = [3.0, cos * 2.0 + sin * 0.01, sin * 2.0 + cos * 0.01]
    assert np.abs(axes.T @ moved) == near(expected, rel=1e-6)


def test_about_a_skew_axis_of_zero_moment_no_rate_is_moved():
    moved = _rate_moved([[2, 0, 0], [0, 1, -1], [0, -1, 1]], [3.0, 2.0, -2.0])
    assert moved[1] == pytest.approx(-moved[2]) and abs(moved[1]) == pytest.approx(2.0)


def _rate_moved(inertia, rate):
    """Return the move of a rate by half ulps with equal signs, in half ulps of 1 rad/s."""
    one = parse_scene(f'scene: s\nbody: {{mass: 2, inertia: {inertia}}}\n'
                      'constraint: free\neffects: []\n'
                      f'initial: {{angular_velocity: {rate}}}\n')
    many = 2.0 ** 30
    moved = rounding._moved(one, one.initial.vector, (1,) * 7, many)
    return (moved - one.initial.vector)[5:8] / (HALF_ULP * many)
