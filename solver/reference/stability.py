"""Whether a structure is stable whose friction softens where it slips."""

from __future__ import annotations

import numpy as np
from numpy.linalg import LinAlgError
from scipy.linalg import cholesky

from solver.arrays import Array
from solver.laws import OPEN
from solver.reference.condensation import Condensation
from solver.reference.rules import HELD, Rules, States


def is_stable(
    condensed: Condensation, rules: Rules, growth: Array, begin: States, end: States
) -> bool:
    """Whether what slips at either end of a way is stable, whatever else slips between them.

    Parameters
    ----------
    condensed, rules
        The structure.
    growth
        Growth of the friction bound per slip of every jump, shape (n,), scaled.
    begin, end
        States at both ends, shape (n,).
    """
    slips = (np.abs(begin) == 1) | (np.abs(end) == 1)
    growth = np.where(slips, growth, 0.0)
    if not np.any(growth < 0.0):
        return True
    sprung = rules.compliance > 0.0
    stiffness = 1.0 + growth * rules.compliance
    if np.any(stiffness <= 0.0):
        return False
    growth /= stiffness
    presses = sprung & (begin == HELD) & (end == HELD)
    growth[presses] += 1.0 / rules.compliance[presses]
    is_free = slips | (begin == OPEN) & (end == OPEN) | sprung
    free = np.flatnonzero(is_free[condensed.base])
    softened = condensed.elastic[np.ix_(free, free)]
    if len(condensed.base) == len(growth):
        softened[np.diag_indices_from(softened)] += growth[free]
    else:
        tied = condensed.ties[:, free].toarray()
        softened += tied.T @ (growth[:, None] * tied)
    try:
        cholesky(softened, overwrite_a=True, check_finite=False)
    except LinAlgError:
        return False
    return True
