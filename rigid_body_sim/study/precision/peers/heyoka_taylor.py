"""heyoka: Taylor series of a variable order, compiled for the very equations; also with 80-bit numbers."""

import numpy as np

from rigid_body_sim.study.precision.peers import body
from rigid_body_sim.study.precision.runner import TOLERANCES, Run, Runner

NAME = 'heyoka'


def version():
    """Return the version that is installed."""
    import heyoka
    return heyoka.__version__


def runners(problem, reference):
    """Yield heyoka in doubles and in 80-bit numbers."""
    given = body.of(problem)
    yield Runner(NAME, 'tolerance', TOLERANCES, lambda tolerance: _run(given, tolerance, np.float64), True)
    yield Runner(f'{NAME}, 80 bit', 'tolerance', (1e-12, 1e-15, 1e-18), lambda tolerance: _run(given, tolerance, np.longdouble), True)


def _run(given, tolerance, number):
    import heyoka
    variables = heyoka.make_vars('x', 'y', 'z', 'w', 'w1', 'w2', 'w3')
    system = list(zip(variables, equations(given, number, *variables)))
    start = given.start.astype(number)
    integrator = heyoka.taylor_adaptive(system, start, tol=number(tolerance), fp_type=number)

    def begin():
        integrator.time = number(0)
        integrator.state[:] = start

    def to(time):
        integrator.propagate_until(number(time))
    return Run(begin, to, lambda: given.state(integrator.state.astype(float)))


def equations(given, number, x, y, z, w, *omega):
    """Return the right-hand sides; what is zero is not written."""
    def total(*terms):
        terms = [number(c) * e for c, e in terms if c != 0.0]
        return sum(terms[1:], terms[0]) if terms else None

    def plus(*parts):
        parts = [part for part in parts if part is not None]
        return sum(parts[1:], parts[0])
    # constants are formed in the precision of the numbers
    i, c = given.moments.astype(number), number(given.inner)
    products = [omega[1] * omega[2], omega[2] * omega[0], omega[0] * omega[1]]
    a = omega if not given.inner else [plus(omega[k], total((c * (i[(k + 1) % 3] - i[(k + 2) % 3]), products[k]))) for k in range(3)]
    columns = [[1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y + w * z), 2.0 * (x * z - w * y)],
               [2.0 * (x * y - w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z + w * x)],
               [2.0 * (x * z + w * y), 2.0 * (y * z - w * x), 1.0 - 2.0 * (x * x + y * y)]]
    rates = []
    for k in range(3):
        j, l = (k + 1) % 3, (k + 2) % 3
        inertia = total((i[j] / i[k], omega[j] * a[l]), (-i[l] / i[k], omega[l] * a[j])) if given.inner else \
            total(((i[j] - i[l]) / i[k], products[k]))
        couple = total((given.weight_arm[l] / i[k], columns[j][2]), (-given.weight_arm[j] / i[k], columns[l][2]),
                       *((given.push[n] / i[k], columns[k][n]) for n in range(3)), *((-given.damping[k, n] / i[k], omega[n]) for n in range(3)))
        constant = number(given.torque[k]) / i[k]
        parts = plus(inertia, couple) if inertia is not None or couple is not None else 0.0 * omega[k]
        rates.append(parts + constant if constant else parts)
    return [0.5 * (w * a[0] + y * a[2] - z * a[1]), 0.5 * (w * a[1] + z * a[0] - x * a[2]), 0.5 * (w * a[2] + x * a[1] - y * a[0]),
            -0.5 * (x * a[0] + y * a[1] + z * a[2]), *rates]
