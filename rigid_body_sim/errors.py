# SPDX-License-Identifier: Apache-2.0
"""Errors that a person reads: one line with the place, the fault and what would be right."""

import importlib

MOST_SLIPS = 2
"""Most typing errors in a misspelt word; with more it is another word."""
LETTERS_TO_A_SLIP = 3
"""Letters of a short word for each slip in it: `force` is not a misspelling of `free`."""


class BadInput(ValueError):
    """Input that cannot be used.

    Parameters
    ----------
    where : str
        The place as the user knows it: ``racket.yaml, line 4: body.inertia``, ``--rate``,
        ``cmd_wrench``.
    problem : str
        What is wrong there, with the value found.
    remedy : str
        What would be right.
    """

    def __init__(self, where, problem, remedy):
        self.where, self.problem, self.remedy = map(printable, (where, problem, remedy))
        super().__init__(f'{self.where}: {self.problem}; {self.remedy}')

    def __reduce__(self):
        return type(self), (self.where, self.problem, self.remedy)


class NotConverged(ArithmeticError):
    """A method gave up; the text says at which time and why.

    Parameters
    ----------
    text : str
    time : float, optional
        The time up to which there are states, s; None where nobody knows.
    """

    def __init__(self, text, time=None):
        super().__init__(text)
        self.time = time

    def __reduce__(self):
        return type(self), (str(self), self.time)


class Ended(NotConverged):
    """No law says how the motion goes on after a time: there it has the event `end`."""


def optional(package):
    """Import a package that is not required; raise BadInput where it is not installed."""
    try:
        return importlib.import_module(package)
    except ModuleNotFoundError as error:
        if error.name not in (package, package.partition('.')[0]):
            raise
        name = package.partition('.')[0]
        raise BadInput(name, 'is not installed', f'pip install {name}') from None


def refuse_without(part, names, where, remedy):
    """Raise BadInput with those names of a contract that a part does not have."""
    absent = [name for name in names if name not in dir(part)]
    if absent:
        raise BadInput(where, f'lacks {", ".join(absent)}', remedy)


def printable(text):
    """Return a text with its unprintable characters escaped, so no terminal obeys them."""
    text = str(text)
    return text if text.isprintable() else ''.join(
        one if one.isprintable() else one.encode('unicode_escape').decode() for one in text)


def nearest(word, known):
    """Return the one of some known words that `word` misspells or shortens, or None.

    `gravty` is a misspelling of `gravity`, and `racket` is short for `tennis_racket`;
    `gravity_gradient` is another word.
    """
    word, known = str(word), list(known)
    allowed = min(MOST_SLIPS, max(1, len(word) // LETTERS_TO_A_SLIP))
    slips, best = min(((_slips(word, one), one) for one in known), default=(len(word), None))
    if slips <= allowed:
        return best
    longer = [one for one in known if f'_{word}_' in f'_{one}_']
    return longer[0] if len(longer) == 1 else None


def _slips(one, other):
    """Return the number of letters left out, put in, replaced or swapped with a neighbour.

    This is the optimal string alignment distance (Damerau 1964).
    """
    before, last = [], list(range(len(other) + 1))
    for i, letter in enumerate(one):
        row = [i + 1]
        for j, wanted in enumerate(other):
            row.append(min(row[j] + 1, last[j + 1] + 1, last[j] + (letter != wanted)))
            if i and j and letter == other[j - 1] and one[i - 1] == wanted:
                row[-1] = min(row[-1], before[j - 1] + 1)
        before, last = last, row
    return last[-1]
