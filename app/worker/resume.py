"""What is handed on when a run changes its process."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields
from functools import partial
from typing import Any

from solver.discrete import Problem
from solver.latin import Checkpoint, Status, StopRules
from solver.latin.warm import Start
from solver.reference import incremental


@dataclass(frozen=True, eq=False)
class ResumeBeside:
    """How far the full linear stage beside a run on separated bases has come.

    Attributes
    ----------
    checkpoint
        From where it goes on; None before its first iteration.
    rules
        Its stop rules, with what they remember.
    ended
        Whether they have ended it.
    """

    checkpoint: Checkpoint | None
    rules: StopRules
    ended: bool


@dataclass(frozen=True, eq=False)
class Resume:
    """What a run needs to go on elsewhere, to the bit as if nothing had happened.

    Attributes
    ----------
    before
        From where to repeat the last iteration, so that its iterate is at hand again; None
        before the first.
    iteration
        Iterations done, all of whose records were sent.
    rules
        Stop rules, with what they remember.
    reference
        As computed already, given its problem, as `without_problem` keeps it; None where there is
        none.
    status
        How the run ended, or None.
    due
        When the next iteration is due, on the machine's monotonic clock, s; so a slow pace is
        kept across short turns.
    beside
        The full stage beside the run, if there is one.
    start
        Where the run started, if that was chosen.
    is_finished
        Whether a status step ended it, in the place of that iterate.
    """

    before: Checkpoint | None
    iteration: int
    rules: StopRules
    reference: Callable[[Problem], incremental.Reference] | None
    status: Status | None
    due: float
    beside: ResumeBeside | None = None
    start: Start | None = None
    is_finished: bool = False


def without_problem(found: incremental.Reference) -> Callable[[Problem], incremental.Reference]:
    """Keep a reference without its problem, which every process has, and cannot always be sent."""
    kept = {one.name: getattr(found, one.name) for one in fields(found) if one.name != "problem"}
    return partial(_with_problem, kept)


def _with_problem(kept: dict[str, Any], problem: Problem) -> incremental.Reference:
    return incremental.Reference(problem, **kept)
