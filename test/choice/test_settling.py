# SPDX-License-Identifier: Apache-2.0
"""What `auto` settles on, and what is told of a method that was named."""

import numpy as np
import pytest
from choice.known_bodies import SLOW, TORQUE
from near import near
from soak import IN_SOAK

from rigid_body_sim.choice import comparison, forecast, measured, runs, settling
from rigid_body_sim.choice.trial import Trial
from rigid_body_sim.integrators import METHODS
from rigid_body_sim.integrators.protocols import FINEST
from rigid_body_sim.integrators.solver import Stepped
from rigid_body_sim.numerics.rotations import angle_between
from rigid_body_sim.recording import about
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.simulation.simulation import Simulation

pytestmark = pytest.mark.without_numba

SMOOTH_ROOT = "torque: {value: ['-0.01/sqrt(1 + wx^2)', 0, 0], frame: body}"


@pytest.mark.parametrize(('errors', 'taken'), [
    ({'dop8': 0.0, 'gauss16': 0.0}, 'first'), ({'dop8': 0.0, 'gauss16': 1e-8}, 'dop8'),
    ({'dop8': 1e-8, 'gauss16': 0.0}, 'gauss16'), ({'dop8': 1e-8, 'gauss16': 1e-9}, 'gauss16'),
    ({'dop8': 1e-9, 'gauss16': 1e-8}, 'dop8'), ({'dop8': 1e-8, 'gauss16': 0.9e-8}, 'first'),
    ({'dop8': 0.9e-8, 'gauss16': 1e-8}, 'first')])
def test_another_method_is_tried_where_one_errs_by_more_than_rounding(errors, taken, monkeypatch):
    scene = parse_scene(SLOW.replace('EFFECTS', TORQUE))
    monkeypatch.setattr(Trial, 'take', lambda self, tolerance: tolerance)
    monkeypatch.setattr(
        Trial, 'excess', lambda self, tolerance, least: errors[self.prototype.method.NAME])
    first, _, _ = measured.pick(scene, list(errors), 1e-11, 6.0)
    found = settling.settle(scene, list(errors), 1e-11, 6.0)
    assert found.method == (first if taken == 'first' else taken)


@pytest.mark.parametrize(('able', 'others'), [(['dop8'], {False}), (['dop8', 'gauss16'], {True})])
def test_a_trial_knows_whether_another_method_could_run_the_scene(able, others, monkeypatch):
    scene, seen = parse_scene(SLOW.replace('EFFECTS', TORQUE)), set()
    monkeypatch.setattr(Trial, 'take', lambda self, tolerance: (
        seen.add(self._others), tolerance)[1])
    monkeypatch.setattr(Trial, 'excess', lambda *_: 0.0)
    settling.settle(scene, able, 1e-11, 6.0)
    assert seen == others


@pytest.mark.parametrize('misses', [True, False])
def test_a_method_that_was_measured_is_tried_too_where_the_first_one_misses(misses, monkeypatch):
    """It errs by a tenth of what the first one errs by."""
    scene = parse_scene(SLOW.replace('EFFECTS', TORQUE))
    first, _, _ = measured.pick(scene, ['dop8', 'gauss16'], 1e-11, 6.0)
    monkeypatch.setattr(measured, 'least_error', lambda *_: 1e-14)
    monkeypatch.setattr(Trial, 'take', lambda self, tolerance: tolerance)
    monkeypatch.setattr(Trial, 'excess', lambda *_: 0.0)
    monkeypatch.setattr(Trial, 'misses', lambda *_: misses)
    monkeypatch.setattr(Trial, 'beside', lambda *_: 0.0)
    told = {'dop8': 8e-12, 'gauss16': 8e-12, first: 8e-11}
    monkeypatch.setattr(Trial, 'forecast', lambda self, _: forecast.Forecast(
        told[self.prototype.method.NAME], 6.0))
    found = settling.settle(scene, ['dop8', 'gauss16'], 1e-11, 6.0)
    assert (found.method == first) != misses


@pytest.mark.parametrize(('cut_short', 'excess', 'patiences'), [
    (True, 1e-8, {1, 16}), (False, 1e-8, {1}), (True, 0.0, {1}), (True, np.inf, {1, 16})])
def test_a_miss_for_want_of_steps_asks_for_patience(cut_short, excess, patiences, monkeypatch):
    """A needle that is spun up takes more steps than its first rate asks for."""
    scene, seen = parse_scene(SLOW.replace('EFFECTS', TORQUE)), set()

    def take(self, tolerance):
        seen.add(self._patience)
        return tolerance
    monkeypatch.setattr(Trial, 'take', take)
    monkeypatch.setattr(Trial, 'is_cut_short', cut_short)
    monkeypatch.setattr(
        Trial, 'excess', lambda self, *_: excess if self._patience == 1 else 0.0)
    settling.settle(scene, ['dop8', 'gauss16'], 1e-11, 6.0)
    assert seen == patiences


OTHER = {
    # errors told of dop8 and of gauss16, rad; how far they are apart; whether dop8 misses; taken
    'it rounds less': (8e-11, 2e-11, 8e-11, True, 'gauss16'),
    'it rounds as much': (8e-11, 6e-11, 8e-11, True, 'dop8'),
    'it is somewhere else': (8e-11, 2e-11, 4e-10, True, 'dop8'),
    'what is asked is met': (8e-12, 2e-12, 8e-12, False, 'dop8')}


@pytest.mark.parametrize('case', OTHER.values(), ids=OTHER)
def test_a_method_that_is_doubted_is_tried_where_the_others_miss(case, monkeypatch):
    """Collocation does not see a root that comes near zero; most roots never do."""
    *told, apart, misses, taken = case
    told = dict(zip(('dop8', 'gauss16'), told, strict=True))
    scene = parse_scene(SLOW.replace('EFFECTS', SMOOTH_ROOT))
    assert measured.is_doubted(scene, 'gauss16') and not measured.is_doubted(scene, 'dop8')
    monkeypatch.setattr(Trial, 'take', lambda self, tolerance: tolerance)
    monkeypatch.setattr(Trial, 'misses', lambda *_: misses)
    monkeypatch.setattr(Trial, 'beside', lambda *_: apart)
    monkeypatch.setattr(Trial, 'forecast', lambda self, _: forecast.Forecast(
        told[self.prototype.method.NAME], 6.0))
    found = settling.settle(scene, list(told), 1e-11, 6.0, coarsest=2.0 ** -47)
    assert (found.method, found.tolerance) == (taken, 2.0 ** -47)


@pytest.mark.parametrize(('least', 'taken'), [(1.25e-14, 'gauss16'), (1.26e-14, 'dop8')])
def test_another_method_is_tried_where_its_least_error_is_as_small(least, taken, monkeypatch):
    """It is up to a quarter larger in the table."""
    told = {'dop8': 8e-11, 'gauss16': 2e-11}
    scene = parse_scene(SLOW.replace('EFFECTS', SMOOTH_ROOT))
    monkeypatch.setattr(
        measured, 'least_error', lambda _, name: {'dop8': 1e-14, 'gauss16': least}[name])
    monkeypatch.setattr(Trial, 'take', lambda self, tolerance: tolerance)
    monkeypatch.setattr(Trial, 'misses', lambda *_: True)
    monkeypatch.setattr(Trial, 'beside', lambda *_: 0.0)
    monkeypatch.setattr(Trial, 'forecast', lambda self, _: forecast.Forecast(
        told[self.prototype.method.NAME], 6.0))
    assert settling.settle(scene, list(told), 1e-11, 6.0).method == taken


@IN_SOAK    # a minute, of which the kernels take most
def test_where_one_method_rounds_by_more_than_is_asked_another_one_does_not():
    """The weights of dop8 have both signs; those of collocation are positive, and round less."""
    scene = parse_scene(SLOW.replace('EFFECTS', SMOOTH_ROOT).replace(
        '[0.3, 0.2, 0.1]', '[1.0e-6, 4.0, 1.0e-6]'))    # the middle axis magnifies rounding
    one, other = (settling.settle(scene, names, 1e-14, 8.0)
                  for names in (['dop8'], ['dop8', 'gauss16']))
    assert one.method == 'dop8' and one.expected_error > 1e-14
    assert other.method == 'gauss16'
    # measured: 6.8e-14 beside 1.9e-13
    assert other.expected_error < 0.7 * one.expected_error


FALLING = """
scene: falling
body: {mass: 1.0, inertia: [0.2, 0.3, 0.4]}
constraint: free
effects: [EFFECTS]
initial: {angular_velocity: [1.0, 0.1, 0.0]}
"""
ROOT_FROM_ZERO = "torque: {value: ['-0.3*sqrt(x)', 0, 0]}, force: {value: [1, 0, 0]}"
NAMED = {
    # a polynomial does not follow a root there
    'a root that begins at zero': (ROOT_FROM_ZERO, 'gauss16', 1e-13, True),
    'the same by dop8': (ROOT_FROM_ZERO, 'dop8', 1e-9, False),
    'smooth': ("torque: {value: ['-0.3*wx', 0, 0]}", 'gauss16', 1e-9, False)}


@pytest.mark.parametrize(('effects', 'method', 'accuracy', 'missed'), NAMED.values(), ids=NAMED)
def test_a_method_that_is_named_says_what_it_errs_by(effects, method, accuracy, missed):
    simulation = Simulation(parse_scene(FALLING.replace('EFFECTS', effects)), method,
                            accuracy=accuracy, horizon=2.0, rate=0.5)
    times = runs.looks(2.0)
    best = Stepped(simulation.scene, 'dop8', accuracy=1e-15, horizon=2.0)
    states = np.empty((len(times), 14))
    best.start(simulation.scene.initial.vector).states(times, states)
    error = comparison.apart(simulation.states(times).vector, states).max()
    # measured: 1.0 to 1.4 of the error
    assert error / 3.0 < simulation.expected_error < 3.0 * error + 2e-15
    assert (error > accuracy) == missed == bool(simulation.missed)
    assert about.method_of(simulation.choice)['expected_error'] is None    # no trial for a file
    assert Simulation(simulation.scene, 'dop8', step=0.01).expected_error is None


def test_stiff_dissipation_at_a_coarse_request_is_told_the_error_of_its_run():
    """A coarse run keeps a residual wobble, so it is finer than the trial found sufficient."""
    scene, times = parse_scene(
        FALLING.replace('EFFECTS', 'internal_dissipation: {coefficient: 4.0}'),
        {'initial.angular_velocity': [20, 3, 1]}), runs.looks(1.0)
    simulation = Simulation(scene, accuracy=1e-3, horizon=1.0, rate=1.0)
    fine = Simulation(scene, 'dop8', accuracy=1e-13, horizon=1.0, rate=1.0)
    error = comparison.apart(*(run.states(times).vector for run in (simulation, fine))).max()
    assert simulation.choice.tolerance == 1e-9
    # measured: the error; that of the tolerance found sufficient is 23 times larger
    assert error / 2.0 < simulation.expected_error < 2.0 * error


ROTOR = 'rotor: {axis: [0.3, 0.2, 1], momentum: 1.0e+5}'


@pytest.mark.parametrize(('method', 'accuracy', 'missed'), [
    ('lsoda', 1e-5, True), ('radau', 1e-3, True), ('dop8', 1e-6, False)])
def test_a_damped_nutation_counts_though_the_attitude_does_not_show_it(method, accuracy, missed):
    """A rotor of 1e5 N m s nutates at 5e4 rad/s; a finer run damps it, too."""
    scene, horizon = parse_scene(FALLING.replace('EFFECTS', ROTOR)), 2e-4
    simulation = Simulation(scene, method, accuracy=accuracy, horizon=horizon, rate=5e3)
    one, best = (run.states([horizon]) for run in (
        simulation, Simulation(scene, 'dop8', accuracy=1e-13, horizon=horizon)))
    assert angle_between(*one.orientation[0], *best.orientation[0]) < accuracy
    off = np.linalg.norm(one.angular_velocity - best.angular_velocity) / np.linalg.norm(
        best.angular_velocity)
    assert (off > accuracy) == missed == bool(simulation.missed)
    if missed:    # measured: 0.95 to 1.04 of the error
        assert off / 3.0 < simulation.expected_error < 3.0 * off


@pytest.mark.parametrize('accuracy', [1e-6, FINEST])
def test_a_nutation_is_compared_with_a_run_as_fine_as_it_takes(accuracy, monkeypatch):
    made = []

    def stepped(scene, name, accuracy, horizon):
        made.append(accuracy)
        return Stepped(scene, name, accuracy, horizon=horizon)
    monkeypatch.setattr(settling, 'Stepped', stepped)
    scene = parse_scene(FALLING.replace('EFFECTS', ROTOR))
    settling.of_named(scene, Stepped(scene, 'dop8', accuracy, horizon=5e-5), accuracy, 5e-5)
    assert made == [max(FINEST, 2.0 ** -7 * accuracy)]


def test_only_a_nutation_that_is_faster_than_the_body_counts_beside_the_attitude():
    slow = ROTOR.replace('1.0e+5', '1.0')
    assert settling.nutation(parse_scene(FALLING.replace('EFFECTS', slow))) == 0.0
    rate = settling.nutation(parse_scene(FALLING.replace('EFFECTS', ROTOR)))
    assert rate == near(1e5 / 0.4, rel=1e-3)


@pytest.mark.parametrize('momentum', [1.5, 1.55])
def test_a_nutation_counts_from_four_times_the_pace_of_the_body_on(momentum):
    axis = np.array([0.3, 0.2, 1.0]) / np.sqrt(1.13)
    turns = np.linalg.norm(np.array([0.2, 0.03, 0.0]) + momentum * axis) / 0.4
    assert (turns > 4.0 * np.hypot(1.0, 0.1)) == (momentum > 1.5)
    found = settling.nutation(parse_scene(FALLING.replace(
        'EFFECTS', ROTOR.replace('1.0e+5', str(momentum)))))
    assert found == near(turns if momentum > 1.5 else 0.0, rel=1e-12)


@pytest.mark.parametrize(('share', 'horizon', 'expected'), [
    (1e-6, 1e-4, 1e-6), (1e-6, 2.56e-2, 1e-4), (1e-6, 1e3, 1.0)])
def test_what_a_nutation_loses_grows_in_proportion_to_time(share, horizon, expected, monkeypatch):
    """64 rad of it are followed, up to 2.56e-4 s at 2.5e5 rad/s."""
    scene, seen = parse_scene(FALLING.replace('EFFECTS', ROTOR)), []

    def run(scene, prototype, start, times):
        states = np.zeros((len(times), 14))
        states[:, 5] = 2.0 * (1.0 + share * len(seen))
        states[:-1, 5] = 2.0    # the last look shows it
        seen.append(float(times[-1]))
        return states
    monkeypatch.setattr(settling, 'nutation', lambda scene: 2.5e5)
    monkeypatch.setattr(settling.runs, 'run', run)
    prototype = Stepped(scene, 'dop8', 1e-9, horizon=horizon)
    found = settling._nutation_lost(scene, prototype, horizon)
    assert found == near(expected, rel=1e-5)
    assert seen == near([min(horizon, 2.56e-4)] * 2, rel=1e-12)


@pytest.mark.parametrize(('error', 'met', 'lost', 'expected'), [
    (1e-6, 2.0, 1e-5, (1e-6, 2.0)), (1e-6, 2.0, 1e-3, (1e-3, 0.02)),
    (1e-4, 0.01, 1e-3, (1e-3, 0.01)), (None, None, 1e-3, (1e-3, 0.02)),
    (2e-3, 0.01, 1e-3, (2e-3, 0.01)), (None, None, 1e-5, (None, None))])
def test_the_larger_of_the_errors_of_attitude_and_nutation_is_told(error, met, lost, expected,
                                                                   monkeypatch):
    """It is met while it is in proportion to time, or as long as that of the attitude is."""
    scene = parse_scene(SLOW.replace('EFFECTS', TORQUE))
    monkeypatch.setattr(settling, '_nutation_lost', lambda *_: lost)
    monkeypatch.setattr(Trial, 'forecast', lambda *_: forecast.Forecast(error, met))
    found = settling.of_named(scene, Stepped(scene, 'dop8', 1e-9, horizon=2.0), 1e-5, 2.0)
    assert found == (expected if None in expected else near(expected, rel=1e-12))


def test_what_was_settled_is_the_same_where_all_that_is_told_is():
    one = settling.Settled('dop8', 1e-9, 1e-10, 3.0)
    assert one == settling.Settled('dop8', 1e-9, 1e-10, 3.0)
    for other in (('dop8', 1e-8, 1e-10, 3.0), ('taylor', 1e-9, 1e-10, 3.0),
                  ('dop8', 1e-9, 2e-10, 3.0), ('dop8', 1e-9, 1e-10, 2.0)):
        assert one != settling.Settled(*other)
    assert one != 'dop8'


@pytest.mark.parametrize(('told', 'accuracy', 'taken'), [
    (5e-10, 1e-9, 'lanes'), (2e-9, 1e-9, 'lanes'), (4e-9, 1e-9, 'first'), (4e-9, 5e-9, 'lanes'),
    (None, 1e-9, 'lanes')])
def test_side_by_side_is_preferred_where_it_errs_by_no_more_than_asked_or_than_the_first(
        told, accuracy, taken):
    names = [name for name, one in METHODS.items() if one.FAMILY.LANES]
    alone = next(name for name, one in METHODS.items() if not one.FAMILY.LANES)
    first, lanes = (settling.Settled(name, 1e-9, error, 1.0)
                    for name, error in ((alone, 3e-9), (names[0], told)))
    found = settling.side_by_side(first, lambda able: lanes, [alone, names[0]], accuracy)
    assert found is (lanes if taken == 'lanes' else first)
    # one that has lanes stays, and so does one beside which there is none
    assert settling.side_by_side(lanes, None, [alone, names[0]], accuracy) is lanes
    assert settling.side_by_side(first, None, [alone], accuracy) is first


def test_a_copy_and_a_recording_take_the_forecast_along():
    simulation = Simulation('tennis_racket', accuracy=1e-15, horizon=7.0)
    other = simulation.copy()
    assert other.choice.settled == simulation.choice.settled
    told = about.method_of(simulation.choice)
    assert told['expected_error'] > 1e-15 and 0.0 <= told['met_until'] < 7.0
