# SPDX-License-Identifier: Apache-2.0
"""Bodies at the limits of inertia: rod, ball, needle, and a pendulum without spin."""

import numpy as np

from rigid_body_sim.errors import BadInput
from rigid_body_sim.study.scenes import instruments
from rigid_body_sim.study.scenes.heavy_top import SWINGS, Top, rates, turning_points
from rigid_body_sim.study.scenes.quantity import Quantity
from rigid_body_sim.study.scenes.symmetric_top import cones, round_the_axis
from rigid_body_sim.theory import heavy_top, inertia_tensors, symmetric_top


def thin_rod(run):
    """Yield the quantities of a rod without moment about itself, which turns about L at L/I1."""
    M = run.scene.body.mass
    I1 = run.scene.body.about_center.moments[0]
    length = np.sqrt(12.0 * I1 / M)
    omega = run.at(0.0).angular_velocity.copy()
    L = run.read(instruments.momentum_in_world((I1, I1, 0.0)), [0.0])[0]
    rate = symmetric_top.precession_rate_in_space(np.linalg.norm(L), I1)
    yield Quantity('L/I1 with I1 = M l^2/12, l the length',
                   np.linalg.norm(L) / inertia_tensors.rod_about_center(M, length)[0],
                   np.linalg.norm(omega), 1e-15, 'rad/s')
    start = instruments.axes(run.states([0.0]))[0, :, 2]
    across = np.cross(L / np.linalg.norm(L), start)
    rises = run.crossings(
        lambda s: instruments.axes(s)[:, :, 2] @ across, 0.1 / rate, 65.0 / rate, 400, rising=True)
    yield Quantity('period of the rod in space, 2 pi I1/L',
                   np.full(len(rises) - 1, 2.0 * np.pi / rate), np.diff(rises), 1e-11, 's')
    times = np.linspace(0.0, 1000.0, 501)
    states = run.states(times)
    angle = rate * times
    evenly = np.outer(np.cos(angle), start) + np.outer(np.sin(angle), across)
    yield Quantity('direction of the rod at 501 times in 1000 s', evenly.ravel(),
                   instruments.axes(states)[:, :, 2].ravel(), 1e-10)
    measured = instruments.momentum_in_world((I1, I1, 0.0))(states)
    yield Quantity(
        'L in the world at 501 times', np.tile(L, 501), measured.ravel(), 1e-12, 'kg m^2/s')


def sphere(run):
    """Yield the quantities of a body with three equal moments: omega is constant in all axes."""
    omega = run.at(0.0).angular_velocity.copy()
    size = float(np.linalg.norm(omega))
    if not size:
        raise BadInput(run.scene.name, 'omega is zero', 'needs a rotating body')
    times = np.linspace(0.0, 100.0, 501)
    states = run.states(times)
    yield Quantity('omega in the body at 501 times', np.tile(omega, 501),
                   states.angular_velocity.ravel(), 1e-14, 'rad/s')
    world = instruments.omega_in_world(states)
    yield Quantity(
        'omega in the world at 501 times', np.tile(world[0], 501), world.ravel(), 1e-12, 'rad/s')
    direction = np.cross(omega, np.eye(3)[np.argmin(np.abs(omega))])
    rises = run.crossings(lambda s: instruments.axes(s)[:, 0] @ direction
                          - instruments.axes(run.states([0.0]))[0, 0] @ direction,
                          0.2 * 2.0 * np.pi / size, 6.2 * 2.0 * np.pi / size, 400)
    slopes = [run.read(lambda s: instruments.axes(s)[:, 0] @ direction,
                       [time - 1e-3 / size, time + 1e-3 / size])
              for time in rises]
    first = run.read(lambda s: instruments.axes(s)[:, 0] @ direction, [0.0, 1e-3 / size])
    same = rises[[np.sign(b - a) == np.sign(first[1] - first[0]) for a, b in slopes]]
    yield Quantity('period 2 pi/|omega|', np.full(len(same) - 1, 2.0 * np.pi / size),
                   np.diff(same), 1e-11, 's')
    moment = run.scene.body.about_center.moments[0]
    expected = inertia_tensors.solid_sphere(run.scene.body.mass, run.scene.body.radius)[0]
    yield Quantity('moments of a solid sphere', expected, moment, 1e-15, 'kg m^2')


def needle(run):
    """Yield the quantities of a needle: the formulas of the symmetric top at their limit."""
    I1, _, I3 = run.scene.body.about_center.moments
    omega = run.at(0.0).angular_velocity.copy()
    yield from round_the_axis(run, symmetric_top.precession_rate(omega[2], I1, I3),
                              symmetric_top.precession_rate_as_written(omega[2], I1, I3))
    yield from cones(run, np.linspace(0.0, 10.0, 101), 1e-10)
    L = run.read(instruments.momentum_in_world((I1, I1, I3)), np.linspace(0.0, 10.0, 101))
    yield Quantity('L in the world at 101 times', np.tile(L[0], 101), L.ravel(), 1e-11, 'kg m^2/s')


def spherical_pendulum(run):
    """Yield the quantities of a mass on a rod: the heavy top with P_gamma = 0."""
    top = Top(run)
    half = heavy_top.time_between_turning_points(
        run.at(0.0).angular_velocity, _up(run), top.I1, top.I3, top.Mgl)
    kept = run.read(top.moments_of_motion(run), np.linspace(0.0, 100.0, 501))[:, 0]
    yield Quantity('p_alpha over 100 s', np.full(501, top.P_alpha), kept, 1e-12, 'kg m^2/s')
    yield from rates(run, top, half * np.array([0.13, 0.55, 1.31]))
    yield from turning_points(run, top, half, 2.0 * SWINGS * half)


def _up(run):
    """Return the upward vertical in body axes at the start."""
    return instruments.axes(run.states([0.0]))[0, 2]
