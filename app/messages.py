"""Messages between the page and its worker process."""

from __future__ import annotations

from dataclasses import dataclass

from app.frame import Frame
from solver.refusal import RefusedError
from solver.settings.scene import Settings
from solver.study.comparison import OtherResults
from solver.study.measured_loop import MeasuredLoop

WHOLE = -1.0
"""Pace at which the whole search takes three seconds."""


@dataclass(frozen=True)
class Start:
    """Order to start a run at a pace, iterations per second: 0 waits, inf is free.

    A run that waits does its `steps` first, at least one. A run that follows a dragged
    slider hurries to its end before it is shown; a run that is agreed to may take long
    or much memory.
    """

    number: int
    settings: Settings
    pace: float
    steps: int = 0
    is_dragged: bool = False
    is_agreed: bool = False


@dataclass(frozen=True)
class Pace:
    """Order another pace."""

    pace: float


@dataclass(frozen=True)
class Step:
    """Order one iteration, then to wait."""


@dataclass(frozen=True)
class Show:
    """Order the frame of an earlier iteration, if its iterate is stored."""

    iteration: int


TABLE = "table"
"""Need of a frame with the contact of all interfaces, and with slip."""


@dataclass(frozen=True)
class Needs:
    """Order of extras and quantities for frames, and the selection."""

    extras: frozenset[str] = frozenset()
    interface: str = ""
    substructure: int | None = None
    position: float | None = None
    readings: tuple[str, ...] = ()
    brought: OtherResults | MeasuredLoop | None = None


@dataclass(frozen=True)
class Ready:
    """Order the newest frame, as the last picture is painted."""


Order = Start | Pace | Step | Show | Needs | Ready


@dataclass(frozen=True)
class Began:
    """Report that a run has begun."""

    number: int


@dataclass(frozen=True)
class NewFrame:
    """Report of the newest iterate of the run."""

    frame: Frame


@dataclass(frozen=True)
class Earlier:
    """Report of a requested earlier iterate of the run."""

    frame: Frame


@dataclass(frozen=True)
class Costly:
    """Report that a run was not begun, as it needs much time or memory."""

    number: int
    text: str


@dataclass(frozen=True)
class Failed:
    """Report that a run ended by an error: a sentence, or what the engine refuses."""

    number: int
    problem: str | RefusedError


@dataclass(frozen=True)
class Alive:
    """Report that the worker is alive."""


Report = Began | NewFrame | Earlier | Costly | Failed | Alive
