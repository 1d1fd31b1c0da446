"""What the server and a worker process say to each other; all of it is plain, picklable data.

A run has a ticket. Orders about another ticket than the one at work are ignored, and so are
reports about a ticket that is no longer wanted: nothing depends on who is first.

    server -> worker   Run, Pace, Step, Seek, Watch, Park, Leave
    worker -> server   Ready, then per run: Taken, Begun, Frame, Begun, Reference | Unrivalled,
                       Progress*, Frame*, then End | Parked | Refused; Waiting whenever there is
                       nothing to do
    pool -> session    Begun, Reference, Unrivalled, Progress, Frame, End, Refused, Died; the rest
                       is internal

Only the second Begun has the closed form, which must not hold up the first picture. Begun,
Reference and Frame speak of one interface with friction, the one that is looked at; when another
is chosen all three are sent again. Its forces are per length, N/m, where the bound is known, and
tractions, Pa, where it depends on the pressure.
Every record of a run is in exactly one Progress, and so is every record of the full stage that is
iterated beside a run on separated bases; frames are only the newest. A run that was parked and
went on sends a complete Begun, Reference and a Frame again, and no record or End twice. Died alone
breaks this: what was sent of iterates under its ticket before is to be forgotten.

With the full linear stage, frames have no `bases`, and Progress neither `sizes` nor `beside`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from app.worker.resume import Resume
from solver.latin import Record, Status
from solver.latin.warm import StartChoice
from solver.reduction.basis import ReductionRecord

Floats = NDArray[np.float32]
Bytes = NDArray[np.int8]
Counts = NDArray[np.int16]

LARGEST_SIDE = 400
"""Points and instants of a field that are sent at most; a screen shows no more."""

LONGEST_CURVE = 2000
"""Instants of a curve that are sent at most."""

MOST_SPECTRA = 60
"""Substructures whose spectra are sent at most, chosen by `thinned`."""

MOST_VALUES = 64
"""Singular values of a substructure that are sent at most."""

MOST_SIZES = 60
"""Substructures whose numbers of modes are sent at most, chosen by `thinned`."""

MOST_MODES = 5
"""Modes of the chosen substructure that are sent at most, the largest."""


STRESSES = ("von Mises", "xx", "yy", "xy")
"""Components of stress that a frame may carry."""

STATUS_OPEN = 2
"""Status of a point without contact; -1 is slip backward, 0 stick, +1 slip forward."""


@dataclass(frozen=True)
class Look:
    """Where one looks.

    Attributes
    ----------
    interface
        Name of an interface with friction; the first one if there is none of this name.
    phase
        The chosen instant, as a share of the interval.
    stress
        One of `STRESSES`.
    """

    interface: str = ""
    phase: float = 0.75
    stress: str = STRESSES[0]


@dataclass(frozen=True)
class Run:
    """Start a run in place of whatever is at work.

    Attributes
    ----------
    scene, values
        The catalogue's name and the settings' plain values.
    pace
        Iterations per second, None for as fast as possible, or 0 to wait. The first iteration is
        done in any case.
    pause_after
        Iterations after which the run waits for Pace or Step; None never waits.
    resume
        Where to go on; records before it are not sent again.
    watch
        Names of what frames carry beyond the fields: "spectra", "behaviour", "modes", "mesh",
        "axial".
    seek
        Iteration whose frame is sought first.
    substructure, look
        As in Watch.
    warm
        Whether the run may start from the last iterate of the seat's run before, where that is
        better.
    after, previous
        How that one is found, for the pool to fill in: the ticket of a run that this process has
        at work, or the order that would have gone on with it.
    """

    ticket: int
    scene: str
    values: dict[str, Any]
    pace: float | None = None
    pause_after: int | None = None
    resume: Resume | None = None
    watch: frozenset[str] = frozenset()
    seek: int | None = None
    substructure: int | None = None
    look: Look = Look()
    warm: bool = False
    after: int | None = None
    previous: Run | None = None

    @property
    def waits(self) -> bool:
        """Whether it has nothing to do until another order comes."""
        if self.resume is None or self.seek is not None:
            return False
        paused = self.pause_after is not None and self.resume.iteration >= self.pause_after
        return self.resume.status is not None or self.pace == 0 or paused


@dataclass(frozen=True)
class Pace:
    """Go on at this many iterations per second, None for as fast as possible, or 0 to wait.

    A `pause_after` has no effect any more, whether reached or not.
    """

    ticket: int
    pace: float | None


@dataclass(frozen=True)
class Step:
    """Do one iteration and wait."""

    ticket: int


@dataclass(frozen=True)
class Seek:
    """Send the frame of an iteration that was done already; the run itself is not moved.

    A number out of range counts as the nearest one; a newer Seek takes the place of an older.
    """

    ticket: int
    iteration: int


@dataclass(frozen=True)
class Watch:
    """Change what frames carry, and send one at once.

    Attributes
    ----------
    substructure
        The one whose modes are carried, counted from 0; None is the last one, and so is a number
        that is too large.
    look
        Where one looks; the chosen instant and stress matter for "mesh" and "axial" alone.
    """

    ticket: int
    watch: frozenset[str]
    substructure: int | None = None
    look: Look = Look()


@dataclass(frozen=True)
class Park:
    """Give up the run, and unless `keep` is false, say how to go on: someone needs the process."""

    ticket: int
    keep: bool = True


@dataclass(frozen=True)
class Leave:
    """End the process."""


Order = Run | Pace | Step | Seek | Watch | Park | Leave


@dataclass(frozen=True)
class Ready:
    """The process listens."""


@dataclass(frozen=True)
class Taken:
    """A Run was read and is being set up; the run before it is gone."""

    ticket: int


@dataclass(frozen=True)
class Waiting:
    """The run has nothing to do until an order comes: it has ended, or is paused."""

    ticket: int


@dataclass(frozen=True)
class Axes:
    """Title and unit across and up."""

    across: tuple[str, str]
    up: tuple[str, str]


@dataclass(frozen=True)
class Mesh:
    """Quadrilaterals, as many as a screen shows: corners (n_nodes, 2), m; nodes (n_quads, 4)."""

    nodes: Floats
    quads: NDArray[np.int32]


@dataclass(frozen=True)
class Wires:
    """Wires that a frame may show the axial force of.

    Attributes
    ----------
    numbers
        Of the wires, from 1.
    positions
        Where the force is given along each of them, shape (n_positions,), m.
    broken
        Number of the broken one, or 0.
    exact_positions, exact
        Force of the broken wire and of its neighbours in closed form, shape (2, n_nodes,
        n_instants), N, and its places, m; None where there is none, or not yet.
    """

    numbers: tuple[int, ...]
    positions: Floats
    broken: int
    exact_positions: Floats | None = None
    exact: Floats | None = None


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
class ShownModes:
    """The largest displacement modes of one substructure's separated basis, without body forces.

    Attributes
    ----------
    positions
        Shape (n_points,), m.
    space_modes
        Shape (n_modes, n_points); the largest entry of each is 1 in size, and the last lobe that
        is at least half as large is positive.
    time_functions
        Shape (n_modes, n_instants), m, at the instants of Begun; mode times function is the field.
    born
        Shape (n_modes,): whether more than half of the mode, in its energy, lies outside the modes
        of the iteration before.
    record
        What the iteration did to the basis.
    lost
        Modes that downsizing dropped.
    """

    positions: Floats
    space_modes: Floats
    time_functions: Floats
    born: NDArray[np.bool_]
    record: ReductionRecord
    lost: int


@dataclass(frozen=True)
class OwnValues:
    """How large the modes of one substructure are, beside the field that they have to hold.

    Attributes
    ----------
    basis
        Norms of the time functions, shape (n_modes,), relative to the largest entry of both.
    wanted
        Singular values, at most `MOST_VALUES`, of what the local stage asks for, W^ + F^/k, in the
        same inner product.
    """

    basis: Floats
    wanted: Floats


@dataclass(frozen=True)
class Bases:
    """The separated bases of one iterate.

    Attributes
    ----------
    substructure
        The chosen one, counted from 0.
    largest, stored
        Modes of the largest basis, and of all together, a shared one counted once.
    modes, values
        Of the chosen substructure, if "modes", or "spectra", is watched.
    """

    substructure: int
    largest: int
    stored: int
    modes: ShownModes | None
    values: OwnValues | None


@dataclass(frozen=True)
class MeshField:
    """Displacement and stress on a `Mesh` at one instant.

    Attributes
    ----------
    instant
        Index of the instant among those of Begun.
    component
        One of `STRESSES`.
    displacement
        Shape (n_nodes, 2), m.
    stress
        Shape (n_quads,), Pa; a quadrilateral that stands for several elements has their mean.
    largest
        Largest displacement over the whole time, m.
    """

    instant: int
    component: str
    displacement: Floats
    stress: Floats
    largest: float


@dataclass(frozen=True)
class AxialForces:
    """Axial forces at one instant, an index as in `MeshField`: (n_wires, n_positions), N."""

    instant: int
    force: Floats


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
    behaviour
        Map of the k-free indicator, shape as friction; or None.
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
    behaviour: Floats | None
    bases: Bases | None
    mesh: MeshField | None = None
    axial: AxialForces | None = None


@dataclass(frozen=True)
class End:
    """The run has ended; it still answers Seek and Watch until it is parked or replaced."""

    ticket: int
    status: Status
    iteration: int


@dataclass(frozen=True)
class Parked:
    """The run was given up on request.

    Attributes
    ----------
    order
        The order that goes on with it; None if that was not asked for, or nothing is known of it.
    """

    ticket: int
    order: Run | None


@dataclass(frozen=True)
class Refused:
    """The run could not start, or broke: a sentence for the user."""

    ticket: int
    reason: str


@dataclass(frozen=True)
class Died:
    """The process of this run is gone: its Progress, Frame and End are to be forgotten.

    Begun and Reference still hold. The pool says it in the process's stead.

    Attributes
    ----------
    again
        Whether the run was started again from its beginning, under the same ticket; otherwise
        it is given up.
    """

    ticket: int
    reason: str
    again: bool


Report = (
    Taken
    | Waiting
    | Begun
    | Reference
    | Unrivalled
    | Progress
    | Frame
    | End
    | Parked
    | Refused
    | Died
)


def instant_of(phase: float, count: int) -> int:
    """Give the instant, among this many, at a share of the interval."""
    return min(max(round(phase * (count - 1)), 0), count - 1)


def thinned(size: int, largest: int = LARGEST_SIDE) -> NDArray[np.intp]:
    """Give the indices that stand for a long axis, first and last included."""
    return np.unique(np.linspace(0, size - 1, min(size, largest)).round().astype(np.intp))
