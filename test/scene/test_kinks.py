# SPDX-License-Identifier: Apache-2.0
"""Kinks of expressions and dry friction: located to round-off, so methods keep their orders."""

import math

import mpmath
import numpy as np
import pytest
from near import near
from soak import IN_SOAK, SOAK

from rigid_body_sim.errors import BadInput, NotConverged
from rigid_body_sim.integrators import runnable
from rigid_body_sim.integrators.solver import Stepped
from rigid_body_sim.scene.effects.wrench import Wrench
from rigid_body_sim.scene.scene import parse_scene

HINGE = '{hinge: {axis: [0, 0, 1]}}'
I = 0.5    # kg m^2 about the axis


def scene_of(effects, initial, constraint='free'):
    return parse_scene('scene: a\nbody: {mass: 2.0, inertia: [0.3, 0.3, 0.5]}\n'
                       f'constraint: {constraint}\neffects: {effects}\ninitial: {initial}\n')


def followed(scene, time, method='dop8', **control):
    """Return the rate at a time, the times of the kinks, the ledger's entries and the state."""
    solver, out = started(scene, time, method, control)
    return float(out[7]), solver._course.kinks(time), solver.entries(time), out


def started(scene, time, method='dop8', control=None):
    """Return the solver of a scene from its start and the state at a time."""
    solver = Stepped(scene, method, **(control or {'accuracy': 1e-13})).start(scene.initial.vector)
    out = np.empty(14)
    solver.state(time, out)
    return solver, out


@pytest.mark.without_numba
def test_kinks_are_where_they_are_and_cost_no_accuracy():
    for text, time, rate, kinks in (
            ('where(t < 1, 0.1, -0.2)', 2.0, 1.0 + (0.1 - 0.2) / I, [1.0]),
            ('where(1 <= t, 0.1, -0.2)', 2.0, 1.0 + (0.1 - 0.2) / I, [1.0]),
            ('abs(sin(3*t))', math.pi, 1.0 + 2.0 / I, [math.pi / 3, 2 * math.pi / 3]),
            ('sign(1 - t)', 3.0, 1.0 - 1.0 / I, [1.0]),
            ('max(t - 1, 0)*min(1, 3 - t)', 2.5, 1.0 + (0.5 + 0.5 - 1 / 24) / I, [1.0, 2.0])):
        scene = scene_of(f"[torque: {{value: [0, 0, '{text}']}}]", '{spin: 1}')
        for method in ('dop8', 'gauss16')[:1 + (text == 'sign(1 - t)')]:
            found, times, entries, _ = followed(scene, time, method)
            times = [one for one in times if one < time * (1 - 1e-12)]
            assert found == pytest.approx(rate, abs=2e-14), (text, method)
            assert times == near(kinks, rel=1e-15), (text, method)
            assert entries[4] == pytest.approx(I * (rate - 1.0), abs=2e-14), (text, method)


@pytest.mark.without_numba
def test_a_well_with_a_sharp_bottom_has_the_period_of_its_parabolas():
    scene = scene_of("[potential: {energy: '2*abs(angle)'}]", '{angle: 0.5}', HINGE)
    period = 4 * math.sqrt(2 * I * 0.5 / 2.0)
    found, kinks, _, _ = followed(scene, 1.25 * period + 0.01)
    assert np.array(kinks) / period == near([0.25, 0.75, 1.25], rel=1e-14)
    assert found == near(-2.0 / I * (period / 4 - 0.01), rel=1e-13)


@IN_SOAK
@pytest.mark.without_numba
@pytest.mark.parametrize(('method', 'order', 'steps'), [
    ('rk4', 4, (0.04, 0.02)), ('dop8', 8, (0.2, 0.1))])
def test_the_order_survives(method, order, steps):
    scene = scene_of("[potential: {energy: '2*abs(angle) + 5*angle^4'}, "
                     "torque: {value: [0, 0, '-0.1*wz*abs(wz) + max(sin(t), 0.2)']}]",
                     '{angle: 0.5}', HINGE)
    solver, exact = started(scene, 3.0, 'gauss16')
    assert len(solver._course.kinks(3.0)) > 6
    errors = [abs(started(scene, 3.0, method, {'step': step})[1][7] - exact[7]) for step in steps]
    slope = np.polyfit(np.log(steps), np.log(errors), 1)[0]
    assert slope > order - 0.6, errors


FREE_START = '{angular_velocity: [0.5, -0.6, 1], velocity: [0.5, -0.3, 0]}'
WORDS = {
    'abs': "torque: {value: [0, 0, '-2*angle - 0.3*abs(angle - 0.1)']}",
    'sign': "torque: {value: [0, 0, '-2*angle - 0.3*sign(angle + 0.05)']}",
    'min': "torque: {value: [0, 0, 'min(-2*angle, 0.3 - 3*angle - 0.1*rate)']}",
    'max': "torque: {value: [0, 0, 'max(-2*angle, -0.3 - angle*cos(t))']}",
    'where': "torque: {value: [0, 0, 'where(rate < 0.2, -3*angle, -2*angle - 0.1)']}",
    'a comparison': "torque: {value: [0, 0, '-2*angle - 0.5*(angle > 0.1)']}",
    'pieces of time': "torque: {value: [0, 0, 'where(t < 0.7, -2*angle, "
                      "where(t < 1.9, -4*angle, sin(angle)))']}",
    'one in another': "torque: {value: [0, 0, 'max(min(-2*angle, 0.4), -abs(sin(2*t)))']}",
    'in a potential': "potential: {energy: 'where(angle > 0, angle^2, 3*angle^2) "
                      "+ 0.3*abs(angle - 0.1)'}",
    'in a force on a free body': "force: {value: ['-2*max(x, 0.1)', '-2*abs(y)', 0], "
                                 "frame: world, at: [0.3, 0.1, 0]}",
    'in both angular velocities': "torque: {value: ['-0.1*abs(wx)', '-0.2*min(Wy, 0.1)', "
                                  "'0.3*sign(qz)']}"}


LIKE_OTHERS = 'abs', 'sign', 'min', 'max', 'where', 'a comparison', 'pieces of time'
"""What the other scenes have, too."""


@pytest.mark.without_numba
@pytest.mark.parametrize('word', [
    pytest.param(word, marks=IN_SOAK if word in LIKE_OTHERS else ()) for word in WORDS])
def test_every_word_is_located_and_keeps_the_order(word):
    free = 'free' in word or 'both' in word
    scene = scene_of(f'[{WORDS[word]}]', FREE_START if free else '{angle: 0.5, rate: 0.4}',
                     'free' if free else HINGE)
    (one, exact), (other, end) = started(scene, 3.0, 'gauss16'), started(scene, 3.0)
    kinks, others = one._course.kinks(3.0), other._course.kinks(3.0)
    assert len(kinks) == len(others) > 0
    # measured: 5e-16 s and 9e-16
    assert np.abs(np.subtract(kinks, others)).max() < 2e-15
    assert np.abs(end - exact)[1:].max() < 4e-15
    errors = [np.abs(started(scene, 3.0, control={'step': step})[1] - exact)[1:].max()
              for step in (0.3, 0.15)]
    # measured: 7.6 to 9.0
    assert math.log2(errors[0] / errors[1]) > 7.2, errors


def period(power):
    """Return that of x'' = -sign(x) |x|^power with the speed 1 at x = 0, s (beta function)."""
    amplitude = (0.5 * (power + 1)) ** (1 / (power + 1))
    return float(4 * amplitude / (power + 1) * mpmath.beta(1 / (power + 1), 0.5))


@pytest.mark.without_numba
@pytest.mark.parametrize(('power', 'method', 'accuracies'), [
    pytest.param(0.5, 'dop8', [1e-9], marks=IN_SOAK),
    (1.5, 'dop8', [1e-5, 1e-11] if SOAK else [1e-5, 1e-8]),
    pytest.param(1.5, 'gauss16', [1e-8], marks=IN_SOAK)])
def test_a_power_that_is_not_whole_has_its_kink_where_its_base_is_zero(power, method, accuracies):
    """A step looks beyond the kink in which it ends, where |x|^1.5 as it stands is not real."""
    scene = scene_of(f"[force: {{value: ['-2*sign(x)*abs(x)^{power}', 0, 0], frame: world}}]",
                     '{velocity: [1, 0, 0]}')
    time = period(power)
    for accuracy in accuracies:
        _, kinks, _, end = followed(scene, time, method, accuracy=accuracy, horizon=time)
        assert abs(kinks[0] - 0.5 * time) < accuracy
        # measured: 0.19 of it
        assert max(abs(end[8]), abs(end[11] - 1.0)) < accuracy


@IN_SOAK
@pytest.mark.without_numba
def test_branches_of_a_kink_may_have_roots_that_end_there():
    """A ball on a Hertzian wall under a steady push, written in three ways."""
    ends = []
    for wall in ('max(x, 0)^1.5', 'where(x > 0, x^1.5, 0)',
                 'where(0 < x, x, 0)*sqrt(max(x, 0))'):
        scene = scene_of(f"[force: {{value: ['0.6 - 10*{wall}', 0, 0], frame: world}}]",
                         '{velocity: [1, 0, 0]}')
        _, kinks, _, end = followed(scene, 9.0)
        assert len(kinks) == 2
        ends.append(end)
    assert np.abs(np.array(ends[1:]) - ends[0]).max() < 1e-12


@pytest.mark.without_numba
def test_a_root_that_is_not_real_on_its_own_side_is_still_refused():
    scene = scene_of("[force: {value: ['-abs(vx)*sqrt(x)', 0, 0], frame: world}]",
                     '{velocity: [-1, 0, 0]}')
    with pytest.raises(NotConverged, match='the state is no longer finite'):
        followed(scene, 1.0)


@IN_SOAK
@pytest.mark.without_numba
def test_after_such_a_kink_fixed_steps_have_the_order_of_the_power():
    """The step behind the kink errs by h^(p + 2): what it takes is not smooth there."""
    scene = scene_of("[force: {value: ['-2*sign(x)*abs(x)^1.5', 0, 0], frame: world}]",
                     '{velocity: [1, 0, 0]}')
    time = period(1.5)
    steps = [time / n / 1.013 for n in (40, 80)]
    errors = [abs(followed(scene, time, step=step)[3][8]) for step in steps]
    slope = np.polyfit(np.log(steps), np.log(errors), 1)[0]
    assert slope == pytest.approx(2.5, abs=0.2), errors


@pytest.mark.without_numba
def test_dry_friction_takes_the_same_from_every_swing_and_stops():
    """On a torsion spring k a friction T takes 2 T/k from each half swing of pi sqrt(I/k)."""
    scene = scene_of('[spring: {stiffness: 50}, dry_friction: {torque: 3}]', '{angle: 0.5}', HINGE)
    half, lost = math.pi * math.sqrt(I / 50), 2 * 3 / 50
    _, kinks, entries, end = followed(scene, 2.5)
    assert kinks == near([n * half for n in (1, 2, 3, 4)], rel=2e-15)
    out = np.empty((4, 14))
    solver = Stepped(scene, 'dop8', accuracy=1e-13).start(scene.initial.vector)
    solver.states(np.array(kinks), out)
    turns = [(-1) ** n * (0.5 - n * lost) for n in (1, 2, 3, 4)]
    assert 2 * np.arctan2(out[:, 3], out[:, 4]) == pytest.approx(turns, abs=1e-15)
    assert not end[5:8].any()
    assert 2 * math.atan2(end[3], end[4]) == pytest.approx(turns[-1], abs=1e-15)
    assert entries[1] == near(0.5 * 50 * (0.5 ** 2 - 0.02 ** 2), rel=2e-15)
    found = {round(time / half) for time, name, _ in solver.events(0.0, 2.5)
             if name == 'turning point'}
    assert found >= {1, 2, 3}


@pytest.mark.without_numba
def test_friction_bears_a_torque_until_it_outgrows_it():
    """0.5 t N m break loose from 1 N m at 2 s: I rate = (t - 2)^2/4 from there on."""
    scene = scene_of("[torque: {value: [0, 0, '0.5*t']}, dry_friction: {torque: 1}]", '{}', HINGE)
    rate, (loose,), _, _ = followed(scene, 3.0, accuracy=1e-11)
    assert loose == near(2.0, rel=1e-15)
    assert rate == near(0.25 / I, rel=1e-11)
    for torque, moves in ((0.9, False), (1.1, True)):
        scene = scene_of(f'[torque: {{times: [0, 1], values: [[0, 0, 0], [0, 0, {torque}]]}}, '
                         'dry_friction: {torque: 1}]', '{}', HINGE)
        rate, _, _, _ = followed(scene, 3.0)
        assert rate == near(0.1 * 2.0 / I if moves else 0.0, rel=1e-14)


@pytest.mark.without_numba
def test_what_slides_along_a_kink_says_so():
    scene = scene_of("[torque: {value: [0, 0, '-0.1*sign(wz)']}]", '{spin: 1}')
    with pytest.raises(NotConverged, match=r'at t = 5\.0.* s the body slides along a kink'):
        followed(scene, 10.0)
    # a kink on which nothing drives the body stays as it is
    scene = scene_of("[torque: {value: ['-0.1*sign(wx)', 0, 0]}]", '{spin: 1}')
    assert followed(scene, 10.0)[0] == 1.0


def test_only_methods_that_stop_at_kinks_run_them():
    able = runnable(scene_of("[torque: {value: [0, 0, 'abs(t - 1)']}]", '{}'))
    assert able == ['dop8', 'gauss16', 'rk4']
    able = runnable(scene_of('[dry_friction: {torque: 1}]', '{}', HINGE))
    assert able == ['dop8', 'gauss16', 'split2', 'rk4', 'semi_implicit_euler']


@pytest.mark.parametrize(('effect', 'constraint', 'words'), [
    ("torque: {value: [0, 0, 'where(t, 1, 2)']}", 'free', 'where without a comparison'),
    ("torque: {value: [0, 0, 'where(t < 1, 1)']}", 'free', 'where with 2 arguments'),
    ("torque: {value: [0, 0, '0 < t < 1']}", 'free', 'is not part of the language'),
    ("torque: {value: [0, 0, 't == 1']}", 'free', 'is not part of the language'),
    ('dry_friction: {torque: 0}', HINGE, 'needs a number above 0'),
    ('dry_friction: {torque: 1}', 'pivot', "cannot act on constraint 'pivot'")])
def test_what_does_not_fit_gets_one_line(effect, constraint, words):
    with pytest.raises(BadInput, match=words):
        scene_of(f'[{effect}]', '{}', constraint)


def turned(out):
    """Return the angle of a state about z, from -2 pi to 2 pi."""
    return 2 * math.atan2(out[3], out[4])


WOUND = '{angle: 0.5, rate: 14}'


@pytest.mark.without_numba
def test_a_torsion_spring_goes_on_from_the_other_end_beyond_a_turn():
    """Between two jumps from 2 pi to -2 pi it is a harmonic oscillator."""
    scene = scene_of('[spring: {stiffness: 2}]', WOUND, HINGE)
    with mpmath.workdps(30):
        w, end = mpmath.sqrt(2 / mpmath.mpf(I)), 2 * mpmath.pi
        # a + i v/w turns by -w t
        after = mpmath.mpc(end, mpmath.sqrt(14 ** 2 + (w * 0.5) ** 2 - (w * end) ** 2) / w)
        passage = (mpmath.arg(mpmath.mpc(0.5, 14 / w)) - mpmath.arg(after)) / w
        period = (mpmath.arg(-mpmath.conj(after)) - mpmath.arg(after)) / w
        jumps = [float(passage), float(passage + period)]
        time = float(passage + 1.25 * period)
        exact = -mpmath.conj(after) * mpmath.expj(-w * (time - passage - period))
        expected = float(exact.real), float(w * exact.imag)
    ends = []
    for method in ('dop8', 'gauss16'):
        solver, out = started(scene, time, method)
        kinks = np.array(solver._course.kinks(time))
        assert np.abs(kinks[:, np.newaxis] - jumps).min(axis=0).max() < 2e-15, method
        ends.append(out)
    # half an ulp of its rate of 14 rad/s moves it by 4.8e-15 and 7.8e-15; measured: 9.8e-15 and
    # 1.8e-14
    for out in ends:
        assert turned(out) == pytest.approx(expected[0], abs=1e-14)
        assert out[7] == pytest.approx(expected[1], abs=2e-14)


@pytest.mark.without_numba
@pytest.mark.parametrize(('method', 'order'), [
    pytest.param('rk4', 4, marks=IN_SOAK), ('dop8', 8)])
def test_the_order_survives_where_the_angle_jumps(method, order):
    scene = scene_of("[torque: {value: [0, 0, '-2*angle - 0.3*angle*cos(angle)']}]", WOUND, HINGE)
    solver, exact = started(scene, 1.3, 'gauss16', {'accuracy': 1e-12})
    assert len(solver._course.kinks(1.3)) == 2
    errors = [abs(started(scene, 1.3, method, {'step': step})[1][7] - exact[7])
              for step in (0.1, 0.05)]
    # measured: 4.1 and 8.3
    assert math.log2(errors[0] / errors[1]) > order - 0.2, errors


@pytest.mark.without_numba
def test_only_what_jumps_where_the_body_gets_has_the_kink():
    for effects, start, winds in (
            ("torque: {value: [0, 0, '-sin(angle) + 0.1*cos(angle/2 - t)']}", WOUND, False),
            ('gravity: {g: 9.81}', WOUND, False),
            ("potential: {energy: '3*angle'}", WOUND, False),
            ("torque: {value: [0, 0, 'cos(angle/3)']}", WOUND, True),
            ("torque: {value: [0, 0, '-0.1*angle']}", '{}', True),    # no energy known
            ('spring: {stiffness: 2, damping: 0.1}', WOUND, True),
            ('spring: {stiffness: 2, damping: 0.1}', '{angle: 6, rate: 1}', False),
            ("spring: {stiffness: 2}, torque: {value: [0, 0, '-rate'], books: heat}", '{}', True),
            ('spring: {stiffness: 2}, strike: {impulse: [0, 9, 0], point: [1, 0, 0]}', '{}',
             True)):
        scene = scene_of(f'[{effects}]', start, HINGE)
        assert scene.constraint.winds == winds, effects
        assert ('taylor' in runnable(scene)) != winds, effects


@pytest.mark.without_numba
@pytest.mark.parametrize('method', ['taylor', 'gauss16'])
def test_a_start_with_more_energy_has_the_kink_of_its_scene(method):
    """A command gives the body a rate that the start of the scene does not have."""
    low, high = (scene_of('[spring: {stiffness: 2}]', start, HINGE)
                 for start in ('{angle: 0.5}', WOUND))
    assert not low.constraint.winds
    solver = Stepped(low, method, accuracy=1e-9).start(high.initial.vector)
    out, exact = np.empty(14), started(high, 0.6)[1]
    solver.state(0.6, out)
    assert len(solver._course.kinks(0.6)) == 1
    assert np.abs(out - exact).max() < 1e-9


@pytest.mark.without_numba
def test_many_starts_and_a_held_wrench_have_the_kink():
    scene = scene_of('[spring: {stiffness: 2}]', '{angle: 0.5}', HINGE)
    starts = np.array([scene_of('[]', start, HINGE).initial.vector
                       for start in ('{angle: 0.5}', WOUND)])
    many, out = np.empty((2, 1, 14)), np.empty(14)
    solver = Stepped(scene, 'taylor', accuracy=1e-9)
    solver.many(starts, np.array([0.6]), many)
    for start, found in zip(starts, many, strict=True):
        solver.start(start).state(0.6, out)
        assert np.array_equal(found[0], out)
    assert turned(out) < -4.0
    pushed = Stepped(scene, 'gauss16', accuracy=1e-9, wrench=Wrench(torque=(0.0, 0.0, 30.0)))
    assert pushed.start(starts[0])._course.kinks(0.6)
