"""From the fields of a run to what a screen shows of them."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.worker.bases import show_bases
from app.worker.protocol import (
    LONGEST_CURVE,
    MOST_SPECTRA,
    MOST_VALUES,
    Begun,
    Bytes,
    Floats,
    Frame,
    Reference,
    thinned,
)
from solver.discrete import Problem
from solver.latin import Checkpoint, Iterate
from solver.latin.indicators import behaviour_indicator
from solver.laws import Neumann, Perfect
from solver.reduction.svd import friction_spectra
from solver.reference import incremental
from solver.reference.closed_form import closed_form
from solver.scenes.bar import BarSettings, bar
from solver.settings import Settings


class Sampler:
    """Thin the fields of one problem, and turn nodal forces into forces per length."""

    def __init__(self, problem: Problem) -> None:
        law = problem.friction
        self._problem = problem
        self._rows = thinned(len(law.positions))
        self._columns = thinned(problem.n_instants)
        self._curve = thinned(problem.n_instants, LONGEST_CURVE)
        lengths = law.by_point(law.weights)
        self._lengths = lengths[self._rows]

    def begun(self, ticket: int) -> Begun:
        """Describe what the fields stand on, without the closed form."""
        problem, law = self._problem, self._problem.friction
        bound = law.by_point(law.bound)
        cuts = [law.first[0] for law in problem.of_law(Perfect) if isinstance(law, Perfect)]
        (loaded,) = (law for law in problem.of_law(Neumann) if isinstance(law, Neumann))
        return Begun(
            ticket=ticket,
            positions=_floats(law.positions[self._rows]),
            instants=_floats(problem.instants[self._columns]),
            cuts=_floats(problem.positions[problem.row_dofs[np.array(cuts, dtype=np.intp)]]),
            bound=_floats(bound[self._rows] * problem.scales.force / self._lengths),
            load=_floats(loaded.force[0, self._curve] * problem.scales.force),
            all_instants=_floats(problem.instants[self._curve]),
            closed_form=None,
            closed_form_end=None,
        )

    def completed(self, begun: Begun, settings: Settings) -> Begun:
        """Add the closed form, where there is one."""
        closed = closed_form(bar(settings)) if isinstance(settings, BarSettings) else None
        if closed is None:
            return begun
        return replace(
            begun,
            closed_form=self._density(closed.friction_force),
            closed_form_end=_floats(closed.end_displacement[self._curve]),
        )

    def reference(self, ticket: int, found: incremental.Reference) -> Reference:
        """Show a reference."""
        return Reference(
            ticket=ticket,
            friction=self._density(found.friction_force),
            status=self._status(found.status),
            end_displacement=_floats(found.displacement[-1, self._curve]),
            residual=found.residual,
            seconds=found.seconds,
        )

    def frame(
        self,
        ticket: int,
        iterate: Iterate,
        watch: frozenset[str],
        *,
        sought: bool = False,
        before: Checkpoint | None = None,
        substructure: int | None = None,
    ) -> Frame:
        """Show an iterate, with what is watched beyond its fields.

        The iterate `before` tells what became of its modes; `substructure` is as in Watch.
        """
        behaviour = "behaviour" in watch
        return Frame(
            ticket=ticket,
            iteration=iterate.number,
            sought=sought,
            friction=self._density(iterate.friction_force),
            status=self._status(iterate.status),
            end_displacement=_floats(iterate.displacement[-1, self._curve]),
            spectra=_table(friction_spectra(iterate)) if "spectra" in watch else None,
            behaviour=_floats(self._thin(behaviour_indicator(iterate).map)) if behaviour else None,
            bases=show_bases(iterate, before, watch, substructure),
        )

    def _thin(self, field: NDArray[Any]) -> NDArray[Any]:
        return field[np.ix_(self._rows, self._columns)]

    def _density(self, force: NDArray[np.float64]) -> Floats:
        return _floats(self._thin(force) / self._lengths[:, None])

    def _status(self, status: NDArray[np.int8]) -> Bytes:
        return np.ascontiguousarray(self._thin(status))


def _floats(values: NDArray[np.float64]) -> Floats:
    return values.astype(np.float32, order="C")


def _table(spectra: list[NDArray[np.float64]]) -> Floats:
    """Give spectra as rows of one table, padded with NaN."""
    chosen = [spectra[place][:MOST_VALUES] for place in thinned(len(spectra), MOST_SPECTRA)]
    table = np.full((len(chosen), max(map(len, chosen))), np.nan, dtype=np.float32)
    for row, values in zip(table, chosen, strict=True):
        row[: len(values)] = values
    return table
