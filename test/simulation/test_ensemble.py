"""Ensembles give each body the bits that it has alone."""

import numpy as np
import pytest

from rigid_body_sim import BadInput, Simulation, State, ensemble, parse_scene, scene_names
from rigid_body_sim.compilation.threads import on_all_cores


def test_racket_ensemble_has_the_bits_of_single_runs():
    starts = [State.of(angular_velocity=(0.01 * k, 5.0, 0.01)) for k in range(20)]
    times = [0.5, 20.0, 3.0]
    states = ensemble('tennis_racket', starts, times)
    for k, start in enumerate(starts):
        alone = Simulation(parse_scene(f"""
scene: racket
body: {{mass: 1.0, inertia: [1.0, 2.0, 3.0]}}
constraint: free
effects: []
initial: {{angular_velocity: {start.angular_velocity.tolist()}}}
"""))
        assert states[k].vector.tobytes() == alone.states(times).vector.tobytes()


def test_many_bodies_come_from_all_cores_in_order():
    starts = np.tile(State.of(angular_velocity=(0.01, 5.0, 0.01)).vector, (3000, 1))
    starts[:, 0] = np.arange(3000.0)
    states = ensemble('tennis_racket', starts, [3010.0])
    assert len(states) == 3000
    assert [body.time[0] for body in states] == [3010.0] * 3000
    for body in (0, 1536, 2999):
        assert states[body].vector.tobytes() == ensemble('tennis_racket', starts[body:body + 1], [3010.0]).vector.tobytes()
    assert states[10:20].vector.tobytes() == states.vector[10:20].tobytes()
    assert len({body.vector.tobytes() for body in states}) == 3000


def test_what_fails_on_another_core_is_told():
    def work(part):
        if part.stop == 100:
            raise ValueError('the last one')
    with pytest.raises(ValueError, match='the last one'):
        on_all_cores(work, 100)


def test_stepped_ensemble_has_the_bits_of_single_runs():
    starts = [State.of(angular_velocity=(0.0, 5.0, 0.1 * k)) for k in range(1, 5)]
    states = ensemble('tennis_racket', starts, [1.0, 2.0], integrator='dop8', accuracy=1e-9)
    simulation = Simulation('tennis_racket', integrator='dop8', accuracy=1e-9)
    alone = np.empty((2, 14))
    simulation.choice.solver(starts[2].vector, simulation.wrench).states(np.array([1.0, 2.0]), alone)
    assert states[2].vector.tobytes() == alone.tobytes()


def test_wrong_starts_are_refused():
    with pytest.raises(BadInput, match='shape'):
        ensemble('tennis_racket', np.zeros((2, 7)), [1.0])
    with pytest.raises(BadInput, match='finite'):
        ensemble('tennis_racket', np.full((2, 14), np.nan), [1.0])


def test_package_offers_what_it_says():
    assert 'heavy_top' in scene_names()
    import rigid_body_sim
    for name in rigid_body_sim.__all__:
        assert getattr(rigid_body_sim, name)
    with pytest.raises(AttributeError, match='no attribute'):
        rigid_body_sim.nothing  # noqa: B018
