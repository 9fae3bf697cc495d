# SPDX-License-Identifier: Apache-2.0
"""The table of methods checks each page against its contract when the page is added."""

import collections
import inspect

from rigid_body_sim.errors import BadInput, refuse_without
from rigid_body_sim.integrators.protocols import Family, Method

CONTROLS = 'accuracy', 'step'


class Methods(collections.UserDict):
    """The pages of methods/ by their names (integrators/protocols.py, Method).

    A page that lacks what it or its family has to declare is refused when it is added, by BadInput
    with the names that are missing.
    """

    def __init__(self, pages=()):
        """Add the pages of a mapping of names, in its order."""
        super().__init__()
        self._changed()
        self.update(pages)

    def _changed(self):
        """Forget what was derived from the pages."""
        self._needed = {page.NEEDS for page in self.data.values()}
        self._able = {}    # names by what acts: scenes of a kind ask again and again

    def __setitem__(self, name, page):
        """Add a page under its name."""
        where = f'method {name}'
        refuse_without(page, inspect.get_annotations(Method), where, 'every method declares them')
        refuse_without(page.FAMILY, [*inspect.get_annotations(Family), 'bind'],
                       f'{where}: FAMILY', 'every family declares them')
        if name != page.NAME:
            raise BadInput(where, f'its page calls itself {page.NAME!r}',
                           'the same name in the table and on the page')
        asks = page.FAMILY.ASKS
        if not page.TAKES or not set(page.TAKES) <= {*CONTROLS} & {*asks}:
            raise BadInput(f'{where}: TAKES', f'got {page.TAKES!r}', 'some of '
                           f'{", ".join(one for one in CONTROLS if one in asks)}, '
                           'what its family can be controlled by')
        if page.TABLE and not (page.FAMILY.TABLE and 'accuracy' in page.TAKES):
            raise BadInput(f'{where}: TABLE', f'got {page.TABLE!r}', 'False, or a Runge-Kutta '
                           'method that takes an accuracy: steps end where sliding does')
        for control in page.TAKES:
            refuse_without(page, asks[control], where,
                           f'its family needs them for {control!r} (docs/extending/method.md)')
        super().__setitem__(name, page)
        self._changed()

    def __delitem__(self, name):
        """Remove the page of a name."""
        super().__delitem__(name)
        self._changed()

    def views(self, effects):
        """Return the views that some method needs and all of these effects have, a frozenset."""
        return frozenset(view for view in self._needed
                         if all(getattr(effect, view) is not None for effect in effects))

    def able(self, views, hot, kinked, in_field):
        """Return the names of the methods that can follow what acts, a tuple.

        Parameters
        ----------
        views : frozenset of str
            Those that all effects have.
        hot, kinked, in_field : bool
            Whether anything makes heat, has kinks, depends on time or place.
        """
        key = views, hot, kinked, in_field
        if key not in self._able:
            self._able[key] = tuple(
                name for name, page in self.items()
                if page.NEEDS in views and (page.HEAT or not hot)
                and (page.FAMILY.KINKS or not kinked) and (page.FIELD or not in_field))
        return self._able[key]
