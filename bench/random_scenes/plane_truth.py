# SPDX-License-Identifier: Apache-2.0
"""The truth of a convex body on a plane: its phases, its impacts, and the events between them.

Within a phase the motion is smooth and goes by collocation (collocation.py); the phase ends where
one of its watches passes zero on the polynomial of a step. A slip that ends is followed until it
is rounding: steps get shorter with it. A slip that begins at 0 goes by Newton's method from the
directions along which it grows. Where the laws leave the sequel open, or doubles decide, the truth
says so and ends there (`Unknown`).
"""

import numpy as np

from random_scenes import collocation
from random_scenes.plane_directions import Unknown, away, parallel
from random_scenes.plane_laws import (
    FREE,
    HELD,
    MOVES,
    SLIDE,
    SMOOTH,
    STICK,
    Body,
    along,
    cross,
    dot,
    size_of,
    solved,
)
from random_scenes.wide import WIDE

LOOKS = 24                      # samples of a step, at which its watches are looked at
FLIGHT = 'flight', FREE
LOW, DAMPED = 2e-3, 3e-2        # rad: a ring so low is left alone; where its rolling has friction
NOTHING = 1e-15                 # share of the speeds below which a slip has ended
SAME = 1e-10                    # and of a start, which copies have moved a little
CHATTERS = 1e-13                # and below which no impact rebounds
HALVINGS = 70                   # of an interval, until its ends are neighbours
SHORTEST = 1e-20                # s
GRAZES = 1e-9                   # share of the lengths by which a minimum may miss its zero


class PlaneTruth:
    """The course of a body on a plane from the start of its scene.

    Parameters
    ----------
    scene : Scene
    read : dict
        The scene file.
    moved : array, optional
        By which share each unknown of the start (13) is changed.

    Attributes
    ----------
    events : list of (str, float)
        Names and times.
    known : float
        Until when the motion is known, s.
    why : str
        Why not any longer.
    impacts : list of (float, float)
        Times, and normal velocities as shares of the speeds.
    """

    def __init__(self, scene, read, moved=None):
        self.body = Body(scene, read)
        self.t, self.events, self.impacts = WIDE(0), [], []
        self.steps, self.known, self.why = [], np.inf, ''
        self.mode, self.d, self.rolling, self.way, self.left = FLIGHT, None, None, None, None
        self.y = self._start(scene.initial.vector, moved)
        self.next, self.part, self.stiff, self.ends = self._time(), WIDE(0.5), False, None
        self.struck = set()

    def _start(self, vector, moved):
        v = np.asarray(vector, dtype=float).astype(WIDE)
        body, start = self.body, np.concatenate((v[1:8], v[11:14], v[8:11]))
        if moved is not None:
            sizes = np.where(np.arange(13) < 4, WIDE(1), start)
            start = start + moved * sizes
        start[:4] /= np.sqrt((start[:4] ** 2).sum())
        y = start[None].copy()
        y[:, 4:7] = 0
        R, w = body.motion_of(y).R, start[4:7, None]
        y[:, 4:7] = along(R, (body.tensor * w[None]).sum(1)).T
        middle = along(R, body.center[:, None])
        y[:, 7:10] += along(R, cross(w, body.center[:, None])).T
        y[:, 10:] += middle.T
        self.touches_at_start = abs(float(body.gap(y)[0])) < 1e-9 * float(body.length)
        return y[0]

    # -- the course ---------------------------------------------------------------------------

    def run(self, end):
        """Go on to a time, or to where nothing is known."""
        end, body = WIDE(end), self.body
        try:
            self._strikes(WIDE(0))
            if self.touches_at_start:
                self._meet(told=False)
            while self.t < end:
                later = [WIDE(x) for x in body.jumps if self.t < WIDE(x) <= end]
                stop = min([*later, end])
                self._step(stop)
                if later and self.t == stop:
                    self._jump()
        except Unknown as error:
            self.known, self.why = float(self.t), str(error)

    def _jump(self):
        """Go on behind a jump of what acts."""
        self.body.since = self.t
        struck = self._strikes(self.t)
        if self.mode != FLIGHT and (struck or self.mode[0] == STICK or self.mode[1] == HELD):
            self._meet(told=False)

    def _strikes(self, time):
        body, struck = self.body, False
        for number, one in enumerate(body.strikes):
            if number in self.struck or WIDE(one.get('time', 0.0)) != time:
                continue
            self.struck.add(number)
            struck = True
            at = body.motion_of(self.y[None])
            J = np.array(one['impulse'], dtype=float).astype(WIDE)[:, None]
            J = along(at.R, J) if one.get('frame') == 'body' else J
            point = np.array(one['point'], dtype=float).astype(WIDE) if 'point' in one else \
                body.center
            lever = along(at.R, (point - body.center)[:, None])
            self.y[4:7] += cross(lever, J)[:, 0]
            self.y[7:10] += J[:, 0] / body.mass
        return struck

    def states(self, times):
        """Return rows of unknowns at times that are known."""
        begins, rows = np.array([one.begin for one in self.steps], dtype=WIDE), []
        for time in times:
            one = self.steps[int(np.searchsorted(begins, WIDE(time), side='right')) - 1]
            rows.append(one.at((WIDE(time) - one.begin) / one.length)[0])
        return np.array(rows)

    def speed(self):
        """Return a speed beside which slips are judged, m/s."""
        at, body = self.body.motion_of(self.y[None]), self.body
        F, _ = body.free(at, self.y[None], np.array([self.t]))
        fall = np.sqrt(size_of(F)[0] / body.mass * body.length)
        return float(size_of(at.v)[0] + size_of(at.omega)[0] * body.length + fall)

    def _forced(self):
        """Return an acceleration beside which others are judged, m/s^2."""
        return WIDE(self.speed()) ** 2 / self.body.length

    def _sizes(self):
        at, body = self.body.motion_of(self.y[None]), self.body
        L = size_of(at.L)[0] + body.mass * body.length * WIDE(self.speed()) * WIDE(1e-6)
        v, far = WIDE(self.speed()), body.length
        return np.array([WIDE(1)] * 4 + [L] * 3 + [v] * 3 + [far] * 3, dtype=WIDE)

    def _rates(self):
        body, mode = self.body, self.mode
        if mode == FLIGHT:
            return body.rates
        way = self.way if body.is_disk else None
        return lambda y, t: body.touching(y, t, mode, None, way).rates

    def _by_ways(self, y, t, ways):
        """Return rates, and the rates of what slips and rolls, along directions given."""
        body, mode, ways = self.body, self.mode, list(ways)
        d = ways[0] if mode[0] == SLIDE else None
        rolls = mode[1] == MOVES and not body.is_disk
        way = ways[-1][0] * body.e1 + ways[-1][1] * body.e2 if rolls else self.way
        found = body.touching(y, t, mode, d, way)
        grows = [found.grows] if mode[0] == SLIDE else []
        if rolls:
            grows.append(body.rolling_grows(y, found.rates))
        return found.rates, grows

    def _directions(self):
        """Return the directions and sizes of what slips and rolls; those that begin are known."""
        body, ways, sizes = self.body, [], []
        at = body.motion_of(self.y[None])
        for moves, begins, v in ((self.mode[0] == SLIDE, self.d, body.slip(at)),
                                 (self.mode[1] == MOVES and not body.is_disk, self.rolling,
                                  body.rolls(at))):
            if moves:
                size = size_of(v)[0]
                ways.append(v[:, 0] / size if begins is None else begins)
                sizes.append(size if begins is None else (v[:, 0] * begins).sum())
        return ways, sizes

    def _step(self, stop):
        """Make one step, up to an event if there is one."""
        if self.mode != FLIGHT:
            self._low()
        sizes, left = self._sizes(), self._before_zero()
        if self.stiff or self.d is not None or self.rolling is not None:
            left = WIDE(np.inf)
        length = min(self.next, stop - self.t, self.part * left)
        with np.errstate(all='ignore'):
            made, ends = self._made(length, sizes)
        self.next = made.length * WIDE(1.3)
        if np.isfinite(left):
            self.part = min(WIDE(1), WIDE(1.3) * made.length / left)
        self._finish(made, stop, ends)

    def _made(self, length, sizes):
        """Return the longest Step up to a length that leaves out nothing, and directions."""
        begins = self.d is not None or self.rolling is not None
        stiff = begins or self.stiff
        while length > SHORTEST:
            if not stiff:
                made = collocation.step(self._rates(), self.t, self.y, length, sizes)
                if self._is_whole(made, sizes):
                    return made, None
            if self.mode[0] == SLIDE or (self.mode[1] == MOVES and not self.body.is_disk):
                ways = collocation.Ways(*self._directions())
                found = ways.step(self._by_ways, self.t, self.y, length, sizes)
                if found is not None and self._is_whole(found[0], sizes):
                    self.stiff = True
                    return found
            length = length / 2
        raise Unknown('no step is short enough')

    @staticmethod
    def _is_whole(made, sizes):
        return made is not None and (made.left_out() / sizes).max() < collocation.SMALL

    def _finish(self, made, stop, ends):
        """Keep a step up to its first event, and follow it."""
        self.ends = ends
        found = self._first(made)
        share, name = (WIDE(1), 'arrive') if found is None else found
        self._keep(made, share)
        whole = found is None and made.length == stop - made.begin
        self.t = stop if whole else made.begin + share * made.length
        self.d = self.rolling = None
        if found is None and ends is not None:
            if self.mode[0] == SLIDE:
                self.d = ends[0]
            if self.mode[1] == MOVES and not self.body.is_disk:
                self.rolling = ends[-1]
            self._loosens(made)
        getattr(self, '_' + name)()

    def _loosens(self, made):
        """Look whether slips are so fast that their directions need not be unknowns any more."""
        now = self._now(None, None)
        fast = np.inf
        _, sizes = self._directions()
        for size in sizes:
            fast = min(fast, size)
        weight = size_of(now.rates[:, 7:10].T)[0] + self._forced()
        if fast > 2 * weight * made.length:
            self.stiff, self.d, self.rolling = False, None, None

    def _keep(self, made, share):
        self.steps.append(made)
        self.y = made.at(share)[0]
        self.y[:4] /= np.sqrt((self.y[:4] ** 2).sum())

    def _low(self):
        body = self.body
        low = DAMPED if body.dry + body.viscous + body.film > 0 else LOW
        if body.shape in ('torus', 'disk') and body.inclination(self.y[None])[0] < low:
            raise Unknown('a low ring')

    def _before_zero(self):
        """Return how long a step may be before a slip or a rolling could end, s."""
        body, most = self.body, WIDE(np.inf)
        if self.mode == FLIGHT:
            return most
        at = body.motion_of(self.y[None])
        now = self._now(None if self.d is None else self.d[:, None])
        if self.mode[0] == SLIDE:
            most = min(most, _time_left(now.slip[:, 0], now.grows[:, 0]))
        if self.mode[1] == MOVES and not body.is_disk:
            grows = body.rolling_grows(self.y[None], now.rates)
            most = min(most, _time_left(body.rolls(at)[:, 0], grows[:, 0]))
        return most

    # -- watches ------------------------------------------------------------------------------

    def _watches(self, y, t):
        """Return what stays above 0 within a phase, by name: arrays (rows)."""
        body = self.body
        if self.mode == FLIGHT:
            return {'meet': body.gap(y) / body.length}
        found = body.touching(y, t, self.mode, None, self.way if body.is_disk else None)
        weight = body.mass * WIDE(self.speed()) ** 2 / body.length
        watched = {'leave': found.N / weight}
        if self.mode[0] == SLIDE:
            watched['paradox'] = found.A * body.mass
            watched['leave'] = watched['leave'] * np.sign(found.A)
        if self.mode[0] == STICK and np.isfinite(body.mu):
            watched['let_go'] = (body.mu * found.N - size_of(found.friction)) / weight
        if self.mode[1] == HELD:
            watched['roll_off'] = (body.dry * found.N - size_of(found.holds)) / (
                weight * body.length)
        at = body.motion_of(y)
        if self.ends is not None and self.mode[0] == SLIDE:    # it goes through 0 smoothly
            watched['stuck'] = (self.ends[0][:, None] * body.slip(at)).sum(0) / self.speed()
        if self.ends is not None and self.mode[1] == MOVES and not body.is_disk:
            watched['hold'] = (self.ends[-1][:, None] * body.rolls(at)).sum(0) / self.speed()
        if self.mode[1] == MOVES and body.is_disk:
            watched['hold'] = -self.way * body.rim_rate(body.motion_of(y)) * (
                body.length / WIDE(self.speed()))
        return watched

    def _first(self, made):
        """Return (share, name) of the first watch that passes zero within a step, or None."""
        shares = np.arange(1, LOOKS + 1, dtype=WIDE) / LOOKS
        with np.errstate(all='ignore'):
            seen, best = self._seen(made, shares), None
            for name, values in seen.items():
                where = self._bracket(made, name, shares, values)
                if where is None:
                    continue
                share = self._zero(made, name, *where)
                if best is None or share < best[0]:
                    best = share, name
        return best

    def _seen(self, made, shares):
        if self.mode == FLIGHT and made.begin == self.left:
            # the height of a low bounce would be rounding of the place: its rate is integrated
            y = made.at(collocation.C)
            rate = dot(self.body.n, self.body.motion_of(y).u)
            return {'meet': collocation.integral(rate, shares) * made.length / self.body.length}
        return self._watches(made.at(shares), made.begin + shares * made.length)

    def _bracket(self, made, name, shares, values):
        """Return shares between which a watch passes zero for the first time, or None."""
        low = np.flatnonzero(values <= 0)
        first = int(low[0]) if len(low) else len(values)
        for k in range(1, min(first, len(values) - 1)):
            if values[k] <= values[k - 1] and values[k] <= values[k + 1]:
                fine = np.linspace(shares[k - 1], shares[k + 1], 33, dtype=WIDE)
                inner = self._seen(made, fine)[name]
                if (inner <= 0).any():
                    j = int(np.flatnonzero(inner <= 0)[0])
                    return fine[j - 1], fine[j]
                if inner.min() < GRAZES and name not in ('stuck', 'hold'):
                    raise Unknown(f'a watch grazes zero: {name}')
        if first == len(values):
            return None
        return (shares[first - 1] if first else WIDE(0)), shares[first]

    def _zero(self, made, name, low, high):
        """Return the share at which a watch passes zero, by sections."""
        for _ in range(15):
            inner = np.linspace(low, high, 26, dtype=WIDE)
            values = self._seen(made, inner[1:-1])[name]
            bad = np.flatnonzero(values <= 0)
            k = int(bad[0]) + 1 if len(bad) else 25
            low, high = inner[k - 1], inner[k]
            if high - low <= WIDE(2e-19) * high:
                break
        return high

    # -- what follows an event ----------------------------------------------------------------

    def _tell(self, name):
        self.events.append((name, float(self.t)))

    def _arrive(self):
        """Look whether a slip or a rolling has ended at the end of a step."""
        body = self.body
        if self.mode == FLIGHT:
            return
        least, at = NOTHING * self.speed(), body.motion_of(self.y[None])
        if self.ends is not None:    # watches see the zero
            return
        if self.mode[0] == SLIDE and size_of(body.slip(at))[0] < least:
            self._stuck()
        elif self.mode[1] == MOVES and not body.is_disk and size_of(at.moved)[0] < least:
            self._hold()

    def _stuck(self):
        """Go on behind the end of a slip: friction holds, or the slip turns round."""
        now = self._now(None if self.ends is None else self.ends[0][:, None])
        left = _time_left(now.slip[:, 0], now.grows[:, 0])
        if self.ends is None and np.isfinite(left):
            self.y = self.y + left * now.rates[0]
            self.t = self.t + left
        before = len(self.events)
        self._land(slips=False)
        names = {STICK: 'rolling began', SLIDE: 'sliding began', 'flight': 'lift-off'}
        if self.mode[0] in names and not (self.mode[0] == SLIDE and self.body.rho > 0):
            self.events.insert(before, (names[self.mode[0]], float(self.t)))
        self._rests()

    def _hold(self):
        """Go on behind the end of a rolling: dry friction holds it, or it turns round."""
        self._land(slips=self.mode[0] == SLIDE, rolls=False)
        self._rests()

    def _rests(self):
        """Tell the event `rest` if all motion has ended."""
        if self.mode == FLIGHT:
            return
        at = self.body.motion_of(self.y[None])
        moving = float(size_of(at.v)[0] + size_of(at.omega)[0] * self.body.length)
        if self.mode[0] == STICK and moving < 1e-12 * self.speed():
            self._tell('rest')
            self.y[4:10] = 0

    def _meet(self, told=True):
        """Go on where the lowest point is on the plane: an impact, a flight, or a landing."""
        body = self.body
        at = body.motion_of(self.y[None])
        gap = dot(body.n, at.x + at.r)[0]
        self.y[10:] -= gap * body.n[:, 0]
        normal, speed = dot(body.n, at.u)[0], self.speed()
        ideal = not np.isfinite(body.mu)
        if self.touches_at_start and self.t == 0 and abs(normal) < SAME * speed:
            self.y[7:10] -= normal * body.n[:, 0]
            normal = 0 * normal
            slip = size_of(at.u - dot(body.n, at.u) * body.n)[0]
            if slip < SAME * speed:    # it rolls
                self.y[7:10] -= (at.u[:, 0] - dot(body.n, at.u)[0] * body.n[:, 0])
        slip = size_of(body.motion_of(self.y[None]).u)[0]
        if normal > NOTHING * speed:
            self._fly()
        elif normal < -NOTHING * speed or (ideal and normal == 0 and slip > NOTHING * speed):
            self._low()
            self._impact(told)
        else:
            self._land(slips=slip > NOTHING * speed)

    def _impact(self, told):
        body, speed = self.body, self.speed()
        at = body.motion_of(self.y[None])
        axes = [body.e1, body.e2, body.n]
        turns = [cross(at.r, e + 0 * at.r) for e in axes]
        G = np.stack([np.stack([dot(e, f / body.mass + cross(body.spun(at, turn), at.r))
                                for e in axes]) for f, turn in zip(axes, turns, strict=True)],
                     axis=1)[:, :, 0]
        before = np.array([dot(e, at.u)[0] for e in axes], dtype=WIDE)
        if told:
            self.impacts.append((float(self.t), float(-before[2]) / speed))
            self._tell('impact')
        e = body.restitution if -before[2] * body.restitution > CHATTERS * speed else WIDE(0)
        given, sticks = self._impulse(G, before, e)
        if given @ (before + G @ given / 2) > 0:    # it would create energy
            e = self._bearable(G, before, e)
            e = e if -before[2] * e > CHATTERS * speed else WIDE(0)
            given, sticks = self._impulse(G, before, e)
        self.y[7:10] += sum(g * f[:, 0] for g, f in zip(given, axes, strict=True)) / body.mass
        self.y[4:7] += sum(g * turn[:, 0] for g, turn in zip(given, turns, strict=True))
        if e > 0:
            self._fly()
        else:
            self._land(slips=not sticks)

    def _bearable(self, G, before, e):
        """Return the largest restitution below e with which an impact creates no energy."""
        low, high = WIDE(0), e
        for _ in range(HALVINGS):
            middle = (low + high) / 2
            given, _ = self._impulse(G, before, middle)
            creates = given @ (before + G @ given / 2) > 0
            low, high = (low, middle) if creates else (middle, high)
        return low

    def _impulse(self, G, before, e):
        """Return the impulse of an impact (e1, e2, n), and whether P sticks."""
        mu, wanted = self.body.mu, -(before + np.array([0, 0, e * before[2]], dtype=WIDE))
        stuck = solved(G[:, :, None], wanted[:, None])[:, 0]
        if not np.isfinite(mu) and stuck[2] < 0:
            self._end('ideal rolling needs a plane that pulls')
        if not np.isfinite(mu) or np.sqrt(stuck[0] ** 2 + stuck[1] ** 2) <= mu * stuck[2]:
            return stuck, True
        if mu == 0:
            return np.array([0, 0, wanted[2] / G[2, 2]], dtype=WIDE), False

        def after(angles):
            push = np.stack([-mu * np.cos(angles), -mu * np.sin(angles), 1 + 0 * angles])
            A = G[2] @ push
            N = wanted[2] / A
            u = before[:2, None] + N * (G[:2] @ push)
            return N * push, u, A
        with np.errstate(all='ignore'):
            angle = parallel(lambda angles: after(angles)[1:])
        return after(np.array([angle]))[0][:, 0], False

    def _fly(self):
        self.mode, self.left, self.stiff = FLIGHT, self.t, False
        self.d = self.rolling = self.way = None
        self.next = self._time()
        at, h = self.body.motion_of(self.y[None]), WIDE(1e-6) * self._time()
        later = self.body.motion_of(self.y[None] + h * self.body.rates(
            self.y[None], np.array([self.t])))
        rate, grown = dot(self.body.n, at.u)[0], dot(self.body.n, later.u - at.u)[0] / h
        if grown < 0 < rate:
            self.next = min(self.next, -3 * rate / grown)

    def _time(self):
        """Return a time in which the body moves by a part of its length, s."""
        return WIDE(0.05) * self.body.length / WIDE(self.speed())

    def _leave(self):
        """Leave the plane, or end: N has fallen to 0."""
        body = self.body
        if self._presses(SMOOTH) and not np.isfinite(body.mu):
            self._end('ideal rolling needs a plane that pulls')
        if body.viscous + body.film > 0:
            kept = body.viscous, body.film
            body.viscous, body.film = WIDE(0), WIDE(0)
            N = body.touching(self.y[None], np.array([self.t]), self.mode, None, self.way).N[0]
            body.viscous, body.film = kept
            if body.mass * self._forced() * 1e-12 < N:
                self._end('viscous rolling friction lifts the body')
        self._tell('lift-off')
        self._fly()

    def _presses(self, how):
        found = self.body.touching(self.y[None], np.array([self.t]), (how, FREE))
        return found.N[0] > 0

    def _paradox(self):
        self._end("Painleve's paradox")

    def _end(self, why):
        self._tell('end')
        raise Unknown(f'end: {why}')

    def _let_go(self):
        """Go on where friction can hold the point of contact no more."""
        before = len(self.events)
        self._land(slips=False, holds=False)
        names = {STICK: 'rolling began', SLIDE: 'sliding began', 'flight': 'lift-off'}
        self.events.insert(before, (names[self.mode[0]], float(self.t)))

    def _roll_off(self):
        """Go on where dry friction can hold the rolling no more."""
        self._land(slips=self.mode[0] == SLIDE, rolls=False, keeps=False)

    def _land(self, slips, rolls=None, holds=True, keeps=True):
        """Begin a phase of contact.

        Parameters
        ----------
        slips, rolls : bool
            Whether P slips and s' is not 0; None finds out.
        holds, keeps : bool
            Whether friction may hold a slip, and a rolling.
        """
        body, mu = self.body, self.body.mu
        self.d, self.rolling, self.stiff = None, None, False
        self.next, self.part = self._time(), WIDE(0.5)
        at, speed = body.motion_of(self.y[None]), self.speed()
        self._low()
        if rolls is None:
            moved = body.rim_rate(at)[0] * body.length if body.is_disk else size_of(at.moved)[0]
            rolls = abs(moved) > 1e-14 * speed
        if body.rho > 0 and not slips:
            slips = abs(body.slip(at)[2, 0]) > 1e-14 * speed
        if not slips and mu > 0:
            self.y[7:10] -= at.u[:, 0]
        rolling = FREE if body.dry == 0 else MOVES if rolls else HELD
        self.way = None
        if rolling == MOVES and body.is_disk:
            self.way = -body.rim_sign(at)[0]
        slip = SMOOTH if mu == 0 else SLIDE if slips and np.isfinite(mu) else STICK
        self.mode = slip, rolling
        found = self._now()
        if slip == SLIDE and not found.A[0] > 0:
            self._paradox()
        if not found.N[0] > 0:
            if slip == STICK and np.isfinite(mu) and self._presses(SMOOTH):
                holds = False
            elif slip == STICK and not np.isfinite(mu) and self._presses(SMOOTH):
                self._end('ideal rolling needs a plane that pulls')
            else:
                self._fly()
                return
        held = rolling != HELD or (keeps and size_of(found.holds)[0] <= body.dry * found.N[0])
        stuck = slip != STICK or not np.isfinite(mu) or (
            holds and size_of(found.friction)[0] <= mu * found.N[0])
        if held and stuck:
            return
        if not held and not stuck:
            raise Unknown('a slip and a rolling begin at once')
        (self._slip_begins if held else self._roll_begins)(found)

    def _now(self, d=None, rolling=None):
        """Return Found of the present, along directions given or its own."""
        rolling = self.rolling if rolling is None else rolling
        way = self.way
        if rolling is not None:
            way = rolling[0] * self.body.e1 + rolling[1] * self.body.e2
        return self.body.touching(self.y[None], np.array([self.t]), self.mode, d, way)

    def _slip_begins(self, found):
        """Begin a slip along the direction in which it grows."""
        self.mode = SLIDE, self.mode[1]
        f = found.friction
        d = away(self._growth(self.y[None], np.array([self.t])), -f / size_of(f), len(f),
                  self._forced())
        self.d = d
        found = self._now(d[:, None])
        if not found.A[0] > 0:
            self._paradox()
        if not found.N[0] > 0:
            self._fly()
            return
        growth = (d * found.grows[:, 0]).sum()
        if growth < -1e-12 * self._forced():
            self._end('no slip grows')
        self._holds_on(found)

    def _holds_on(self, found):
        body = self.body
        if self.mode[1] == HELD and size_of(found.holds)[0] > body.dry * found.N[0] * (
                1 + WIDE(1e-12)):
            raise Unknown('a slip and a rolling begin at once')
        if self.mode[0] == STICK and np.isfinite(body.mu) and (
                size_of(found.friction)[0] > body.mu * found.N[0] * (1 + WIDE(1e-12))):
            raise Unknown('a slip and a rolling begin at once')

    def _growth(self, y, t):
        """Return a function of directions (n, rows) -> (rates of the slip, A > 0), for one row."""
        def growth(d):
            rows = d.shape[1]
            found = self.body.touching(np.tile(y, (rows, 1)), np.tile(t, rows), self.mode, d,
                                       self.way)
            return found.grows, np.where(found.A > 0, found.N, -1)
        return growth

    def _roll_begins(self, found):
        """Begin a rolling in the way in which it grows."""
        body = self.body
        h = found.holds
        self.mode = self.mode[0], MOVES
        if body.is_disk:
            # the force that would hold it is against s'
            self.way = -np.sign(h[0, 0])
        else:
            d = away(self._rolls(self.y[None], np.array([self.t])), -h / size_of(h), 2,
                      self._forced())
            self.rolling = d
        self._holds_on(self._now())

    def _rolls(self, y, t):
        """Return a function of ways (2, rows) -> (rates of s' along e1 and e2, N)."""
        body = self.body

        def growth(d):
            rows = d.shape[1]
            way = d[0] * body.e1 + d[1] * body.e2
            states = np.tile(y, (rows, 1))
            found = body.touching(states, np.tile(t, rows), self.mode, None, way)
            return body.rolling_grows(states, found.rates), found.N
        return growth


def _time_left(v, growth):
    """Return the time after which v is 0 if it falls on as it does, inf if it does not fall."""
    size = np.sqrt((v * v).sum())
    falls = -(v * growth).sum() / size if size > 0 else WIDE(0)
    return size / falls if falls > 0 else WIDE(np.inf)
