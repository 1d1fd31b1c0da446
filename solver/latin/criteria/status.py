"""How a run ends: in a word, and what to try next in a sentence."""

from __future__ import annotations

from dataclasses import dataclass
from enum import StrEnum


class Ending(StrEnum):
    """How a run can end."""

    CONVERGED = "converged"
    EXHAUSTED = "exhausted"
    STALLED = "stalled"
    CANCELLED = "cancelled"
    DIVERGED = "diverged"


@dataclass(frozen=True)
class Status:
    """The end of a run, in a word, and what to try next in a sentence."""

    ending: Ending
    advice: str


CANCELLED = Status(Ending.CANCELLED, "The run was stopped before its end; start it again.")
