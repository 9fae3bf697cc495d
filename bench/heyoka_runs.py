# SPDX-License-Identifier: Apache-2.0
"""Runs of a heyoka object that stays, for the benches that time them."""


def runs_of(solver, start, duration, attitude_of):
    """Return act() and attitude() of a heyoka object.

    Parameters
    ----------
    solver : heyoka.taylor_adaptive
    start : array
        The unknowns at time 0.
    duration : float
        s.
    attitude_of : function
        Makes a quaternion of the unknowns.

    Returns
    -------
    act : function
        Run once.
    attitude : function
        Run once and return the final attitude.
    """
    def act():
        solver.time = 0.0
        solver.state[:] = start
        solver.propagate_until(duration)

    def attitude():
        act()
        return attitude_of(solver.state)
    return act, attitude
