# SPDX-License-Identifier: Apache-2.0
"""Check of formulas that hold in a limit.

The deviation of the motion from the formula is measured at three values of the small parameter;
its order and its limit follow.
"""

import math

import numpy as np

from rigid_body_sim.study.scenes.quantity import Quantity


def limit(name, parameter, values, ratios, order, order_tolerance, tolerance, as_written=None):
    """Return two Quantities: the order at which the deviation vanishes, and its limit.

    Parameters
    ----------
    name, parameter : str
        Names of the quantity and of the small parameter.
    values : sequence of 3 floats
        Values of the parameter, falling.
    ratios : sequence of 3 floats
        Measured over predicted at these values.
    order : int
        Power of the parameter to which the deviation is proportional.
    as_written : float, optional
        Uncorrected formula over the corrected one.
    """
    values, deviations = np.asarray(values, dtype=float), np.asarray(ratios, dtype=float) - 1.0
    measured = math.log(abs(deviations[1] / deviations[2])) / math.log(values[1] / values[2])
    detail = ', '.join(f'{deviation:.3g} at {value:.3g}'
                       for value, deviation in zip(values, deviations, strict=True))
    # deviation = a p^n + b p^(2 n) + c: three values give the constant c
    powers = np.stack([np.ones(3), values**order, values ** (2 * order)], axis=1)
    left = np.linalg.solve(powers, deviations)[0]
    return [Quantity(f'{name}: order of its deviation in {parameter}', float(order), measured,
                     order_tolerance, absolute=True, detail=f'deviation {detail}'),
            Quantity(f'{name}, over the formula, in the limit', 1.0, 1.0 + left, tolerance,
                     as_written=as_written)]
