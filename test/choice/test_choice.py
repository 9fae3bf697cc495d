# SPDX-License-Identifier: Apache-2.0
"""What a choice is: its settings, finer ones, and who goes on where a closed form ends."""

import types

import numpy as np
import pytest
from choice.known_bodies import SLOW, TORQUE
from near import near

from rigid_body_sim.choice import choice as module
from rigid_body_sim.choice.choice import Choice
from rigid_body_sim.choice.choose import choose
from rigid_body_sim.choice.forecast import Forecast
from rigid_body_sim.choice.settling import Settled
from rigid_body_sim.errors import BadInput
from rigid_body_sim.integrators.protocols import FINEST
from rigid_body_sim.scene.effects.wrench import Wrench
from rigid_body_sim.scene.scene import load_scene, parse_scene


def choice(method='dop8', step=None, prototype=None, settled=None):
    return Choice('a scene', method, 1e-9, step, 5.0, 1e-10, prototype, settled)


@pytest.mark.without_numba
@pytest.mark.parametrize(('tolerance', 'share', 'expected'), [
    (1e-6, 2.0 ** -7, 1e-6 / 128.0), (1e-6, 0.25, 0.25e-6), (1e-6, 0.0, FINEST),
    (64.0 * FINEST, 2.0 ** -7, FINEST)])
def test_a_finer_choice_has_a_share_of_the_tolerance_or_the_finest(tolerance, share, expected):
    one = choose(parse_scene(SLOW.replace('EFFECTS', TORQUE)), 'dop8', tolerance)
    finer = one.finer(share)
    assert finer.tolerance == near(expected, rel=1e-15)
    assert (finer.method, finer._prototype.accuracy) == ('dop8', finer.tolerance)
    assert one.finer().tolerance == near(max(FINEST, tolerance / 128.0), rel=1e-15)


@pytest.mark.without_numba
def test_what_has_no_finer_choice_says_so():
    scene = parse_scene(SLOW.replace('EFFECTS', TORQUE))
    with pytest.raises(BadInput, match='fixed steps are not tried'):
        choose(scene, 'dop8', step=0.01).finer()    # the accuracy that it was given has no effect
    with pytest.raises(BadInput, match='no finer run tells its error'):
        choose(scene, 'dop8', FINEST).finer()
    assert choose(load_scene('tennis_racket')).finer() is None


@pytest.mark.without_numba
@pytest.mark.parametrize(('effects', 'method', 'ends'), [
    ('drag: {angular: 0.02}, STRIKE', 'exact', True), ('drag: {angular: 0.02}', 'exact', False),
    ('STRIKE', 'exact', False), ('drag: {angular: 0.02}, STRIKE', 'dop8', False)])
def test_a_strike_may_end_a_closed_form_that_not_every_start_has(effects, method, ends):
    """Drag slows a spin about the axis of symmetry in closed form, and no other rotation."""
    strike = 'strike: {impulse: [1, 0, 0], point: [0, 0.3, 0.4], time: 0.5}'
    scene = parse_scene('scene: s\nbody: {mass: 1.0, inertia: [0.2, 0.2, 0.1]}\nconstraint: free\n'
                        f'effects: [{effects.replace("STRIKE", strike)}]\ninitial: {{spin: 9.0}}')
    found = choose(scene, method, 1e-6)
    assert found.ends == ends
    # with or without a strike another start may not have the form
    assert found.rests_on_start == ('drag' in effects and method == 'exact')


@pytest.mark.parametrize(('method', 'able', 'parts'), [
    ('dop8', None, ['prototype 0 1 2']), ('exact', None, ['prototype 0 1 2']),
    ('exact', {0, 1, 2}, ['prototype 0 1 2']), ('exact', {1}, ['prototype 1', 'general 0 2'])],
    ids=['it steps', 'every start has the motion', 'all have it', 'some have it'])
def test_bodies_that_do_not_have_the_motion_go_by_the_general_method(
        method, able, parts, monkeypatch):
    asked = []

    class Solver:
        motion = types.SimpleNamespace(takes=able)

        def __init__(self, name):
            self.name = name

        def takes(self, start):
            return start[0] in able

        def many(self, starts, times, out):
            asked.append(' '.join((self.name, *(f'{start[0]:g}' for start in starts))))
            out[:] = starts[:, np.newaxis, :1]
    monkeypatch.setattr(Choice, '_general', lambda self, wrench: Solver('general'))
    choice = Choice(None, method, 1e-9, None, 1.0, 1e-9, Solver('prototype'), None)
    starts, out = np.arange(3.0)[:, np.newaxis] * np.ones(14), np.full((3, 2, 1), np.nan)
    choice.many(starts, np.array([1.0, 2.0]), out)
    assert asked == parts
    assert out[:, :, 0].tolist() == [[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]]


@pytest.mark.parametrize(('step', 'settled', 'expected'), [
    (None, None, (1e-8, 2.0)), (0.1, None, (None, None)),
    (None, Settled('dop8', 1e-10, 1e-7, 3.0), (1e-7, 3.0))])
def test_what_was_settled_is_expected_else_what_trials_of_a_tolerance_tell(
        step, settled, expected, monkeypatch):
    """Fixed steps are not tried."""
    monkeypatch.setattr(module.settling, 'of_named', lambda *settings: Forecast(1e-8, 2.0))
    one = choice(step=step, settled=settled)
    assert (one.expected_error, one.met_until) == expected


@pytest.mark.parametrize(('settled', 'measured', 'nutation', 'line'), [
    (None, True, 0.0, False), (None, False, 0.0, True), (None, True, 9.0, True),
    (Settled('dop8', 1e-10, 1e-8, 2.0), True, 0.0, True)])
def test_a_method_that_was_named_is_tried_only_where_no_table_knows_it(
        settled, measured, nutation, line, monkeypatch):
    monkeypatch.setattr(module.settling, 'of_named', lambda *settings: Forecast(1e-8, 2.0))
    monkeypatch.setattr(module.settling, 'nutation', lambda scene: nutation)
    monkeypatch.setattr(module.measured, 'on_such', lambda scene, method: measured)
    assert choice(settled=settled).missed == (
        'the accuracy asked, 1e-09 rad, is missed: the error expected within 5 s is 1.0e-08 rad; '
        'it is met until 2 s' if line else None)


HELD, FREE = Wrench(torque=(0.0, 0.0, 1.0)), Wrench()


@pytest.mark.parametrize(('method', 'takes', 'wrench', 'expected'), [
    ('dop8', None, FREE, 'itself'), ('exact', None, FREE, 'itself'),
    ('exact', True, FREE, 'itself'), ('exact', False, FREE, 'general'),
    ('exact', None, HELD, 'general'), ('exact', True, HELD, 'general'),
    # a wrench is part of the equations that are stepped, but for power series
    ('dop8', None, HELD, 'dop8'), ('taylor', None, HELD, 'general')])
def test_the_general_method_goes_on_where_a_choice_cannot(method, takes, wrench, expected,
                                                          monkeypatch):
    def named(name):
        return types.SimpleNamespace(start=lambda start: name)

    monkeypatch.setattr(module, 'Stepped', lambda scene, name, *settings, **more: named(name))
    monkeypatch.setattr(module, 'general', lambda *settings: named('general'))
    prototype = named('itself')
    prototype.takes, prototype.is_nearly = lambda start: takes, False
    prototype.rests_on_start = method == 'exact' and takes is not None
    prototype.motion = types.SimpleNamespace(takes=None if takes is None else prototype.takes)
    assert choice(method, prototype=prototype).solver(np.zeros(14), wrench) == expected


def test_a_choice_is_shown_by_what_was_asked():
    assert repr(choice(settled=Settled('dop8', 1e-10, 1e-7, 3.0))) == (
        "Choice(method='dop8', accuracy=1e-09, step=None, horizon=5.0, tolerance=1e-10)")


@pytest.mark.parametrize(('tolerance', 'error', 'expected'), [
    (1e-11, 1e-9, (1e-11, 5.0)), (1e-11, 1.01e-9, (1e-11, None)), (0.0, 0.0, (FINEST, 5.0))])
def test_bodies_may_need_another_tolerance_than_their_scene(tolerance, error, expected):
    """An accuracy of 1e-9 rad is met throughout the 5 s if the error is at most that."""
    found = choice(prototype=types.SimpleNamespace(at=lambda tolerance: tolerance)).suited(
        tolerance, error)
    assert (found.tolerance, found.met_until) == expected
    assert (found._prototype, found.expected_error) == (expected[0], error)
