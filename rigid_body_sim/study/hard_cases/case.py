"""What a hard case is: a name, why it is hard, a run that returns an error and the bound that the problem itself allows."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Outcome:
    """What a run gave.

    Attributes
    ----------
    error, bound : float
        In `unit`; the bound is floor + growth by conditioning, `reason` says which.
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


@dataclass(frozen=True)
class Question:
    """What peers are asked about a case.

    Attributes
    ----------
    time : float
        Simulated, s, of the answer.
    unit : str
        Of the error.
    ask : callable
        Module of a peer -> its error; it may raise RefusedError, NotConverged or anything else.
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
        1 racket, 2 inertia, 3 speed, 4 steps, 5 long runs, 6 tops, 7 contact, 8 dissipation, 9
        commands, 10 reversal.
    name, why : str
        `why` says what makes it hard.
    run : callable
        () -> Outcome.
    asked : Question or None
        What peers are asked.
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
