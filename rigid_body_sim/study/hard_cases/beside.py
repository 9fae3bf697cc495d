# SPDX-License-Identifier: Apache-2.0
"""The peers on a hard case: their error at one time, or the message that they give instead.

They run as their users run them (steps of 1 ms, tolerances of 1e-12). Each question is asked in a
process of its own, so that a peer that crashes or never ends gives one more answer.
"""

import importlib
import math
import multiprocessing

from mpmath import mp, mpf

from rigid_body_sim.command_line import deaf_children
from rigid_body_sim.errors import BadInput, NotConverged
from rigid_body_sim.study.hard_cases.case import Question

LONGEST = 100.0
"""Last reference time (s) that peers are asked for; later ones would take them hours."""
STEP, TOLERANCE = 1e-3, 1e-12
MOST_RADIANS = 1e4
"""Largest angle (rad); beyond it even one step a radian takes a peer minutes."""
PATIENCE = 20.0
"""Time (s) after which a peer that has not answered is stopped."""


def modules():
    """Return the installed peers, name -> module, and the names of the others."""
    try:
        from rigid_body_sim.study.precision import peers
    except ImportError:
        return {}, ['all: numba is not installed']
    found, missing = {}, []
    for name in peers.MODULES:
        module = importlib.import_module(f'{peers.__name__}.{name}')
        try:
            with peers.quiet():
                module.version()
        except ImportError:
            missing.append(module.NAME)
        else:
            found[module.NAME] = module
    return found, missing


def answer(module, question):
    """Return the error of a peer, or a text that says why there is none.

    The text is empty if the peer cannot be asked.
    """
    context = multiprocessing.get_context('fork')
    ours, theirs = context.Pipe(duplex=False)
    process = context.Process(target=lambda: theirs.send(_asked(module, question)))
    with deaf_children():
        process.start()
    theirs.close()
    try:
        found = ours.recv() if ours.poll(PATIENCE) else f'no answer in {PATIENCE:g} s'
    except EOFError:
        found = 'crashes'
    process.kill()
    process.join()
    return found


def _asked(module, question):
    from rigid_body_sim.study.precision import peers
    from rigid_body_sim.study.precision.runner import RefusedError
    try:
        with peers.quiet():
            found = question.ask(module)
    except (RefusedError, BadInput) as refusal:
        return f'refuses: {_brief(refusal)}'
    except NotConverged as failure:
        return f'fails: {_brief(failure)}'
    except Exception as failure:    # a foreign program may raise anything
        return f'fails: {type(failure).__name__}: {_brief(failure)}'
    return found if isinstance(found, str) or math.isfinite(found) else 'NaN in silence'


def attitude(scene, record):
    """Return the Question for the attitude (rad) of a record of attitudes.py.

    It asks for the last of the record's times that peers can reach.
    """
    size = math.hypot(*record['angular_velocity'])
    near = [state for state in record['states']
            if state['time'] <= LONGEST and size * state['time'] <= MOST_RADIANS]
    state = (near or record['states'][:1])[-1]

    def measure(run):
        run.to(state['time'])
        return angle(run.state()[:4], state['orientation'])
    return smooth(scene, state['time'], 'rad', measure)


def smooth(scene, time, unit, measure):
    """Return the Question for a measurement on the started Run of a smooth scene.

    A Run is that of precision/runner.py.
    """
    def ask(module):
        from rigid_body_sim.study.precision.suite import Problem
        runner = next(iter(module.runners(Problem(scene.name, scene.about, time, scene),
                                          _Rates([scene.initial.angular_velocity]))))
        step = time / max(1, round(time / STEP))
        run = runner.make(step if runner.control == 'step' else TOLERANCE)
        run.start()
        return measure(run)
    return Question(time, unit, ask)


class _Rates:
    """Stand-in for a reference: it has the fastest rate, which is all that peers ask for."""

    def __init__(self, omega):
        self.omega = omega


def angle(found, expected):
    """Return the angle (rad) between an attitude and one given by its digits."""
    with mp.workdps(50):
        p, q = [mpf(float(x)) for x in found], [mpf(x) for x in expected]
        if not mp.fdot(p, p) * mp.fdot(q, q) > 0:    # a NaN too
            return math.inf
        sign = 1 if mp.fdot(p, q) > 0 else -1
        across = mp.sqrt(sum((sign * a / mp.sqrt(mp.fdot(p, p)) - b / mp.sqrt(mp.fdot(q, q))) ** 2
                             for a, b in zip(p, q)))
        return float(4 * mp.asin(min(mpf(1), across / 2)))


def _brief(failure):
    return ' '.join(str(failure).split())[:90]
