"""From the fields of a run to what a screen shows of them."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.worker.bases import show_bases
from app.worker.frames import Frame, Reference, Stand
from app.worker.meshes import Thinned
from app.worker.shown import (
    LONGEST_CURVE,
    MOST_SPECTRA,
    MOST_VALUES,
    Axes,
    Bytes,
    Floats,
    Look,
    MeshField,
    instant_of,
    thinned,
)
from app.worker.wires import ShownWires
from solver.discrete import Problem
from solver.discrete.idle import nothing_acts
from solver.discrete.loops import Fields
from solver.latin import Checkpoint, Iterate
from solver.reduction.svd import friction_spectra
from solver.reference import incremental
from solver.scenes import broken_wire_of, closed_form_of, kind_of, loop_of
from solver.settings import Settings


class Sampler:
    """Thin the fields of one problem, and turn nodal forces into forces per length or area.

    Parameters
    ----------
    problem, settings
        What is solved.
    look
        Where one looks.

    Attributes
    ----------
    interface
        Name of the interface that is looked at.
    """

    def __init__(self, problem: Problem, settings: Settings, look: Look) -> None:
        names = list(problem.rubbing)
        self.interface = look.interface if look.interface in names else names[0]
        self._problem = problem
        self._settings = settings
        self._law = law = problem.rubbing[self.interface]
        sizes = [len(one.positions) for one in problem.rubbing.values()]
        first = sum(sizes[: names.index(self.interface)])
        self._points = slice(first, first + len(law.positions))
        self._rows = thinned(len(law.positions))
        self._columns = thinned(problem.n_instants)
        self._curve = thinned(problem.n_instants, LONGEST_CURVE)
        self._lengths = law.by_point(law.weights)[self._rows]
        self._loop = loop_of(settings, problem)
        self._mesh: Thinned | None = None
        self._wires: ShownWires | None = None
        if problem.inside is not None:
            self._mesh = Thinned(problem.inside, settings)
        elif kind_of(settings) == "wires":
            self._wires = ShownWires(problem, settings.values()["broken"])

    def stand(self) -> Stand:
        """Describe what the fields stand on, without the closed form."""
        problem, law, loop = self._problem, self._law, self._loop
        bound = coefficient = None
        if law.opens:
            coefficient = _floats(law.mean_by_point(law.friction)[self._rows])
        else:
            whole = law.by_point(law.bound)[self._rows]
            bound = _floats(whole * problem.scales.force / self._lengths)
        load = loop.force if isinstance(loop.force, np.ndarray) else None
        return Stand(
            interface=self.interface,
            interfaces=tuple(problem.rubbing),
            positions=_floats(law.positions[self._rows]),
            instants=_floats(problem.instants[self._columns]),
            cuts=_floats(law.positions[np.bincount(law.points) > 1]),
            bound=bound,
            coefficient=coefficient,
            loop=Axes(loop.across, loop.up),
            load=None if load is None else _floats(load[self._curve]),
            all_instants=_floats(problem.instants[self._curve]),
            closed_form=None,
            closed_form_end=None,
            mesh=self._mesh.mesh if self._mesh else None,
            wires=self._wires.base if self._wires else None,
            is_idle=nothing_acts(problem),
        )

    def completed(self, stand: Stand) -> Stand:
        """Add the closed form, where there is one."""
        closed = closed_form_of(self._settings)
        if closed is not None:
            return replace(
                stand,
                closed_form=self._density(closed.friction_force),
                closed_form_end=_floats(closed.end_displacement[self._curve]),
            )
        exact = broken_wire_of(self._settings)
        if exact is not None and self._wires is not None:
            return replace(stand, wires=self._wires.completed(exact, self._columns))
        return stand

    def reference(self, found: incremental.Reference) -> Reference:
        """Show a reference."""
        fields = found.contact(self.interface)
        return Reference(
            interface=self.interface,
            friction=self._density(fields.tangential_force),
            pressure=None if fields.normal_force is None else self._density(fields.normal_force),
            status=self._status(fields.status),
            end_displacement=_floats(self._loop.displacement(found.displacement)[self._curve]),
            load=self._load(found),
            residual=found.residual,
            seconds=found.seconds,
        )

    def frame(
        self,
        iterate: Iterate,
        watch: frozenset[str],
        look: Look,
        before: Checkpoint | None = None,
    ) -> Frame:
        """Show an iterate, with what is watched beyond its fields.

        The iterate `before` tells what became of its modes.
        """
        *normal, tangential = self._problem.contact_places[self.interface]
        force = iterate.contact_force
        instant = instant_of(look.phase, len(self._columns))
        axial = self._wires if "axial" in watch else None
        return Frame(
            iteration=iterate.number,
            interface=self.interface,
            friction=self._density(force[tangential]),
            pressure=self._density(force[normal[0]]) if normal else None,
            status=self._status(iterate.status[self._points]),
            end_displacement=_floats(self._loop.displacement(iterate.displacement)[self._curve]),
            load=self._load(iterate),
            spectra=_table(friction_spectra(iterate)) if "spectra" in watch else None,
            bases=show_bases(iterate, before, watch, look.substructure),
            mesh=self._mesh_field(iterate, look, instant) if "mesh" in watch else None,
            axial=axial.forces(iterate, instant, self._columns[instant]) if axial else None,
        )

    def _mesh_field(self, iterate: Iterate, look: Look, instant: int) -> MeshField | None:
        if self._mesh is None:
            return None
        column = int(self._columns[instant])
        whole = iterate.displacement
        displacement, stress = self._mesh.fields(whole, column, look.stress)
        largest = max(float(whole.max()), -float(whole.min()))
        return MeshField(instant, look.stress, _floats(displacement), _floats(stress), largest)

    def _load(self, fields: Fields) -> Floats | None:
        force = self._loop.force
        return None if isinstance(force, np.ndarray) else _floats(force(fields)[self._curve])

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
