# SPDX-License-Identifier: Apache-2.0
"""Family of the collocation methods: gauss16.

On a plane its steps are those of marching/contact_gauss_step.py.

The kernels that depend on the number of unknowns are made as source text for gauss_march.py. Loops
over the eight stages are the inner ones, on arrays in which the stages of an unknown lie side by
side: the compiler makes vector code of them without being allowed to reorder any sum.
"""

import functools

import numpy as np

from rigid_body_sim.compilation.templates import specialise
from rigid_body_sim.integrators.equations import equations as general
from rigid_body_sim.integrators.equations.relaxation import stiff_relaxations
from rigid_body_sim.integrators.families import one_step
from rigid_body_sim.integrators.marching import gauss_march, relaxing, unroll
from rigid_body_sim.integrators.marching.gauss_nodes import STAGES
from rigid_body_sim.integrators.marching.points import CONTROL, VALUES, Control
from rigid_body_sim.integrators.protocols import FINEST  # noqa: F401
from rigid_body_sim.mechanics.bounds import cancelling
from rigid_body_sim.scene.constraints.protocol import Mechanism

ASKS = {'accuracy': (), 'step': ()}
TABLE = False
TAKES_WRENCH = True
LANES = False
KINKS = True
ROOTS = False
FLOOR = 2.0 ** -50          # share of the unknowns that is rounding
RELAXED_FLOOR = 2.0 ** -39  # the same where slopes of the stages take the place of rates
RELAXED_SETTLED = 2.0 ** -46
CLOCK = 2.0 ** -50          # share of the time that is rounding
TERMS = 2 * STAGES + 1      # polynomials of a curve: P_0 ... P_16


def bind(method, stepped):
    """Return the method's kernels on the equations of a scene."""
    if stepped.scene.constraint.mechanism is Mechanism.PLANE:
        # only now: a dozen modules of contact, which no other scene needs
        from rigid_body_sim.integrators.marching import contact, contact_gauss
        if stepped.wrench:
            return contact.OnPlane(stepped.scene, method, stepped.wrench, stepped.step)
        return contact_gauss.OnPlaneByGauss(stepped.scene, method, stepped.step)
    return one_step.bind(method, stepped)


class Equations(general.Equations):
    """The equations of a scene, with what stiff drag relaxes.

    Attributes
    ----------
    relaxations : list of Relaxation
        Empty where no drag is stiff.
    """

    def __init__(self, scene, wrench=None):
        super().__init__(scene, wrench)
        self.relaxations = stiff_relaxations(scene, self.kind.UNKNOWNS)


def equations_of(scene, wrench):
    """Return the equations of a scene that `march` is for."""
    return Equations(scene, wrench)


def march(method, equations, adapts):
    """Return the module that marches: gauss_march.py bound to equations."""
    size, kernels = equations.kind.UNKNOWNS, equations.kernels.__name__
    return specialise(
        gauss_march, rate=f'{kernels}:rate', settled=f'{kernels}:settled',
        relax=_relax(equations.relaxations, _places(size)), hidden=_hidden(equations.polynomial),
        FLOOR=f'FLOOR = {RELAXED_FLOOR if equations.relaxations else FLOOR!r}\n',
        CLOCK=f'CLOCK = {CLOCK if equations.timed else 0.0!r}\n',
        SETTLED=f'SETTLED = {RELAXED_SETTLED if equations.relaxations else 0.0!r}\n',
        **_of_unknowns(size, equations.groups, equations.parameter_count))


@functools.cache
def _of_unknowns(size, groups, parameter_count):
    """Return the bindings of gauss_march.py that depend on the unknowns and their number."""
    relative = sum(not absolute for _, _, absolute in groups)
    places = _places(size)
    return {
        **{name: f'{name} = {place}\n' for name, place in places.items()},
        'load': unroll.load_source('load', size), 'put': unroll.put_source('put', size),
        'load_scales': unroll.load_source('load_scales', relative),
        'put_scales': unroll.put_source('put_scales', relative),
        'stage_rates': _stage_rates(size, parameter_count), 'spread': _spread(size),
        'combined': _combined(size, places['RATES']), 'advanced': _advanced(size),
        'along': _along(size, places['CURVE']),
        'end_of_curve': _end_of_curve(size, places['CURVE']),
        'measure': _measure(groups), 'by_group': _by_group(groups), 'grown': _grown(groups),
        'fastest': unroll.fastest_source(groups), 'first_scales': _first_scales(groups),
        'pulled': _pulled(groups), 'balanced': unroll.balanced_source(groups),
        'FLIGHT': f'FLIGHT = {unroll.flight(groups)!r}\n'}


def _places(size):
    """Return the counts and places of gauss_march.py for `size` unknowns."""
    last, rates, square = VALUES + 2 * size, STAGES * size, STAGES * STAGES
    matrix = rates + STAGES * size
    predictor, between, steps = (matrix + k * square for k in (1, 2, 3))
    curve = steps + 5
    return {'SIZE': size, 'LAST': last, 'SWEEPS': last + 1, 'KEPT': last + 2,
            'RATES': rates, 'MATRIX': matrix, 'PREDICTOR': predictor, 'BETWEEN': between,
            'FOR': steps, 'FOR_STEP': steps + 1, 'FOR_BEFORE': steps + 2, 'FOR_POINT': steps + 3,
            'TAIL': steps + 4, 'CURVE': curve, 'ASIDE': curve + TERMS * size}


def _end(places):
    """Return the place behind what gauss_march.py keeps in S."""
    return places['ASIDE'] + STAGES * places['SIZE']


def _hidden(polynomial):
    """Return the binding of `hidden` in gauss_march.py: polynomials hide nothing."""
    arguments = 'p, S, y, h, mean, pull, scales, time'
    return _function(f'hidden({arguments})', [], '0.0' if polynomial else f'rough({arguments})')


def _relax(found, places):
    """Return the binding of `relax` in gauss_march.py: a kernel, or the source of an idle one.

    `found` are the Relaxations of the equations.
    """
    if not found:
        return _function('relax(S, y, h, fresh)', ['pass'])
    first = _end(places)
    blocks = tuple((one.first, len(one.rates), first + k * relaxing.PART)
                   for k, one in enumerate(found))
    bound = specialise(relaxing, BLOCKS=f'BLOCKS = {blocks!r}\n',
                       RATES=f'RATES = {places["RATES"]}\n')
    return f'{bound.__name__}:relax'


def begin(stepped, march):
    """Return (control, point) of a march, to be copied for each start."""
    found = stiff_relaxations(stepped.scene, march.SIZE)
    first = march.WORK + _end(_places(march.SIZE))
    control = np.zeros(first + relaxing.PART * len(found))
    for k, one in enumerate(found):
        part, n = control[first + k * relaxing.PART:], len(one.rates)
        part[relaxing.INTO:relaxing.INTO + n * n] = one.into.ravel()
        part[relaxing.BACK:relaxing.BACK + n * n] = one.back.ravel()
        part[relaxing.DECAY:relaxing.DECAY + n] = one.rates
    tolerance = stepped.accuracy / stepped.horizon if stepped.accuracy is not None else 0.0
    CONTROL.store(control, Control(tolerance, stepped.step or 0.0, 0.0))
    point = np.zeros(march.KEPT + STAGES * march.SIZE)
    turning, moving = cancelling(stepped.scene, stepped.horizon)
    control[march.TURNING], control[march.MOVING] = turning, moving
    if stepped.accuracy is not None:
        one_step.set_least_scales(stepped, moving, march.FLIGHT, point)
    return control, point


def _function(head, lines, result=None):
    """Return the source of a compiled kernel from its head, lines and result."""
    returned = [] if result is None else [f'    return {result}']
    indented = [f'    {line}' for line in lines]
    return '\n'.join(['@compiled', f'def {head}:', *indented, *returned, ''])


def _tuple(entries):
    """Return the text of a tuple."""
    return f'({"".join(f"{entry}, " for entry in entries)})'


def _stage_rates(n, parameters):
    """Return the source of ``stage_rates(p, S)``: rates at the eight stages."""
    stages = _tuple(f'S[{STAGES * u} + i]' for u in range(n))
    return _function('stage_rates(p, S)', [
        # a tuple: an array might overlap S, and numbers would be read anew at each stage
        f'numbers = {_tuple(f"p[{k}]" for k in range(parameters))}',
        f'for i in range({STAGES}):', f'    k = rate(numbers, {stages})',
        *(f'    S[{STAGES * (n + u)} + i] = k[{u}]' for u in range(n))])


def _spread(n):
    """Return the source of ``spread(S, y, at)``.

    Stages = y + the matrix at `at` times their rates, all unknowns in one loop.
    """
    lines = [f'f{u}_{j} = S[{STAGES * (n + u) + j}]' for u in range(n) for j in range(STAGES)]
    lines.append(f'for i in range({STAGES}):')
    lines += [f'    a{j} = S[at + {STAGES * j} + i]' for j in range(STAGES)]
    for u in range(n):
        total = _tree([f'a{j} * f{u}_{j}' for j in range(STAGES)])
        lines.append(f'    S[{STAGES * u} + i] = y[{u}] + ({total})')
    return _function('spread(S, y, at)', lines)


def _combined(size, rates):
    """Return the source of ``combined(S, row)``.

    The sum over the stages of row[j] times the rates, for each unknown.
    """
    sums = (_tree([f'row[{j}] * S[{rates + STAGES * u + j}]' for j in range(STAGES)])
            for u in range(size))
    return _function('combined(S, row)', [], _tuple(sums))


def _advanced(size):
    """Return the source of ``advanced(y, mean, c, h) -> (y, c)``.

    The step made, and what the sums lose (Kahan).
    """
    lines = [line for u in range(size)
             for line in (f'd{u} = h * mean[{u}] + c[{u}]', f's{u} = y[{u}] + d{u}')]
    return _function('advanced(y, mean, c, h)', lines,
                     f'{unroll.sums(size)}, {unroll.losses(size)}')


def _along(size, curve):
    """Return the source of ``along(S, y, x)``.

    y plus the curve at x, by the recurrence of Legendre's polynomials.
    """
    lines = ['p0, p1 = 1.0, x']
    for k in range(1, TERMS - 1):
        ahead, back = (2 * k + 1) / (k + 1), k / (k + 1)
        lines.append(f'p{k + 1} = {ahead!r} * (x * p{k}) - {back!r} * p{k - 1}')
    sums = (' + '.join(f'S[{curve + TERMS * u + k}] * p{k}' for k in range(TERMS))
            for u in range(size))
    return _function('along(S, y, x)', lines,
                     _tuple(f'y[{u}] + ({total})' for u, total in enumerate(sums)))


def _end_of_curve(n, curve):
    """Return the source of ``end_of_curve(S)``: the curve's last coefficients."""
    last = (f'S[{curve + TERMS * u + TERMS - 1}]' for u in range(n))
    return _function('end_of_curve(S)', [], _tuple(last))


def _squares(name, first, last):
    """Return the text of a sum of squares."""
    return ' + '.join(f'{name.format(u)} * {name.format(u)}' for u in range(first, last))


def _shares(groups, name):
    """Yield for each group of unknowns the text of its squared norm over its squared scale.

    Absolute groups are not scaled; `name` is the text of a component.
    """
    place = 0
    for first, last, absolute in groups:
        square = _squares(name, first, last)
        if absolute:
            yield square
        else:
            scale = f'scales[{place}]'
            yield f'({square}) / {scale} if {scale} > {unroll.NOTHING * unroll.NOTHING!r} else 0.0'
            place += 1


def _measure(groups):
    """Return the source of ``measure(a, b, share, scales)``.

    The squared norm of a - share b, group by group over the squared scales.
    """
    lines = ['total = 0.0']
    for (first, last, _), share in zip(groups, _shares(groups, 'd{}'), strict=True):
        lines += [f'd{u} = a[{u}] - share * b[{u}]' for u in range(first, last)]
        lines.append(f'total += {share}')
    return _function('measure(a, b, share, scales)', lines, 'total')


def _by_group(groups):
    """Return the source of ``by_group(a, scales)``.

    The squared norm of each group of unknowns over its squared scale.
    """
    return _function('by_group(a, scales)', [], _tuple(_shares(groups, 'a[{}]')))


def _grown(groups):
    """Return the source of ``grown(scales, y)``: the squared scales with the unknowns y met."""
    squares = [_squares('y[{}]', first, last) for first, last, absolute in groups if not absolute]
    entries = (f'max(scales[{place}], {square})' for place, square in enumerate(squares))
    return _function('grown(scales, y)', [], _tuple(entries))


def _first_scales(groups):
    """Return the source of ``first_scales(scales, y, k, h)``.

    The squared scales at y, where a first step h with rates k moves, at least `scales`.
    """
    relative = [(first, last) for first, last, absolute in groups if not absolute]
    entries = (f'max(scales[{place}], {_squares("y[{}]", first, last)}, '
               f'h * h * ({_squares("k[{}]", first, last)}))'
               for place, (first, last) in enumerate(relative))
    return _function('first_scales(scales, y, k, h)', [], _tuple(entries))


def _pulled(groups):
    """Return the source of ``pulled(turning, moving, h, scales)``.

    What the accelerations of terms that may cancel do in a step, as a share of the first relative
    group, and of velocity and place.
    """
    def share(size, place):
        least = unroll.NOTHING * unroll.NOTHING
        return f'({size} / math.sqrt(scales[{place}]) if scales[{place}] > {least!r} else 0.0)'
    shares = [share('turning * h', 0)]
    for place, size in zip(unroll.flight(groups), ('moving * h * h', 'moving * h'), strict=False):
        shares.append(share(size, place))
    return _function('pulled(turning, moving, h, scales)', [], ' + '.join(shares))


def _tree(terms):
    """Return the sum of terms, added in pairs: a shorter chain than one after the other."""
    while len(terms) > 1:
        pairs = zip(terms[::2], terms[1::2], strict=True)
        terms = [f'({left} + {right})' for left, right in pairs]
    return terms[0]
