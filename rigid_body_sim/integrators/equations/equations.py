# SPDX-License-Identifier: Apache-2.0
"""The equations of motion of one scene: a template bound to the sums of what acts, and numbers.

Effects that the scene does not list are not in the code.
"""

import bisect
import functools
from typing import NamedTuple

import numpy as np

from rigid_body_sim.compilation.templates import imported, specialise
from rigid_body_sim.errors import BadInput
from rigid_body_sim.integrators.equations import (
    carried,
    euler,
    field,
    flying,
    hinged,
    hinged_field,
    turning,
)
from rigid_body_sim.mechanics.parameters import scene_parameters
from rigid_body_sim.scene.state import TIME

STATE = 'qx, qy, qz, qw, wx, wy, wz, vx, vy, vz'
FIELD = ', t, x, y, z'
OMEGA = 'wx', 'wy', 'wz'
KEPT = 64    # sources that are kept for scenes that differ in numbers only


class Equations:
    """The equations of a scene.

    Parameters
    ----------
    scene : Scene
    wrench : effects.wrench.Wrench, optional
        Held command.

    Attributes
    ----------
    kind : module
        turning, flying, field, carried, hinged or hinged_field: which unknowns there are.
    on_hinge : bool
        Whether the unknowns are an angle and its rate.
    drifts : bool
        Whether place and velocity of the reference point are unknowns.
    kernels : module
        `kind` bound to what acts: ``rate(p, y)``, ``settled(y, c)``, ``start(p, vector, point,
        at)``, ``write(p, time, y, out)``.
    groups : tuple of (int, int, bool)
        Unknowns whose errors are measured together: first, end, whether against 1 or against
        their own largest size so far.
    write : str
        Where the last of them is: for :func:`rigid_body_sim.compilation.templates.specialise`.
    breakpoints : tuple of floats
        Times (s) at which the parameters jump.
    calls : tuple
        What acts, as text for the ..._source functions.
    parameter_count, fixed_count : int
        Of the parameters, and of those at their beginning that do not change at breakpoints.
    modes : list of int
        Where among the parameters the sides of the switches are, one for each switch.
    grip : float
        Largest torque with which dry friction holds a body on a hinge at rest, N m.
    gripping : list of int
        The switches of that friction, places in `modes`.
    in_field : bool
        Whether anything depends on time or place; then the time is the last unknown.
    timed : bool
        Whether anything depends on time.
    polynomial : bool
        Whether all that acts is polynomials of the unknowns.
    makes_heat : bool
        Whether anything depends on velocities: what books heat, and what declares it.

    Raises
    ------
    BadInput
        An effect gives a force where a bearing holds the body.
    """

    def __init__(self, scene, wrench=None):
        """Bind the kind of equations to what acts.

        More than forty lines: each attribute is made from those before it.
        """
        self.frame, self._body = scene.frame, scene_parameters(scene)
        self._actors = [effect for effect in scene.effects if effect.acting is not None]
        self._actors += [wrench] if wrench else []
        self.breakpoints = tuple(
            sorted({time for actor in self._actors for time in actor.breakpoints})
        )
        acting = self._acting(-np.inf)
        if not self.frame.pushed and any(one.gives == 'force' for one in acting):
            raise self._lost_force()
        path, self.on_hinge = self.frame.path, scene.constraint.axis is not None
        in_field = path is not None or any(one.in_field for one in acting)
        if path is not None:
            self.kind = carried
        elif self.on_hinge:
            self.kind = hinged_field if in_field else hinged
            refuse_no_moment(scene, self._body)
        else:
            self.kind = (field if in_field else
                         flying if any(one.gives == 'force' for one in acting) else turning)
        self.drifts = self.kind in (flying, field)
        fixed = hinged.PARAMETERS.size if self.on_hinge else euler.FIXED
        self.groups = self.kind.GROUPS
        if self.kind is turning and any(one.gives == 'turning' for one in acting):
            self.groups = turning.APART
        self.calls = calls = _calls(acting, fixed)
        count = fixed + sum(len(one.values) for one in acting)
        self.parameter_count = count + (len(path.values) if path is not None else 0)
        self.in_field = in_field
        self.timed = path is not None or any(one.timed for one in acting)
        self.polynomial = path is None and all(one.polynomial for one in acting)
        self.modes, self.gripping, self.grip = [], [], 0.0
        at = fixed
        for one in acting:
            if one.grip:
                self.grip += one.grip
                self.gripping += range(len(self.modes), len(self.modes) + len(one.modes))
            self.modes += [at + place for place in one.modes]
            at += len(one.values)
        self.makes_heat = any(one.books == 'heat' or one.of_motion for one in acting)
        state = STATE + FIELD if in_field else STATE
        if self.on_hinge:
            sources = {'torque': torque_source(calls, state)}
        else:
            sources = {'omega_rate': _omega_rate(calls, state),
                       'axes_rate': _axes_rate(calls, state)}
        if self.drifts:
            sources['force'] = force_source(calls, state)
        if path is not None:
            sources['path'] = path_source(path, count)
        self.kernels = specialise(self.kind, **sources)
        self.write = f'{self.kernels.__name__}:write'
        self._equation, self._held = self._equation_parameters(), {}
        self._fixed = (
            hinged.PARAMETERS.array(hinged.HingedParameters(self._equation, hinged.NO_ATTITUDE))
            if self.on_hinge else euler.EQUATION.array(self._equation))
        self.fixed_count = fixed

    def _lost_force(self):
        """Return the BadInput of an effect whose force a bearing would balance unnoticed."""
        name = next(actor.name for actor in self._actors if any(
            one.gives == 'force' for one in actor.acting(self.frame, -np.inf)))
        return BadInput(f'effects.{name}', 'gives a force, and a bearing holds the body',
                        'the torque of the force about the bearing is what acts')

    def switching_source(self):
        """Return the source of ``switching(p, q, omega, v, t, place)``: the switches, a tuple."""
        lines, found, at = [], [], self.fixed_count
        imports = []
        for number, one in enumerate(self._acting(-np.inf)):
            if one.switching:
                name = f'switching_{number}'
                imports.append(imported(one.switching, name))
                values = ''.join(f'p[{at + k}], ' for k in range(len(one.values)))
                lines.append(f'    found{number} = {name}({values}{STATE}{FIELD * one.in_field})')
                found += [f'found{number}[{k}]' for k in range(len(one.modes))]
            at += len(one.values)
        return '\n'.join([*imports, '', '', '@compiled', f'def switching(p, {STATE}{FIELD}):',
                          *lines, f'    return ({", ".join(found)},)', ''])

    def _acting(self, time):
        return [one for actor in self._actors for one in actor.acting(self.frame, time)]

    def _equation_parameters(self):
        """Return the EquationParameters, without the numbers that a start decides."""
        frame = self.frame
        moments = (0.0, 0.0, 0.0) if self.on_hinge else frame.moments
        inverse = [1.0 / moment if moment > 0.0 else 0.0 for moment in moments]
        if self.on_hinge:
            inverse[0] = 1.0 / self._body.hinge_moment
        share = [difference / moment if moment > 0.0 else 0.0 for difference, moment in zip(
            frame.differences, moments, strict=True)]
        return euler.EquationParameters(
            scene=self._body, euler=tuple(share), inverse=tuple(inverse),
            point=frame.from_body(frame.point), start=euler.NO_START, moves=float(frame.pushed))

    def held(self, time):
        """Return the parameters that hold just after a time, as an array of the caller's own.

        Those of the start are to be set.
        """
        k = bisect.bisect_right(self.breakpoints, time)
        if k not in self._held:
            self._held[k] = self.parameters(time)
        return self._held[k].copy()

    def continued(self, p, time):
        """Return the parameters that hold just after a time, of a start whose parameters are p."""
        held = self.held(time)
        held[:self.fixed_count] = p[:self.fixed_count]
        return held

    def start(self, vector):
        """Return (parameters, unknowns) of a start, a state vector (14)."""
        p, y = self.held(float(vector[TIME])), np.zeros(self.kind.UNKNOWNS)
        self.kernels.start(p, vector, y, 0)
        return p, y

    def parameters(self, time):
        """Return the parameters that hold just after a time.

        The fixed ones, then the values of all that acts, then those of a pivot's path.
        """
        acting = [value for one in self._acting(time) for value in one.values]
        path = self.frame.path.values if self.frame.path else ()
        return np.concatenate((self._fixed, acting, path))


def refuse_no_moment(scene, body):
    """Raise BadInput where a body, SceneParameters, has no moment about the axis that holds it."""
    if not body.hinge_moment > 0.0:
        raise BadInput(
            f'{scene.name}: constraint.hinge',
            'the moment of inertia about the axis is zero',
            'move the axis',
        )


class _Form(NamedTuple):
    """An Acting without its numbers: what the source of the equations depends on."""

    name: str        # of its kernel in that source
    imported: str    # the line that imports it
    gives: str
    books: str
    in_field: bool
    inner: bool
    count: int       # of its values

    @classmethod
    def of(cls, acting):
        """Return the form of an Acting."""
        module, _, function = acting.kernel.partition(':')
        name = f'{function}_{module.rpartition(".")[2]}'
        return cls(name, imported(acting.kernel, name), acting.gives, acting.books,
                   acting.in_field, acting.inner, len(acting.values))


class _Call:
    """One Acting, as text.

    The line that calls its kernel, and the names of its three components.
    """

    def __init__(self, form, number, at):
        self.gives, self.books, self.inner, self._first = form.gives, form.books, form.inner, at
        self.pulls = form.gives == 'torque' and form.books == 'potential'
        self.imported = form.imported
        values = ''.join(f'p[{at + k}], ' for k in range(form.count))
        self.x, self.y, self.z = (f'{self.gives}{number}_{axis}' for axis in 'xyz')
        state = STATE + FIELD * form.in_field
        self.lines = [f'    {self.x}, {self.y}, {self.z} = {form.name}({values}{state})']
        if self.gives == 'turning':    # what keeps L = R m: the torque m x u
            m = euler.MOMENTS
            self.turns = ux, uy, uz = self.x, self.y, self.z
            self.x, self.y, self.z = (f'inner{number}_{axis}' for axis in 'xyz')
            self.lines += [
                f'    m1, m2, m3 = p[{m}] * wx, p[{m + 1}] * wy, p[{m + 2}] * wz',
                f'    {self.x} = m2 * {uz} - m3 * {uy}',
                f'    {self.y} = m3 * {ux} - m1 * {uz}',
                f'    {self.z} = m1 * {uy} - m2 * {ux}',
            ]

    def fall(self, pulls):
        """Let the axes turn with the torque of potentials, too: c Gamma, c the first value."""
        if not pulls:
            return
        own, *rest = self.lines
        moved = [f'    {name} = {name} + p[{self._first}] * ({" + ".join(parts)})'
                 for name, parts in zip(self.turns, zip(*((one.x, one.y, one.z) for one in pulls),
                                                        strict=True), strict=True)]
        self.lines = [*(line for one in pulls for line in one.lines), own, *moved, *rest]
        self.imported = '\n'.join(dict.fromkeys([*(one.imported for one in pulls),
                                                 self.imported]))


def _calls(acting, at):
    """Return the calls of Actings, whose values stand in p from the place `at` on, a tuple.

    Actings that differ in numbers only get the same tuple, and with it the same sources.
    """
    return _calls_of(tuple(map(_Form.of, acting)), at)


@functools.lru_cache(maxsize=KEPT)
def _calls_of(forms, at):
    calls = []
    for number, form in enumerate(forms):
        calls.append(_Call(form, number, at))
        at += form.count
    for call in calls:
        if call.gives == 'turning':
            call.fall([one for one in calls if one.pulls])
    return tuple(calls)


def _kernel(name, calls, results, state=STATE):
    """Return the source of a kernel that makes the calls and returns the results (expressions)."""
    return '\n'.join(
        [
            *sorted({call.imported for call in calls}),
            '',
            '',
            '@compiled',
            f'def {name}(p, {state}):',
            *(line for call in calls for line in call.lines),
            f'    return ({"".join(f"{result}, " for result in results)})',
            '',
        ]
    )


def _sums(calls):
    return [' + '.join(getattr(call, axis) for call in calls) or '0.0' for axis in 'xyz']


def path_source(path, at):
    """Return the source of ``path(p, t)``; its values stand in p from the place `at` on."""
    values = ''.join(f'p[{at + k}], ' for k in range(len(path.values)))
    return '\n'.join([imported(path.name, 'along_path'), '', '', '@compiled', 'def path(p, t):',
                      f'    return along_path({values}t)', ''])


@functools.lru_cache(maxsize=KEPT)
def torque_source(calls, state=STATE):
    """Return the source of ``torque(p, q, omega, v)``, the sum of all torques."""
    calls = [call for call in calls if call.gives != 'force']
    return _kernel('torque', calls, _sums(calls), state)


@functools.lru_cache(maxsize=KEPT)
def force_source(calls, state=STATE):
    """Return the source of ``force(p, q, omega, v)``, the sum of all forces."""
    calls = [call for call in calls if call.gives == 'force']
    return _kernel('force', calls, _sums(calls), state)


def applied_source(acting, at):
    """Return the source of ``applied(p, q, omega, v, t, place)``, all that acts beside a contact.

    It returns force (world), couple (frame), the power of work and that which goes into heat, and
    the part of the couple that acts against parts inside the body. The values of the Actings stand
    in p from the place `at` on.
    """
    return _applied_source(_calls(acting, at))


@functools.lru_cache(maxsize=KEPT)
def _applied_source(calls):
    power = {'work': [], 'heat': [], 'potential': []}
    for call in calls:
        rates = ('vx', 'vy', 'vz') if call.gives == 'force' else OMEGA
        components = zip((call.x, call.y, call.z), rates, strict=True)
        power[call.books] += [f'{component} * {rate}' for component, rate in components]
    forces = _sums([call for call in calls if call.gives == 'force'])
    couples = _sums([call for call in calls if call.gives == 'torque'])
    heat = f'-({" + ".join(power["heat"])})' if power['heat'] else '0.0'
    work = ' + '.join(power['work']) or '0.0'
    inner = _sums([call for call in calls if call.inner])
    return _kernel('applied', calls, (*forces, *couples, work, heat, *inner), STATE + FIELD)


@functools.lru_cache(maxsize=KEPT)
def turning_source(calls):
    """Return the source of ``turning(p, q, omega, v)``, the extra rate at which the axes turn."""
    calls = [call for call in calls if call.gives == 'turning']
    return _kernel('turning', calls, _turning_rates(calls) if calls else ('0.0',) * 3)


@functools.lru_cache(maxsize=KEPT)
def _omega_rate(calls, state):
    """Euler's terms, with the torques' where there are any."""
    calls = [call for call in calls if call.gives != 'force']
    terms = [
        f'p[{euler.EULER + k}] * ({product})'
        for k, product in enumerate(('wy * wz', 'wz * wx', 'wx * wy'))
    ]
    if calls:
        terms = [
            f'{term} + p[{euler.INVERSE + k}] * ({total})'
            for k, (term, total) in enumerate(zip(terms, _sums(calls), strict=True))
        ]
    return _kernel('omega_rate', calls, terms, state)


@functools.lru_cache(maxsize=KEPT)
def _axes_rate(calls, state):
    """omega, with the extra turning rate of internal dissipation where there is one."""
    calls = [call for call in calls if call.gives == 'turning']
    rates = [' + '.join(terms) for terms in zip(OMEGA, _turning_rates(calls), strict=True)]
    return _kernel('axes_rate', calls, rates if calls else OMEGA, state)


def _turning_rates(calls):
    """Return the three sums of the rates at which effects turn the axes."""
    return [' + '.join(call.turns[k] for call in calls) for k in range(3)]
