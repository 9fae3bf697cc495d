# SPDX-License-Identifier: Apache-2.0
"""Groups 4, 7, 8, 9 and 10: checked by exact statements or laws rather than by a reference."""

import functools
import hashlib
import math
import os
import subprocess
import sys

import numpy as np

from rigid_body_sim.errors import BadInput
from rigid_body_sim.numerics.rotations import angle_between
from rigid_body_sim.scene.scene import load_scene, parse_scene
from rigid_body_sim.simulation.simulation import Simulation
from rigid_body_sim.study.hard_cases import questions
from rigid_body_sim.study.hard_cases.case import Case, Outcome
from rigid_body_sim.study.hard_cases.contact import Shot, question
from rigid_body_sim.study.hard_cases.sliding_ball import A, G

EPSILON = np.finfo(float).eps
RELAXING = ('scene: relaxing\nbody: {{mass: 1.0, inertia: {inertia}}}\nconstraint: free\n'
            'effects: [internal_dissipation: {{coefficient: {c!r}}}]\n'
            'initial: {{angular_velocity: {omega}}}\n')
BALL = ('scene: ball\nbody: {{mass: 0.17, shape: {{solid_sphere: {{radius: 0.028575}}}}}}\n'
        'constraint: table\n'
        'effects: [{strike}sliding_friction: {{mu: {mu!r}, g: 9.81}}]\ninitial: {initial}\n')
WOBBLING, ON_SMALLEST, OFF_SMALLEST = (2.0, 0.1, 0.2), (5.0, 0.0, 0.0), (5.0, 0.0, 1e-300)
LEAVES = (math.log(1e300) - math.log(3.0)) / (175.0 / 12.0)
ENDED = 100.0
"""Product of c and the time (s) after which nothing is left of a wobble."""
SPEED = 1.5    # m/s, speed of the ball that is struck again
ONSET = 250
"""Tick at which that ball begins to roll; there are 1000 each second."""
RESTRUCK = 2.0 * SPEED / (7.0 * G * (1e-3 * ONSET))
"""Coefficient mu with which it does."""
DRAWN = (1.0 - 0.4 * A * 140.0) / 1.4
"""Final speed (m/s), rolling, of a ball that starts at 1 m/s with 140 rad/s of back spin."""
OPPOSITE = tuple((0.1 * sign, 1e100 * sign, 5e-324 * sign) for sign in (1.0, -1.0))
"""Opposite angular impulses, N m s, in body axes."""


def _same_bits(*vectors):
    first = vectors[0].tobytes()
    return Outcome(float(sum(vector.tobytes() != first for vector in vectors[1:])), 0.0,
                   'runs that differ', 'the same bits')


def million_ticks():
    """Compare one jump of 1e6 s, a million ticks of 1 s, and times out of order."""
    # the body turns slowly, since only its 4000 flips cost time
    scene = load_scene('tennis_racket', ['initial.angular_velocity=[0.0001, 0.05, 0.0001]'])
    ticking, jumping, shuffled = (Simulation(scene, rate=1.0) for _ in range(3))
    last = ticking.advance_through(1_000_000)[-1].vector
    jumping.advance(1_000_000)
    return _same_bits(
        last, ticking.vector, jumping.vector, shuffled.states([3.0, 1e6, 2.0]).vector[1])


def composed_jumps():
    """Make a thousand jumps of random lengths there and back, each from a new anchor."""
    simulation, random = Simulation(load_scene('free_body')), np.random.default_rng(10)
    motion, start = simulation.choice.solver, simulation.vector.copy()
    times = np.append(
        np.cumsum(random.choice([-1.0, 1.0], 1000) * 10.0 ** random.uniform(-9.0, 1.0, 1000)), 0.0)
    state, out = start.copy(), np.empty(14)
    wrench = simulation.wrench
    for time in times:
        motion(state, wrench).state(time, out)
        state = out.copy()
    # An error of omega at an anchor turns the body for the time from there to the end at 0. The
    # factor 3 multiplies a walk of 1 ulp each (24 such walks with two versions of NumPy and numba
    # reached 0.04 to 1.5 of it).
    left = float(np.linalg.norm(start[5:8])) * float(np.linalg.norm(times))
    bound = 3.0 * EPSILON * (4.0 * math.sqrt(len(times)) + left)
    return Outcome(angle_between(*state[1:5], *start[1:5]), bound, 'rad',
                   'a walk: each anchor rounds omega, which turns for what is left')


def random_bits():
    """Return a hash of states of a racket under random impulses and holds."""
    simulation, random = Simulation(load_scene('tennis_racket')), np.random.default_rng(3)
    digest = hashlib.sha256()
    for _ in range(20):
        simulation.impulse(tuple(random.normal(size=3)), tuple(random.normal(size=3)), 'body')
        simulation.advance(int(random.integers(1, 400)))
        digest.update(simulation.vector.tobytes())
        simulation.forget_past()
    return digest.hexdigest()


def two_processes():
    """Run one scene with commands in this process twice, and in another one."""
    here = random_bits()
    code = (
        'from rigid_body_sim.study.hard_cases.behaviour import random_bits; print(random_bits())')
    root = os.path.dirname(os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(
        __file__)))))
    there = subprocess.run([sys.executable, '-c', code], capture_output=True, text=True,
                           check=True, timeout=300, cwd=root).stdout.strip()
    return Outcome(float(here != random_bits()) + float(here != there), 0.0, 'runs that differ',
                   'the same bits')


def ball(mu=0.2, initial='{}', strike=''):
    """Return the Simulation of a billiard ball."""
    return Simulation(parse_scene(BALL.format(mu=mu, initial=initial, strike=strike)))


def two_fifths():
    """Strike a ball at 2a/5: it rolls at once, without slip or event, at a constant speed."""
    simulation = ball(strike=f'strike: {{impulse: [0.255, 0, 0], height: {2.0 * A / 5.0!r}}}, ')
    speeds = simulation.states(np.linspace(0.0, 10.0, 1001)).velocity[:, 0]
    return Outcome(float(np.ptp(speeds)) + len(simulation.events), 0.0, 'm/s',
                   'rolling at once, no chatter: the speed has one value')


def frictionless():
    """Let a ball slip with mu = 0, for ever."""
    states = ball(mu=0.0, initial='{velocity: [1.0, 0, 0], angular_velocity: [0, -50, 3]}').states(
        [0.1, 1e3, 1e6])
    return Outcome(float(np.abs(states.velocity[:, 0] - 1.0).max()), 0.0, 'm/s',
                   'nothing slows it: the speed to the last bit')


def restruck_at_onset():
    """Strike a ball again at the very tick at which rolling begins, twice in that tick."""
    simulation = ball(mu=RESTRUCK, initial=f'{{velocity: [{SPEED!r}, 0, 0]}}')
    simulation.advance(ONSET)
    simulation.impulse(force=(0.0, 0.17 * 0.25, 0.0))
    simulation.impulse(force=(0.0, 0.17 * 0.25, 0.0))
    simulation.advance(1000)
    expected = np.array([SPEED, 0.5]) * 5.0 / 7.0
    return Outcome(float(np.abs(simulation.vector[11:13] - expected).max()), 8.0 * EPSILON, 'm/s',
                   'some roundings of speeds of 1 m/s')


def draw_shot():
    """Play a ball with back spin: it comes back, then rolls with a slip of exactly zero."""
    simulation = ball(initial='{velocity: [1.0, 0, 0], angular_velocity: [0, -140.0, 0]}')
    simulation.advance(3000)
    v, q = simulation.state.velocity[0], simulation.state
    slip = (v - A * q.angular_velocity[1] if abs(q.orientation[0]) + abs(q.orientation[2]) == 0.0
            else math.inf)
    return Outcome(abs(v - DRAWN) + abs(slip), 8.0 * EPSILON, 'm/s', 'rounding of speed and slip')


def relaxing_scene(c, omega, inertia=questions.INERTIA):
    """Return the scene of a body that loses energy."""
    return parse_scene(RELAXING.format(c=c, omega=list(omega), inertia=list(inertia)))


def relaxing(c, omega, seconds, inertia=questions.INERTIA, accuracy=1e-12):
    """Return energies above L^2/(2 I_max) (relative) and States at 400 times."""
    simulation = Simulation(relaxing_scene(c, omega, inertia), accuracy=accuracy)
    states = simulation.states(np.linspace(0.0, seconds, 400))
    energy, square = simulation.diagnose(states)
    return (energy - square / (2.0 * max(inertia))) / energy[0], states


def never_rises(c, omega, seconds, **more):
    """Return the Outcome of the largest rise of the excess, and of its value at the end."""
    excess, _ = relaxing(c, omega, seconds, **more)
    return Outcome(
        max(float(np.diff(excess).max()), float(abs(excess[-1])) if c * seconds > ENDED else 0.0),
        20.0 * EPSILON, 'of the energy', 'rounding of energy and L^2; at the end nothing is left')


def stays_on_smallest():
    """Start exactly on the smallest axis, which is an exact solution, however unstable."""
    _, states = relaxing(1.0, ON_SMALLEST, 100.0)
    return Outcome(float(np.abs(states.angular_velocity - ON_SMALLEST).max()), 0.0, 'rad/s',
                   'nothing moves it')


def leaves_smallest():
    """Start 1e-300 off the smallest axis and time the growth of the offset.

    It grows as a spiral at the mean of c L^2 (1/I1 - 1/I2) and c L^2 (1/I1 - 1/I3), 175/12 1/s.
    """
    _, states = relaxing(1.0, OFF_SMALLEST, 80.0)
    time = states.time[
        int(
            np.argmax(
                np.hypot(2.0 * states.angular_velocity[:, 1], 3.0 * states.angular_velocity[:, 2])
                > 1.0
            )
        )
    ]
    return Outcome(abs(float(time) - LEAVES), 0.3, 's',
                   f'it leaves after {LEAVES:.1f} s; seen every 0.2 s, the spiral is not round')


def impulses_cancel():
    """Apply opposite impulses in one tick, denormal ones too; 1e300 is refused in one line."""
    scene = load_scene('tennis_racket')
    one, quiet = Simulation(scene), Simulation(scene)
    for each in (one, quiet):
        each.advance(100)
    for impulse in OPPOSITE:
        one.impulse(torque=impulse, frame='body')
    refused = 0
    for size in (1e300, math.inf, math.nan):
        try:
            one.impulse(torque=(size, 0.0, 0.0))
        except BadInput:
            refused += 1
    for each in (one, quiet):
        each.advance(100)
    return Outcome(float(one.vector.tobytes() != quiet.vector.tobytes()) + 3 - refused, 0.0,
                   'runs that differ', 'the same bits')


def energy_is_no_proof():
    """Follow a body beside the separatrix by RK4 with steps of 1 ms.

    The energy holds to 1e-14 and better while the attitude is wrong by more than 1e-6 rad.
    """
    text = ('scene: beside\nbody: {{mass: 1.0, inertia: [3.0, 4.0, 6.0]}}\n'
            'constraint: {0}\neffects: {1}\n'
            'initial: {{angular_velocity: [2.0, 0.7, 1.0000000000000002]}}\n')
    # held at its centre of mass the body turns like a free one, by the kernels of tops
    exact = Simulation(parse_scene(text.format('free', '[]')))
    stepped = Simulation(
        parse_scene(text.format('pivot', '[gravity: {g: 9.81}]')), 'rk4', step=1e-3)
    for each in (exact, stepped):
        each.advance(60_000)
    held, wrong = (abs(stepped.energy / exact.energy - 1.0),
                   angle_between(*exact.vector[1:5], *stepped.vector[1:5]))
    return Outcome(held / wrong, 1e-6, 'energy error/attitude error',
                   f'energy held to {held:.0e}, attitude wrong by {wrong:.0e} rad')


def cases():
    """Yield the cases.

    More than forty lines: a table, one entry a case.
    """
    yield Case(
        4, 'a jump of 1e6 s, a million ticks, any order',
        'sums of time steps round; states that depend on earlier steps do not repeat',
        million_ticks)
    yield Case(
        1, 'energy is no proof',
        'a stepper keeps the energy to round-off beside the separatrix, and is still wrong',
        energy_is_no_proof)
    yield Case(7, 'struck at 2a/5',
               'no slip at all: rounding makes a slip on which sign functions chatter', two_fifths,
               question(Shot(0.2, (SPEED, 0.0), (0.0, SPEED / A, 0.0), 10.0, (SPEED, 0.0))))
    yield Case(7, 'no friction', 'the time to rolling is infinite', frictionless,
               question(Shot(0.0, (1.0, 0.0), (0.0, -50.0, 3.0), 10.0, (1.0, 0.0))))
    yield Case(7, 'restruck twice at the very tick of rolling onset',
               'two events in one tick, at the end of a phase', restruck_at_onset,
               question(Shot(RESTRUCK, (SPEED, 0.0), (0.0, 0.0, 0.0), 1.25,
                             (SPEED * 5.0 / 7.0, 0.5 * 5.0 / 7.0), (1e-3 * ONSET, (0.0, 0.5)))))
    yield Case(7, 'draw shot', 'the speed passes through zero while friction does not', draw_shot,
               question(Shot(0.2, (1.0, 0.0), (0.0, -140.0, 0.0), 3.0, (DRAWN, 0.0))))
    for name, why, c, seconds in (
            ('through the separatrix',
             'from the smallest to the largest axis, past the orbit of infinite period', 0.05,
             200.0),
            *((f'stiff: c dt = {c * 1e-3:g}',
               'the wobble dies out within a fraction of a tick; '
               'explicit steps would stay short for ever',
               c, 1.0)
              for c in (1e3, 1e6, 1e9))):
        yield Case(
            8, name, why, functools.partial(never_rises, c, WOBBLING, seconds),
            questions.never_rises(relaxing_scene(c, WOBBLING), seconds, c * seconds > ENDED))
    for inertia, accuracy in (
        ((1.0, 1.0, 2.0), 1e-12),
        ((1.0, 2.0, 2.0), 1e-12),
        ((1.0, 2.0, 3.0), 1e-6),
    ):
        yield Case(
            8,
            f'stiff: c dt = 1e+06, I = ({", ".join(f"{moment:g}" for moment in inertia)}), '
            f'asked for {accuracy:g} rad',
            'steps chatter on a rate that ends abruptly; with loose steps a wobble never ends, '
            'and the steps stay at 1/rate',
            functools.partial(never_rises, 1e9, WOBBLING, 1.0, inertia=inertia, accuracy=accuracy))
    yield Case(8, 'exactly on the smallest axis', 'unstable, yet it must stay', stays_on_smallest,
               questions.stays(relaxing_scene(1.0, ON_SMALLEST), 100.0))
    yield Case(8, '1e-300 off the smallest axis',
               'absolute tolerances keep it there for ever, or noise throws it off early',
               leaves_smallest, questions.leaves(relaxing_scene(1.0, OFF_SMALLEST), 80.0, LEAVES))
    yield Case(9, 'opposite impulses, denormal and 1e100; 1e300 refused',
               'one overflow makes every number NaN', impulses_cancel, questions.cancel(OPPOSITE))
    yield Case(10, 'a thousand jumps there and back', 'every jump begins at a rounded state',
               composed_jumps)
    yield Case(10, 'the same bits in two processes',
               'caches, hashes, threads and fast mathematics differ', two_processes)
