# SPDX-License-Identifier: Apache-2.0
"""A ball on a table in multiple precision: the reference for scenes with the constraint `table`.

While the ball slides, M v' = -mu M g e and I omega' = (-a z) x (-mu M g e), where e = u/|u| and
u = v + omega x (-a z) is the slip. u' = -mu g (1 + M a^2/I) e is along e, so e does not turn, v
and omega are linear in time until u vanishes, and constant from then on. The attitude is the
Taylor series of q' = omega(t) q / 2 (omega in world axes).
"""

from mpmath import mp, mpf

from rigid_body_sim.study.precision.inputs import cross, product, turned, turned_back, unit


class Ball:
    """The motion of one ball from its start, with the same methods as taylor.Turning."""

    def __init__(self, inputs, bits):
        self.bits, self.time = bits, 0.0
        self._given = inputs
        self._q, self._omega = inputs.orientation, turned(inputs.orientation, inputs.omega)
        self._v = inputs.velocity[:2]
        self._strikes = list(inputs.strikes)
        self._ratio = inputs.moments[0] / (inputs.mass * inputs.radius ** 2)
        self._now = mpf(0)

    def state(self):
        """Return the attitude of the body (unit quaternion) and omega in body axes, mpf."""
        return unit(self._q), turned_back(unit(self._q), self._omega)

    def go(self, time):
        """Go on to a time (s, a double); strikes at that time have acted."""
        with mp.workprec(self.bits + 64):
            while self._strikes and self._strikes[0][0] <= time:
                until, impulse, lever, height, _ = self._strikes.pop(0)
                self._until(mpf(until))
                self._strike(impulse, lever, height)
            self._until(mpf(time))
            self.time = time
            return self.state()

    def _strike(self, impulse, lever, height):
        given = self._given
        size = mp.sqrt(impulse[0] ** 2 + impulse[1] ** 2)
        lever = turned(unit(self._q), lever)
        if height:
            behind = mp.sqrt(given.radius ** 2 - height ** 2) / size
            lever = (-behind * impulse[0], -behind * impulse[1], height)
        self._v = tuple(v + j / given.mass for v, j in zip(self._v, impulse))
        self._omega = tuple(w + x / given.moments[0]
                            for w, x in zip(self._omega, cross(lever, impulse)))

    def _until(self, end):
        given, a = self._given, self._given.radius
        u = self._v[0] - a * self._omega[1], self._v[1] + a * self._omega[0]
        slip = mp.sqrt(u[0] ** 2 + u[1] ** 2)
        speed = (mp.sqrt(self._v[0] ** 2 + self._v[1] ** 2)
                 + a * mp.sqrt(self._omega[0] ** 2 + self._omega[1] ** 2))
        push = given.mu * given.g
        # inputs are doubles, so a slip below their rounding counts as zero
        if slip > 4e-16 * speed and push:
            e = u[0] / slip, u[1] / slip
            change = (-e[1] * push / (self._ratio * a), e[0] * push / (self._ratio * a), mpf(0))
            rolls = self._now + slip / (push * (1 + 1 / self._ratio))
            last = min(end, rolls)
            self._turn(last - self._now, change)
            self._v = tuple(v - push * x * (last - self._now) for v, x in zip(self._v, e))
            self._now = last
            if rolls <= end:
                self._v = a * self._omega[1], -a * self._omega[0]
        if end > self._now:
            self._turn(end - self._now, (mpf(0),) * 3)
            self._now = end

    def _turn(self, duration, change):
        """Turn the attitude for a duration while omega changes at a constant rate."""
        largest = mp.sqrt(mp.fsum((abs(w) + abs(c) * duration) ** 2
                                  for w, c in zip(self._omega, change)))
        count = int(largest * duration) + 1
        h = duration / count
        for _ in range(count):
            terms = [self._q]
            for n in range(self.bits // 2):
                first = product((*self._omega, mpf(0)), terms[n])
                second = product((*change, mpf(0)), terms[n - 1]) if n else (mpf(0),) * 4
                terms.append(tuple((x + y) / (2 * (n + 1)) for x, y in zip(first, second)))
                if (n > 8 and max(abs(x) for x in (*terms[-1], *terms[-2])) * h**n
                        < mpf(2) ** -self.bits):
                    break
            power, total = mpf(1), [mpf(0)] * 4
            for term in terms:
                total = [x + power * y for x, y in zip(total, term)]
                power *= h
            self._q = unit(total)
            self._omega = tuple(w + c * h for w, c in zip(self._omega, change))
