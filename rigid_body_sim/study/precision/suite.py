# SPDX-License-Identifier: Apache-2.0
"""The problems of the suite: a scene and a duration each.

The first and the fourth are those of published comparisons.
"""

from dataclasses import dataclass

from rigid_body_sim.scene.scene import load_scene, parse_scene


@dataclass(frozen=True)
class Problem:
    """A problem to solve: a scene, from its start to `duration` (s).

    `patience` multiplies the CPU time that a study allows for one run.
    """

    name: str
    about: str
    duration: float
    scene: object
    patience: float = 1.0


def _written(body, constraint, effects, initial):
    return f'body: {body}\nconstraint: {constraint}\neffects: {effects}\ninitial: {initial}\n'


HEAVY = (
    '{mass: 1.0, inertia: [0.03, 0.03, 0.01], inertia_about: origin, center_of_mass: [0, 0, 0.1]}')
FREE = '{mass: 1.0, inertia: [1.0, 2.0, 3.0]}'
WEIGHT = '[gravity: {g: 9.81}]'

_PROBLEMS = {
    'racket': (
        'the middle axis is unstable',
        100.0,
        _written(FREE, 'free', '[]', '{angular_velocity: [0.01, 5.0, 0.01]}'),
    ),
    'generic_free_body': (
        'no axis, no direction is special',
        1000.0,
        _written(
            '{mass: 1.0, inertia: [1.3, 2.1, 2.9]}',
            'free',
            '[]',
            '{orientation: [0.1, -0.5, 0.3, 0.8], angular_velocity: [0.9, -1.1, 0.7]}',
        ),
    ),
    # the polhode is nearly the separatrix:
    # I1 (I2 - I1) omega1^2 = I3 (I3 - I2) omega3^2 (1 + 2e-9)
    'separatrix_free_body': (
        'all but on the separatrix, far from the axes',
        100.0,
        _written(
            FREE,
            'free',
            '[]',
            '{orientation: [0.3, 0.1, -0.4, 0.7], '
            'angular_velocity: [1.212435567710711, 1.1, 0.7]}',
        ),
    ),
    'heavy_symmetric_top': (
        'precession and nutation',
        20.0,
        _written(
            HEAVY, 'pivot', WEIGHT, '{euler_zyz: [0.0, 0.5, 0.0], angular_velocity: [0, 0, 60]}'
        ),
    ),
    'asymmetric_heavy_top': (
        'no closed form is known',
        20.0,
        _written(
            '{mass: 1.0, inertia: [0.03, 0.022, 0.012], inertia_about: origin, '
            'center_of_mass: [0.01, 0.005, 0.1]}',
            'pivot',
            WEIGHT,
            '{euler_zyz: [0.2, 0.8, 0.3], angular_velocity: [3, -2, 40]}',
        ),
    ),
    'driven_body': (
        'a torque fixed in an asymmetric body',
        20.0,
        _written(
            FREE,
            'free',
            '[torque: {value: [0.3, -0.2, 0.5]}]',
            '{angular_velocity: [0.1, 2.0, 0.3]}',
        ),
    ),
    'damped_body': (
        'drag, and heat from inside',
        50.0,
        _written(
            FREE,
            'free',
            '[drag: {angular: 0.02}, internal_dissipation: {coefficient: 0.02}]',
            '{angular_velocity: [4.0, 0.3, 0.2]}',
        ),
    ),
    'ball_slip_to_roll': (
        'a billiard ball with side spin slides, then rolls',
        3.0,
        _written(
            '{mass: 0.17, shape: {solid_sphere: {radius: 0.028575}}}',
            'table',
            '[sliding_friction: {mu: 0.2, g: 9.81}]',
            '{angular_velocity: [40.0, -60.0, 30.0], velocity: [1.5, 0.4, 0.0]}',
        ),
    ),
    # it starts hanging, with 1e-9 less than the rate 2 sqrt(M g l/I) that reaches the top
    'separatrix_pendulum': (
        'all but enough to reach the top',
        20.0,
        _written(
            '{mass: 2.0, inertia: [0.48, 0.48, 0.002], center_of_mass: [0, 0, -0.4]}',
            '{hinge: {axis: [0, 1, 0]}}',
            WEIGHT,
            '{angle: 0.0, rate: 6.2641839015}',
        ),
    ),
    'torsion_spring': (
        'a door: weight, a torsion spring and its damper on a slanting hinge',
        20.0,
        _written(
            '{mass: 2.0, inertia: [0.48, 0.5, 0.02], center_of_mass: [0.3, 0, 0.1]}',
            '{hinge: {axis: [0.1, 0, 1]}}',
            '[gravity: {g: 9.81}, spring: {stiffness: 12.0, angle: 0.4, damping: 0.02}]',
            '{angle: -1.2, rate: 3.0}',
        ),
    ),
    'top_in_air': (
        'an asymmetric top that the air slows by the square of its velocity',
        10.0,
        _written(
            '{mass: 1.0, inertia: [0.03, 0.022, 0.012], inertia_about: origin, '
            'center_of_mass: [0.01, 0.005, 0.1]}',
            'pivot',
            '[gravity: {g: 9.81}, drag: {quadratic: 0.2, angular_quadratic: 1.0e-5}]',
            '{euler_zyz: [0.2, 0.8, 0.3], angular_velocity: [3, -2, 40]}',
        ),
    ),
    'tied_top': (
        'an asymmetric top that a spring ties to a point beside it',
        10.0,
        _written(
            '{mass: 1.0, inertia: [0.03, 0.022, 0.012], inertia_about: origin, '
            'center_of_mass: [0.01, 0.005, 0.1]}',
            'pivot',
            '[gravity: {g: 9.81}, spring: {at: [0, 0, 0.15], anchor: [0.3, 0, 0.2], '
            'stiffness: 30.0, length: 0.1}]',
            '{euler_zyz: [0.2, 0.8, 0.3], angular_velocity: [3, -2, 40]}',
        ),
    ),
    'sleeping_top_unstable': (
        'P_gamma^2 at 0.999 of 4 I1 M g l, a seed of 1e-6 rad/s',
        20.0,
        _written(HEAVY, 'pivot', WEIGHT, '{angular_velocity: [1.0e-6, 0, 34.2931]}'),
    ),
}

# kinds of scene that the suite lacks, for the table by which `auto` chooses
_TRAINING = {
    'fast_asymmetric_top': (
        'fast nutation of a small size',
        10.0,
        _written(
            '{mass: 0.4, inertia: [0.003, 0.0036, 0.002], inertia_about: origin, '
            'center_of_mass: [0.002, 0, 0.04]}',
            'pivot',
            WEIGHT,
            '{euler_zyz: [0.3, 0.5, 0.1], angular_velocity: [0.4, 0.3, 120]}',
        ),
    ),
    'damped_heavy_top': (
        'drag on an asymmetric top',
        10.0,
        _written(
            '{mass: 1.0, inertia: [0.03, 0.022, 0.012], inertia_about: origin, '
            'center_of_mass: [0, 0, 0.1]}',
            'pivot',
            '[gravity: {g: 9.81}, drag: {linear: 0.1, angular: 0.002}]',
            '{euler_zyz: [0.2, 0.8, 0.3], angular_velocity: [3, -2, 40]}',
        ),
    ),
    'driven_body_with_drag': (
        'thrown, driven and held back by the air',
        20.0,
        _written(
            FREE,
            'free',
            '[gravity: {g: 9.81}, torque: {value: [0.3, -0.2, 0.5]}, '
            'drag: {linear: 0.1, angular: 0.05}]',
            '{angular_velocity: [0.1, 2.0, 0.3], velocity: [3.0, 0.0, 9.0]}',
        ),
    ),
    'driven_pendulum': (
        'a pendulum under a constant couple',
        20.0,
        _written(
            '{mass: 2.0, inertia: [0.48, 0.48, 0.002], center_of_mass: [0, 0, -0.4]}',
            '{hinge: {axis: [0, 1, 0]}}',
            '[gravity: {g: 9.81}, torque: {value: [0, 1.5, 0]}]',
            '{angle: 0.3, rate: 4.0}',
        ),
    ),
    'damped_pendulum': (
        'a pendulum with drag',
        20.0,
        _written(
            '{mass: 2.0, inertia: [0.48, 0.48, 0.002], center_of_mass: [0, 0, -0.4]}',
            '{hinge: {axis: [0, 1, 0]}}',
            '[gravity: {g: 9.81}, drag: {linear: 0.05, angular: 0.01}]',
            '{angle: 0.3, rate: 9.0}',
        ),
    ),
}
# scenes that ship, and how long they run (s); their references are made by
# test/data/make_plane_scenes.py
_ON_A_PLANE = {'rolling_disk': 10.0, 'routh_sphere': 10.0, 'tippe_top': 5.0}
PATIENCE = 10.0
"""Factor of the CPU time on a plane: contact of engines is of first order, so steps are short."""
NAMES, TRAINING, ON_A_PLANE = tuple(_PROBLEMS), tuple(_TRAINING), tuple(_ON_A_PLANE)
QUICK = ('racket', 'heavy_symmetric_top', 'asymmetric_heavy_top', 'driven_body')
"""Problems of the quick form of the study: two with a closed form, two without."""


def problem(name):
    """Return a problem of the suite."""
    if name in ON_A_PLANE:
        scene = load_scene(name)
        return Problem(name, scene.about, _ON_A_PLANE[name], scene, PATIENCE)
    about, duration, text = (_PROBLEMS | _TRAINING)[name]
    return Problem(
        name, about, duration, parse_scene(f'scene: {name}\n{text}', where=f'suite: {name}'))


def of_scene(scene, overrides, duration):
    """Return the problem of a user's scene."""
    loaded = load_scene(scene, overrides)
    return Problem(loaded.name, loaded.about, duration, loaded)
