"""What a class predicts of a lesson's question."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Poll:
    """The predictions of a class at one moment; nobody is named.

    Attributes
    ----------
    leads
        Whether this page leads the class.
    predicted, present
        How many have predicted, and how many follow.
    counts
        How many predicted each choice; empty until the leader opens it.
    is_answered
        Whether the leader has gone on to the answer.
    """

    leads: bool
    predicted: int
    present: int
    counts: tuple[int, ...] = ()
    is_answered: bool = False
