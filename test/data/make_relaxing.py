# SPDX-License-Identifier: Apache-2.0
"""Make relaxing.json: bodies under constant torques and linear drag, to 34 digits.

    PYTHONPATH=test/data python test/data/make_relaxing.py

Bodies of mass 2 kg with principal axes along their own. Damped and hinged bodies follow from
formulas in 400 digits; the same cases at short times, and all driven bodies, from Taylor series of
the equations of motion (relaxing_body.py).
"""

import json
import pathlib

from high_precision_body import closed_form
from mpmath import mp, mpf
from relaxing_body import flown, sphere_turned, turned

Q = [0.1, -0.3, 0.5, 0.8062257748298549]
MASS = 2.0
LONG = [0.001, 0.7, 20.0, -3.0, 1e4, 1e6]
SHORT = [0.001, 0.7, 12.0, -3.0]
CASES = {
    # kind, moments, omega, torque (body), couple (world), angular drag, times
    'free, asymmetric': ('damped', [0.5, 0.8, 1.1], [1.0, 2.0, -3.0], 0.0, LONG),
    'sphere, angular drag': ('damped', [0.5, 0.5, 0.5], [1.0, 2.0, -3.0], 0.1, LONG),
    'sphere, drag at 1e-300 /s': ('damped', [1.0, 1.0, 1.0], [1.0, 2.0, -3.0], 1e-300, LONG),
    'sphere, drag at 1e-9 /s': ('damped', [1.0, 1.0, 1.0], [1.0, 2.0, -3.0], 1e-9, LONG),
    'sphere, drag at 1e3 /s': (
        'damped',
        [1.0, 1.0, 1.0],
        [1.0, 2.0, -3.0],
        1e3,
        [1e-6, 1e-3, 0.7, 1e6, -0.3],
    ),
    'rod, angular drag': ('damped', [0.5, 0.5, 0.0], [1.0, 2.0, 0.0], 0.1, [0.7, 20.0, -3.0, 1e4]),
    'driven through zero': ('driven', [0.8, 0.8, 1.3], [0.4, -0.2, -1.1], [0.0, 0.0, 0.5], SHORT),
    'driven back': ('driven', [0.8, 0.8, 0.3], [0.4, -0.2, 1.1], [0.0, 0.0, -0.2], SHORT),
    'driven about x': ('driven', [0.3, 0.8, 0.8], [0.4, -0.2, 1.1], [-0.2, 0.0, 0.0], SHORT),
    'driven, never across': ('driven', [0.8, 0.8, 0.3], [0.0, 0.0, 1.1], [0.0, 0.0, -0.2], SHORT),
    'driven at 1e-300': ('driven', [0.8, 0.8, 0.3], [0.4, -0.2, 1.1], [0.0, 0.0, 1e-300], SHORT),
    'sphere, torque in the body': (
        'driven',
        [0.8] * 3,
        [0.4, -0.2, -1.1],
        [-0.5, 0.1, 0.4],
        SHORT,
    ),
    'sphere, torque in the world': (
        'world',
        [0.8] * 3,
        [0.4, -0.2, -1.1],
        [-0.5, 0.1, 0.4],
        SHORT,
    ),
    'hinge, drag': ('hinge', [0.5, 0.8, 1.1], -2.0, (0.0, 0.05), LONG),
    'hinge, torque': ('hinge', [0.5, 0.8, 1.1], -2.0, (0.3, 0.0), LONG),
    'hinge, both, through zero': ('hinge', [0.5, 0.8, 1.1], -2.0, (0.3, 0.05), LONG),
    'hinge, drag at 1e-300 /s': ('hinge', [0.5, 0.8, 1.0], -2.0, (0.3, 1e-300), LONG),
    'hinge, drag at 1e3 /s': (
        'hinge',
        [0.5, 0.8, 1.0],
        -2.0,
        (0.3, 1e3),
        [1e-6, 1e-3, 0.7, 1e6, -0.3],
    ),
}
FLIGHTS = {'drag': 0.1, 'drag at 1e-300 /s': 2e-300, 'drag at 1e3 /s': 2e3, 'no drag': 0.0}


def relaxed(rate, slope, t):
    """Return integral and value of y' = slope - rate' y, rate = (y0, rate')."""
    (y,), (v,) = flown([0], [rate[0]], [slope], rate[1], t)
    return y, v


def state_of(kind, moments, omega, given, t):
    """Return (q, omega) at a time."""
    if kind == 'driven':
        return turned(Q, omega, t, moments, torque=given)
    if kind == 'world':
        return sphere_turned(Q, omega, t, moments[0], given)
    if kind == 'hinge':
        torque, drag = map(mpf, given)
        angle, rate = relaxed((omega, drag / mpf(moments[2])), torque / mpf(moments[2]), t)
        s, c = mp.sin(angle / 2), mp.cos(angle / 2)
        norm = mp.sqrt(mp.fsum(mpf(x) ** 2 for x in Q))
        x, y, z, w = (mpf(x) / norm for x in Q)
        return [x * c + y * s, y * c - x * s, z * c + w * s, w * c - z * s], [mpf(0), mpf(0), rate]
    r = mpf(given) / mpf(moments[0])
    (s,), _ = flown([0], [1], [0], r, t)
    q, rates = closed_form([m or mpf('1e-120') for m in moments], Q, omega, s)
    norm = mp.sqrt(mp.fsum(x * x for x in q))
    return [x / norm for x in q], [mp.exp(-r * mpf(t)) * w for w in rates]


def alike(a, b):
    """Assert that two states agree, their quaternions up to sign."""
    sign = 1 if mp.fdot(a[0], b[0]) > 0 else -1
    size = max(mp.norm(a[1]), mpf(1e-30))
    assert max(abs(x - sign * y) for x, y in zip(a[0], b[0], strict=True)) < 1e-33
    assert max(abs(x - y) for x, y in zip(a[1], b[1], strict=True)) < 1e-33 * size


def main():
    """Write the file."""
    mp.dps = 50
    found = {'mass': MASS, 'orientation': Q, 'cases': {}, 'flights': {}}
    for name, (kind, moments, omega, given, times) in CASES.items():
        states = []
        for t in times:
            q, rates = state_of(kind, moments, omega, given, t)
            if kind == 'damped' and t in (0.001, 0.7) and given < 1.0:
                alike((q, rates), turned(Q, omega, t, moments, drag=[given] * 3))
            if kind == 'hinge' and t == 0.7 and given[1] < 1.0:
                torque, drag = given
                alike((q, rates), turned(Q, [0, 0, omega], t, [1, 1, moments[2]],
                                         torque=[0, 0, torque], drag=[0, 0, drag]))
            states.append({'time': t, 'state': [mp.nstr(x, 34) for x in (*q, *rates)]})
        found['cases'][name] = {'kind': kind, 'moments': moments, 'omega': omega, 'given': given,
                                'states': states}
        print(name, flush=True)
    for name, c in FLIGHTS.items():
        times = [1e-6, 1e-3, 0.7, 20.0, -0.3, 1e6]
        states = []
        for t in times:
            place, speed = flown([1.0, 2.0, 3.0], [3.0, -4.0, 5.0], [0, 0, -mpf(9.81)],
                                 mpf(c) / mpf(MASS), t)
            states.append({'time': t, 'state': [mp.nstr(x, 34) for x in (*place, *speed)]})
        found['flights'][name] = {'linear': c, 'states': states}
    path = pathlib.Path(__file__).with_name('relaxing.json')
    path.write_text(json.dumps(found, indent=1) + '\n', encoding='utf-8')


if __name__ == '__main__':
    main()
