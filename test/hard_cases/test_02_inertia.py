# SPDX-License-Identifier: Apache-2.0
"""Group 2, inertia of all kinds: equal, lamina, rod, needle, tiny, huge.

The cases stand in rigid_body_sim/study/hard_cases, each with why it is hard and the reason of its
bound; `hard_cases` prints what is measured.
"""

import pytest
from hard_cases.judged import judge

from rigid_body_sim.study.hard_cases.table import of_group


@pytest.mark.parametrize('case', of_group(2), ids=lambda case: case.name)
def test_case(case):
    # measured: at most 0.2 of the bounds (not quite round needle)
    judge(case)
