# SPDX-License-Identifier: Apache-2.0
"""The stage of a page shows what was looked at (kept.py), and moves as its snapshots say."""

import contextlib
import types

import kept
import numpy as np
import pytest
from near import near

pytest.importorskip('viser')

from rigid_body_sim.scene.effects.wrench import Wrench
from rigid_body_sim.scene.scene import load_scene
from rigid_body_sim.simulation.simulation import Simulation
from rigid_body_sim.view.snapshots import Snapshot
from rigid_body_sim.view.stage import ARROW, FADING, Stage

SCENES = ('heavy_top', 'kater_pendulum_from_p', 'billiard_follow', 'tennis_racket', None,
          pytest.param('rolling_disk', marks=pytest.mark.without_numba))


class Server:
    """Stands for a viser server: remembers what is added, under its path."""

    def __init__(self):
        self.scene, self.added = self, {}

    atomic = contextlib.nullcontext

    def __getattr__(self, name):
        if not name.startswith('add_'):
            raise AttributeError(name)

        def add(path, *values, **settings):
            begun = {'visible': True, 'position': np.zeros(3), 'wxyz': np.array((1.0, 0, 0, 0))}
            handle = types.SimpleNamespace(kind=name, values=values, **begun | settings)
            self.added[path] = handle
            return handle
        return add

    def shown(self):
        """Return what a page would show, as plain data."""
        return {path: vars(handle) for path, handle in self.added.items()}


def snapshot(simulation, times, wrench=None, restarted=False):
    states = simulation.states(times).vector
    return Snapshot(times[-1], states[-1], states, wrench or Wrench(), 0.0, 0.0, 0.0,
                 restarted=restarted)


@pytest.mark.parametrize('name', SCENES)
def test_the_stage(name):
    server = Server()
    stage = Stage(server, load_scene(name) if name else None)
    assert not stage.follows    # it is the page that says so
    first = {'unit': stage.unit, 'cell': stage.cell, 'axis': stage.what_axis}
    if name:
        # the trials of a body on a plane take minutes in plain Python
        simulation = Simulation(
            stage.scene, 'auto' if stage.scene.body.surface is None else 'dop8')
        stage.shown = dict.fromkeys(('omega', 'momentum', 'force', 'torque', 'axis', 'polhode',
                                     'herpolhode'), True)
        stage.follows = True
        one = snapshot(simulation, [0.01, 0.02, 0.04], Wrench((0.0, 0.1, 0.2), (0.0, 0.0, 0.1)))
        stage.show(one)
        stage.trace(one)
        stage.draw_traces()
    kept.check(f'stage_{name}', first | {'shown': server.shown()})


def test_a_ghost_is_grey_translucent_and_stands_on_no_ground_of_its_own():
    server, other = Server(), Server()
    Stage(server, load_scene('heavy_top'), 'second', ghost=True)
    Stage(other, load_scene('heavy_top'))
    assert {path for path in server.added if 'ground' in path or 'holder' in path} == set()
    assert {path.replace('/world', '/second') for path in other.added
            if 'ground' not in path and 'holder' not in path} == set(server.added)
    for path, handle in server.added.items():
        if 'surface' in path:
            assert handle.color == (150, 150, 160)
            assert handle.opacity == 0.35


def test_an_arrow_grows_with_its_vector_until_its_kind_is_rescaled():
    server = Server()
    stage = Stage(server, load_scene('tennis_racket'))
    handle = server.added['/world/reference/omega']
    whole, lengths = stage._length('omega'), []
    assert whole == near(ARROW, rel=0.02)    # the plate hides next to nothing
    for size in (2.0, 1.0, 3.0, 3.2, 1.6, 0.0):
        stage._draw_arrow('omega', np.zeros(3), np.array([0.0, size, 0.0]))
        lengths.append(float(np.linalg.norm(handle.points[0, 1] - handle.points[0, 0])))
    assert lengths[:5] == near([whole, whole / 2, 1.5 * whole, whole, whole / 2], rel=1e-6)
    assert not handle.visible


def test_arrows_of_a_ball_begin_at_its_surface_and_are_told_apart_where_they_coincide():
    server = Server()
    scene = load_scene('sphere')
    stage, simulation = Stage(server, scene), Simulation(scene)
    stage.shown = dict.fromkeys(('omega', 'momentum', 'herpolhode'), True)
    one = snapshot(simulation, [0.0, 0.1])
    stage.show(one)
    stage.trace(one)
    stage.draw_traces()
    omega, momentum = (server.added[f'/world/reference/{key}'] for key in ('omega', 'momentum'))
    assert np.cross(omega.points[0, 1], momentum.points[0, 1]) == pytest.approx(0.0, abs=1e-6)
    for handle in (omega, momentum):
        # the drawn ball has flat faces
        assert np.linalg.norm(handle.points[0, 0]) == pytest.approx(1.0, abs=0.01)
    assert (np.linalg.norm(momentum.points[0, 1]) + momentum.head_length
            < np.linalg.norm(omega.points[0, 1]))
    assert momentum.shaft_radius > omega.shaft_radius
    tips = server.added['/world/reference/trace_herpolhode'].points
    assert tips[-1, 1] == pytest.approx(omega.points[0, 1], abs=1e-6)


def test_the_world_moves_against_a_body_that_is_followed_and_a_pull_halts_it():
    server = Server()
    scene = load_scene('billiard_follow')
    stage, simulation = Stage(server, scene), Simulation(scene)
    stage.follows = True
    root, body = server.added['/world'], server.added['/world/body']
    stage.show(snapshot(simulation, [0.0, 0.5]))
    assert root.position == pytest.approx(-body.position, abs=1e-12)
    before = root.position.copy()
    point = np.array([0.1, 0.2, 0.3])
    pulled = snapshot(simulation, [0.5, 0.7])
    stage.show(pulled, held=[(point, point + 0.1)])
    assert root.position == pytest.approx(before)
    spring = server.added['/world/reference/spring']
    assert spring.visible
    assert spring.points[0, 1] - spring.points[0, 0] == pytest.approx([0.1 / stage.unit] * 3)
    assert stage.to_world(point / stage.unit + root.position) == pytest.approx(point)
    lead = root.position + body.position
    for n in range(1, 4):
        stage.show(pulled)
        assert root.position + body.position == pytest.approx(lead * FADING ** n)
    assert not spring.visible
    stage.follows = False
    stage._lead[:] = 0.0
    stage.show(pulled)
    assert root.position == pytest.approx(np.zeros(3))


def test_traces_hold_their_last_points_and_begin_anew():
    server = Server()
    scene = load_scene('heavy_top')
    stage, simulation = Stage(server, scene), Simulation(scene)
    stage.shown = {'axis': True}
    line = server.added['/world/reference/trace_axis']
    stage.trace(snapshot(simulation, np.linspace(0.0, 1.0, 11).tolist()))
    stage.draw_traces()
    assert line.visible
    assert line.points.shape == (10, 2, 3)
    assert (line.points[1:, 0] == line.points[:-1, 1]).all()
    radii = np.linalg.norm(line.points, axis=2)
    assert radii == near(np.full((10, 2), radii[0, 0]), rel=1e-6)
    assert not server.added['/world/body/trace_polhode'].visible
    stage.trace(snapshot(simulation, [2.0], restarted=True))
    stage.draw_traces()
    assert not line.visible
