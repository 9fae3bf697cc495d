# SPDX-License-Identifier: Apache-2.0
"""A small patch of contact that spins while its body rolls: the phase PIVOTING.

Steps that follow how its slip relaxes take no time: each of these scenes took steps without end.
Compiling a contact with a patch takes half a minute, so `make test` runs what plain Python can.
"""

import math

import numpy as np
import pytest
from near import near
from scipy.integrate import solve_ivp
from soak import IN_SOAK

from rigid_body_sim.errors import NotConverged
from rigid_body_sim.integrators.equations.contact_views import PIVOTING, ROLLING, SLIDING
from rigid_body_sim.integrators.marching.contact_march import STEPS
from rigid_body_sim.integrators.marching.contact_phase import MODE
from rigid_body_sim.numerics.rotations import rotate
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.simulation.simulation import Simulation

G, RADIUS, MU, SINE, COSINE = 9.81, 0.02, 0.6, 0.6, 0.8


def simulation(effects, initial, table, accuracy, horizon):
    """Return a Simulation of a ball of 1 kg under gravity by dop8."""
    return Simulation(parse_scene(
        f'scene: pivots\nbody: {{mass: 1.0, shape: {{solid_sphere: {{radius: {RADIUS}}}}}, '
        f'surface: {{sphere: {{radius: {RADIUS}}}}}}}\nconstraint: {table}\n'
        f'effects: [gravity: {{g: {G}}}, sliding_friction: {{mu: {MU}}}, {effects}]\n'
        f'initial: {initial}\n'), 'dop8', accuracy, horizon=horizon)


def phases_of(sim):
    """Return (mode, steps) of the phases of the course that a simulation is on."""
    return [(int(phase.p[MODE]), int(phase._meta[STEPS]))
            for phase in sim._spans[-1].solver._course._so_far.phases]


def on_a_slope(patch, spin, accuracy, horizon):
    """Return a ball that rolls down a slope and spins about its normal, and its closed form.

    With W = rho w, x = u/W down the slope and S = W sqrt(1 + x^2), friction is mu N x W/S up the
    slope and mu N rho W/S about the normal, so that, with B = 7/2 mu g cos a and
    D = 5/2 mu g cos a rho^2/R^2,

        u' = g sin a - B x/sqrt(1 + x^2)        W' = -D/sqrt(1 + x^2)

    u' = x W' for the constant x = g sin a/sqrt((B - D)^2 - (g sin a)^2): W falls evenly to 0, and
    from v = R omega + u, v' = g sin a - F/m, 2/5 m R^2 omega' = F R the ball goes down with
    v' = (5 g sin a + 2 u')/7.

    Returns
    -------
    Simulation
    end : float
        When the spin dies, s.
    along : callable
        Time up to then (s) -> distance down the slope (m), speed (m/s).
    """
    fast, slow = 3.5 * MU * G * COSINE, 2.5 * MU * G * COSINE * (patch / RADIUS) ** 2
    x = G * SINE / math.sqrt((fast - slow) ** 2 - (G * SINE) ** 2)
    pace, slip = slow / math.sqrt(1.0 + x * x), x * patch * spin
    grown = (5.0 * G * SINE - 2.0 * x * pace) / 7.0
    sim = simulation(
        f'spinning_friction: {{radius: {patch}}}',
        f'{{angular_velocity_world: [0, {SINE * spin!r}, {COSINE * spin!r}], '
        f'velocity: [0, {COSINE * slip!r}, {-SINE * slip!r}]}}',
        f'{{table: {{normal: [0, {SINE}, {COSINE}]}}}}', accuracy, horizon)
    return sim, patch * spin / pace, lambda t: (
        slip * t + 0.5 * grown * t * t, slip + grown * t)


@pytest.mark.parametrize(('patch', 'spin', 'accuracy', 'bound'), [
    (1e-6, 0.01, 1e-9, 3e-12),    # measured: 4e-13
    pytest.param(1e-6, 0.01, 1e-12, 3e-14, marks=IN_SOAK),     # 3e-15
    pytest.param(1e-7, 1e-3, 1e-12, 6e-14, marks=IN_SOAK)])    # 9e-15
def test_a_ball_goes_down_a_slope_while_its_spin_dies_as_its_closed_form_says(
        patch, spin, accuracy, bound):
    sim, end, along = on_a_slope(patch, spin, accuracy, 8.0)
    event = sim.at_event('rolling began', within=8.0)
    assert event.time == near(end, rel=bound)
    phases = phases_of(sim)
    assert [mode for mode, _ in phases] == [SLIDING, PIVOTING, ROLLING]
    assert sum(steps for _, steps in phases) < 4000    # 2354; 9e7 if all of it were slip
    way = np.array([0.0, COSINE, -SINE])
    for share in (0.01, 0.5, 0.99):
        (state,) = sim.states([share * end])
        place, speed = along(share * end)
        assert state.position @ way == pytest.approx(place, abs=bound)
        assert state.velocity @ way == pytest.approx(speed, abs=bound)
    sim.advance(400)
    ledger = sim.ledger()
    assert abs(ledger['energy_residual']) < bound
    # all that the spin had, 1/5 m R^2 w^2, and what the slip takes beside it, mu N u^2/S
    assert ledger['dissipated_spinning'] == near(0.2 * (RADIUS * spin) ** 2, rel=1e-11)


@IN_SOAK
def test_one_jump_through_a_pivot_has_the_bits_of_many_calls():
    times = np.linspace(0.0, 0.4, 41)
    far, near = (on_a_slope(1e-6, 0.01, 1e-9, 8.0)[0] for _ in range(2))
    rows = far.states(times).vector
    for k in (3, 17, 18, 29, 36, 40):
        assert near.states([times[k]]).vector.tolist() == rows[[k]].tolist()


@IN_SOAK
def test_a_pivot_whose_friction_reaches_the_cone_slips_when_its_equations_say():
    """A force k t along a level table: friction follows it up to mu m g, and no further.

    With W = rho w, x = u/W, S = W sqrt(1 + x^2): u' = k t/m - 7/2 mu g u/S and
    W' = -5/2 mu g rho^2/R^2 W/S; v' = k t/m - mu g u/S. They are solved in (u, W).
    """
    patch, spin, k, end = 1e-6, 0.01, 400.0, 0.07
    sim = simulation(f'spinning_friction: {{radius: {patch}}}, '
                     f'force: {{value: ["{k}*t", 0, 0], frame: world}}',
                     f'{{angular_velocity: [0, 0, {spin}]}}', 'table', 1e-9, 1.0)
    slip, spun = 3.5 * MU * G, 2.5 * MU * G * (patch / RADIUS) ** 2

    def rates(t, y):
        size = math.hypot(y[0], y[1])
        return [k * t - slip * y[0] / size, -spun * y[1] / size, k * t - MU * G * y[0] / size]

    solved = solve_ivp(rates, (0.0, end), [0.0, patch * spin, 0.0], 'Radau', rtol=1e-10,
                       atol=[1e-18, 1e-18, 1e-13])
    (state,) = sim.states([end])
    assert [mode for mode, _ in phases_of(sim)][:3] == [SLIDING, PIVOTING, SLIDING]
    assert sum(steps for _, steps in phases_of(sim)) < 20000    # measured: 6900
    turn = rotate(*state.orientation, *state.angular_velocity)
    assert state.velocity[0] == pytest.approx(solved.y[2, -1], abs=3e-12)    # measured: 3e-13
    assert state.velocity[0] - RADIUS * turn[1] == pytest.approx(solved.y[0, -1], abs=3e-11)
    sim.advance(70)
    assert abs(sim.ledger()['energy_residual']) < 1e-11    # measured: 1e-12


def drawn(body, table, effects, initial, accuracy, horizon):
    """Return a Simulation of one of the scenes that a fuzz has drawn."""
    return Simulation(parse_scene(
        f'scene: pivots\nbody: {body}\nconstraint: {table}\neffects: [gravity: {{g: {G}}}, '
        f'{effects}]\ninitial: {initial}\n'), 'dop8', accuracy, horizon=horizon)


@IN_SOAK
@pytest.mark.parametrize(('body', 'table', 'effects', 'initial', 'end', 'most'), [
    # friction comes near the cone fast, where differences have to be short: 3e4 steps, 8e5 if not
    ('{mass: 1.68, shape: {disk: {radius: 0.1141}}}', 'table',
     'sliding_friction: {mu: 0.2864}, spinning_friction: {radius: 1.593e-09}',
     '{euler_zyz: [0.07869, 0.4601, 1.677], angular_velocity: [7.018, 2.358, 6.346], '
     'rolling: true}', 0.8, 1e5),
    # the accuracy lets it pivot at times; too short a difference is noise: 3e4 steps, 4e5 then
    ('{mass: 1.173, inertia: [3.134e-05, 3.134e-05, 3.095e-05], '
     'center_of_mass: [0, 0, -5.296e-4], surface: {sphere: {radius: 0.008173}}}',
     '{table: {normal: [-0.2981, -0.07737, 1]}}',
     'sliding_friction: {mu: 0.1211}, spinning_friction: {radius: 7.508e-07}',
     '{euler_zyz: [5.529, 2.082, 2.621], angular_velocity: [3.563, 1.454, -75.49], '
     'rolling: true}', 0.23, 1e5),
    # the spin is less than the accuracy lets the slip err by: 2e4 steps, 1e8 if it does not pivot
    ('{mass: 0.02039, shape: {torus: {radius: 0.01231, tube: 0.003857}}}',
     '{table: {normal: [-0.2647, 0.0122, 1]}}',
     'sliding_friction: {mu: 0.2148}, spinning_friction: {radius: 3.472e-10}',
     '{euler_zyz: [1.57, 1.332, 0.1538], angular_velocity: [0.3056, -1.303, 3.031], '
     'rolling: true}', 0.28, 1e5)])
def test_a_body_that_pivots_takes_few_steps_and_errs_by_less_than_is_asked(
        body, table, effects, initial, end, most):
    ends = []
    for accuracy in (1e-9, 1e-12):
        sim = drawn(body, table, effects, initial, accuracy, end)
        ends.append(sim.states([end]).vector[0])
        assert PIVOTING in [mode for mode, _ in phases_of(sim)]
        assert sum(steps for _, steps in phases_of(sim)) < most
        sim.advance(math.floor(1000.0 * end))
        # measured: up to 6e-12 and 3e-15
        assert abs(sim.ledger()['energy_residual']) < 0.1 * accuracy
    assert ends[0] == pytest.approx(ends[1], abs=1e-9)


@IN_SOAK
def test_a_ring_that_pivots_and_falls_flat_ends_its_run_with_the_line_of_one_that_spins_there():
    """Its lowest point runs around it ever faster; differences across that led nowhere."""
    sim = drawn('{mass: 2.923, shape: {torus: {radius: 0.3043, tube: 0.1428}}}',
                '{table: {normal: [-0.1084, -0.2869, 1]}}',
                'sliding_friction: {mu: 0.9169}, rolling_friction: {viscous: 0.7814}, '
                'spinning_friction: {radius: 4.65e-09}',
                '{euler_zyz: [5.463, 0.8471, 0.5653], angular_velocity: [0.192, 1.033, 0.5213], '
                'rolling: true}', 1e-9, 1.4)
    with pytest.raises(NotConverged, match='the body lies flat and goes on sliding or spinning'):
        sim.states([1.4])
    assert sum(steps for _, steps in phases_of(sim)) < 2e5    # measured: 7e4


@IN_SOAK
def test_a_spin_that_friction_cannot_stop_goes_on_through_0_without_an_event():
    """The body turns its spin about the normal around: a creep that began there erred by 3e-9."""
    ends = []
    for accuracy in (1e-9, 1e-12):
        sim = drawn('{mass: 1.227, '
                    'shape: {ellipsoid: {semi_axes: [0.003868, 0.002704, 0.003353]}}}',
                    '{table: {normal: [0.07471, 0.2683, 1.0]}}',
                    'sliding_friction: {mu: 0.297}, spinning_friction: {radius: 1.196e-10}',
                    '{euler_zyz: [4.921, 1.128, 0.5745], angular_velocity: [17.13, 2.212, 12.04], '
                    'rolling: true}', accuracy, 0.16)
        ends.append(sim.states([0.158]).vector[0])
        assert [mode for mode, _ in phases_of(sim)][:3] == [SLIDING, PIVOTING, PIVOTING]
        assert sum(steps for _, steps in phases_of(sim)) < 1e5
        sim.advance(158)
        assert not sim.events
        # measured: 1e-12 and 2e-15
        assert abs(sim.ledger()['energy_residual']) < 0.03 * accuracy
    assert ends[0] == pytest.approx(ends[1], abs=1e-9)
