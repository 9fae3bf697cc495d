# SPDX-License-Identifier: Apache-2.0
"""The error that is expected of closed forms."""

import types

import numpy as np
import pytest
from choice.known_bodies import Coasting, coasting_scene
from near import near
from scipy.spatial.transform import Rotation

from rigid_body_sim.choice import exact_forecast, runs
from rigid_body_sim.choice.choose import choose
from rigid_body_sim.integrators.protocols import FINEST
from rigid_body_sim.numerics.rotations import angle_between
from rigid_body_sim.scene.effects.wrench import Wrench
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.simulation.simulation import Simulation


@pytest.mark.without_numba
@pytest.mark.parametrize('accuracy', [1e-5, 1e-10])
def test_after_a_strike_that_ends_a_closed_form_the_error_is_that_of_what_goes_on(accuracy):
    """Drag slows a spin about the axis of symmetry in closed form, and no other rotation."""
    scene = parse_scene(
        'scene: struck\nbody: {mass: 1.0, inertia: [0.2, 0.2, 0.1]}\nconstraint: free\n'
        'effects: [drag: {angular: 0.02}, strike: {impulse: [1, 0, 0], point: [0, 0.3, 0.4], '
        'time: 0.5}]\ninitial: {spin: 9.0}')
    simulation, times = Simulation(scene, accuracy=accuracy, horizon=2.0), [1.0, 1.5, 2.0]
    fine = Simulation(scene, 'gauss16', accuracy=1e-14, horizon=2.0).states(times)
    assert simulation.choice.method == 'exact'
    error = max(angle_between(*one, *best) for one, best in zip(
        simulation.states(times).orientation, fine.orientation, strict=True))
    assert error < accuracy
    # measured: 5.3e-7 where 5.4e-7 is told, and 1.6e-12 at 1e-10
    assert error / 3.0 <= simulation.choice.expected_error <= 3.0 * error


@pytest.mark.without_numba
def test_a_closed_form_gives_way_where_what_goes_on_after_a_strike_misses():
    """The general method that goes on runs untried; the one that is chosen instead was tried."""
    scene = parse_scene(
        'scene: thrown\nbody: {mass: 0.354, inertia: [0.72, 0.734, 0.043], '
        'center_of_mass: [-0.44, 1.05, 0.036]}\nconstraint: free\n'
        'effects: [gravity: {g: 3.7}, drag: {linear: 0.03, angular: 0.00068}, '
        'strike: {impulse: [-0.6, -0.03, -0.35], point: [-0.55, 0.64, 0.0056], time: 0.6, '
        'frame: body}]\ninitial: {euler_zyz: [1.2, 0.96, 1.4], spin: 27.0}')
    settings, times = {'accuracy': 1e-6, 'horizon': 2.2}, [1.0, 1.6, 2.2]
    fine = Simulation(scene, 'gauss16', accuracy=1e-13, horizon=2.2).states(times)
    errors = {}
    for method in ('exact', 'auto'):
        simulation = Simulation(scene, method, **settings)
        errors[method] = max(angle_between(*one, *best) for one, best in zip(
            simulation.states(times).orientation, fine.orientation, strict=True))
        assert (simulation.choice.missed is None) == (errors[method] <= 1e-6)
    # measured: 2.6e-7 by taylor, and 1.2e-6
    assert errors['auto'] <= 1e-6 < errors['exact']


def test_the_expected_error_knows_how_far_the_motion_magnifies_rounding():
    """A racket that stands still for long on its unstable axis: half an ulp grows by e^(l t)."""
    scene = parse_scene('scene: s\nbody: {mass: 1.0, inertia: [1, 2, 3]}\nconstraint: free\n'
                        'effects: []\ninitial: {angular_velocity: [1e-4, 5, 1e-4]}\n')
    horizon = 8.0
    choice = choose(scene, horizon=horizon)
    start, out, moved = scene.initial.vector, np.empty(14), np.empty(14)
    times = np.linspace(0.0, horizon, 200)[1:]
    worst = 0.0
    for part in (5, 6, 7):
        other = start.copy()
        other[part] += np.spacing(other[part]) * 2 ** 20
        for time in times:
            for vector, row in ((start, out), (other, moved)):
                choice.solver(vector, Wrench()).state(time, row)
            worst = max(worst, 0.5 * angle_between(*out[1:5], *moved[1:5]) / 2 ** 20)
    assert worst / 3.0 < choice.expected_error < 3.0 * (worst + 2 ** -53 * 5.0 * horizon)
    # a racket on its stable axis magnifies nothing
    calm = parse_scene(scene.text, {'initial.angular_velocity': [5, 1e-4, 1e-4]})
    assert choose(calm, horizon=horizon).expected_error < 2e-14


class Closed(Coasting):
    """A closed form that holds before the strike, or for ever."""

    def __init__(self, ends):
        super().__init__()
        self.motion = types.SimpleNamespace(takes=self.takes if ends else None)

    def takes(self, vector):
        return vector[0] == 0.0


class Off(Coasting):
    """Goes on with an error, rad."""

    def __init__(self, error):
        super().__init__()
        self._error = error

    def start(self, vector):
        turned = vector.copy()
        turn = Rotation.from_rotvec([0.0, 0.0, self._error])
        turned[1:5] = (Rotation.from_quat(vector[1:5]) * turn).as_quat()
        return super().start(turned)


@pytest.mark.parametrize(('own', 'accuracy', 'error'), [
    (0.0, 1e-5, 1e-5 * 127 / 128 + 1e-9), (5e-6, 1e-5, 1.5e-5 - 1e-5 / 128 + 1e-9),
    (0.0, 64.0 * FINEST, 63.0 * FINEST + 1e-9)])
def test_errors_of_what_goes_on_of_rounding_and_of_a_scene_nearly_this_one_add_up(
        own, accuracy, error, monkeypatch):
    monkeypatch.setattr(exact_forecast, 'lost', lambda *_: 1e-9 * np.ones(runs.LOOKS))
    asked, scene = [], coasting_scene((1.0, 8.0))
    found = exact_forecast.of_exact(scene, Closed(True), own, accuracy, 4.0,
                                    lambda one: asked.append(one) or Off(one))
    assert asked == [max(FINEST, accuracy / 128.0), accuracy]
    assert found.error == near(error, rel=1e-6)


def test_without_a_strike_that_ends_it_a_closed_form_errs_by_rounding_and_by_its_own(monkeypatch):
    monkeypatch.setattr(exact_forecast, 'lost', lambda *_: 1e-9 * np.ones(runs.LOOKS))
    for scene, form in ((coasting_scene(), Closed(True)), (coasting_scene((1.0, 8.0)),
                                                           Closed(False))):
        found = exact_forecast.of_exact(scene, form, 4e-9, 3.05e-9, 4.0, pytest.fail)
        assert found == near((5e-9, 2.0), rel=1e-12)    # 1e-9 + 4e-9 t/4 is met
