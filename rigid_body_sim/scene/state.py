# SPDX-License-Identifier: Apache-2.0
"""The state of a body: one vector of 14 doubles, with names for its parts.

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

import html
import typing
from typing import NamedTuple

import numpy as np

from rigid_body_sim.compilation.layout import Quaternion, Vector, layout
from rigid_body_sim.errors import optional

if typing.TYPE_CHECKING:
    import pandas
    import xarray

STATE_SIZE = 14
TIME = 0
ORIENTATION = slice(1, 5)
ANGULAR_VELOCITY = slice(5, 8)
POSITION = slice(8, 11)
VELOCITY = slice(11, 14)

PLACES = {'time': slice(TIME, TIME + 1), 'orientation': ORIENTATION,
          'angular_velocity': ANGULAR_VELOCITY, 'position': POSITION, 'velocity': VELOCITY}
AXES = {'orientation': 'xyzw', 'angular_velocity': 'xyz', 'position': 'xyz', 'velocity': 'xyz'}
UNITS = {'time': 's', 'orientation': '1', 'angular_velocity': 'rad/s', 'position': 'm',
         'velocity': 'm/s'}
SHOWN = 10    # states of a long series that a notebook shows


class StateView(NamedTuple):
    """The state in kernels, in the layout of the module's table."""

    time: float
    orientation: Quaternion
    angular_velocity: Vector
    position: Vector
    velocity: Vector


STATE = layout(StateView)


class State:
    """One state: a view on its vector of 14 doubles; the parts are views too.

    Parameters
    ----------
    vector : array (14,)
        Time, orientation (4), angular velocity, position, velocity (3 each); units and axes are
        those of the properties.
    """

    __slots__ = ('vector',)

    def __init__(self, vector: np.ndarray):
        self.vector = vector

    @classmethod
    def of(cls, time=0.0, orientation=(0.0, 0.0, 0.0, 1.0), angular_velocity=(0.0, 0.0, 0.0),
           position=(0.0, 0.0, 0.0), velocity=(0.0, 0.0, 0.0)) -> 'State':
        """Make a state of its parts.

        Parameters
        ----------
        time : float
            Since the start of the simulation, s.
        orientation : sequence of 4 floats
            Unit quaternion (x, y, z, w), body to world.
        angular_velocity : sequence of 3 floats
            Body axes, rad/s.
        position, velocity : sequence of 3 floats
            Those of the body's origin, world axes, m and m/s.
        """
        return cls(np.array([time, *orientation, *angular_velocity, *position, *velocity],
                            dtype=float))

    @property
    def time(self) -> float:
        """Time since the start of the simulation, s."""
        return float(self.vector[TIME])

    @property
    def orientation(self) -> np.ndarray:
        """Unit quaternion (x, y, z, w) that rotates body vectors to the world."""
        return self.vector[ORIENTATION]

    @property
    def angular_velocity(self) -> np.ndarray:
        """Angular velocity in body axes, rad/s."""
        return self.vector[ANGULAR_VELOCITY]

    @property
    def position(self) -> np.ndarray:
        """Position of the body's origin in the world, m."""
        return self.vector[POSITION]

    @property
    def velocity(self) -> np.ndarray:
        """Velocity of the body's origin in world axes, m/s."""
        return self.vector[VELOCITY]

    def __array__(self, dtype=None, copy=None):
        return (np.array if copy else np.asarray)(self.vector, dtype=dtype)

    def __repr__(self):
        return (f'State(time={self.time!r}, orientation={self.orientation.tolist()}, '
                f'angular_velocity={self.angular_velocity.tolist()}, '
                f'position={self.position.tolist()}, velocity={self.velocity.tolist()})')

    def _repr_html_(self):
        return _table(self.vector[np.newaxis])


class States(State):
    """Many states in one array, whose parts have a row for each state.

    An integer gives one :class:`State`; a slice, a mask or a list of places gives States.

    Parameters
    ----------
    vector : array (n, 14)
        A row for each state, as State has it.
    """

    __slots__ = ()

    @property
    def time(self) -> np.ndarray:
        """Times since the start of the simulation, s, shape (n,)."""
        return self.vector[:, TIME]

    @property
    def orientation(self) -> np.ndarray:
        """Unit quaternions (x, y, z, w) that rotate body vectors to the world, shape (n, 4)."""
        return self.vector[:, ORIENTATION]

    @property
    def angular_velocity(self) -> np.ndarray:
        """Angular velocities in body axes, rad/s, shape (n, 3)."""
        return self.vector[:, ANGULAR_VELOCITY]

    @property
    def position(self) -> np.ndarray:
        """Positions of the body's origin in the world, m, shape (n, 3)."""
        return self.vector[:, POSITION]

    @property
    def velocity(self) -> np.ndarray:
        """Velocities of the body's origin in world axes, m/s, shape (n, 3)."""
        return self.vector[:, VELOCITY]

    def __len__(self):
        return len(self.vector)

    def __getitem__(self, index):
        if isinstance(index, tuple):
            raise TypeError('States take one index; the columns have names: states.position[:, 0]')
        rows = self.vector[index]
        return State(rows) if rows.ndim == 1 else States(rows)

    def __iter__(self) -> typing.Iterator[State]:
        return map(State, self.vector)

    def to_pandas(self) -> 'pandas.DataFrame':
        """Return a DataFrame indexed by time, with a column for each component.

        The columns are ``orientation_x`` ... ``velocity_z``; the units are those of the parts.
        Raises BadInput where pandas is not installed.
        """
        pandas = optional('pandas')
        columns = [f'{part}_{axis}' for part, axes in AXES.items() for axis in axes]
        return pandas.DataFrame(self.vector[:, 1:], columns=columns,
                                index=pandas.Index(self.time, name='time'))

    def to_xarray(self) -> 'xarray.Dataset':
        """Return a Dataset: a variable for each part, over time and its axes, with units.

        Raises BadInput where xarray is not installed.
        """
        xarray = optional('xarray')
        coordinates = {'time': ('time', self.time, {'units': UNITS['time']}),
                       'quaternion': list('xyzw'), 'axis': list('xyz')}
        dimension = {part: 'quaternion' if axes == 'xyzw' else 'axis'
                     for part, axes in AXES.items()}
        parts = {part: (('time', dimension[part]), getattr(self, part), {'units': UNITS[part]})
                 for part in AXES}
        return xarray.Dataset(parts, coordinates)

    def plot(self, *parts: str):
        """Draw parts over time with matplotlib.

        Parameters
        ----------
        *parts : str
            ``orientation``, ``angular_velocity``, ``position``, ``velocity``; by default the
            orientation and the angular velocity.

        Returns
        -------
        list of matplotlib.axes.Axes
            One for each part, from top to bottom.

        Raises
        ------
        ValueError
            For a part that does not exist.
        """
        parts = parts or ('orientation', 'angular_velocity')
        for part in parts:
            if part not in AXES:
                raise ValueError(f'plot: no part {part!r}; the parts are {", ".join(AXES)}')
        pyplot = optional('matplotlib.pyplot')
        _, rows = pyplot.subplots(len(parts), sharex=True, squeeze=False, layout='constrained')
        for part, axes in zip(parts, rows[:, 0], strict=True):
            for name, values in zip(AXES[part], getattr(self, part).T, strict=True):
                axes.plot(self.time, values, label=name)
            axes.set_ylabel(f'{part.replace("_", " ")} ({UNITS[part]})')
            axes.legend(loc='upper right', ncols=len(AXES[part]))
        axes.set_xlabel('time (s)')
        return rows[:, 0].tolist()

    def __repr__(self):
        if not len(self):
            return 'States(none)'
        first, last = float(self.time[0]), float(self.time[-1])
        return f'States({len(self)} states from {first!r} s to {last!r} s)'

    def _repr_html_(self):
        more = f'<p>{html.escape(repr(self))}</p>' if len(self) > SHOWN else ''
        return _table(self.vector[:SHOWN]) + more


def _table(rows):
    """Return states as an HTML table: a row for each, a column for each component."""
    heads = ''.join(f'<th colspan="{len(axes)}">{part.replace("_", " ")} ({UNITS[part]})</th>'
                    for part, axes in AXES.items())
    names = ''.join(f'<th>{axis}</th>' for axes in AXES.values() for axis in axes)
    body = ''.join('<tr>' + ''.join(f'<td>{value:.9g}</td>' for value in row) + '</tr>'
                   for row in rows.tolist())
    return (f'<table><thead><tr><th rowspan="2">time (s)</th>{heads}</tr><tr>{names}</tr></thead>'
            f'<tbody>{body}</tbody></table>')
