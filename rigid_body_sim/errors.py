# SPDX-License-Identifier: Apache-2.0
"""Errors that a person reads: one line with the place, the fault and what would be right."""


class BadInput(ValueError):
    """Input that cannot be run.

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
        super().__init__(f'{where}: {problem}; {remedy}')
        self.where = where
        self.problem = problem
        self.remedy = remedy


class NotConverged(ArithmeticError):
    """A method gave up: it says at which time and why, instead of returning NaN."""
