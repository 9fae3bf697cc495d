# SPDX-License-Identifier: Apache-2.0
"""What the package says of one random scene on a plane, beside the truth."""

import math
import random

import numpy as np
import yaml

from random_scenes.looks import looks
from random_scenes.plane_draw import drawn
from random_scenes.plane_truth import PlaneTruth
from random_scenes.wide import WIDE, angle
from rigid_body_sim.choice.choose import methods_for
from rigid_body_sim.errors import BadInput, NotConverged
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.simulation.simulation import Simulation

ACCURACIES = 1e-6, 1e-11
NAMED = 'dop8', 'taylor', 'gauss16'
LOOKS = 24
COPIES = 3               # starts moved by half an ulp in each number, with random signs,
HALF_ULP, MOVED = 2.0 ** -53, 2.0 ** 10      # times this
SENSELESS = 1e-2         # rad: a floor above it leaves nothing to be asked
BESIDE = 1e-6            # share of the time of a fall: impacts closer than that are a heap
SLACK = 30.0             # times the error of an event that goes with that of the attitude


class Known:
    """The truth of a scene: times, unknowns, events, floors, and until when it is known.

    Attributes
    ----------
    times : array
        Looks, s.
    rows : array
        Unknowns at the looks.
    floors : array (4)
        Largest effects of half an ulp on attitude (rad), place (m), velocity (m/s) and angular
        momentum (N m s).
    events : list of (str, float, float)
        Name, time, and the effect of half an ulp on it (s).
    why : str
        Why it is not known to the end.
    """

    def __init__(self, scene, number, duration):
        read = yaml.safe_load(scene.text)
        chance = random.Random(f'{number} signs')
        best, self.why = _run(scene, read, duration, None)
        until = min(best.known, duration)
        fall = math.sqrt(float(best.body.length) / 9.81)
        self.body, self.fall = best.body, fall
        copies = []
        for _ in range(COPIES):
            signs = np.array([chance.choice((-1.0, 1.0)) for _ in range(13)])
            other, _ = _run(scene, read, duration, signs.astype(WIDE) * HALF_ULP * MOVED)
            copies.append(other)
            until = min(until, other.known)
        lists = [heaped(one.events, fall) for one in (best, *copies)]
        for events in lists[1:]:
            for mine, its in zip(lists[0], events, strict=False):
                if mine[0] != its[0] or abs(mine[1] - its[1]) > 1e-3 * fall:
                    self.why = self.why or 'half an ulp decides which event follows'
                    until = min(until, mine[1], its[1])
                    break
            else:
                if len(lists[0]) != len(events):
                    longer = max(lists[0], events, key=len)
                    until = min(until, longer[min(len(lists[0]), len(events))][1])
        self.until = until
        self.ends = self.why.startswith('end:') and until == best.known
        self.times = looks(duration, LOOKS)
        if until < duration:
            self.times = self.times[self.times < until - 1e-6 * fall]
        self.events = [
            (name, time, max(abs(time - one[k][1]) for one in lists[1:]) / MOVED)
            for k, (name, time) in enumerate(lists[0])
            if time <= until - 1e-6 * fall * (until < duration) and all(
                k < len(one) for one in lists[1:])]
        self.rows, self.floors = np.zeros((0, 13)), np.zeros(4)
        if len(self.times):
            self.rows = best.states(self.times)
            turned = float(np.abs(best.body.motion_of(self.rows).omega).max())
            self.floors = np.maximum.reduce(
                [apart(self.rows, one.states(self.times)).max(0) for one in copies]) / MOVED
            own = HALF_ULP * (4.0 + turned * self.times[-1])
            self.floors[0] = max(self.floors[0], own)


def _run(scene, read, duration, moved):
    one = PlaneTruth(scene, read, moved)
    one.run(duration)
    return one, one.why


def apart(rows, others):
    """Return differences of attitude (rad), place, velocity, angular momentum, a row each."""
    return np.array([[angle(a[:4], b[:4]), *(
        float(np.sqrt(((a[part] - b[part]) ** 2).sum()))
        for part in (slice(10, 13), slice(7, 10), slice(4, 7)))]
        for a, b in zip(rows, others, strict=True)])


def heaped(events, fall):
    """Return events without impacts that follow each other within a small share of a fall."""
    times = [time for name, time in events if name == 'impact']
    crowded = {time for k, time in enumerate(times)
               if any(abs(time - other) < BESIDE * fall for other in times[max(0, k - 1):k + 2]
                      if other != time)}
    return [(name, time) for name, time in events if name != 'impact' or time not in crowded]


def rows_of(body, states):
    """Return unknowns of the truth for states of the package."""
    q, w, v, x = (np.array(one).astype(WIDE) for one in (
        states.orientation, states.angular_velocity, states.velocity, states.position))
    y = np.concatenate((q, 0 * w, v, x), axis=1)
    y[:, :4] /= np.sqrt((y[:, :4] ** 2).sum(1))[:, None]
    R = body.motion_of(y).R
    y[:, 4:7] = (R * (body.tensor * w.T[None]).sum(1)[None]).sum(1).T
    c = np.repeat(body.center[:, None], len(y), axis=1)
    carried = np.cross(w, c.T).T
    y[:, 7:10] += (R * carried[None]).sum(1).T
    y[:, 10:] += (R * c[None]).sum(1).T
    return y


def tried(number, seed, slim=False):
    """Yield (text of a line, kind of verdict, verdicts) for one scene: a row for each run.

    Kinds: `auto` and `named` runs, `refused` scenes, scenes of which the truth is `unknown` from
    the start on, and `senseless` ones.
    """
    text, duration = drawn(number, seed, slim)
    try:
        scene = parse_scene(text)
    except BadInput as error:
        yield f'{number:4} refused: {error}'[:180], 'refused', ()
        return
    known = Known(scene, number, duration)
    what = ' '.join([*yaml.safe_load(text)['body']['surface'],
                     *(one.name.replace('_friction', '') for one in scene.effects[1:])])
    head = f'{number:4} {what[:44]:44}{duration:7.2f}'
    until = '' if known.until >= duration else f' known until {known.until:.3f}: {known.why}'
    if len(known.times) == 0:
        yield f'{head} {known.why}', 'unknown', ()
        return
    if known.floors[0] > SENSELESS:
        yield f'{head} floor {known.floors[0]:.1e}', 'senseless', ()
        return
    for accuracy in ACCURACIES:
        used = None
        for method in ('auto', *NAMED):
            if method == used or not (method == 'auto' or method in methods_for(scene)):
                continue    # `auto` has shown it
            horizon = float(known.times[-1])
            made = Simulation(scene, method, accuracy, horizon=horizon, rate=1.0 / horizon)
            used = used or made.choice.method
            line, verdicts = _compared(made, known, method, accuracy)
            yield f'{head}{line}{until}', 'auto' if method == 'auto' else 'named', verdicts


def _compared(simulation, known, method, accuracy):
    """Return the rest of a line, and verdicts: met, foretold, balanced, events."""
    horizon = float(known.times[-1])
    try:
        states = simulation.states(known.times)
    except NotConverged as error:
        return f'{method:>8} {accuracy:.0e} ENDS EARLY: {error}'[:150], (False,) * 4
    expected = simulation.expected_error
    other = rows_of(known.body, states)
    off = apart(known.rows, other)
    error, floor = off[:, 0].max(), known.floors[0]
    allowed = max(accuracy, 3.0 * floor)
    told = math.inf if expected is None else expected
    met = error <= (allowed if method == 'auto' else max(allowed, 3.0 * told))
    met = met and off[:, 1].max() <= 10.0 * max(
        allowed * float(known.body.length), 3.0 * known.floors[1])
    size = max(error, floor)
    foretold = expected is None or size / 3.0 <= expected <= 3.0 * size or expected > SENSELESS
    simulation.advance(1)
    ledger = simulation.ledger()
    residual = max(abs(ledger['energy_residual']), ledger['momentum_residual'])
    balanced = residual <= 10.0 * max(accuracy, floor)
    events, late, said = _events(simulation, known, max(allowed, error), horizon)
    marks = ''.join(f'  {word}' for word, good in zip(
        ('MISSED', 'EXPECTED', 'LEDGER', f'EVENTS {said}'), (met, foretold, balanced, events),
        strict=True) if not good)
    return (f'{accuracy:8.0e}{_called(method, simulation):>12}{told:9.1e}{error:9.1e}{floor:9.1e}'
            f'{residual:9.1e}{late:9.1e} {len(known.events):3}{marks}'), tuple(
                map(bool, (met, foretold, balanced, events)))


def _called(method, simulation):
    used = simulation.choice.method
    return used if method == used else f'auto: {used}'


def _events(simulation, known, allowed, horizon):
    """Return whether the events are those of the truth, the latest one's error, and what not."""
    own = heaped([(one.name, one.time) for one in simulation.events], known.fall)
    true = [one for one in known.events if one[1] <= horizon]
    edge = horizon - 1e-4 * known.fall
    mine = [one for one in own if one[1] <= horizon]
    late = 0.0
    for (name, time, floor), (called, when) in zip(true, mine, strict=False):
        if name != called:
            return time > edge, late, f'{name} {time!r}, not {called} {when!r}'
        share = (floor + HALF_ULP * known.fall) / max(known.floors[0], HALF_ULP)
        late = max(late, abs(when - time))
        if abs(when - time) > SLACK * max(allowed * share, allowed * known.fall):
            return False, late, f'{name} {time!r}, not at {when!r}'
    if len(true) != len(mine):
        rest = [one for one in (true[len(mine):] or mine[len(true):]) if one[1] <= edge]
        return not rest, late, f'{len(mine)} events, not {len(true)}'
    return True, late, ''


def judged(number, seed, slim=False):
    """Return what `tried` yields, as a list; one line if something is raised."""
    try:
        return list(tried(number, seed, slim))
    except Exception as error:    # whatever a scene raises is a finding, and the next is tried
        said = ' '.join(str(error).split())
        return [(f'{number:4} {type(error).__name__}: {said}  RAISED'[:300], 'raised', ())]
