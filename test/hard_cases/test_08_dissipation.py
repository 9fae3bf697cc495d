"""Group 8, internal dissipation, weak to stiff.

The cases stand in rigid_body_sim/study/hard_cases, each with why it is hard and the reason of its bound; `hard_cases` prints what is measured.
"""

import pytest

from rigid_body_sim.study.hard_cases.behaviour import never_rises
from rigid_body_sim.study.hard_cases.table import of_group


@pytest.mark.parametrize('case', of_group(8), ids=lambda case: case.name)
def test_case(case):
    outcome = case.run()
    # measured: no rise through the separatrix; 5.4e-17 of the energy left at the end; 0.03 s
    assert outcome.good, f'{outcome.error:.3g} {outcome.unit}, bound {outcome.bound:.3g} ({outcome.reason}); {case.why}'


def test_a_strong_dissipation_ends():
    """At c dt = 1000 a second takes a few hundred steps: rates are looked at once a step and twelve times, and end with the wobble."""
    import multiprocessing
    process = multiprocessing.get_context('fork').Process(target=never_rises, args=(1e6, (2.0, 0.1, 0.2), 1.0))
    process.start()
    process.join(20.0)
    ended = process.exitcode
    process.kill()
    assert ended == 0
