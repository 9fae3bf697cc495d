# SPDX-License-Identifier: Apache-2.0
"""Check of the upright top (notes, "Sleeping top") on both sides of P_gamma^2 = 4 I1 M g l.

Above it a seed stays small; below it the top nods.
"""

import numpy as np
from scipy.optimize import brentq

from rigid_body_sim.errors import BadInput
from rigid_body_sim.study.scenes import instruments
from rigid_body_sim.study.scenes.heavy_top import Top
from rigid_body_sim.study.scenes.limits import limit
from rigid_body_sim.study.scenes.quantity import Quantity
from rigid_body_sim.theory import sleeping_top as theory

# seeds over the one that changes the frequency by 1e-7, for the limit of small seeds
SEEDS = (4.0, 2.0, 1.0)
SEED = 1e-6                         # rad/s across, if the scene has none
SIDES = (1.001, 0.999)              # P_gamma^2 over its threshold, for any spin of the scene


def check(run):
    """Yield the quantities at the scene's own spin, on both sides of the threshold, and at it."""
    top = Top(run)
    if top.beta > 1e-6:
        raise BadInput(
            run.scene.name, f'it starts at a tilt of {top.beta!r} rad',
            'needs an upright start, tilt 0')
    seed = float(np.hypot(*run.at(0.0).angular_velocity[:2])) or SEED
    threshold = theory.threshold(top.I1, top.Mgl)
    own = top.P_gamma / threshold
    ratios = [ratio for ratio in (round(own**2, 9), *SIDES) if abs(ratio - 1.0) > 1e-6]
    for ratio in dict.fromkeys(ratios):
        spin = (top.P_gamma / top.I3 if ratio == round(own**2, 9)
                else threshold * np.sqrt(ratio) / top.I3)
        stable = theory.is_stable(top.I3 * spin, top.I1, top.Mgl)
        yield from (_stable if stable else _falling)(run, top, float(spin), seed, ratio)
    yield from _at_the_threshold(run, top, threshold, seed)


def _stable(run, top, spin, seed, ratio):
    """Yield the effect of a seed above the threshold, where beta'' = -stiffness beta/I1.

    The quantities are the largest tilt and the rate of the swing.
    """
    rate = float(np.sqrt(theory.stiffness(top.I3 * spin, top.I1, top.Mgl) / top.I1))
    tilts, rates = [], []
    seeds = _seeds(rate, ratio)
    for one in seeds:
        upright = run.variant(_upright(one, spin))
        turn = upright.crossings(instruments.beta_rate, 0.2 / rate, 2.5 / rate, 20)[0]
        tilts.append(upright.read(instruments.beta, turn)[0] * rate / one)
        rates.append(0.5 * np.pi / turn / rate)
    where = f'at {ratio:.6g} of the threshold'
    longest = (run.variant(_upright(seed, spin)).read(
        instruments.beta, np.linspace(0.0, 100.0 / rate, 4001)).max())
    yield Quantity(f'the seed stays small {where}: largest tilt in {100.0 / rate:.0f} s',
                   seed / rate, longest, 1e-4, 'rad', bound=True)
    yield from limit(
        f'largest tilt seed/sqrt(stiffness/I1) {where}', 'the seed', seeds, tilts, 2, 0.05, 1e-9)
    yield from limit(
        f'rate of the swing sqrt(stiffness/I1) {where}', 'the seed', seeds, rates, 2, 0.05, 1e-9)


def _falling(run, top, spin, seed, ratio):
    """Yield the growth of a seed below the threshold, and how far the top nods.

    The growth is beta = seed sinh(rate t)/rate while beta^2 is far below 1e-3.
    """
    rate = float(theory.growth_rate(top.I3 * spin, top.I1, top.Mgl))
    nod = float(theory.nodding_tilt(top.I3 * spin, top.I1, top.Mgl))
    growth, tilts = [], []
    seeds = _seeds(rate, ratio)
    time = 1.5 / rate
    for one in (seed, *seeds):
        upright = run.variant(_upright(one, spin))
        early, late = upright.read(instruments.beta, [time, 2.0 * time])
        growth.append(np.arccosh(0.5 * late / early) / time / rate)
        guess = np.log(4.0 * nod * rate / one) / rate
        turn = upright.crossings(instruments.beta_rate, 0.5 * guess, 1.5 * guess, 400)[0]
        tilts.append(upright.read(instruments.beta, turn)[0] / nod)
    where = f'at {ratio:.6g} of the threshold'
    late = seed * np.sinh(3.0) / rate
    yield Quantity(f"growth rate {where}, the scene's seed", rate, growth[0] * rate,
                   late**2 / abs(1.0 - ratio), '1/s', detail=f'while beta^2 < {late**2:.1e}')
    yield from limit(f'growth rate {where}', 'the seed', seeds, growth[1:], 2, 0.05, 1e-9)
    yield Quantity(
        f"farthest tilt {where}, the scene's seed", nod, tilts[0] * nod,
        (seed / rate) ** 2 / abs(1.0 - ratio), 'rad', detail=f'{np.degrees(nod):.4f} degrees')
    if nod > 3.0:
        return      # it passes the lowest point for every seed
    yield from limit(f'farthest tilt {where}, cos(beta_max) = P_gamma^2/(2 I1 M g l) - 1',
                     'the seed', seeds, tilts[1:], 2, 0.05, 1e-9)


def _seeds(rate, ratio):
    """Return three seeds, rad/s.

    The quartic term of V_eff changes a swing of tilt seed/rate by about tilt^2/(4 |ratio - 1|).
    """
    return rate * np.sqrt(4.0 * abs(ratio - 1.0) * 1e-7) * np.array(SEEDS)


def _upright(seed, spin):
    """Return an upright start with a transverse seed, rad/s."""
    return {'initial.euler_zyz': [0.0, 0.0, 0.0], 'initial.angular_velocity': [seed, 0.0, spin]}


def _at_the_threshold(run, top, threshold, seed):
    """Yield that the threshold itself is stable: the quartic term of V_eff holds the seed."""
    spin = float(threshold / top.I3)
    upright = run.variant(_upright(seed, spin))
    # from V_eff = const + M g l beta^4/8: I1 seed^2/2 at the turning point
    expected = float((4.0 * top.I1 * seed**2 / top.Mgl) ** 0.25)
    exact = (brentq(lambda beta: theory.effective_potential(beta, threshold, top.I1, top.Mgl)
                    - top.Mgl - 0.5 * top.I1 * seed**2,
                    0.5 * expected, 2.0 * expected)
             if expected > 1e-2 else expected)
    turn = upright.crossings(
        instruments.beta_rate, 0.2 * expected / seed, 4.0 * expected / seed, 200)[0]
    yield Quantity(
        'farthest tilt at the threshold itself', exact, upright.read(instruments.beta, turn)[0],
        1e-3, 'rad', detail='by the quartic term alone')
