# SPDX-License-Identifier: Apache-2.0
"""Commands as rows of doubles: one form from the topic to the body and to the recording.

The node takes rows from its topics, a simulation applies them, a recording keeps them. One array
holds the commands of a tick in their order.

====== ======= ==================================================================================
column name    meaning
====== ======= ==================================================================================
0      KIND    IMPULSE: force and torque are impulses (N s, N m s) and act once; HOLD: they are
               held (N, N m) until the next hold; RELEASE: what is held ends
1      AXES    of the components: WORLD, or BODY (they turn with the body while held)
2:5    FORCE   at the centre of mass
5:8    TORQUE
====== ======= ==================================================================================
"""

import numpy as np

from rigid_body_sim.errors import BadInput
from rigid_body_sim.scene.effects.wrench import Wrench

IMPULSE, HOLD, RELEASE = range(3)
TOPICS = ('cmd_impulse', 'cmd_wrench', 'release')
"""Name of each kind in the journal of a recording."""
NAMES = ('impulse', 'wrench', 'release')
"""Name of each kind in an error."""
WORLD, BODY = range(2)
FRAMES = ('world', 'body')

KIND, AXES, FORCE, TORQUE = 0, 1, slice(2, 5), slice(5, 8)
WIDTH = 8
ZERO = (0.0, 0.0, 0.0)
LET_GO = np.array([(RELEASE, WORLD, *ZERO, *ZERO)])


def row_of(kind: int, force, torque, frame: str) -> np.ndarray:
    """Return one command as an array of shape (1, 8).

    Parameters
    ----------
    kind : int
        IMPULSE or HOLD.
    force, torque : sequence of 3 floats
    frame : {'world', 'body'}

    Raises
    ------
    BadInput
        If these are not three numbers each, or the frame is unknown. The simulation decides
        whether a body can take the numbers (admission.py).
    """
    try:
        if isinstance(force, (set, dict)) or isinstance(torque, (set, dict)):
            raise TypeError    # in no order
        force, torque = tuple(map(float, force)), tuple(map(float, torque))
    except (TypeError, ValueError):
        raise not_three_numbers(kind, force, torque) from None
    if (len(force), len(torque)) != (3, 3):
        raise not_three_numbers(kind, force, torque)
    if frame not in FRAMES:
        raise BadInput(NAMES[kind], f'got frame {frame!r}', "'world' or 'body'")
    return np.array([(kind, FRAMES.index(frame), *force, *torque)])


def not_three_numbers(kind: int, force, torque) -> BadInput:
    """Return the error for a force and a torque that are not three finite numbers each."""
    return BadInput(
        NAMES[kind],
        f'got force {_shown(force)!r}, torque {_shown(torque)!r}',
        'three finite numbers each',
    )


def _shown(vector):
    return list(vector) if isinstance(vector, tuple) else vector


def wrench_of(row: np.ndarray) -> Wrench:
    """Return the Wrench that a row holds from its tick on: the zero wrench for a release."""
    force, torque = tuple(row[FORCE].tolist()), tuple(row[TORQUE].tolist())
    return Wrench(force, torque, FRAMES[int(row[AXES])]) if any(force + torque) else Wrench()


def rows_of(commands) -> np.ndarray:
    """Return the rows of commands as a journal has them: topic, frame, force, torque."""
    rows = [
        (TOPICS.index(one['topic']), FRAMES.index(one['frame']), *one['force'], *one['torque'])
        for one in commands
    ]
    return np.array(rows, dtype=float).reshape(-1, WIDTH)


def commands_of(rows: np.ndarray) -> list[dict]:
    """Return rows as the dicts that :func:`rows_of` takes."""
    return [
        {
            'topic': TOPICS[int(row[KIND])],
            'frame': FRAMES[int(row[AXES])],
            'force': row[FORCE],
            'torque': row[TORQUE],
        }
        for row in rows.tolist()
    ]
