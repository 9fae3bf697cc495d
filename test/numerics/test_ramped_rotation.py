# SPDX-License-Identifier: Apache-2.0
"""Turn under an angular velocity that grows linearly, against 34 digits and against itself.

Both regions are tried.
"""

import json
import math
import pathlib

import numpy as np
import pytest

from rigid_body_sim.numerics.ramped_rotation import RIM, WIDER, ramped_rotation
from rigid_body_sim.numerics.rotations import multiply

RECORDS = json.loads((pathlib.Path(__file__).resolve().parents[1] / 'data'
                      / 'ramped_rotation.json').read_text())
EPSILON = np.finfo(float).eps


def angle(c, p, w, time):
    """Return a bound on the angle turned: the conditioning of the turn in its inputs."""
    return abs(time) * max(math.hypot(c, p), math.hypot(c + w * time, p))


def difference(one, other):
    return math.sqrt(sum((float(a) - float(b)) ** 2 for a, b in zip(one, other, strict=True)))


@pytest.mark.parametrize('record', RECORDS, ids=lambda record: record['name'])
def test_reference(record):
    case = [float.fromhex(value) for value in record['case']]
    # worst measured: 0.96 epsilon (1 + angle), 'outside, wide'
    assert (difference(ramped_rotation(*case), record['turn'])
            <= 2.0 * EPSILON * (1.0 + angle(*case)))


def random_cases(count, seed=5):
    rng = np.random.default_rng(seed)
    for _ in range(count):
        w = 10.0 ** rng.uniform(-3, 3)
        root = math.sqrt(w)
        yield (
            float(root * rng.choice([-1, 1]) * 10.0 ** rng.uniform(-2, 2)),
            float(root * 10.0 ** rng.uniform(-3, 2)), w,
            float(rng.choice([-1, 1]) * 10.0 ** rng.uniform(-3, 2) / root), float(rng.uniform()))


def test_two_turns_make_one():
    for c, p, w, time, share in random_cases(2000):
        first = share * time
        later = time - first
        product = multiply(
            *ramped_rotation(c + w * first, p, w, later), *ramped_rotation(c, p, w, first))
        # worst measured 3.0
        assert (difference(product, ramped_rotation(c, p, w, time))
                <= 6.0 * EPSILON * (1.0 + angle(c, p, w, time)))


def test_a_turn_back_undoes_it():
    for c, p, w, time, _ in random_cases(1000):
        x, y, z, s = multiply(
            *ramped_rotation(c + w * time, p, w, -time), *ramped_rotation(c, p, w, time))
        # worst measured 3.4
        assert (difference((x, y, z, s), (0.0, 0.0, 0.0, 1.0))
                <= 6.0 * EPSILON * (1.0 + angle(c, p, w, time)))


def test_no_jump_at_the_rim():
    """On either side of the border of the regions the answer is the same."""
    for p in (0.05, 2.0, 7.5):
        c = math.sqrt(RIM * RIM - WIDER * p * p)
        inside, outside = (ramped_rotation(c * (1.0 + nudge), p, 1.0, 20.0)
                           for nudge in (-1e-14, 1e-14))
        # the nudge itself turns the end by 20 * 2e-14 * 10 / 2 rad
        assert difference(inside, outside) <= 20.0 * 2e-14 * c


def test_no_ramp_is_a_plain_rotation():
    x, y, z, s = ramped_rotation(3.0, 4.0, 0.0, 0.2)
    assert (x, y, z, s) == pytest.approx(
        (0.6 * math.sin(0.5), 0.8 * math.sin(0.5), 0.0, math.cos(0.5)), abs=1e-15)


def test_extremes_stay_unit():
    for case in [(1e300, 1e299, 1e3, 1.0), (1e-300, 1e-200, 1e-3, 1.0), (1.0, 1.0, 1e-320, 1.0),
                 (1e160, 1e150, 1e-300, 1.0), (5.0, 1e-320, 1.0, 3.0), (0.0, 1e8, 1.0, 1e-9),
                 (-1e8, 1.0, 1.0, 2e8),
                 (1e300, 1e299, 1e3, 1e9)]:
        assert math.sqrt(sum(part * part for part in ramped_rotation(*case))) == pytest.approx(
            1.0, abs=2e-15)
