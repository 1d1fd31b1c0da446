"""Orders, from the server to a worker process."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from app.worker.shown import STRESSES


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
    watch
        Names of what frames carry beyond the fields: "spectra", "modes", "mesh", "axial".
    substructure, look
        As in Watch.
    warm
        Whether the run may start from the last iterate of the run before, where that is better.
    """

    ticket: int
    scene: str
    values: dict[str, Any]
    pace: float | None = None
    pause_after: int | None = None
    watch: frozenset[str] = frozenset()
    substructure: int | None = None
    look: Look = Look()
    warm: bool = False


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


Order = Run | Pace | Step | Seek | Watch
