# SPDX-License-Identifier: Apache-2.0
"""A moving body in a notebook or a file: a picture that plays without a server or a network.

::

    from rigid_body_sim import Simulation
    Simulation('tennis_racket').view(duration=10)        # in a notebook: the last line of a cell
    Simulation('heavy_top').view().save('top.html')      # anywhere else
"""

import html
import json
import pathlib

import numpy as np

from rigid_body_sim.analysis import page
from rigid_body_sim.analysis.moving import Moving
from rigid_body_sim.errors import BadInput
from rigid_body_sim.simulation.simulation import Simulation
from rigid_body_sim.view.player import states_of

FRAMES_A_SECOND, MOST_FRAMES = 120, 6000
HEIGHT = 540    # px


class View:
    """A motion to be looked at; a notebook shows it.

    Parameters
    ----------
    moves : analysis.moving.Moving
    title : str
    """

    def __init__(self, moves, title):
        self._moves, self._title = moves, title

    def page(self):
        """Return the HTML page."""
        scripts = ''.join(f'<script>{(page.HERE / name).read_text()}</script>'
                          for name in ('body.js', 'player.js'))
        return (f'<!DOCTYPE html><html lang="en"><head><meta charset="utf-8">'
                f'<title>{html.escape(self._title)}</title>'
                f'<style>{(page.HERE / "page.css").read_text()}</style></head><body>'
                f'<h2>{html.escape(self._title)}. {html.escape(page.heading_of(self._moves))}</h2>'
                f'{page.player(0, self._moves)}{scripts}'
                f'<script>player(0, {json.dumps(self._moves.data())})</script></body></html>')

    def save(self, path):
        """Write the page to a file."""
        pathlib.Path(path).write_text(self.page(), encoding='utf-8')

    def _repr_html_(self):
        return (f'<iframe srcdoc="{html.escape(self.page())}" width="100%" height="{HEIGHT}" '
                f'style="border:0" sandbox="allow-scripts"></iframe>')


def view(what, duration=10.0):
    """Return the View of a simulation from now on, or of a recording from its start on.

    Parameters
    ----------
    what : Simulation, Recording, str or path
        A Simulation is not advanced. A path is that of a recording.
    duration : float
        Length of what is shown, s.

    Raises
    ------
    BadInput
        A duration that is not positive, or a recording without states.
    """
    if not 0.0 < duration < np.inf:
        raise BadInput('view', f'got a duration of {duration!r} s', 'a positive number of seconds')
    count = min(int(duration * FRAMES_A_SECOND) + 1, MOST_FRAMES)
    if isinstance(what, Simulation):
        times = np.linspace(what.time, what.time + duration, count)
        vectors, scene = what.states(times).vector, what.scene
    else:
        times, vectors, scene = _recorded(what, duration, count)
    moves = Moving(times, vectors[:, 1:5], vectors[:, 5:8], vectors[:, 8:11], scene)
    return View(moves, scene.name.replace('_', ' ') if scene else 'unknown scene')


def _recorded(what, duration, count):
    times, vectors, _, source = states_of(what)
    wanted = np.linspace(0.0, min(duration, float(times[-1])), count)
    places = np.searchsorted(times, wanted)
    return times[places], vectors[places], source.scene
