# SPDX-License-Identifier: Apache-2.0
"""The arrows of a picture beside the motion that follows: omega, L, force and torque."""

import types

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from rigid_body_sim.analysis.drift import FLOOR
from rigid_body_sim.scene.effects.wrench import Wrench
from rigid_body_sim.scene.scene import load_scene, parse_scene
from rigid_body_sim.simulation.simulation import Simulation
from rigid_body_sim.view.curves import POINTS, WINDOW, Curves
from rigid_body_sim.view.snapshots import (
    MOST_BETWEEN,
    TURN_BETWEEN,
    Mechanics,
    Snapshot,
    state_between,
    trail_between,
)

TENSOR = [[0.3, 0.01, 0.02], [0.01, 0.4, -0.03], [0.02, -0.03, 0.5]]
START = 'orientation: [0.1, 0.2, 0.3, 0.9]'
CASES = {
    'free': ('free', f'{START}, angular_velocity: [1, 2, 3], velocity: [4, 5, 6]'),
    'pivot': ('pivot', f'{START}, angular_velocity: [1, 2, 3]'),
    'hinge': ('{hinge: {axis: [1, 2, 2], through: [0.1, 0, 0.2]}}', f'{START}, rate: 3')}


@pytest.mark.without_numba
@pytest.mark.parametrize('name', CASES)
def test_arrows_are_the_slopes_of_momentum(name):
    """Force = m dv/dt of the centre of mass, torque = dL/dt, by differences of the states."""
    constraint, initial = CASES[name]
    scene = parse_scene(f'scene: s\nbody: {{mass: 2, inertia: {TENSOR}, center_of_mass: '
                        f'[0.1, -0.2, 0.3]}}\nconstraint: {constraint}\n'
                        f'effects: [gravity: {{g: 9.81}}]\ninitial: {{{initial}}}\n')
    mechanics, h = Mechanics(scene), 1e-4
    simulation = Simulation(scene, 'dop8', accuracy=1e-10, horizon=0.3)
    before, now, after = simulation.states([0.1 - h, 0.1, 0.1 + h]).vector
    found = mechanics.arrows(now, Wrench())

    def momentum(vector):
        return mechanics.arrows(vector, Wrench()).momentum

    def velocity(vector):
        return mechanics.velocity_at(vector, mechanics.center(vector))
    slope = 2.0 * (velocity(after) - velocity(before)) / (2.0 * h)
    assert found.force == pytest.approx(slope, rel=1e-5, abs=1e-5)
    turn = Rotation.from_quat(now[1:5])
    assert found.omega == pytest.approx(turn.apply(now[5:8]))
    spin = turn.apply(np.array(TENSOR) @ now[5:8])
    if name == 'free':
        assert found.momentum == pytest.approx(spin)
    if name == 'hinge':
        axis = turn.apply(np.array([1.0, 2.0, 2.0]) / 3.0)
        slope = axis * (axis @ (momentum(after) - momentum(before))) / (2.0 * h)
    else:
        slope = (momentum(after) - momentum(before)) / (2.0 * h)
    assert found.torque == pytest.approx(slope, rel=1e-5, abs=1e-5)
    center = now[8:11] + turn.apply([0.1, -0.2, 0.3])
    assert mechanics.center(now) == pytest.approx(center)


@pytest.mark.parametrize('scene', ['tennis_racket', 'chandler_wobble', 'needle', 'baseball_bat'])
def test_the_rounding_of_a_torque_that_is_zero_is_no_arrow(scene):
    """The terms of dL/dt cancel; an arrow is drawn to the scale of the first one of its kind."""
    scene = load_scene(scene)
    mechanics, simulation = Mechanics(scene), Simulation(scene)
    for vector in simulation.states(np.linspace(1.0, 20.0, 20)).vector:
        assert not mechanics.arrows(vector, Wrench()).torque.any()
    held = Wrench(torque=tuple(1e-6 * mechanics.arrows(vector, Wrench()).momentum))
    size = np.linalg.norm(held.torque)
    assert mechanics.arrows(vector, held).torque == pytest.approx(held.torque, abs=1e-5 * size)


def test_a_body_that_flies_freely_feels_no_force_though_its_origin_is_carried_round():
    scene = parse_scene(f'scene: s\nbody: {{mass: 2, inertia: {TENSOR}, center_of_mass: '
                        '[0.1, -0.2, 0.3]}\nconstraint: free\neffects: []\n'
                        f'initial: {{{START}, angular_velocity: [1, 2, 3]}}\n')
    found = Mechanics(scene).arrows(Simulation(scene).states([1.7]).vector[0], Wrench())
    assert not found.force.any() and not found.torque.any()


def test_force_and_torque_that_a_source_tells_stand_in_for_those_of_the_state():
    scene = load_scene('tennis_racket')
    vector, told = scene.initial.vector, (np.array([1.0, 2.0, 3.0]), np.array([4.0, 5.0, 6.0]))
    snapshot = Snapshot(0.0, vector, vector[np.newaxis], Wrench(), 0.0, 0.0, 0.0, net=told)
    mechanics = Mechanics(scene)
    found, own = mechanics.of(snapshot), mechanics.arrows(vector, Wrench())
    assert found.force is told[0] and found.torque is told[1]
    assert (found.momentum == own.momentum).all() and (found[0] == own[0]).all()
    assert (mechanics.of(snapshot._replace(net=None)).torque == own.torque).all()


BRAKED = ('scene: s\nbody: {mass: 3.0, inertia: [1.0, 1.5, 2.0]}\nconstraint: free\n'
          "effects: [force: {value: ['-0.1*vx', 0, 0]}]\ninitial: {}\n")


@pytest.mark.parametrize(('scene', 'needed'), [
    ('tennis_racket', False), ('heavy_top', False), ('kater_pendulum', False),
    ('billiard_low', True), ('tossed_coin', True), (parse_scene(BRAKED), True)],
    ids=lambda one: getattr(one, 'name', None))
def test_a_source_without_velocities_knows_whose_forces_need_them(scene, needed):
    scene = load_scene(scene) if isinstance(scene, str) else scene
    assert Mechanics(scene).need_velocity() is needed


class Gui:
    """What is asked of viser for a chart."""

    def add_uplot(self, data, *series, **settings):
        self.chart = types.SimpleNamespace(data=data, scales=settings['scales'])
        self.series, self.settings = series, settings
        return self.chart


def moved(times, speeds):
    """Return states of a body whose centre of mass, at (1, 0, 0) in it, is at (0, t^2, 0).

    It turns about z, whatever `speeds` (rad/s) say.
    """
    states = np.zeros((3, 14))
    states[:, 0], states[:, 7] = times, speeds
    turns = Rotation.from_rotvec(np.outer(np.array(times) + 0.3, [0.0, 0.0, 1.0]))
    states[:, 1:5] = turns.as_quat()
    states[:, 8:11] = np.outer(np.square(times), [0.0, 1.0, 0.0]) - turns.apply([1.0, 0.0, 0.0])
    return states


ACCELERATED = parse_scene('scene: s\nbody: {mass: 3.0, inertia: [1.0, 1.5, 2.0], '
                          'center_of_mass: [1.0, 0.0, 0.0]}\nconstraint: free\neffects: []\n'
                          'initial: {}\n')


def test_force_and_torque_are_told_by_the_differences_of_three_states():
    """The force is 2 m; the angular velocity rises by 10 rad/s^2, so the torque is 10 C."""
    force, torque = Mechanics(ACCELERATED).net_between(
        moved([0.99, 1.0, 1.01], [4.9, 5.0, 5.1]))
    assert force == pytest.approx([0.0, 6.0, 0.0], abs=1e-9)
    assert torque == pytest.approx([0.0, 0.0, 20.0], abs=1e-9)


@pytest.mark.parametrize(('times', 'speed', 'known'), [
    ([0.9, 1.0, 1.1], 1.9, True), ([0.9, 1.0, 1.1], 2.1, False),
    ([0.9, 1.0, 1.10008], 1.9, True), ([0.9, 1.0, 1.10012], 1.9, False),
    ([1.0, 1.0, 1.1], 1.9, False), ([1.0, 1.0, 1.0], 0.0, False)])
def test_states_that_are_uneven_in_time_or_far_apart_tell_neither(times, speed, known):
    """A turn of 0.2 rad from one to the next, and a thousandth of the step, are the limits."""
    found = Mechanics(ACCELERATED).net_between(moved(times, [9.0, speed, 9.0]))
    assert [part.shape for part in found] == [(3,), (3,)]
    assert [bool(np.isfinite(part).all()) for part in found] == [known] * 2


def test_of_a_hinged_body_the_torque_about_its_axis_is_told():
    """Its momentum about the hinge turns with it; its component along the axis is 2 rad/s^2 C."""
    scene = load_scene('kater_pendulum', ['body.inertia=[[0.48, 0.0, 0.0], [0.0, 0.48, 0.1], '
                                          '[0.0, 0.1, 0.4]]'])
    states = np.zeros((3, 14))
    states[:, 0], states[:, 4], states[:, 6] = [0.9, 1.0, 1.1], 1.0, [0.8, 1.0, 1.2]
    _, torque = Mechanics(scene).net_between(states)
    assert torque == pytest.approx([0.0, 2.0 * (0.48 + 2.0 * 0.4**2), 0.0], abs=1e-12)


@pytest.mark.parametrize(('elapsed', 'share'), [
    (0.4, 0.25), (0.5, 0.0), (0.6, 0.0), (0.0, 0.0), (-0.1, 0.0)])
def test_a_state_between_two_is_told_unless_they_are_half_a_second_apart_or_back_in_time(
        elapsed, share):
    before, after = np.zeros((2, 14))
    before[0], before[4], before[8] = 1.0, 1.0, 5.0
    after[0], after[4], after[8] = 1.0 + elapsed, 1.0, 9.0
    assert state_between(before, after, 0.25)[8] == 5.0 + share * 4.0


def snapshot(time, energy=0.0, momentum=0.0, restarted=False):
    return Snapshot(time, None, None, None, 0.0, energy, momentum, (), restarted)


def test_curves_hold_the_last_residuals_in_units_of_their_scale():
    gui = Gui()
    curves = Curves(gui)
    assert [part.tolist() for part in gui.chart.data[:3]] == [[0.0], [0.0], [0.0]]
    for one in (snapshot(1.0, 2e-16, -3e-16), snapshot(2.0, np.nan), snapshot(2.0, 1e-16, 0.0),
                snapshot(2.0, 9e-16), snapshot(1.5, 9e-16), snapshot(3.0, 4e-16, 5e-16)):
        curves.take(one)
    curves.draw(1.0)
    times, energy, momentum, upper, lower = gui.chart.data
    assert times.tolist() == [-2.0, -1.0, 0.0]
    assert energy == pytest.approx([2.0, 1.0, 4.0])
    assert momentum == pytest.approx([-3.0, 0.0, 5.0])
    assert upper == pytest.approx([FLOOR / 1e-16] * 3)
    assert (lower == -upper).all()
    curves.take(snapshot(0.5, 7e-16, 0.0, restarted=True))
    curves.draw(1.0)
    assert gui.chart.data[0].tolist() == [0.0]
    assert gui.chart.scales['x']['range'] == (-WINDOW, 0.0)
    curves.draw(100.0)
    assert gui.chart.scales['x']['range'] == (-100.0 * WINDOW, 0.0)
    for k in range(2 * POINTS):
        curves.take(snapshot(1.0 + k))
    curves.draw(1.0)
    assert len(gui.chart.data[0]) == POINTS
    assert gui.chart.data[0][0] == 1.0 - POINTS


def test_the_curves_stand_out_from_a_shaded_band_between_dashed_lines():
    gui = Gui()
    Curves(gui)
    [(times, energy, momentum, upper, lower)] = gui.series
    assert [one['label'] for one in (times, energy, momentum)] == ['t - now (s)', 'energy', 'L²']
    assert energy['width'] == momentum['width'] > upper['width'] == lower['width'] > 0
    assert 'dash' not in energy and 'dash' not in momentum and upper['dash'] == lower['dash']
    assert len({energy['stroke'], momentum['stroke'], upper['stroke']}) == 3
    [band] = gui.settings['bands']
    assert band['series'] == (3, 4)    # the places of its edges, after the times
    # the axis of x is no clock, and that of y fits the data
    assert gui.chart.scales['x']['time'] is False and gui.chart.scales['y'] == {'auto': True}
    assert gui.settings['legend']['show'] and 'units of 1e-16' in gui.settings['title']
    across, up = gui.settings['axes']
    assert across['label'] == times['label'] and up['grid']['width'] == across['grid']['width'] > 0


@pytest.mark.parametrize('spin', [3.0, 119.0, 240.0, -400.0])
def test_a_trail_between_two_pictures_turns_as_the_body_does(spin):
    """Sampled 60 times a second, a body at 240 rad/s turns by 4 rad from one to the next."""
    simulation = Simulation('symmetric_top', overrides={
        'initial.angular_velocity': [0.02 * spin, 0.0, spin]})
    before, after = simulation.states([1.0, 1.0 + 1.0 / 60.0]).vector
    trail = trail_between(before, after)
    assert (trail[-1] == after).all()
    assert len(trail) == min(1 + int(abs(spin) / 60.0 / TURN_BETWEEN), MOST_BETWEEN)
    exact = simulation.states(trail[:, 0])
    off = Rotation.from_quat(trail[:, 1:5]).inv() * Rotation.from_quat(exact.orientation)
    # omega is 0.02 rad off the axis, and goes round it on the way
    assert off.magnitude().max() < 0.02 * abs(spin) / 60.0 + 1e-3


def test_a_trail_does_not_guess_across_a_long_gap_or_back_in_time():
    before, later, long_after = Simulation('tennis_racket').states([1.0, 1.1, 2.0]).vector
    assert len(trail_between(before, later)) > 1
    for one, other in ((before, long_after), (later, before), (before, before)):
        assert (trail_between(one, other) == other[np.newaxis]).all()
