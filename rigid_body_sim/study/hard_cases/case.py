# SPDX-License-Identifier: Apache-2.0
"""A hard case: a name, why it is hard, and a run.

The run returns an error and the bound that the problem itself allows.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class Outcome:
    """The result of a run.

    Attributes
    ----------
    error, bound : float
        Both in `unit`; the bound is floor + growth by conditioning, and `reason` names it.
    unit, reason : str
    """

    error: float
    bound: float
    unit: str
    reason: str

    @property
    def good(self):
        """Whether the error is a number within the bound."""
        return self.error <= self.bound

    def __str__(self):
        return f'{self.error:.3g} {self.unit}, bound {self.bound:.3g} ({self.reason})'


@dataclass(frozen=True)
class Question:
    """A question to the peers about a case.

    Attributes
    ----------
    time : float
        Simulated time of the answer, s.
    unit : str
        Unit of the error.
    ask : callable
        Takes the module of a peer and returns its error; it may raise RefusedError, NotConverged
        or anything else.
    """

    time: float
    unit: str
    ask: object


@dataclass(frozen=True)
class Case:
    """One row of the table.

    Attributes
    ----------
    group : int
        1 racket, 2 inertia, 3 speed, 4 steps, 5 long runs, 6 tops, 7 contact, 8 dissipation,
        9 commands, 10 reversal.
    name, why : str
        `why` says why the case is hard.
    run : callable
        Takes nothing and returns the Outcome.
    asked : Question or None
        The question to the peers.
    """

    group: int
    name: str
    why: str
    run: object
    asked: object = None


GROUPS = {
    1: 'racket',
    2: 'inertia',
    3: 'speed',
    4: 'steps',
    5: 'long runs',
    6: 'tops',
    7: 'contact',
    8: 'dissipation',
    9: 'commands',
    10: 'reversal',
}
