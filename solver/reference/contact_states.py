"""What jumps and forces say of contacts: their states, the friction of given jumps, the status."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array
from solver.laws import OPEN
from solver.laws.play import play
from solver.laws.rules import Rules
from solver.reference.condensation import Condensation
from solver.reference.states import HELD, States


def states_at(jumps: Array, rules: Rules) -> States:
    """Give the states of a body that is where it would be if it were rigid, (n, n_instants)."""
    closed = (jumps + rules.gap[:, None] <= 0.0)[rules.partner]
    slip = np.sign(np.diff(jumps, axis=1, prepend=0.0))
    slip[rules.normal] = HELD
    return np.where(closed, slip, OPEN).astype(np.int8)


def all_forces(condensed: Condensation, rules: Rules, jumps: Array, force: Array) -> Array:
    """Add the friction at jumps that follow from prescribed displacements, all instants."""
    found = np.zeros_like(jumps)
    found[condensed.moving] = force
    given = ~rules.normal
    given[condensed.moving] = False
    slip = np.diff(jumps, axis=1, prepend=0.0)
    bound = rules.bounds(found, slip)
    found[given] = (-bound * np.sign(slip))[given]
    sprung = np.flatnonzero(given & (rules.compliance > 0.0))
    if len(sprung):
        soft, jump = rules.compliance[sprung, None], jumps[sprung]
        found[sprung] = (play(jump, bound[sprung] * soft) - jump) / soft
    return found


def status_of(rules: Rules, slip: Array, forces: Array) -> NDArray[np.int8]:
    """Give the status of every point, stacked interface by interface, (n_points, n_instants)."""
    tangential = ~rules.normal
    status = np.sign(slip).astype(np.int8)
    with_normal = rules.normal[rules.partner][:, None]
    status[with_normal & (forces[rules.partner] <= 0.0)] = OPEN
    return np.asarray(status[tangential])
