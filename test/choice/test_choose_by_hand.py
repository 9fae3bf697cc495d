# SPDX-License-Identifier: Apache-2.0
"""Settings of a choice, finer ones, and rates of dissipation, by hand."""

import math
import types

import numpy as np
import pytest
from choice.known_bodies import SLOW, TORQUE, coasting_scene
from near import near

from rigid_body_sim.choice import choose as module
from rigid_body_sim.choice.choose import choose
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


@pytest.mark.parametrize(('inertia', 'rates'), [
    ('[1, 4, 4]', (0.25, 1.0)), ('[1, 1, 1]', (0.25, 0.25)), ('[0.5, 4, 4]', (0.125, 1.0))])
def test_dissipation_is_as_fast_as_the_momentum_and_faster_about_slim_axes(inertia, rates):
    """It is c L about the largest axis, and I_max/I_min times that about the smallest.

    Here c = 0.5, and L = 0.5 I_min, since the body turns about that axis. Both are quotients of
    the rate L/I_max.
    """
    scene = parse_scene(f'scene: s\nbody: {{mass: 1, inertia: {inertia}}}\nconstraint: free\n'
                        'effects: [internal_dissipation: {coefficient: 0.5}]\n'
                        'initial: {angular_velocity: [0.5, 0, 0]}\n')
    assert module._inner_rates(scene) == near(rates, rel=1e-15)
    assert module._inner_rates(coasting_scene()) == (0.0, 0.0)


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


@pytest.mark.parametrize(('coefficient', 'stiff'), [(19.8, set()), (20.2, {'dissipation'})])
def test_dissipation_is_stiff_from_ten_times_the_rate_of_the_body_on(coefficient, stiff):
    """Of a body of equal moments it is c L/I over L/I^2, here c/2."""
    scene = parse_scene('scene: s\nbody: {mass: 1, inertia: [1, 1, 1]}\nconstraint: free\n'
                        f'effects: [internal_dissipation: {{coefficient: {coefficient}}}]\n'
                        'initial: {angular_velocity: [0.5, 0, 0]}\n')
    assert module._stiff(scene) == stiff


def test_the_rounding_beside_the_error_of_a_scene_nearly_this_one_counts_what_a_torque_adds(
        monkeypatch):
    """Half an ulp of 4, and of the angle 3 t + t^2/4: 2 N m act on moments of 4 kg m^2."""
    scene = coasting_scene(effects=('torque: {value: [0, 0, 2], frame: body}',))
    monkeypatch.setattr(module, 'absorbing_motion', lambda scene: None)
    monkeypatch.setattr(module, 'nearly_absorbing', lambda *_: ('a motion', 'a scene', 1e-12))
    found = module._closed_form(scene, 8.0)
    assert (found.motion, found.scene, found.error) == ('a motion', 'a scene', 1e-12)
    assert found.floor == near(2.0 ** -53 * (4.0 + 24.0 + 16.0), rel=1e-15)


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
    monkeypatch.setattr(module.Choice, '_general', lambda self, wrench: Solver('general'))
    choice = module.Choice(None, method, 1e-9, None, 1.0, 1e-9, Solver('prototype'), None)
    starts, out = np.arange(3.0)[:, np.newaxis] * np.ones(14), np.full((3, 2, 1), np.nan)
    choice.many(starts, np.array([1.0, 2.0]), out)
    assert asked == parts
    assert out[:, :, 0].tolist() == [[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]]
