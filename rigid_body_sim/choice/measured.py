"""What the methods cost and how accurate they are, as measured, and the choice that follows from it.

measured.json is made by ``python -m rigid_body_sim.study.precision.make_measured``; it names its machine. For each kind of scene and each
method that controls its error it has, for tolerances from coarse to fine, the largest error of the attitude along the training problems (rad)
and the CPU time for each radian that the body may turn (s).
"""

import functools
import json
import pathlib

from rigid_body_sim.mechanics.bounds import swing_rate
from rigid_body_sim.numerics.functions import hypot3

FILE = pathlib.Path(__file__).with_name('measured.json')
HALF_ULP = 2.0 ** -53


@functools.cache
def table():
    """Return the content of measured.json."""
    return json.loads(FILE.read_text())


def kind(scene):
    """Return the kind of a scene: its constraint, and what makes heat."""
    if scene.effect('internal_dissipation'):
        return f'{scene.constraint.kind}, dissipating'
    return f'{scene.constraint.kind}, damped' if scene.effect('drag') else scene.constraint.kind


def pace(scene):
    """Return how fast a body may turn (rad/s): its rate at the start, and what its weight can add."""
    return hypot3(*scene.initial.angular_velocity) + swing_rate(scene)


def floor(scene, horizon):
    """Return what rounding alone is expected to do to the attitude (rad): half an ulp of all the angle gone through."""
    return HALF_ULP * (4.0 + pace(scene) * horizon)


def rows(scene):
    """Return the measurements for a scene's kind: method -> list of dicts with tolerance, error, cost, from coarse to fine."""
    kinds = table()['kinds']
    return kinds.get(kind(scene)) or kinds[scene.constraint.kind]


def pick(scene, able, accuracy, horizon):
    """Return (method, tolerance, expected error in rad) of the cheapest method measured to meet an accuracy, else of the most accurate one.

    Parameters
    ----------
    scene : Scene
    able : list of str
        Methods that can run it.
    accuracy : float
        Error of the attitude that is asked for, rad.
    horizon : float
        Over which it is asked for, s.
    """
    good, rest = [], []
    for method in able:
        entries = rows(scene).get(method, [])
        first = next((entry for entry in entries if entry['error'] <= accuracy), None)
        if first:
            good.append((first['cost'], first['error'], method, first['tolerance']))
        rest += [(entry['error'], entry['cost'], method, entry['tolerance']) for entry in entries]
    if good:
        _, error, method, tolerance = min(good)
    else:
        error, _, method, tolerance = min(rest)
    return method, tolerance, max(error, floor(scene, horizon))
