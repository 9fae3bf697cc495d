"""Commands as rows of doubles: what a node takes, a simulation applies and a recording keeps; one array holds all of a tick, in their order.

====== ======= ===================================================================================================================
column name    meaning
====== ======= ===================================================================================================================
0      KIND    IMPULSE: force and torque are impulses (N s, N m s), and act once; HOLD: they are held (N, N m) until the next hold;
               RELEASE: the held ones end
1      AXES    of the components: WORLD, or BODY (they turn with the body while held)
2:5    FORCE   at the centre of mass
5:8    TORQUE
====== ======= ===================================================================================================================
"""

import numpy as np

IMPULSE, HOLD, RELEASE = range(3)
TOPICS = ('cmd_impulse', 'cmd_wrench', 'release')
"""Of each kind, as the journal of a recording names it."""
WORLD, BODY = range(2)
FRAMES = ('world', 'body')

KIND, AXES, FORCE, TORQUE = 0, 1, slice(2, 5), slice(5, 8)
WIDTH = 8
ZERO = (0.0, 0.0, 0.0)
LET_GO = np.array([(RELEASE, WORLD, *ZERO, *ZERO)])


def rows_of(commands):
    """Return the rows of commands as a journal has them: dicts with ``topic``, ``frame``, ``force``, ``torque``."""
    rows = [(TOPICS.index(one['topic']), FRAMES.index(one['frame']), *one['force'], *one['torque']) for one in commands]
    return np.array(rows, dtype=float).reshape(-1, WIDTH)


def commands_of(rows):
    """Return rows as the dicts that :func:`rows_of` takes."""
    return [{'topic': TOPICS[int(kind)], 'frame': FRAMES[int(axes)], 'force': numbers[:3], 'torque': numbers[3:]}
            for kind, axes, *numbers in rows.tolist()]
