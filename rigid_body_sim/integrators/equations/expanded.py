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
from rigid_body_sim.integrators.equations.plan import UNKNOWN, Plan
from rigid_body_sim.integrators.equations.series import refusal
from rigid_body_sim.integrators.equations.trees import FIRST, STARTED, TURNED, Trees, own
from rigid_body_sim.integrators.marching import recurrences
from rigid_body_sim.integrators.marching.taylor_series import ORDER
from rigid_body_sim.scene.expressions import tree
from rigid_body_sim.scene.expressions.source import HEAD, Lines

MOST = 200
"""Most products of series in a plan: with more of them compiling takes longer than most runs."""
STEADY = '_steady'
"""What names of parts begin with that are the same in all steps."""


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
    prepare, expand : str
        Sources of ``prepare(p, S)``, which keeps in S what is the same in all steps from a start,
        and of ``expand(p, S, y)``: the coefficients of the unknowns, and of the integrals of
        those series after them.
    room : int
        The size of S: the coefficients, then what is kept.

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
        self.prepare, self.expand = self._sources(plan, lines)
        self._values, self.parameter_count = lines.values, self._first + len(lines.values)

    @property
    def _first(self):
        """The place of the plan's values in the parameters."""
        return super().parameters(-np.inf).size

    def parameters(self, time):
        """Return the parameters that hold just after a time, those of the plan after the rest."""
        before = super().parameters(time)
        changing = {f'parameter_{name}': value
                    for name, value in self._trees.numbers(time).items()}
        return np.array([*before, *(self._values | {
            name: changing[name] for name in self._values if name in changing}).values()])

    def _sources(self, plan, lines):
        """Return the sources of `prepare` and `expand`."""
        steady, given = _apart([*plan.firsts, *plan.fixed])
        before, once, each_step = self._of_start(lines)
        kept, early = lines.of(*steady), len(lines.lines)
        names = lines.of(*given)
        firsts, fixed = names[:len(plan.firsts)], names[len(plan.firsts):]
        size, first = self.kind.UNKNOWNS, self._first
        width = recurrences.places(size + self.based)
        at = width * (ORDER + 1)
        kept = {f'the_{STEADY}{k}': name for k, name in enumerate(kept)} | once
        self.room = at + len(kept)
        before = [*(f'    {name} = p[{first + k}]' for k, name in enumerate(lines.values)),
                  *before]
        ys = ''.join(f'the__y{k}, ' for k in range(size))
        return '\n'.join([
            HEAD,
            f'from {hinged.__name__} import angle_between, less_turns, load_attitude, load_start',
            '\n\n@compiled\ndef prepare(p, S):',
            *before,
            *lines.lines[:early],
            *(f'    S[{at + k}] = {text}' for k, text in enumerate(kept.values())),
            '',
        ]), '\n'.join([
            f'from {recurrences.__name__} import expansion as kernel_for',
            '',
            f'expansion = kernel_for({plan.steps!r}, {plan.rates + plan.bases!r}, {width})',
            '\n\n@compiled\ndef expand(p, S, y):',
            f'    {ys}= y',
            *before,
            *(f'    {name} = S[{at + k}]' for k, name in enumerate(kept)),
            *each_step,
            *lines.lines[early:],
            f'    expansion(S, (({ys}), ({_listed(firsts)}), ({_listed(fixed)})))',
            '',
        ])

    def _of_start(self, lines):
        """Return what the formulas need of a start.

        Lines that name it; name -> text of what is kept; and lines of each step.
        """
        place, first = (', '.join(f'the__{name}' for name in names) for names in (STARTED, FIRST))
        begin = [f'    {place} = load_start(p).place']
        if not self.on_hinge:
            return begin, {}, []
        axis, zero = (''.join(f'{lines.value(f"{name}{k}", part)}, '
                              for k, part in enumerate(parts)) for name, parts in (
                                  ('hinge', self.frame.hinge.axis),
                                  ('zero', self.frame.hinge.zero)))
        first = f'({first})'
        return ([*begin, f'    {first} = load_attitude(p)'],
                {'turned': f'angle_between(({zero}), {first}, ({axis}))'},
                [f'    the__{TURNED} = less_turns(turned, the__y0)'])


def _apart(trees):
    """Return the parts that are the same in all steps, and trees with names in their place."""
    parts = tree.parts(*trees)
    changing, parted, steady = set(), {}, {}
    for one in parts:
        leaf = one.op in ('number', 'name')
        if (one.args[0].startswith(UNKNOWN) or one is own(TURNED) if one.op == 'name'
                else not leaf and any(arg in changing for arg in one.args)):
            changing.add(one)

    def name_of(one):
        if one in changing or one.op in ('number', 'name'):
            return parted[one]
        return steady.setdefault(one, tree.term('name', f'{STEADY}{len(steady)}'))
    for one in parts:
        parted[one] = (tree.term(one.op, *map(name_of, one.args))
                       if one in changing and one.op != 'name' else one)
    found = [name_of(one) for one in trees]
    return list(steady), found


def _listed(names):
    return ''.join(f'{name}, ' for name in names)
