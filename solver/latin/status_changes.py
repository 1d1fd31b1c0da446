"""Which points changed their status from one iterate to the next, and what the law says why."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from solver.latin.iterate import Iterate
from solver.laws import OPEN, Contact

ROUNDING = 1e-9
"""Share of its bound by which a force that is at it may be beyond."""


@dataclass(frozen=True, eq=False)
class StatusChanges:
    """What changed at one interface; fields of shape (n_points, n_instants).

    Attributes
    ----------
    slip
        It begins to: if it stuck, the friction force would be over its bound.
    turn
        It slips the other way, for the same reason.
    stick
        It does again: with friction at its bound the slip would go the way that friction pushes.
    settle
        It counts as stuck, as it slips by no more than both stages still differ by.
    lift
        Contact is lost: it would have to pull.
    touch
        Contact is found: without a pressing force the bodies would overlap.
    """

    slip: NDArray[np.bool_]
    turn: NDArray[np.bool_]
    stick: NDArray[np.bool_]
    settle: NDArray[np.bool_]
    lift: NDArray[np.bool_]
    touch: NDArray[np.bool_]

    @property
    def counts(self) -> dict[str, int]:
        """How many points and instants there are of each, where there are any."""
        return {name: count for name, one in vars(self).items() if (count := int(one.sum()))}

    @property
    def all(self) -> NDArray[np.bool_]:
        """Where the status is another."""
        return np.asarray(np.any(list(vars(self).values()), axis=0))


def status_changes(iterate: Iterate, before: Iterate, name: str) -> StatusChanges:
    """Compare the statuses of two iterates at one interface, and ask the law for reasons.

    A point that is over its bound if it stuck is so in the local stage of `iterate`: there the law
    is obeyed along E+, so the force that sticking needs is known (solver/README.md, 2).
    """
    law = iterate.problem.rubbing[name]
    now, was = iterate.status_at(law), before.status_at(law)
    over = over_bound(law, iterate)
    slips, slipped = np.abs(now) == 1, np.abs(was) == 1
    rests = (now == 0) & slipped
    return StatusChanges(
        slip=slips & (was == 0),
        turn=slips & slipped & (now != was),
        stick=rests & ~over,
        settle=rests & over,
        lift=(now == OPEN) & (was != OPEN),
        touch=(now != OPEN) & (was == OPEN),
    )


def over_bound(law: Contact, iterate: Iterate) -> NDArray[np.bool_]:
    """Tell where friction would be over its bound if nothing slipped since the instant before.

    Shape (n_points, n_instants); of a point with several pairs, whether one of them would.
    """
    moved, force = iterate.local_displacement, iterate.boundary_local_force
    along, start = law.tangential, law.tangential.start
    compliance = np.add.reduce([1.0 / iterate.k[rows] for rows in along.component.sides])
    compliance = compliance if along.softness is None else compliance + along.softness
    first = 0.0 if start is None else start[:, None]
    slip = np.diff(along.slider(moved, force), axis=1, prepend=first)
    trial = force[along.component.above] - slip / compliance[:, None]
    pressing = None if law.normal is None else force[law.normal.component.above]
    bound = along.allowed(pressing, slip)
    found = np.abs(trial) > (1.0 + ROUNDING) * bound
    return np.asarray(law.by_point(found.astype(float)) > 0.0)
