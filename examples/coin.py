# SPDX-License-Identifier: Apache-2.0
"""What a sweep keeps of a tossed coin: a function of the user's own (config/sweeps/coin.yaml)."""

G = 9.81


def landing(run):
    """Return when the coin is back at the height of the toss, and the cosine of its tilt then.

    Parameters
    ----------
    run : rigid_body_sim.sweeps.functions.Run

    Returns
    -------
    dict of str to float
        ``time`` of flight 2 u/g (s); ``side``: above 0 heads are up, below 0 tails.
    """
    time = 2.0 * run.values['initial.velocity.2'] / G
    [state] = run.at([time])
    x, y, _, _ = state.orientation
    return {'flight': time, 'side': 1.0 - 2.0 * (x * x + y * y)}
