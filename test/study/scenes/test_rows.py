# SPDX-License-Identifier: Apache-2.0
"""The rows of every check for a made-up motion, which obeys no law, are those that are kept.

What is predicted and what is measured differ widely then, so a change of either shows, even where
a true motion would meet both, or lie below a bound in any case.
"""

import json
import math
import types

import kept
import numpy as np
import pytest
from near import near
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

from rigid_body_sim.errors import BadInput
from rigid_body_sim.scene.scene import load_scene
from rigid_body_sim.scene.state import States
from rigid_body_sim.study.scenes import (
    convex_body,
    driven_body,
    experiment,
    free_body,
    heavy_top,
    instruments,
    kapitza_pendulum,
    kater_pendulum,
    sleeping_top,
)
from rigid_body_sim.study.scenes.systems import SYSTEMS

PACE = {'chandler_wobble': 6e-7, 'kater_pendulum': 6.0, 'kater_pendulum_from_p': 6.0,
        'kapitza_pendulum': 40.0, 'baseball_bat': 5.0, 'librating_satellite': 3e-3,
        'tennis_racket': -1.0, 'rising_egg': -100.0, 'rattleback': 87.0, 'free_body': 8.0,
        **dict.fromkeys((name for name in SYSTEMS if name.startswith('billiard')), 5.0)}
"""How fast a body turns in a made-up motion if not as fast as at the start, rad/s."""
AT = {'impact': 0.0878, 'rolling began': 0.4, 'rest': 0.8}
"""When each event happens, over the span that is searched; a coin hits the table about then."""
PARTS = ('name', 'predicted', 'measured', 'tolerance', 'unit', 'bound', 'absolute', 'as_written',
         'detail')


def _mark(part):
    """Return a number between -1 and 1 that any number of a mapping moves."""
    if isinstance(part, (dict, list)):
        parts = part.values() if isinstance(part, dict) else part
        return sum(0.5 ** (k % 5 + 1) * _mark(one) for k, one in enumerate(parts)) / 2.0
    return math.atan(part) / 1.6 if isinstance(part, (int, float)) else 0.0


class Motion:
    """Stands in for Simulation: a body that begins as the scene says, and turns in two ways.

    R(t) = exp(u a(t)) R(0) exp(v b(t)) with u fixed in the world and v in the body; each rate
    swells and sinks, and the body wanders about.
    """

    def __init__(self, scene, method, accuracy):
        self.scene = scene
        self._place, self.rate, self._ticks = scene.initial.position, 1000.0, 0
        self._mark = 1.0 + 0.1 * _mark(scene.mapping)
        self._turn = Rotation.from_quat(scene.initial.orientation)
        omega, self._velocity = (np.array(one) for one in (
            scene.initial.angular_velocity, scene.initial.velocity))
        for effect in scene.effects:
            if effect.name == 'strike':    # as a law would have it but for the factors
                impulse = np.array(effect.impulse) / scene.body.mass
                omega += 0.3 * np.cross(effect.point or (0.0, 0.0, effect.height), impulse)
                self._velocity += 0.9 * impulse
        pace = PACE.get(scene.name, float(np.linalg.norm(omega))) or 1.0
        self._v = np.array([0.48, -0.6, 0.64])
        self._b = 0.37 * pace * self._mark
        self._omega, rest = omega, self._turn.apply(omega - self._b * self._v)
        self._a = float(np.linalg.norm(rest))
        self._u = rest / self._a

    def states(self, times):
        t = np.asarray(times, float)
        a, b = self._a, self._b
        turned = self._turns(t)
        omega = (turned.inv().apply(self._u) * (a * (1.0 + 0.1 * np.sin(1.3 * a * t)))[:, None]
                 + self._v * (b * (1.0 + 0.2 * np.sin(0.7 * b * t)))[:, None])
        wander = 0.01 * np.stack([np.sin(a * t), np.cos(b * t) - 1.0, np.sin((a - b) * t)], 1)
        omega[t == 0.0] = self._omega    # to the last bit
        place = self._place + self._velocity * t[:, None] + wander
        return States(np.column_stack([t, turned.as_quat(), omega, place,
                                       self._velocity + a * wander]))

    def _turns(self, t):
        a, b = self._a, self._b
        first = a * t + (1.0 - np.cos(1.3 * a * t)) / 13.0
        second = b * t + (1.0 - np.cos(0.7 * b * t)) / 3.5
        return (Rotation.from_rotvec(first[:, None] * self._u) * self._turn
                * Rotation.from_rotvec(second[:, None] * self._v))

    def advance(self, ticks):
        self._ticks += ticks

    @property
    def events(self):
        time = 1e-3 * self._ticks * self._mark
        return [types.SimpleNamespace(name=name, time=share * time)
                for name, share in (*AT.items(), ('rolling began', 0.9))]

    def at_event(self, name, before):
        return types.SimpleNamespace(time=before * AT[name] * self._mark)

    def ledger(self):
        return {'energy_residual': -1e-3 * self._ticks, 'dissipated': 2e-3 * self._ticks}

    def diagnose(self, states):
        return 1.0 + 0.1 * np.sin(states.time), None


@pytest.mark.parametrize('name', SYSTEMS)
def test_rows_of_a_made_up_motion(name, monkeypatch):
    monkeypatch.setattr(experiment, 'Simulation', Motion)
    run = experiment.Experiment(load_scene(name), 'exact')
    rows = list(map(_kept, SYSTEMS[name].check(run)))
    kept.check(f'rows_{name}', rows)
    before = json.loads((kept.FOLDER / f'rows_{name}.json').read_text(encoding='utf-8'))
    assert [one['tolerance'] for one in rows] == near([one['tolerance'] for one in before], 1e-6)


class Precessing(Motion):
    """Stands in for Simulation: a free body with I1 = I2, in closed form.

    R(t) = exp(t L/I1) R(0) exp(-t Omega e3) with Omega = omega3 (I3 - I1)/I1.
    """

    def states(self, times):
        t = np.asarray(times, float)[:, None]
        I1, _, I3 = self.scene.body.about_center.moments
        omega = np.array(self.scene.initial.angular_velocity)
        first = Rotation.from_quat(self.scene.initial.orientation)
        L = first.apply(np.array([I1, I1, I3]) * omega)
        about = Rotation.from_rotvec(t * [0.0, 0.0, omega[2] * (I3 - I1) / I1])
        turned = Rotation.from_rotvec(t * L / I1) * first * about.inv()
        return States(np.column_stack([t, turned.as_quat(), about.apply(omega), 0.0 * t, 0.0 * t,
                                       0.0 * t, 0.0 * t, 0.0 * t, 0.0 * t]))


@pytest.mark.parametrize(('name', 'changes'), [
    ('symmetric_top', ['initial.angular_velocity=[0.5, 0.8, 2]', 'body.inertia=[2, 2, 2.6]']),
    ('symmetric_top', ['initial.angular_velocity=[-0.8, 0.3, -2]', 'body.inertia=[2, 2, 1.5]']),
    ('thin_rod', ['body.mass=3', 'body.shape.rod.length=2']), ('needle', []),
    ('sphere', ['body.mass=3', 'body.shape.solid_sphere.radius=0.3']),
    ('sphere', ['initial.angular_velocity=[3, 1, -2]'])])
def test_rows_of_an_exact_motion_are_all_confirmed(name, changes, monkeypatch):
    monkeypatch.setattr(experiment, 'Simulation', Precessing)
    given = ['initial.orientation=[0.1, -0.7, 0.5, 0.5]', *changes]
    rows = list(SYSTEMS[name].check(experiment.Experiment(load_scene(name, given), 'exact')))
    assert [one.name for one in rows if not one.passed] == []
    assert all(np.size(one.measured) for one in rows)


class Falling(Precessing):
    """Stands in for Simulation: such a body in free fall, which hits the table with its rim."""

    def at_event(self, name, before):
        begin, size = self.scene.initial, self.scene.body.surface.size[0]

        def gap(time):
            upright = instruments.axes(self.states([time]))[0, 2, 2]
            return (begin.position[2] + begin.velocity[2] * time
                    - 0.5 * self.scene.effect('gravity').g * time**2
                    - size * math.sqrt(1.0 - upright**2))
        times = np.linspace(0.0, before, 500)
        k = next(k for k, time in enumerate(times) if gap(time) < 0.0)
        return types.SimpleNamespace(time=brentq(gap, times[k - 1], times[k], xtol=1e-15))


@pytest.mark.parametrize('turn', [[0.1, -0.7, 0.5, 0.5], [0.5, 0.1, -0.2, 0.8]])
def test_a_tossed_coin_hits_the_table_when_its_rim_does(turn, monkeypatch):
    monkeypatch.setattr(experiment, 'Simulation', Falling)
    run = experiment.Experiment(load_scene(
        'tossed_coin', [f'initial.orientation={turn}']), 'exact')
    row = next(convex_body.tossed_coin(run))
    assert row.name == 'first impact' and row.passed    # measured: 2e-16


@pytest.mark.parametrize(('name', 'changes'), [
    *(('billiard_follow', one) for one in (
        'strike.time=0.5', 'strike.impulse=[-0.2, 0, 0]', 'strike.impulse=[0.2, 0.1, 0]',
        'sliding_friction.mu=0', 'initial.velocity=[1, 0, 0]',
        'initial.angular_velocity=[0, 1, 0]', 'initial.orientation=[0, 0, 1, 0]')),
    *(('symmetric_top', one) for one in (
        'body.inertia=[1, 1.1, 1.5]', 'body.inertia=[1, 1, 1]',
        'initial.angular_velocity=[0, 0, 2]', 'initial.angular_velocity=[1, 0, 0]')),
    *(('heavy_top', one) for one in (
        'gravity.g=0', 'body.center_of_mass=[0, 0, -0.1]',
        'body.center_of_mass=[0.01, 0, 0.1]', 'body.center_of_mass=[0, 0.01, 0.1]',
        'body.inertia=[0.02, 0.021, 0.005]', 'initial.tilt=0', 'initial.tilt=3.14159265')),
    ('tennis_racket', 'body.inertia=[1, 1, 1.5]'),
    ('tennis_racket', 'initial.angular_velocity=[1, 0, 0]'),
    ('asymmetric_top', 'initial.angular_velocity=[0, 1, 0]'),
    ('sleeping_top', 'initial.tilt=0.3'), ('steady_precession', 'initial.spin=3'),
    ('sphere', 'initial.angular_velocity=[0, 0, 0]'), ('kater_pendulum', 'initial.rate=30'),
    ('kater_pendulum', 'gravity.g=0'), ('kater_pendulum', 'constraint.hinge.through=[0, 0, -0.4]')
])
def test_what_no_formula_is_for_is_refused(name, changes, monkeypatch):
    monkeypatch.setattr(experiment, 'Simulation', Motion)
    run = experiment.Experiment(load_scene(name, [changes]), 'exact')
    with pytest.raises(BadInput, match=f'^{name}: '):
        list(SYSTEMS[name].check(run))


class Measured(Exception):
    """The check goes on to measure."""


def measured(_):
    raise Measured


@pytest.mark.parametrize(('scene', 'beta', 'difference', 'reaches'), [
    (heavy_top, 0.0201, 1.0, True), (heavy_top, 0.0199, 1.0, False),
    (heavy_top, math.pi - 0.0201, 1.0, True), (heavy_top, math.pi - 0.0199, 1.0, False),
    (heavy_top, math.pi / 2, 1.0, True),
    # 6e-6 is 1e-6 of sqrt(I1 M g l) = 6 kg m^2/s
    (heavy_top, 1.0, 6.5e-6, True), (heavy_top, 1.0, 5.5e-6, False),
    (heavy_top, 1.0, -6.5e-6, True), (heavy_top, 1.0, -5.5e-6, False),
    (sleeping_top, 0.9e-6, 0.0, True), (sleeping_top, 1.1e-6, 0.0, False)])
@pytest.mark.parametrize('sense', [1.0, -1.0])
def test_a_top_is_off_the_vertical_or_upright(monkeypatch, scene, beta, difference, reaches,
                                              sense):
    top = types.SimpleNamespace(beta=beta, P_gamma=2.0, P_alpha=sense * (2.0 + difference),
                                I1=4.0, I3=1.0, Mgl=9.0, momenta=None)
    monkeypatch.setattr(scene, 'Top', lambda _: top)
    run = types.SimpleNamespace(scene=types.SimpleNamespace(name='top'), at=measured)
    with pytest.raises(Measured if reaches else BadInput):
        next(scene.check(run))


def inclined(tilts):
    """Return states of a disk whose axis is off the level by tilts, rad."""
    half = 0.25 * math.pi - 0.5 * np.asarray(tilts)
    nothing = np.zeros(len(half))
    return types.SimpleNamespace(
        orientation=np.stack([nothing, np.sin(half), nothing, np.cos(half)], axis=1))


@pytest.mark.parametrize(('shape', 'rolls', 'spins'), [
    # squares of w3, v^2 = g R/3 and g R/4, and of W, 4 g/(5 R) and 2 g/(3 R)
    ('disk', 1.0 / 3.0, 4.0 / 5.0), ('hoop', 1.0 / 4.0, 2.0 / 3.0)])
def test_an_upright_disk_is_tried_one_percent_above_and_below_its_thresholds(
        shape, rolls, spins):
    scene = load_scene('rolling_disk', [f'body.shape={{{shape}: {{radius: 0.5}}}}'])
    g, shares = scene.effect('gravity').g, []

    def variant(changes):
        """Return the linear motion: x'' = (threshold^2 - rate^2) x, to a factor."""
        assert changes['initial.euler_zyz'] == [0.0, near(0.5 * math.pi, 1e-15), 0.0]
        spin, seed, roll = changes['initial.angular_velocity']
        assert 0.0 < seed < 1e-5 and (spin == 0.0 or roll == 0.0)
        rate, threshold = (roll, rolls * g / 0.5) if roll else (spin, spins * g / 0.5)
        shares.append(abs(rate) / math.sqrt(threshold))
        pace = math.sqrt(abs(threshold - rate * rate))
        grow = np.sinh if rate * rate < threshold else np.sin
        return types.SimpleNamespace(states=lambda times: inclined(
            -np.minimum(seed / pace * grow(pace * times), 0.5)))
    run = types.SimpleNamespace(scene=scene, variant=variant)
    assert all(row.passed for row in convex_body._upright(run, ''))
    assert shares == near([1.01, 0.99, 1.01, 0.99], rel=1e-14)    # measured: 3e-16


@pytest.mark.parametrize(('tilt', 'grows'), [
    (1.05e-4, 1.0), (-1.05e-4, 1.0), (0.95e-4, 0.0), (-0.95e-4, 0.0)])
def test_a_tilt_has_grown_where_it_is_once_beyond_a_ten_thousandth(tilt, grows):
    run = types.SimpleNamespace(scene=load_scene('rolling_disk'), variant=lambda _: (
        types.SimpleNamespace(states=lambda times: inclined(tilt * (times == times[-1])))))
    assert [row.measured for row in convex_body._upright(run, '')] == [grows] * 4


def _kept(row):
    """Return a Quantity as plain data; what is as good as 0 beside an absolute tolerance is 0."""
    found = {part: getattr(row, part) for part in PARTS}
    if row.absolute and np.ndim(row.measured) == 0 and abs(row.measured) < 1e-3:
        found['measured'] = 0.0
    return found


def test_the_reduced_length_of_a_pendulum_is_about_the_axis_of_its_tilt():
    """It tilts about y, where a box of 0.3 x 0.1 x 0.2 m has M (0.3^2 + 0.2^2)/12 + M 0.5^2."""
    scene = load_scene('kapitza_pendulum', [
        'body.shape={box: {size: [0.3, 0.1, 0.2]}}', 'body.center_of_mass=[0, 0, 0.5]'])
    assert kapitza_pendulum.numbers(types.SimpleNamespace(scene=scene)) == (
        0.01, 300.0, 9.81, near((0.13 / 12.0 + 0.25) / 0.5, rel=1e-14))


@pytest.mark.parametrize(('angle', 'rate', 'reach'), [
    # phi'^2/2 = Omega^2 (cos phi - cos reach) with Omega = 3 rad/s
    (-0.4, 0.0, 0.4), (0.0, 3.0, math.pi / 3.0), (0.6, -3.0, math.acos(math.cos(0.6) - 0.5)),
    (0.0, 6.0, None), (0.0, 7.0, None), (0.1, 6.0, None), (0.0, 0.0, None)])
def test_a_pendulum_swings_as_far_as_its_energy_lets_it(angle, rate, reach):
    pendulum = types.SimpleNamespace(angle=lambda _: [angle], rate=lambda _: [rate])
    run = types.SimpleNamespace(states=list, scene=types.SimpleNamespace(name='it'))
    if reach is None:
        with pytest.raises(BadInput, match='does not swing to and fro'):
            kater_pendulum._reach(pendulum, run, 3.0)
    else:
        assert kater_pendulum._reach(pendulum, run, 3.0) == near(reach, rel=1e-14)


def test_a_short_pendulum_swings_too():
    short = load_scene('kater_pendulum', ['constraint.hinge.distance=0.05'])
    assert kater_pendulum.Pendulum(short).length == near(0.05, rel=1e-15)


@pytest.mark.parametrize(('changes', 'is_in_closed_form'), [
    ([], True), (['body.inertia=[0.8, 0.9, 1.3]'], False),
    (['effects.torque.value=[0.1, 0, 0.5]'], False),
    (['effects.torque.value=[0, 0.1, 0.5]'], False)])
def test_the_formula_of_a_driven_body_is_for_a_torque_about_its_axis_of_symmetry(
        changes, is_in_closed_form, monkeypatch):
    monkeypatch.setattr(experiment, 'Simulation', Motion)
    run = experiment.Experiment(load_scene('driven_body', changes), 'exact')
    first = next(driven_body.check(run))
    assert (first.name == 'omega at 41 times') == is_in_closed_form


@pytest.mark.parametrize(('pace', 'is_slow'), [(1.0, False), (0.01, True)])
def test_a_body_is_followed_until_it_has_flipped_three_times(pace, is_slow):
    omega, until = pace * np.array([0.1, 3.0, 0.2]), []

    def crossings(value, begin, end, samples):
        until.append(end)
        return np.arange(3.0)
    run = types.SimpleNamespace(
        scene=load_scene('free_body', ['body.inertia=[1, 2, 3]']), crossings=crossings,
        at=lambda _: types.SimpleNamespace(angular_velocity=omega))
    row, = free_body.flips(run, 20.0)
    assert until == ([near(3.5 * row.predicted[0], rel=1e-15)] if is_slow else [20.0])
    assert (3.5 * row.predicted[0] > 20.0) == is_slow
