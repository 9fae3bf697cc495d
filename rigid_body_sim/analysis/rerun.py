# SPDX-License-Identifier: Apache-2.0
"""A recorded run that is simulated again from its journal: same scene, commands and ticks."""

import json

import numpy as np

from rigid_body_sim.choice.settling import Settled
from rigid_body_sim.errors import BadInput
from rigid_body_sim.messages.timeline import NANOSECONDS, Timeline
from rigid_body_sim.recording.about import SIMULATION_PARAMETERS
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.scene.state import States
from rigid_body_sim.simulation.command_rows import rows_of
from rigid_body_sim.simulation.simulation import Simulation

LONGEST = 10**12     # ticks


class Rerun:
    """A run as its journal tells it.

    Parameters
    ----------
    entries : list of dict
        The journal of one body, see recording.reader.Recording.journal.
    method : dict
        What to change: ``integrator``, ``accuracy``; it then holds for the whole run.
    first_stamp : int, optional
        Stamp (ns) of the first tick, where the journal's log times are not the stamps and the
        journal does not tell.

    Attributes
    ----------
    begin : dict
        The journal's entry of that kind: all about the run.
    recorded : dict
        What the recorded simulation was asked for, and its method.
    simulation : Simulation
        In its present state.

    Raises
    ------
    BadInput
        If there is no journal, or it does not reach back to the start.
    """

    def __init__(self, entries, method, first_stamp=None):
        self.begin = next(
            (entry for entry in entries if entry['kind'] == 'begin' and 'simulation' in entry),
            None,
        )
        anchor = next((entry for entry in entries if entry['kind'] == 'state'), None)
        if self.begin is None or anchor is None:
            raise BadInput(
                'journal',
                'is missing',
                'a recording by sim_node or simulate: ros2 bag record knows no ticks of commands',
            )
        self._method = method
        self.recorded = json.loads(self.begin['simulation'])
        self.simulation = self._simulation(self.begin['scene'], self.recorded)
        stamp = anchor.get('stamp', anchor['log_time'] if first_stamp is None else first_stamp)
        self._lines = [_line(stamp, anchor['tick'], self.recorded['rate'])]
        self._actions = []
        rate = self.recorded['rate']
        for entry in entries:
            if entry['kind'] not in ('commands', 'reset', 'parameters'):
                continue
            self._actions.append(entry)
            if entry['kind'] == 'parameters' and entry['simulation']['rate'] != rate:
                rate = entry['simulation']['rate']
                self._lines.append(self._lines[-1].from_tick(entry['tick'], rate))
        self._actions.reverse()
        self._act()
        self._given = -1

    def _simulation(self, text, asked):
        asked = {**asked, **self._method}
        # the method that auto chose then, not the one it would choose now
        settled = None
        if not self._method and asked['integrator'] in ('auto', 'exact'):
            settled = Settled(asked['method'], asked['tolerance'], asked['expected_error'],
                              asked.get('met_until', asked['horizon']))
        simulation = Simulation(
            parse_scene(text),
            asked['integrator'],
            asked['accuracy'],
            asked['rate'],
            # the step was that of the recorded method
            None if self._method else asked.get('step'),
            horizon=asked['horizon'],
            settled=settled,
        )
        # states are compared, not events; a damaged stamp may lie years away
        simulation.watching = False
        return simulation

    def ticks(self, stamps):
        """Return the ticks of stamps (n,) int64, ns; BadInput where one lies between ticks."""
        starts = np.array([line.origin for line in self._lines[1:]], dtype=np.int64)
        places = np.searchsorted(starts, stamps, side='right')
        ticks = np.empty(len(stamps), np.int64)
        for place, line in enumerate(self._lines):
            mine = places == place
            if mine.any():
                ticks[mine] = line.tick + np.rint(
                    (stamps[mine] - line.origin) * float(line.rate) / NANOSECONDS
                ).astype(np.int64)
                if not -1 < ticks[mine].min() <= ticks[mine].max() <= LONGEST:
                    raise BadInput(
                        'recording',
                        'has a stamp before its first tick, or years after it',
                        'stamps of a simulation',
                    )
                for k in np.flatnonzero(mine)[[0, -1]]:
                    if line.instant(int(ticks[k])) != stamps[k]:
                        raise BadInput(
                            'recording',
                            f'a message at {int(stamps[k])} ns, between two ticks',
                            'stamps of a simulation',
                        )
        return ticks

    def stamp(self, tick):
        """Return the stamp of a tick, ns."""
        line = next(line for line in reversed(self._lines) if line.tick <= tick)
        return line.instant(tick)

    def to(self, tick):
        """Run on to a tick, commands included."""
        while self.simulation.tick < tick:
            self.simulation.advance(self._next(tick) - self.simulation.tick)
            self._act()

    def _next(self, tick):
        return min(tick, self._actions[-1]['tick']) if self._actions else tick

    def through(self, tick):
        """Run on to a tick and return all ticks not yet given; the first one is 0.

        Returns
        -------
        ticks : array (n,)
        states : States
            After all commands.
        energies, squares : array (n,)
            Energies (J) and L^2.
        """
        first, parts = self._given + 1, []
        if self._given < self.simulation.tick:
            parts.append(
                (
                    self.simulation.vector[np.newaxis].copy(),
                    [self.simulation.energy],
                    [self.simulation.angular_momentum_squared],
                )
            )
        self._given = max(tick, self.simulation.tick)
        while self.simulation.tick < tick:
            simulation = self.simulation
            vectors = simulation.advance_through(self._next(tick) - simulation.tick).vector
            energies, momenta = simulation.diagnose(States(vectors))
            if self._act():
                vectors[-1] = self.simulation.vector
                energies[-1], momenta[-1] = (
                    self.simulation.energy,
                    self.simulation.angular_momentum_squared,
                )
            parts.append((vectors, energies, momenta))
        vectors, energies, momenta = (
            np.concatenate(columns) for columns in zip(*parts, strict=True)
        )
        return np.arange(first, first + len(vectors)), States(vectors), energies, momenta

    @property
    def next_tick(self):
        """The first tick that :meth:`through` has not given yet."""
        return self._given + 1

    def skip_to(self, tick):
        """Run on to a tick, the next one that :meth:`through` gives."""
        self.to(tick)
        self._given = tick - 1

    def _act(self):
        """Repeat what was done at the present tick, in order; return whether anything was done."""
        acted = False
        while self._actions and self._actions[-1]['tick'] == self.simulation.tick:
            acted = True
            entry = self._actions.pop()
            if entry['kind'] == 'reset':
                self.simulation.reset()
            elif entry['kind'] == 'commands':
                self.simulation.forget_past()
                for refusal in self.simulation.command(rows_of(entry['commands'])):
                    raise refusal.error
            elif SIMULATION_PARAMETERS & set(entry['changed']):
                following = self._simulation(entry['scene'], entry['simulation'])
                following.follow(self.simulation, entry['keeps_state'])
                self.simulation = following
        return acted


def _line(stamp, tick, rate):
    """Return the Timeline on which a tick has a stamp."""
    return Timeline(stamp - Timeline(0, rate).instant(tick), rate)
