# SPDX-License-Identifier: Apache-2.0
"""The contracts of this folder: what a method, a method family and a solver offer.

docs/extending/method.md shows how to add a method. A method is a module of methods/ with one line
in the table of ``integrators/__init__.py``; a family is a module of families/. The table
(registry.py) refuses a method that lacks a declaration, so none fails in a run.
"""

from typing import Any, Protocol, runtime_checkable

import numpy as np

FINEST = 1e-15
"""The finest accuracy (rad) that doubles allow."""
Event = tuple[float, str, dict]
"""Time (s) and name of an event, and numbers that belong to it, by name."""


@runtime_checkable
class Solver(Protocol):
    """A scene followed from one state: the exact motions, and every method of this folder.

    The state at a time does not depend on which other times were asked. Unless stated otherwise,
    vectors are those of scene/state.py (14 doubles) and times are simulated seconds.

    Attributes
    ----------
    rests_on_start : bool
        Whether it may not hold, or not well enough, from another start of the scene.
    """

    rests_on_start: bool

    @property
    def name(self) -> str:
        """``exact``, or the name of the method."""

    def start(self, vector: np.ndarray) -> 'Solver':
        """Return a solver from a state on; this one stays as it is.

        Parameters
        ----------
        vector : array (14,)
            The state, its time included. It is copied.
        """

    def runner(self) -> Any:
        """Return ``run(start, time, out)``: the bits of ``start(start).state(time, out)``.

        It is the quickest way to one state. Calls of one runner may not overlap.
        """

    def state(self, time: float, out: np.ndarray) -> None:
        """Fill `out`, shape (14,), with the state at a time not before the start."""

    def states(self, times: np.ndarray, out: np.ndarray) -> None:
        """Fill `out`, shape (n, 14), with the states at n times, in any order.

        Raises
        ------
        BadInput
            A time before the start, or not finite.
        NotConverged
            The solver cannot reach a time; the message names the time at which it stopped.
        """

    def many(self, starts: np.ndarray, times: np.ndarray, out: np.ndarray) -> None:
        """Fill `out`, shape (bodies, n, 14), with the states of many bodies at n times.

        Parameters
        ----------
        starts : array (bodies, 14)
        times : array (n,)

        Raises
        ------
        BadInput, NotConverged
            As `states`; the message begins with the number of the body.
        """

    def entries(self, time: float) -> np.ndarray:
        """Return the entries of the ledger from the start to a time, shape (5,).

        mechanics/ledger.py has their layout: work (J), heat (J), angular impulse (N m s, world).
        """

    def allowance(self, until: float) -> tuple[float, float] | None:
        """Return the error that the solver has allowed itself beyond its accuracy, or None.

        Returns
        -------
        (float, float) or None
            Error of the attitude, rad, and the time from which on, s, not after `until`.
        """

    def events(self, after: float, until: float, tick: float = 0.0) -> list[Event]:
        """Return what happens after one time and not later than another, in order.

        Parameters
        ----------
        tick : float
            Length of a tick, s. A motion in closed form may drop events that crowd within one.
        """


@runtime_checkable
class Method(Protocol):
    """A module of methods/: what it is, where it is published, and what it can do.

    Attributes
    ----------
    NAME : str
        Its name in a scene's settings and in the table of methods.
    ORDER : int
        The global error falls with this power of the step.
    PRESERVES : tuple of str
        What it keeps exactly, rounding apart.
    SOURCE : str
        Where it is published.
    NEEDS : str
        The view of every effect that it asks for (scene/effects/protocol.py): ``acting`` or
        ``series``.
    HEAT : bool
        Whether it runs scenes in which anything makes heat.
    FIELD : bool
        Whether it runs scenes in which what acts depends on time or place: its stages then have a
        clock.
    STIFF : tuple of str
        What may be much faster than the motion while it controls its error and keeps its pace:
        ``dissipation`` (internal), ``drag`` (linear). `auto` takes no other method there.
    TABLE : bool
        Whether it follows a ball on the table, whose steps end where sliding does: a Runge-Kutta
        method that estimates its error.
    TAKES : tuple of str
        What controls it: ``accuracy``, ``step`` (fixed steps, s).
    FAMILY : Family
        The module that makes its kernels. A family may ask for more names, which it documents.
    """

    NAME: str
    ORDER: int
    PRESERVES: tuple
    SOURCE: str
    NEEDS: str
    HEAT: bool
    FIELD: bool
    STIFF: tuple
    TABLE: bool
    TAKES: tuple
    FAMILY: Any


@runtime_checkable
class Family(Protocol):
    """A module of families/: it binds a method to the equations of a scene.

    Attributes
    ----------
    TAKES_WRENCH : bool
        Whether its equations take a held wrench. Where it is False, the general method (`GENERAL`
        in ``integrators/__init__.py``) solves the hold.
    LANES : bool
        Whether it has a function ``batch`` (LanesFamily).
    KINKS : bool
        Whether its marches stop at the kinks of what acts (marching/switched.py).
    ROOTS : bool
        Whether its steps see that a root of what moves comes near zero (`rooted` of an Acting).
    ASKS : dict of str to tuple of str
        What may control its methods (Method.TAKES), and the names that a page then has beside
        those of Method.
    TABLE : bool
        Whether its methods may declare TABLE.
    FINEST : float
        The finest accuracy that makes a difference, rad: a finer one gives the same run.
    """

    ASKS: dict[str, tuple[str, ...]]
    TABLE: bool
    TAKES_WRENCH: bool
    LANES: bool
    KINKS: bool
    ROOTS: bool
    FINEST: float

    def bind(self, method: Method, stepped: Any) -> 'Bound':
        """Return the method's kernels on a scene's equations.

        Parameters
        ----------
        method : Method
            Of this family.
        stepped : Stepped
            Its scene, wrench, accuracy (rad), step (s) and horizon (s) are used.

        Raises
        ------
        BadInput
            The method cannot run the scene.
        """


@runtime_checkable
class LanesFamily(Family, Protocol):
    """A family that can solve many bodies side by side in the vector unit."""

    def batch(self, bound: 'Bound', stepped: Any, times: np.ndarray) -> 'Batch | None':
        """Return a way to solve many bodies side by side in the vector unit, or None.

        Parameters
        ----------
        times : array (n,)
            s, in any order, n > 0.
        """


class Bound(Protocol):
    """A method bound to the equations of one scene.

    Attributes
    ----------
    KEEPS_ENTRIES : bool
        Whether its courses have a method ``entries(time)``, as Solver.entries. Otherwise the
        ledger's entries are a quadrature over the states (mechanics/quadrature.py).
    """

    KEEPS_ENTRIES: bool

    def at(self, stepped: Any) -> 'Bound':
        """Return the Bound of a solver that differs from the one bound in its accuracy alone."""

    def runner(self, stepped: Any, slow: float) -> Any:
        """Return (kernel, room), the quickest way to a final state, or None.

        ``kernel(room, vector, time, out)`` fills `out` with the bits of a course from that start
        and returns points.REACHED, or something else where that takes a course: so it does of a
        body that turns slower than `slow` (rad/s). It works in `room`: calls may not overlap.
        """

    def course(self, stepped: Any) -> 'Course':
        """Return the course of a started solver."""


class Course(Protocol):
    """One run from a start.

    Attributes
    ----------
    TELLS_EVENTS : bool
        Whether it has a method ``events(after, until)``, as Solver.events; else the solver
        watches the states for events (mechanics/events.py).
    """

    TELLS_EVENTS: bool

    def state(self, time: float, out: np.ndarray) -> None:
        """Fill `out`, shape (14,), with the state at a time (s) not before the start."""

    def states(self, times: np.ndarray, out: np.ndarray) -> None:
        """Fill the rows of `out` as `state` does, for times (s) in any order."""

    def step_at(self, time: float) -> tuple[float, float]:
        """Return when the step that holds a time (s) begins and ends, s.

        The beginning is infinite where no step holds it, and the end where none follows.

        Only courses that do not tell events are asked.
        """

    def kinks(self, until: float) -> list[float]:
        """Return the times before another at which marches stopped at a kink, s.

        Only courses whose Bound keeps no entries are asked.
        """


class Batch(Protocol):
    """Many bodies of one scene, solved side by side."""

    def run(self, starts: np.ndarray, out: np.ndarray) -> tuple[int, float] | None:
        """Fill `out`, shape (bodies, n, 14), from `starts`, shape (bodies, 14).

        Returns
        -------
        (int, float) or None
            The body that could not be followed and its time (s).
        """


class MarchingFamily(Family, Protocol):
    """A family whose methods march in compiled code; marching/bound.py binds them.

    Attributes
    ----------
    bind : callable
        ``marching.bound.Bound``.
    """

    def equations_of(self, scene: Any, wrench: Any) -> Any:
        """Return the equations (equations/equations.py) that `march` is for."""

    def march(self, method: Method, equations: Any, adapts: bool) -> Any:
        """Return the module that marches, a template of marching/ bound to method and equations.

        Parameters
        ----------
        adapts : bool
            Whether the method chooses its own steps.

        Returns
        -------
        module
            With ``SIZE`` (unknowns), ``VALUES`` (place of the unknowns in a point), ``begin(p,
            control, point)``, ``march(p, control, point, following, target, end, limit)`` and
            ``between(p, control, point, following, dt)``; ``arrive(p, control, point, target,
            limit)`` gives final states where the method chooses its own steps, or is None.
        """

    def begin(self, stepped: Any, march: Any) -> tuple[np.ndarray, np.ndarray]:
        """Return (control, point) of a march, arrays that are copied for each start."""
