"""Predicted intervals beside those of the simulation's events."""

import pytest

from rigid_body_sim.node.prediction import Prediction
from rigid_body_sim.simulation import Simulation


def compared(scene, overrides, seconds, rate=100.0):
    from rigid_body_sim.scenes import load_scene
    simulation = Simulation(load_scene(scene, overrides), rate=rate)
    prediction = Prediction(simulation.scene, simulation.state)
    simulation.advance(round(seconds * rate))
    for event in simulation.events:
        prediction.note(event.name, event.time)
    return prediction.compared()


@pytest.mark.parametrize(('scene', 'overrides', 'seconds', 'name'), [
    ('tennis_racket', [], 20.0, 'flip'),
    ('tennis_racket', ['initial.angular_velocity=[1.0, 3.0, 0.2]'], 20.0, 'flip'),
    ('tennis_racket', ['body.inertia=[3.0, 1.0, 2.0]', 'initial.angular_velocity=[0.2, 0.1, 3.0]'], 40.0, 'flip'),
    ('kater_pendulum', [], 10.0, 'turning point'),
    ('kater_pendulum', ['initial.angle=3.0', 'initial.rate=0.1'], 40.0, 'turning point'),
    ('kater_pendulum', ['constraint.hinge.axis=[0.0, 1.0, 1.0]'], 10.0, 'turning point'),
])
def test_interval_is_the_predicted_one(scene, overrides, seconds, name):
    found = compared(scene, overrides, seconds)
    assert found['event'] == name
    # measured at most 4e-14
    assert abs(found['relative_difference']) < 1e-12


@pytest.mark.parametrize(('scene', 'overrides'), [
    ('sphere', []), ('symmetric_top', []), ('free_body', ['initial.angular_velocity=[0.0, 1.0, 0.0]']), ('heavy_top', []),
    ('kater_pendulum', ['initial.angle=0.0']), ('kater_pendulum', ['initial.rate=20.0']), ('kater_pendulum', ['effects=[]']),
])
def test_where_theory_is_silent_so_is_the_node(scene, overrides):
    assert compared(scene, overrides, 0.0) == {}


def test_nothing_is_predicted_while_a_wrench_is_held():
    assert Prediction(Simulation('tennis_racket').scene, None).compared() == {}
