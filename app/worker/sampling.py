"""From an iterate to the frame that the page is sent."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import fields, replace
from functools import partial
from typing import Any

import numpy as np

from app.frame import Floats, Frame, FrictionInterface, InterfaceFields, Run
from app.messages import Needs
from app.worker.extras import EXTRAS
from app.worker.geometry import DrawnMesh, DrawnRods, floats, thinned
from app.worker.strand import DrawnRope
from solver.arrays import Array
from solver.discrete import Problem
from solver.discrete.problem import nothing_acts
from solver.discrete.structure import LoopFields
from solver.latin import Iterate, Record, Solution, Status
from solver.latin.end.status import CANCELLED
from solver.reference.limit_analysis import Collapse
from solver.reference.solution import Reference
from solver.scenes.remarks import remarks_on
from solver.settings.scene import Settings
from solver.study.quantities import reading
from solver.study.quantities.finished import FinishedRun

MOST_INSTANTS = 401
MOST_POINTS = 401
"""Instants, and points of an interface, that a frame has at most."""
MOST_VALUES = 100_000
"""Values of a field up to which a frame has the contact of all interfaces, and not of
one."""
MOST_ITERATIONS = 1000
"""Entries of the history that a frame has at most."""
SCALARS = tuple(f.name for f in fields(Record) if f.name not in ("modes", "is_answer"))


class Sampler:
    """Thin the fields of one problem, and turn nodal forces into forces per length or area.

    `run` is what all frames share, to which `complete` adds the reference. Of what is
    solved, `columns` are the instants, and `rows` the points by interface, that are
    shown; `drawn` is the bodies as they are drawn.
    """

    def __init__(self, problem: Problem, settings: Settings, number: int) -> None:
        self.problem = problem
        self.settings = settings
        self.columns = thinned(problem.n_instants, MOST_INSTANTS)
        self.rows = {
            name: thinned(len(law.positions), MOST_POINTS)
            for name, law in problem.rubbing.items()
        }
        self.loop = settings.structure().loop(problem)
        kind = {"plane": DrawnMesh, "helices": DrawnRope}.get(settings.kind, DrawnRods)
        self.drawn: DrawnRods | DrawnMesh | DrawnRope = kind(
            problem, settings, self.columns
        )
        self.run = Run(
            number=number,
            settings=settings,
            sentence=settings.sentence(),
            instants=floats(problem.instants[self.columns]),
            interfaces={name: self._interface(name) for name in problem.rubbing},
            geometry=self.drawn.geometry,
            across=self.loop.across,
            up=self.loop.up,
            is_idle=nothing_acts(problem),
        )

    def complete(self, reference: Reference | None) -> None:
        """Add what is known without the search: the reference, and closed forms."""
        curves = self.settings.exact(self.problem, reference)
        exact = tuple(
            replace(curve, across=curve.across[self.columns], up=curve.up[self.columns])
            if curve.up.ndim == 1
            else replace(curve, up=curve.up[:, self.columns])
            for curve in curves
        )
        known: dict[str, Any] = {"exact": exact, "is_compared": True}
        if reference is not None:
            known["reference"] = self._contact(reference, self.problem.rubbing)
            known["reference_loop"] = self._loop(reference)
            known["reference_seconds"] = reference.seconds
        self.run = replace(self.run, **known)

    def collapse(self, collapse: Collapse) -> None:
        """Add the mechanism by which the structure begins to fail, and when."""
        moved = self.drawn.nodes_of(
            collapse.mechanism * self.problem.scales.displacement
        )
        self.run = replace(
            self.run, is_compared=True, mechanism=moved, collapses_at=collapse.time
        )

    def frame(
        self,
        iterate: Iterate,
        history: Sequence[Record],
        status: Status | None,
        needs: Needs,
    ) -> Frame:
        """What is shown of an iterate, with the extras that views need."""
        needs = replace(needs, interface=self.run.interface(needs.interface))
        solution = Solution(iterate, list(history), status or CANCELLED)
        run = FinishedRun(self.settings, solution, made_loop=self.loop)
        kept = [history[place] for place in thinned(len(history), MOST_ITERATIONS)]
        scalars = {
            n: floats(np.array([getattr(each, n) for each in kept])) for n in SCALARS
        }
        return Frame(
            run=self.run,
            iteration=iterate.iterations,
            is_answer=iterate.is_answer,
            contact=self._contact(iterate, self._names(needs)),
            deformed=self.drawn.deformed(iterate),
            loop=self._loop(iterate),
            history=scalars,
            status=status,
            energy=float(run.dissipated.sum()),
            residual=iterate.residual,
            remarks=tuple(remarks_on(self.settings, iterate)) if status else (),
            extras=self._extras(iterate, needs),
            readings={name: reading(name)(run) for name in needs.readings},
        )

    def _extras(self, iterate: Iterate, needs: Needs) -> dict[str, Any]:
        known = {
            name: partial(extra, self) for name, extra in EXTRAS.items()
        } | self.drawn.extras
        return {
            name: known[name](iterate, needs) for name in needs.extras & known.keys()
        }

    def _names(self, needs: Needs) -> tuple[str, ...]:
        """Interfaces whose contact a frame has."""
        size = sum(len(rows) for rows in self.rows.values()) * len(self.columns)
        if size <= MOST_VALUES:
            return tuple(self.rows)
        return (needs.interface,)

    def _interface(self, name: str) -> FrictionInterface:
        law = self.problem.rubbing[name]
        rows = self.rows[name]
        bound = coefficient = None
        if law.opens:
            coefficient = floats(law.mean_by_point(law.tangential.friction)[rows, None])
        else:
            highest = law.by_point(law.tangential.highest)[rows]
            if highest.shape[1] > 1:
                highest = highest[:, self.columns]
            else:
                highest = highest
            bound = floats(
                highest * self.problem.scales.force / self._lengths(name)[:, None]
            )
        cuts = law.positions[np.bincount(law.points) > 1]
        positions = floats(law.positions[rows])
        return FrictionInterface(
            positions, floats(cuts), bound, coefficient, law.is_spring
        )

    def _lengths(self, name: str) -> Array:
        """Length or area that each shown point of an interface stands for."""
        law = self.problem.rubbing[name]
        return np.asarray(law.by_point(law.weights)[self.rows[name]])

    def _contact(
        self, shown: Iterate | Reference, names: Iterable[str]
    ) -> Mapping[str, InterfaceFields]:
        contact = {}
        for name in names:
            nodal = shown.contact(name)
            lengths = self._lengths(name)[:, None]
            kept = np.ix_(self.rows[name], self.columns)
            pressure = nodal.normal_force
            contact[name] = InterfaceFields(
                floats(nodal.tangential_force[kept] / lengths),
                None if pressure is None else floats(pressure[kept] / lengths),
                np.ascontiguousarray(nodal.status[kept]),
            )
        return contact

    def _loop(self, shown: LoopFields) -> Floats:
        return floats(np.stack(self.loop.along(shown))[:, self.columns])
