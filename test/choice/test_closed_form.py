# SPDX-License-Identifier: Apache-2.0
"""The closed form of a scene nearly the one that is asked for."""

from choice.known_bodies import coasting_scene
from near import near

from rigid_body_sim.choice import closed_form as module


def test_the_rounding_beside_the_error_of_a_scene_nearly_this_one_counts_what_a_torque_adds(
        monkeypatch):
    """Half an ulp of 4, and of the angle 3 t + t^2/4: 2 N m act on moments of 4 kg m^2."""
    scene = coasting_scene(effects=('torque: {value: [0, 0, 2], frame: body}',))
    monkeypatch.setattr(module, 'absorbing_motion', lambda scene: None)
    monkeypatch.setattr(module, 'nearly_absorbing', lambda *_: ('a motion', 'a scene', 1e-12))
    found = module.closed_form(scene, 8.0)
    assert (found.motion, found.scene, found.error) == ('a motion', 'a scene', 1e-12)
    assert found.floor == near(2.0 ** -53 * (4.0 + 24.0 + 16.0), rel=1e-15)
