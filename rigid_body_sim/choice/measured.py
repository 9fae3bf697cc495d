# SPDX-License-Identifier: Apache-2.0
"""The measured cost and accuracy of the methods, and the choice that follows from them.

``python -m rigid_body_sim.study.precision.make_measured`` makes measured.json, which names its
machine. For each kind of scene, each method that controls its error, and tolerances from coarse to
fine, it has the largest error of the attitude along the training problems (rad) and the CPU time
for each radian that the body may turn (s).
"""

import functools
import json
import math
import pathlib

from rigid_body_sim.integrators import METHODS
from rigid_body_sim.integrators.equations.relaxation import stiff_relaxations
from rigid_body_sim.integrators.equations.series import has_formulas
from rigid_body_sim.mechanics.bounds import swing_rate
from rigid_body_sim.numerics.functions import hypot3
from rigid_body_sim.scene.constraints.protocol import Mechanism
from rigid_body_sim.scene.scene import kept

FILE = pathlib.Path(__file__).with_name('measured.json')
HALF_ULP = 2.0 ** -53
OFTEN = 13      # largest number of unknowns of the equations

PROMISED = {'dop8': [{'tolerance': one, 'error': one, 'cost': 1.0}
                     for one in (float(f'1e-{n}') for n in range(1, 16))]}


@functools.cache
def table():
    """Return the content of measured.json."""
    return json.loads(FILE.read_text())


@kept
def kind(scene):
    """Return the kind of a scene in the table: its free directions, and how it makes heat.

    Heat at a constant angular momentum (`turning`) is internal dissipation; other heat is damping.
    """
    hot = _hot(scene)
    if any(one.gives == 'turning' for one in hot):
        return f'{_free_directions(scene)}, dissipating'
    return f'{_free_directions(scene)}, damped' if hot else _free_directions(scene)


@kept
def makes_heat(scene):
    """Return whether anything makes heat, which may bring a body to rest."""
    return bool(_hot(scene))


def _hot(scene):
    """Return what makes heat, a list of Acting."""
    frame = scene.frame
    return [one for effect in scene.effects if effect.acting is not None
            for one in effect.acting(frame, 0.0) if one.books == 'heat']


def _free_directions(scene):
    """Return the table's word for the free directions of a scene's body."""
    return {Mechanism.FREE: 'free', Mechanism.POINT: 'pivot', Mechanism.AXIS: 'hinge',
            Mechanism.TABLE: 'table', Mechanism.PLANE: 'plane'}[scene.constraint.mechanism]


def pace(scene):
    """Return a bound on the rate of a body (rad/s): that at the start, plus what weight adds."""
    return hypot3(*scene.initial.angular_velocity.tolist()) + swing_rate(scene)


def floor(scene, horizon):
    """Return the error of the attitude (rad) by rounding: half an ulp of all the angle turned."""
    return HALF_ULP * (4.0 + pace(scene) * horizon)


@kept
def rows(scene):
    """Return the measurements for a scene's kind.

    A dict: method -> list of dicts with tolerance, error (rad) and cost (s), from coarse to fine.
    On a plane nothing was measured: the general method promises the accuracy it is given.
    """
    kinds = table()['kinds']
    return kinds.get(kind(scene)) or kinds.get(_free_directions(scene)) or PROMISED


def on_such(scene, method):
    """Return whether a method was measured on scenes of this kind.

    Power series were measured where what acts is given in numbers; formulas of a scene, and the
    phases of a body on a plane, have series of their own, which take seconds to compile.
    """
    by_series = METHODS[method].NEEDS == 'series'
    if by_series and (has_formulas(scene) or scene.constraint.mechanism is Mechanism.PLANE):
        return False
    return bool(rows(scene).get(method)) and not _misses_roots(scene, method)


def is_doubted(scene, method):
    """Return whether a method may err on a scene without a sign of it, and is else a good one.

    Collocation was measured where what acts is smooth: its error estimate assumes that. Where |v|
    of quadratic drag nearly passes zero it errs by thousands of times what is asked and does not
    say so. Other roots never come near zero, and there it rounds least.
    """
    return bool(rows(scene).get(method)) and _misses_roots(scene, method)


def _misses_roots(scene, method):
    """Return whether the steps of a method do not see that a root in a scene comes near zero.

    Stiff drag lets nothing swing through zero; few methods are left there, and collocation is the
    only one of high order.
    """
    return _rooted(scene) and not METHODS[method].FAMILY.ROOTS and not is_stiff(scene)


@kept
def is_stiff(scene):
    """Return whether drag in proportion to velocity is stiff in a scene."""
    return bool(stiff_relaxations(scene, OFTEN))


@kept
def _rooted(scene):
    """Return whether anything that acts takes a root of what moves."""
    return any(one.rooted for effect in scene.effects if effect.acting is not None
               for one in effect.acting(scene.frame, 0.0))


def least_error(scene, method):
    """Return the least error (rad) that a method was measured to have; infinite if it was not."""
    return min((entry['error'] for entry in rows(scene).get(method, ())), default=math.inf)


def pick(scene, able, accuracy, horizon):
    """Return (method, tolerance, expected error in rad) of the cheapest good method.

    If no method was measured to meet the accuracy, the most accurate one is taken.

    Parameters
    ----------
    scene : Scene
    able : list of str
        Methods that can run it.
    accuracy : float
        Error of the attitude that is asked for, rad.
    horizon : float
        Time over which the accuracy is asked for, s.
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
