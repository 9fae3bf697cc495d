"""State: what flows through everything. One vector of 14 doubles, with names for its parts.

======== ===================== =========================================================== =====
slice    name                  meaning                                                     unit
======== ===================== =========================================================== =====
0        time                  since the start of the simulation                           s
1:5      orientation           unit quaternion (x, y, z, w), rotates body vectors to world -
5:8      angular_velocity      in body axes                                                rad/s
8:11     position              of the body's origin, in the world                          m
11:14    velocity              of the body's origin, in world axes                         m/s
======== ===================== =========================================================== =====
"""

import numpy as np

STATE_SIZE = 14
TIME = 0
ORIENTATION = slice(1, 5)
ANGULAR_VELOCITY = slice(5, 8)
POSITION = slice(8, 11)
VELOCITY = slice(11, 14)


class State:
    """One state, a view on its vector (layout above); the parts are views too."""

    __slots__ = ('vector',)

    def __init__(self, vector):
        self.vector = vector

    @classmethod
    def of(cls, time=0.0, orientation=(0.0, 0.0, 0.0, 1.0), angular_velocity=(0.0, 0.0, 0.0), position=(0.0, 0.0, 0.0),
           velocity=(0.0, 0.0, 0.0)):
        """Make a state of its parts."""
        return cls(np.array([time, *orientation, *angular_velocity, *position, *velocity], dtype=float))

    time = property(lambda self: float(self.vector[TIME]))
    orientation = property(lambda self: self.vector[ORIENTATION])
    angular_velocity = property(lambda self: self.vector[ANGULAR_VELOCITY])
    position = property(lambda self: self.vector[POSITION])
    velocity = property(lambda self: self.vector[VELOCITY])

    def __repr__(self):
        return (f'State(time={self.time!r}, orientation={self.orientation.tolist()}, angular_velocity={self.angular_velocity.tolist()}, '
                f'position={self.position.tolist()}, velocity={self.velocity.tolist()})')


class States(State):
    """Many states: the vector has shape (n, 14), each part has n rows."""

    __slots__ = ()

    time = property(lambda self: self.vector[:, TIME])
    orientation = property(lambda self: self.vector[:, ORIENTATION])
    angular_velocity = property(lambda self: self.vector[:, ANGULAR_VELOCITY])
    position = property(lambda self: self.vector[:, POSITION])
    velocity = property(lambda self: self.vector[:, VELOCITY])

    def __len__(self):
        return len(self.vector)

    def __getitem__(self, index):
        return State(self.vector[index])

    def __repr__(self):
        return f'States({len(self)} states from {self.vector[0, TIME]!r} s to {self.vector[-1, TIME]!r} s)'
