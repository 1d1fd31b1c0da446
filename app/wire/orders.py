"""Orders, from the server to a worker process."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

from app.picture.shown import Look
from solver.settings import Settings
from solver.study.other_programs.brought import Brought

WHOLE: Literal["whole"] = "whole"
"""The pace at which a search lasts three seconds, however many iterations it takes."""
Rate = float | Literal["whole"] | None
"""Iterations per second, `WHOLE`, None for as fast as possible, or 0 to wait."""


@dataclass(frozen=True)
class Run:
    """Start a run in place of whatever is at work.

    Attributes
    ----------
    settings
        Checked where they came from.
    label, notice
        What is new in it, for the legend of runs, and what the status line has to say of it.
    pace, is_held
        As in Pace.
    pause_after
        Iterations after which the run waits for Pace or Step; None never waits.
    warm
        Whether the run may start from the last iterate of the run before, where that is better.
    follows_hand
        Whether a slider moves: then the run hurries to its end before it is shown, and nothing is
        compared with it afterwards.
    is_agreed
        Whether it begins however long or large it is.
    is_alone
        Whether it is nothing to compare with those before.
    twin
        Settings of a run A, which goes in step with this one, B; None has none.
    """

    ticket: int
    settings: Settings
    label: str = ""
    notice: str = ""
    pace: Rate = None
    pause_after: int | None = None
    is_held: bool = False
    warm: bool = False
    follows_hand: bool = False
    is_agreed: bool = False
    is_alone: bool = False
    twin: Settings | None = None


@dataclass(frozen=True)
class Pace:
    """Go on at this pace.

    A `pause_after` has no effect any more, whether reached or not.

    Attributes
    ----------
    is_held
        Whether it waits for a study that is timed, and not for its user.
    """

    ticket: int
    pace: Rate
    is_held: bool = False


@dataclass(frozen=True)
class Step:
    """Do one iteration, or several, without any pace, and wait."""

    ticket: int
    count: int = 1


@dataclass(frozen=True)
class Seek:
    """Show an iteration that was done already, or follow the run; the run itself is not moved.

    Attributes
    ----------
    iteration
        A number out of range counts as the nearest one; None follows.
    """

    ticket: int
    iteration: int | None


@dataclass(frozen=True)
class Watch:
    """Look elsewhere, whatever is at work."""

    look: Look


@dataclass(frozen=True)
class Tabulate:
    """Have the browser save numbers of what is looked at.

    Attributes
    ----------
    what
        One of `app.worker.saving.KINDS`.
    number
        Tells it from those before.
    """

    what: str
    number: int


@dataclass(frozen=True)
class Bring:
    """Lay results of another program beside the runs of their scene, or take them away.

    Attributes
    ----------
    brought
        They travel this once; None takes those away that there were.
    """

    brought: Brought | None


@dataclass(frozen=True)
class Ready:
    """The page has painted what it has, and waits for the next picture.

    Attributes
    ----------
    afresh
        Whether all of it is to be sent, and not only what changed.
    rest
        Seconds that it wants to be left alone.
    whole
        Whether the next is to be sent whole, when there is something new: others follow it too.
    """

    afresh: bool = False
    rest: float = 0.0
    whole: bool = False


Order = Run | Pace | Step | Seek | Watch | Tabulate | Bring | Ready
