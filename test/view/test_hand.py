# SPDX-License-Identifier: Apache-2.0
"""The hand: springs and strikes as commands, worked out by hand for bodies where that is easy."""

import math

import numpy as np
import pytest
from near import near
from scipy.spatial.transform import Rotation
from soak import IN_SOAK

from rigid_body_sim import Simulation, load_scene
from rigid_body_sim.drawing.body import drawing_of
from rigid_body_sim.errors import NotConverged
from rigid_body_sim.scene.scene import parse_scene, scene_names
from rigid_body_sim.simulation.command_rows import AXES, BODY, FORCE, TORQUE, WORLD
from rigid_body_sim.view.hand import FOLLOWS, PULL, Hand, pace_of, together
from rigid_body_sim.view.mouse import hit
from rigid_body_sim.view.snapshots import Mechanics

SLIM = """
scene: slim
body: {{mass: 1.0, inertia: [1.0, 1.0, {:g}]}}
constraint: free
effects: []
initial: {{angular_velocity: [0.1, 0.2, 0.3]}}
"""


def hand_of(name, *overrides):
    scene = load_scene(name, overrides)
    return Hand(Mechanics(scene)), scene.initial.vector.copy()


def test_the_hand_feels_the_mass_at_the_middle_of_a_ball_and_two_sevenths_of_it_at_its_edge():
    hand, vector = hand_of('sphere')
    assert hand.felt_mass(vector, np.zeros(3), np.array([1.0, 0.0, 0.0])) == pytest.approx(1.0)
    # along y at (a, 0, 0): 1/M + a^2 / (2/5 M a^2) = (1 + 5/2)/M
    assert hand.felt_mass(vector, np.array([0.1, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])) == \
        pytest.approx(2.0 / 7.0)


def test_at_a_pivot_it_feels_the_moment_about_it_and_nothing_along_the_arm():
    hand, vector = hand_of('spherical_pendulum', 'initial.euler_zyz=[0, 0, 0]',
                           'initial.angular_velocity=[0, 0, 0]')
    tip = np.array([0.0, 0.0, 1.0])
    assert hand.felt_mass(vector, tip, np.array([1.0, 0.0, 0.0])) == pytest.approx(1.0)
    assert hand.felt_mass(vector, tip, tip) is None
    assert hand.pull(vector, tip, 2.0 * tip, PULL) is None


def test_the_wrench_is_the_force_at_the_grabbed_point():
    hand, vector = hand_of('sphere', 'initial.angular_velocity=[0, 0, 0]')
    grabbed, cursor = np.array([0.1, 0.0, 0.0]), np.array([0.1, 0.3, 0.0])
    [row] = hand.pull(vector, grabbed, cursor, 2.0)
    assert row[FORCE] == pytest.approx([0.0, 4.0 * 0.3 * 2.0 / 7.0, 0.0])
    assert row[TORQUE] == pytest.approx(np.cross(grabbed, row[FORCE]))


def test_the_spring_is_damped_by_the_speed_of_the_grabbed_point():
    """M (pace^2 x - 2 x 0.7 pace v), along x at the middle of a ball of 1 kg."""
    hand, vector = hand_of('sphere', 'initial.angular_velocity=[0, 0, 0]')
    vector[11] = 0.5
    [row] = hand.pull(vector, np.zeros(3), np.array([0.3, 0.0, 0.0]), 2.0)
    assert row[FORCE] == pytest.approx([4.0 * 0.3 - 2.0 * 0.7 * 2.0 * 0.5, 0.0, 0.0])
    assert hand.pull(vector, np.zeros(3), np.array([0.35, 0.0, 0.0]), 2.0) is None    # at rest


@pytest.mark.parametrize(('least', 'axes'), [(0.0099, BODY), (0.0101, WORLD)])
def test_about_an_axis_of_less_than_a_hundredth_of_the_largest_moment_nothing_is_turned(
        least, axes):
    scene = parse_scene(SLIM.format(least))
    hand, vector = Hand(Mechanics(scene)), scene.initial.vector
    [row] = hand.pull(vector, np.array([0.1, 0.2, 0.3]), np.array([0.5, 0.1, 0.3]), 2.0)
    assert row[AXES] == axes
    assert (abs(row[TORQUE][2]) < 1e-15) == (axes == BODY)


@pytest.mark.parametrize(('strength', 'speed', 'lag', 'pace'), [
    (1.0, 1.0, 1e-3, PULL), (4.0, 1.0, 1e-3, 2.0 * PULL), (1.0, 10.0, 1e-3, 0.1 * PULL),
    (100.0, 1.0, 1.0 / 60.0, 12.0), (1.0, 1e-3, 1e-3, 200.0)])
def test_the_spring_is_as_stiff_as_its_delay_allows(strength, speed, lag, pace):
    """A fifth of a radian passes in a delay, at most."""
    assert pace_of(strength, speed, lag) == near(pace, rel=1e-12)


@pytest.mark.parametrize(('speed', 'strength'), [
    (1.0, 0.1), pytest.param(1.0, 1.0, marks=IN_SOAK), (1.0, 100.0),
    pytest.param(100.0, 1.0, marks=IN_SOAK), pytest.param(1e-3, 1.0, marks=IN_SOAK),
    (1e-3, 100.0)])
def test_a_pull_that_acts_two_snapshots_late_ends_at_the_cursor(speed, strength):
    """A strong spring, and any at 1/1000 of real time, was once driven by its own delay."""
    simulation = Simulation(load_scene('sphere', ['initial.angular_velocity=[0, 0, 0]']),
                            rate=1000.0)
    hand, late = Hand(Mechanics(simulation.scene)), [None, None]
    grip, cursor = np.array([0.05, 0.0, 0.02]), np.array([0.3, 0.2, 0.1])
    lag = max(speed / 60.0, 1e-3)
    begun = np.linalg.norm(cursor - grip)
    for _ in range(900):
        vector = simulation.vector.copy()
        point = hand.held_point(vector, grip, lag)
        late.append(hand.pull(vector, point, cursor, pace_of(strength, speed, lag)))
        if (row := late.pop(0)) is not None:
            assert simulation.command(row) == []
        simulation.advance(round(1000.0 * lag))
        assert np.linalg.norm(cursor - point) < 2.0 * begun
    assert np.linalg.norm(cursor - point) < 0.05 * begun


def test_a_point_that_whirls_is_held_at_the_axis_and_a_slow_one_where_it_is():
    hand, vector = hand_of('sphere', 'initial.angular_velocity=[0, 0, 1000]')
    grip = np.array([0.08, 0.0, 0.05])
    assert hand.held_point(vector, grip, 1.0 / 60.0) == pytest.approx([0.0, 0.0, 0.05], abs=1e-4)
    vector[5:8] = 0.0, 0.0, 1e-3
    assert hand.held_point(vector, grip, 1.0 / 60.0) == pytest.approx(grip, abs=1e-9)


def test_a_hand_holds_beside_the_axis_through_the_middle_of_the_body():
    """At the turn FOLLOWS between snapshots it is halfway to the axis, at thrice it at a tenth."""
    scene = parse_scene('scene: s\nbody: {mass: 2.0, inertia: [1.0, 1.0, 1.0], center_of_mass: '
                        '[1.0, 2.0, 3.0]}\nconstraint: free\neffects: []\ninitial: {}\n')
    hand, vector = Hand(Mechanics(scene)), scene.initial.vector.copy()
    grip, lag, center = np.array([1.5, 2.0, 7.0]), 0.1, np.array([1.0, 2.0, 3.0])
    at = vector[8:11]
    for spin in (0.0, 1e-200):    # whose square is zero
        vector[5:8] = 0.0, 0.0, spin
        assert hand.held_point(vector, grip, lag) == pytest.approx(at + grip, abs=1e-12)
    for times, arm in ((1.0, 0.25), (3.0, 0.05)):
        vector[5:8] = 0.0, 0.0, times * FOLLOWS / lag
        held = at + center + [arm, 0.0, 4.0]
        assert hand.held_point(vector, grip, lag) == pytest.approx(held, abs=1e-12)


def test_a_pull_does_not_brake_the_spin_of_a_fast_top():
    simulation = Simulation('heavy_top', rate=600.0)
    hand = Hand(Mechanics(simulation.scene))
    spin = simulation.vector[7]
    for _ in range(60):
        vector = simulation.vector.copy()
        point = hand.held_point(vector, np.array([0.03, 0.0, 0.15]), 1.0 / 60.0)
        row = hand.pull(vector, point, np.array([0.1, 0.1, 0.1]), pace_of(1.0, 1.0, 1.0 / 60.0))
        simulation.command(row)
        simulation.advance(10)
    assert simulation.vector[7] == near(spin, rel=0.05)


def test_a_body_that_must_roll_is_not_lifted_off_its_plane_and_one_that_may_slip_can_be():
    """Dragging a disk upwards once ended its run: ideal rolling needs a plane that pulls."""
    for name, lifted in (('rolling_disk', False), ('tippe_top', True)):
        hand, vector = hand_of(name)
        point = vector[8:11] + np.array([0.01, 0.0, 0.01])
        above, below = np.array([0.1, 0.0, 0.2]), np.array([0.1, 0.0, -5.0])
        for cursor, up in ((point + above, lifted), (point + below, False)):
            [row] = hand.pull(vector, point, cursor, PULL)
            assert np.hypot(*row[FORCE][:2]) > 0.0
            assert (row[FORCE][2] > 0.0) == up
    # towards its plane a body at rest is pulled straight to the cursor
    hand, vector = hand_of('rolling_disk', 'initial.angular_velocity=[0, 0, 0]')
    point = vector[8:11] + np.array([0.01, 0.0, 0.01])
    [row] = hand.pull(vector, point, point + below, PULL)
    assert np.cross(row[FORCE], below) == pytest.approx(
        0.0, abs=1e-12 * np.linalg.norm(row[FORCE]) * np.linalg.norm(below))


def test_two_pulls_at_once_are_the_sum_of_their_wrenches():
    hand, vector = hand_of('sphere', 'initial.angular_velocity=[0, 0, 0]')
    one = hand.pull(vector, np.array([0.1, 0, 0]), np.array([0.1, 0.3, 0]), 2.0)
    other = hand.pull(vector, np.array([0, 0.1, 0]), np.array([0, 0.1, 0.2]), 2.0)
    both = together([one, other])
    assert (both[:, :2] == one[:, :2]).all()
    assert (both[:, 2:] == one[:, 2:] + other[:, 2:]).all()


COARSE = {'integrator': 'dop8', 'accuracy': 1e-6}
RARE = {'baseball_bat': {}, 'driven_body': COARSE, 'kapitza_pendulum': COARSE,
        'kater_pendulum': COARSE, 'kater_pendulum_from_p': COARSE, 'librating_satellite': COARSE,
        'major_axis_relaxation': {}}
"""Scenes under a pull that hardly another test compiles, and how they are solved."""


@pytest.mark.parametrize('name', [
    pytest.param(name, marks=[pytest.mark.without_numba] * (name in RARE)
                 + [IN_SOAK] * (name in ('kapitza_pendulum', 'major_axis_relaxation')))
    for name in scene_names()])
def test_a_pull_at_sixty_snapshots_a_second_is_taken_and_stays_bounded_in_every_scene(name):
    simulation = Simulation(name, rate=600.0, **RARE.get(name, {}))
    mechanics = Mechanics(simulation.scene)
    hand, drawing = Hand(mechanics), drawing_of(simulation.scene)
    vector = simulation.vector
    reach = np.linalg.norm(drawing.vertices, axis=1).max()
    corner = drawing.vertices[np.argmax(drawing.vertices @ (1.0, 0.3, 0.2))]
    cursor = vector[8:11] + reach * np.array([0.9, 0.5, 0.4])
    before = np.linalg.norm(vector[5:8])
    for _ in range(40):
        grabbed = vector[8:11] + Rotation.from_quat(vector[1:5]).apply(corner)
        row = hand.pull(vector, grabbed, cursor, PULL)
        if row is not None:
            assert simulation.command(row) == []
        try:
            simulation.advance(10)
        except NotConverged:
            if simulation.scene.contact.mu < math.inf:
                raise
            return    # what must roll may be pulled off its plane sideways, too
    assert np.isfinite(simulation.vector).all()
    assert np.linalg.norm(vector[5:8]) < 3.0 * before + 40.0 * PULL


@pytest.mark.without_numba
@pytest.mark.parametrize('least', [1e-3, 1e-7])
def test_a_slim_body_is_turned_by_its_end_and_never_spun_about_its_axis(least):
    simulation = Simulation(parse_scene(SLIM.format(least)), rate=600.0, integrator='dop8',
                            accuracy=1e-6)
    mechanics = Mechanics(simulation.scene)
    hand, drawing = Hand(mechanics), drawing_of(simulation.scene)
    corner = drawing.vertices[np.argmax(drawing.vertices @ (1.0, 0.3, 0.2))]
    reach, fastest = np.linalg.norm(corner), np.zeros(2)
    for k in range(60):
        vector = simulation.vector
        grabbed = vector[8:11] + Rotation.from_quat(vector[1:5]).apply(corner)
        cursor = reach * np.array([1.5 * np.sin(k / 7), 1.2 * np.cos(k / 9), 0.5])
        row = hand.pull(vector, grabbed, cursor, PULL)
        assert row[0, AXES] == BODY
        simulation.command(row)
        simulation.advance(10)
        omega = np.abs(simulation.vector[5:8])
        fastest = np.maximum(fastest, [omega[:2].max(), omega[2]])
    assert 1.0 < fastest[0] < 4.0 * PULL
    assert fastest[1] == near(0.3, rel=1e-6)


def test_a_pulled_point_comes_to_the_cursor_and_stays():
    simulation = Simulation('sphere', rate=600.0)
    hand, cursor = Hand(Mechanics(simulation.scene)), np.array([0.3, 0.2, 0.1])
    for _ in range(600):
        vector = simulation.vector
        grabbed = vector[8:11] + Rotation.from_quat(vector[1:5]).apply([0.1, 0.0, 0.0])
        simulation.command(hand.pull(vector, grabbed, cursor, PULL))
        simulation.advance(10)
    assert grabbed == pytest.approx(cursor, abs=0.01)


def test_a_ray_hits_the_near_side_of_the_body_where_it_stands():
    scene = load_scene('sphere', ['initial.position=[1, 2, 3]'])
    point = hit(drawing_of(scene), scene.initial.vector, np.array([1.0, -5.0, 3.0]),
                np.array([0.0, 1.0, 0.0]))
    assert point == pytest.approx([1.0, 1.9, 3.0], abs=1e-3)
    assert hit(drawing_of(scene), scene.initial.vector, np.array([2.0, -5.0, 3.0]),
               np.array([0.0, 1.0, 0.0])) is None
