# SPDX-License-Identifier: Apache-2.0
"""Make lagrange_top.json: states of heavy tops to 34 digits, and their conditioning.

    python test/data/make_lagrange_top.py [CASE ...]        (all: about an hour on two cores)

The states are Taylor series of the full equations (heavy_body.py). A case's inputs are exact
doubles: those of `Body` and of the state vector. `sensitivity` is the largest change (attitude:
angle, rad; angular velocity: rad/s) under four random choices (one if a thousand bits are carried)
of plus or minus one ulp on every input that is not zero.
"""

import json
import math
import multiprocessing
import pathlib
import random
import sys

import numpy as np
from heavy_body import Flow, Nutation
from mpmath import mp, mpf

FILE = pathlib.Path(__file__).with_name('lagrange_top.json')
PERTURBATIONS = 4


def tilted(beta, twist=0.0):
    """Return the orientation with the axis at beta, turned about itself."""
    half, turn = 0.5 * beta, 0.5 * twist
    s, c = math.sin(half), math.cos(half)
    return [s * math.sin(turn), s * math.cos(turn), c * math.sin(turn), c * math.cos(turn)]


def unit(*q):
    """Return q / |q| in doubles."""
    norm = math.sqrt(math.fsum(x * x for x in q))
    return [x / norm for x in q]


def steady(beta, k, n):
    """Return omega in body axes of the slow steady precession.

    Its rate a solves k - n a + a^2 cos(beta) = 0.
    """
    c = math.cos(beta)
    a = 2.0 * k / (n + math.sqrt(n * n - 4.0 * k * c))
    return [-a * math.sin(beta), 0.0, 0.0]


HEAVY = {'moments': [0.03, 0.03, 0.01], 'mass': 1.0, 'center': [0.0, 0.0, 0.1], 'g': 9.81}
# k = 1, n = omega_3
ROUND = {'moments': [1.0, 1.0, 1.0], 'mass': 1.0, 'center': [0.0, 0.0, 0.5], 'g': 2.0}
ROD = {'moments': [1.0, 1.0, 0.0], 'mass': 3.0, 'center': [0.0, 0.0, 0.5], 'g': 9.81}
UPRIGHT, HANGING = [0.0, 0.0, 0.0, 1.0], [1.0, 0.0, 0.0, 0.0]
HEAVY_K = 0.981 / 0.03
CONE = steady(0.6, HEAVY_K, 20.0)


def case(body, orientation, omega, *times, bits=180, step=None):
    """Return a case with times in s.

    With `step` (s, below a quarter period) the times after the third use one period of nutation.
    """
    return {**body, 'orientation': orientation, 'angular_velocity': omega, 'times': list(times),
            'bits': bits, 'step': step}


LATER = 1000.125, 1e6, -777777.7
CASES = {
    'heavy_top': case(HEAVY, tilted(0.5), [0.0, 0.0, 60.0], 0.01, 1.0, 20.0, *LATER, step=0.03),
    'heavy_top_backwards': case(HEAVY, tilted(0.5), [0.3, -0.2, 60.0], -0.01, -5.0),
    'loops': case(HEAVY, tilted(1.0, 0.7), [2.5, 1.5, 55.0], 0.1, 1.0, 5.0, *LATER, step=0.02),
    'unidirectional': case(HEAVY, tilted(1.0, -0.7), [-2.0, -1.0, -55.0], 0.1, 5.0),
    'hanging_top': case({**HEAVY, 'center': [0.0, 0.0, -0.1]}, tilted(0.8), [1.0, 3.0, 20.0], 0.1,
                        1.0, 5.0, *LATER, step=0.03),
    'axis_x_hanging': case({**HEAVY, 'moments': [0.01, 0.03, 0.03], 'center': [-0.1, 0.0, 0.0]},
                           unit(0.3, 0.5, -0.2, 0.7), [30.0, 2.0, -1.0], 0.1, 5.0),
    'axis_y': case({**HEAVY, 'moments': [0.03, 0.035, 0.03], 'center': [0.0, 0.1, 0.0]},
                   unit(0.3, 0.5, -0.2, 0.7), [1.0, 20.0, -3.0], 0.1, 5.0),
    'ball_on_a_string': case(
        {'moments': [0.4, 0.4, 0.4], 'mass': 1.0, 'center': [0.1, -0.2, 0.3], 'g': 9.81},
        unit(0.1, 0.2, 0.3, 0.9), [3.0, 1.0, -5.0], 0.1, 10.0),
    'lamina': case(
        {'moments': [0.1, 0.1, 0.19], 'mass': 1.0, 'center': [0.0, 0.0, 0.05], 'g': 9.81},
        tilted(0.3), [0.1, 0.0, 15.0], 0.1, 1.0, 10.0, *LATER, step=0.02),
    'through_upright': case(HEAVY, UPRIGHT, [3.0, 1.0, 20.0], 0.1, 1.0, 5.0, *LATER, step=0.03),
    'through_hanging': case(HEAVY, HANGING, [3.0, 1.0, 20.0], 0.1, 1.0, 5.0, *LATER, step=0.03),
    'past_upright_at_1e-9': case(HEAVY, unit(0.0, 1e-9, 0.0, 1.0), [3.0, 0.0, 10.0], 0.1, 5.0),
    'past_hanging_at_1e-9': case(HEAVY, unit(1.0, 0.0, 1e-9, 0.0), [3.0, 1.0, 10.0], 0.1, 5.0),
    'sleeping': case(HEAVY, UPRIGHT, [0.0, 0.0, 60.0], 0.1, 5.0),
    'nearly_sleeping_1e-9': case(HEAVY, unit(0.0, 1e-9, 0.0, 1.0), [0.0, 0.0, 60.0], 0.1, 5.0),
    'nearly_sleeping_1e-200': case(
        HEAVY, [0.0, 1e-200, 0.0, 1.0], [0.0, 0.0, 60.0], 1.0, bits=900),
    'at_threshold': case(
        ROUND, unit(0.0, 0.25, 0.0, 1.0), [0.0, 0.0, 2.0], 1.0, 10.0, 30.0, *LATER, step=0.3),
    'at_threshold_1e-3': case(ROUND, unit(1e-3, 0.0, 0.0, 1.0), [0.0, 0.0, 2.0], 1.0, 30.0),
    'at_threshold_kicked': case(ROUND, UPRIGHT, [1e-5, 0.0, 2.0], 1.0, 30.0),
    'ulp_below_threshold': case(
        ROUND, unit(1e-7, 0.0, 0.0, 1.0), [0.0, 0.0, 2.0 - 2.0 ** -52], 1.0, 30.0),
    'ulp_above_threshold': case(
        ROUND, unit(1e-7, 0.0, 0.0, 1.0), [0.0, 0.0, 2.0 + 2.0 ** -51], 1.0, 30.0),
    'falling_1e-300': case(
        ROUND, [1e-300, 0.0, 0.0, 1.0], [0.0, 0.0, 1.0], 400.0, 798.0, bits=1160),
    'falling_1e-9': case(ROUND, unit(1e-9, 0.0, 0.0, 1.0), [0.0, 0.0, 1.0], 10.0, 25.0, 60.0),
    'falling_kicked_1e-12': case(HEAVY, UPRIGHT, [1e-12, 0.0, 20.0], 1.0, 8.0, 15.0),
    'falling_heavy_top': case(
        HEAVY, tilted(0.01), [0.0, 0.0, 30.0], 1.0, 3.0, 10.0, *LATER, step=0.03),
    'swinging_1e-9': case(HEAVY, unit(1.0, 0.0, 0.0, 1e-9), [0.0, 3e-9, 10.0], 0.1, 5.0),
    'swinging_1e-300': case(HEAVY, [1.0, 0.0, 0.0, 1e-300], [0.0, 3e-300, 10.0], 1.0, bits=1160),
    'spherical_pendulum': case(
        ROD, tilted(2.0), [2.0, 1.0, 0.0], 0.1, 1.0, 10.0, *LATER, step=0.05),
    'spherical_pendulum_nearly_flat': case(
        ROD, tilted(2.0), [1e-6, 4.0, 0.0], 0.1, 1.0, 10.0, *LATER, step=0.05),
    'rod_over_the_top': case(ROD, tilted(2.0), [0.0, 12.0, 0.0], 0.1, 10.0),
    'rod_swinging_in_a_plane': case(ROD, tilted(2.0), [0.0, 3.0, 0.0], 0.1, 10.0),
    'separatrix_in_a_plane': case(ROUND, HANGING, [2.0, 0.0, 0.0], 1.0, 10.0, 30.0),
    'nearly_separatrix': case(ROUND, unit(0.0, 0.75, 0.0, 1.0), [-0.72, 0.9600000001, 1.0], 1.0,
                              10.0, 30.0, *LATER, step=0.2),
    'nearly_separatrix_far': case(HEAVY, tilted(2.5), [0.0, 11.0, 0.0], 1.0, 5.0),
    'steady_precession': case(HEAVY, tilted(0.6), [CONE[0], 0.0, 60.0], 0.1, 5.0),
    'tiny_nutation': case(
        HEAVY, tilted(0.6), [CONE[0], 1e-9, 60.0], 0.1, 1.0, 5.0, *LATER, step=0.02),
    'fast_top': case(HEAVY, tilted(0.5), [0.0, 0.0, 1e6], 1e-5, 1e-3, 3e-3),
    'fast_top_kicked': case(HEAVY, tilted(1.5), [1e3, 0.0, 1e6], 1e-5, 1e-3),
    'just_hyperbolic': case(
        ROUND, tilted(1.545), [0.02, 0.0, 0.3], 0.9, 0.95, 2.75, 2.8, 4.6, 4.7, step=0.2),
    'just_circular': case(
        ROUND, tilted(1.56), [0.02, 0.0, 0.3], 0.9, 0.95, 2.75, 2.8, 4.6, 4.7, step=0.2),
    'light': case({**HEAVY, 'g': 1e-12}, tilted(0.5), [1.0, 2.0, 3.0], 1.0, 30.0),
    'weightless': case({**HEAVY, 'g': 0.0}, tilted(0.5), [1.0, 2.0, 3.0], 1.0, 30.0),
    'from_rest': case(HEAVY, tilted(1.2), [0.0, 0.0, 0.0], 0.1, 1.0, 5.0),
    'slow': case({**HEAVY, 'g': 1e-20}, tilted(1.2), [0.0, 1e-11, 1e-10], 1e9, 1e11),
    'needle': case(
        {**HEAVY, 'moments': [0.03, 0.03, 3e-14]}, tilted(1.2), [1.0, 2.0, 1e3], 0.1, 2.0),
    'fast_top_for_long': case(
        HEAVY, tilted(0.5), [0.0, 0.0, 1e4], 0.01, 0.02, 0.03, *LATER, step=2e-4)}


def ulps(x, sign):
    """Return x moved by one ulp; zero stays zero."""
    return x + sign * math.ulp(x) if x != 0.0 else x


def perturbed(given, seed):
    """Return the case with every input moved by one ulp, equal moments together."""
    source = random.Random(seed)
    sign = {moment: source.choice((-1, 1)) for moment in sorted(set(given['moments']))}

    def moved(values):
        return [ulps(x, source.choice((-1, 1))) for x in values]
    return {**given, 'moments': [ulps(x, sign[x]) for x in given['moments']],
            'center': moved(given['center']), 'orientation': moved(given['orientation']),
            'angular_velocity': moved(given['angular_velocity']),
            'mass': ulps(given['mass'], source.choice((-1, 1))),
            'g': ulps(given['g'], source.choice((-1, 1)))}


def states(given, bits):
    """Return [(q, omega)] at the case's times, and the first two turning points of the axis.

    The latter are for times by way of a period of nutation.
    """
    mp.prec = 2 * bits + 2200
    arm = [mpf(given['mass']) * mpf(given['g']) * mpf(c) for c in given['center']]

    def flow():
        return Flow(bits, given['moments'], arm).start(
            given['orientation'], given['angular_velocity'])
    direct = flow()
    found = [direct.go(time) for time in given['times'][:3]]
    if given['step'] is None:
        return found, []
    nutation = Nutation(flow, given['step'])
    return found + [nutation.go(time) for time in given['times'][3:]], nutation.turning_points


def distance(one, other):
    """Return the angle (rad) between two attitudes and the length of the difference of omegas."""
    q, p = one[0], other[0]
    signs = mp.sign(mp.fsum(a * b for a, b in zip(q, p)))
    return (float(2 * mp.sqrt(mp.fsum((a - signs * b) ** 2 for a, b in zip(q, p)))),
            float(mp.sqrt(mp.fsum((a - b) ** 2 for a, b in zip(one[1], other[1])))))


def make(name):
    """Return a case with its states and sensitivity."""
    given = CASES[name]
    bits = given['bits']
    found, turning_points = states(given, bits)
    moved = [states(perturbed(given, seed), max(130, bits - 50))[0]
             for seed in range(PERTURBATIONS if bits < 1000 else 1)]
    entry = {key: value for key, value in given.items() if key not in ('times', 'bits', 'step')}
    if turning_points:
        entry['turning_points'] = [mp.nstr(time, 40) for time in turning_points]
    entry['states'] = []
    for k, time in enumerate(given['times']):
        changes = np.array([distance(found[k], other[k]) for other in moved])
        entry['states'].append({
            'time': time, 'orientation': [mp.nstr(x, 40) for x in found[k][0]],
            'angular_velocity': [mp.nstr(x, 40) for x in found[k][1]],
            'sensitivity': [float(f'{x:.2e}') for x in changes.max(axis=0)]})
    return name, entry


if __name__ == '__main__':
    names = sys.argv[1:] or list(CASES)
    known = json.loads(FILE.read_text()) if FILE.exists() and sys.argv[1:] else {}
    with multiprocessing.Pool(2) as pool:
        for name, entry in pool.imap_unordered(make, names):
            known[name] = entry
            print(name, [state['sensitivity'] for state in entry['states']], flush=True)
            FILE.write_text(json.dumps(
                {key: known[key] for key in CASES if key in known}, indent=1) + '\n')
