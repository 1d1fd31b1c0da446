"""How far the pairs of an interface slip between instants, and what friction takes meanwhile."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from solver.arrays import Array
from solver.latin import Iterate
from solver.laws import Contact


def slips_of(iterate: Iterate) -> Iterator[tuple[Contact, Array, Array]]:
    """Give each interface with friction, the slip of its pairs, m, and the work it takes, J.

    Both from each instant to the next, shape (n_pairs, n_instants), and both of the local stage,
    whose laws hold at every iterate. A point slips at the bound of the instant that it slips to.
    """
    scales = iterate.problem.scales
    moved, force = iterate.local_displacement, iterate.boundary_local_force
    for law in iterate.problem.rubbing.values():
        slip = np.diff(law.tangential.slider(moved, force), axis=1, prepend=0.0)
        slip *= scales.displacement
        yield law, slip, force[law.tangent.above] * slip * -scales.force
