"""What jumps and forces say of contacts: their states, the friction of given jumps, the status."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array
from solver.laws import OPEN
from solver.laws.friction import follow
from solver.laws.play import play
from solver.reference.condensation import Condensation
from solver.reference.rules import Rules
from solver.reference.states import HELD, States


def states_at(jumps: Array, rules: Rules) -> States:
    """States of a body that is where it would be if it were rigid, (n, n_instants)."""
    closed = (jumps + rules.gap[:, None] <= 0.0)[rules.partner]
    slip = np.sign(np.diff(jumps, axis=1, prepend=0.0))
    slip[rules.normal] = HELD
    return np.where(closed, slip, OPEN).astype(np.int8)


def all_forces(condensed: Condensation, rules: Rules, jumps: Array, force: Array) -> Array:
    """Add the friction at jumps that follow from prescribed displacements, all instants."""
    forces = np.zeros_like(jumps)
    forces[condensed.moving] = force
    given = ~rules.normal
    given[condensed.moving] = False
    slip = np.diff(jumps, axis=1, prepend=0.0)
    bound = rules.bounds(forces, slip)
    forces[given] = (-bound * np.sign(slip))[given]
    for number, strength in enumerate(rules.strengths):
        own = given & (rules.compliance > 0.0) & (rules.strength == number)
        if not own.any():
            continue
        soft, jump = rules.compliance[own, None], jumps[own]
        reach = soft * np.broadcast_to(rules.before_slip(rules.bound, forces), jumps.shape)[own]
        slider = play(jump, reach) if number == 0 else follow(jump, reach, strength)
        forces[own] = (slider - jump) / soft
    return forces


def status_of(rules: Rules, slip: Array, forces: Array) -> NDArray[np.int8]:
    """Status of every point, stacked interface by interface, (n_points, n_instants)."""
    tangential = ~rules.normal
    status = np.sign(slip).astype(np.int8)
    with_normal = rules.normal[rules.partner][:, None]
    status[with_normal & (forces[rules.partner] <= 0.0)] = OPEN
    return np.asarray(status[tangential])
