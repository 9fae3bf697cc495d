# SPDX-License-Identifier: Apache-2.0
"""Group 5, long runs: no trend, by statistics.

The cases stand in rigid_body_sim/study/hard_cases, each with why it is hard and the reason of its
bound; `hard_cases` prints what is measured.
"""

import pytest
from hard_cases.judged import judge

from rigid_body_sim.study.hard_cases.table import of_group


@pytest.mark.parametrize('case', of_group(5), ids=lambda case: case.name)
def test_case(case):
    # measured: 0.3, 1.1 and 0.5 sigma of 5; with 1e8 ticks 1.6 (free body) and 1.3 (anchored anew)
    judge(case)
