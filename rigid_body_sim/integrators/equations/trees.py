# SPDX-License-Identifier: Apache-2.0
"""The equations of a scene as trees: the rates of its unknowns, written with these unknowns.

Euler's equations, what acts in numbers, and the formulas of effects (Formulas of
scene/effects/protocol.py). The unknowns are those of the templates (equations.py).
"""

import numpy as np

from rigid_body_sim.integrators.equations import euler
from rigid_body_sim.integrators.equations.euler import DRIFT, OMEGA, PLACE
from rigid_body_sim.integrators.equations.half_angles import Sums
from rigid_body_sim.integrators.equations.plan import rewritten, unknown
from rigid_body_sim.numerics.rotations import matrix, rotate
from rigid_body_sim.scene.expressions import path, source, tree, vectors
from rigid_body_sim.scene.expressions.source import IDENTITY

STARTED = 'start_x', 'start_y', 'start_z'
FIRST = 'first_x', 'first_y', 'first_z', 'first_w'
TURNED = 'turned'
"""Numbers of a start: the place of a point that is held (less its path, where it has one); on a
hinge the attitude where phi is 0, and its angle less phi."""


def own(name):
    """Return the term of a name that no parameter of a scene can have."""
    return tree.term('name', f'_{name}')


class Trees:
    """The rates of a scene's unknowns as trees.

    Parameters
    ----------
    equations : equations.Equations
        They say which unknowns there are.
    actors : list of Effect
        What acts.
    fixed : array
        Euler's numbers, as the templates have them.

    Attributes
    ----------
    rates : list of Terms
        Rates of the unknowns, made of these (`unknown`), of parameters and of own names.
    parameters : dict of str to float
        Parameters of the formulas.
    """

    def __init__(self, equations, actors, fixed):
        self._equations, self._frame = equations, equations.frame
        self._actors, self._fixed = actors, fixed
        self._times = (-np.inf, *equations.breakpoints)
        self._static, self.parameters = {}, {}
        self._of_frame = self._frame_definitions()
        rates = self._on_axis() if equations.on_hinge else self._free()
        if equations.in_field:
            rates.append(tree.ONE)
        self.rates = rewritten(rates, self._definitions(), self.parameters)
        if equations.on_hinge:
            self.rates = Sums(unknown(0)).of(self.rates)

    def numbers(self, time):
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

    def _pulls(self, time):
        return [actor.series(self._frame, time) for actor in self._actors]

    def _vector(self, name, count=3):
        """Return the terms of numbers that may change with time; those that stay 0 are ZERO."""
        tables = [self.numbers(time) for time in self._times]
        names = [f'_{name}{k}' for k in range(count)]
        return tuple(tree.term('name', one) if any(table[one] for table in tables) else tree.ZERO
                     for one in names)

    def _constants_of(self, name, values):
        """Return the terms of numbers that never change."""
        names = [f'_{name}{k}' for k in range(len(values))]
        self._static |= dict(zip(names, map(float, values), strict=True))
        return tuple(tree.term('name', one) if value else tree.ZERO
                     for one, value in zip(names, values, strict=True))

    def _acting(self, omega):
        """Return torque (frame components) and force (world components) of all that acts."""
        frame = self._frame
        formulas = [one for pull in self._pulls(-np.inf) for one in pull.formulas]
        force, about = self._vector('force'), vectors.to_body(self._vector('couple'))
        torque, pushing = self._vector('constant'), self._vector('force')
        if not frame.moves:
            arm = self._constants_of('arm', rotate(*frame.axes, *frame.arm))
            about = vectors.total(about, vectors.cross(arm, vectors.to_body(force)))
        for one in formulas:
            self.parameters |= dict(one.parameters)
        for one in formulas:
            turn, push = one.torque, one.force
            if one.of_frame:
                x, y, z, *push = rewritten([*turn, *push], self._of_frame, self.parameters)
                torque = vectors.total(torque, (x, y, z))
            else:
                about = vectors.total(about, turn)
            pushing = vectors.total(pushing, push)
        axes = self._axes()
        if axes is not None:
            about = tuple(vectors.dot(column, about) for column in zip(*axes, strict=True))
        torque = vectors.total(about, torque)
        drag = _rows(self._vector('drag', 9))
        return vectors.total(torque, tuple(vectors.dot(row, omega) for row in drag)), pushing

    def _on_axis(self):
        """Return the rates of a body on a hinge."""
        n = self._constants_of('axis', self._frame.hinge.axis)
        torque, _ = self._acting(tuple(tree.times(part, unknown(1)) for part in n))
        inverse, = self._constants_of('inverse', self._inverse[:1])
        return [unknown(1), tree.times(inverse, vectors.dot(n, torque))]

    @property
    def _inverse(self):
        return self._fixed[euler.EQUATION.part('inverse').places]

    def _free(self):
        """Return the rates of a body that turns in all directions."""
        omega = tuple(unknown(OMEGA + k) for k in range(3))
        torque, force = self._acting(omega)
        share = self._constants_of('euler', self._fixed[euler.EQUATION.part('euler').places])
        inverse = self._constants_of('inverse', self._inverse)
        rates = [*_turning([unknown(k) for k in range(OMEGA)], omega), *(
            tree.plus(tree.times(share[k], tree.times(omega[k - 2], omega[k - 1])),
                      tree.times(inverse[k], torque[k])) for k in range(3))]
        if self._equations.drifts:
            drift = tuple(unknown(DRIFT + k) for k in range(3))
            pushed = (tree.ZERO,) * 3
            if self._frame.moves:
                slowing = self._slowing()
                force = vectors.difference(
                    force, tuple(tree.times(slowing, part) for part in drift))
                lightness, = self._constants_of('lightness', [1.0 / self._frame.mass])
                pushed = tuple(tree.times(lightness, part) for part in force)
            rates += [*drift, *pushed]
        return rates

    def _slowing(self):
        return (own('slowing') if any(self.numbers(time)['_slowing'] for time in self._times)
                else tree.ZERO)

    def _axes(self):
        """Return the matrix that turns frame components into body components; None if 1."""
        if tuple(self._frame.axes) == IDENTITY:
            return None
        found = self._constants_of('turn', np.ravel(matrix(*self._frame.axes)).tolist())
        return _rows(found)

    def _frame_definitions(self):
        """Return the definitions of the names in kernels of effects: those of the frame."""
        frame, place, drift = self._frame, map(own, STARTED), (tree.ZERO,) * 3
        if self._equations.on_hinge:
            n = self._constants_of('axis', frame.hinge.axis)
            half = tree.times(tree.number(0.5), unknown(0))
            sine, cosine = tree.term('sin', half), tree.term('cos', half)
            turn = (*(tree.times(part, sine) for part in n), cosine)
            attitude = _product([own(name) for name in FIRST], turn)
            omega = tuple(tree.times(part, unknown(1)) for part in n)
        else:
            attitude = [unknown(k) for k in range(OMEGA)]
            omega = tuple(unknown(OMEGA + k) for k in range(3))
        if frame.moves:
            place, drift = (tuple(unknown(first + k) for k in range(3))
                            for first in (PLACE, DRIFT))
        elif frame.path is not None:
            self.parameters |= dict(frame.path.parameters)
            place = map(tree.plus, place, frame.path.trees)
            drift = path.velocities(frame.path.trees)
        clock = unknown(self._equations.kind.UNKNOWNS - 1)
        return _named((source.ATTITUDE, attitude), (source.RATES, omega), (source.PLACE, place),
                      (source.VELOCITY, drift), (source.TIME, (clock,)))

    def _definitions(self):
        """Return the definitions of the public names of the state: name -> tree of other names."""
        frame, of = self._frame, self._of_frame
        attitude, omega, place, drift, clock = (
            [of[name] for name in names] for names in (
                source.ATTITUDE, source.RATES, source.PLACE, source.VELOCITY, source.TIME))
        axes = self._axes()
        if axes is not None:
            x, y, z, w = self._constants_of('skew', frame.axes)
            back = (*(tree.negative(part) for part in (x, y, z)), w)
            attitude = _product(attitude, back)
            omega = tuple(vectors.dot(row, omega) for row in axes)
        point = self._constants_of('point', frame.point)
        rates = vectors.named(source.RATES)
        carried_along = vectors.to_world(vectors.cross(rates, point))
        found = _named(
            (source.ATTITUDE, attitude), (source.RATES, omega), (source.TIME, clock),
            (source.WORLD_RATES, vectors.to_world(rates)),
            (source.PLACE, vectors.difference(place, vectors.to_world(point))),
            (source.VELOCITY, vectors.difference(drift, carried_along)))
        if self._equations.on_hinge:
            found |= {'angle': tree.plus(unknown(0), own(TURNED)), 'rate': unknown(1)}
        return found


def _named(*groups):
    """Return name -> tree of pairs of names and trees."""
    return {name: one for names, trees in groups for name, one in zip(names, trees, strict=True)}


def _rows(nine):
    """Return nine terms as the rows of a matrix."""
    three = iter(nine)
    return tuple(zip(three, three, three, strict=True))


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
