"""From a strand to what a screen shows of its wires."""

from __future__ import annotations

import numpy as np

from app.picture.shown import Floats, Wires, thinned
from solver.discrete import Problem
from solver.discrete.probes import AxialForce
from solver.latin import Iterate

MOST_WIRES = 12


class ShownWires:
    """The axial forces of a strand, thinned; the broken wire is always shown.

    Parameters
    ----------
    problem
        One of wires.
    broken
        Number of the broken one, from 1; 0 for none.

    Attributes
    ----------
    base
        What the forces stand on.
    """

    def __init__(self, problem: Problem, broken: int) -> None:
        self._force = AxialForce(problem)
        count = int(self._force.wires.max()) + 1
        self._shape = count, len(self._force.wires) // count
        wires = {int(wire) for wire in thinned(count, MOST_WIRES)}
        if broken:
            wires.add(broken - 1)
        elements = thinned(self._shape[1])
        self._chosen = np.ix_(np.array(sorted(wires)), elements)
        self.base = Wires(
            numbers=tuple(wire + 1 for wire in sorted(wires)),
            positions=self._force.positions[: self._shape[1]][elements].astype(np.float32),
            broken=broken,
        )

    def forces(self, iterate: Iterate, column: int) -> Floats:
        """Show the forces of an iterate at one instant."""
        force = self._force(iterate.displacement[:, column]).reshape(self._shape)
        return np.asarray(force[self._chosen], dtype=np.float32)
