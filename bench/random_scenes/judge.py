# SPDX-License-Identifier: Apache-2.0
"""What `auto` promises on one random scene, beside the truth."""

import math
import signal

import numpy as np
import yaml

from random_scenes.ball import BallTruth
from random_scenes.draw import drawn
from random_scenes.kinks import WORDS, Kinked
from random_scenes.looks import looks
from random_scenes.new_language import MOTIONS
from random_scenes.truth import HALF_ULP, MOVED, TooMuchWork, Truth
from random_scenes.wide import WIDE, angle
from rigid_body_sim.compilation.environment import HAVE_NUMBA
from rigid_body_sim.errors import NotConverged
from rigid_body_sim.integrators.protocols import FINEST
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.simulation.simulation import Simulation

ACCURACIES = 1e-6, 1e-11
LOOKS = 64               # as often as a trial of `auto`: dense output errs between steps
STOPPED = 0.5            # share of its largest rate below which a body has lost what it gained
LONGEST = 120            # s of the processor, a scene with its compilation
LONGEST_IN_PYTHON = 600  # without compilation
LONGEST_TRUTH = 600      # the truth of a scene
STEPS = 2000             # of the truth, in all copies: what they do not reach is left out
ENOUGH = 16              # looks that were reached; of fewer, the horizon is drawn nearer
LESS = 2.0 ** 11, 2.0 ** 3    # half ulps by which a start is moved that is magnified: to 12 mrad
AMONG, EARLY = 512, 1e-6    # times evenly, and as many from this share of the duration on
MUCH_FINER = 2.0 ** -7   # share of a tolerance
BY_FAR = 1.5             # times as much as at looks
SENSELESS = 1e-2         # rad: a floor above it leaves nothing to be asked


def truth_of(scene, most=math.inf, moved=MOVED):
    """Return what follows a scene with 64-bit mantissas, at its start, by `most` steps."""
    read = yaml.safe_load(scene.text)
    settings = [next(iter(one.items())) for one in read['effects']]
    kinked = any(word in scene.text for word in WORDS) or getattr(scene.constraint, 'winds', False)
    follow = BallTruth if scene.constraint.kind == 'table' else Kinked if kinked else Truth
    motion = next((one for one in MOTIONS if str(list(one[0])) == str(_motion(read))), None)
    return follow(scene, settings, read.get('parameters', {}), motion, most, moved)


def _motion(read):
    """Return the path of a pivot as a scene says it, None where it does not move."""
    held = read['constraint']
    settings = held.get('pivot') if isinstance(held, dict) else None
    return (settings or {}).get('motion')


def known(scene, duration):
    """Return times, attitudes there, the largest floor (rad), and Truth.jumped (J).

    There are LOOKS times up to the duration, or up to where STEPS steps of the truth lead: a slim
    body may turn a million times, and what goes wrong in that shows in a thousand.
    """
    while True:
        times, attitudes, floors, jumped = _followed(scene, looks(duration, LOOKS), STEPS)
        if len(times) >= ENOUGH:
            break
        duration = float(times[-1]) if len(times) else duration / LOOKS
    for moved in LESS:
        if max(floors) == math.inf:
            floors = _followed(scene, times, math.inf, moved)[2]
    return times, attitudes, max(floors), jumped


def _followed(scene, times, most, moved=MOVED):
    """Return what `known` returns, with all floors and the times that so many steps reach."""
    truth = truth_of(scene, most, moved)
    first, fastest, attitudes, floors = truth.rate, 0.0, [], []
    jumped = float(truth.jumped)
    for end in times:
        try:
            truth.to(float(end))
        except TooMuchWork:
            break
        attitudes.append(truth.y[0, :4].astype(WIDE))
        fastest, jumped = max(fastest, truth.rate), float(truth.jumped)
        # a rate that the body has gained and keeps counts from the start on
        slow = truth.rate < max(first, STOPPED * fastest)
        turned = truth.turned if slow else fastest * float(end)
        floors.append(max(truth.floor(), HALF_ULP * (4.0 + turned)))
    return times[:len(floors)], attitudes, floors, jumped


def tried(number, seed, draw=drawn):
    """Yield (text of a line, met, foretold, balanced) for one scene at each accuracy."""
    text, duration = draw(number, seed)
    scene = parse_scene(text)
    _within(LONGEST_TRUTH, 'the truth')
    times, attitudes, largest, jumped = known(scene, duration)
    duration, longest = float(times[-1]), LONGEST if HAVE_NUMBA else LONGEST_IN_PYTHON
    _within(longest, 'the scene')
    what = ' '.join([scene.constraint.kind, *(effect.name for effect in scene.effects)])
    for accuracy in ACCURACIES:
        simulation = Simulation(scene, accuracy=accuracy, horizon=duration, rate=1.0 / duration)
        choice, states = simulation.choice, simulation.states(times)
        error, floor = _error(attitudes, states), largest
        between = _worst_between(simulation, times)
        if between is not None:
            _within(LONGEST_TRUTH, 'the truth')
            _, there, floors, _ = _followed(scene, between, math.inf)
            _within(longest, 'the scene')
            error = max(error, _error(there, simulation.states(between)))
            floor = max(floor, *floors)
        residual = _unbalanced(simulation, jumped)
        expected, size = choice.expected_error, max(error, floor)
        expected = np.inf if expected is None else expected    # nothing is known
        verdicts = [
            error <= max(accuracy, 3.0 * floor),
            size / 3.0 <= expected <= 3.0 * size or expected > SENSELESS,
            residual <= 10.0 * max(accuracy, floor)]
        if floor > SENSELESS:
            verdicts = [True] * 3
        marks = ''.join(f'  {word}' for word, good in zip(
            ('MISSED', 'EXPECTED', 'LEDGER'), verdicts, strict=True) if not good)
        yield (f'{number:4} {what[:44]:44}{duration:7.2f}{accuracy:8.0e}{choice.method:>9}'
               f'{choice.tolerance:8.0e}{expected:9.1e}{error:9.1e}{floor:9.1e}{residual:9.1e}'
               f'{marks}'), *map(bool, verdicts)


def _error(attitudes, states):
    """Return the largest error of states beside the true attitudes, rad."""
    return max(angle(best, own.astype(WIDE))
               for best, own in zip(attitudes, states.orientation, strict=True))


def _chords(own, other):
    """Return the distances of quaternions, shape (n, 4), to the nearer one of each other pair."""
    return np.minimum(*(np.sqrt(((own - sign * other) ** 2).sum(axis=1)) for sign in (1.0, -1.0)))


def _worst_between(simulation, times):
    """Return the time at which a run errs most by far, beside a finer one; None if at a look.

    Errors of a body that slows down may rise and fall between two looks. Where the finer run takes
    too much work nothing is found.

    Returns
    -------
    array (1,) or None
        s.
    """
    choice, end = simulation.choice, float(times[-1])
    if choice.method == 'exact':
        return None
    among = np.unique(np.concatenate((np.linspace(0.0, end, AMONG)[1:],
                                      np.geomspace(EARLY * end, end, AMONG))))
    try:
        finer = Simulation(simulation.scene, choice.method, rate=simulation.rate, horizon=end,
                           accuracy=max(choice.tolerance * MUCH_FINER, FINEST))
        apart = [_chords(finer.states(at).orientation, simulation.states(at).orientation)
                 for at in (among, times)]
    except NotConverged:
        return None
    worst = int(np.argmax(apart[0]))
    return among[worst:worst + 1] if apart[0][worst] > BY_FAR * apart[1].max() else None


def _unbalanced(simulation, jumped):
    """Return the larger residual of the ledger after a tick, less the energy that jumped (J)."""
    first = simulation.ledger()
    simulation.advance(1)
    ledger = simulation.ledger()
    largest = max(abs(one[key]) for one in (first, ledger)
                  for key in ('kinetic', 'potential', 'work'))
    jumps = jumped / largest if largest else 0.0
    return max(abs(ledger['energy_residual'] - jumps), ledger['momentum_residual'])


def _within(seconds, what):
    """Raise TimeoutError if what begins takes more than so many seconds of the processor.

    It is raised once a second from then on: whoever swallows it does not go on for ever.
    """
    def late(*_):
        raise TimeoutError(f'{what} takes more than {seconds} s')
    signal.signal(signal.SIGVTALRM, late)
    signal.setitimer(signal.ITIMER_VIRTUAL, seconds, 1.0)


def judged(number, seed, draw=drawn):
    """Return what `tried` yields, as a list; one line if something is raised or hangs."""
    try:
        return list(tried(number, seed, draw))
    except Exception as error:    # whatever a scene raises is a finding, and the next is tried
        said = ' '.join(str(error).split())
        return [(f'{number:4} {type(error).__name__}: {said}  RAISED', False, False, False)]
    finally:
        signal.setitimer(signal.ITIMER_VIRTUAL, 0.0)
