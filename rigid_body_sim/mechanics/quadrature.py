# SPDX-License-Identifier: Apache-2.0
"""Work, heat and angular impulse, integrated along the published trajectory.

The ledger's entries do not come from the equations that a method solved but from its states: a
quadrature over these, under control of its own error (panels.py). So the ledger belongs to the
published trajectory whatever solved it, and does not agree with a method merely because it repeats
what the method did. Panels are laid from the start on, so the ledger does not depend on how often
it is asked.
"""

import bisect
import math

import numpy as np

from rigid_body_sim.compilation.memory import memory, table
from rigid_body_sim.compilation.templates import imported, specialise
from rigid_body_sim.mechanics import booking, parameters
from rigid_body_sim.mechanics.bounds import (
    cancelling_terms,
    drive,
    falling,
    pull,
    relaxation,
    resting,
    swing_rate,
)
from rigid_body_sim.mechanics.energy import DIAGNOSIS, KINETIC, POTENTIAL, carried_energy
from rigid_body_sim.mechanics.ledger import DISSIPATED, ENTRIES_SIZE, WORK
from rigid_body_sim.mechanics.panels import (
    COLUMNS,
    ENERGY,
    LONGER,
    MOMENTUM,
    NOISE,
    OMEGA,
    PLACES,
    SHORTER,
    SUMS,
    add_panels,
)
from rigid_body_sim.mechanics.potential import energies
from rigid_body_sim.numerics.functions import hypot3
from rigid_body_sim.scene.state import ANGULAR_VELOCITY, STATE, STATE_SIZE, TIME, VELOCITY

RADIANS = 8.0            # angle of the fastest turn in the longest panel
UNMOVED = 1.0            # s, the first panel where nothing moves
AT_ONCE = 256            # panels
CLOCK = 2.0 ** -46       # share of the time, 64 ulps: the clock resolves no shorter panel
TINY = 2.0 ** -80        # share of the first panel: no shorter one is tried
CANCELLED = 2.0 ** -48   # share of terms that may cancel: smaller coefficients are rounding
MOST = 2 ** 20
"""Panels between two times that are asked for: seconds of work."""
EVENLY = 2 ** 12
"""Panels where more than MOST would be asked for, over more than eight million radians.

They are spread evenly, and give the mean of what acts.
"""
NOTHING = memory(np.zeros(0))


class Actors:
    """Everything that acts in a scene, in the form that the ledger takes.

    Parameters
    ----------
    scene : Scene
    wrench : effects.wrench.Wrench, optional
        Held all the time.
    horizon : float, optional
        How long the scene is to last, s.

    Attributes
    ----------
    acts : bool
        Whether anything gives the body energy or angular momentum, or takes it.
    breakpoints : list of float
        Times at which what acts jumps, s.
    is_carried : bool
        Whether the body is held at a pivot that moves.
    swing, drive : float
        Bounds of the rates (bounds.py), rad/s and rad/s^2.
    noise : float
        What rounding leaves of terms of the torque that cancel, as those of a weight, N m.
    relaxation, falling : float
        Rates at which heat relaxes the body (bounds.py): over the square of its |omega|, s, and
        down its potentials, 1/s.
    """

    def __init__(self, scene, wrench=None, horizon=0.0):
        self._frame = scene.frame
        self._actors = [effect for effect in scene.effects if effect.acting is not None]
        self._actors += [wrench] if wrench else []
        self.breakpoints = sorted({time for actor in self._actors for time in actor.breakpoints})
        self._scene = parameters.parameters(scene)
        self._energies = energies(scene)
        self.is_carried = self._frame.path is not None
        self._numbers = parameters.scene_parameters(scene)
        self._kernels, self._held = None, {}
        found = self._acting(-math.inf)
        self.acts = any(one.gives != 'force' or one.books != 'potential' for one in found)
        self.swing, self.drive = swing_rate(scene), drive(scene, wrench)
        self._resting = resting(scene)
        moments = scene.constraint.inertia(scene.body).moments
        self.relaxation = relaxation(scene, max(moments))
        self.falling = falling(scene)
        terms = cancelling_terms(scene, horizon)
        self._noise_of_force = CANCELLED * terms.force
        self.noise = CANCELLED * (terms.torque + pull(scene))
        self._inner, self._largest = scene.inner_dissipation, max(moments)

    def _acting(self, time):
        return [one for actor in self._actors for one in actor.acting(self._frame, time)]

    def held(self, time):
        """Return the parameters that hold just after a time (s), for the kernel `rates`."""
        place = bisect.bisect_right(self.breakpoints, time)
        if place not in self._held:
            values = [value for one in self._acting(time) for value in one.values]
            self._held[place] = np.array([*self._scene[:parameters.SCENE.size], *values])
        return self._held[place]

    def rates(self, p, states):
        """Return the rates at states (n, 14): of the entries, |omega|, noise of the power."""
        if self._kernels is None:
            source = _source(self._acting(-math.inf), self._frame.path is not None)
            self._kernels = specialise(booking, acting=source)
        out = np.empty((len(states), COLUMNS))
        self._kernels.rates(memory(p), memory(states), memory(out))
        x, y, z = states[:, VELOCITY].T
        speed = np.sqrt(x * x + y * y + z * z)
        out[:, NOISE] = self.noise * out[:, OMEGA] + self._noise_of_force * speed
        if self._inner > 0.0:    # the heat u^2/c, u = c times torques that nearly cancel
            omega = out[:, OMEGA]
            torque = self.noise + CANCELLED * self._largest * omega * omega
            out[:, NOISE] += 2.0 * torque * np.sqrt(self._inner * np.abs(out[:, DISSIPATED]))
        return out

    def carried(self, vector):
        """Return M u . V - M u^2/2 of a state (J), u the velocity of the pivot.

        The bearing's force M V' - F has the power M u . V' - F . u. The first is the rate of this
        less M u' . (V - u), and that is done by the torque of scene/effects/carrying.py.
        """
        return carried_energy(self._numbers, STATE.load(vector.tolist()))

    def gained(self, states):
        """Return the energy (J) that work gives and heat takes between states (n, 14), (n - 1,).

        Where the pivot moves, that is without what its bearing gives (`carried`).
        """
        rows = np.empty((len(states), DIAGNOSIS.size))
        self._energies.diagnose_many(memory(self._scene), memory(states), memory(rows))
        energy = rows[:, KINETIC] + rows[:, POTENTIAL]
        if self.is_carried:
            energy -= [self.carried(vector) for vector in states]
        return np.diff(energy)

    def sizes(self, vector):
        """Return the sizes of energy (J) and momentum (kg m^2/s) of a state.

        They are at least those of a body that rests: smaller errors are nothing.
        """
        row = np.empty(DIAGNOSIS.size)
        self._energies.diagnose(self._scene, vector, row)
        found = DIAGNOSIS.load(row.tolist())
        return (max(found.kinetic, abs(found.potential), self._resting[0]),
                max(hypot3(*found.momentum), self._resting[1]))


class Quadrature:
    """The entries of the ledger along a trajectory.

    Parameters
    ----------
    actors : Actors
    states : callable
        (times, out) -> None, as a solver has it.
    start : array (14,)
        The state at the start.
    slack : float
        Relative uncertainty of the states between two steps of a method: panels are not made
        shorter to resolve it.
    kinks : callable
        Time -> the times before it at which what acts has a kink, besides the breakpoints, s.
    """

    def __init__(self, actors, states, start, slack, kinks=lambda until: ()):
        self._actors, self._states, self._start, self._slack = actors, states, start, slack
        self._kinks = kinks
        self._rewind()

    def _rewind(self):
        self._time, self._sums = float(self._start[TIME]), np.zeros(SUMS)
        self._sums[[ENERGY, MOMENTUM]] = self._actors.sizes(self._start)
        pace = hypot3(*self._start[ANGULAR_VELOCITY].tolist()) + self._actors.swing
        self._longest = RADIANS / pace if pace > 0.0 else math.inf
        self._length = self._first = self._first_panel(pace)

    def _first_panel(self, pace):
        """Return the time (s) in which the body could turn by RADIANS from the start."""
        a = self._actors.drive
        if a > 0.0:
            return 2.0 * RADIANS / (pace + math.sqrt(pace * pace + 2.0 * a * RADIANS))
        return RADIANS / pace if pace > 0.0 else UNMOVED

    def until(self, time):
        """Return the entries from the start to a time (s), array (5,)."""
        if time < self._time:
            self._rewind()
        self._count = 0
        ends = [*sorted({*self._actors.breakpoints, *self._kinks(time)}), math.inf]
        ahead = time - self._time
        # where the clock resolves no turn of the body, short panels would see noise
        fastest = RADIANS / self._longest + self._actors.drive * (time - float(self._start[TIME]))
        lost = fastest * CLOCK * abs(time) > RADIANS
        self._least = ahead / EVENLY if lost or ahead > MOST * self._longest else 0.0
        for end in ends[bisect.bisect_right(ends, self._time):]:
            self._time, self._length = self._lay(self._time, time, end, self._length, self._sums)
            if end > time:
                break
        sums = self._sums
        if self._time < time:    # a part of the next panel
            sums = sums.copy()
            self._lay(self._time, time, time, time - self._time, sums)
        entries = sums[:ENTRIES_SIZE].copy()
        if self._actors.is_carried:
            now = np.empty((1, STATE_SIZE))
            self._states(np.array([time]), now)
            entries[WORK] += self._actors.carried(now[0]) - self._actors.carried(self._start)
        return entries

    def _lay(self, t, until, end, length, sums):
        """Lay the panels that end not later than a time, in a stretch where parameters hold.

        Parameters
        ----------
        t, until : float
            s, from there to there.
        end : float
            The last panel of the stretch ends there exactly, s.
        length : float
            Of the next panel, s.
        sums : array (SUMS,)
            Changed.

        Returns
        -------
        float, float
            Where the last panel ends (s), and the length of the next one (s).
        """
        p, most, last = self._actors.held(t), 1, min(until, end)
        while t < last:
            least = (until - t) / EVENLY if self._count > MOST else self._least
            length = max(length, least)
            edges = _edges(t, until, end, length, most)
            if len(edges) < 2:
                break
            times = (edges[:-1, np.newaxis] + np.diff(edges)[:, np.newaxis] * PLACES).ravel()
            states = np.empty((len(times), STATE_SIZE))
            self._states(times, states)
            # the edges are rounded, so a panel may be an ulp of the time longer than asked
            shortest = max(1.001 * least, CLOCK * abs(t) + TINY * self._first)
            rates = table(self._actors.rates(p, states))
            added, advice = add_panels(rates, memory(edges), self._gained(edges),
                                       self._actors.relaxation, self._actors.falling,
                                       self._longest, shortest, self._slack, self._actors.noise,
                                       memory(sums))
            self._count, most = self._count + len(edges) - 1, min(AT_ONCE, 2 * most)
            if advice == SHORTER:
                length, most = 0.5 * (edges[added + 1] - edges[added]), 1
            elif advice == LONGER:
                length, most = 2.0 * length, 1
            t = float(edges[added])
        return t, length

    def _gained(self, edges):
        """Return the energy (J) that the body gained in each panel, where heat relaxes it."""
        if not (self._actors.relaxation > 0.0 or self._actors.falling > 0.0):
            return NOTHING
        states = np.empty((len(edges), STATE_SIZE))
        self._states(edges, states)
        return memory(self._actors.gained(states))


def _edges(t, until, end, length, most):
    """Return the edges of up to `most` panels from a time on; the first edge alone if none fits.

    The panel that would leave less than a tenth of another one before `end` goes up to there.
    """
    count = min(most, int((min(until, end) - t) / length))
    if end < math.inf:
        count = min(count, int((end - t) / length - 0.1))
        if count < 1 and t + 1.1 * length >= end and end <= until:
            return np.array([t, end])
    # one after the other, so that an edge does not depend on where this call begins
    edges = np.add.accumulate([t, *[length] * count])
    return edges if edges[-1] <= until else edges[:-1]


def _source(acting, carried):
    """Return the source of ``acting(p, q, omega, v, m, time, place)`` for what acts.

    It returns the power of what does work, minus the power of what makes heat, and the torque in
    the frame. Energy that effects have as a potential is no entry. At a pivot that moves,
    what potentials and heat take of the bearing's work is not in it (`Actors.carried`).
    """
    lines, at, power, torques = [], parameters.SCENE.size, {'work': [], 'heat': []}, []
    turning, pulling = [], []    # extra rates of the axes, torques of potentials
    imports = ['from rigid_body_sim.numerics.vectors import cross, dot, plus, scaled']
    for number, one in enumerate(acting):
        imports.append(imported(one.kernel, f'kernel_{number}'))
        values = ''.join(f'p[{at + k}], ' for k in range(len(one.values)))
        at += len(one.values)
        name = f'{one.gives}_{number}'
        field = ', time, *place' * one.in_field
        lines.append(f'    {name} = kernel_{number}({values}*q, *omega, *v{field})')
        if one.gives == 'turning':    # what keeps L = R m: the torque m x u, below
            turning.append((name, at - len(one.values)))
        elif one.gives == 'torque' and not one.inner:
            torques.append(name)
            if one.books == 'potential':
                pulling.append(name)
        if carried and one.gives == 'force':
            if one.books != 'work':
                power['work'].append(f'-dot({name}, v)')
            if one.books == 'heat':
                power['heat'].append(f'dot({name}, v)')
        elif one.books in power:
            power[one.books].append(f'dot({name}, {"v" if one.gives == "force" else "omega"})')
    # the axes turn with omega + u, and take the body through the potentials
    for name, first in turning:
        lines += [f'    {name} = plus({name}, scaled(p[{first}], {pull}))' for pull in pulling]
        if pulling:
            lines.append(f'    {name}_rate = {name}')
        power['heat'] += [f'-dot({pull}, {name}_rate)' for pull in pulling]
        lines.append(f'    {name} = cross(m, {name})')
    total = '(0.0, 0.0, 0.0)'
    for name in torques:
        total = name if total.startswith('(') else f'plus({total}, {name})'
    work = ' + '.join(power['work']) or '0.0'
    heat = f'-({" + ".join(power["heat"])})' if power['heat'] else '0.0'
    return '\n'.join([*imports, '', '', '@compiled', 'def acting(p, q, omega, v, m, time, place):',
                      *lines,
                      f'    return {work}, {heat}, {total}', ''])
