"""How far fields are from equilibrium and from the laws of all contacts."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array
from solver.reference.condensation import Condensation
from solver.reference.rules import Rules


class Shown(NamedTuple):
    """Fields of a structure, scaled.

    Attributes
    ----------
    deformation
        Displacement but for rigid motions, shape (n_dofs, n_instants).
    forces, opening, slip
        Of all jumps, with what is in series, shape (n_forces, n_instants).
    """

    deformation: Array
    forces: Array
    opening: Array
    slip: Array


def unbalanced_of(condensed: Condensation, rules: Rules, shown: Shown) -> NDArray[np.float64]:
    """KKT residual of every instant, a force, scaled.

    The largest of: forces out of balance; distance of the normal force from (f - r g)+ with the
    opening g, and of the friction force from f - r v cut to its bound, with the slip v. A stiffness
    r of the pair makes a force of a length; the conditions hold if and only if both distances
    vanish.
    """
    forces, unit = shown.forces, condensed.unit[:, None]
    bound = rules.bounds(forces, shown.slip, shown.opening)
    pressed = np.maximum(forces - unit * shown.opening, 0.0)
    rubbed = np.clip(forces - unit * shown.slip, -bound, bound)
    wrong = np.abs(forces - np.where(rules.normal[:, None], pressed, rubbed))
    # The force of a normal jump that is prescribed is not determinate, so it has no law to obey.
    moving = np.isin(np.arange(len(forces)), condensed.moving)
    wrong[rules.normal & ~moving] = 0.0
    unbalanced = np.abs(condensed.unbalanced(shown.deformation, forces)).max(axis=0, initial=0.0)
    return np.asarray(np.maximum(unbalanced, wrong.max(axis=0, initial=0.0)))
