"""The peers beside a case: the attitude at one time, as their users run them (steps of 1 ms, tolerances of 1e-12), or what they say.

Each answer is asked of a process of its own, so that a peer that crashes or goes on for ever is one more answer.
"""

import importlib
import math
import multiprocessing

from rigid_body_sim.errors import BadInput, NotConverged
from rigid_body_sim.study.hard_cases.attitudes import angle, scene_of

LONGEST = 100.0
"""s: later reference times would take the peers hours."""
STEP, TOLERANCE = 1e-3, 1e-12
MOST_RADIANS = 1e4
"""Turned over, beyond which even a step a radian takes a peer minutes."""
PATIENCE = 30.0
"""s: a peer that has not answered by then has none."""


def modules():
    """Return what is installed of the peers: name -> module, and the names of those that are not."""
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


def at(record):
    """Return the reference state that peers are asked for: the last one they can reach."""
    size = math.hypot(*record['angular_velocity'])
    near = [state for state in record['states'] if state['time'] <= LONGEST and size * state['time'] <= MOST_RADIANS]
    return (near or record['states'])[-1] if near else record['states'][0]


def error(module, record):
    """Return the attitude error (rad) of a peer on a record, or a text that says why there is none."""
    context = multiprocessing.get_context('fork')
    ours, theirs = context.Pipe(duplex=False)
    process = context.Process(target=lambda: theirs.send(_error(module, record)))
    process.start()
    theirs.close()
    try:
        answer = ours.recv() if ours.poll(PATIENCE) else f'no answer in {PATIENCE:g} s'
    except EOFError:
        answer = 'crashes'
    process.kill()
    process.join()
    return answer


def _error(module, record):
    from rigid_body_sim.study.precision import peers
    from rigid_body_sim.study.precision.runner import RefusedError
    from rigid_body_sim.study.precision.suite import Problem
    state = at(record)
    problem = Problem(record['name'], record['why'], state['time'], scene_of(record))
    reference = _Rates([record['angular_velocity']])
    try:
        with peers.quiet():
            runner = next(iter(module.runners(problem, reference)))
            step = state['time'] / max(1, round(state['time'] / STEP))
            run = runner.make(step if runner.control == 'step' else TOLERANCE)
            run.start()
            run.to(state['time'])
            found = angle(run.state()[:4], state['orientation'])
    except (RefusedError, BadInput) as refusal:
        return f'refuses: {_brief(refusal)}'
    except NotConverged as failure:
        return f'fails: {_brief(failure)}'
    except Exception as failure:    # a foreign program may raise anything
        return f'fails: {type(failure).__name__}: {_brief(failure)}'
    return found if math.isfinite(found) else 'NaN in silence'


class _Rates:
    """What the peers ask of a reference: the fastest rate."""

    def __init__(self, omega):
        self.omega = omega


def _brief(failure):
    return ' '.join(str(failure).split())[:90]
