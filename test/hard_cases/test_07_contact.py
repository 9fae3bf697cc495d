# SPDX-License-Identifier: Apache-2.0
"""Group 7, contact: the ball on the table.

The cases stand in rigid_body_sim/study/hard_cases, each with why it is hard and the reason of its
bound; `hard_cases` prints what is measured.
"""

import pytest
from hard_cases.judged import judge

from rigid_body_sim.study.hard_cases.table import of_group


@pytest.mark.parametrize('case', of_group(7), ids=lambda case: case.name)
def test_case(case):
    # measured: 0, 0, 5.6e-17 and 5.6e-17 m/s
    judge(case)
