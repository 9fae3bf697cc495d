# SPDX-License-Identifier: Apache-2.0
"""Each scene that ships, and scenes of every kind of effect, open and move: what is drawn of them.

The simulation's process, the stage of the page and the data of a report run here as they are;
only the pipe between them is a list, and nobody looks at the server.
"""

import json

import numpy as np
import pytest
from near import near

from rigid_body_sim.scene.scene import load_scene, parse_scene, scene_names

pytest.importorskip('viser', reason='viser is not installed')
import viser

from rigid_body_sim.analysis.moving import Moving
from rigid_body_sim.view.live import pace_for
from rigid_body_sim.view.runner import Runner
from rigid_body_sim.view.stage import Stage

pytestmark = pytest.mark.without_numba

FREE = """
scene: one
parameters: {{k: 4.0, w0: 12.0}}
body: {{mass: 1.0, shape: {{box: {{size: [0.2, 0.3, 0.1]}}}}}}
constraint: free
effects: [{}]
initial: {{angular_velocity: [1.0, 2.0, 0.5], position: [0.1, 0, 0]}}
"""
MORE = {
    'spring': FREE.format('spring: {at: [0.1, 0, 0], anchor: [0, 0, 1], stiffness: 4.0, '
                          'length: 0.2}'),
    'rotor': FREE.format('rotor: {axis: [0, 0, 1], momentum: 0.4}'),
    'expressions': FREE.format('torque: {value: ["-k*wx", 0, "0.1*sin(w0*t)"], frame: body}'),
    'kinks': FREE.format('force: {value: ["-k*abs(x)", "min(0.2, y)", 0]}'),
    'potential': FREE.format('potential: {energy: "0.5*k*(z - 1)^2"}'),
    'moving_pivot': """
scene: driven_top
body: {mass: 1.0, inertia: [0.03, 0.03, 0.01], inertia_about: origin, center_of_mass: [0, 0, 0.1]}
constraint: {pivot: {motion: [0, 0, "0.05*sin(20*t)"]}}
effects: [gravity: {g: 9.81}]
initial: {euler_zyz: [0.0, 0.5, 0.0], angular_velocity: [0, 0, 60]}
""",
    'parts_in_a_surface': """
scene: loaded_ball
body:
  parts:
  - {mass: 1.0, shape: {solid_sphere: {radius: 0.09}}}
  - {mass: 0.5, shape: {cylinder: {radius: 0.02, length: 0.05}}, at: [0, 0, -0.03]}
  surface: {sphere: {radius: 0.1}}
constraint: {table: {normal: [0, 0.1, 1]}}
effects: [gravity: {g: 9.81}, sliding_friction: {mu: .inf}]
initial: {euler_zyz: [0.0, 1.0, 0.0], angular_velocity: [0, 0, 3], rolling: true}
"""}
TRIED = 'kapitza_pendulum', 'librating_satellite'
"""Scenes that ship and have no closed form for the trial to be short."""
TURN = 0.05
"""Time on the clock of the page between two pictures, s."""


class Pipe(list):
    """The page's end of the pipe to a Runner: a list of what it sends."""

    def send(self, sent):
        """Take what the runner sends."""
        self.append(sent)


@pytest.fixture(scope='module')
def server():
    made = viser.ViserServer(host='127.0.0.1', port=0, verbose=False)
    yield made
    made.stop()


def snapshots_of(scene):
    """Return the snapshots that a page gets of a scene at its start and after two pictures."""
    pipe = Pipe()
    # a trial of methods takes seconds in plain Python
    quick = (scene.name in scene_names() and scene.name not in TRIED
             and scene.body.surface is None)
    named = {} if quick else {'integrator': 'dop8', 'accuracy': 1e-6}
    runner = Runner(pipe, {'rate': 1000.0, **named}, None)
    runner.told('scene', scene.text)
    runner.told('speed', pace_for(scene))
    for _ in range(2):
        runner._advance(TURN)
    assert [name for name, _ in pipe if name in ('refused', 'failed')] == []
    assert [name for name, _ in pipe][:3] == ['preparing', 'preparing', 'scene']
    return [value for name, value in pipe if name == 'snapshot']


def test_every_scene_opens_and_moves(server):
    """One test for all of them: what runs without numba takes a process for each test."""
    for name in [*scene_names(), *MORE]:
        opens_and_moves(parse_scene(MORE[name]) if name in MORE else load_scene(name), server)


def opens_and_moves(scene, server):
    """Assert that all that is drawn of a scene is finite, and that the body moves."""
    snapshots = snapshots_of(scene)
    stage, shown = Stage(server, scene), []
    stage.shown = dict.fromkeys(('omega', 'momentum', 'force', 'torque', 'axis', 'polhode',
                                 'herpolhode'), True)
    for snapshot in snapshots:
        stage.trace(snapshot)
        stage.show(snapshot)
        stage.draw_traces()
        shown.append(np.concatenate([stage._body.position, stage._body.wxyz]))
        for handle in stage._arrows.values():
            assert np.isfinite(handle.points).all()
    assert np.isfinite(shown).all() and len(shown) == 3
    assert np.abs(np.diff(shown, axis=0)).max() > 1e-6
    assert len(stage.bodies) > 0 and stage.drawing.about
    stage.remove()

    states = np.array([snapshot.vector for snapshot in snapshots])
    data = Moving(states[:, 0], states[:, 1:5], states[:, 5:8], states[:, 8:11], scene).data()
    json.dumps(data, allow_nan=False)
    assert data['orientation'][0] != data['orientation'][-1] or (
        data['position'][0] != data['position'][-1])


def test_a_spring_is_drawn_from_its_anchor_to_the_body(server):
    scene = parse_scene(MORE['spring'])
    stage = Stage(server, scene)
    snapshot = snapshots_of(scene)[-1]
    stage.show(snapshot)
    [[begin, end]] = stage._coils.points * stage.unit
    assert begin == pytest.approx([0.0, 0.0, 1.0], abs=1e-6)
    assert np.linalg.norm(end - snapshot.vector[8:11]) == near(0.1, rel=1e-5)
    assert stage._coils.visible


def test_the_column_moves_with_a_pivot_that_moves(server):
    scene = parse_scene(MORE['moving_pivot'])
    stage = Stage(server, scene)
    for snapshot in snapshots_of(scene):
        stage.show(snapshot)
        assert stage._holder.position * stage.unit == pytest.approx(
            [0.0, 0.0, 0.05 * np.sin(20.0 * snapshot.time)], abs=1e-9 + 1e-6 * stage.unit)
    assert np.abs(stage._holder.position).max() > 0.0


def test_parts_are_seen_through_the_surface_that_touches(server):
    stage = Stage(server, parse_scene(MORE['parts_in_a_surface']))
    assert stage.drawing.about == ('the true shape, 2 parts, and the surface that touches the '
                                   'plane, a sphere')
    assert [one.clear for one in stage.drawing.surfaces] == [False, False, True]
    assert {handle.opacity for handle in stage.bodies} == {None, 0.35}
