"""Reports, from a worker process to the server."""

from __future__ import annotations

from dataclasses import dataclass

from app.worker.shown import (
    Axes,
    AxialForces,
    Bases,
    Bytes,
    Counts,
    Floats,
    Mesh,
    MeshField,
    Wires,
)
from solver.latin import Record, Status
from solver.latin.warm import StartChoice


@dataclass(frozen=True)
class Taken:
    """A Run was read and is being set up; the run before it is gone."""

    ticket: int


@dataclass(frozen=True)
class Waiting:
    """The run has nothing to do until an order comes: it has ended, or is paused."""

    ticket: int


@dataclass(frozen=True)
class Begun:
    """A run has started: what its fields stand on, thinned to `LARGEST_SIDE`, in SI.

    Attributes
    ----------
    interface, interfaces
        The one that is looked at, and all with friction.
    positions, instants
        Of the field's points and columns, m and s.
    cuts
        Positions where substructures meet, m.
    bound
        Friction bound mu p at the positions, N/m; None where it depends on the pressure.
    coefficient
        Coefficient of friction at the positions there; else None.
    loop
        What `load` and `end_displacement` are.
    load
        Force at the loaded end, shape (n_curve,), N; None where frames tell it.
    all_instants
        The instants of `load` and of end displacements, thinned to `LONGEST_CURVE`, s.
    closed_form, closed_form_end
        Friction force, N/m, and end displacement, m, of the closed form; None where there is
        none, or as long as it is not computed.
    start
        Which start was chosen, where there was a choice.
    mesh
        Of plane bodies.
    wires
        Of a strand.
    is_idle
        Whether nothing acts on the structure, so that nothing moves.
    """

    ticket: int
    interface: str
    interfaces: tuple[str, ...]
    positions: Floats
    instants: Floats
    cuts: Floats
    bound: Floats | None
    coefficient: Floats | None
    loop: Axes
    load: Floats | None
    all_instants: Floats
    closed_form: Floats | None
    closed_form_end: Floats | None
    start: StartChoice | None = None
    mesh: Mesh | None = None
    wires: Wires | None = None
    is_idle: bool = False


@dataclass(frozen=True)
class Reference:
    """The reference; its fields are as in Frame."""

    ticket: int
    interface: str
    friction: Floats
    pressure: Floats | None
    status: Bytes
    end_displacement: Floats
    load: Floats | None
    residual: float
    seconds: float


@dataclass(frozen=True)
class Unrivalled:
    """There is no reference to compare with: errors are NaN."""

    ticket: int


@dataclass(frozen=True)
class Progress:
    """Records of iterations, in order, none left out, without their `reduction`.

    Attributes
    ----------
    sizes
        Modes of the substructures `thinned(number, MOST_SIZES)`, shape (n_records, n_shown).
    beside
        Records of the same run with the full linear stage, as far as it has not ended.
    """

    ticket: int
    records: tuple[Record, ...]
    sizes: Counts | None = None
    beside: tuple[Record, ...] = ()


@dataclass(frozen=True)
class Frame:
    """The fields of one iterate, thinned, in SI.

    Attributes
    ----------
    sought
        Whether it answers a Seek, and is not the newest.
    interface
        The one whose fields these are.
    friction
        Friction force on the body above, shape (n_positions, n_instants), N/m, or Pa.
    pressure
        Same shape, Pa; None where the bound is known.
    status
        -1, 0, +1, or `STATUS_OPEN`, same shape.
    end_displacement
        Displacement of the loaded end or side, m, or its rotation, shape (n_curve,).
    load
        Force that it takes, N, same shape; None where Begun tells it.
    spectra
        Singular values, shape (n_substructures, n_values), NaN where there is none, of the
        substructures `thinned(number, MOST_SPECTRA)`; or None.
    bases
        The separated bases, if there are any.
    mesh, axial
        What was chosen of them, where it is watched and there is any.
    """

    ticket: int
    iteration: int
    sought: bool
    interface: str
    friction: Floats
    pressure: Floats | None
    status: Bytes
    end_displacement: Floats
    load: Floats | None
    spectra: Floats | None
    bases: Bases | None
    mesh: MeshField | None = None
    axial: AxialForces | None = None


@dataclass(frozen=True)
class End:
    """The run has ended; it still answers Seek and Watch until it is replaced."""

    ticket: int
    status: Status
    iteration: int


@dataclass(frozen=True)
class Refused:
    """The run could not start, or broke: a sentence for the user.

    Attributes
    ----------
    trace
        Where it broke, for the server's log; empty for settings that were refused.
    """

    ticket: int
    reason: str
    trace: str = ""


@dataclass(frozen=True)
class Died:
    """The process is gone, and all that it had; the link says it in its stead."""


Report = Taken | Waiting | Begun | Reference | Unrivalled | Progress | Frame | End | Refused | Died
