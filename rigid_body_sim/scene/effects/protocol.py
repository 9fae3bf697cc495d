# SPDX-License-Identifier: Apache-2.0
"""The contract of an effect: what it declares, and the views of it that others ask for.

An effect is a frozen dataclass that inherits :class:`Effect`. It overrides the views that it has;
a view that it does not override is None, and code that needs the view refuses the effect.
docs/extending adds an effect step by step.
"""

import inspect
from collections.abc import Callable, Iterable
from types import FunctionType
from typing import Any, ClassVar, NamedTuple, Protocol

import numpy as np

from rigid_body_sim.scene.bodies import Body
from rigid_body_sim.scene.constraints.protocol import Constraint, Mechanism
from rigid_body_sim.scene.expressions.tree import ZERO, Term
from rigid_body_sim.scene.frame import Frame
from rigid_body_sim.scene.state import State

Vector = tuple[float, float, float]


class Acting(NamedTuple):
    """A force, a torque or a turning rate that acts as long as its values hold.

    In a frame with a `path` an effect gives both the torque about the moving point and the force;
    the ledger books the share of that force in the work of the drive.

    Attributes
    ----------
    kernel : str
        ``'package.module:function'``. The compiled function has the signature ``(value, ...,
        value, qx, qy, qz, qw, wx, wy, wz, vx, vy, vz)``: the attitude of the frame, its angular
        velocity (frame components, rad/s) and the velocity of the centre of mass (world, m/s). It
        returns three components.
    values : tuple of floats
    gives : str
        ``force`` (N, world components, at the centre of mass; only where ``frame.pushed``),
        ``torque`` (N m, frame components, about the reference point) or ``turning`` (rad/s, frame
        components, an extra rate at which the axes turn under a constant angular momentum; its
        first value is a c, and c times the torque of all potentials is added to it).
    books : str
        Where the ledger writes the power: ``potential`` (the view `potential` has the energy),
        ``work`` (done on the body) or ``heat`` (taken from it).
    in_field : bool
        True if it depends on time, place, or the velocity of a free body that no force moves.
        The kernel then has four more arguments ``t, x, y, z``: the time (s) and the place of the
        point of reference (world, m).
    timed : bool
        True if it depends on time by itself, not only by where the body is.
    of_motion : bool
        True if it depends on velocities; one that books heat need not say so.
    inner : bool
        True for a torque against a part inside the body, whose momentum the view `momentum` has:
        the ledger's angular impulse does not include it.
    switching : str
        ``'package.module:function'``, of what has kinks, else empty. The compiled function has the
        signature of `kernel` and returns its switches, a tuple of floats: a kink is where one of
        them changes its sign.
    modes : tuple of int
        Places in `values`, one for each switch: 1 or -1 there says that the switch is on that
        side, 0 (which an effect gives) that the kernel looks at the sign itself.
    grip : float
        Torque with which it holds a body on a hinge at rest, N m: that of dry friction, whose one
        switch is the rate.
    rooted : bool
        True if it takes a root or a fractional power of a quantity that changes: where that comes
        near zero, as |v| does, it is nearly a kink.
    polynomial : bool
        True if it is a polynomial of attitude, velocities and time: then it is no rougher than the
        motion itself. Anything else may hide a rough term that is too small to show in the motion.
    winding : bool
        True if it jumps where the angle of a hinge goes on from its other end, two turns away. The
        jump is a kink where ``frame.hinge.winds``.
    both_ways : bool
        True of what books heat and may add energy as well as take it: what a scene writes itself.
    """

    kernel: str
    values: tuple[float, ...]
    gives: str
    books: str
    in_field: bool = False
    of_motion: bool = False
    inner: bool = False
    switching: str = ''
    modes: tuple[int, ...] = ()
    grip: float = 0.0
    timed: bool = False
    rooted: bool = False
    winding: bool = False
    both_ways: bool = False
    polynomial: bool = False


class Formulas(NamedTuple):
    """Torque and force of an effect as trees (scene/expressions/tree.py), for power series.

    Their names are those of expressions, and parameters.

    Attributes
    ----------
    torque : tuple of 3 Terms
        About the reference point, body components (those of the frame if `of_frame`), N m.
    force : tuple of 3 Terms
        At the centre of mass, world components, N. Only where ``frame.moves``; else zeros, and
        the torque has its moment.
    parameters : tuple of (str, float)
    of_frame : bool
        True if the names mean what the arguments of an Acting's kernel mean: the attitude of the
        frame, its angular velocity (frame components), place and velocity of the reference point.
    """

    torque: tuple[Term, Term, Term]
    force: tuple[Term, Term, Term] = (ZERO, ZERO, ZERO)
    parameters: tuple[tuple[str, float], ...] = ()
    of_frame: bool = False


class Pull(NamedTuple):
    """Torque and force of an effect, for power series: numbers, or formulas where these fail.

    Attributes
    ----------
    constant : tuple of 3 floats
        Torque about the reference point, frame components (N m).
    force : tuple of 3 floats, optional
        At the centre of mass, world components (N). It turns a held body by arm x R^T force, and
        moves a free one.
    couple : tuple of 3 floats, optional
        World components (N m).
    drag : tuple of 3 tuples of 3 floats, optional
        Rows of the matrix that makes a torque of omega, frame components (N m s).
    slowing : float
        c of a force -c v at the centre of mass of a free body (N s/m).
    formulas : tuple of Formulas
        What else acts.
    """

    constant: Vector = (0.0, 0.0, 0.0)
    force: Vector | None = None
    couple: Vector | None = None
    drag: tuple[Vector, Vector, Vector] | None = None
    slowing: float = 0.0
    formulas: tuple[Formulas, ...] = ()


class Twist(NamedTuple):
    """A torque -stiffness (phi - angle) - damping phi' about the axis of a hinge at phi (rad).

    Attributes
    ----------
    stiffness : float
        N m/rad.
    angle : float
        rad.
    damping : float
        N m s.
    """

    stiffness: float
    angle: float
    damping: float


class Potential(NamedTuple):
    """A potential energy as a function of the attitude and the place of the body.

    Attributes
    ----------
    kernel : str
        ``'package.module:function'``. The compiled function has the signature ``(value, ...,
        value, qx, qy, qz, qw, x, y, z)``: the attitude of the frame and the place of the centre of
        mass (world, m). It returns the energy in J.
    values : tuple of floats
    """

    kernel: str
    values: tuple[float, ...]


class Momentum(NamedTuple):
    """Angular momentum that a part carries inside the body, beside that of the body itself.

    Attributes
    ----------
    kernel : str
        ``'package.module:function'``. The compiled function has the signature ``(value, ...,
        value, t)``: the time, s. It returns three components in the frame, kg m^2/s.
    values : tuple of floats
    """

    kernel: str
    values: tuple[float, ...]


class Bounds(NamedTuple):
    """Bounds of an effect; solvers derive from them how often they look for events.

    Attributes
    ----------
    energy : float
        Half the range of its potential over all attitudes, J.
    torque : float
        The largest torque of a drive that may go on for ever, about the reference point, N m.
    pieces : tuple of (float, float)
        Rising times (s) and the largest torque of the drive from each to the next (N m), where
        that is known; before the first it is 0.
    share : float
        The largest angular acceleration that the drive gives, over that of its torque about the
        least moment: small where a slim body gets next to no torque about its thin axis.
    """

    energy: float
    torque: float
    pieces: tuple[tuple[float, float], ...] = ()
    share: float = 1.0


class Cancelling(NamedTuple):
    """How large terms are that may cancel each other.

    Attributes
    ----------
    torque : float
        Terms of the torque about the reference point, N m.
    force : float
        Terms of the force on a body that forces move, N.
    """

    torque: float
    force: float


NOTHING_CANCELS = Cancelling(0.0, 0.0)


class Contact(NamedTuple):
    """The contact of a body with a table.

    Attributes
    ----------
    mu : float
        Coefficient of sliding friction; infinite for a body that always rolls.
    g : float
        Acceleration that presses a ball on the table (mechanism TABLE), m/s^2.
    rolling : float
        Coefficient of dry rolling friction: a force C N against the velocity of the point of
        contact over the surface of the body (mechanism PLANE, like the next fields).
    rolling_viscous : float
        c of the force -c v against that velocity v, N s/m.
    film : float
        c of such a force -c v/sin(a) by the air under a disk that is inclined by a, N s/m.
    patch : float
        Radius rho of the patch of contact, m: the couple of friction about the normal is mu N rho.
    """

    mu: float = 0.0
    g: float = 0.0
    rolling: float = 0.0
    rolling_viscous: float = 0.0
    film: float = 0.0
    patch: float = 0.0


class Effect(Protocol):
    """An action on a body, apart from its constraint.

    The right-hand side and the potential must fit together: the ledger's energy residual of a
    scene says whether they do.

    Attributes
    ----------
    name : str
        The word for it in a scene file.
    SCHEMA : dict
        JSON schema of its settings there.
    mechanisms : tuple of Mechanism
        Free directions of the constraints under which it may act.
    repeatable : bool
        True if a scene may list it more than once.
    """

    name: ClassVar[str]
    SCHEMA: ClassVar[dict[str, Any]]
    mechanisms: ClassVar[tuple[Mechanism, ...]]
    repeatable: ClassVar[bool] = False

    def __init_subclass__(cls, **options: Any) -> None:
        """Refuse a setting that has the name of a view: it would hide the view."""
        super().__init_subclass__(**options)
        views = {name for name, view in vars(Effect).items()
                 if isinstance(view, property | classmethod | FunctionType)}
        for name, kind in inspect.get_annotations(cls).items():
            if name in views and 'ClassVar' not in str(kind):
                raise TypeError(f'{cls.__name__}.{name} is a setting with the name of a view of '
                                'the contract Effect: give it another name')

    @classmethod
    def from_scene(cls, settings: dict[str, Any], body: Body, constraint: Constraint,
                   where: str) -> 'Effect':
        """Return the effect of its settings in a scene file.

        Parameters
        ----------
        settings : dict
            They satisfy SCHEMA, and all numbers are finite.
        body, constraint
            Of the scene.
        where : str
            File and key path, for error lines.

        Raises
        ------
        BadInput
            For what SCHEMA cannot say.
        """
        ...

    @property
    def breakpoints(self) -> tuple[float, ...]:
        """Times (s) at which a step ends: its values jump, or it stirs after it was constant."""
        return ()

    @property
    def acting(self) -> Callable[[Frame, float], tuple[Acting, ...]] | None:
        """``acting(frame, time)``: what acts continuously just after a time (s), each an Acting.

        The number, the kernels and the ledger entries of these are the same at all times; only
        values change, and only at breakpoints. An effect that never does anything to a body in
        this frame returns none: closed forms match a scene by what acts, not by what it lists.
        """
        return None

    @property
    def opposite(self) -> 'Effect | None':
        """The effect of this class that does the contrary at all times, where a scene can say it.

        Two such effects do nothing together.
        """
        return None

    @property
    def series(self) -> Callable[[Frame, float], Pull] | None:
        """``series(frame, time)``: the same as `acting`, as a Pull. The method taylor needs it."""
        return None

    @property
    def damping(self) -> Callable[[Frame], Pull] | None:
        """``damping(frame)``: its drag in proportion to velocity, which may be stiff.

        Of the Pull, `drag` and `slowing` count. By default they are those of `series`; an effect
        whose series has formulas instead gives them here.
        """
        series = self.series
        return None if series is None else lambda frame: series(frame, 0.0)

    @property
    def potential(self) -> Callable[[Frame], Potential] | None:
        """``potential(frame)``: its energy. An effect needs it if it books its power there."""
        return None

    @property
    def momentum(self) -> Callable[[Frame], Momentum | None] | None:
        """``momentum(frame)``: what it carries inside the body, or None in this frame."""
        return None

    @property
    def twist(self) -> Twist | None:
        """What it does about the axis of a hinge, if it does nothing else; a closed form asks."""
        return None

    @property
    def uniform_field(self) -> Vector | None:
        """The acceleration that it gives to all parts of a body alike, world components, m/s^2.

        It is that of a free fall in a uniform field, which an accelerometer does not feel; None
        for an effect of any other kind. Closed forms, theory and analysis know the weight by it.
        """
        return None

    @property
    def inner_dissipation(self) -> float:
        """The c of an extra turning c m x omega that makes heat at constant L, 1/(kg m^2/s).

        It is 0 for an effect that does not do this. Its rate ``c |m|`` relative to the rotation
        says whether a scene is stiff.
        """
        return 0.0

    @property
    def as_impulse(self) -> Callable[[Body, np.ndarray], tuple[np.ndarray, np.ndarray]] | None:
        """``as_impulse(body, vector)``: its impulse at one instant, the attribute `time` (s).

        For the state (14 doubles) just before it returns the impulse of force at the centre of
        mass (N s) and of torque (N m s), each of shape (3,) in world axes. Three more numbers,
        if given, are what rounding took from each: in a slim body they count.
        """
        return None

    @property
    def bounds(self) -> Callable[[Body, Constraint], Bounds] | None:
        """``bounds(body, constraint)``: its Bounds; None counts as zero."""
        return None

    @property
    def grip(self) -> float:
        """The torque with which it holds a body on a hinge at rest, N m."""
        return 0.0

    def cancelling(self, frame: Frame, start: State, horizon: float) -> Cancelling:
        """Return how large terms are that may cancel each other up to a time (s).

        What is left of them is rounding, which no step is short enough to follow. Terms of place
        and attitude count as they are at the start. Potentials that have bounds need not say so.
        """
        return NOTHING_CANCELS

    @property
    def contact(self) -> Contact | None:
        """How body and table touch, for an effect of the mechanisms TABLE and PLANE."""
        return None

    def notes(self, body: Body, constraint: Constraint) -> list[str]:
        """Return warnings about settings that are legal but probably unintended, one line each."""
        return []


def as_floats(values: Iterable[float]) -> tuple[float, ...]:
    """Return a sequence from a scene file as a tuple of floats."""
    return tuple(float(value) for value in values)
