# SPDX-License-Identifier: Apache-2.0
"""The labelled body of each handout: its shape, axes, angular velocity, and the named lengths.

The shape is the one that reports and the browser view show. A scene with a bare tensor has none;
the box of equal inertia stands for it.
"""

import re
import types
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import LightSource, to_rgb
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d.art3d import Poly3DCollection
from mpl_toolkits.mplot3d.proj3d import proj_transform
from scipy.spatial.transform import Rotation

from figures.style import BLACK, BLUE, GREEN, GREY, ORANGE
from rigid_body_sim.drawing.body import drawing_of
from rigid_body_sim.drawing.setting import middle_of, reach_of
from rigid_body_sim.scene.scene import load_scene

TONES = '#9cc4e4', '#f0c07c'
ALPHA = 0.45
NONE = types.MappingProxyType({})


class Labelled(NamedTuple):
    """What a body is drawn with.

    Attributes
    ----------
    scene : str
    overrides : tuple of str
    view : (float, float)
        Elevation and azimuth of the eye, degrees.
    points : dict of str to (x, y, z)
        Labels of points, body axes, m.
    lengths : dict of str to ((x, y, z), (x, y, z))
        Labels of lengths between two points, body axes, m.
    arrows : dict of str to ((x, y, z), (x, y, z))
        Label to point and direction, body axes; a unit is drawn as long as the body reaches.
    inwards : bool
        Whether the arrows end at their points and come from their directions.
    vertical : bool
        Whether to show the weight.
    axes : str
        The body axes to show, of '123'.
    """

    scene: str
    overrides: tuple = ()
    view: tuple = (22.0, -60.0)
    points: Mapping = NONE
    lengths: Mapping = NONE
    arrows: Mapping = NONE
    inwards: bool = False
    vertical: bool = False
    axes: str = '123'


O = (0.0, 0.0, 0.0)
TOP = {'points': {'O': O, 'C': (0.0, 0.0, 0.1)},
       'lengths': {'l': ((-0.06, 0.0, 0.0), (-0.06, 0.0, 0.1))}, 'vertical': True,
       'view': (14.0, -70.0), 'axes': '13'}
BODIES = {
    'billiard_ball': Labelled(
        'billiard_follow', view=(8.0, -80.0), axes='', points={'C': O},
        lengths={'a': (O, (0.0, 0.0, -0.028575)), 'h': (O, (0.0, 0.0, 0.02))},
        arrows={'M v$_0$': ((-0.03, 0.0, 0.02), (-1.0, 0.0, 0.0))}, inwards=True),
    'kater_pendulum': Labelled(
        'kater_pendulum', ('initial.angle=0.35',), view=(4.0, -88.0), axes='', vertical=True,
        points={'Q': O, 'C': (0.0, 0.0, -0.4), 'P': (0.0, 0.0, -1.0)},
        lengths={'l': ((0.14, 0.0, 0.0), (0.14, 0.0, -0.4)),
                 "l'": ((-0.2, 0.0, 0.0), (-0.2, 0.0, -1.0))}),
    'baseball_bat': Labelled(
        'baseball_bat', view=(42.0, -55.0), axes='',
        points={'hand': O, 'C': (0.55, 0.0, 0.0)},
        lengths={'l': ((0.0, 0.12, 0.0), (0.55, 0.12, 0.0)),
                 'd': ((0.0, -0.14, 0.0), (0.6227, -0.14, 0.0))},
        arrows={'F': ((0.6227, -0.03, 0.0), (0.0, -0.6, 0.0))}, inwards=True),
    'driven_body': Labelled('driven_body', arrows={'Γ': (O, (0.0, 0.0, 1.0))}, axes='12'),
    'free_body': Labelled('free_body'),
    'symmetric_top': Labelled('symmetric_top'),
    'chandler_wobble': Labelled('chandler_wobble', axes='13'),
    'asymmetric_top': Labelled('asymmetric_top'),
    'tennis_racket': Labelled('tennis_racket'),
    'major_axis_relaxation': Labelled('major_axis_relaxation'),
    'euler_angles': Labelled('heavy_top', ('initial.euler_zyz=[0.7, 0.5, 0.4]',), **TOP),
    'heavy_top': Labelled('heavy_top', **TOP),
    'steady_precession': Labelled('steady_precession', **TOP),
    'sleeping_top': Labelled('sleeping_top', **TOP),
    'fast_top': Labelled('fast_top', **TOP),
    'degenerate': Labelled('thin_rod', points={'C': O},
                           lengths={'L': ((-0.1, 0.0, -0.5), (-0.1, 0.0, 0.5))}),
    'inertia_tensors': Labelled('sphere', points={'C': O}),
    'rolling_disk': Labelled('rolling_disk', vertical=True, points={'C': O},
                             lengths={'R': (O, (0.5, 0.0, 0.0))}),
    'rising_tops': Labelled('tippe_top', vertical=True, axes='3',
                            points={'C': (0.0, 0.0, -0.003)}),
    'rolling_spheres': Labelled('routh_sphere', vertical=True, axes='3',
                                points={'C': (0.0, 0.0, -0.12)}),
    'tossed_coin': Labelled('tossed_coin', vertical=True, points={'C': O},
                            lengths={'R': (O, (0.012, 0.0, 0.0))}, axes='3'),
    'kapitza_pendulum': Labelled(
        'kapitza_pendulum', view=(8.0, -85.0), axes='', vertical=True,
        points={'O': O, 'C': (0.0, 0.0, 0.15)},
        lengths={'r': (O, (0.0, 0.0, 0.15))}),
    'librating_satellite': Labelled('librating_satellite', points={'C': O}),
    'rattleback': Labelled('rattleback', view=(25.0, -75.0), vertical=True),
}


def draw(name):
    """Return the figure of the body of a page."""
    about = BODIES[name]
    scene = load_scene(about.scene, about.overrides)
    turn, reference = Rotation.from_quat(scene.initial.orientation), middle_of(scene)
    drawing = drawing_of(scene)
    reach = reach_of(scene, drawing)

    def world(point):
        return turn.apply(np.subtract(point, reference)) / reach

    figure = Figure(figsize=(3.6, 3.2), dpi=100)
    FigureCanvasAgg(figure)
    axes = figure.add_axes([-0.1, -0.1, 1.2, 1.2], projection='3d', computed_zorder=False)
    seen, drawn, labels = [world(drawing.vertices)], [], []

    def arrow(start, vector, text, color, width=2.0, head=0.13):
        axes.quiver(*start, *vector, color=color, linewidth=width, arrow_length_ratio=head,
                    zorder=6)
        labels.append((text, start + vector, color))
        drawn.append((start, start + vector))
        seen.append([start, start + 1.2 * vector])

    omega, named = scene.initial.angular_velocity, 'ω'
    for surface in drawing.surfaces:
        _fill(axes, surface, world(surface.vertices))
    for k in map(int, about.axes):
        # the label of an axis that omega hides stands beyond that of omega
        hidden = omega[k - 1] > 0.999 * np.linalg.norm(omega) > 0.0
        arrow(np.zeros(3), 1.25 * turn.apply(np.eye(3)[k - 1]), '' if hidden else f'e$_{k}$',
              GREY, 1.0)
        named += f', e$_{k}$' if hidden else ''
    if np.any(omega):
        arrow(np.zeros(3), 1.5 * turn.apply(omega / np.linalg.norm(omega)), named, ORANGE)
    for text, (at, direction) in about.arrows.items():
        vector = turn.apply(direction)
        if about.inwards:
            start = world(at) + vector
            labels.append((text, start, GREEN))
            arrow(start, -vector, '', GREEN, 2.0, 0.25)
        else:
            arrow(world(at), vector, text, GREEN)
    if about.vertical:
        center = world(scene.body.center_of_mass)
        arrow(center, np.array([0.0, 0.0, -0.7]), 'M g', BLACK)
    for text, point in about.points.items():
        seen.append([world(point)])
        axes.plot(*world(point), 'o', color=BLACK, markersize=4, zorder=8)
        labels.append((text, world(point), BLACK))
    for text, ends in about.lengths.items():
        first, last = (world(point) for point in ends)
        axes.plot(*np.transpose([first, last]), color=BLUE, linewidth=1.4, zorder=7,
                  marker='_', markersize=6)
        labels.append((text, 0.5 * (first + last), BLUE))
        drawn.append((first, last))
        seen.append([first, last])
    least, most = (function(np.concatenate(seen), axis=0) for function in (np.min, np.max))
    middles, half = 0.5 * (least + most), 0.5 * (most - least).max()
    axes.set(**{f'{k}lim': (middle - half, middle + half)
                for k, middle in zip('xyz', middles, strict=True)})
    axes.set_box_aspect((1.0, 1.0, 1.0), zoom=1.0)
    axes.view_init(*about.view)
    axes.set_axis_off()
    _label(axes, labels, drawn)
    return figure


def _label(axes, labels, drawn):
    """Write each label beside its point, in the direction that has the most room.

    Parameters
    ----------
    axes : Axes3D
        With its limits and view.
    labels : list of (str, (3,) array, color)
        What is written, beside which point.
    drawn : list of ((3,) array, (3,) array)
        The ends of the lines to keep away from.
    """
    axes.apply_aspect()
    projection = axes.get_proj()

    def pixels(point):
        x, y, _ = proj_transform(*point, projection)
        return axes.transData.transform((x, y))

    share = np.linspace(0.0, 1.0, 40)[:, np.newaxis]
    taken = [pixels(first) * (1.0 - share) + pixels(last) * share for first, last in drawn]
    turns = np.linspace(0.0, 2.0 * np.pi, 16, endpoint=False)
    for text, point, color in labels:
        if not text:
            continue
        # half the size of a letter of 12 points is 7 pixels, and a label may have several
        half = np.array([4.0 * len(re.sub(r'\$_(.)\$|[ ,]', r'\1', text)) + 3.0, 9.0])
        places = pixels(point) + np.column_stack([np.cos(turns), np.sin(turns)]) * (half + 7.0)
        near = [np.linalg.norm((np.concatenate(taken) - place) / half, axis=1).min()
                for place in places]
        place = places[int(np.argmax(near))]
        axes.figure.text(*axes.figure.transFigure.inverted().transform(place), text, color=color,
                         fontsize=12, ha='center', va='center', zorder=9)
        taken.append(place + half * np.array([[-1.0, 0.0], [0.0, 0.0], [1.0, 0.0]]))


def _fill(axes, surface, vertices):
    """Draw a surface as shaded triangles, seen through."""
    corners = vertices[surface.faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(normals, axis=1)
    kept = lengths > 0.0
    light = LightSource(azdeg=300.0, altdeg=50.0).shade_normals(
        normals[kept] / lengths[kept, np.newaxis], fraction=0.6)
    tones = np.array([to_rgb(tone) for tone in TONES])[surface.accent[kept].astype(int)]
    colors = np.clip(tones * (0.75 + 0.35 * light[:, np.newaxis]), 0.0, 1.0)
    axes.add_collection3d(Poly3DCollection(
        corners[kept], facecolors=np.column_stack([colors, np.full(len(colors), ALPHA)]),
        linewidths=0.0, zorder=1))
