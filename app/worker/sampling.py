"""The sampler, which makes frames for the page from iterates."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import fields, replace
from functools import partial
from typing import Any

import numpy as np

from app.frame import Extremes, Floats, Frame, FrictionInterface, InterfaceFields, Run
from app.messages import TABLE, Needs
from app.worker.cells import floats, thinned
from app.worker.extras import EXTRAS, Sampled
from app.worker.geometry import DrawnMesh, DrawnRods
from app.worker.past_iterates import PastIterates
from app.worker.pieces import Cutter
from app.worker.strand import DrawnRope
from app.worker.zigzag import zigzag
from solver.arrays import Array, Indices
from solver.discrete import Problem
from solver.discrete.problem import is_unloaded
from solver.latin import Answer, Iterate, Record, Solution, Status
from solver.latin.end.status import CANCELLED
from solver.laws import Contact
from solver.reference.closed_forms import ExactCurve
from solver.reference.limit_analysis import Collapse
from solver.reference.solution import Reference
from solver.scenes.remarks import remarks_on
from solver.settings.scene import Settings
from solver.study.quantities import reading
from solver.study.quantities.cycles import loads_over_time, turning_points
from solver.study.quantities.finished import FinishedRun, figures_of

MOST_INSTANTS = 401
MOST_POINTS = 401
"""Largest numbers of instants, and of points of an interface, in a frame."""
MOST_TURNS = 100
"""Largest number of turning points of a load that are shown beside these instants."""
MOST_VALUES = 100_000
"""Values of a field up to which a frame has the contact of all interfaces, and not of
the selected one alone."""
MOST_IN_TABLE = 400_000
"""The same for a table that is taken away; pandas writes as many rows in a second."""
MOST_ITERATIONS = 1000
"""Largest number of entries of the history in a frame."""
NO_SCALARS = ("modes", "is_answer")
SCALARS = tuple(f.name for f in fields(Record) if f.name not in NO_SCALARS)
"""Names of the scalars of a record."""


def shown_instants(settings: Settings, count: int) -> Indices:
    """Shown instants of a run, ascending, (n,), of `count` in all.

    They are evenly thinned, and those at which a load turns back or is largest, so that
    curves have their corners.
    """
    kept = thinned(count, MOST_INSTANTS)
    if len(kept) == count:
        return kept
    among = [kept]
    for path in loads_over_time(settings):
        among.append(np.array([path.argmin(), path.argmax()]))
        turns = turning_points(path)
        if len(turns) <= MOST_TURNS:
            among.append(np.array(turns, dtype=np.intp))
    return np.unique(np.concatenate(among))


class Sampler:
    """Sampler of one problem: thinned fields, with forces per length or area.

    `run` is the part that all frames share, to which `complete` adds the reference.
    `past` are the iterates of the search that may be shown again.
    `columns` are the indices of the instants that are shown, shape (n_shown,), and
    `rows` those of the points, by interface; `drawn` has the geometry of the drawing.
    """

    def __init__(self, problem: Problem, settings: Settings, number: int) -> None:
        self.problem = problem
        self.settings = settings
        self.columns = shown_instants(settings, problem.n_instants)
        contacts = problem.contacts
        laws = contacts.laws.values()
        # Length, m, or area, m², of each point.
        lengths = contacts.of_points([law.by_point(law.weights) for law in laws])
        self.rows = {
            name: thinned(size, MOST_POINTS)
            for name, size in zip(contacts, contacts.sizes.tolist(), strict=True)
        }
        self._lengths = {
            name: lengths[points][self.rows[name], None]
            for name, points in contacts.points.items()
        }
        self.loop = settings.structure().loop(problem)
        self.past = PastIterates()
        self._solution: Reference | Answer | None = None
        self._sampled = Sampled(problem, settings, self.loop, self.columns)
        kind = {"plane": DrawnMesh, "helices": DrawnRope}.get(settings.kind, DrawnRods)
        self.drawn: DrawnRods | DrawnMesh | DrawnRope = kind(
            problem, settings, self.columns
        )
        self._cutter = Cutter(problem, settings, self.columns)
        self.run = Run(
            number=number,
            settings=settings,
            sentence=settings.sentence(),
            instants=problem.instants[self.columns],
            interfaces=self._interfaces(),
            geometry=self.drawn.geometry,
            n_substructures=len(problem.substructures),
            across=self.loop.across,
            up=self.loop.up,
            is_idle=is_unloaded(problem),
        )

    def keep(self, iterate: Iterate) -> None:
        """Store an iterate of the search, or the answer as the solution."""
        if not isinstance(iterate, Answer):
            self.past.keep(iterate)
        elif self._solution is None:
            self._solution = iterate

    def complete(self, reference: Reference | None) -> None:
        """Add the reference and the closed forms to the run."""
        curves = self.settings.exact(self.problem, reference)
        exact = tuple(self._at_columns(curve) for curve in curves)
        known: dict[str, Any] = {"exact": exact, "is_compared": True}
        if reference is not None:
            self._solution = reference
            known["reference"] = self._contact(reference, self.problem.contacts)
            loop = np.stack(self.loop.along(reference))
            known["reference_loop"] = floats(loop[:, self.columns])
            known["reference_moved"] = self.drawn.deformed(reference).largest
            known["reference_seconds"] = reference.seconds
        self.run = replace(self.run, **known)

    def collapse(self, collapse: Collapse) -> None:
        """Add the mechanism of a structure that collapses, and the time of collapse."""
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
        *,
        with_remarks: bool = True,
    ) -> Frame:
        """Frame of an iterate, with the extras that views in sight need."""
        needs = replace(needs, interface=self.run.interface(needs.interface))
        # Quantities are those of a run that ended here.
        solution = Solution(iterate, list(history), status or CANCELLED)
        run = FinishedRun(self.settings, solution, made_loop=self.loop)
        residual = None
        is_beside = False
        if isinstance(iterate, Answer):
            residual = iterate.residual
            is_beside = iterate.is_beside
        remarks: tuple[str, ...] = ()
        if status and with_remarks:
            remarks = tuple(remarks_on(self.settings, iterate))
        return Frame(
            run=self.run,
            iteration=iterate.iterations,
            is_answer=is_beside,
            contact=self._with_bounds(
                self._contact(
                    iterate, self._names(needs), with_slip=TABLE in needs.extras
                ),
                iterate,
            ),
            deformed=self.drawn.deformed(iterate),
            loop=floats(np.stack([run.displacement, run.force])[:, self.columns]),
            extremes=self._extremes(run),
            slips=floats(self._slips(iterate)),
            history=_scalars(history),
            status=status,
            energy=floats(np.cumsum(run.dissipated)[self.columns]),
            residual=residual,
            remarks=remarks,
            extras=self._extras(iterate, needs),
            readings={name: reading(name)(run) for name in needs.readings},
        )

    def _extremes(self, run: FinishedRun) -> tuple[Extremes, Extremes]:
        """Extremes of displacement and force of the loop, over all instants."""
        across, up = [
            Extremes(
                figure.largest,
                float(self.problem.instants[figure.instant]),
                figure.last,
            )
            for figure in figures_of(run)
        ]
        return across, up

    def _slips(self, iterate: Iterate) -> Array:
        """Share of all points of surfaces that slip, at shown instants, (n_shown,)."""
        contacts = self.problem.contacts
        # Springs are next to the surfaces, and neither stick nor slip.
        status = iterate.status[contacts.on_surfaces]
        slips = np.abs(status[:, self.columns]) == 1
        # One wire of a layer may stand for all of them.
        copies = contacts.copies[contacts.on_surfaces]
        return np.asarray(copies @ slips / copies.sum())

    def _extras(self, iterate: Iterate, needs: Needs) -> dict[str, Any]:
        known = {name: partial(extra, self._sampled) for name, extra in EXTRAS.items()}
        known |= self.drawn.extras
        known["pieces"] = self._cutter.pieces
        known["zigzag"] = partial(
            zigzag, self._sampled, self.past.few() or [iterate], self._solution
        )
        return {
            name: known[name](iterate, needs) for name in needs.extras & known.keys()
        }

    def _at_columns(self, curve: ExactCurve) -> ExactCurve:
        """A closed form at the shown instants."""
        if curve.up.ndim == 1:
            across = curve.across[self.columns]
            return replace(curve, across=across, up=curve.up[self.columns])
        return replace(curve, up=curve.up[:, self.columns])

    def _names(self, needs: Needs) -> tuple[str, ...]:
        """Names of the interfaces whose contact fields are in a frame."""
        size = sum(len(rows) for rows in self.rows.values()) * len(self.columns)
        most = MOST_VALUES
        if TABLE in needs.extras:
            most = MOST_IN_TABLE
        if size <= most:
            return tuple(self.rows)
        return (needs.interface,)

    def _interfaces(self) -> dict[str, FrictionInterface]:
        """Interfaces by name, in the order of stacked fields."""
        contacts = self.problem.contacts
        found = {}
        for law, numbers, _, _ in contacts.stacks:
            is_cut = np.bincount(law.points) > 1
            strength = coefficient = None
            if law.opens:
                coefficient = law.mean_by_point(law.tangential.friction)[:, None]
            else:
                strength = self._strength_of(law)
            for number, (points, _) in zip(numbers, law.ranges, strict=True):
                name = contacts.names[number]
                positions = law.positions[points]
                rows = self.rows[name]
                found[name] = FrictionInterface(
                    positions=floats(positions[rows]),
                    cuts=floats(positions[is_cut[points]]),
                    strength=_shown(strength, points, rows),
                    coefficient=_shown(coefficient, points, rows),
                    is_spring=law.is_spring,
                )
        return {name: found[name] for name in contacts.names}

    def _strength_of(self, law: Contact) -> Array:
        """Friction strength at the points of a law, N/m or Pa.

        Shape (n_points, n_shown), or (n_points, 1) where it does not change.
        """
        highest = law.by_point(law.tangential.largest_bound)
        # A strength that does not change has a single column.
        if highest.shape[1] > 1:
            highest = highest[:, self.columns]
        force = highest * self.problem.scales.force
        return np.asarray(force / law.by_point(law.weights)[:, None])

    def _contact(
        self,
        shown: Iterate | Reference,
        names: Iterable[str],
        *,
        with_slip: bool = False,
    ) -> Mapping[str, InterfaceFields]:
        contact = {}
        for name in names:
            nodal = shown.contact(name)
            rows = self.rows[name]
            # Forces at nodes depend on the mesh; over their lengths they do not.
            lengths = self._lengths[name]
            pressure = None
            if nodal.normal_force is not None:
                pressure = floats(nodal.normal_force[rows][:, self.columns] / lengths)
            slip = None
            if with_slip:
                slip = floats(nodal.slip[rows][:, self.columns])
            contact[name] = InterfaceFields(
                floats(nodal.tangential_force[rows][:, self.columns] / lengths),
                pressure,
                np.ascontiguousarray(nodal.status[rows][:, self.columns]),
                slip,
            )
        return contact

    def _with_bounds(
        self, contact: Mapping[str, InterfaceFields], iterate: Iterate
    ) -> Mapping[str, InterfaceFields]:
        """Add the friction bound of the local stage, if slip, a bond or a cap acts."""
        friction_law = self.settings.law
        is_known = not self.problem.opens and friction_law.slip_factor is None
        if friction_law.is_by_pressure_alone or is_known:
            return contact
        contacts = self.problem.contacts
        force = iterate.boundary_local_force
        bounded = dict(contact)
        for law, numbers, _, _ in contacts.stacks:
            violation = law.violation(iterate.local_displacement, force, 0.0)
            bound = law.by_point(violation.bound)[:, self.columns]
            for number, (points, _) in zip(numbers, law.ranges, strict=True):
                name = contacts.names[number]
                if name in contact:
                    shown = bound[points][self.rows[name]] / self._lengths[name]
                    largest = floats(shown * self.problem.scales.force)
                    bounded[name] = replace(contact[name], bound=largest)
        return bounded


def _shown(field: Array | None, points: slice, rows: Indices) -> Floats | None:
    """Shown rows of a field of an interface, (n_rows, n), from the field of its law."""
    if field is None:
        return None
    return floats(field[points][rows])


def _scalars(history: Sequence[Record]) -> dict[str, Floats]:
    """Scalars of the records of a history, thinned, shape (n_records,) each."""
    kept = [history[number] for number in thinned(len(history), MOST_ITERATIONS)]
    scalars = {}
    for name in SCALARS:
        values = [getattr(record, name) for record in kept]
        scalars[name] = floats(np.array(values))
    return scalars
