# SPDX-License-Identifier: Apache-2.0
"""What a choice is made by: settings, rates of dissipation, closed forms, by hand."""

import math
import types

import numpy as np
import pytest
from choice.known_bodies import SLOW, TORQUE, coasting_scene
from near import near

from rigid_body_sim.choice import choose as module
from rigid_body_sim.choice.choose import choose
from rigid_body_sim.choice.closed_form import ClosedForm
from rigid_body_sim.choice.settling import Settled
from rigid_body_sim.errors import BadInput
from rigid_body_sim.integrators.protocols import FINEST
from rigid_body_sim.scene.scene import load_scene, parse_scene
from rigid_body_sim.scene.state import State


@pytest.mark.parametrize('settings', [
    ('auto', FINEST, None, 1.0), ('exact', 1.0, None, 1e300), ('dop8', 1e-9, 5e-324, 1e-300)])
def test_settings_that_a_scene_could_have_pass(settings):
    module._check(*settings)


@pytest.mark.parametrize(('settings', 'words'), [
    (('auto', math.nextafter(FINEST, 0.0), None, 1.0), 'accuracy: got'),
    (('auto', math.nextafter(1.0, 2.0), None, 1.0), 'accuracy: got'),
    (('auto', math.nan, None, 1.0), 'accuracy: got nan'), (('dop8', 1e-9, 0.0, 1.0), 'step: got'),
    (('dop8', 1e-9, math.inf, 1.0), 'step: got inf'), (('dop8', 1e-9, -1.0, 1.0), 'step: got'),
    (('dop9', 1e-9, None, 1.0), "integrator: got 'dop9'; did you mean 'dop8'?"),
    (('magic', 1e-9, None, 1.0), "integrator: got 'magic'; one of auto, exact"),
    (('auto', 1e-9, None, 0.0), 'horizon: got'), (('auto', 1e-9, None, math.inf), 'horizon: got')])
def test_settings_that_no_scene_could_have_are_refused(settings, words):
    with pytest.raises(BadInput) as refusal:
        module._check(*settings)
    assert str(refusal.value).startswith(words)


@pytest.mark.parametrize(('coefficient', 'inertia', 'rates'), [
    (0.5, '[1, 4, 4]', (0.25, 1.0)), (0.5, '[1, 1, 1]', (0.25, 0.25)),
    (0.5, '[0.5, 4, 4]', (0.125, 1.0)), (1.0, '[1, 1, 1]', (0.5, 0.5))])
def test_dissipation_is_as_fast_as_the_momentum_and_faster_about_slim_axes(coefficient, inertia,
                                                                           rates):
    """It is c L about the largest axis, and I_max/I_min times that about the smallest.

    Here L = 0.5 I_min, since the body turns about that axis. Both are quotients of the rate
    L/I_max.
    """
    scene = parse_scene(f'scene: s\nbody: {{mass: 1, inertia: {inertia}}}\nconstraint: free\n'
                        f'effects: [internal_dissipation: {{coefficient: {coefficient}}}]\n'
                        'initial: {angular_velocity: [0.5, 0, 0]}\n')
    assert module._inner_rates(scene) == near(rates, rel=1e-15)
    assert module._inner_rates(coasting_scene()) == (0.0, 0.0)


@pytest.mark.without_numba
def test_the_same_choice_is_given_for_the_same_scene_start_and_settings():
    scene = load_scene('tennis_racket')
    one = choose(scene, accuracy=1e-9)
    assert choose(scene, accuracy=1e-9) is one
    assert choose(scene, accuracy=1e-8) is not one
    assert choose(load_scene('tennis_racket'), accuracy=1e-9) is not one
    start = State.of(angular_velocity=(0.0, 1.0, 0.0)).vector
    same, moved = (module._Same(scene, vector.tobytes())
                   for vector in (scene.initial.vector, start))
    assert hash(same) == hash(moved) and same != moved
    assert same == module._Same(scene, np.copy(scene.initial.vector).tobytes())


@pytest.mark.parametrize(('coefficient', 'inertia', 'stiff'), [
    (19.8, '[1, 1, 1]', set()), (20.2, '[1, 1, 1]', {'dissipation'}),
    (10.2, '[1, 2, 2]', {'dissipation'})])
def test_dissipation_is_stiff_from_ten_times_the_rate_of_the_body_on(coefficient, inertia, stiff):
    """Of a body of equal moments it is c L/I over L/I^2, here c/2; about a slim axis twice that.

    One of the two rates suffices.
    """
    scene = parse_scene(f'scene: s\nbody: {{mass: 1, inertia: {inertia}}}\nconstraint: free\n'
                        f'effects: [internal_dissipation: {{coefficient: {coefficient}}}]\n'
                        'initial: {angular_velocity: [0.5, 0, 0]}\n')
    assert module._stiff(scene) == stiff


@pytest.mark.without_numba
def test_a_choice_by_a_motion_takes_no_steps_and_keeps_what_was_settled():
    scene = load_scene('tennis_racket')
    one = choose(scene)
    assert (one.method, one.accuracy, one.horizon) == ('exact', 1e-12, 100.0)
    assert (one.settled.method, one.settled.tolerance) == ('exact', 1e-12)
    assert choose(scene, settled=one.settled).settled is one.settled
    with pytest.raises(BadInput, match='a closed form takes no steps'):
        choose(scene, 'exact', step=0.01)
    with pytest.raises(BadInput, match=r'cannot run the scene struck; those that can: .*dop8'):
        choose(parse_scene(SLOW.replace('EFFECTS', TORQUE)), 'exact')


class Asked:
    """What a choice asks of others, and their answers.

    Of a closed form: whether it was named, and the Choice.
    """

    def __init__(self, monkeypatch, closed=None, settled=None, rates=(0.0, 0.0)):
        self.named, self.able, self.wanted, self.coarsest = None, None, None, None
        self.together = 0
        scene = coasting_scene()
        self.same = module._Same(scene, scene.initial.vector.tobytes())

        def by_motion(scene, named, accuracy, horizon, before):
            self.named = named
            return closed

        def settle(scene, able, wanted, horizon, coarsest):
            self.able, self.wanted, self.coarsest = able, wanted, coarsest
            return settled

        def side_by_side(settled, settle, able, accuracy):
            self.together += 1
            return settled
        monkeypatch.setattr(module, '_by_motion', by_motion)
        monkeypatch.setattr(module, '_inner_rates', lambda scene: rates)
        monkeypatch.setattr(module.settling, 'settle', settle)
        monkeypatch.setattr(module.settling, 'side_by_side', side_by_side)

    def choose(self, integrator='auto', accuracy=1e-6, step=None, settled=None, together=False):
        return module._chosen.__wrapped__(self.same, integrator, accuracy, step, 10.0, settled,
                                          together)


@pytest.mark.without_numba
@pytest.mark.parametrize(('integrator', 'step', 'before', 'named'), [
    ('auto', None, None, False), ('exact', None, None, True), ('auto', 0.1, None, None),
    ('dop8', None, None, None), ('auto', None, 'exact', True), ('auto', None, 'dop8', None)])
def test_a_motion_is_looked_for_unless_a_method_or_a_step_is_given(integrator, step, before, named,
                                                                   monkeypatch):
    """One that `auto` took before counts as named: it is taken again."""
    closed = types.SimpleNamespace(ends=False, missed=None)
    asked = Asked(monkeypatch, closed, Settled('dop8', 1e-9, 1e-10, 10.0))
    found = asked.choose(integrator, step=step, settled=before and Settled(before, 1e-9))
    assert asked.named == named
    assert (found is closed) == (named is not None)


@pytest.mark.without_numba
@pytest.mark.parametrize(('ends', 'missed', 'error', 'settled', 'taken'), [
    (False, 'missed', 1e-3, 1e-9, True), (True, None, 1e-3, 1e-9, True),
    (True, 'missed', 1e-3, 1e-9, False), (True, 'missed', 1e-3, 1e-3, True),
    (True, 'missed', 0.5, None, False)])
def test_a_motion_that_a_strike_ends_gives_way_to_a_method_that_errs_less(
        ends, missed, error, settled, taken, monkeypatch):
    """An error that is not told is that of a method that needed no trial: the table promises."""
    closed = types.SimpleNamespace(ends=ends, missed=missed, expected_error=error)
    asked = Asked(monkeypatch, closed, Settled('dop8', 1e-9, settled, 10.0))
    assert (asked.choose() is closed) == taken


@pytest.mark.without_numba
@pytest.mark.parametrize(('rates', 'integrator', 'accuracy', 'tolerance'), [
    # ten times the rate of the body is stiff; about the other axes it ends no wobble
    ((20.0, 20.0), 'auto', 1e-6, 1e-9), ((1.0, 20.0), 'auto', 1e-6, 1e-7),
    ((20.0, 20.0), 'radau', 1e-6, 1e-9), ((20.0, 20.0), 'radau', 1e-11, 1e-11),
    ((1.0, 20.0), 'radau', 1e-6, 1e-6)])
def test_stiff_dissipation_takes_a_tolerance_that_leaves_no_wobble(rates, integrator, accuracy,
                                                                   tolerance, monkeypatch):
    asked = Asked(monkeypatch, settled=Settled('radau', 1e-7, 1e-7, 10.0), rates=rates)
    found = asked.choose(integrator, accuracy)
    assert (found.method, found.tolerance, found.accuracy) == ('radau', tolerance, accuracy)
    assert found._prototype.accuracy == tolerance
    if integrator == 'auto':
        wobbles = rates[0] > 10.0
        assert (asked.wanted, asked.coarsest) == (
            (1e-9, 1e-9) if wobbles else (1e-6, math.inf))
        # 20 times the rate of the body is stiff: dop8 takes just that, radau stiff drag, too
        assert {'dop8', 'radau'} <= set(asked.able) and 'gauss16' not in asked.able


@pytest.mark.without_numba
@pytest.mark.parametrize('together', [False, True])
def test_a_method_that_has_bodies_side_by_side_is_asked_for_where_there_are_many(
        together, monkeypatch):
    asked = Asked(monkeypatch, settled=Settled('dop8', 1e-9, 1e-10, 10.0))
    assert asked.choose(together=together).method == 'dop8'
    assert asked.together == int(together)


@pytest.mark.parametrize('settings', [{}, {'together': True}])
def test_one_body_is_chosen_for_unless_many_are_said(settings, monkeypatch):
    asked = []
    monkeypatch.setattr(module, '_chosen', lambda *settings: asked.append(settings))
    choose(coasting_scene(), **settings)
    assert asked[0][1:] == ('auto', 1e-12, None, 100.0, None, bool(settings))


@pytest.mark.without_numba
@pytest.mark.parametrize(('step', 'same'), [(None, True), (0.1, False)])
def test_a_choice_keeps_what_its_trials_have_made_ready(step, same, monkeypatch):
    """Fixed steps were not tried."""
    made = types.SimpleNamespace(at=lambda tolerance, wanted: (tolerance, wanted))
    asked = Asked(monkeypatch, settled=Settled('dop8', 1e-9, 1e-10, 10.0, prototype=made))
    assert (asked.choose(step=step)._prototype == (1e-9, 1e-6)) == same


@pytest.mark.parametrize(('error', 'floor', 'named', 'taken'), [
    (1e-9, 0.0, False, True), (1.01e-9, 0.0, False, False), (1.01e-9, 0.0, True, True),
    (2e-9, 2e-9, False, True), (2.1e-9, 2e-9, False, False)])
def test_the_motion_of_a_scene_nearly_this_one_errs_by_what_is_asked_or_by_rounding(
        error, floor, named, taken, monkeypatch):
    monkeypatch.setattr(module, 'closed_form', lambda *_: ClosedForm(
        'a motion', 'a scene', error, floor))
    monkeypatch.setattr(module, 'Exact', lambda *_: 'a prototype')
    found = module._by_motion('a scene', named, 1e-9, 5.0, None)
    assert (found is not None) == taken


@pytest.mark.parametrize(('plane', 'paradox', 'able', 'expected'), [
    (True, True, ['dop8', 'taylor'], ['dop8']), (True, True, ['taylor'], []),
    (True, False, ['dop8', 'taylor'], ['dop8', 'taylor']),
    (False, True, ['dop8', 'taylor'], ['dop8', 'taylor'])])
def test_series_do_not_run_a_body_that_may_meet_the_paradox(plane, paradox, able, expected,
                                                            monkeypatch):
    kind = module.Mechanism.PLANE if plane else module.Mechanism.FREE
    scene = types.SimpleNamespace(
        name='s', body=None, contact=types.SimpleNamespace(mu=1.0),
        constraint=types.SimpleNamespace(mechanism=kind))
    monkeypatch.setattr(module, 'runnable', lambda scene: able)
    monkeypatch.setattr(module, 'absorbing_motion', lambda scene: None)
    monkeypatch.setattr(module, 'may_meet_paradox', lambda body, mu: paradox)
    assert module.methods_for(scene) == expected
