# SPDX-License-Identifier: Apache-2.0
"""Loops over starts and over scenes: `restart` and `with_` give what a new Simulation gives."""

import dataclasses
import pickle

import numpy as np
import pytest

from rigid_body_sim.choice import choose, settling
from rigid_body_sim.errors import BadInput, NotConverged
from rigid_body_sim.scene.scene import changed_scene, load_scene, parse_scene
from rigid_body_sim.scene.state import State
from rigid_body_sim.simulation.simulation import Simulation

TIMES = np.array([0.0, 3.0, 0.25, 40.0])
ASYMMETRIC = """
scene: leaning
body: {mass: 1.0, inertia: [0.03, 0.04, 0.05], center_of_mass: [0, 0, 0.1], inertia_about: origin}
constraint: pivot
effects: [gravity: {g: 9.81}]
initial: {tilt: 0.3, angular_velocity: [0.1, 0, 20]}
"""
SLIDING_BALL = """
scene: sliding
body: {mass: 0.2, shape: {solid_sphere: {radius: 0.03}}}
constraint: table
effects: [sliding_friction: {mu: 0.2, g: 9.81}]
initial: {angular_velocity: [1, 20, 3], velocity: [1, 0.1, 0]}
"""
SLIDING_SPIN = """
scene: turning
body: {mass: 1.0, inertia: [0.03, 0.04, 0.05]}
constraint: free
effects: [torque: {value: [0, 0, 0.01]}]
initial: {angular_velocity: [0, 0, 2]}
"""


def with_start(scene, start):
    return dataclasses.replace(scene, initial=State(np.array(start)))


@pytest.mark.without_numba
@pytest.mark.parametrize('name', ['tennis_racket', 'heavy_top', 'kater_pendulum', 'needle',
                                  'driven_body', 'billiard_low', 'baseball_bat'])
def test_a_closed_form_begun_anew_has_the_bits_of_a_new_simulation(name):
    simulation = Simulation(name)
    later = simulation.states([2.5])[0]
    simulation.advance(700)
    if simulation.scene.accepts_commands:
        simulation.impulse(torque=(0.0, 1e-3, 0.0))
    simulation.advance(10)
    assert simulation.restart(later) is simulation
    start = later.vector.copy()
    start[0] = 0.0
    fresh = Simulation(with_start(simulation.scene, start))
    assert simulation.tick == 0 and not simulation.wrench and simulation.time == 0.0
    alone = simulation.states(TIMES[1:2]).vector[0]    # before the start itself is asked for
    assert alone.tobytes() == fresh.states(TIMES).vector[1].tobytes()
    assert simulation.vector.tobytes() == fresh.vector.tobytes()
    for each in (simulation, fresh):
        each.advance(1234)
    assert simulation.vector.tobytes() == fresh.vector.tobytes()
    assert simulation.states(TIMES).vector.tobytes() == fresh.states(TIMES).vector.tobytes()
    assert simulation.ledger() == fresh.ledger()
    assert simulation.events == fresh.events
    assert simulation.energy == fresh.energy


def test_a_simulation_begun_anew_goes_on_the_same_after_a_pickle_and_a_reset():
    simulation = Simulation('tennis_racket')
    simulation.restart(State.of(angular_velocity=(1.0, 2.0, 3.0)))
    simulation.advance(100)
    restored, copied = pickle.loads(pickle.dumps(simulation)), simulation.copy()
    for each in (simulation, restored, copied):
        each.advance(50)
    assert simulation.vector.tobytes() == restored.vector.tobytes() == copied.vector.tobytes()
    for each in (simulation, restored):
        each.reset()
    assert simulation.tick == restored.tick == 150
    assert simulation.state.angular_velocity.tolist() == restored.state.angular_velocity.tolist()
    assert simulation.state.angular_velocity == pytest.approx([1.0, 2.0, 3.0], abs=1e-15)


@pytest.mark.parametrize('moved', [(0.0, 0.1, 2.0), (0.0, 0.0, -1.0), (0.5, 0.0, 0.0)])
def test_a_closed_form_that_rests_on_its_start_is_looked_for_again(moved):
    """About a principal axis the torque has a closed form, off it none; and back again."""
    simulation = Simulation(parse_scene(SLIDING_SPIN))
    assert simulation.choice.method == 'exact'
    simulation.restart(State.of(angular_velocity=moved))
    fresh = Simulation(with_start(simulation.scene, simulation.state.vector))
    assert simulation.choice.method == fresh.choice.method
    assert simulation.states(TIMES).vector.tobytes() == fresh.states(TIMES).vector.tobytes()
    restored = pickle.loads(pickle.dumps(simulation))
    assert restored.choice.method == fresh.choice.method
    assert restored.states(TIMES).vector.tobytes() == fresh.states(TIMES).vector.tobytes()
    simulation.restart(simulation.scene.initial)
    assert simulation.choice.method == 'exact'


@pytest.mark.without_numba
def test_a_method_and_its_tolerance_stay_without_a_trial(monkeypatch):
    simulation = Simulation(parse_scene(ASYMMETRIC), accuracy=1e-6, horizon=2.0)
    settled = simulation.choice.settled
    monkeypatch.setattr(settling, 'settle', None)    # nothing is tried from here on
    start = simulation.states([1.5])[0]
    simulation.restart(start)
    begun = start.vector.copy()
    begun[0] = 0.0
    fresh = Simulation(with_start(simulation.scene, begun), accuracy=1e-6, horizon=2.0,
                       settled=settled)
    assert simulation.states([2.0]).vector.tobytes() == fresh.states([2.0]).vector.tobytes()
    other = simulation.with_({'body.mass': 0.9})
    assert (other.choice.method, other.choice.tolerance) == (settled.method, settled.tolerance)
    assert other.scene.body.mass == 0.9
    again = Simulation(changed_scene(simulation.scene, {'body.mass': 0.9}), accuracy=1e-6,
                       horizon=2.0, settled=settled)
    assert other.states([2.0]).vector.tobytes() == again.states([2.0]).vector.tobytes()


def test_with_other_values_a_closed_form_is_that_of_the_changed_scene():
    simulation = Simulation('heavy_top', accuracy=1e-9, rate=50.0)
    simulation.advance(10)
    other = simulation.with_({'initial.spin': 40.0, 'gravity.g': 1.62})
    fresh = Simulation('heavy_top', accuracy=1e-9, rate=50.0,
                       overrides={'initial.spin': 40.0, 'gravity.g': 1.62})
    assert other.tick == 0 and other.rate == 50.0 and other.accuracy == 1e-9
    assert other.states(TIMES).vector.tobytes() == fresh.states(TIMES).vector.tobytes()
    assert other.scene.text == fresh.scene.text
    assert simulation.tick == 10
    assert Simulation(parse_scene(ASYMMETRIC), horizon=1.0).with_(
        {'body.inertia': [0.04, 0.04, 0.05]}).choice.method == 'exact'
    assert simulation.with_(commands='refuse').scene.accepts_commands is False


@pytest.mark.parametrize(('start', 'words'), [
    (np.zeros(13), 'shape'), (np.full(14, np.nan), 'finite'),
    (State.of(orientation=(0.0, 0.0, 0.0, 2.0)), 'unit quaternion'),
    (State.of(angular_velocity=(0.0, 1e200, 0.0)),
     r'the kinetic energy is beyond what a double holds \(inf J\)')])
def test_a_bad_start_is_refused_in_one_line_and_changes_nothing(start, words):
    simulation = Simulation('tennis_racket')
    simulation.advance(5)
    before = simulation.vector.copy()
    with pytest.raises(BadInput, match=words) as caught:
        simulation.restart(start)
    assert '\n' not in str(caught.value)
    assert simulation.tick == 5 and simulation.vector.tobytes() == before.tobytes()
    simulation.advance(5)
    other = Simulation('tennis_racket')
    other.advance(10)
    assert simulation.vector.tobytes() == other.vector.tobytes()


def test_the_same_scene_is_not_chosen_for_twice(monkeypatch):
    scene = parse_scene(ASYMMETRIC)
    first = Simulation(scene, accuracy=1e-6, horizon=2.0)
    monkeypatch.setattr(settling, 'settle', None)
    assert Simulation(scene, accuracy=1e-6, horizon=2.0).choice is first.choice
    monkeypatch.undo()
    assert Simulation(scene, accuracy=1e-9, horizon=2.0).choice is not first.choice
    # a start that was written over is another start
    scene.initial.vector[5] = 1.0
    assert choose.choose(scene, 'auto', 1e-6, horizon=2.0) is not first.choice


def test_a_text_that_was_read_before_gives_scenes_that_share_nothing_changeable():
    first, second = load_scene('heavy_top'), load_scene('heavy_top')
    first.initial.vector[5] = 7.0
    first.mapping['body']['mass'] = 9.0
    assert second.initial.vector[5] != 7.0 and second.mapping['body']['mass'] == 1.0
    assert load_scene('heavy_top').text == second.text


@pytest.mark.without_numba
@pytest.mark.parametrize(('scene', 'method'), [
    *((scene, 'exact') for scene in ('tennis_racket', 'heavy_top', 'kater_pendulum', 'driven_body',
                                     parse_scene(SLIDING_BALL))),
    (parse_scene(ASYMMETRIC), 'taylor'), (parse_scene(ASYMMETRIC), 'dop8'),
    (parse_scene(ASYMMETRIC), 'gauss16'), (parse_scene(ASYMMETRIC), 'radau'),
    (parse_scene(ASYMMETRIC.replace('[gravity: {g: 9.81}]', '[gravity: {g: 9.81}, torque: {'
     'times: [0.1, 0.2], values: [[0.1, 0, 0], [0, 0.1, 0]]}]')), 'taylor'),
    ('major_axis_relaxation', 'dop8')])
def test_a_runner_has_the_bits_of_a_simulation_begun_anew(scene, method):
    simulation = Simulation(scene, method, accuracy=1e-6, horizon=1.0)
    run, out = simulation.runner(), np.empty(14)
    for turned in (1.0, 1.25):
        start = simulation.scene.initial.vector.copy()
        start[5:8] *= turned
        for time in (0.0, 0.3, 1.0):
            run(start, time, out)
            assert out.tobytes() == simulation.restart(start).states([time]).vector.tobytes()


@pytest.mark.without_numba
def test_a_runner_goes_on_where_one_call_does_not_arrive_and_says_what_cannot_be_reached():
    simulation = Simulation(parse_scene(ASYMMETRIC), 'rk4', step=1.25e-4)
    run, out, start = simulation.runner(), np.empty(14), simulation.scene.initial.vector
    run(start, 1.03, out)    # one call takes 8192 steps
    assert out.tobytes() == simulation.states([1.03]).vector.tobytes()
    for time in (-1.0, np.nan, np.inf):
        with pytest.raises(BadInput, match='time'):
            run(start, time, out)
    fast = start.copy()
    fast[7] = 1e17
    with pytest.raises(NotConverged, match='more radians'):
        run(fast, 1.0, out)


def test_a_runner_of_a_closed_form_says_what_lies_beyond_doubles():
    scene = parse_scene(ASYMMETRIC.replace('constraint: pivot', 'constraint: free').replace(
        'gravity: {g: 9.81}', 'drag: {angular: 0.01}').replace(
            '[0.03, 0.04, 0.05]', '[0.05, 0.05, 0.05]').replace(', inertia_about: origin', ''))
    run, out = Simulation(scene, 'exact').runner(), np.empty(14)
    with pytest.raises(BadInput, match='beyond what doubles hold'):
        run(scene.initial.vector, -1e5, out)
