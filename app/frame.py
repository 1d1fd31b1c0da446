"""Data of a run on the page: `Run` is common to iterates, a `Frame` is one iterate.

All arrays are in SI, float32, space first and time last, thinned to what a screen
shows.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, is_dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from solver.arrays import Array
from solver.discrete.structure import Description
from solver.latin import Status
from solver.reference.closed_forms import ExactCurve
from solver.settings.scene import Settings

Floats = NDArray[np.float32]
Bytes = NDArray[np.int8]
LOCAL = "local"
LINEAR = "linear"
"""Stages of an iteration: laws of interfaces, then elasticity and balance."""


@dataclass(frozen=True, eq=False)
class FrictionInterface:
    """Data of an interface that are common to all iterates."""

    positions: Floats
    """Positions of its points along the bodies, shape (n_points,), m."""
    cuts: Floats
    """Positions at which substructures meet, shape (n_cuts,), m."""
    strength: Floats | None
    """Friction strength mu p, N/m or Pa, shape (n_points, n_instants), or (n_points, 1)
    where it does not change; None where it depends on the pressure."""
    coefficient: Floats | None
    """Coefficient of friction, shape (n_points, 1), where the strength depends on the
    pressure."""
    is_spring: bool = False
    """Whether it is a spring that pulls at a point, and no surface on which bodies
    touch."""


@dataclass(frozen=True, eq=False)
class InterfaceFields:
    """Contact at one interface."""

    friction: Floats
    """Friction force on the body above, shape (n_points, n_instants), N/m along rods,
    Pa in the plane."""
    pressure: Floats | None
    """Pressure, same shape, Pa; None where it is given."""
    status: Bytes
    """Status of the points: -1, 0, +1 or `OPEN`, same shape."""
    slip: Floats | None = None
    """Tangential displacement over the body below, same shape, m; None where nobody
    takes it away."""
    bound: Floats | None = None
    """Largest friction, same shape and unit as friction; None where the pressure, or
    the interface, tells it."""


@dataclass(frozen=True, eq=False)
class Geometry:
    """The undeformed bodies for drawing."""

    description: Description
    """Bodies, what holds them and what acts on them."""
    nodes: Floats
    """Corners of the cells, shape (n_nodes, 2), m, from the lower left corner of all
    bodies on; rods and bands are drawn with a thickness."""
    cells: NDArray[np.int32]
    """Nodes round each cell that is drawn, shape (n_cells, n_corners); the last is
    repeated where a cell has fewer corners."""
    parts: NDArray[np.intp]
    """Substructure of each cell, or its wire in a rope, shape (n_cells,)."""
    points: Floats
    """Contact points, shape (n_points, 2), m; NaN where a line of them is broken."""
    chains: NDArray[np.intp]
    """Index of the interface of each contact point, shape (n_points,)."""
    outlines: NDArray[np.intp]
    """Nodes of closed lines round substructures, -1 behind each line."""
    rims: NDArray[np.intp]
    """Nodes of the sides of bodies that nothing touches, -1 behind each line."""


@dataclass(frozen=True, eq=False)
class DeformedGeometry:
    """Displacements of the drawn bodies at all instants."""

    nodes: Floats
    """Displacement of the nodes, shape (n_nodes, 2, n_instants), m."""
    points: Floats
    """Displacement of the contact points, shape (n_points, 2, n_instants), m."""
    status: Bytes
    """Status of the contact points, shape (n_points, n_instants)."""

    @cached_property
    def largest(self) -> Floats:
        """Largest displacement of the nodes along x and y, shape (2,), m."""
        return np.nanmax(np.abs(self.nodes), axis=(0, 2), initial=0.0)


@dataclass(frozen=True, eq=False)
class Run:
    """Data that are common to all frames of a run."""

    number: int
    """Number of the run, from 1: no other run of the server has it."""
    settings: Settings
    sentence: str
    """Sentence on the scene and its loads."""
    instants: Array
    """Instants that are shown, shape (n_instants,), s; float64, as some lie close."""
    interfaces: Mapping[str, FrictionInterface]
    """All interfaces with friction, by name."""
    geometry: Geometry
    n_substructures: int
    across: tuple[str, str]
    up: tuple[str, str]
    """Title and SI unit of the loop's displacement and force."""
    exact: tuple[ExactCurve, ...] = ()
    """Closed forms of the scene, at the same instants."""
    reference: Mapping[str, InterfaceFields] = field(default_factory=dict)
    """Contact of the incremental solver, by interface; empty without a reference."""
    reference_loop: Floats | None = None
    """Displacement and force of the reference's loop, shape (2, n_instants), SI."""
    reference_moved: Floats | None = None
    """Largest displacement of the drawn nodes in the reference, along x and y, shape
    (2,), m."""
    reference_seconds: float = float("nan")
    """Run time of the incremental solver from settings to result, s."""
    mechanism: Floats | None = None
    """Displacement of the nodes as the structure begins to collapse, (n_nodes, 2), m,
    the size of a body at most; None where it does not."""
    collapses_at: float = float("nan")
    """Instant of the collapse, s; NaN without one."""
    is_compared: bool = False
    """Whether the search for a reference and closed forms is over."""
    is_idle: bool = False
    """Whether nothing acts, so that nothing moves."""

    @property
    def structure(self) -> tuple[object, ...]:
        """Key of scene, size and supports: runs with equal keys can be compared."""
        drawn = self.geometry.description
        held = {(hold.kind, hold.side) for hold in drawn.holds}
        # An end that is moved is held, too.
        for act in drawn.acts:
            if act.unit == "m" and act.side in ("left", "right"):
                held.add(("clamp", act.side))
        size = drawn.bodies, drawn.length, drawn.height, drawn.broken
        return self.settings.scene, *size, held

    @property
    def surfaces(self) -> list[str]:
        """Names of the interfaces between bodies, without springs."""
        return [name for name, each in self.interfaces.items() if not each.is_spring]

    def x_title(self, name: str) -> str:
        """Title of positions along an interface, with its name among several."""
        if len(self.surfaces) > 1:
            return f"{name}: x"
        return "x"

    def interface(self, name: str) -> str:
        """The interface of a name.

        The default is the first interface, and of wires the last, which slips most.
        """
        if name in self.interfaces:
            return name
        return list(self.interfaces)[-1 if self.settings.kind == "helices" else 0]

    def known(self, quantity: str) -> list[ExactCurve]:
        """Closed forms of one quantity."""
        return [curve for curve in self.exact if curve.of == quantity]

    def column(self, phase: float) -> int:
        """Index of the instant at a share of the interval."""
        time = phase * float(self.instants[-1])
        return int(np.argmin(np.abs(self.instants - time)))


class Extremes(NamedTuple):
    """A number of the loop over all instants of a run, also those not shown, SI."""

    largest: float
    """Value that is largest in size."""
    largest_at: float
    """First instant at which it is, s."""
    last: float
    """Value at the end."""


@dataclass(frozen=True, eq=False)
class Frame:
    """An iterate of a run, for views."""

    run: Run
    iteration: int
    """Number of the iterate, from 1."""
    is_answer: bool
    """Whether it is the certified solution, which is no iteration of the search."""
    contact: Mapping[str, InterfaceFields]
    """Contact fields by interface: the selected one, and all others where they are
    small."""
    deformed: DeformedGeometry
    """Displacements of the drawn bodies."""
    loop: Floats
    """Displacement and force of the loop, shape (2, n_instants), SI."""
    extremes: tuple[Extremes, Extremes]
    """Largest and last displacement and force of the loop in the whole run."""
    slips: Floats
    """Share of all points of surfaces that slip, shape (n_instants,)."""
    energy: Floats
    """Energy dissipated from the beginning up to each instant, J, shape
    (n_instants,)."""
    history: Mapping[str, Floats]
    """Scalars of every iteration so far, by the names of `solver.latin.Record`; each of
    shape (n_iterations,)."""
    status: Status | None = None
    """Status with which the run ended; None while it continues."""
    residual: float | None = None
    """KKT residual of a certified solution; None for all other iterates."""
    is_followed: bool = False
    """Whether the states of the run before led to the answer, without an iteration."""
    remarks: tuple[str, ...] = ()
    """Remarks on the answer, in plain sentences."""
    extras: Mapping[str, Any] = field(default_factory=dict)
    """Extras that views in sight need, by name."""
    readings: Mapping[str, float] = field(default_factory=dict)
    """Quantities of the run that a lesson or a case names, by name."""

    @cached_property
    def nbytes(self) -> int:
        """Memory of what differs from frame to frame, bytes."""
        return _size([self.deformed, self.contact, self.loop, self.extras])

    @property
    def stage(self) -> tuple[int, bool, bool]:
        """Key of the run's stage: number, is compared with a reference, is over.

        Axes are chosen again when it changes.
        """
        return self.run.number, bool(self.run.reference), self.status is not None

    @property
    def place(self) -> int:
        """Place in its run, from 1: the answer follows the last iterate."""
        return self.iteration + self.is_answer

    def last(self, name: str) -> float:
        """The newest value of a scalar of the history."""
        return float(self.history[name][-1])

    @property
    def error(self) -> float:
        """Relative error of the contact force; estimated without a reference."""
        measured = self.last("error_force")
        if np.isfinite(measured):
            return measured
        return self.last("estimated_error")


def _size(part: Any) -> int:
    """Memory of all arrays in a part of a frame, bytes."""
    if isinstance(part, Mapping):
        return sum(map(_size, part.values()))
    if isinstance(part, list | tuple):
        return sum(map(_size, part))
    if is_dataclass(part):
        return _size(vars(part))
    return int(getattr(part, "nbytes", 0))


@dataclass(frozen=True)
class Selection:
    """The selected instant, interface, substructure and position."""

    phase: float = 0.75
    """The instant, as a share of the interval."""
    interface: str = ""
    """Name of the selected interface (`Run.interface`)."""
    substructure: int | None = None
    """Index of the selected substructure, from 0; None is the last."""
    position: float | None = None
    """Position along the bodies that is marked, m."""
    stage: str = LINEAR
    """Stage up to which the iteration is shown, `LOCAL` or `LINEAR`; after the linear
    stage it is whole."""

    @property
    def marked(self) -> Floats:
        """The marked position, (1,), m; (0,) without one."""
        if self.position is None:
            return np.zeros(0, dtype=np.float32)
        return np.array([self.position], dtype=np.float32)
