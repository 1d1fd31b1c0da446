"""How far fields are from equilibrium and from the laws of all contacts."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array
from solver.laws.rules import Rules
from solver.reference.condensation import Condensation


def unbalanced_of(
    condensed: Condensation, rules: Rules, displacement: Array, forces: Array
) -> NDArray[np.float64]:
    """Give the KKT residual of every instant, a force, scaled.

    The largest of: forces out of balance; distance of the normal force from (f - r g)+ with the
    opening g, and of the friction force from f - r v cut to its bound, with the slip v. A stiffness
    r of the pair makes a force of a length; the conditions hold if and only if both distances
    vanish.
    """
    jumps = condensed.jump(displacement, forces)
    unit = np.zeros((len(jumps), 1))
    unit[condensed.moving, 0] = condensed.springs
    unit[unit == 0.0] = 1.0
    opening = jumps + rules.gap[:, None]
    slip = np.diff(jumps, axis=1, prepend=0.0)
    bound = rules.bounds(forces)
    pressed = np.maximum(forces - unit * opening, 0.0)
    rubbed = np.clip(forces - unit * slip, -bound, bound)
    wrong = np.abs(forces - np.where(rules.normal[:, None], pressed, rubbed))
    # The force of a normal jump that is prescribed is not determinate, so it has no law to obey.
    wrong[rules.normal & (np.isin(np.arange(len(jumps)), condensed.moving, invert=True))] = 0.0
    unbalanced = np.abs(condensed.unbalanced(displacement, forces)).max(axis=0, initial=0.0)
    return np.asarray(np.maximum(unbalanced, wrong.max(axis=0, initial=0.0)))
