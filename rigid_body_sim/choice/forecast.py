# SPDX-License-Identifier: Apache-2.0
"""The expected error of a run: how errors go on in time, and until when an accuracy is met."""

import math
from typing import NamedTuple

import numpy as np

from rigid_body_sim.choice.comparison import grown, lengths
from rigid_body_sim.choice.measured import makes_heat
from rigid_body_sim.mechanics.bounds import (
    angles_turned,
    drive,
    drives,
    pushed_unbounded,
    unbounded,
)
from rigid_body_sim.numerics.functions import hypot3, log, power
from rigid_body_sim.numerics.rotations import rotate_back
from rigid_body_sim.numerics.vectors import dot
from rigid_body_sim.scene.state import ANGULAR_VELOCITY

POWERS = 1.0, 2.0        # of the angle that a body turns: those with which errors grow
TURNED = 1.5             # times an error: more only one that turned round adds, not one that grows
SLOWED = 0.5             # share of its largest rate that a body has left that has slowed down
STEADY = 2.0 ** -10      # share of the angular velocity: a body spins steadily where less changes
ROUNDING = 2.0 ** -40    # share of it below which changes are rounding
LEAST = 8                # looks that show a steady spin


class Forecast(NamedTuple):
    """The expected error of a run.

    Attributes
    ----------
    error : float
        Largest error of the attitude within the horizon, rad.
    met_until : float
        Time until which the accuracy asked is met, s: the horizon if it is met throughout, else
        the last time at which it was seen to be met.
    """

    error: float
    met_until: float


def missed(accuracy, horizon, expected, met_until):
    """Return one line that says that an accuracy is missed, and until when it is met; else None.

    Parameters
    ----------
    accuracy : float
        Asked for, rad.
    horizon : float
        s.
    expected : float or None
        Error within the horizon, rad, where it is known.
    met_until : float or None
        s, where it is known.
    """
    if expected is None or expected <= accuracy:
        return None
    until = ''
    if met_until is not None:
        until = (f'; it is met until {met_until:.3g} s' if met_until > 0.0
                 else '; it is met at no time')
    figures = (f'{expected:.{places}e}' for places in range(1, 18))
    shown = next(figure for figure in figures if not float(figure) <= accuracy)
    return (f'the accuracy asked, {accuracy:g} rad, is missed: the error expected within '
            f'{horizon:g} s is {shown} rad{until}')


def later(scene, states, errors, longer, beside=None):
    """Return the error (rad) at a time beyond a run, from its errors at looks.

    It grows in proportion to time, as the number of steps does, or to the angle that a body turns
    which heat slows. Where a drive makes a body turn ever faster, errors go with the angle that it
    turns, or with a power of it up to the square: then those of the momentum, which add up, turn
    the body. What the errors did in the second half of the run tells the power; where they went
    through 0 and grow the other way, by how much they grew there counts. Where heat has made a
    body spin steadily, the errors made until then stay, and grow only by what they grew in the
    second half.

    Parameters
    ----------
    states : array (n, 14)
        The run, at looks.
    errors : array (n,)
        rad.
    longer : float
        The later time over that of the run, at least 1.
    beside : array (n, 14), optional
        The run beside which these are the errors of the attitude.
    """
    last = float(errors.max())
    if longer == 1.0:
        return last
    if beside is not None and spins_steadily(scene, states):
        return last + 2.0 * (longer - 1.0) * grown(states, beside)
    faster, so_far = _spin_up(scene, states)
    if faster == 0.0 or not 0.0 < last < math.inf:
        return last * turned_later(scene, states, longer)
    first = float(errors[:len(errors) // 2].max())
    grew = log(last / first) / log(so_far) if first > 0.0 else POWERS[1]
    angle = longer * (1.0 + faster * (longer - 1.0))
    if beside is not None:
        # in proportion to the angle, what the second half adds is a part of what is added in all
        added = grown(states, beside) * so_far / (so_far - 1.0)
        if added > TURNED * last:
            last = added
    return last * power(angle, min(max(grew, POWERS[0]), POWERS[1]))


def turned_later(scene, states, longer):
    """Return the angle that a body has turned by a later time over that at the end of a run.

    It grows in proportion to time, unless heat slows the body: then it goes on at the largest rate
    of the last quarter of the run. Where that is less than the one of the quarter before, and
    nothing keeps the body turning, each quarter of this length to come has the same share of the
    last.

    Parameters
    ----------
    states : array (n, 14)
        The run, at looks.
    longer : float
        The later time over that of the run, at least 1.
    """
    if longer == 1.0 or not makes_heat(scene):
        return longer
    rates = lengths(states[:, ANGULAR_VELOCITY])
    n = len(rates)
    before, last = float(rates[n // 2:3 * n // 4].max()), float(rates[3 * n // 4:].max())
    if not 0.0 < last < math.inf:
        return 1.0 if last == 0.0 else longer
    turned = np.empty(n)
    angles_turned(np.arange(1.0, n + 1.0), rates, math.inf, turned)
    yet = longer - 1.0
    if last < before and _comes_to_rest(scene):
        yet = min(yet, 0.25 * last / (before - last))
    # the first rate counts up to the first look, too
    return min(longer, 1.0 + yet * n * last / float(turned[-1] + rates[0]))


def has_slowed(scene, states):
    """Return whether heat slows a body to less than SLOWED of its largest rate in a run.

    Parameters
    ----------
    states : array (n, 14)
        The run, at looks.
    """
    if not makes_heat(scene):
        return False
    rates = lengths(states[:, ANGULAR_VELOCITY])
    first = hypot3(*scene.initial.angular_velocity.tolist())
    return float(rates[-1]) < SLOWED * max(first, float(rates.max()))


def spins_steadily(scene, states):
    """Return whether heat has made a body spin steadily in the second half of a run.

    Parameters
    ----------
    states : array (n, 14)
        The run, at looks.
    """
    return makes_heat(scene) and is_steady(scene, states[len(states) // 2 - 1:])


def is_steady(scene, states):
    """Return whether a body spins about an axis of its own and will go on to.

    Hardly anything changes of its angular velocity along its own axes, and no more in the second
    half than in the first. Inner heat leaves a body at the axis of its largest moment only.

    Parameters
    ----------
    states : array (n, 14)
        A part of a run, at looks.
    """
    rates = states[:, ANGULAR_VELOCITY]
    if len(rates) < LEAST:
        return False
    size, middle = float(lengths(rates[-1:])[0]), len(rates) // 2
    if not 0.0 < size < math.inf:
        return False
    whole, before, last = (float((part.max(axis=0) - part.min(axis=0)).max()) / size
                           for part in (rates, rates[:middle + 1], rates[middle:]))
    if not (whole <= STEADY and last <= max(before, ROUNDING)):
        return False
    return scene.inner_dissipation == 0.0 or _about_largest(scene, rates[-1])


def _about_largest(scene, omega):
    """Return whether a body spins about the axis of its largest moment, up to a share STEADY."""
    moments, spins = _along_axes(scene, omega)
    most = max(moments)
    off = [(1.0 - one / most) * spin for one, spin in zip(moments, spins, strict=True)]
    return hypot3(*off) <= STEADY * hypot3(*spins)


def _along_axes(scene, omega):
    """Return the principal moments (kg m^2) of a body, and its rates (rad/s) about their axes."""
    inertia = scene.constraint.inertia(scene.body)
    return inertia.moments, rotate_back(*inertia.axes, *omega.tolist())


def may_tumble(scene, states, yet):
    """Return whether inner heat may make a body tumble in a time to come that spins as yet.

    The body has the momentum L and the kinetic energy T = L^2/2I - d, I its least moment. It turns
    about the axis of I until T falls to L^2/2J, J the middle one; passing there magnifies errors.
    With x = 1/I for each axis, and p the share of L^2 along it, heat is

        d' = c L^4 var(x) <= c L^4 (max x - mean x)(mean x - min x) <= 2 c L^2 (max x - min x) d

    by Bhatia and Davis (Amer. Math. Monthly 107, 2000), since L^2 (max x - mean x) is 2 d.

    Parameters
    ----------
    states : array (n, 14)
        The run, at looks.
    yet : float
        s.
    """
    if scene.inner_dissipation == 0.0 or not np.isfinite(states[-1]).all():
        return False
    moments, spins = _along_axes(scene, states[-1, ANGULAR_VELOCITY])
    least, middle, most = sorted(moments)
    if least == 0.0:
        return False
    momenta = [one * spin for one, spin in zip(moments, spins, strict=True)]
    square = dot(momenta, momenta)
    below = 0.5 * dot(momenta, [(1.0 / least - 1.0 / one) * part
                                for one, part in zip(moments, momenta, strict=True)])
    passes = 0.5 * square * (1.0 / least - 1.0 / middle)
    if below > passes:    # it has passed already
        return False
    folds = 2.0 * scene.inner_dissipation * square * (1.0 / least - 1.0 / most) * yet
    return below > 0.0 and log(passes / below) <= folds


def _comes_to_rest(scene):
    """Return whether nothing pushes a body for ever; inner heat leaves it a rotation."""
    return (drives(scene)[-1][1] == 0.0 and not pushed_unbounded(scene)
            and scene.inner_dissipation == 0.0)


def _spin_up(scene, states):
    """Return how a drive makes a body turn faster.

    First the share of its last rate that a run adds, after the lesser growth of its last two
    quarters; then the factor by which rate times time, an angle, grew in its second half.
    """
    if drive(scene, None) == 0.0 and not unbounded(scene):
        return 0.0, 2.0
    rates = lengths(states[:, ANGULAR_VELOCITY])
    n = len(rates)
    half, quarter, last = (float(rates[:many].max()) for many in (n // 2, 3 * n // 4, n))
    if not 0.0 < half <= last < math.inf:
        return 0.0, 2.0
    return 4.0 * min(quarter - half, last - quarter) / last, 2.0 * last / half


def forecast(errors, times, accuracy, horizon, last=None):
    """Return the Forecast that follows from errors at times.

    Beyond the last of the times the error is taken to grow evenly.

    Parameters
    ----------
    errors, times : array (n,)
    accuracy : float
        rad.
    horizon : float
        s.
    last : float, optional
        The error at the horizon, rad; else it grows in proportion to time.
    """
    errors = np.maximum.accumulate(errors)
    seen, end = float(errors[-1]), float(times[-1])
    error = seen * max(1.0, horizon / end) if last is None else max(seen, last)
    if error <= accuracy:
        return Forecast(error, horizon)
    k = int(np.searchsorted(errors, accuracy, side='right'))    # errors[k] is too large
    if k == 0:    # in proportion to time before the first look
        return Forecast(error, float(times[0]) * accuracy / float(errors[0]))
    if k < len(errors):
        return Forecast(error, float(times[k - 1]))
    return Forecast(error, end + (horizon - end) * (accuracy - seen) / (error - seen))
