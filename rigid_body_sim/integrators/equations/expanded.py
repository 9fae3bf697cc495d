# SPDX-License-Identifier: Apache-2.0
"""The equations of a scene as trees, and the plan of their Taylor series.

The rates of the unknowns (equations.py) are written as trees of these unknowns: Euler's equations,
what acts in numbers, and the formulas of effects (Formulas of scene/effects/protocol.py).
marching/recurrences.py has the recurrences of the plan. The first coefficients are computed as
kernels compute the parts of an expression (scene/expressions/source.py).
"""

import math
import operator

import numpy as np

from rigid_body_sim.errors import BadInput
from rigid_body_sim.integrators.equations import euler, hinged, hinged_field
from rigid_body_sim.integrators.equations.equations import Equations
from rigid_body_sim.integrators.equations.euler import CLOCK, DRIFT, OMEGA, PLACE
from rigid_body_sim.integrators.equations.series import refusal
from rigid_body_sim.integrators.marching import recurrences
from rigid_body_sim.numerics.rotations import matrix, rotate
from rigid_body_sim.scene.expressions import source, tree, vectors
from rigid_body_sim.scene.expressions.source import HEAD, IDENTITY, Lines

MOST = 200
"""Most products of series in a plan: with more of them compiling takes longer than most runs."""
LARGEST = 64
"""Largest whole power that is multiplied out."""
STARTED = 'start_x', 'start_y', 'start_z'
FIRST = 'first_x', 'first_y', 'first_z', 'first_w'
TURNED = 'turned'
"""Numbers of a start: the place of a point that is held; on a hinge the attitude where phi is 0,
and its angle less phi."""


def own(name):
    """Return the node of a name that no parameter of a scene can have."""
    return tree.node('name', f'_{name}')


def unknown(place):
    """Return the node of an unknown."""
    return own(f'y{place}')


class Expanded(Equations):
    """The equations of a scene whose effects all have the view `series`, with formulas.

    Attributes
    ----------
    rates : list of Nodes
        Of the unknowns, made of these (`unknown`) and of names whose values `named` has.
    named : dict of str to float
        The numbers at the beginning. A start on a hinge or a pivot adds those of its own.
    expand : str
        Source of ``expand(p, S, y)``: the coefficients of the unknowns.

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
        self._parameters = {}
        self._static = {}
        self._times = (-np.inf, *self.breakpoints)
        rates = self._rates(scene)
        self.rates = rewritten(rates, self._definitions(), self._parameters)
        plan = Plan(self.rates)
        if plan.products > MOST:
            raise BadInput('integrator', f'taylor cannot run the scene {scene.name}: its formulas '
                           f'take {plan.products} products of series',
                           f'at most {MOST}: dop8 and gauss16 take more')
        self.named = self._parameters | self._numbers(-np.inf)
        lines = Lines(self.named)
        self.expand = self._expand(plan, lines)
        self._values, self.parameter_count = lines.values, self._first + len(lines.values)

    @property
    def _first(self):
        """The place of the plan's values in the parameters."""
        return super().parameters(self._fixed, -np.inf).size

    def parameters(self, fixed, time):
        """Return the parameters that hold just after a time, those of the plan behind the rest."""
        before = super().parameters(fixed, time)
        changing = {f'parameter_{name}': value for name, value in self._numbers(time).items()}
        return np.array([*before, *(self._values | {
            name: changing[name] for name in self._values if name in changing}).values()])

    def _pulls(self, time):
        return [actor.series(self.frame, time) for actor in self._actors]

    def _numbers(self, time):
        """Return the numbers of the equations at a time: name -> value."""
        found = dict(self._static)
        for name, shape in (('constant', 3), ('force', 3), ('couple', 3), ('drag', 9)):
            total = np.zeros(shape)
            for pull in self._pulls(time):
                total += np.ravel(getattr(pull, name) or 0.0)
            found |= {f'_{name}{k}': part for k, part in enumerate(total.tolist())}
        slowing = 0.0    # added one by one: what `sum` does depends on the version of Python
        for pull in self._pulls(time):
            slowing += pull.slowing
        return found | {'_slowing': slowing}

    def _vector(self, name, count=3):
        """Return the nodes of numbers that may change with time; those that stay 0 are ZERO."""
        tables = [self._numbers(time) for time in self._times]
        names = [f'_{name}{k}' for k in range(count)]
        return tuple(tree.node('name', one) if any(table[one] for table in tables) else tree.ZERO
                     for one in names)

    def _constants_of(self, name, values):
        """Return the nodes of numbers that never change."""
        names = [f'_{name}{k}' for k in range(len(values))]
        self._static |= dict(zip(names, map(float, values), strict=True))
        return tuple(tree.node('name', one) if value else tree.ZERO
                     for one, value in zip(names, values, strict=True))

    def _rates(self, scene):
        """Return the rates of the unknowns, trees of public names and of their own.

        More than forty lines: the equations of motion, term by term.
        """
        frame = self.frame
        formulas = [one for pull in self._pulls(-np.inf) for one in pull.formulas]
        for one in formulas:
            self._parameters |= dict(one.parameters)
        force, about = self._vector('force'), vectors.to_body(self._vector('couple'))
        for one in formulas:
            about = vectors.total(about, one.torque)
        if not frame.moves:
            arm = self._constants_of('arm', rotate(*frame.axes, *frame.arm))
            about = vectors.total(about, vectors.cross(arm, vectors.to_body(force)))
        axes = self._axes()
        torque = about if axes is None else tuple(
            vectors.dot(column, about) for column in zip(*axes, strict=True))
        torque = vectors.total(torque, self._vector('constant'))
        drag = _rows(self._vector('drag', 9))
        if self.kind in (hinged, hinged_field):
            n = self._constants_of('axis', scene.constraint.axis)
            omega = tuple(tree.times(part, unknown(1)) for part in n)
            torque = vectors.total(torque, tuple(vectors.dot(row, omega) for row in drag))
            inverse, = self._constants_of('inverse', [1.0 / self._moment])
            rates = [unknown(1), tree.times(inverse, vectors.dot(n, torque))]
            return [*rates, tree.ONE] if self.kind is hinged_field else rates
        omega = tuple(unknown(OMEGA + k) for k in range(3))
        torque = vectors.total(torque, tuple(vectors.dot(row, omega) for row in drag))
        share = self._constants_of('euler', self._fixed[euler.EQUATION.part('euler').places])
        inverse = self._constants_of('inverse',
                                     self._fixed[euler.EQUATION.part('inverse').places])
        rates = [*_turning([unknown(k) for k in range(OMEGA)], omega), *(
            tree.plus(tree.times(share[k], tree.times(omega[k - 2], omega[k - 1])),
                      tree.times(inverse[k], torque[k])) for k in range(3))]
        if self.kind.UNKNOWNS > PLACE:
            drift = tuple(unknown(DRIFT + k) for k in range(3))
            pushed = (tree.ZERO,) * 3
            if frame.moves:
                for one in formulas:
                    force = vectors.total(force, one.force)
                slowing = self._slowing()
                force = vectors.difference(
                    force, tuple(tree.times(slowing, part) for part in drift))
                lightness, = self._constants_of('lightness', [1.0 / frame.mass])
                pushed = tuple(tree.times(lightness, part) for part in force)
            rates += [*drift, *pushed]
        return [*rates, tree.ONE] if self.kind.UNKNOWNS > CLOCK else rates

    def _slowing(self):
        return (own('slowing') if any(self._numbers(time)['_slowing'] for time in self._times)
                else tree.ZERO)

    def _axes(self):
        """Return the matrix that turns frame components into body components; None if 1."""
        if tuple(self.frame.axes) == IDENTITY:
            return None
        found = self._constants_of('turn', np.ravel(matrix(*self.frame.axes)).tolist())
        return _rows(found)

    def _definitions(self):
        """Return what the public names of the state are: name -> tree of public and own names."""
        frame, found = self.frame, {}
        if self.kind in (hinged, hinged_field):
            n = self._constants_of('axis', frame.hinge.axis)
            half = tree.times(tree.number(0.5), unknown(0))
            sine, cosine = tree.node('sin', half), tree.node('cos', half)
            turn = (*(tree.times(part, sine) for part in n), cosine)
            attitude = _product([own(name) for name in FIRST], turn)
            omega = tuple(tree.times(part, unknown(1)) for part in n)
            found |= {'angle': tree.plus(unknown(0), own(TURNED)), 'rate': unknown(1)}
            clock = unknown(2)
        else:
            attitude = [unknown(k) for k in range(OMEGA)]
            omega = tuple(unknown(OMEGA + k) for k in range(3))
            axes = self._axes()
            if axes is not None:
                x, y, z, w = self._constants_of('skew', frame.axes)
                back = (*(tree.negative(part) for part in (x, y, z)), w)
                attitude = _product(attitude, back)
                omega = tuple(vectors.dot(row, omega) for row in axes)
            clock = unknown(CLOCK)
        place, drift = tuple(own(name) for name in STARTED), (tree.ZERO,) * 3
        if frame.moves:
            place, drift = (tuple(unknown(first + k) for k in range(3))
                            for first in (PLACE, DRIFT))
        point = self._constants_of('point', frame.point)
        carried = vectors.to_world(vectors.cross(vectors.named(source.RATES), point))
        for names, trees in (
                (source.ATTITUDE, attitude), (source.RATES, omega), (source.TIME, (clock,)),
                (source.WORLD_RATES, vectors.to_world(vectors.named(source.RATES))),
                (source.PLACE, vectors.difference(place, vectors.to_world(point))),
                (source.VELOCITY, vectors.difference(drift, carried))):
            found |= dict(zip(names, trees, strict=True))
        return found

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
            f'expansion = kernel_for({plan.steps!r}, {plan.rates!r}, {recurrences.places(size)})',
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
        if self.kind not in (hinged, hinged_field):
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


def _rows(nine):
    """Return nine nodes as the rows of a matrix."""
    three = iter(nine)
    return tuple(zip(three, three, three, strict=True))


def _listed(names):
    return ''.join(f'{name}, ' for name in names)


def _turning(q, omega):
    """Return q' = q omega/2, trees."""
    half = tree.number(0.5)
    return [tree.times(half, part) for part in _product(q, (*omega, tree.ZERO))]


def _product(p, q):
    """Return the quaternion product p q, trees."""
    px, py, pz, pw = p
    qx, qy, qz, qw = q

    def total(*terms):
        found = tree.ZERO
        for sign, a, b in terms:
            found = (tree.plus if sign > 0 else tree.minus)(found, tree.times(a, b))
        return found
    return [total((1, pw, qx), (1, px, qw), (1, py, qz), (-1, pz, qy)),
            total((1, pw, qy), (1, py, qw), (1, pz, qx), (-1, px, qz)),
            total((1, pw, qz), (1, pz, qw), (1, px, qy), (-1, py, qx)),
            total((1, pw, qw), (-1, px, qx), (-1, py, qy), (-1, pz, qz))]


def rewritten(trees, definitions, parameters):
    """Return trees in which names are what definitions say, made of what recurrences know.

    Whole powers are multiplied out; a tangent is a quotient, and a power of a changing exponent an
    exponential.
    """
    found = {}

    def of(one):
        if one in found:
            return found[one]
        if one.op == 'name' and one.args[0] in definitions:
            made = of(definitions[one.args[0]])
        elif one.op in ('number', 'name'):
            made = one
        else:
            args = [of(arg) for arg in one.args]
            if one.op == '^' and not _changes(args[1]):
                args[1] = _whole(args[1], parameters)
            made = _remade(one.op, args)
        found[one] = made
        return made
    return [of(one) for one in trees]


RULES = {'+': tree.plus, '-': tree.minus, '*': tree.times, '/': tree.over,
         'negative': tree.negative}


def _remade(op, args):
    """Return the node of an operation on trees that are rewritten already."""
    if op in RULES:
        return RULES[op](*args)
    if op == 'tan':
        return tree.over(tree.node('sin', *args), tree.node('cos', *args))
    if op != '^':
        return tree.node(op, *args)
    base, exponent = args
    if exponent is tree.ZERO:
        return tree.ONE
    if _changes(exponent):
        return tree.node('exp', tree.times(exponent, tree.node('log', base)))
    if exponent.op == 'number' and abs(exponent.args[0]) in range(1, LARGEST + 1):
        whole = _whole_power(base, int(abs(exponent.args[0])))
        return whole if exponent.args[0] > 0.0 else tree.over(tree.ONE, whole)
    if exponent.op == 'number' and exponent.args[0] == 0.5:
        return tree.node('sqrt', base)
    return tree.node('^', base, exponent)


def _whole(exponent, parameters):
    """Return an exponent that does not change, as a number where it is a whole one or a half."""
    by_number = {'+': operator.add, '-': operator.sub, '*': operator.mul}

    def value(one):
        if one.op in by_number:
            return by_number[one.op](*map(value, one.args))
        if one.op == 'negative':
            return -value(*one.args)
        known = one.args[0] if one.op in ('number', 'name') else math.nan
        return parameters.get(known, math.nan) if one.op == 'name' else known
    found = value(exponent)
    known = abs(found) == 0.5 or abs(found) in range(LARGEST + 1)
    return tree.number(found) if known else exponent


def _whole_power(base, exponent):
    """Return a power by squares."""
    if exponent == 1:
        return base
    half = _whole_power(base, exponent // 2)
    square = tree.times(half, half)
    return tree.times(square, base) if exponent % 2 else square


def _changes(one):
    return any(name.startswith('_y') for name in tree.names(one))


class Plan:
    """The steps that make the series of trees.

    Attributes
    ----------
    steps : tuple
        (op, operands ...), as recurrences.py reads them.
    rates : tuple
        The operand of each tree; None of a tree that is 0.
    firsts, fixed : list of Nodes
        The first coefficient of each step; what steps take beside series.
    products : int
        The Cauchy products of an order.
    """

    def __init__(self, trees):
        self._place, self._fixed, self.firsts, self._steps = {}, {}, [], []
        self._changing = set()
        for one in tree.parts(*trees):
            if one.op == 'name':
                changes = one.args[0].startswith('_y')
            else:
                changes = any(arg in self._changing for arg in one.args)
            if changes:
                self._changing.add(one)
                if one not in self._place:
                    self._append(one)
        self.rates = tuple(None if one is tree.ZERO else self._operand(one) for one in trees)
        self.steps, self.fixed = tuple(self._steps), list(self._fixed)
        weights = {'*': 1, '/': 1, 'exp': 1, 'sin': 1, 'cos': 1, 'tanh': 2, 'log': 1, 'sqrt': 1,
                   '^': 2}
        self.products = sum(weights.get(step[0], 0) for step in self._steps)

    def _number(self, one):
        """Return the operand of what does not change, or changes from call to call only."""
        return -1 - self._fixed.setdefault(one, len(self._fixed))

    def _operand(self, one):
        return self._place[one] if one in self._changing else self._number(one)

    def _put(self, one, *step):
        self._place[one] = len(self._steps)
        self._steps.append(step)
        self.firsts.append(one)

    def _append(self, one):
        """Append the step of a node that changes."""
        op, operands = one.op, [self._operand(arg) for arg in one.args if one.op != 'name']
        inverse = tree.node('/', tree.ONE, one.args[-1]) if op == '/' else None
        match op:
            case 'name':
                self._put(one, 'unknown', int(one.args[0].removeprefix('_y')))
            case '*' if min(operands) < 0:
                self._put(one, 'scaled', max(operands), min(operands))
            case '/' if operands[1] < 0:
                self._put(one, 'scaled', operands[0], self._number(inverse))
            case '/':
                self._put(one, '/', *operands, self._number(inverse))
            case 'sin' | 'cos':
                for which in ('sin', 'cos'):
                    pair = tree.node(which, *one.args)
                    self._changing.add(pair)
                    self._put(pair, which, *operands)
            case 'log':
                self._put(one, op, *operands, self._number(tree.node('/', tree.ONE, *one.args)))
            case 'sqrt':
                self._put(one, op, *operands,
                          self._number(tree.node('/', tree.number(0.5), one)))
            case '^':
                self._put(one, op, *operands, self._number(tree.node('/', tree.ONE, one.args[0])))
            case _:
                self._put(one, op, *operands)
