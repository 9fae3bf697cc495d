# SPDX-License-Identifier: Apache-2.0
"""The phases of a body on a plane, and which one follows how the one before has ended.

The phases are in equations/contact_rates.py, the march through one is contact_phase.py's.
"""

import bisect
import math

import numpy as np

from rigid_body_sim.errors import NotConverged
from rigid_body_sim.integrators.equations.contact_impacts import velocity_of_lowest
from rigid_body_sim.integrators.equations.contact_rest import (
    IDEAL,
    comes_down,
    grip_patch,
    halt,
    hastens,
    is_clamped,
    lay,
    lies,
    lies_level,
    lies_low,
    rise,
    spins,
    tip,
    topple,
)
from rigid_body_sim.integrators.equations.contact_states import read
from rigid_body_sim.integrators.equations.contact_views import (
    CREEPING,
    FLIGHT,
    GLIDING,
    PIVOTING,
    RESTING,
    ROLLING,
    ROW,
    SLIDING,
    UNKNOWNS,
    WATCHED,
)
from rigid_body_sim.integrators.marching import contact_march
from rigid_body_sim.integrators.marching.contact_bounce import CHATTER, bounce
from rigid_body_sim.integrators.marching.contact_phase import Phase
from rigid_body_sim.integrators.marching.contact_rolling import DryRolling, is_held
from rigid_body_sim.integrators.marching.contact_scales import ROUNDING, Scales, length_of
from rigid_body_sim.mechanics.contact.parameters import CONTACT
from rigid_body_sim.numerics.functions import hypot, hypot3
from rigid_body_sim.scene.state import TIME as STATE_TIME

HOLDS = 1e-12            # share of the grip: so much beyond it is rounding
CANCELS = 2.0 ** -51     # share of the weight that the balance of the plane may leave
MOST_PHASES, AT_ONCE = 4000, 1e-6    # so many within that share of the time of a length: a fault
(MODE, SWIFT, CREEP, SIDE, LAG, WIDE, UNTIL, MU, INCLINED, MASS, STARTED, ONSET, RIM, LEVEL, DRY,
 VISCOUS, FILM, PATCH) = (CONTACT.part(name).first for name in (
     'mode', 'swift', 'creep', 'side', 'lag', 'wide', 'until', 'mu', 'inclined', 'mass', 'began',
     'onset', 'rim', 'level', 'rolling', 'rolling_viscous', 'film', 'patch'))
ORIGIN, SIZES, WAY = (CONTACT.part(name).places for name in ('origin', 'size', 'way'))
SIZE, GAP, TIME = UNKNOWNS.size, UNKNOWNS.part('gap').first, UNKNOWNS.part('time').first
OMEGA, U = (UNKNOWNS.part(name).places for name in ('omega', 'u'))
SLIP = slice(U.start, U.start + 2)    # the part of the unknown u along the plane
VELOCITY, FORCE = (ROW.part(name).places for name in ('velocity', 'force'))
NORMAL, GRIP, FIRMNESS, MOTION = (WATCHED.part(name).first for name in (
    'normal', 'grip', 'firmness', 'motion'))
BEGAN = {CREEPING: 'sliding began', ROLLING: 'rolling began', RESTING: 'rolling began',
         FLIGHT: 'lift-off'}
PARADOX = ("Painleve's paradox at t = {} s: no force at the contact can keep the body from "
           'sinking into the plane; a smaller mu does not meet it')
PULLS = ('at t = {} s ideal rolling needs a plane that pulls, since without friction the body '
         'would stay on it; a finite mu lets it slip')
LIFTS = ('at t = {} s viscous rolling friction or a film of air lifts the body, which falls back '
         'at once without it: its couple does not fall with the load, and here the load is 0; a '
         'smaller coefficient or dry rolling friction does not lift')
SLIDES = ('at t = {} s the body lies flat and goes on sliding or spinning on its face or rim, '
          'which is not solved: it may touch the plane at one point; more friction or a level '
          'plane lets it rest')
TIMED = ('at t = {} s the body lies flat under an effect that depends on time, which may move it '
         'again at a time that is not looked for; pieces in time are followed')
WIDEST = 3e-3            # time of a difference, over that in which a body moves by its length
NARROWEST = 1e-6
SLIP_ROUNDS = 2.0 ** -44 # share of the spin by which forces that cancel round the slip of a pivot
NARROWS = 0.125          # times it where the slip of a pivot changes faster,
SOON = 8                 # which then ends after so many steps
TURNS = 50               # corrections of the way in which a flat ring tips


class Succession:
    """The phases of a course so far, the first one from its start.

    Parameters
    ----------
    bound : contact.OnPlane
        The body and its rates.
    vector : array (14,)
        The start.
    accuracy, horizon : float
        rad and s.

    Attributes
    ----------
    begin : float
        The time of the start, s.
    phases : list of contact_phase.Phase
    begins : list of float
        Their times since the start, s.
    events : list of (time, name, values)
    over : float or None
        The time since the start at which no law of contact says how it goes on, s.
    why : str
        The reason.
    """

    def __init__(self, bound, vector, accuracy, horizon):
        self._bound, self.begin = bound, float(vector[STATE_TIME])
        self._tolerance = accuracy / horizon
        self._work = np.zeros(bound.work_shape)
        self.phases, self.begins, self._wide = [], [], WIDEST
        self.events, self.over, self.why = [], None, ''
        y = np.empty(SIZE)
        x, yy, height = read(bound.parameters(self.begin), vector, y)
        self._place = x, yy
        p = self._parameters(self.begin)
        length = length_of(p, bound.rates, y, self._work[0])
        self._scales = scales = Scales(length, bound.heaviness, accuracy)
        self._rolling = DryRolling(bound, scales, accuracy)
        slack = ROUNDING * (length + abs(height) + p[INCLINED] * hypot(x, yy))
        if y[GAP] > slack:
            self._open(FLIGHT, p, y)
            return
        rounding = scales.rounding(y)
        tip(p, y, rounding / length)
        ux, uy, normal = velocity = velocity_of_lowest(p, y)
        y[GAP] = 0.0
        if is_clamped(p, y, velocity, rounding):
            self._land(p, y, (ux, uy))
        elif normal > rounding:
            self._open(FLIGHT, p, y)
        elif normal < -rounding or (p[MU] > IDEAL and hypot(ux, uy) > rounding):
            self._impact(p, y)    # of a slip, too, that ideal rolling does not let be
        else:
            self._land(p, y, (ux, uy) if hypot(ux, uy) > rounding else (0.0, 0.0))

    def _parameters(self, time):
        """Return the parameters that hold just after a time (s), of this course."""
        p = self._bound.parameters(time)
        p[STARTED], p[ORIGIN] = self.begin, self._place
        return p

    def _open(self, mode, p, y, stopped=False, tipped=False, released=False):
        """Begin a phase; the last three are those of DryRolling.begin."""
        if mode == RESTING and self._bound.is_timed:
            self._end(y, TIMED)
            return
        time = self.begin + float(y[TIME])
        stopped = stopped or is_held(p)
        p = self._parameters(time)
        k = bisect.bisect_right(self._bound.breakpoints, time)
        later = self._bound.breakpoints[k:]
        p[UNTIL] = later[0] - self.begin if later else math.inf
        p[MODE], p[SWIFT] = mode, self._scales.speed(y)
        p[CREEP] = self._scales.creep * p[SWIFT]
        self._rolling.begin(p, y, stopped, tipped, released)
        if mode == FLIGHT and lies(p, y):
            p[LEVEL] = 1.0
            y[GAP] += rise(p, y)
        short = AT_ONCE * self._scales.length / p[SWIFT]
        if len(self.phases) >= MOST_PHASES and (
                float(y[TIME]) - self.phases[-MOST_PHASES].begin <= short):
            raise NotConverged(f'{self._bound.scene.name}: at t = {time!r} s phases of contact '
                               'follow each other without end', time)
        # no step is asked to resolve the rounding of forces that cancel
        tolerance = max(self._tolerance, CANCELS * self._scales.heaviness / p[SWIFT])
        p[LAG] = tolerance * self._scales.length
        noise = abs(spins(p, y)) * SLIP_ROUNDS / p[LAG]
        p[WIDE] = min(WIDEST, max(self._wide, noise)) * self._scales.length / p[SWIFT]
        if mode == PIVOTING:
            p[SIDE] = math.copysign(1.0, spins(p, y))
        self.phases.append(Phase(self._bound, p, y, tolerance, self._work, self._scales.length))
        self.begins.append(self.phases[-1].begin)

    def _land(self, p, y, u):
        """Begin the phase of contact with the slip u that the laws of contact say."""
        y[U] = *u, 0.0
        y[GAP] = 0.0
        mu, row, rates = p[MU], np.empty(ROW.size), self._bound.rates
        slides = u[0] != 0.0 or u[1] != 0.0 or (
            abs(spins(p, y)) > self._scales.rounding(y))
        p[MODE] = GLIDING if mu == 0.0 else SLIDING if slides and mu < IDEAL else ROLLING
        self._rolling.begin(p, y, is_held(p))
        slow = self._scales.rounding(y) / self._scales.length
        if lies_level(p, y, slow) and rates.load_of(p, y).normal > 0.0:
            self._lie(p, y, slow)
            return
        rates.rate(p, y, row)
        if not row[FIRMNESS] > 0.0:
            self._end(y)
            return
        if not row[NORMAL] > 0.0:
            if p[MODE] == ROLLING and mu < IDEAL and self._is_pressed(p, y):
                self._creep_off(p, y)
            else:
                self._fly(p, y)
            return
        if comes_down(p, y, row):
            p[MODE] = SLIDING
            self._rest(p, y, self.begin + float(y[TIME]))
            return
        mode = p[MODE]
        held = is_held(p) and not self._bound.is_disk
        if mode == ROLLING and (held or not (row[MOTION] > 0.0 or any(y[OMEGA]))) and (
                rates.stays(p, y)):
            halt(p, y)
            self._open(RESTING, p, y)
            return
        if mode == ROLLING and row[GRIP] < -HOLDS * mu * row[NORMAL]:
            self._creep_off(p, y)
            return
        self._open(mode, p, y)

    def _lie(self, p, y, slow):
        """Begin the phase of a ring that lies flat and does not tip faster than `slow` (rad/s).

        Friction at one point would turn a torus about its tube, or keep the spin of a ring.
        """
        slides, spins_on = any(y[SLIP]), abs(y[OMEGA][2]) > slow
        if p[MU] > 0.0 and (spins_on or (slides and not (
                p[MODE] == SLIDING and self._bound.is_disk))):
            p[MODE] = SLIDING
            self._rest(p, y, self.begin + float(y[TIME]))
        elif not slides and not spins_on and self._bound.rates.stays(p, y):
            halt(p, y)
            self._open(RESTING, p, y)
        else:
            self._give_way(p, y)

    def _give_way(self, p, y):
        """Let a ring that lies flat tip about its rim, or slide: the plane does not hold it."""
        load, radius, row = self._bound.rates.load_of(p, y), p[SIZES][0], np.empty(ROW.size)
        tilting, slack = hypot3(*load.tilting), ROUNDING * p[SIZES][0] * load.normal
        if tilting > radius * load.normal:
            x, z, _ = load.tilting
            self._topple(p, y, (-x, -z))
        elif tilting <= slack and (p[MU] == 0.0 or (
                self._bound.is_disk and abs(load.spinning) <= slack)):
            lay(p, y, load.normal)
        else:
            self._end(y, SLIDES)
            return
        self._rolling.begin(p, y, True)
        self._bound.rates.rate(p, y, row)
        if not row[NORMAL] > 0.0:
            self._fly(p, y)
        elif p[MODE] == ROLLING and row[GRIP] < -HOLDS * p[MU] * row[NORMAL]:
            self._creep_off(p, y)
        else:
            self._open(int(p[MODE]), p, y)

    def _topple(self, p, y, way):
        """Incline a ring that lies flat so that its lowest point is the one that goes down first.

        `way` is a first guess of how omega grows, body axes. Rolling friction has no part in it.
        """
        smooth, row = p.copy(), np.empty(ROW.size)
        smooth[DRY], smooth[RIM], smooth[ONSET], smooth[WAY] = 0.0, 0.0, 0.0, (1.0, 0.0)
        for _ in range(TURNS):
            topple(y, way)
            self._bound.rates.rate(smooth, y, row)
            (x, z), (a, b, _) = way, row[OMEGA].tolist()
            if abs(x * b - z * a) <= ROUNDING * hypot(x, z) * hypot(a, b):
                return
            way = a, b

    def _creep_off(self, p, y):
        """Let a slip begin, or end the course where no slip can: the contact does not stick."""
        y[SLIP] = 0.0, 0.0
        p[MODE], row = ROLLING, np.empty(ROW.size)
        self._bound.rates.rate(p, y, row)
        sticks = row[GRIP] >= -HOLDS * p[MU] * row[NORMAL]
        p[MODE] = CREEPING
        p[SWIFT] = self._scales.speed(y)
        p[CREEP] = self._scales.creep * p[SWIFT]
        self._rolling.begin(p, y, is_held(p))
        self._bound.rates.rate(p, y, row)
        # accelerations of the contact by forces, beside which that of the slip is rounding
        forced = max(1.0, row[FIRMNESS]) * p[SWIFT] * p[SWIFT] / self._scales.length
        if not row[FIRMNESS] > 0.0:
            self._end(y)
        elif not row[NORMAL] > 0.0:
            self._fly(p, y)
        elif row[SLIP][0] < -HOLDS * forced and not sticks:
            self._end(y)
        else:
            self._open(CREEPING, p, y)

    def _fly(self, p, y):
        """Begin a flight from a contact whose slip is in y."""
        row = np.empty(ROW.size)
        if p[MU] > IDEAL and self._is_pressed(p, y):
            # without friction the body would stay: ideal rolling would need a plane that pulls
            self._end(y, PULLS)
            return
        if self._is_lifted(p, y):
            self._end(y, LIFTS)
            return
        self._bound.rates.rate(p, y, row)
        y[U], y[GAP] = row[VELOCITY], 0.0
        self._open(FLIGHT, p, y)

    def _is_pressed(self, p, y):
        """Return whether the body would stay on the plane without friction."""
        smooth, row = p.copy(), np.empty(ROW.size)
        smooth[MODE] = GLIDING
        self._bound.rates.rate(smooth, y, row)
        return row[NORMAL] > 0.0

    def _is_at_paradox(self, p, y):
        """Return whether A of a slip has fallen to rounding, beside what it is without friction.

        Where the direction of the slip leads it there, A falls like the root of the time that is
        left, so that no double lies between it and 0.
        """
        if p[MODE] not in (SLIDING, CREEPING):
            return False
        row, smooth = np.empty((2, ROW.size))
        self._bound.rates.rate(p, y, row)
        alone = p.copy()
        alone[MODE] = GLIDING
        self._bound.rates.rate(alone, y, smooth)
        return row[FIRMNESS] <= ROUNDING * smooth[FIRMNESS]

    def _is_lifted(self, p, y):
        """Return whether rolling friction lifts a body that falls back without it."""
        if not p[VISCOUS] + p[FILM] > 0.0:
            return False
        last = self.phases[-1] if self.phases else None
        has_fallen = last is not None and last.p[MODE] == FLIGHT and (
            y[TIME] - last.begin <= AT_ONCE * self._scales.length / last.p[SWIFT])
        alone, row = p.copy(), np.empty(ROW.size)
        alone[VISCOUS], alone[FILM] = 0.0, 0.0
        self._bound.rates.rate(alone, y, row)
        return row[NORMAL] > (0.0 if has_fallen else HOLDS * p[MASS] * self._scales.heaviness)

    def _end(self, y, why=PARADOX, ahead=0.0):
        """End the course: no law of contact says how it goes on `ahead` (s) of what is known."""
        self.over = float(y[TIME])
        time = self.begin + (self.over + ahead)
        self.why = why.format(repr(time))
        self.events.append((time, 'end', {}))

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
        self.events.append((time, 'rest', {}))
        if lies(p, y) and not self._bound.rates.stays(p, y):
            p[MODE] = GLIDING if p[MU] == 0.0 else ROLLING
            self._give_way(p, y)
            return
        self._open(RESTING, p, y)

    def _impact(self, p, y):
        """Let the body bounce, or land where it rebounds no more."""
        found = bounce(p, y, self._scales)
        self.events.append((self.begin + float(y[TIME]), 'impact', {
            'normal_velocity': found.before, 'impulse': found.impulse}))
        if found.impulse < -CHATTER * self._scales.speed(y) * p[MASS]:
            self._end(y, PULLS)
        elif found.rebounds:
            self._open(FLIGHT, p, y)
        else:
            self._land(p, y, found.slip)

    def follow(self, phase):
        """Begin the phase that follows one that has ended.

        More than forty lines: each way in which a phase ends has its own sequel.
        """
        p, y, why = phase.p.copy(), phase.front[:SIZE].copy(), int(phase.status)
        time = self.begin + float(y[TIME])
        if p[LEVEL] > 0.0:
            y[GAP] -= rise(p, y)
            p[LEVEL] = 0.0
        if why == contact_march.SETTLED:
            self._open(PIVOTING, p, y)
            return
        if p[MODE] == PIVOTING:
            p[MODE] = SLIDING    # it is a slip, whose events are these
            soon = phase.steps <= SOON
            self._wide = max(NARROWS * self._wide, NARROWEST) if soon else WIDEST
            if why == contact_march.FASTER and p[SIDE] * spins(p, y) < 0.0:
                if self._spins_on(p, y):
                    self._open(PIVOTING, p, y)
                    return
                why = contact_march.STUCK
                grip_patch(p, y)
            elif why == contact_march.FAILED:
                why = contact_march.FASTER
        if why == contact_march.FAILED and self._rolling.goes_on_tipping(p, y):
            self._open(int(p[MODE]), p, y)
            return
        if why == contact_march.FAILED and lies_low(p, y) and (
                phase.kernels is not self._bound.kernels):
            self._open(int(p[MODE]), p, y)    # the series of a ring that is almost flat has a pole
            return
        if why == contact_march.FAILED and self._rolling.jams(p, y):
            self._rest(p, y, time)
            return
        if why == contact_march.FAILED and self._rolling.has_ended(p, y):
            why = contact_march.STOPPED
        if why in (contact_march.LOST_CONTACT, contact_march.PARADOX) and _died(p, y):
            why = contact_march.STUCK
        if why == contact_march.FAILED and self._is_at_paradox(p, y):
            why = contact_march.PARADOX
        if why == contact_march.FAILED:
            raise NotConverged(f'{self._bound.scene.name}: no step is small enough at '
                               f't = {time!r} s', time)
        if why == contact_march.PARADOX:
            self._end(y, ahead=phase.ahead)
            return
        if why == contact_march.TOUCHED:
            self._impact(p, y)
            return
        if why == contact_march.FASTER and p[MODE] == CREEPING and y[SLIP][0] <= 0.0:
            why = contact_march.STUCK    # the slip that began has died again
            grip_patch(p, y)
        if why == contact_march.LOST_CONTACT:
            self._fly(p, y)
            if self.over is None:
                self.events.append((time, 'lift-off', {}))
        elif why == contact_march.LET_GO:
            before = len(self.events)
            self._creep_off(p, y)
            self._tell(time, before, False)
        elif why == contact_march.STOPPED and p[MODE] != FLIGHT:
            self._stop(p, y, time)
        elif why == contact_march.HELD:
            self._open(int(p[MODE]), p, y, not p[ONSET] + p[RIM] > 0.0, p[RIM] > 0.0, is_held(p))
        elif why == contact_march.STUCK:
            before = len(self.events)
            self._land(p, y, (0.0, 0.0))
            self._tell(time, before, True)
            if self.phases[-1].p[MODE] == RESTING and self.events[-1][1] != 'rest':
                self.events.append((time, 'rest', {}))
        elif why == contact_march.FASTER:
            row = np.empty(ROW.size)
            self._bound.rates.rate(p, y, row)
            y[SLIP] = row[ROW.part('slip').places]
            self._open(SLIDING, p, y)
        elif why == contact_march.JUMP and p[MODE] == RESTING:
            self._wake(y, time)
        else:
            self._open(int(p[MODE]), p, y)

    def _tell(self, time, before, died):
        """Add the event of a contact that slips no more, or that friction holds no more.

        The phase that follows names it: a slip that has died may turn round. That is where a new
        one begins, except for a patch: its slip goes through 0 with its spin, and may do so in a
        phase that pivots, where nothing tells. Where friction bears nothing, the grip mu N ends
        with N, and the body lifts off.

        Parameters
        ----------
        before : int
            Number of the events that were before.
        died : bool
            Whether a slip has died.
        """
        p = self.phases[-1].p
        turns = died and p[MODE] == CREEPING and p[PATCH] > 0.0
        if self.over is None and p[MODE] in BEGAN and not turns:
            self.events.insert(before, (time, BEGAN[p[MODE]], {}))

    def _spins_on(self, p, y):
        """Return whether the spin of a patch that pivots goes on through 0: nothing stops it."""
        on, row = p.copy(), np.empty(ROW.size)
        on[MODE], on[SIDE] = PIVOTING, -p[SIDE]
        self._bound.rates.rate(on, y, row)
        return on[SIDE] * hastens(row, y) > 0.0

    def _wake(self, y, time):
        """Let a body stay at rest if it is held under what acts from now on, else let it move."""
        p = self._parameters(time)
        p[SWIFT] = self._scales.speed(y)
        self._land(p, y, (0.0, 0.0))

    def write(self, place, times, rows, out):
        """Fill rows of out with the states of a phase, given by its place, at times[rows] (s)."""
        self.phases[place].write(self._place, self.begin, times, rows, out)

    @property
    def allowed(self):
        """The (error, since) that dry rolling friction allows itself (DryRolling)."""
        return self._rolling.allowed

    @property
    def last(self):
        """The last time of which a course that has ended knows the state, s.

        A course that ends where it begins knows none: then it is that time.
        """
        time = self.begin + self.over
        while time - self.begin > self.over:
            time = math.nextafter(time, -math.inf)
        return time


def _died(p, y):
    """Return whether a slip has died: a step past its end reverses what is left of it.

    What the laws say of a slip the other way is then no event.
    """
    slip = hypot3(*y[SLIP].tolist(), spins(p, y))
    return p[MODE] == SLIDING and slip <= contact_march.DEAD * p[SWIFT]
