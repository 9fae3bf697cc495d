# SPDX-License-Identifier: Apache-2.0
"""All hard cases, in the order of their groups."""

from rigid_body_sim.study.hard_cases import attitudes, behaviour, trends

CASES = tuple(sorted(
    [*attitudes.cases(), *trends.cases(), *behaviour.cases()], key=lambda case: case.group))


def of_group(group):
    """Return the cases of a group."""
    return [case for case in CASES if case.group == group]
