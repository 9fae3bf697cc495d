# SPDX-License-Identifier: Apache-2.0
"""The equations of a scene whose effects give formulas, for power series.

trees.py has the rates of the unknowns as trees, plan.py the steps that make their series, and
marching/recurrences.py the recurrences. The first coefficients are computed as kernels compute the
parts of an expression (scene/expressions/source.py).
"""

import numpy as np

from rigid_body_sim.errors import BadInput
from rigid_body_sim.integrators.equations import hinged
from rigid_body_sim.integrators.equations.equations import Equations
from rigid_body_sim.integrators.equations.plan import Plan
from rigid_body_sim.integrators.equations.series import refusal
from rigid_body_sim.integrators.equations.trees import FIRST, STARTED, TURNED, Trees
from rigid_body_sim.integrators.marching import recurrences
from rigid_body_sim.scene.expressions.source import HEAD, Lines

MOST = 200
"""Most products of series in a plan: with more of them compiling takes longer than most runs."""


class Expanded(Equations):
    """The equations of a scene whose effects all have the view `series`, with formulas.

    Attributes
    ----------
    rates : list of Nodes
        Rates of the unknowns (:class:`Trees`).
    named : dict of str to float
        The numbers at the beginning. A start on a hinge or a pivot adds those of its own.
    based : int
        The number of series that have to stay positive within a step.
    expand : str
        Source of ``expand(p, S, y)``: the coefficients of the unknowns, and of the integrals of
        those series after them.

    Raises
    ------
    BadInput
        An effect without the view, something with kinks, or products beyond MOST.
    """

    def __init__(self, scene):
        if not all(effect.series is not None for effect in scene.effects
                   if effect.acting is not None):
            raise refusal(scene)
        super().__init__(scene)
        if self.modes:
            raise refusal(scene)
        self._trees = Trees(self, self._actors, self._fixed)
        self.rates = self._trees.rates
        plan = Plan(self.rates)
        if plan.products > MOST:
            raise BadInput('integrator', f'taylor cannot run the scene {scene.name}: its formulas '
                           f'take {plan.products} products of series',
                           f'at most {MOST}: dop8 and gauss16 take more')
        self.named = self._trees.parameters | self._trees.numbers(-np.inf)
        self.based = len(plan.bases)
        lines = Lines(self.named)
        self.expand = self._expand(plan, lines)
        self._values, self.parameter_count = lines.values, self._first + len(lines.values)

    @property
    def _first(self):
        """The place of the plan's values in the parameters."""
        return super().parameters(self._fixed, -np.inf).size

    def parameters(self, fixed, time):
        """Return the parameters that hold just after a time, those of the plan after the rest."""
        before = super().parameters(fixed, time)
        changing = {f'parameter_{name}': value
                    for name, value in self._trees.numbers(time).items()}
        return np.array([*before, *(self._values | {
            name: changing[name] for name in self._values if name in changing}).values()])

    def _expand(self, plan, lines):
        """Return the source of ``expand(p, S, y)``."""
        before = self._of_start(lines)
        names = lines.of(*plan.firsts, *plan.fixed)
        firsts, fixed = names[:len(plan.firsts)], names[len(plan.firsts):]
        size, first = self.kind.UNKNOWNS, self._first
        ys = ''.join(f'the__y{k}, ' for k in range(size))
        return '\n'.join([
            HEAD,
            f'from {hinged.__name__} import attitude, load_attitude, load_start',
            f'from {recurrences.__name__} import expansion as kernel_for',
            '',
            f'expansion = kernel_for({plan.steps!r}, {plan.rates + plan.bases!r}, '
            f'{recurrences.places(size + self.based)})',
            '',
            '',
            '@compiled',
            'def expand(p, S, y):',
            f'    {ys}= y',
            *(f'    {name} = p[{first + k}]' for k, name in enumerate(lines.values)),
            *before,
            *lines.lines,
            f'    expansion(S, (({ys}), ({_listed(firsts)}), ({_listed(fixed)})))',
            '',
        ])

    def _of_start(self, lines):
        """Return the lines that name what a start determines."""
        place, first = (', '.join(f'the__{name}' for name in names) for names in (STARTED, FIRST))
        begin = [f'    {place} = load_start(p).place']
        if not self.on_hinge:
            return begin
        nx, ny, nz = (lines.value(f'hinge{k}', part)
                      for k, part in enumerate(self.frame.hinge.axis))
        zx, zy, zz, zw = (lines.value(f'zero{k}', part)
                          for k, part in enumerate(self.frame.hinge.zero))
        return [
            *begin,
            f'    {first} = load_attitude(p)',
            f'    ux, uy, uz, uw = multiply(-{zx}, -{zy}, -{zz}, {zw}, *attitude(p, the__y0))',
            f'    the__{TURNED} = 2.0 * atan2({nx} * ux + {ny} * uy + {nz} * uz, uw) - the__y0']


def _listed(names):
    return ''.join(f'{name}, ' for name in names)
