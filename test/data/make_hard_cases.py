# SPDX-License-Identifier: Apache-2.0
"""Make rigid_body_sim/study/hard_cases/references.json from free_body and lagrange_top.json.

It takes the hard cases among them, with the reason. Rackets get a state at 100 s besides, where
peers can be asked too.
"""

import json
import pathlib

import mpmath as mp
from high_precision_body import closed_form

DATA = pathlib.Path(__file__).resolve().parent
TO = DATA.parents[1] / 'rigid_body_sim' / 'study' / 'hard_cases' / 'references.json'
DIGITS = 36
NEVER_BACK = 'on the separatrix the period is infinite: with one lost bit it comes back'
GROWS = ('the offset grows e-fold every 0.35 s: rounding that removes or creates it decides when '
         'the body flips')

FREE = {
    **{f'racket, {off} off the middle axis': (1, GROWS)
       for off in ('0.01', '0.0001', '1e-08', '1e-16', '1e-40', '1e-300')},
    'racket, exactly on the middle axis': (
        1, 'unstable, yet an exact solution: it must never flip'),
    **{f'exactly on the separatrix, c = {c}': (1, NEVER_BACK) for c in ('0.0', '0.7', '-5.0')},
    **{f'{ulp} ulp of omega {axis} beside the separatrix': (
           1, 'one bit decides on which side it turns over, and when')
       for ulp in ('+1', '-1') for axis in (1, 3)},
    **{f'near the separatrix in a generic direction, {gap}': (
           1, 'L^2 - 2 E I2 cancels to the gap squared')
       for gap in ('1e-05', '-1e-05', '1e-13', '-1e-13')},
    'symmetric to 1e-15': (2, 'I1 - I2 has one digit; formulas for three moments divide by it'),
    'symmetric to 1e-15, about the equator': (
        2, 'the same, at the edge between two kinds of motion'),
    'prolate': (2, 'I1 = I2 exactly: the amplitude of the elliptic functions vanishes'),
    'sphere': (2, 'all differences are zero'),
    'nearly a sphere': (2, 'differences of one to three ulp decide the axes'),
    'lamina': (
        2, 'I3 = I1 + I2, the limit for a body; many refuse an ulp beyond'),
    'rod': (2, "a zero moment: Euler's equations divide by it"),
    'needle along 3, tumbling': (
        2, '1 : 1 : 1e-12; errors of omega are divided by the small moment'),
    'needle along 3, spun': (2, '1 : 1 : 1e-12 at 1e6 rad/s'),
    'needle, not quite round': (2, 'I1 and I2 differ by less than I3'),
    '1e-30 kg m^2': (2, 'absolute tolerances in SI units are far too coarse'),
    '1e+30 kg m^2': (2, 'squares of squares overflow'),
    '1e6 rad/s': (3, '1000 rad a tick of 1 ms'),
    '1e-12 rad/s': (3, 'steps by absolute error never notice that it moves'),
    '1e6 and 1e-12 rad/s': (3, 'both on one body: eighteen digits between the components'),
    '1e6 rad/s along the middle, 1e-12 off it': (3, 'unstable with an e-folding time of 2.8 us')}
TOPS = {
    'sleeping': 'exactly upright: Euler angles are singular',
    'nearly_sleeping_1e-9': 'tilt and swing must not drown in the spin',
    'nearly_sleeping_1e-200': 'squares of the tilt underflow',
    'through_upright': 'passes beta = 0 exactly, again and again',
    'through_hanging': 'passes beta = pi exactly',
    'past_upright_at_1e-9': 'alpha turns by pi within a nanosecond',
    'at_threshold': 'P_gamma^2 = 4 I1 M g l exactly: neither stable nor not to first order',
    'ulp_below_threshold': 'falls, with an e-folding time of 6.7e7 s',
    'ulp_above_threshold': 'does not fall',
    'falling_1e-9': 'leaves upright by e-folds, from a tilt of 1e-9',
    'falling_kicked_1e-12': 'leaves exactly upright by a kick of 1e-12 rad/s',
    'hanging_top': 'swings about beta = pi',
    'heavy_top': 'cusps: let go with the axis at rest',
    'loops': 'nutation with loops',
    'unidirectional': 'nutation without loops',
    'spherical_pendulum': 'no spin, no third moment',
    'separatrix_in_a_plane': 'reaches the upright position after an infinite time',
    'fast_top_for_long': 'a nutation takes 1.9 ms',
    'fast_top': 'a nutation takes 19 us, 53 in a tick of 1 ms',
    'needle': '1 : 1 : 1e-12 on a pivot',
}


def main():
    """Collect the references and write them."""
    free = {record['name']: record for record in json.loads((DATA / 'free_body.json').read_text())}
    tops = json.loads((DATA / 'lagrange_top.json').read_text())
    found = []
    for name, (group, why) in FREE.items():
        record = free[name]
        if group == 1 and 100.0 not in [state['time'] for state in record['states']]:
            record['states'] = sorted(
                [*record['states'], _solved(record, 100.0)], key=lambda state: state['time'])
        flips = [{'count': flip['count'], 'time': flip['time']} for flip in record['flips']]
        found.append({
            'group': group, 'name': name, 'why': why, 'kind': 'free', 'moments': record['moments'],
            'flips': flips, **{key: record[key] for key in ('orientation', 'angular_velocity')},
            'states': _states(record['states'])})
    for name, why in TOPS.items():
        record = tops[name]
        found.append({
            'group': 6, 'name': f'top, {name.replace("_", " ")}', 'why': why, 'kind': 'pivot',
            'flips': [],
            **{key: record[key]
               for key in ('moments', 'mass', 'center', 'g', 'orientation', 'angular_velocity')},
            'states': _states([state for state in record['states'] if state['time'] > 0.0])})
    TO.write_text('[\n' + ',\n'.join(map(json.dumps, found)) + '\n]\n')


def _solved(record, time):
    with mp.workdps(100):
        q, omega = closed_form(
            record['moments'], record['orientation'], record['angular_velocity'], time)
        return {'time': time, 'orientation': [mp.nstr(x, DIGITS) for x in q],
                'angular_velocity': [mp.nstr(x, DIGITS) for x in omega]}


def _states(states):
    return [{key: state[key] for key in ('time', 'orientation', 'angular_velocity')}
            for state in states if state['time'] != 0.0]


if __name__ == '__main__':
    main()
