# SPDX-License-Identifier: Apache-2.0
"""The contract of a motion: what a closed form offers to the exact solver.

A motion is a module of this folder with one line in the table of ``motions/__init__.py``. Members
that it lacks are declared as None. docs/extending adds one step by step.
"""

from collections.abc import Callable
from typing import Any, Protocol, runtime_checkable

import numpy as np

from rigid_body_sim.scene.scene import Scene


@runtime_checkable
class Motion(Protocol):
    """A motion in closed form over any time, from its anchor: the state of the last change.

    `state`, `anchor`, `fill_columns`, `next_event` and `entries` are compiled kernels. States
    are those of scene/state.py (14 doubles), times are simulated seconds.

    Attributes
    ----------
    ANCHOR_SIZE : int
        Number of doubles in an anchor.
    EVENTS : tuple of str
        Names of the events, by the code that `next_event` returns.
    """

    ANCHOR_SIZE: int
    EVENTS: tuple[str, ...]

    def absorbs(self, scene: Scene) -> bool:
        """Return whether the motion solves the scene whole: constraint, effects and body.

        The match is by what acts (``scene.acts_only``, ``mechanics.pulls.total_pull``), not by
        what the scene lists. Effects that are impulses, such as strikes, need no mention: after
        each the motion is anchored anew.
        """
        ...

    @property
    def takes(self) -> Callable[[Scene, np.ndarray], bool] | None:
        """``takes(scene, start)``: whether the motion holds from a state of a scene it absorbs.

        None if it holds from any state. It is asked at each start: an impulse may have changed the
        state, and then the general method goes on.
        """
        ...

    def parameters(self, scene: Scene) -> np.ndarray:
        """Return the numbers of a scene that the kernels take, in a layout of the motion's own."""
        ...

    @property
    def anchor(self) -> Callable[[np.ndarray, np.ndarray, np.ndarray], Any]:
        """``anchor(parameters, start, out)``: fill `out`, shape (ANCHOR_SIZE,), from a state."""
        ...

    @property
    def state(self) -> Callable[[np.ndarray, float, np.ndarray], Any]:
        """``state(anchor, time, out)``: fill `out`, shape (14,), with the state at any time."""
        ...

    @property
    def fill_columns(self) -> Callable[[np.ndarray, np.ndarray, np.ndarray], Any] | None:
        """``fill_columns(anchor, times, columns)``: the operations of `state` on many times.

        It fills the columns of loops.py with the same bits as `state`, as vector code; None if
        many states are computed one by one.
        """
        ...

    @property
    def next_event(self) -> Callable[[np.ndarray, float], tuple[float, int]] | None:
        """``next_event(anchor, after)``: time (s, infinite if none) and code of the next event.

        Events of the scene whose names are not among `EVENTS` are looked for on the states
        (mechanics/events.py), and so are all events if this is None.
        """
        ...

    @property
    def entries(self) -> Callable[[np.ndarray, float, np.ndarray], Any] | None:
        """``entries(anchor, time, out)``: fill `out`, shape (5,), with the ledger's entries.

        They are those of effects since the anchor (mechanics/ledger.py). If this is None, the
        ledger integrates them along the states, under error control.
        """
        ...
