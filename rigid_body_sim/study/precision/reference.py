# SPDX-License-Identifier: Apache-2.0
"""References: attitude and omega along a problem to 34 digits, and the floor that the inputs set.

The floor is the effect of half an ulp on every input number, the largest over some random choices
of signs, computed in the same arithmetic. In general no method in doubles can be better; a better
one was lucky. Where the inputs are simple fractions that doubles hold exactly, it still tells how
sensitive the problem is.
"""

import json
import pathlib
from dataclasses import dataclass

import numpy as np
from mpmath import mp, mpf

from rigid_body_sim.study.precision import inputs
from rigid_body_sim.study.precision.ball import Ball
from rigid_body_sim.study.precision.taylor import Turning

FOLDER = pathlib.Path(__file__).resolve().parent / 'references'
SAMPLES = 32
BITS, CHECK_BITS, FLOOR_BITS = 200, 152, 104
DIGITS = 34


@dataclass(frozen=True)
class Reference:
    """The true motion of a problem.

    Attributes
    ----------
    times : array (n,)
        Times, s; the last one is the duration.
    orientation, omega : lists of n tuples of mpf
        Unit quaternion from body to world; rad/s in body axes.
    floor, floor_omega : arrays (n,)
        Floors of the two, rad and rad/s.
    digits : float
        Number of decimal digits to which two computations of different precision and steps agree.
    """

    times: np.ndarray
    orientation: list
    omega: list
    floor: np.ndarray
    floor_omega: np.ndarray
    digits: float

    def errors(self, states):
        """Return the errors of states (n, 7), q and omega, at the times.

        They are rotation angles (rad) and lengths of the difference of omega (rad/s).
        """
        rows = [[mpf(x) for x in row] for row in states.tolist()]
        return self.distances([row[:4] for row in rows], [row[4:] for row in rows])

    def distances(self, orientation, omega):
        """Return the distances of attitudes and rates (lists of tuples of mpf) from these.

        They are rotation angles (rad) and lengths (rad/s).
        """
        return _distances(orientation, omega, self.orientation, self.omega)


def compute(scene, duration, draws=8, progress=lambda part: None):
    """Return the Reference of a scene.

    Parameters
    ----------
    scene : Scene
    duration : float
        Length of the motion, s.
    draws : int
        Number of random choices of signs for the floor.
    progress : callable
        Called with the share that is done, from 0 to 1.
    """
    times = [duration * (k + 1) / SAMPLES for k in range(SAMPLES)]
    count = draws + 2

    def run(number, bits, move):
        with mp.workprec(bits + 64):
            made = inputs.of(scene, move)
            motion = (Ball if made.kind == 'table' else Turning)(made, bits)
            found = []
            for k, time in enumerate(times):
                found.append(motion.go(time))
                progress((number + (k + 1) / SAMPLES) / count)
        return [q for q, _ in found], [w for _, w in found]

    best, check = run(0, BITS, inputs.exactly), run(1, CHECK_BITS, inputs.exactly)
    with mp.workprec(BITS):
        apart = max(max(angle, float(w / max(1, mp.norm(omega))))
                    for (angle, w), omega in zip(zip(*_distances(*check, *best)), best[1]))
        moved = [_distances(*run(2 + k, FLOOR_BITS, inputs.Moved(k)), *best) for k in range(draws)]
        floor, floor_omega = (np.max([one[k] for one in moved], axis=0) for k in (0, 1))
        digits = float(-mp.log10(max(apart, mpf(10) ** -60)))
    return Reference(np.array(times), *best, floor, floor_omega, digits)


def _distances(orientation, omega, true_orientation, true_omega):
    """Return the rotation angles and the lengths of differences of omega, two arrays."""
    angles, lengths = [], []
    with mp.workprec(max(mp.prec, 160)):
        for q, w, p, v in zip(orientation, omega, true_orientation, true_omega):
            q = inputs.unit(q)
            across = [a - b if inputs.dot(q, p) > 0 else a + b for a, b in zip(q, p)]
            angles.append(float(4 * mp.asin(min(mpf(1), mp.sqrt(inputs.dot(across, across)) / 2))))
            lengths.append(float(mp.sqrt(mp.fsum((a - b) ** 2 for a, b in zip(w, v)))))
    return np.array(angles), np.array(lengths)


def save(name, problem, reference):
    """Write a reference to its file, with its scene and duration."""
    def text(rows):
        return [[mp.nstr(x, DIGITS) for x in row] for row in rows]
    FOLDER.joinpath(f'{name}.json').write_text(json.dumps(
        {'scene': problem.scene.text, 'duration': problem.duration,
         'digits': round(reference.digits, 1), 'times': reference.times.tolist(),
         'orientation': text(reference.orientation), 'omega': text(reference.omega),
         'floor': [float(f'{x:.3e}') for x in reference.floor],
         'floor_omega': [float(f'{x:.3e}') for x in reference.floor_omega]},
        indent=1) + '\n')


def load(problem):
    """Return the cached Reference of a problem, or None.

    The scene and the duration in the file must be exactly those of the problem.
    """
    path = FOLDER / f'{problem.name}.json'
    if not path.is_file():
        return None
    found = json.loads(path.read_text())
    if (found['scene'], found['duration']) != (problem.scene.text, problem.duration):
        return None
    with mp.workdps(DIGITS + 6):
        rows = [[tuple(map(mpf, row)) for row in found[name]] for name in ('orientation', 'omega')]
    return Reference(np.array(found['times']), *rows, np.array(found['floor']),
                     np.array(found['floor_omega']), found['digits'])
