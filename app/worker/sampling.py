"""From an iterate to the frame that the page is sent."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import fields, replace
from typing import Any

import numpy as np

from app.frame import ContactFields, Floats, Frame, Interface, Run
from app.messages import Needs
from app.worker.extras import EXTRAS
from app.worker.geometry import DrawnMesh, DrawnRods, floats, thinned
from app.worker.strand import DrawnRope
from solver.arrays import Array
from solver.discrete import Problem
from solver.discrete.idle import nothing_acts
from solver.discrete.loops import LoopFields
from solver.discrete.rope.rope import Rope
from solver.latin import Iterate, Record, Solution, Status
from solver.latin.status import CANCELLED
from solver.reference.solution import Reference
from solver.remarks import remarks_on
from solver.scenes import exact_of, loop_of, structure_of, words_of
from solver.settings import Settings
from solver.study.quantities.finished import FinishedRun
from solver.study.quantities.quantities import reading

MOST_INSTANTS, MOST_POINTS = 401, 401
"""Instants, and points of an interface, that a frame has at most."""
MOST_VALUES = 100_000
"""Values of a field up to which a frame has the contact of all interfaces, and not of one."""
MOST_ITERATIONS, MOST_SUBSTRUCTURES = 1000, 60
"""Entries of the history that a frame has at most, and sizes of bases in each."""
SCALARS = tuple(f.name for f in fields(Record) if f.name not in ("reduction", "is_answer"))


class Sampler:
    """Thin the fields of one problem, and turn nodal forces into forces per length or area.

    Attributes
    ----------
    run
        What all frames share; `complete` adds the reference.
    problem, settings, loop, columns, rows
        What is solved, its loop, and the instants, and points by interface, that are shown.
    drawn
        The bodies as they are drawn.
    """

    def __init__(self, problem: Problem, settings: Settings, number: int) -> None:
        self.problem, self.settings = problem, settings
        self.columns = thinned(problem.n_instants, MOST_INSTANTS)
        self.rows = {
            name: thinned(len(law.positions), MOST_POINTS) for name, law in problem.rubbing.items()
        }
        self.loop = loop_of(settings, problem)
        self.drawn = _drawn(problem, structure_of(settings), self.columns)
        load = self.loop.force
        self.run = Run(
            number=number,
            settings=settings,
            sentence=words_of(settings),
            instants=floats(problem.instants[self.columns]),
            interfaces={name: self._interface(name) for name in problem.rubbing},
            geometry=self.drawn.geometry,
            across=self.loop.across,
            up=self.loop.up,
            load=floats(load[self.columns]) if isinstance(load, np.ndarray) else None,
            is_idle=nothing_acts(problem),
        )

    def complete(self, reference: Reference | None) -> None:
        """Add what is known without the search: the reference, and closed forms."""
        curves = exact_of(self.settings, self.problem, reference)
        exact = tuple(
            replace(curve, across=curve.across[self.columns], up=curve.up[self.columns])
            if curve.up.ndim == 1
            else replace(curve, up=curve.up[:, self.columns])
            for curve in curves
        )
        self.run = replace(self.run, exact=exact)
        if reference is not None:
            self.run = replace(
                self.run,
                reference=self._contact(reference, tuple(self.problem.rubbing)),
                reference_loop=self._loop(reference),
                reference_seconds=reference.seconds,
            )

    def frame(
        self, iterate: Iterate, history: Sequence[Record], status: Status | None, needs: Needs
    ) -> Frame:
        """What is shown of an iterate, with the extras that views need."""
        solution = Solution(iterate, list(history), status or CANCELLED)
        run = FinishedRun(self.settings, solution, bool(self.run.reference), self.loop)
        return Frame(
            run=self.run,
            iteration=iterate.iterations,
            is_answer=iterate.is_answer,
            contact=self._contact(iterate, self._names(needs)),
            deformed=self.drawn.deformed(iterate),
            loop=self._loop(iterate),
            history=_columns(history),
            status=status,
            energy=float(run.dissipated.sum()),
            residual=iterate.residual,
            remarks=tuple(remarks_on(self.settings, iterate)) if status else (),
            extras={
                name: EXTRAS[name](self, iterate, needs) for name in needs.extras if name in EXTRAS
            },
            readings={name: reading(name)(run) for name in needs.readings},
        )

    def _names(self, needs: Needs) -> tuple[str, ...]:
        """Interfaces whose contact a frame has."""
        size = sum(len(rows) for rows in self.rows.values()) * len(self.columns)
        if size <= MOST_VALUES:
            return tuple(self.rows)
        return (needs.interface if needs.interface in self.rows else next(iter(self.rows)),)

    def _interface(self, name: str) -> Interface:
        law, rows = self.problem.rubbing[name], self.rows[name]
        bound = coefficient = None
        if law.opens:
            coefficient = floats(law.mean_by_point(law.tangential.friction)[rows, None])
        else:
            highest = law.by_point(law.tangential.highest)[rows]
            highest = highest[:, self.columns] if highest.shape[1] > 1 else highest
            bound = floats(highest * self.problem.scales.force / self.lengths(name)[:, None])
        cuts = law.positions[np.bincount(law.points) > 1]
        return Interface(floats(law.positions[rows]), floats(cuts), bound, coefficient)

    def lengths(self, name: str) -> Array:
        """Length or area that each shown point of an interface stands for."""
        law = self.problem.rubbing[name]
        return np.asarray(law.by_point(law.weights)[self.rows[name]])

    def _contact(
        self, shown: Iterate | Reference, names: Sequence[str]
    ) -> Mapping[str, ContactFields]:
        contact = {}
        for name in names:
            nodal, lengths = shown.contact(name), self.lengths(name)[:, None]
            kept, pressure = np.ix_(self.rows[name], self.columns), nodal.normal_force
            contact[name] = ContactFields(
                floats(nodal.tangential_force[kept] / lengths),
                None if pressure is None else floats(pressure[kept] / lengths),
                np.ascontiguousarray(nodal.status[kept]),
            )
        return contact

    def _loop(self, shown: LoopFields) -> Floats:
        force = (
            self.loop.force if isinstance(self.loop.force, np.ndarray) else self.loop.force(shown)
        )
        both = self.loop.displacement(shown.displacement), force
        return floats(np.stack([np.asarray(values)[self.columns] for values in both]))


def _drawn(problem: Problem, structure: Any, columns: Array) -> DrawnRods | DrawnMesh | DrawnRope:
    """The bodies of a structure as they are drawn."""
    if isinstance(structure, Rope):
        return DrawnRope(structure, columns)
    kind = DrawnRods if problem.inside is None else DrawnMesh
    return kind(problem, structure.described(), columns)


def _columns(history: Sequence[Record]) -> dict[str, Floats]:
    kept = [history[place] for place in thinned(len(history), MOST_ITERATIONS)]
    columns = {name: floats(np.array([getattr(entry, name) for entry in kept])) for name in SCALARS}
    if kept and kept[0].reduction:
        shown = thinned(len(kept[0].reduction), MOST_SUBSTRUCTURES)
        columns["modes"] = floats(np.array([[e.reduction[n].modes for n in shown] for e in kept]))
    return columns
