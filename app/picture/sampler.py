"""From the fields of a run to what a screen shows of them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.picture.bases import Bases, bases_of
from app.picture.clipped import Clipped, clipped
from app.picture.cycled import Cycled, cycled
from app.picture.frames import DrawnFields, Stand
from app.picture.helices import HelixGeometry
from app.picture.meshes import Thinned
from app.picture.portrait import DrawnGeometry, Pose
from app.picture.shown import (
    LONGEST_CURVE,
    Axes,
    Floats,
    Look,
    MeshField,
    floats,
    instant_of,
    thinned,
)
from app.picture.slip_plane import SlipPlane, slip_plane, space_of
from app.picture.spectra import spectra_of
from app.picture.strands import StrandField, shown_strand
from app.picture.wires import ShownWires
from solver.discrete import Problem
from solver.discrete.idle import nothing_acts
from solver.discrete.loops import LoopFields
from solver.discrete.rope.rope import Rope
from solver.latin import Iterate
from solver.latin.status_changes import status_changes
from solver.reference.closed_forms.exact_curve import ExactCurve
from solver.reference.shakedown.slip_space import SlipSpace
from solver.reference.solution import Reference
from solver.scenes import exact_of, kind_of, loop_of, structure_of, words_of
from solver.settings import Settings

Changes = tuple[dict[str, int], NDArray[np.bool_]]
"""How many points and instants have changed their status, by kinds, and where, as it is drawn."""


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
    loop
        Of the scene.
    """

    def __init__(self, problem: Problem, settings: Settings, look: Look) -> None:
        names = list(problem.rubbing)
        structure = structure_of(settings)
        self._strand = shown_strand(settings)
        usual = self._strand.base.usual if self._strand else names[0]
        self.interface = look.interface if look.interface in names else usual
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
        self.loop = loop_of(settings, problem)
        described = structure.described()
        self._mesh: Thinned | None = None
        self._wires: ShownWires | None = None
        if problem.inside is not None:
            self._mesh = Thinned(problem.inside, settings)
        elif kind_of(settings) == "wires":
            self._wires = ShownWires(problem, described.broken[0] + 1 if described.broken else 0)
        mesh = self._mesh.mesh if self._mesh else None
        self._geometry: DrawnGeometry | HelixGeometry = (
            HelixGeometry(structure)
            if isinstance(structure, Rope)
            else DrawnGeometry(problem, described, mesh)
        )

    def stand(self) -> Stand:
        """Describe what the fields stand on, without closed forms."""
        problem, law, loop = self._problem, self._law, self.loop
        bound = coefficient = None
        if law.opens:
            coefficient = floats(law.mean_by_point(law.tangential.friction)[self._rows])
        else:
            whole = law.by_point(law.tangential.highest)[self._rows]
            if whole.shape[1] > 1:
                whole = whole[:, self._columns]
            bound = floats(whole * problem.scales.force / self._lengths[:, None])
        load = loop.force if isinstance(loop.force, np.ndarray) else None
        return Stand(
            interface=self.interface,
            interfaces=tuple(problem.rubbing),
            positions=floats(law.positions[self._rows]),
            instants=floats(problem.instants[self._columns]),
            cuts=floats(law.positions[np.bincount(law.points) > 1]),
            bound=bound,
            coefficient=coefficient,
            loop=Axes(loop.across, loop.up),
            load=None if load is None else floats(load[self._curve]),
            all_instants=floats(problem.instants[self._curve]),
            portrait=self._geometry.portrait,
            words=words_of(self._settings),
            mesh=self._mesh.mesh if self._mesh else None,
            wires=self._wires.base if self._wires else None,
            strand=self._strand.base if self._strand else None,
            is_idle=nothing_acts(problem),
        )

    def completed(self, stand: Stand, found: Reference | None) -> Stand:
        """Add what is known of it without a mesh, for the forces of a reference."""
        curves = exact_of(self._settings, self._problem, found)
        return replace(stand, exact=tuple(map(self._drawn, curves)))

    def _drawn(self, exact: ExactCurve) -> ExactCurve:
        if exact.up.ndim == 1:
            return replace(exact, across=exact.across[self._curve], up=exact.up[self._curve])
        rows = thinned(len(exact.across))
        return replace(exact, across=exact.across[rows], up=exact.up[np.ix_(rows, self._columns)])

    def reference(self, found: Reference) -> DrawnFields:
        """Show a reference."""
        fields = found.contact(self.interface)
        return self._shown(found, fields.tangential_force, fields.normal_force, fields.status)

    def frame(
        self, iterate: Iterate, look: Look, before: Iterate | None = None, *, is_slow: bool = False
    ) -> Frame:
        """Show an iterate; the one `before` tells what became of its modes, and of its status."""
        *normal, tangential = self._problem.contact_places[self.interface]
        force, status = iterate.contact_force, iterate.status[self._points]
        pressure = force[normal[0]] if normal else None
        shown = self._shown(iterate, force[tangential], pressure, status)
        return Frame(shown, iterate, before, look, self, is_slow)

    def changes(self, iterate: Iterate, before: Iterate) -> Changes:
        """Count what has changed its status, by kinds, and give where, as fields are shown."""
        found = status_changes(iterate, before, self.interface)
        return found.counts, self._thin(found.all)

    def mesh_field(self, iterate: Iterate, look: Look) -> MeshField | None:
        """Show the inside of plane bodies at the chosen instant."""
        if self._mesh is None:
            return None
        column = self._column(look)
        whole = iterate.displacement
        displacement, stress = self._mesh.fields(whole, column, look.stress)
        largest = max(float(whole.max()), -float(whole.min()))
        return MeshField(floats(displacement), floats(stress), largest)

    def cycles(self, iterate: Iterate) -> Cycled:
        """Show an iterate cycle by cycle, and where it slips along the interface."""
        return cycled(self._settings, iterate, self._points, self._rows, self._lengths)

    def clipped(self, iterate: Iterate) -> Clipped:
        """Keep the friction of an iterate in few numbers."""
        return clipped(self._settings, iterate)

    @cached_property
    def _space(self) -> SlipSpace | None:
        return space_of(self._problem)

    def slips(self, iterate: Iterate) -> SlipPlane | None:
        """Show an iterate in the plane of two slips, where there are no more."""
        if self._space is None:
            return None
        return slip_plane(self._settings, iterate, self._space, self._columns)

    def pose(self, iterate: Iterate, look: Look, bodies: MeshField | None) -> Pose:
        """Show what has moved at the chosen instant."""
        return self._geometry.pose(iterate, self._column(look), bodies)

    def strand(self, iterate: Iterate, look: Look) -> StrandField | None:
        """Show the wires of a strand that is bent at the chosen instant, and where it is cut."""
        if self._strand is None:
            return None
        return self._strand.at(iterate, self._column(look), look.place or 0.0, self.interface)

    def axial(self, iterate: Iterate, look: Look) -> Floats | None:
        """Give the forces in the wires of a strand at the chosen instant."""
        column = self._column(look)
        return self._wires.forces(iterate, column) if self._wires else None

    def _column(self, look: Look) -> int:
        return int(self._columns[instant_of(look.phase, len(self._columns))])

    def _shown(
        self,
        fields: LoopFields,
        friction: NDArray[np.float64],
        pressure: NDArray[np.float64] | None,
        status: NDArray[np.int8],
    ) -> DrawnFields:
        force = self.loop.force
        return DrawnFields(
            interface=self.interface,
            friction=self._density(friction),
            pressure=None if pressure is None else self._density(pressure),
            status=np.ascontiguousarray(self._thin(status)),
            end_displacement=floats(self.loop.displacement(fields.displacement)[self._curve]),
            load=None if isinstance(force, np.ndarray) else floats(force(fields)[self._curve]),
        )

    def _thin(self, field: NDArray[Any]) -> NDArray[Any]:
        return field[np.ix_(self._rows, self._columns)]

    def _density(self, force: NDArray[np.float64]) -> Floats:
        return floats(self._thin(force) / self._lengths[:, None])


@dataclass(frozen=True, eq=False)
class Frame:
    """One iterate as views see it; what only some of them show is computed when one looks."""

    fields: DrawnFields
    iterate: Iterate
    before: Iterate | None
    look: Look
    sampler: Sampler
    is_slow: bool = False

    @cached_property
    def changes(self) -> Changes | None:
        """What has changed its status since the iterate before, where one has the time to see."""
        if not self.is_slow or self.before is None:
            return None
        return self.sampler.changes(self.iterate, self.before)

    @property
    def iteration(self) -> int:
        """Number of the iterate."""
        return self.iterate.number

    @cached_property
    def cycles(self) -> Cycled:
        """The cycles of its load."""
        return self.sampler.cycles(self.iterate)

    @cached_property
    def clipped(self) -> Clipped:
        """How few numbers its friction takes."""
        return self.sampler.clipped(self.iterate)

    @cached_property
    def slips(self) -> SlipPlane | None:
        """The plane of its slips, where two points rub."""
        return self.sampler.slips(self.iterate)

    @cached_property
    def spectra(self) -> Floats:
        """Singular values, as `spectra_of` gives them."""
        return spectra_of(self.iterate)

    @cached_property
    def bases(self) -> Bases | None:
        """The separated bases, if there are any."""
        before = self.before.checkpoint if self.before else None
        return bases_of(self.iterate, before, self.look.substructure)

    @cached_property
    def mesh(self) -> MeshField | None:
        """The inside of plane bodies."""
        return self.sampler.mesh_field(self.iterate, self.look)

    @cached_property
    def pose(self) -> Pose:
        """What has moved at the chosen instant."""
        return self.sampler.pose(self.iterate, self.look, self.mesh)

    @cached_property
    def strand(self) -> StrandField | None:
        """The wires of a strand that is bent."""
        return self.sampler.strand(self.iterate, self.look)

    @cached_property
    def axial(self) -> Floats | None:
        """Forces in the wires of a strand, shape (n_wires, n_positions), N."""
        return self.sampler.axial(self.iterate, self.look)
