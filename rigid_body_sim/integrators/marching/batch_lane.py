# SPDX-License-Identifier: Apache-2.0
"""The numbers of a body in a lane of a batch, as one view, and the rows where they stand.

batch_directions.py, batch_turning.py and batch_hinge.py say what the unknowns are and what the
equations take.
"""

from typing import NamedTuple

from rigid_body_sim.compilation.layout import Matrix, Quaternion, Vector, layout

ORDER, COARSE = 18, 14    # of the series; the latter for coarse tolerances
DIRECTIONS = 6    # components of two directions


class Unknowns(NamedTuple):
    """The unknowns of a body, or the coefficients of an order.

    The attitude is given by two directions of the world, seen in the body; a quaternion or one
    direction across a hinge takes fewer places, and the others stay 0.
    """

    attitude: tuple[(float,) * DIRECTIONS]
    omega: Vector


class Point(NamedTuple):
    """A point of the march of a lane."""

    time: float      # s
    step: float      # that led here, s
    scale: float     # squared, of omega, (rad/s)^2
    lost: Unknowns   # by the sums
    q: Quaternion
    y: Unknowns


class Before(NamedTuple):
    """What `between` takes of the point before."""

    time: float
    q: Quaternion
    y: Unknowns


class Attitude(NamedTuple):
    """What `between` finds."""

    q: Quaternion
    omega: Vector


class Numbers(NamedTuple):
    """The numbers of the equations (batch.py)."""

    euler: Vector
    constant: Vector
    u: Matrix
    v: Vector
    drag: Matrix


class Lane(NamedTuple):
    """All numbers of a lane: they stand in a column, one in each row of eight."""

    point: Point
    series: tuple[(Unknowns,) * ORDER]      # coefficients of the higher orders
    before: Before                          # the point before
    end: float                              # time where the march ends, s
    sound: float                            # squared norm of the unknowns there
    since: float                            # time since the point that `between` takes, s
    found: Attitude                         # what `between` finds
    numbers: Numbers
    inverses: tuple[(float,) * ORDER]       # 1/k for k = 1 ... ORDER


UNKNOWN, POINT, LANE = layout(Unknowns), layout(Point), layout(Lane)
UNKNOWNS = UNKNOWN.size
OMEGA = UNKNOWN.part('omega').first    # the first of its components

# of each sum in omega' the two components of omega whose products it takes
GYROSCOPIC = [(OMEGA + (i + 1) % 3, OMEGA + (i + 2) % 3) for i in range(3)]

# rows; those of the coefficients follow those of the unknowns, which are order 0
TIME, STEP, SCALE, LOST, QUATERNION, SERIES = (POINT.part(name).first for name in Point._fields)
BEFORE_TIME, BEFORE_Q, BEFORE_SERIES = (LANE.part('before').part(name).first
                                        for name in Before._fields)
END, SOUND, SINCE, FOUND, INVERSES = (
    LANE.part(name).first for name in ('end', 'sound', 'since', 'found', 'inverses'))
EULER, CONSTANT, U, V, DRAG = (LANE.part('numbers').part(name).first for name in Numbers._fields)
ROWS = LANE.size
