"""The local stage: all interface laws at all points and instants (paper, problem 2.1)."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from solver.discrete.problem import Array, Indices, Problem, space_time
from solver.latin.blocks import Blocks, at_once
from solver.laws import Contact, Dirichlet, Friction, Neumann, Perfect
from solver.laws.boundary import neumann
from solver.laws.contact import ContactLaw
from solver.laws.friction import FrictionLaw, as_slice
from solver.laws.perfect import perfect


class LocalStage:
    """Interface laws along the search direction E+, ready for one problem and one k.

    It reads z = W - F/k of the linear stage alone, and what it gives is read as
    W^ + F^/k = 2 W^ - z (theory.md, 2). Laws of one kind are applied together.

    Parameters
    ----------
    problem, k
        Whose laws; k has shape (n_rows,).
    where
        Rows and instants to which the laws are confined, or None for all. Only rows of `Friction`
        may be left out, together with those below; fields then have these rows and instants alone.
    blocks
        Of instants, for what is local in time; None for all at once.

    Attributes
    ----------
    displacement
        W^ of the last call, shape (n_rows, n_instants); the next call gives a new one.
    """

    def __init__(
        self,
        problem: Problem,
        k: Array,
        where: tuple[Indices, Indices] | None = None,
        blocks: Blocks | None = None,
    ) -> None:
        rows, instants = where or (np.arange(problem.n_rows), np.arange(problem.n_instants))
        place = np.full(problem.n_rows, -1)
        place[rows] = np.arange(len(rows))
        shape = (len(rows), len(instants))
        self._blocks = blocks or at_once(len(instants))
        self.displacement = space_time(*shape)
        self._outgoing = space_time(*shape)
        self._given: list[tuple[slice | Indices, Array]] = []
        self._laws = [
            _law(law, place, k[rows], len(instants)) for law in together(problem.rubbing.values())
        ]
        cuts = [law for law in problem.of_law(Perfect) if isinstance(law, Perfect)]
        self._cuts = None
        if cuts:
            first = np.concatenate([law.first for law in cuts])
            second = np.concatenate([law.second for law in cuts])
            share = (k[first] / (k[first] + k[second]))[:, None]
            self._cuts = (as_slice(place[first]), as_slice(place[second]), share)
        self._loads = [
            (as_slice(place[law.rows]), law.force[:, instants] / k[law.rows, None])
            for law in problem.of_law(Neumann)
            if isinstance(law, Neumann)
        ]
        for law in problem.of_law(Dirichlet):
            assert isinstance(law, Dirichlet)
            self._given.append((as_slice(place[law.rows]), law.displacement[:, instants]))

    def __call__(self, incoming: Array) -> Array:
        """Obey all laws.

        Parameters
        ----------
        incoming
            z = W - F/k of the linear stage, shape (n_rows, n_instants).

        Returns
        -------
        W^ + F^/k, same shape; the next call overwrites it.
        """
        found = self.displacement = np.empty_like(self._outgoing)
        for rows, displacement in self._given:
            found[rows] = displacement
        for law in self._laws:
            law(incoming, found)
        self._blocks.each(lambda some: self._bonds(incoming[:, some], some))
        return self._outgoing

    def _bonds(self, incoming: Array, some: slice) -> None:
        """Obey the laws that are local in time, at some instants, and reflect."""
        found, outgoing = self.displacement[:, some], self._outgoing[:, some]
        if self._cuts is not None:
            first, second, share = self._cuts
            common = perfect(incoming[first], incoming[second], share)
            found[first] = common
            found[second] = common
        for rows, force_over_k in self._loads:
            found[rows] = neumann(incoming[rows], force_over_k[:, some])
        np.multiply(found, 2.0, out=outgoing)
        np.subtract(outgoing, incoming, out=outgoing)


def together(laws: Iterable[Friction | Contact]) -> list[Friction | Contact]:
    """Join all interfaces of known bound between two bodies: their points know no interface."""
    pairs, others = [], []
    for law in laws:
        if isinstance(law, Friction) and law.below is not None:
            pairs.append((law, law.below))
        else:
            others.append(law)
    if not pairs:
        return others
    joined = Friction(
        rows=np.concatenate([law.rows for law, _ in pairs]),
        points=np.arange(sum(len(law.rows) for law, _ in pairs)),
        positions=np.concatenate([law.positions[law.points] for law, _ in pairs]),
        weights=np.concatenate([law.weights for law, _ in pairs]),
        bound=np.concatenate([law.bound for law, _ in pairs]),
        below=np.concatenate([below for _, below in pairs]),
    )
    return [joined, *others]


def _law(
    law: Friction | Contact, place: Indices, k: Array, n_times: int
) -> FrictionLaw | ContactLaw:
    """Prepare a law for fields whose rows stand at these places; -1 where they are left out."""
    if isinstance(law, Contact):
        below = (place[law.below[0]], place[law.below[1]]) if law.below else None
        moved = replace(law, normal=place[law.normal], tangent=place[law.tangent], below=below)
        return ContactLaw(moved, k, n_times)
    kept = place[law.rows] >= 0
    confined = replace(
        law,
        rows=place[law.rows[kept]],
        points=law.points[kept],
        weights=law.weights[kept],
        bound=law.bound[kept],
        below=None if law.below is None else place[law.below[kept]],
    )
    return FrictionLaw(confined, k, n_times)
