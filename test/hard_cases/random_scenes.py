# SPDX-License-Identifier: Apache-2.0
"""Random scenes and commands: plain data that is a scene file, so a failure can be run again."""

import json

from hard_cases.conditioning import Allowed
from hypothesis import strategies as st

from rigid_body_sim.errors import BadInput, NotConverged
from rigid_body_sim.scene.scene import parse_scene
from rigid_body_sim.simulation.simulation import Simulation

unit = st.one_of(st.just(0.0), st.floats(-1.0, 1.0), st.floats(-1e-9, 1e-9),
                 st.sampled_from([1.0, -1.0, 5e-324, 1e-160]))
vectors = st.tuples(unit, unit, unit).map(list)
quaternions = st.tuples(unit, unit, unit, unit).map(list).filter(lambda q: max(map(abs, q)) > 0.0)
sizes = st.sampled_from([1e-12, 1e-3, 1.0, 10.0, 1e3, 1e6])


@st.composite
def moments(draw, symmetric):
    """Draw moments that a body can have."""
    a, b = draw(st.floats(1e-3, 1.0)), draw(st.floats(1e-3, 1.0))
    if symmetric:
        return [a, a, draw(st.sampled_from([1e-12, 0.5, 1.0, 1.5, 2.0])) * a]
    share = draw(st.one_of(st.sampled_from([0.0, 1.0]), st.floats(1e-12, 1.0)))
    return [a, b, abs(a - b) + share * (a + b - abs(a - b))]


@st.composite
def scenes(draw):
    """Draw a scene in closed form of any kind."""
    kind, speed = draw(st.sampled_from(['free', 'top', 'hinge', 'table'])), draw(sizes)
    omega = [speed * x for x in draw(vectors)]
    scene = {'scene': 'drawn', 'constraint': kind, 'effects': [],
             'initial': {'orientation': draw(quaternions)}}
    if kind == 'free':
        scene['body'] = {'mass': draw(sizes), 'inertia': draw(moments(symmetric=False))}
        scene['initial'] |= {'angular_velocity': omega, 'velocity': draw(vectors)}
    elif kind == 'table':
        scene['body'] = {
            'mass': draw(sizes), 'shape': {'solid_sphere': {'radius': draw(st.floats(1e-3, 1.0))}}}
        scene['effects'] = [{'sliding_friction': {
            'mu': draw(st.one_of(st.just(0.0), st.floats(1e-6, 2.0))), 'g': 9.81}}]
        scene['initial'] |= {'angular_velocity': omega, 'velocity': [*draw(vectors)[:2], 0.0]}
    else:
        scene['body'] = {
            'mass': 1.0, 'inertia': draw(moments(symmetric=True)), 'inertia_about': 'origin',
            'center_of_mass': [0.0, 0.0, draw(st.sampled_from([0.0, 1e-9, 0.01, -0.01]))]}
        scene['effects'] = [{'gravity': {'g': draw(st.floats(0.0, 20.0))}}]
        scene['initial']['angular_velocity'] = omega
        scene['constraint'] = 'pivot'
        if kind == 'hinge':
            scene['constraint'] = {'hinge': {'axis': draw(vectors.filter(lambda axis: max(map(
                abs, axis)) > 1e-3))}}
            del scene['initial']['angular_velocity']
            scene['initial']['rate'] = omega[0]
    return scene


@st.composite
def stepped_scenes(draw, every_effect):
    """Draw a scene that no closed form absorbs, turning with 20 rad/s at most.

    It is an asymmetric top, a driven body, or one that loses energy. With `every_effect` drag too,
    and dissipation so strong that other methods are taken: kinds that take minutes to compile.
    """
    kind = draw(st.sampled_from([
        'top', 'driven', 'relaxing', *(['dragged', 'stiff'] if every_effect else [])]))
    speed = draw(st.sampled_from([0.0, 1e-3, 1.0, 10.0]))
    inertia = draw(moments(symmetric=False).filter(lambda I: min(I) > 1e-2))
    scene = {
        'scene': 'drawn', 'constraint': 'free', 'body': {'mass': draw(sizes), 'inertia': inertia},
        'initial': {'orientation': draw(quaternions),
                    'angular_velocity': [speed * x for x in draw(vectors)]}}
    if kind == 'top':
        scene['constraint'] = 'pivot'
        arm = [draw(st.floats(0.001, 0.01)) for _ in range(3)]
        scene['body'] = {
            'mass': 1.0, 'inertia': inertia, 'inertia_about': 'origin', 'center_of_mass': arm}
        scene['effects'] = [{'gravity': {'g': draw(st.floats(0.1, 20.0))}}]
    elif kind == 'driven':
        scene['effects'] = [{'torque': {'value': draw(vectors.filter(any))}}]
    elif kind == 'dragged':
        scene['effects'] = [{'drag': {
            'angular': draw(st.floats(1e-6, 1.0)), 'linear': draw(st.floats(1e-6, 1.0))}}]
    else:
        scene['effects'] = [{'internal_dissipation': {'coefficient': draw(st.floats(
            1e-6, 0.4 if kind == 'relaxing' else 1e6))}}]
    return scene


def commands(acts=('impulse', 'advance', 'reset'), sizes=sizes):
    """Draw up to six commands: (what, force, torque, size, frame)."""
    return st.lists(st.tuples(st.sampled_from(acts), vectors, vectors, sizes,
                              st.sampled_from(['world', 'body'])),
                    max_size=6)


def in_one_line(refusal):
    """Assert that a refusal is one clear line."""
    text = str(refusal)
    assert text.isprintable() and len(text) < 2000 and 'np.' not in text, repr(text)


def run(scene, acts):
    """Run a random scene under commands.

    Returns
    -------
    simulation : Simulation
    allowed : Allowed
    The result is None where the scene is refused in one line.
    """
    try:
        simulation = Simulation(parse_scene(json.dumps(scene)))
    except BadInput as refusal:
        in_one_line(refusal)
        return None
    allowed = Allowed(simulation)
    for act, force, torque, size, frame in [*acts, ('advance', None, None, 1.0, None)]:
        try:
            if act == 'reset':
                simulation.reset()
                allowed.restart(simulation)
            elif act == 'advance':
                simulation.advance(max(1, int(min(size, 1e3))))
            else:
                getattr(simulation, act)(
                    [size * x for x in force], [size * x for x in torque], frame)
        except (BadInput, NotConverged) as refusal:
            in_one_line(refusal)
        allowed.look(simulation)
    return simulation, allowed
