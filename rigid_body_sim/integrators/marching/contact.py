# SPDX-License-Identifier: Apache-2.0
"""A convex body on a plane, from phase to phase: flight, slip, roll, and the impacts between them.

The phases are in equations/contact_rates.py, the kernels that march through one in
contact_march.py. This module decides which phase follows an event.
"""

import bisect
import math

import numpy as np

from rigid_body_sim.compilation.templates import specialise
from rigid_body_sim.compilation.threads import look
from rigid_body_sim.errors import BadInput, NotConverged
from rigid_body_sim.integrators.equations import contact_rates, equations
from rigid_body_sim.integrators.equations.contact_impacts import (
    IMPACT,
    collide,
    load_impact,
    velocity_of_lowest,
)
from rigid_body_sim.integrators.equations.contact_rest import (
    about_tube,
    grows,
    halt,
    jams,
    lies,
    lies_low,
    pause,
    rise,
    rolls,
    spins,
    stays_flat,
    tip,
    tipping,
    withheld,
)
from rigid_body_sim.integrators.equations.contact_states import read
from rigid_body_sim.integrators.equations.contact_views import (
    CREEPING,
    FLIGHT,
    GLIDING,
    RESTING,
    ROLLING,
    ROW,
    SLIDING,
    UNKNOWNS,
    WATCHED,
)
from rigid_body_sim.integrators.marching import contact_march, contact_step, contact_zero
from rigid_body_sim.integrators.marching.work import Work
from rigid_body_sim.mechanics.contact.holding import way_out
from rigid_body_sim.mechanics.contact.numbers import contact_parameters, weight
from rigid_body_sim.mechanics.contact.parameters import CONTACT, HELD, SLOW, TIPS
from rigid_body_sim.mechanics.ledger import ENTRIES_SIZE, HEATS
from rigid_body_sim.numerics.functions import hypot, hypot3, power
from rigid_body_sim.numerics.rotations import normalised
from rigid_body_sim.scene.effects.wrench import Wrench
from rigid_body_sim.scene.state import STATE_SIZE
from rigid_body_sim.scene.state import TIME as STATE_TIME

ROUNDING = 2.0 ** -47    # of gap, slip and normal velocity, relative to lengths and speeds
CHATTER = 1e-13          # an impact rebounds no more below that share of the speeds
HOLDS = 1e-12            # share of the grip: so much beyond it is rounding
SHORT = 1e-6             # time of a difference, over that in which a body moves by its length
CREEPS = 1e-4            # share of the speeds, times the cube root of the accuracy
LARGEST_CREEP = 1e-7
CANCELS = 2.0 ** -51     # share of the weight that the balance of the plane may leave
EVENT = 256              # steps that cost as much as finding one event and what follows it
MOST_PHASES, AT_ONCE = 4000, 1e-6    # so many within that share of the time of a length: a fault
MOST_IMPACTS = 100       # of a ring that lies flat, at a time
MODE, SWIFT, CREEP, UNTIL, MU, INCLINED, DRY, RESTITUTION, MASS = (
    CONTACT.part(name).first for name in ('mode', 'swift', 'creep', 'until', 'mu', 'inclined',
                                          'rolling', 'restitution', 'mass'))
STARTED, ORIGIN = CONTACT.part('began').first, CONTACT.part('origin').places
WAY = CONTACT.part('way').places
ONSET, TURN, SINCE, RIM, LEVEL = (CONTACT.part(name).first for name in (
    'onset', 'turn', 'since', 'rim', 'level'))
SIZE, GAP, TIME = UNKNOWNS.size, UNKNOWNS.part('gap').first, UNKNOWNS.part('time').first
Q, OMEGA, U = (UNKNOWNS.part(name).places for name in ('q', 'omega', 'u'))
PACE = ROW.part('pace').first
VELOCITY, LEVER = ROW.part('velocity').places, ROW.part('lever').places
NORMAL, GRIP, FIRMNESS, MOTION, ROLLS = (WATCHED.part(name).first for name in (
    'normal', 'grip', 'firmness', 'motion', 'rolling'))
SLIP = slice(U.start, U.start + 2)    # the part of the unknown u along the plane
BEGAN = {contact_march.LET_GO: 'sliding began', contact_march.STUCK: 'rolling began'}
PARADOX = ("Painleve's paradox at t = {} s: no force at the contact can keep the body from "
           'sinking into the plane; a smaller mu does not meet it')
PULLS = ('at t = {} s ideal rolling needs a plane that pulls, since without friction the body '
         'would stay on it; a finite mu lets it slip')
SLIDES = ('at t = {} s the body lies flat and goes on sliding on its face or rim, which is not '
          'solved: it may touch the plane at one point; more friction or a level plane lets it '
          'rest')
IDEAL = 1e300            # a larger mu is infinite
ROWS = 4096              # states of one call of a kernel
FIRST = np.array([0])    # the only row


def march_of(rate, step):
    """Return contact_march.py bound to rates, 'module:rate', and to a module of steps."""
    zero = specialise(contact_zero, rate=rate, step_from=f'{step}:step_from').__name__
    return specialise(contact_march, rate=rate, step_from=f'{step}:step_from',
                      error_of=f'{step}:error_of', ORDER=f'from {step} import ORDER\n',
                      first_zero=f'{zero}:first_zero')


class OnPlane:
    """The kernels and the numbers of one scene and wrench.

    The wrench is always in the code, so that no command waits for a compilation.
    """

    KEEPS_ENTRIES = True

    def __init__(self, scene, method, wrench, step):
        if step is not None:
            raise BadInput('step', f'got {step!r} for a body on a plane',
                           'steps end where phases do: give an accuracy')
        self.scene = scene
        self._wrench = wrench or Wrench()
        self._actors = [effect for effect in scene.effects if effect.acting is not None]
        self._frame = scene.frame
        self.breakpoints = sorted({time for one in self._actors for time in one.breakpoints})
        acting = self._acting(-math.inf)
        if any(one.modes or one.gives == 'turning' for one in acting):
            raise BadInput(f'{scene.name}: effects', 'an expression with a kink, or an effect '
                           'that turns the axes, for a body on a plane',
                           'a smooth expression, numbers that hold, or pieces in time')
        if scene.contact.rolling > 0.0 and any(one.timed for one in acting):
            raise BadInput(f'{scene.name}: effects', 'an expression of time for a body on a plane '
                           'that dry rolling friction may bring to rest',
                           'pieces in time, or viscous rolling friction')
        source = equations.applied_source(acting, CONTACT.size)
        holds = f'HOLDS = {scene.contact.rolling > 0.0}\n'
        self.rates = specialise(contact_rates, applied=source, HOLDS=holds)
        rate = f'{self.rates.__name__}:rate'
        self.kernels = march_of(rate, specialise(contact_step, rate=rate).__name__)
        self.work_shape = contact_step.WORK_ROWS, ROW.size
        self._fixed, self._held = contact_parameters(scene), {}
        self.is_disk = scene.body.surface.kind == 'disk'
        self.is_torus = scene.body.surface.kind == 'torus'
        self.heaviness = max(weight(scene), 1e-3)

    def _acting(self, time):
        return [one for actor in [*self._actors, self._wrench]
                for one in actor.acting(self._frame, time)]

    def parameters(self, time):
        """Return the parameters that hold just after a time (s), an array of the caller's own."""
        k = bisect.bisect_right(self.breakpoints, time)
        if k not in self._held:
            values = [value for one in self._acting(time) for value in one.values]
            self._held[k] = np.concatenate((self._fixed, values))
        return self._held[k].copy()

    def kernels_of(self, mode, low=False):
        """Return the module that marches through a phase (contact_march.py).

        `low` says that the body is a ring that is almost flat.
        """
        return self.kernels

    def at(self, stepped):
        """Return the Bound of a solver that differs in its accuracy: this one."""
        return self

    def runner(self, stepped):
        """Return None: runs are those of a course."""

    def course(self, stepped):
        """Return the course of a started solver."""
        return PlaneCourse(stepped, self)


class PlaneCourse:
    """One course from a start."""

    TELLS_EVENTS = True

    def __init__(self, stepped, bound):
        self._bound, self._start = bound, np.array(stepped.vector)
        self._begin = float(self._start[STATE_TIME])
        self._error = stepped.accuracy
        self._tolerance = stepped.accuracy / stepped.horizon
        self._work = np.zeros(bound.work_shape)
        self._steps = Work(f'{stepped.method.NAME} on {bound.scene.name}', stepped.most,
                           comes_to_rest=True)
        self._phases, self._begins = [], []
        self._events, self._over, self._why = [], None, ''
        y = np.empty(SIZE)
        x, yy, height = read(bound.parameters(self._begin), self._start, y)
        self._place = x, yy
        p = self._parameters(self._begin)
        self._length = length = _length(p, bound.rates, y, self._work[0])
        self._heaviness = bound.heaviness
        speed = self._speed(y)
        self._creep = min(LARGEST_CREEP, CREEPS * power(stepped.accuracy, 1.0 / 3.0))
        slack = ROUNDING * (length + abs(height) + p[INCLINED] * hypot(x, yy))
        if y[GAP] > slack:
            self._open(FLIGHT, p, y)
            return
        rounding = ROUNDING * speed
        tip(p, y, rounding / length)
        ux, uy, normal = velocity_of_lowest(p, y)
        y[GAP] = 0.0
        if normal > rounding:
            self._open(FLIGHT, p, y)
        elif normal < -rounding or (p[MU] > IDEAL and hypot(ux, uy) > rounding):
            self._impact(p, y)    # of a slip, too, that ideal rolling does not let be
        else:
            self._land(p, y, (ux, uy) if hypot(ux, uy) > rounding else (0.0, 0.0))

    def _parameters(self, time):
        """Return the parameters that hold just after a time (s), of this course."""
        p = self._bound.parameters(time)
        p[STARTED], p[ORIGIN] = self._begin, self._place
        return p

    def _speed(self, y):
        """Return a speed beside which rounding is judged, m/s."""
        rate = hypot3(*y[OMEGA].tolist())
        return (hypot3(*y[U].tolist()) + rate * self._length
                + math.sqrt(self._heaviness * self._length))

    def _open(self, mode, p, y, stopped=False):
        """Begin a phase; `stopped` says that the body no longer rolls."""
        time = self._begin + float(y[TIME])
        stopped = stopped or _held(p)
        p = self._parameters(time)
        k = bisect.bisect_right(self._bound.breakpoints, time)
        later = self._bound.breakpoints[k:]
        p[UNTIL] = later[0] - self._begin if later else math.inf
        p[MODE], p[SWIFT] = mode, self._speed(y)
        p[CREEP] = self._creep * p[SWIFT]
        self._hold(p, y, stopped)
        if mode == FLIGHT and lies(p, y):
            p[LEVEL] = 1.0
            y[GAP] += rise(p, y)
        short = AT_ONCE * self._length / p[SWIFT]
        if len(self._phases) >= MOST_PHASES and (
                float(y[TIME]) - self._phases[-MOST_PHASES].begin <= short):
            raise NotConverged(f'{self._bound.scene.name}: at t = {time!r} s phases of contact '
                               'follow each other without end')
        # no step is asked to resolve the rounding of forces that cancel
        tolerance = max(self._tolerance, CANCELS * self._heaviness / p[SWIFT])
        self._phases.append(_Phase(self._bound, p, y, tolerance, self._work, self._length))
        self._begins.append(self._phases[-1].begin)

    def _hold(self, p, y, stopped):
        """Note whether dry rolling friction holds the body from here on, or which way it rolls.

        A rolling that ends does so at a time rounded to doubles: `stopped` says that what is left
        of it is rounding, however large.
        """
        p[WAY], p[ONSET], p[TURN], p[RIM] = (1.0, 0.0), 0.0, 0.0, 0.0
        if not p[DRY] > 0.0 or p[MODE] in (FLIGHT, RESTING):
            return
        p[SWIFT] = swift = self._speed(y)
        disk, torus, speed = self._bound.is_disk, self._bound.is_torus, rolls(p, y)
        if lies(p, y) and disk:
            # the lowest point runs along the rim of a flat disk at any speed that rounding gives
            stopped = stopped or abs(tipping(p, y)[1]) * self._length <= ROUNDING * swift
        if stopped or abs(speed) <= (ROUNDING if disk else 2.0 * SLOW) * swift:
            pause(p, y)
            p[WAY], row = HELD, np.empty(ROW.size)
            self._bound.rates.rate(p, y, row)
            if row[ROLLS] >= 0.0:
                return
            speed, across = withheld(p, y, row)
            if not disk and not (torus and self._tips(p, y, about_tube(p, y, speed, across))):
                self._begin_to_roll(p, y, speed, across)
        elif torus:
            self._tips(p, y, tipping(p, y)[0])
        if disk:
            p[WAY] = math.copysign(1.0, speed), 0.0

    def _tips(self, p, y, speed):
        """Note, and return, whether friction lets a low torus tip only; `speed` has its sign."""
        about, along = tipping(p, y)
        if abs(along) * self._length > ROUNDING * p[SWIFT] + self._error * abs(about):
            return False
        way, p[RIM] = tuple(p[WAY].tolist()), self._error
        p[WAY], row = (math.copysign(1.0, speed), 0.0), np.empty(ROW.size)
        pause(p, y)
        self._bound.rates.rate(p, y, row)
        if not row[ROLLS] > 0.0:
            p[WAY], p[RIM] = way, 0.0
        return p[RIM] > 0.0

    def _goes_on_tipping(self, p, y):
        """Return whether a torus whose friction along the ring no step follows tips only."""
        if not p[DRY] > 0.0 or not self._bound.is_torus or p[RIM] > 0.0:
            return False
        self._error = max(self._error, TIPS)
        return self._tips(p, y, tipping(p, y)[0])

    def _begin_to_roll(self, p, y, x, z):
        """Set the way in which a body begins to roll that a force (x, z) would hold.

        How it turns is a finite difference.
        """
        p[ONSET], p[SINCE] = self._creep * p[SWIFT], y[TIME]

        def way_from(y, x, z):
            return way_out(lambda x, z: self._growth(p, y, x, z), x, z)

        x, z = way = way_from(y, x, z)
        row = np.empty(ROW.size)
        p[WAY] = way
        self._bound.rates.rate(p, y, row)
        short = SHORT * self._length / p[SWIFT]
        later = y + short / row[PACE] * row[:SIZE]
        later[Q] = normalised(*later[Q].tolist())
        a, b = way_from(later, x, z)
        p[WAY], p[TURN] = way, (x * b - z * a) / short

    def _growth(self, p, y, x, z):
        """Return how a rolling grows from 0 under the friction against a direction."""
        p[WAY], row = (x, z), np.empty(ROW.size)
        self._bound.rates.rate(p, y, row)
        return grows(p, y, row)

    def _land(self, p, y, u):
        """Begin the phase of contact with the slip u that the laws of contact say."""
        y[U] = *u, 0.0
        y[GAP] = 0.0
        mu, row, rates = p[MU], np.empty(ROW.size), self._bound.rates
        slides = u[0] != 0.0 or u[1] != 0.0 or spins(p, y) > ROUNDING * self._speed(y)
        p[MODE] = GLIDING if mu == 0.0 else SLIDING if slides and mu < IDEAL else ROLLING
        self._hold(p, y, _held(p))
        rates.rate(p, y, row)
        if not row[FIRMNESS] > 0.0:
            self._end(y)
            return
        if not row[NORMAL] > 0.0:
            self._fly(p, y)
            return
        if stays_flat(p, y, row, ROUNDING * self._speed(y) / self._length):
            p[MODE] = SLIDING
            self._rest(p, y, self._begin + float(y[TIME]))
            return
        mode = p[MODE]
        held = _held(p) and not self._bound.is_disk
        if mode == ROLLING and (held or not (row[MOTION] > 0.0 or any(y[OMEGA]))) and (
                rates.stays(p, y)):
            halt(p, y)
            self._open(RESTING, p, y)
            return
        if mode == ROLLING and row[GRIP] < -HOLDS * mu * row[NORMAL]:
            self._creep_off(p, y)
            return
        self._open(mode, p, y)

    def _creep_off(self, p, y):
        y[SLIP] = 0.0, 0.0
        p[MODE], row = CREEPING, np.empty(ROW.size)
        p[SWIFT] = self._speed(y)
        p[CREEP] = self._creep * p[SWIFT]
        self._hold(p, y, _held(p))
        self._bound.rates.rate(p, y, row)
        if not row[FIRMNESS] > 0.0:
            self._end(y)
        elif not row[NORMAL] > 0.0:
            self._fly(p, y)
        else:
            self._open(CREEPING, p, y)

    def _fly(self, p, y):
        """Begin a flight from a contact whose slip is in y."""
        row = np.empty(ROW.size)
        if p[MU] > IDEAL:
            # without friction the body would stay: ideal rolling would need a plane that pulls
            p[MODE] = GLIDING
            self._bound.rates.rate(p, y, row)
            if row[NORMAL] > 0.0:
                self._end(y, PULLS)
                return
            p[MODE] = ROLLING
        self._bound.rates.rate(p, y, row)
        y[U], y[GAP] = row[VELOCITY], 0.0
        self._open(FLIGHT, p, y)

    def _end(self, y, why=PARADOX):
        """End the course: no law of contact says how it goes on."""
        self._over, self._why = float(y[TIME]), why
        self._events.append((self._begin + self._over, 'end', {}))

    def _stop(self, p, y, time):
        """Let a body rest that lies flat or is held by friction, else let it roll on."""
        p[RIM] = 0.0
        if lies(p, y) or (p[MODE] == ROLLING and self._bound.rates.stays(p, y)):
            self._rest(p, y, time)
        else:
            self._open(int(p[MODE]), p, y, stopped=True)

    def _rest(self, p, y, time):
        """Let a body rest, or end the course of one that lies flat and slides on."""
        if self._bound.rates.slides_on(p, y):
            self._end(y, SLIDES)
            return
        halt(p, y)
        self._events.append((time, 'rest', {}))
        self._open(RESTING, p, y)

    def _impact(self, p, y):
        """Let the body bounce, or land where it rebounds no more."""
        impact, rebounds = self._bounce(p, y, p[RESTITUTION])
        given, slip = impact.impulse, impact.slip
        for _ in range(MOST_IMPACTS):
            # a ring that lies flat turns about another axis from now on: another point goes down
            rounding = ROUNDING * self._speed(y)
            if given < 0.0 or not lies(p, y):
                break
            tips = tip(p, y, rounding / self._length)
            ux, uy, normal = velocity_of_lowest(p, y)
            slides = hypot(ux, uy) > rounding
            sticks = slip == (0.0, 0.0) and not rebounds and p[MU] > 0.0
            if not tips or (normal >= -rounding and not (sticks and slides)):
                rebounds = rebounds and normal > rounding
                slip = (ux, uy) if slides else (0.0, 0.0)
                break
            again, rebounds = self._bounce(p, y, 0.0)
            given, slip = given + again.impulse, again.slip
        self._events.append((self._begin + float(y[TIME]), 'impact', {
            'normal_velocity': impact.before, 'impulse': given}))
        if given < -CHATTER * self._speed(y) * p[MASS]:
            self._end(y, PULLS)
            return
        if rebounds:
            self._open(FLIGHT, p, y)
        else:
            self._land(p, y, slip)

    def _bounce(self, p, y, restitution):
        """Change the unknowns by an impact; return the Impact, and whether the body rebounds."""
        out = np.empty(IMPACT.size)
        trial = y.copy()
        collide(p, trial, restitution, out)
        rebounds = load_impact(out).after > CHATTER * self._speed(y)
        if not rebounds:
            trial = y.copy()
            collide(p, trial, 0.0, out)
        y[:] = trial
        y[GAP] = 0.0
        return load_impact(out.tolist()), rebounds

    def _follow(self, phase):
        """Begin the phase that follows one that has ended.

        More than forty lines: each way in which a phase ends has its own sequel.
        """
        p, y, why = phase.p.copy(), phase.front[:SIZE].copy(), int(phase.status)
        time = self._begin + float(y[TIME])
        if p[LEVEL] > 0.0:
            y[GAP] -= rise(p, y)
            p[LEVEL] = 0.0
        if why == contact_march.FAILED and self._goes_on_tipping(p, y):
            self._open(int(p[MODE]), p, y)
            return
        if why == contact_march.FAILED and lies_low(p, y) and (
                phase.kernels is not self._bound.kernels):
            self._open(int(p[MODE]), p, y)    # the series of a ring that is almost flat has a pole
            return
        if why == contact_march.FAILED and jams(p, y):
            self._rest(p, y, time)
            return
        if why in (contact_march.LOST_CONTACT, contact_march.PARADOX) and _died(p, y):
            why = contact_march.STUCK
        if why == contact_march.FAILED:
            raise NotConverged(f'{self._bound.scene.name}: no step is small enough at '
                               f't = {time!r} s')
        if why == contact_march.PARADOX:
            self._end(y)
            return
        if why == contact_march.TOUCHED:
            self._impact(p, y)
            return
        if why == contact_march.FASTER and y[SLIP][0] < 0.5 * p[CREEP]:
            why = contact_march.STUCK    # the slip that began has died again
        if why in BEGAN:
            self._events.append((time, BEGAN[why], {}))
        if why == contact_march.LOST_CONTACT:
            self._fly(p, y)
            if self._over is None:
                self._events.append((time, 'lift-off', {}))
        elif why == contact_march.LET_GO:
            self._creep_off(p, y)
        elif why == contact_march.STOPPED and p[MODE] != FLIGHT:
            self._stop(p, y, time)
        elif why == contact_march.HELD:
            self._open(int(p[MODE]), p, y, stopped=not p[ONSET] + p[RIM] > 0.0)
        elif why == contact_march.STUCK:
            self._land(p, y, (0.0, 0.0))
            if self._phases[-1].p[MODE] == RESTING and self._events[-1][1] != 'rest':
                self._events.append((time, 'rest', {}))
        elif why == contact_march.FASTER:
            row = np.empty(ROW.size)
            self._bound.rates.rate(p, y, row)
            y[SLIP] = row[ROW.part('slip').places]
            self._open(SLIDING, p, y)
        elif why == contact_march.JUMP and p[MODE] == RESTING:
            self._wake(y, time)
        else:
            self._open(int(p[MODE]), p, y)

    def _wake(self, y, time):
        """Let a body stay at rest if it is held under what acts from now on, else let it move."""
        p = self._parameters(time)
        p[SWIFT] = self._speed(y)
        self._land(p, y, (0.0, 0.0))

    def reach(self, elapsed):
        """March until the time since the start is passed."""
        while self._over is None and self._phases[-1].reach(elapsed, self._steps):
            self._steps.count(EVENT, float(self._phases[-1].front[TIME]), elapsed)
            self._follow(self._phases[-1])
        if self._over is not None and (elapsed > self._over or not self._phases):
            raise NotConverged(f'{self._bound.scene.name}: '
                               + self._why.format(repr(self._begin + self._over)))

    def state(self, time, out):
        """Fill `out` with the state at a time not before the start.

        Columns from 14 on, where `out` has them, get the entries of the ledger, and after them
        the heat by its cause (ledger.HEATS).
        """
        elapsed = time - self._begin
        self.reach(elapsed)
        phase = self._phases[bisect.bisect_right(self._begins, elapsed) - 1]
        phase.write(self._place, self._begin, np.array([time]), FIRST, out[np.newaxis])

    def entries(self, time):
        """Return the ledger's entries from the start to a time, and the HEATS after them."""
        row = np.empty(STATE_SIZE + ENTRIES_SIZE + len(HEATS))
        self.state(time, row)
        return row[STATE_SIZE:]

    def states(self, times, out):
        """Fill the rows of `out` as `state` does, for times not before the start."""
        times = np.ascontiguousarray(times)
        order = np.argsort(times, kind='stable')
        elapsed, done = times[order] - self._begin, 0
        self.reach(float(elapsed[-1]))
        while done < len(order):
            look()
            k = bisect.bisect_right(self._begins, elapsed[done])
            end = min(len(order), done + ROWS)
            if k < len(self._begins):
                end = min(end, int(np.searchsorted(elapsed, self._begins[k])))
            self._phases[k - 1].write(self._place, self._begin, times, order[done:end], out)
            done = end

    def events(self, after, until):
        """Return the (time, name, values) after one time (s) and up to another."""
        try:
            self.reach(until - self._begin)
        except NotConverged:
            if self._over is None:
                raise
        return [event for event in self._events if after < event[0] <= until]


class _Phase:
    """One phase, from an event to the next.

    Attributes
    ----------
    begin : float
        Time since the start of the course, s.
    kernels : module
        contact_march.py as it is bound.
    front : array
        The last point of the march, and where the phase ended.
    """

    def __init__(self, bound, p, y, tolerance, work, length):
        self.kernels = bound.kernels_of(int(p[MODE]), lies_low(p, y))
        self.p, self._work = p, work
        self.begin = float(y[TIME])
        self._meta = np.zeros(contact_march.META)
        self._meta[contact_march.TOLERANCE] = tolerance
        speed = float(p[SWIFT])
        self._meta[contact_march.SPEED], self._meta[contact_march.LENGTH] = speed, length
        self._meta[contact_march.RATE] = speed / length
        self.front = np.zeros(contact_march.POINT)
        self._store, self._sizes = np.empty((8, contact_march.POINT)), np.empty(64)
        self._cursor, self._y = np.empty((2, contact_march.POINT)), np.empty(SIZE)
        bound.rates.rate(p, y, work[0])
        self.kernels.begin(p, work[0], self.front, self._meta, y)

    @property
    def status(self):
        """Why the phase ended; RUNNING if it did not yet."""
        return self._meta[contact_march.STATUS]

    def reach(self, elapsed, work):
        """March until the time is passed or the phase ends; return whether it ends before.

        Parameters
        ----------
        elapsed : float
            s.
        work : Work
            Bounds the steps.

        Raises
        ------
        TooMuchWork
        """
        meta = self._meta

        def arrived():
            return (meta[contact_march.STATUS] != contact_march.RUNNING
                    or self.front[TIME] > elapsed)

        if arrived():
            return self.front[TIME] <= elapsed

        def follow(limit):
            end = int(meta[contact_march.STEPS]) + limit
            if end > len(self._sizes):
                self._sizes = np.concatenate((self._sizes, np.empty(end)))
            while not arrived() and meta[contact_march.STEPS] < end:
                if meta[contact_march.STORED] == len(self._store) < contact_march.KEPT:
                    self._store = np.concatenate((self._store, np.empty_like(self._store)))
                self.kernels.march(self.p, self._work, self._store, self._sizes[:end],
                                   self.front, meta, elapsed)
            return arrived()

        before, steps = work.done, int(meta[contact_march.STEPS])
        work.go(follow, lambda: float(self.front[TIME]), elapsed)
        # `go` leaves out the last slice, whose size depends on the clock
        made = int(meta[contact_march.STEPS]) - steps - (work.done - before)
        work.count(made, float(self.front[TIME]), elapsed)
        return meta[contact_march.STATUS] != contact_march.RUNNING and self.front[TIME] <= elapsed

    def write(self, start, begin, times, order, out):
        """Fill rows of `out` with states at times that the march has passed (contact_march.py)."""
        self.kernels.states(self.p, self._work, self._store, self._sizes, self.front, self._meta,
                            self._cursor, self._y, start, begin, times, order, out)


def _held(p):
    """Return whether dry friction holds the rolling of a body."""
    return tuple(p[WAY].tolist()) == HELD


def _died(p, y):
    """Return whether a slip has died: a step past its end reverses what is left of it.

    What the laws say of a slip the other way is then no event.
    """
    slip = hypot3(*y[SLIP].tolist(), spins(p, y))
    return p[MODE] == SLIDING and slip <= contact_march.DEAD * p[SWIFT]


def _length(p, rates, y, row):
    """Return a length of the body: from its centre of mass to the plane, and its size, m."""
    rates.rate(p, y, row)
    lever = hypot3(*row[LEVER].tolist())
    return max(lever, max(map(abs, p[CONTACT.part('size').places])))
