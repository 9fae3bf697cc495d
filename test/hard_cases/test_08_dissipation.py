"""Group 8, internal dissipation, weak to stiff.

The cases stand in rigid_body_sim/study/hard_cases, each with why it is hard and the reason of its bound; `hard_cases` prints what is measured.
"""

import pytest

from rigid_body_sim.study.hard_cases.table import of_group


@pytest.mark.parametrize('case', of_group(8), ids=lambda case: case.name)
def test_case(case):
    outcome = case.run()
    # measured: no rise through the separatrix; 5.4e-17 of the energy left at the end; 0.03 s
    assert outcome.good, f'{outcome.error:.3g} {outcome.unit}, bound {outcome.bound:.3g} ({outcome.reason}); {case.why}'
