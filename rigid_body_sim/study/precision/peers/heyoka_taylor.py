# SPDX-License-Identifier: Apache-2.0
"""heyoka: Taylor series of variable order, compiled for the given equations.

It also runs with 80-bit numbers.
"""

import numpy as np

from rigid_body_sim.numerics.rotations import rotate_back
from rigid_body_sim.study.precision.peers import ball, given, pendulum, plane
from rigid_body_sim.study.precision.runner import TOLERANCES, RefusedError, Run, Runner

NAME = 'heyoka'


def version():
    """Return the version that is installed."""
    import heyoka
    return heyoka.__version__


def runners(problem, reference):
    """Yield heyoka in doubles and, except for contact, in 80-bit numbers."""
    if plane.has_surface(problem.scene):
        body = plane.of(problem.scene)
        if not body.rolls:
            raise RefusedError('slip that dies on the way: the harness gives it rolling only')
        yield Runner(NAME, 'tolerance', TOLERANCES,
                     lambda tolerance: _on_a_plane(body, tolerance), True)
        return
    numbers = given.of(problem)
    made = _rolling if isinstance(numbers, ball.Ball) else smooth_run
    yield Runner(NAME, 'tolerance', TOLERANCES,
                 lambda tolerance: made(numbers, tolerance, np.float64), True)
    if made is smooth_run:
        finer = (1e-12, 1e-15, 1e-18)
        yield Runner(f'{NAME}, 80 bit', 'tolerance', finer,
                     lambda tolerance: smooth_run(numbers, tolerance, np.longdouble), True)


def smooth_run(numbers, tolerance, number):
    """Return the Run of a Body or Pendulum in numbers of a type (float64 or longdouble)."""
    import heyoka
    swings = isinstance(numbers, pendulum.Pendulum)
    variables = heyoka.make_vars(*(('phi', 'rate') if swings
                                   else ('x', 'y', 'z', 'w', 'w1', 'w2', 'w3')))
    system = list(zip(variables, (swinging if swings else turning)(numbers, number, *variables)))
    start = numbers.start.astype(number)
    integrator = heyoka.taylor_adaptive(system, start, tol=number(tolerance), fp_type=number)

    def begin():
        integrator.time = number(0)
        integrator.state[:] = start

    def to(time):
        integrator.propagate_until(number(time))
    return Run(begin, to, lambda: numbers.state(integrator.state.astype(float)))


def _on_a_plane(body, tolerance):
    """Return the Run of a body that rolls on a plane without slip.

    The unknowns are q and the angular momentum M about the point of contact, in body axes. With r
    from the centre of mass to that point, s = r less the constant part, and the vertical gamma:
    M = (I + m (r^2 - r r^T)) omega, M' = M x omega + m s' x (omega x r) + m g r x gamma.
    """
    import heyoka
    variables = heyoka.make_vars('x', 'y', 'z', 'w', 'm1', 'm2', 'm3')
    x, y, z, w, *M = variables
    gamma = np.array([2.0 * (x * z - w * y), 2.0 * (y * z + w * x), w * w - x * x - y * y + z * z])
    n = np.array(heyoka.make_vars('n1', 'n2', 'n3'))
    lowest = _lowest(body, n)
    there = dict(zip(n, gamma))
    s = np.array([heyoka.subs(one, there) for one in lowest])
    r = body.middle + s
    heavy = _heavy(body, r)
    across = np.array([np.cross(heavy[1], heavy[2]), np.cross(heavy[2], heavy[0]),
                       np.cross(heavy[0], heavy[1])])
    omega = across @ M / (heavy[0] @ across[0])    # the inverse of a symmetric matrix
    slope = np.cross(gamma, omega)
    moved = np.array([sum(heyoka.subs(heyoka.diff(one, along), there) * rate
                          for along, rate in zip(n, slope)) for one in lowest])
    rates = (np.cross(M, omega) + body.mass * np.cross(moved, np.cross(omega, r))
             + body.mass * body.g * np.cross(r, gamma))
    w1, w2, w3 = omega
    turn = [0.5 * (w * w1 + y * w3 - z * w2), 0.5 * (w * w2 + z * w1 - x * w3),
            0.5 * (w * w3 + x * w2 - y * w1), -0.5 * (x * w1 + y * w2 + z * w3)]

    def arm(q):
        vertical = np.array(rotate_back(*q, 0.0, 0.0, 1.0))
        return _heavy(body, body.middle + np.array(_lowest(body, vertical)))
    start = np.concatenate([body.start[:4], arm(body.start[:4]) @ body.in_body()])
    integrator = heyoka.taylor_adaptive(
        list(zip(variables, [*turn, *rates])), start, tol=tolerance)

    def begin():
        integrator.time = 0.0
        integrator.state[:] = start

    def state():
        q = integrator.state[:4] / np.linalg.norm(integrator.state[:4])
        return *q, *np.linalg.solve(arm(q), integrator.state[4:])
    return Run(begin, integrator.propagate_until, state)


def _lowest(body, n):
    """Return the lowest point of a surface from its middle, for a vertical n in body axes."""
    if not body.disk:
        return [-body.radius * one for one in n]
    flat = (n[0] * n[0] + n[1] * n[1]) ** 0.5
    return [-body.radius * n[0] / flat, -body.radius * n[1] / flat, 0.0 * n[2]]


def _heavy(body, r):
    """Return the inertia about the point of contact r, body axes."""
    return body.inertia + body.mass * ((r @ r) * np.eye(3) - np.outer(r, r))


def _rolling(numbers, tolerance, _):
    """Return the Run of a ball, made of two integrators.

    The first one stops at the event when rolling begins, and the second one goes on from there.
    """
    import heyoka
    variables = heyoka.make_vars('x', 'y', 'z', 'w', 'w1', 'w2', 'w3', 'v1', 'v2')
    x, y, z, w, w1, w2, w3 = variables[:7]
    turn = [
        0.5 * (w * w1 + w2 * z - w3 * y),
        0.5 * (w * w2 + w3 * x - w1 * z),
        0.5 * (w * w3 + w1 * y - w2 * x),
        -0.5 * (w1 * x + w2 * y + w3 * z),
    ]

    def integrator(push, **events):
        system = [*turn, *(heyoka.expression(float(c)) for c in push[4:])]
        return heyoka.taylor_adaptive(
            list(zip(variables, system)), numbers.start, tol=tolerance, **events)
    rolling = sliding = integrator(np.zeros(9))
    if numbers.slides:
        onset = sum((c * one for c, one in zip(numbers.slip[5:], variables[5:])),
                    numbers.slip[4] * variables[4])
        sliding = integrator(
            numbers.push,
            t_events=[heyoka.t_event(onset, direction=heyoka.event_direction.negative)])
    now = sliding

    def begin():
        nonlocal now
        now = sliding
        if numbers.slides:
            now.reset_cooldowns()
        now.time = 0.0
        now.state[:] = numbers.start

    def to(time):
        nonlocal now
        now.propagate_until(time)
        if now.time < time:
            rolling.time = now.time
            rolling.state[:] = now.state
            rolling.propagate_until(time)
            now = rolling
    return Run(begin, to, lambda: numbers.state(now.state))


def swinging(numbers, number, phi, rate):
    """Return the right-hand sides of a pendulum, without terms that are zero."""
    import heyoka
    a, b, k, d, s = numbers.numbers.astype(number)
    parts = [c * e
             for c, e in ((a, heyoka.cos(phi)), (b, heyoka.sin(phi)), (-d, rate), (-s, phi))
             if c != 0.0]
    right = sum(parts[1:], parts[0]) if parts else 0.0 * rate
    return [rate, right + k if k else right]


def turning(numbers, number, x, y, z, w, *omega):
    """Return the right-hand sides, without terms that are zero."""
    def total(*terms):
        terms = [number(c) * e for c, e in terms if c != 0.0]
        return sum(terms[1:], terms[0]) if terms else None

    def plus(*parts):
        parts = [part for part in parts if part is not None]
        return sum(parts[1:], parts[0])
    # constants are formed in the precision of the run
    i, c = numbers.moments.astype(number), number(numbers.inner)
    products = [omega[1] * omega[2], omega[2] * omega[0], omega[0] * omega[1]]
    a = (omega if not numbers.inner else [plus(
        omega[k], total((c * (i[(k + 1) % 3] - i[(k + 2) % 3]), products[k]))) for k in range(3)])
    columns = [[1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)],
               [2.0 * (x * y - w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + w * x)],
               [2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y)]]
    driven = [*_slowed(numbers, number, total, omega), *_tied(numbers, number, total, columns)]
    rates = []
    for k in range(3):
        j, l = (k + 1) % 3, (k + 2) % 3
        inertia = (total((i[j] / i[k], omega[j] * a[l]), (-i[l] / i[k], omega[l] * a[j]))
                   if numbers.inner else total(((i[j] - i[l]) / i[k], products[k])))
        couple = total((numbers.weight_arm[l] / i[k], columns[j][2]),
                       (-numbers.weight_arm[j] / i[k], columns[l][2]),
                       *((numbers.push[n] / i[k], columns[k][n]) for n in range(3)),
                       *((-numbers.damping[k, n] / i[k], omega[n]) for n in range(3)))
        constant = number(numbers.torque[k]) / i[k]
        acting = [one[k] if one[k] is None else one[k] / i[k] for one in driven]
        parts = (plus(inertia, couple, *acting)
                 if any(one is not None for one in (inertia, couple, *acting))
                 else 0.0 * omega[k])
        rates.append(parts + constant if constant else parts)
    return [
        0.5 * (w * a[0] + y * a[2] - z * a[1]),
        0.5 * (w * a[1] + z * a[0] - x * a[2]),
        0.5 * (w * a[2] + x * a[1] - y * a[0]),
        -0.5 * (x * a[0] + y * a[1] + z * a[2]),
        *rates,
    ]


def _slowed(numbers, number, total, omega):
    """Return the torques of drag by squares, a list."""
    import heyoka
    found = []
    for coefficient, form in ((numbers.quadratic, numbers.resisting),
                              (numbers.angular_quadratic, np.eye(3))):
        if coefficient:
            slowed = [total(*zip(row, omega)) for row in form]
            first, *more = [w * s for w, s in zip(omega, slowed) if s is not None]
            speed = number(-coefficient) * heyoka.sqrt(sum(more, first))
            found.append([s if s is None else speed * s for s in slowed])
    return found


def _tied(numbers, number, total, columns):
    """Return the torque of a spring, a list of one or none."""
    import heyoka
    if not numbers.tie:
        return []
    at, anchor, stiffness, length = numbers.tie
    at, anchor = at.astype(number), anchor.astype(number)
    b = [total(*zip(anchor, column)) for column in columns]
    square = total(*zip(-2 * at, b)) + number(at @ at + anchor @ anchor)
    pull = number(stiffness) - number(stiffness * length) / heyoka.sqrt(square)
    levers = [total((at[k - 2], b[k - 1]), (-at[k - 1], b[k - 2])) for k in range(3)]
    return [[lever if lever is None else pull * lever for lever in levers]]
