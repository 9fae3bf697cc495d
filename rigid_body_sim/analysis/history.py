# SPDX-License-Identifier: Apache-2.0
"""What happened in a run, from the journal of its recording.

It consists of marks, which figures show, and of segments without a change from outside.
"""

import dataclasses
from dataclasses import dataclass

import numpy as np

from rigid_body_sim.messages.timeline import NANOSECONDS
from rigid_body_sim.scene.constraints.protocol import Mechanism
from rigid_body_sim.scene.scene import Scene, parse_scene


@dataclass(frozen=True)
class Mark:
    """Something that happened.

    `stamp` (ns) from which on it holds; `kind`: ``event``, ``strike``, ``commands``, ``reset``,
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
        Stamp of its first tick, ns.
    scene : Scene or None
        As it runs; None where it is not known.
    rate, pace : float
        Ticks per simulated second, and simulated seconds per second; 0: as fast as it goes, or not
        known.
    held : bool
        Whether a wrench acts.
    begun_by : str
        The kind of Mark that it begins with; ``''`` for the first one.
    """

    stamp: int
    scene: Scene | None
    rate: float
    pace: float
    held: bool = False
    begun_by: str = ''

    @property
    def keeps_energy(self):
        """Whether energy is constant here."""
        return self._keeps(lambda one: one.books == 'potential')

    @property
    def keeps_momentum(self):
        """Whether L^2 about the centre of mass is constant here."""
        return self._keeps(lambda one: one.gives in ('force', 'turning')) and (
            self.scene.constraint.mechanism is Mechanism.FREE)

    def _keeps(self, harmless):
        """Return whether `harmless` is true of everything that acts between impulses."""
        if self.scene is None or self.held or self.scene.constraint.mechanism is Mechanism.PLANE:
            return False
        frame = self.scene.frame
        return all(effect.contact is None and all(map(harmless, effect.acting(frame, 0.0)))
                   for effect in self.scene.acting)


@dataclass(frozen=True)
class History:
    """Marks and segments in stamp order; the first segment begins with the recording."""

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


def history(entries, events, first, end):
    """Return the History of a run.

    Parameters
    ----------
    entries : list of dict
        The journal.
    events : iterable of (int, dict)
        Stamps and DiagnosticStatus messages.
    first : Segment
        As the recording begins.
    end : int
        Stamp of its last tick, ns.
    """
    segments = [first]
    for entry in entries:
        changed = _changed(segments[-1], entry)
        if changed:
            segments.append(dataclasses.replace(changed, stamp=entry['log_time'],
                                                begun_by=entry['kind']))
    segments, strikes = _with_strikes(segments, entries, end)
    marks = sorted(
        [*filter(None, map(_mark, entries)), *(_event(*event) for event in events), *strikes],
        key=lambda mark: mark.stamp,
    )
    return History(tuple(marks), tuple(segments))


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


def _with_strikes(segments, entries, end):
    """Return the segments, cut where the scene's own strikes act, and the Marks of the strikes.

    They act at their times since the start, the last reset or another scene.
    """
    starts = {
        entry['log_time']
        for entry in entries
        if entry['kind'] == 'reset' or not entry.get('keeps_state', True)
    }
    cut, marks, begin = [], [], segments[0].stamp
    for segment, following in zip(segments, [*segments[1:], None], strict=True):
        fresh = segment is segments[0] or segment.stamp in starts
        begin = segment.stamp if fresh else begin
        until = min(end, following.stamp - 1) if following else end
        cut.append(segment)
        for effect in segment.scene.strikes if segment.scene else ():
            stamp = begin + round(effect.time * NANOSECONDS)
            if not segment.stamp + (not fresh) <= stamp <= until:
                continue
            marks.append(Mark(stamp, 'strike', effect.name, {'time': effect.time}))
            if stamp > segment.stamp:
                cut.append(dataclasses.replace(segment, stamp=stamp, begun_by='strike'))
    return cut, marks


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
