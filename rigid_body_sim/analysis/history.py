"""What happened in a run, from the journal of its recording: marks for people, and segments in which nothing was changed from outside."""

import dataclasses
from dataclasses import dataclass

import numpy as np

from rigid_body_sim.messages.timeline import NANOSECONDS
from rigid_body_sim.scene.constraints.protocol import Mechanism
from rigid_body_sim.scene.scene import Scene, parse_scene

KEEP_ENERGY = {'gravity', 'strike'}
KEEP_MOMENTUM = {'gravity', 'strike', 'internal_dissipation'}


@dataclass(frozen=True)
class Mark:
    """Something that happened.

    `stamp` (ns) from which on it holds; `kind`: ``event``, ``commands``, ``reset``,
    ``parameters``, ``gap``; `name` for people; `values`.
    """

    stamp: int
    kind: str
    name: str
    values: dict


@dataclass(frozen=True)
class Segment:
    """A stretch between two changes from outside (commands, strikes, resets, parameters).

    Attributes
    ----------
    stamp : int
        Of its first tick, ns.
    scene : Scene or None
        As it runs; None where it is not known.
    rate, pace : float
        Ticks per simulated second, and simulated seconds per second; 0: as fast as it goes, or not
        known.
    held : bool
        Whether a wrench acts.
    """

    stamp: int
    scene: Scene | None
    rate: float
    pace: float
    held: bool = False

    @property
    def keeps_energy(self):
        """Whether energy is constant here."""
        return self._keeps(KEEP_ENERGY)

    @property
    def keeps_momentum(self):
        """Whether L^2 about the centre of mass is constant here."""
        return self._keeps(KEEP_MOMENTUM) and self.scene.constraint.mechanism is Mechanism.FREE

    def _keeps(self, effects):
        return (
            self.scene is not None
            and not self.held
            and all(effect.name in effects for effect in self.scene.effects)
        )


@dataclass(frozen=True)
class History:
    """Marks and segments in the order of their stamps; the first segment begins with the recording."""

    marks: tuple
    segments: tuple

    def at(self, stamps):
        """Return for each stamp (ns) the position of its segment."""
        return (
            np.searchsorted(
                [segment.stamp for segment in self.segments], stamps, side='right'
            ).clip(1)
            - 1
        )


def history(entries, events, first):
    """Return the History of a run.

    Parameters
    ----------
    entries : list of dict
        The journal.
    events : iterable of (int, dict)
        Stamps and DiagnosticStatus messages.
    first : Segment
        As the recording begins.
    """
    marks = sorted(
        [*filter(None, map(_mark, entries)), *(_event(*event) for event in events)],
        key=lambda mark: mark.stamp,
    )
    segments = [first]
    for entry in entries:
        changed = _changed(segments[-1], entry)
        if changed:
            segments.append(dataclasses.replace(changed, stamp=entry['log_time']))
    return History(tuple(marks), tuple(_with_strikes(segments, entries)))


def _changed(segment, entry):
    """Return the segment that begins with a journal entry, or None."""
    if entry['kind'] == 'commands':
        held = segment.held
        for command in entry['commands']:
            if command['topic'] != 'cmd_impulse':
                held = command['topic'] == 'cmd_wrench' and any(
                    (*command['force'], *command['torque'])
                )
        return dataclasses.replace(segment, held=held)
    if entry['kind'] == 'reset':
        return dataclasses.replace(segment, held=False)
    if entry['kind'] == 'parameters':
        pace = float(entry['changed'].get('real_time_factor', segment.pace))
        return dataclasses.replace(
            segment,
            scene=parse_scene(entry['scene']),
            rate=entry['simulation']['rate'],
            pace=pace,
            held=segment.held and entry['keeps_state'],
        )
    return None


def _with_strikes(segments, entries):
    """Return the segments, cut where the scene's own strikes act: at their times since the start, the last reset or another scene."""
    starts = {
        entry['log_time']
        for entry in entries
        if entry['kind'] == 'reset' or not entry.get('keeps_state', True)
    }
    cut, begin = [], segments[0].stamp
    for segment, following in zip(segments, [*segments[1:], None], strict=True):
        begin = segment.stamp if segment.stamp in starts else begin
        cut.append(segment)
        times = (
            [effect.time for effect in segment.scene.effects if effect.as_impulse is not None]
            if segment.scene
            else []
        )
        stamps = sorted(begin + round(time * NANOSECONDS) for time in times)
        cut += [dataclasses.replace(segment, stamp=stamp) for stamp in stamps
                if segment.stamp < stamp and (following is None or stamp < following.stamp)]
    return cut


def _mark(entry):
    """Return the Mark of a journal entry, or None."""
    stamp, kind = entry['log_time'], entry['kind']
    if kind == 'commands':
        return Mark(
            stamp,
            kind,
            ', '.join(dict.fromkeys(command['topic'] for command in entry['commands'])),
            {'tick': entry['tick']},
        )
    if kind == 'reset':
        return Mark(stamp, kind, kind, {'tick': entry['tick']})
    if kind == 'parameters':
        return Mark(
            stamp,
            kind,
            ', '.join(f'{name} = {value}' for name, value in entry['changed'].items()),
            {'tick': entry['tick']},
        )
    if kind == 'gap':
        return Mark(
            entry['after'],
            kind,
            f'{entry["ticks"]} ticks not recorded',
            {'ticks': entry['ticks'], 'until': entry['until']},
        )
    return None


def _event(stamp, status):
    return Mark(
        stamp,
        'event',
        status['name'],
        {
            'message': status['message'],
            **{pair['key']: pair['value'] for pair in status['values']},
        },
    )
