"""What is handed on when a run changes its process."""

from __future__ import annotations

from dataclasses import dataclass

from solver.latin import Checkpoint, Status, StopRules
from solver.reference.incremental import Reference


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
        As computed already.
    status
        How the run ended, or None.
    due
        When the next iteration is due, on the machine's monotonic clock, s; so a slow pace is
        kept across short turns.
    """

    before: Checkpoint | None
    iteration: int
    rules: StopRules
    reference: Reference
    status: Status | None
    due: float
