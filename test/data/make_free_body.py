# SPDX-License-Identifier: Apache-2.0
"""Make free_body.json: free rigid bodies of every kind, to 36 digits.

It can run from any folder and takes about five minutes.

Inputs are exact doubles. Each case is checked against a power-series integration over its first
radians before it is written. It has the largest effect of one ulp on a single moment or component
of omega (`one_ulp`, rad; `one_ulp_omega`, relative to |omega|).
"""

import itertools
import json
import pathlib

import mpmath as mp
import numpy as np
from high_precision_body import angle, closed_form, flip_time, rotation_matrix, taylor

DIGITS = 36
TURNED = (0.1, 0.2, -0.3, 0.9273618495495704)       # as good as normalised
TIMES = (0.0, 0.1, 10.0, 1e3, 1e4)
C = 0.7


def case(name, moments, omega, times=TIMES, digits=60, flips=(), **more):
    """Return a case; `more` may hold axes, center_of_mass, g, position, velocity."""
    return {'name': name, 'moments': list(moments), 'angular_velocity': list(omega),
            'orientation': list(TURNED), 'times': list(times), 'digits': digits,
            'flips': list(flips), **more}


def nudged(x, ulps):
    """Return a double some ulps away."""
    for _ in range(abs(ulps)):
        x = float(np.nextafter(x, np.inf if ulps > 0 else -np.inf))
    return x


def cases():
    """Yield all cases."""
    for order in itertools.permutations((2.0, 3.0, 4.0)):
        name = 'asymmetric ' + ' '.join(f'{moment:g}' for moment in order)
        yield case(name, order, (0.7, -0.4, 1.1), flips=(1, 2, 1000))
    yield case('asymmetric, long axis polar', (2.0, 3.0, 4.0), (-1.5, 0.2, 0.1))
    yield case('asymmetric, short axis polar, tiny wobble', (2.0, 3.0, 4.0), (1e-9, -1e-12, -1.5))
    yield case('asymmetric, no component along 1', (2.0, 3.0, 4.0), (0.0, 0.6, -0.8))
    yield case('asymmetric, no component along 2', (2.0, 3.0, 4.0), (0.6, 0.0, 0.8))
    yield case('asymmetric, no component along 3', (2.0, 3.0, 4.0), (0.6, -0.8, 0.0))
    for k in range(3):
        omega = [0.0, 0.0, 0.0]
        omega[k] = -1.25
        yield case(f'asymmetric, about axis {k + 1}', (2.0, 3.0, 4.0), omega)
    yield case('at rest', (2.0, 3.0, 4.0), (0.0, 0.0, 0.0))
    yield case('prolate', (3.0, 3.0, 1.0), (0.7, -0.4, 1.1))
    yield case('oblate', (1.0, 1.5, 1.0), (0.7, -0.4, 1.1))
    yield case('prolate, nearly about the equator', (1.0, 3.0, 3.0), (1e-14, -0.4, 1.1))
    yield case('symmetric, about the equator', (3.0, 3.0, 1.0), (0.7, -0.4, 0.0))
    yield case('symmetric to 1e-15', (3.0, nudged(3.0, 2), 1.0), (0.7, -0.4, 1.1))
    yield case('symmetric to 1e-15, oblate', (1.0, 1.5, nudged(1.0, 4)), (0.7, -0.4, 1.1))
    yield case(
        'symmetric to 1e-15, about the equator', (3.0, nudged(3.0, 2), 1.0), (0.7, -0.4, 1e-9))
    yield case('nearly a sphere', (1.0, nudged(1.0, 1), nudged(1.0, 3)), (0.7, -0.4, 1.1))
    yield case('sphere', (0.4, 0.4, 0.4), (0.7, -0.4, 1.1))
    yield case('lamina', (1.0, 2.0, 3.0), (0.7, -0.4, 1.1))
    yield case('lamina across', (3.0, 0.001, 3.001), (0.7, -0.4, 1.1))
    yield case('rod', (1.0, 1.0, 0.0), (0.7, -0.4, 0.0))
    yield case('rod along 1', (0.0, 1.0, 1.0), (0.0, -0.4, 1.1))
    for k in range(3):
        moments, name = [1.0, 1.0, 1.0], f'needle along {k + 1}'
        moments[k] = 1e-12
        yield case(f'{name}, tumbling', moments, (0.7, -0.4, 1.1))
        spin = [0.7, -0.4, 1.1]
        spin[k] = 1e6
        yield case(f'{name}, spun', moments, spin, (0.1, 10.0, 1e3))
    yield case(
        'needle, not quite round', (1.0, 1.0 + 2e-13, 1e-12), (0.7, -0.4, 1.1), flips=(1, 10))
    yield case('needle, not quite round, near its middle axis', (1.0, 1.0 + 2e-13, 1e-12),
               (1e-7, 1.1, 1e-8))
    yield case('needle, flat', (1.0, 1.0 + 9e-13, 1e-12), (0.9, 0.5, 1.1))
    yield case('1e-30 kg m^2', (2e-30, 3e-30, 4e-30), (0.7, -0.4, 1.1))
    yield case('1e+30 kg m^2', (2e30, 3e30, 4e30), (0.7, -0.4, 1.1))
    yield case('1e-12 rad/s', (2.0, 3.0, 4.0), (7e-13, -4e-13, 1.1e-12), (1e3, 1e12))
    yield case('1e6 rad/s', (2.0, 3.0, 4.0), (7e5, -4e5, 1.1e6), (1e-3, 0.1, 10.0, 1e4))
    yield case(
        '1e6 and 1e-12 rad/s', (2.0, 3.0, 4.0), (1e-12, 1e-12, 1.1e6), (1e-3, 0.1, 10.0, 1e4))
    yield case('1e6 rad/s along the middle, 1e-12 off it', (2.0, 3.0, 4.0), (1e-12, 1.1e6, 1e-12),
               (1e-5, 1e-3, 1.0), 80, (1, 2))
    yield case('1e-200 rad/s', (2.0, 3.0, 4.0), (7e-201, -4e-201, 1.1e-200), (1e3, 1e200))
    for off in (1e-2, 1e-4, 1e-8, 1e-16, 1e-40):
        yield case(f'racket, {off:g} off the middle axis', (1.0, 2.0, 3.0), (off, 5.0, off),
                   (0.1, 10.0, 100.0, 1e3, 1e4), 60 + int(-2.2 * np.log10(off)), (1, 2, 100))
    yield case('racket, 1e-300 off the middle axis', (1.0, 2.0, 3.0), (1e-300, 5.0, 1e-300),
               (100.0, 1e3), 720, (1,))
    yield case('racket, exactly on the middle axis', (1.0, 2.0, 3.0), (0.0, 5.0, 0.0))
    yield case(
        'racket, off towards the largest', (1.0, 2.0, 3.0), (0.0, 5.0, 1e-3), flips=(1, 100))
    yield case(
        'racket, off towards the smallest', (1.0, 2.0, 3.0), (1e-3, 5.0, 0.0), flips=(1, 100))
    for c in (0.0, C, -5.0):
        yield case(f'exactly on the separatrix, c = {c}', (3.0, 4.0, 6.0), (2.0, c, 1.0),
                   flips=(1,) if c < 0.0 else ())
    yield case('exactly on the separatrix, other orders', (4.0, 6.0, 3.0), (C, -1.0, 2.0))
    for k, name in ((0, '1'), (2, '3')):
        for ulps in (1, -1):
            omega = [2.0, C, 1.0]
            omega[k] = nudged(omega[k], ulps)
            yield case(f'{ulps:+d} ulp of omega {name} beside the separatrix', (3.0, 4.0, 6.0),
                       omega, digits=90, flips=(1, 2))
    for gap in (1e-2, 1e-5, 1e-9, 1e-13):
        for sign in (1, -1):
            yield case(
                f'near the separatrix in a generic direction, {sign * gap:g}', (2.0, 3.1, 4.3),
                (0.7 * float(np.sqrt(4.3 * 1.2 / (2.0 * 1.1))) * (1.0 + sign * gap), C, -0.7),
                digits=90, flips=(1, 2))
    for kc in (0.1699, 0.1701):
        yield case(f'where the series change their form, complementary modulus {kc}',
                   (2.0, 3.0, 4.0), (0.8 * float(np.sqrt(2.0 * (1.0 - kc * kc))), 0.0, 0.8),
                   tuple(float(t) for t in range(1, 16)))
    axes = (0.18257418583505536, 0.3651483716701107, 0.5477225575051661, 0.7302967433402214)
    yield case('principal axes turned', (2.0, 3.0, 4.0), (0.7, -0.4, 1.1), axes=list(axes))
    yield case('thrown, centre of mass off the origin', (2.0, 3.0, 4.0), (0.7, -0.4, 1.1),
               (0.0, 0.1, 10.0, 1e3), center_of_mass=[0.3, -0.1, 0.2], g=9.81,
               position=[1.0, 2.0, 3.0], velocity=[4.0, -5.0, 6.0])


def in_body(axes, omega):
    """Return the components along the principal axes."""
    return list(rotation_matrix([mp.mpf(x) for x in axes]).T
                * mp.matrix([mp.mpf(w) for w in omega]))


def solved(entry, moments, omega, time, solve=closed_form):
    """Return (quaternion, omega in body axes) of the case with the moments and omega given."""
    axes = entry.get('axes')
    if axes is None:
        return solve(moments, entry['orientation'], omega, time)
    principal = rotation_matrix([mp.mpf(x) for x in axes])
    q, w = solve(
        moments, compose([mp.mpf(x) for x in entry['orientation']], [mp.mpf(x) for x in axes]),
        in_body(axes, omega), time)
    return (compose(q, [-mp.mpf(axes[0]), -mp.mpf(axes[1]), -mp.mpf(axes[2]), mp.mpf(axes[3])]),
            list(principal * mp.matrix(w)))


def compose(p, q):
    """Return the quaternion product p q, normalised."""
    r = [p[3] * q[0] + p[0] * q[3] + p[1] * q[2] - p[2] * q[1],
         p[3] * q[1] - p[0] * q[2] + p[1] * q[3] + p[2] * q[0],
         p[3] * q[2] + p[0] * q[1] - p[1] * q[0] + p[2] * q[3],
         p[3] * q[3] - p[0] * q[0] - p[1] * q[1] - p[2] * q[2]]
    size = mp.sqrt(sum(x * x for x in r))
    return [x / size for x in r]


def neighbours(entry):
    """Yield (moments, omega) with one number an ulp larger; moments of a rod stay equal."""
    for which, k in itertools.product((0, 1), range(3)):
        inputs = list(entry['moments']), list(entry['angular_velocity'])
        row = inputs[which]
        if row[k] != 0.0 and (which == 1 or 0.0 not in row):
            row[k] = float(np.nextafter(row[k], np.inf))
            yield inputs


def flight(entry, q, omega, time):
    """Return position and velocity of the body's origin."""
    c, w0 = [mp.matrix([mp.mpf(x) for x in entry[key]])
             for key in ('center_of_mass', 'angular_velocity')]
    r0, v0 = [mp.matrix([mp.mpf(x) for x in entry[key]]) for key in ('position', 'velocity')]
    first, later = rotation_matrix([mp.mpf(x) for x in entry['orientation']]), rotation_matrix(q)
    t, fall = mp.mpf(time), mp.matrix([0, 0, mp.mpf(entry['g'])])
    v = v0 + first * cross(w0, c)
    return (list(r0 + first * c + v * t - fall * t * t / 2 - later * c),
            list(v - fall * t - later * cross(mp.matrix(omega), c)))


def cross(a, b):
    """Return the vector product."""
    return mp.matrix([
        a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def text(numbers):
    """Return numbers as decimal strings."""
    return [mp.nstr(x, DIGITS, strip_zeros=True) for x in numbers]


def complete(entry):
    """Return the case with its states and flips."""
    mp.mp.dps = entry.pop('digits')
    moments, omega = entry['moments'], entry['angular_velocity']
    size = mp.norm(mp.matrix(omega))
    if size > 1e-100:
        early = 3.0 / size
        q, w = solved(entry, moments, omega, early)
        p, v = solved(
            entry, moments, omega, early, lambda *arguments: taylor(*arguments, order=60))
        assert angle(p, q) < 1e-40 and max(abs(a - b) for a, b in zip(v, w)) < 1e-40 * size, (
            entry['name'], angle(p, q))
    entry['states'] = []
    for time in entry.pop('times'):
        q, w = solved(entry, moments, omega, time)
        beside = [solved(entry, *inputs, time) for inputs in neighbours(entry)]
        state = {'time': time, 'orientation': text(q), 'angular_velocity': text(w),
                 'one_ulp': float(max(angle(q, other) for other, _ in beside)),
                 'one_ulp_omega': float(max(mp.norm(mp.matrix(w) - mp.matrix(other))
                                            for _, other in beside) / (size or 1))}
        if 'center_of_mass' in entry:
            state['position'], state['velocity'] = (text(x) for x in flight(entry, q, w, time))
        entry['states'].append(state)
    found = []
    for count in entry.pop('flips'):
        time = flip_time(moments, omega, count)
        one_ulp = max(abs(time - flip_time(*inputs, count)) for inputs in neighbours(entry)) / time
        found.append({
            'count': count, 'time': mp.nstr(time, DIGITS), 'one_ulp': float(min(1, one_ulp))})
    entry['flips'] = found
    return entry


if __name__ == '__main__':
    finished = []
    for entry in cases():
        finished.append(complete(entry))
        print(entry['name'],
              f'one ulp at the end: {finished[-1]["states"][-1]["one_ulp"]:.1e} rad', flush=True)
    path = pathlib.Path(__file__).with_name('free_body.json')
    path.write_text('[\n' + ',\n'.join(json.dumps(entry) for entry in finished) + '\n]\n')
