# SPDX-License-Identifier: Apache-2.0
"""From trees to compiled kernels: straight-line code, each part of an expression computed once.

Numbers and parameters are values of the kernel, not part of its code: a scene with other numbers
uses the same compiled kernel.
"""

from dataclasses import dataclass

from rigid_body_sim.compilation.templates import module_of
from rigid_body_sim.numerics.rotations import matrix
from rigid_body_sim.scene.expressions import tree

IDENTITY = (0.0, 0.0, 0.0, 1.0)
TIME, PLACE, VELOCITY = ('t',), ('x', 'y', 'z'), ('vx', 'vy', 'vz')
ATTITUDE, RATES, WORLD_RATES = (('qx', 'qy', 'qz', 'qw'), ('wx', 'wy', 'wz'), ('Wx', 'Wy', 'Wz'))
HINGE = ('angle', 'rate')
STATE_NAMES = (*TIME, *PLACE, *VELOCITY, *ATTITUDE, *RATES, *WORLD_RATES, *HINGE)
"""Names of the state in expressions: time (s); place (m) and velocity (m/s) of the body's origin,
world axes; the quaternion body -> world; angular velocity (rad/s) in body and in world axes; the
angle of a hinge (rad, from -2 pi to 2 pi) and its rate (rad/s)."""
PLAIN = (0.0, 1.0, 2.0, 0.5)
"""Numbers that stay in the code, as they come from rules of calculus."""
INTEGER_POWERS = range(2, 9)
OR_ZERO = '/ or 0'
"""The operation of a quotient that is 0 where its divisor is 0; expressions cannot ask for it."""
CALLS = {'/': 'divided', 'log': 'logarithm', 'tan': 'tangent', 'tanh': 'hyperbolic_tangent',
         'sin': 'sin', 'cos': 'cos', 'exp': 'exp', OR_ZERO: 'divided_or_zero'}
KINKED = {'abs', 'sign', 'min', 'max', 'less'}
HEAD = """from rigid_body_sim.compilation.jit import compiled
from rigid_body_sim.numerics.functions import atan2, cos, exp, sin, sin_cos
from rigid_body_sim.numerics.rotations import multiply, rotate, rotate_back
from rigid_body_sim.numerics.vectors import apply, cross, minus, plus
from rigid_body_sim.scene.expressions.functions import (
    divided, divided_or_zero, hyperbolic_tangent, logarithm, raised, raised_beyond, root,
    root_beyond, side, tangent, wound)
"""


@dataclass(frozen=True)
class Kernel:
    """A kernel and its values.

    Attributes
    ----------
    name : str
        ``'module:function'``.
    values : tuple of floats
    """

    name: str
    values: tuple


class Lines:
    """The lines that compute trees, and the values that they ask for.

    Parameters
    ----------
    parameters : mapping of str to float

    Attributes
    ----------
    lines : list of str
    values : dict of str to float
    switches : dict of str to str
        Name of the value that holds the side of a switch -> the quantity that changes its sign
        at the kink.
    winding : str
        Name of the value that holds the side of the jump of a hinge's angle; empty where that is
        no kink.
    jumps : bool
        Whether the trees jump there.
    """

    def __init__(self, parameters):
        self._parameters, self._names = parameters, {}
        self.lines, self.values, self.switches = [], {}, {}
        self.winding, self.jumps = '', False

    def value(self, name, number):
        """Return the name of a value of the kernel."""
        self.values[name] = float(number)
        return name

    def wind(self):
        """Make a switch of the jump of a hinge's angle; what `prelude` gives computes it."""
        self.winding = self._mode('the_end')

    def of(self, *trees):
        """Add the lines that compute trees; return the names of the results.

        Parts with kinks come first: powers in their branches ask for the side of the kink.
        """
        kinked = [one for one in tree.parts(*trees) if one.op in KINKED]
        parts = dict.fromkeys(tree.parts(*kinked, *trees))
        for one in parts:
            if one in self._names:
                continue
            pair = one.op in ('sin', 'cos') and [tree.term(op, *one.args) for op in ('sin', 'cos')]
            if pair and all(each in parts for each in pair):
                self._names |= self._sine_and_cosine(pair)
            else:
                self._names[one] = self._line(one)
        return [self._names[one] for one in trees]

    def _sine_and_cosine(self, pair):
        """Add the line that computes both of an angle, in less time than one by one."""
        names = [f'{one.op}{len(self.lines)}' for one in pair]
        self.lines.append(f'    {", ".join(names)} = sin_cos({self._names[pair[0].args[0]]})')
        return dict(zip(pair, names, strict=True))

    def _line(self, one):
        if one.op == 'name':
            name, = one.args
            if name in self._parameters:
                return self.value(f'parameter_{name}', self._parameters[name])
            return f'the_{name}'
        if one.op == 'number':
            number, = one.args
            if number in PLAIN:
                return repr(number)
            known = next((name for name, value in self.values.items()
                          if value == number and name.startswith('number')), None)
            return known or self.value(f'number{len(self.values)}', number)
        args = [self._names[arg] for arg in one.args]
        operation = self._operation(one, args)
        name = f'part{len(self.lines)}'
        self.lines.append(f'    {name} = {operation}')
        return name

    def _side(self, switch):
        """Add the line that says on which side of a kink a state is; return its name."""
        for mode, known in self.switches.items():
            if known == switch:
                return f'side_{mode}'
        mode = self._mode(switch)
        self.lines.append(f'    side_{mode} = side({mode}, {switch})')
        return f'side_{mode}'

    def _mode(self, switch):
        """Return the name of the value that holds the side of a new switch."""
        mode = self.value(f'mode{len(self.switches)}', 0.0)
        self.switches[mode] = switch
        return mode

    def _beyond(self):
        """Return the text that says whether the state is beyond a kink."""
        return ' or '.join(f'side_{mode} * ({switch}) < 0.0'
                           for mode, switch in self.switches.items())

    def _power(self, *args):
        """Return the text of a power or root whose base may be negative beyond a kink only."""
        name = 'root' if len(args) == 1 else 'raised'
        if not self.switches:
            return f'{name}({", ".join(args)})'
        return f'{name}_beyond({", ".join((self._beyond(), *args))})'

    def _kinked(self, one, args):
        match one.op:
            case 'abs':
                return f'{self._side(args[0])} * {args[0]}'
            case 'sign':
                return self._side(args[0])
            case 'less':
                return f'1.0 if {self._side(f"{args[1]} - {args[0]}")} > 0.0 else 0.0'
            case 'min' | 'max':
                a, b = args
                switch = f'{b} - {a}' if one.op == 'min' else f'{a} - {b}'
                return f'{a} if {self._side(switch)} > 0.0 else {b}'

    def _operation(self, one, args):
        if one.op in KINKED:
            return self._kinked(one, args)
        if one.op == 'where':
            return f'{args[1]} if {args[0]} > 0.5 else {args[2]}'
        if one.op in ('+', '-', '*'):
            return f'{args[0]} {one.op} {args[1]}'
        if one.op == 'negative':
            return f'-{args[0]}'
        exponent = one.args[1].args[0] if one.op == '^' and one.args[1].op == 'number' else None
        if exponent in INTEGER_POWERS:
            # in this order: ((x x) x) x ...
            return ' * '.join([args[0]] * int(exponent))
        if exponent is not None and -exponent in (1, *INTEGER_POWERS):
            return f'divided(1.0, {" * ".join([args[0]] * int(-exponent))})'
        if exponent == 0.5:
            return self._power(args[0])
        if one.op in ('^', 'sqrt'):
            return self._power(*args)
        return f'{CALLS[one.op]}({", ".join(args)})'


def prelude(lines, used, frame):
    """Return the lines that compute the names of expressions from the arguments of kernels.

    Kernels are given the attitude and the angular velocity of a frame, and place and velocity of
    its point of reference (scene/frame.py).

    Parameters
    ----------
    lines : Lines
        Receives the values that are needed.
    used : set of str
        Of STATE_NAMES.
    frame : Frame or None
        None where only the time is used.
    """
    found = []
    own = frame is not None and frame.axes == IDENTITY    # the frame's axes are the body's
    if used & {*PLACE, *VELOCITY}:
        point = ', '.join(lines.value(f'point{k}', part)
                          for k, part in enumerate(frame.from_body(frame.point)))
    if used & {*ATTITUDE, 'angle'}:
        attitude = 'qx, qy, qz, qw'
        if not own:
            ax, ay, az, aw = (lines.value(f'axes{k}', part) for k, part in enumerate(frame.axes))
            attitude = f'multiply({attitude}, -{ax}, -{ay}, -{az}, {aw})'
        found.append(f'    {_names(ATTITUDE)} = {attitude}')
    if used & {*RATES, 'rate'}:
        rates = 'wx, wy, wz'
        if not own:
            rates = f'apply({frame_matrix(lines, frame)}, ({rates}))'
        found.append(f'    {_names(RATES)} = {rates}')
    if used & {*HINGE}:
        n = [lines.value(f'hinge{k}', part) for k, part in enumerate(frame.hinge.axis)]
    if 'rate' in used:
        terms = zip(n, RATES, strict=True)
        found.append(f'    the_rate = {" + ".join(f"{one} * the_{name}" for one, name in terms)}')
    if 'angle' in used:
        found += _angle(lines, frame, n)
    if used & {*WORLD_RATES}:
        found.append(f'    {_names(WORLD_RATES)} = rotate(qx, qy, qz, qw, wx, wy, wz)')
    if used & {*TIME}:
        found.append('    the_t = t')
    if used & {*PLACE}:
        found.append(f'    {_names(PLACE)} = minus((x, y, z), rotate(qx, qy, qz, qw, {point}))')
    if used & {*VELOCITY}:
        drift = '(vx, vy, vz)' if frame.pushed else '(0.0, 0.0, 0.0)'
        found.append(f'    {_names(VELOCITY)} = minus({drift}, rotate(qx, qy, qz, qw, '
                     f'*cross((wx, wy, wz), ({point}))))')
    return found


def _angle(lines, frame, n):
    """Return the lines that compute the angle of a hinge about n, three names of values."""
    zx, zy, zz, zw = (lines.value(f'zero{k}', part) for k, part in enumerate(frame.hinge.zero))
    sine, mode = f'{n[0]} * ux + {n[1]} * uy + {n[2]} * uz', lines.winding
    found = [f'    ux, uy, uz, uw = multiply(-{zx}, -{zy}, -{zz}, {zw}, {_names(ATTITUDE)})']
    if not mode:
        return [*found, f'    the_angle = 2.0 * atan2({sine}, uw)']
    return [*found, f'    the_angle, the_end = wound({mode}, {sine}, uw)',
            f'    side_{mode} = side({mode}, the_end)']


def frame_matrix(lines, frame, back=False):
    """Return the text of the matrix that turns frame components into body components.

    `back` transposes it. A product with it takes half the time of one with its quaternion.
    """
    names = [[lines.value(f'turn{i}{j}', part) for j, part in enumerate(row)]
             for i, row in enumerate(matrix(*frame.axes))]
    rows = zip(*names, strict=True) if back else names
    return '(' + ', '.join(f'({", ".join(row)})' for row in rows) + ')'


def _names(group):
    return ', '.join(f'the_{name}' for name in group)


def kernel(name, arguments, lines, before, result):
    """Return the Kernel of lines: a module of its own in the cache of compiled code.

    Parameters
    ----------
    name : str
    arguments : str
        Behind the values.
    lines : Lines
    before : list of str
        Lines in front.
    result : str
        What it returns.
    """
    values = ''.join(f'{one}, ' for one in lines.values)
    source = '\n'.join([HEAD, '', '@compiled', f'def {name}({values}{arguments}):', *before,
                        *lines.lines, f'    return {result}', ''])
    return Kernel(f'{module_of(source, "expression").__name__}:{name}',
                  tuple(lines.values.values()))
