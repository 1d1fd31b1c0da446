"""Finding the pair that a residual asks for (paper, problem 2.3; solver/README.md, 3)."""

from __future__ import annotations

import numpy as np

from solver.arrays import Array

STEPS = 4
"""Steps of the fixed point at most. On bar and strand with 20 modes, 1, 2 and 10 steps, and the
leading singular pair itself, reach 10 % and 1 % of force error within one iteration of each other
(98 to 106; measured)."""
STAGNATION = 0.01
"""Change of a pair's size, as a share, at which the fixed point stops; 0 and 0.1 as well."""


def nearest_mode(residual: Array, k: Array, weights: Array) -> Array:
    """Space mode of the pair that is nearest to a residual, of any length.

    With G + k Z = g for every boundary field g, problem 2.3 asks for the pair g phi nearest to
    the residual; the paper's fixed point alternates between both factors, and is a power
    iteration towards the leading singular pair.

    Parameters
    ----------
    residual
        delta / k, shape (n_boundary, n_columns); zero gives a mode that is zero.
    k, weights
        Weights of space and of the columns.
    """
    # Only the shape matters, and the squares of very small numbers are zero.
    largest = float(np.abs(residual).max())
    if largest == 0.0:
        return residual[:, 0]
    residual = residual / largest
    # The instant at which the residual is largest: nearer to the pair than any fixed start.
    mode = residual[:, int(np.argmax((k @ (residual * residual)) * weights))]
    size = 0.0
    for _ in range(STEPS):
        time_function = (k * mode) @ residual / float(k @ (mode * mode))
        mode = residual @ (weights * time_function)
        mode /= float(weights @ (time_function * time_function))
        before, size = size, float(k @ (mode * mode))
        size *= float(weights @ (time_function * time_function))
        if abs(size - before) <= STAGNATION * size:
            break
    return mode
