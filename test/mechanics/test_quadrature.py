# SPDX-License-Identifier: Apache-2.0
"""The ledger's entries: those of the published trajectory, however rarely they are asked for."""

import functools
import json
import os
import pathlib
import subprocess
import sys

import numpy as np
import pytest
from near import near
from soak import IN_SOAK

from rigid_body_sim.integrators.solver import Stepped
from rigid_body_sim.mechanics.ledger import ANGULAR_IMPULSE, DISSIPATED, WORK
from rigid_body_sim.mechanics.panels import COUNT, NOISE, POINTS
from rigid_body_sim.mechanics.parameters import SCENE
from rigid_body_sim.mechanics.quadrature import Actors, Quadrature, _edges, _source
from rigid_body_sim.scene.effects.protocol import Acting
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.simulation.simulation import Simulation

ROOT = pathlib.Path(__file__).resolve().parents[2]
EPSILON = np.finfo(float).eps
TOP = """
scene: top
body: {{mass: 1.0, inertia: [0.03, 0.03, 0.01], inertia_about: origin, center_of_mass: {arm}}}
constraint: pivot
effects: [gravity: {{g: {g}}}]
initial: {{euler_zyz: [0.0, {tilt}, 0.0], angular_velocity: {omega}}}
"""
# a coin on its edge: nearby motions part by a factor of e in a second or less
COIN = """
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.simulation.simulation import Simulation
import json
scene = parse_scene('''
scene: coin
body: {mass: 0.0075, shape: {cylinder: {radius: 0.01213, length: 0.00175}},
       center_of_mass: [0, 0.01213, 0]}
constraint: pivot
effects: [gravity: {g: 9.81}, drag: {linear: 0, angular: 1.0e-8}]
initial: {orientation: [0.7071067811865476, 0, 0, 0.7071067811865476],
          angular_velocity: [0.5, 60, 0]}
''')
simulation = Simulation(scene, 'taylor', accuracy=1e-6, horizon=1.5)
before = simulation.energy
simulation.advance(1500)
print(json.dumps(simulation.ledger() | {'lost': before - simulation.energy}))
"""

SLOW = """
scene: slow
body: {mass: 4.0, inertia: [0.011, 0.013, 0.024], center_of_mass: [-0.018, -0.022, 0.013]}
constraint: {hinge: {axis: [-0.98, 0.04, 0.2], through: [-0.009, -0.005, 0.005]}}
effects:
- torque: {times: [0.07, 2.0], frame: body,
           values: [[-0.002, -0.0065, 0.0037], [0.0113, 0.0015, -0.0003]]}
- drag: {linear: 0.19, angular: 1.1e-4, quadratic: 5.5, angular_quadratic: 9.5e-5}
initial: {angle: 1.19, rate: 2.12}
"""


def test_the_ledger_belongs_to_the_trajectory_that_is_published():
    """The ledger of taylor once followed the trajectory of dop8, which parts from its own."""
    settings = os.environ | {'NUMBA_DISABLE_JIT': '1', 'PYTHONPATH': str(ROOT)}
    command = [sys.executable, '-c', COIN]
    text = subprocess.run(command, capture_output=True, text=True, timeout=200, env=settings,
                          check=True).stdout
    ledger = json.loads(text)
    scale = max(ledger['kinetic'], abs(ledger['potential']))
    assert abs(ledger['lost'] - ledger['dissipated']) < 1e-8 * scale
    assert ledger['momentum_residual'] < 1e-7


@pytest.mark.parametrize(('g', 'tilt', 'arm', 'omega'), [
    (981.0, 0.5, [0, 0, 0.1], [0, 0, 60]), (981.0, 2.9, [0, 0, 0.1], [3, 0, 2]),
    (9.81, 1e-5, [0, 0, 0.1], [0, 0, 30]), (1e4, 1.0, [0, 0, -0.1], [0, 300, 90])])
def test_momentum_residual_does_not_depend_on_how_rarely_it_is_asked(g, tilt, arm, omega):
    scene = parse_scene(TOP.format(g=g, tilt=tilt, arm=arm, omega=omega))
    turned = 20.0 * (np.linalg.norm(omega) + 2.0 * np.sqrt(g * 0.1 / 0.03))
    for often in (1, 7, 50):
        simulation, worst = Simulation(scene), 0.0
        for _ in range(20 * often):
            simulation.advance(1000 // often)
            worst = max(worst, simulation.ledger()['momentum_residual'])
        assert worst < 4.0 * EPSILON * turned
    once, often = (Simulation(scene).choice.solver(scene.initial.vector, None) for _ in range(2))
    for time in np.linspace(0.0, 20.0, 37):
        entries = often.entries(time)
    assert np.array_equal(once.entries(20.0), entries)


def turning(scene, rate):
    """Return an Quadrature along a turn about z at a rate given as (angle, rate) of time."""
    def states(times, out):
        out[:] = 0.0
        angle, speed = rate(times)
        out[:, 0], out[:, 3], out[:, 4], out[:, 7] = (
            times, np.sin(0.5 * angle), np.cos(0.5 * angle), speed)
    start = np.empty((1, 14))
    states(np.zeros(1), start)
    return Quadrature(Actors(scene), states, start[0], 0.0)


@pytest.mark.without_numba
@pytest.mark.parametrize('damping', [1e-3, 1.0, 1e4, 1e10])
def test_heat_of_a_layer_that_is_over_before_the_first_node(damping):
    """A body of moment 2 that drag stops: omega = 3 exp(-k t/2), heat = 2 9/2."""
    scene = parse_scene('scene: s\nbody: {mass: 1.0, inertia: [2, 2, 2]}\nconstraint: free\n'
                        f'effects: [drag: {{angular: {damping!r}}}]\n'
                        'initial: {angular_velocity: [0, 0, 3]}\n')

    def rate(t):
        left = np.exp(-0.5 * damping * t)
        return -6.0 / damping * np.expm1(-0.5 * damping * t), 3.0 * left
    quadrature = turning(scene, rate)
    for time in (1e-12, 0.3, 50.0):
        heat = -9.0 * np.expm1(-damping * time)
        entries = quadrature.until(time)
        assert entries[DISSIPATED] == pytest.approx(heat, rel=1e-13, abs=1e-15)
        impulse = 6.0 * np.expm1(-0.5 * damping * time)
        assert entries[ANGULAR_IMPULSE][2] == pytest.approx(impulse, rel=1e-13, abs=1e-15)


@pytest.mark.without_numba
@pytest.mark.parametrize('off', [1e-12, 1e-60, 1e-160, 1e-300])
@pytest.mark.parametrize('coefficient', [3.0, 1e5, 1e9])
def test_a_burst_of_heat_after_a_long_rest_is_booked(coefficient, off):
    """A rod (1, 4, 4) from its axis: m = (sin a, cos a), tan a = off e^(k t), k = c (1 - 1/4).

    For all of that time nothing is dissipated, and then all within some 1/k.
    """
    scene = parse_scene('scene: s\nbody: {mass: 1.0, inertia: [1, 4, 4]}\nconstraint: free\n'
                        f'effects: [internal_dissipation: {{coefficient: {coefficient!r}}}]\n'
                        'initial: {angular_velocity: [1, 0, 0]}\n')
    rate = 0.75 * coefficient

    def states(times, out):
        out[:] = 0.0
        out[:, 0], out[:, 4] = times, 1.0
        folds = np.log(off) + rate * times    # ln tan a
        out[:, 5] = 1.0 / np.sqrt(1.0 + np.exp(2.0 * np.minimum(folds, 300.0)))
        out[:, 6] = 0.25 / np.sqrt(1.0 + np.exp(np.clip(-2.0 * folds, -600.0, 700.0)))
    start = np.empty((1, 14))
    states(np.zeros(1), start)
    quadrature = Quadrature(Actors(scene), states, start[0], 0.0)
    assert quadrature.until(1e3)[DISSIPATED] == near(0.375, rel=1e-12)    # 1/2 - 1/8 J


@pytest.mark.without_numba
def test_a_torque_in_pieces_is_integrated_up_to_each_jump():
    scene = parse_scene(
        'scene: s\nbody: {mass: 1.0, inertia: [1, 1, 1]}\nconstraint: free\neffects: [torque: '
        '{times: [0.5, 0.500001, 2.5], values: [[0, 0, 1], [0, 0, -2], [0, 0, 0]], frame: world}]'
        '\ninitial: {angular_velocity: [0, 0, 7]}\n')
    quadrature = turning(scene, lambda t: (7.0 * t, np.full(len(t), 7.0)))
    assert not quadrature.until(0.5).any()
    for time, impulse in ((1.0, 1e-6 - 2.0 * 0.499999), (9.0, 1e-6 - 2.0 * 1.999999)):
        entries = quadrature.until(time)
        assert entries[ANGULAR_IMPULSE][2] == near(impulse, rel=1e-14)
        assert entries[WORK] == near(7.0 * impulse, rel=1e-14)


def test_a_short_pulse_in_a_slow_motion_is_seen():
    """A rate with a pole near the real axis: a peak of width 1e-3 s at 4.567 s."""
    scene = parse_scene('scene: s\nbody: {mass: 1.0, inertia: [1, 1, 1]}\nconstraint: free\n'
                        'effects: [torque: {value: [0, 0, 1], frame: world}]\n'
                        'initial: {angular_velocity: [0, 0, 7]}\n')
    width, place = 1e-3, 4.567

    def rate(t):
        x = (t - place) / width
        return 0.1 * t + np.arctan(x), 0.1 + 1.0 / (width * (1.0 + x * x))
    quadrature = turning(scene, rate)
    work = 1.0 + np.arctan((10.0 - place) / width) + np.arctan(place / width)
    assert quadrature.until(10.0)[WORK] == near(work, rel=1e-12)


def test_the_noise_of_the_power_is_that_of_forces_and_torques_times_their_speeds():
    soft = '0.5*(1 + tanh((t - 5)/0.5))'
    actors = Actors(parse_scene(
        'scene: s\nbody: {mass: 1.0, inertia: [1, 2, 2.5]}\nconstraint: free\neffects: '
        f"[force: {{value: ['{soft}', 0, 0], frame: world}}, "
        f"torque: {{value: [0, '{soft}', 0]}}]\n"
        'initial: {}\n'), horizon=10.0)
    states = np.zeros((3, 14))
    states[:, 4] = 1.0
    states[0, 11:14], states[1, 11:14], states[2, 5:8] = (1, 0, 0), (2, -3, 6), (0, 3, 4)
    noise = actors.rates(actors.held(0.0), states)[:, NOISE]
    assert noise[0] > 0.0 and actors.noise > 0.0
    assert noise == near([noise[0], 7.0 * noise[0], 5.0 * actors.noise], rel=1e-15)


def lengths_of_panels(scene, until):
    """Return the lengths of the panels that are looked at, in order, of a body that stands."""
    found = []

    def states(times, out):
        out[:] = 0.0
        out[:, 0], out[:, 4] = times, 1.0
        out[:, 5:8] = start[0, 5:8]
        # the nodes are symmetric: the last one is as far from the end as the first is from 0
        first, last = (times[k::POINTS] - times[::POINTS] for k in (1, COUNT))
        found.extend((first + last).tolist())
    start = np.zeros((1, 14))
    start[0, 4:8] = 1.0, *scene.initial.angular_velocity
    Quadrature(Actors(scene), states, start[0], 0.0).until(until)
    return found


@pytest.mark.parametrize('omega', [0.0, 5.0])
def test_no_panel_is_longer_than_eight_radians_of_the_fastest_turn(omega):
    """A pendulum of 9.81 m/s^2 and 1 m: to its 5 rad/s come 2 sqrt(9.81) at most."""
    scene = parse_scene('scene: s\nbody: {mass: 1.0, inertia: [1, 1, 0], inertia_about: origin, '
                        'center_of_mass: [0, 0, 1]}\nconstraint: pivot\n'
                        'effects: [gravity: {g: 9.81}]\n'
                        f'initial: {{angular_velocity: [{omega}, 0, 0]}}\n')
    lengths = lengths_of_panels(scene, 40.0)
    longest = 8.0 / (omega + 2.0 * np.sqrt(9.81))
    assert lengths[0] == near(longest, rel=1e-12)
    assert max(lengths) == near(longest, rel=1e-12)


def test_the_first_panel_of_a_driven_body_at_rest_is_the_time_of_eight_radians():
    """t^2 2/2 = 8 about the axis of least moment; then panels grow, for nothing turns here."""
    scene = parse_scene('scene: s\nbody: {mass: 1.0, inertia: [1, 1, 1]}\nconstraint: free\n'
                        'effects: [torque: {value: [0, 0, 2], frame: world}]\ninitial: {}\n')
    lengths = lengths_of_panels(scene, 400.0)
    assert lengths[0] == near(np.sqrt(8.0), rel=1e-12)
    assert lengths[1] == near(2.0 * np.sqrt(8.0), rel=1e-12)


def test_time_that_goes_back_gives_the_entries_of_then():
    scene = parse_scene('scene: s\nbody: {mass: 1.0, inertia: [1, 1, 1]}\nconstraint: free\n'
                        'effects: [torque: {times: [3], values: [[0, 0, 2]], frame: world}]\n'
                        'initial: {angular_velocity: [0, 0, 7]}\n')
    quadrature = turning(scene, lambda t: (7.0 * t, np.full(len(t), 7.0)))
    later = quadrature.until(9.0)
    assert not quadrature.until(2.0).any()
    assert quadrature.until(9.0).tobytes() == later.tobytes()
    assert later[WORK] == near(2.0 * 7.0 * 6.0, rel=1e-14)


@pytest.mark.parametrize('end', [1.0, 1.05, 1.1, 1.3, 2.04, 2.2])
def test_a_panel_that_would_leave_less_than_a_tenth_of_another_goes_up_to_the_jump(end):
    edges = [0.0]
    while edges[-1] < end:
        edges += _edges(edges[-1], 10.0, end, 1.0, 4)[1:].tolist()
    lengths = np.diff(edges)
    assert edges[-1] == end
    assert lengths[:-1].tolist() == [1.0] * (len(lengths) - 1)
    assert 0.0999 < lengths[-1] < 1.1001


def test_edges_do_not_depend_on_where_a_call_begins():
    at_once = _edges(0.0, 10.0, np.inf, 0.1, 64)
    assert len(at_once) == 65
    assert np.array_equal(_edges(at_once[20], 10.0, np.inf, 0.1, 44), at_once[20:])
    assert _edges(9.95, 10.0, np.inf, 0.1, 8).tolist() == [9.95]


@pytest.mark.without_numba
def test_a_kink_of_what_acts_is_resolved_however_small_it_is():
    """Drag by squares of a body that turns back: c |omega| omega has a kink there.

    omega = a (t - b): the heat is c a^3 ((t - b)^4 + b^4)/4, the angular impulse that of the
    torque, T t, less c a^2 ((t - b)^3 - b^3)/3 after the turn.
    """
    a, b, c, torque, end = 1.5, 0.37, 1e-5, 0.25, 2.0
    scene = parse_scene('scene: s\nbody: {mass: 1.0, inertia: [2, 2, 2]}\nconstraint: free\n'
                        f'effects: [torque: {{value: [0, 0, {torque}], frame: world}}, '
                        f'drag: {{angular_quadratic: {c}}}]\n'
                        f'initial: {{angular_velocity: [0, 0, {-a * b}]}}\n')
    quadrature = turning(scene, lambda t: (a * t * (0.5 * t - b), a * (t - b)))
    entries = quadrature.until(end)
    after = end - b
    heat = 0.25 * c * a ** 3 * (after ** 4 + b ** 4)
    impulse = torque * end - c * a * a * (after ** 3 - b ** 3) / 3.0
    assert entries[DISSIPATED] == near(heat, rel=1e-14)                # 4.4e-16
    assert entries[ANGULAR_IMPULSE][2] == near(impulse, rel=1e-14)    # 0


@IN_SOAK
@pytest.mark.without_numba
def test_a_coarse_tolerance_that_is_fine_enough_leaves_the_ledger_as_fine_as_was_asked():
    """Slow torques: gauss16 meets 1e-11 with a tolerance of 0.1, whose own jumps are no bound."""
    scene = parse_scene(SLOW)
    start = scene.initial.vector
    solver = Stepped(scene, 'gauss16', 0.1, horizon=7.0)
    exact = Quadrature(Actors(scene), solver.start(start).states, start, 0.0).until(7.0)
    loose, fine = (solver.at(0.1, wanted=wanted).start(start).entries(7.0)
                   for wanted in (np.inf, 1e-11))
    size = np.abs(exact).max()
    assert np.abs(fine - exact).max() <= 1e-15 * size    # 6.7e-17
    assert np.abs(loose - exact).max() > 1e-9 * size     # 6.1e-6: what is asked matters


ROWS = np.random.default_rng(3).normal(size=(5, 3, 20)).round(3)


def linear(k, *numbers):
    """Return what kernel k makes of its values and the state: another linear function of each."""
    return tuple((ROWS[k][:, :len(numbers)] @ numbers).tolist())


weighs, blows, creeps, brakes, drags, falls = (
    functools.partial(linear, k) for k in (0, 1, 2, 3, 4, 0))


@pytest.mark.parametrize('carried', [False, True])
@pytest.mark.without_numba
def test_what_acts_is_booked_as_work_as_heat_or_not_at_all(carried):
    """Work by its power; heat by what is taken, that of axes that creep by u = u0 + a c Gamma.

    Potentials Gamma do work on these axes, Gamma . u, and are no entry themselves. At a pivot that
    moves with v the bearing balances each force: its work is less by F . v.
    """
    acts = [Acting(f'{__name__}:weighs', (2.0, 3.0), 'torque', 'potential'),
            Acting(f'{__name__}:blows', (4.0,), 'force', 'work', in_field=True),
            Acting(f'{__name__}:creeps', (0.5, 6.0), 'turning', 'heat'),
            Acting(f'{__name__}:brakes', (7.0,), 'torque', 'work', in_field=True, inner=True),
            Acting(f'{__name__}:drags', (), 'force', 'heat'),
            Acting(f'{__name__}:drags', (), 'torque', 'heat'),
            Acting(f'{__name__}:falls', (), 'force', 'potential')]
    q, omega, v, m = (0.1, -0.5, 0.5, 0.7), (1.0, -2.0, 3.0), (7.0, -8.0, 9.0), (0.2, 0.3, -0.4)
    time, place = 0.4, (4.0, -5.0, 6.0)
    state, field = (*q, *omega, *v), (time, *place)
    pull, wind, drag, brake, fall = (np.array(one) for one in (
        weighs(2.0, 3.0, *state), blows(4.0, *state, *field), drags(*state),
        brakes(7.0, *state, *field), falls(*state)))
    turn = creeps(0.5, 6.0, *state) + 0.5 * pull
    names = {'compiled': lambda function: function}
    exec(_source(acts, carried), names)
    p = (*[9.0] * SCENE.size, 2.0, 3.0, 4.0, 0.5, 6.0, 7.0)
    work, heat, torque = names['acting'](p, q, omega, v, m, time, place)
    assert torque == near(pull + drag, rel=1e-14)
    bearing = -(drag + fall) @ v if carried else wind @ v
    assert work == near(bearing + brake @ omega, rel=1e-13)
    taken = np.cross(m, turn) @ omega + drag @ v + drag @ omega - pull @ turn
    assert heat == near(-taken, rel=1e-13)


@pytest.mark.without_numba
def test_where_nothing_acts_nothing_is_booked():
    names = {'compiled': lambda function: function}
    exec(_source([], False), names)
    assert names['acting'](None, None, None, None, None, 0.0, None) == (0.0, 0.0, (0.0, 0.0, 0.0))
