"""A lesson: a question, a prediction, a run with one or two controls, claims that runs test."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass

from solver.checked import dump
from solver.settings import Settings
from solver.study.quantities.finished import FinishedRun, finished_run
from solver.study.quantities.quantity import Quantity

SUBJECTS = "mechanics", "method"


@dataclass(frozen=True)
class Expected:
    """What a checkpoint is to measure.

    Attributes
    ----------
    low, high
        Both ends of what holds; both infinite for what never comes.
    words
        The same in words.
    """

    low: float
    high: float
    words: str

    def holds(self, value: float) -> bool:
        """Whether a measured value is as expected; NaN never is."""
        return self.low <= value <= self.high


@dataclass(frozen=True, eq=False)
class Claim:
    """A claim of a lesson, and how it is tested.

    Attributes
    ----------
    claim
        One sentence.
    settings
        Of the run that it is about.
    quantity
        Of that run.
    """

    claim: str
    settings: Settings
    quantity: Quantity
    expected: Expected

    def tested(self, run: FinishedRun, share: float) -> tuple[bool, str]:
        """Whether it holds in a run, and what was measured there, in words.

        A quantity of one instant has to be as expected where the plots stand, too: at a share of
        the interval.
        """
        quantity, value = self.quantity, self.quantity(run)
        holds, words = self.expected.holds(value), _written(value, quantity.unit)
        if quantity.at_instant is not None:
            seen = quantity.at_instant(run, round(share * (run.problem.n_instants - 1)))
            if not self.expected.holds(seen):
                holds = False
                words += f", but {_written(seen, quantity.unit)} at the instant of the plots"
        return holds, f"{quantity.title}: {words}; expected {self.expected.words}"


def _written(value: float, unit: str) -> str:
    return "never" if math.isinf(value) else f"{value:.4g} {unit}".strip()


@dataclass(frozen=True, eq=False)
class EndingClaim:
    """A claim of a lesson about how a run ends: words that its status has to say."""

    claim: str
    settings: Settings
    says: str

    def tested(self, run: FinishedRun, share: float) -> tuple[bool, str]:
        """Whether it holds in a run, and what that says, whatever share the plots stand at."""
        message = run.solution.status.advice
        return self.says in message, f"The run says: {message}; expected {self.says}"


@dataclass(frozen=True, eq=False)
class Lesson:
    """A lesson as its file says.

    Attributes
    ----------
    name
        That of its file, without the ending.
    order
        Its place among the lessons.
    subject
        What it is about: one of `SUBJECTS`.
    title, question
        What it is called, and what it asks.
    choices
        Answers to predict from, two or more.
    right
        Index of the right one.
    why
        Why it is right, shown after the choice.
    settings
        Of the run that it starts with.
    controls, views
        Names of the settings that can still be moved, one or two, and of the plots that stay.
    text
        Paragraphs to read before the choice.
    explanation
        Paragraphs that follow it.
    instant
        At which its plots stand, as a share of the interval.
    interface
        Name of that which its plots are of; empty is the first one.
    draw
        Name of the setting over which one may draw the answer as a curve; empty for none.
    beside
        Names of the plots that stand beside the question already; the others would answer it.
    until
        Where its picture, which moves, begins anew before the choice, as a share of the interval.
    """

    name: str
    order: int
    subject: str
    title: str
    question: str
    choices: tuple[str, ...]
    right: int
    why: str
    settings: Settings
    controls: tuple[str, ...]
    views: tuple[str, ...]
    text: tuple[str, ...]
    explanation: tuple[str, ...]
    checkpoints: tuple[Claim | EndingClaim, ...]
    instant: float
    interface: str = ""
    draw: str = ""
    beside: tuple[str, ...] = ()
    until: float = 1.0

    @property
    def curve(self) -> list[tuple[float, float]]:
        """What is measured over the setting that one draws over, in its order.

        Of the checkpoints that change nothing else and ask for the quantity of the first of them:
        the middle of what is expected, infinite for never.
        """
        curve: dict[float, float] = {}
        own, asked = self.settings.values(), ""
        for claim in self.checkpoints:
            if not isinstance(claim, Claim):
                continue
            values = claim.settings.values()
            same = all(values[name] == own[name] for name in own if name != self.draw)
            if self.draw in values and same and asked in ("", claim.quantity.name):
                asked = claim.quantity.name
                curve[values[self.draw]] = 0.5 * (claim.expected.low + claim.expected.high)
        return sorted(curve.items())

    @property
    def drawn_quantity(self) -> str:
        """What that curve shows, in words."""
        claims = (claim for claim in self.checkpoints if isinstance(claim, Claim))
        return next((claim.quantity.title for claim in claims), "")


def check(lesson: Lesson) -> Iterator[tuple[bool, str]]:
    """Whether what a lesson claims holds, each with a line; equal settings share a run."""
    wanted: defaultdict[str, set[str | None]] = defaultdict(set)
    for claim in lesson.checkpoints:
        reads = claim.quantity.reads if isinstance(claim, Claim) else None
        wanted[dump(claim.settings)].add(reads)
    runs: dict[str, FinishedRun] = {}
    for claim in lesson.checkpoints:
        key = dump(claim.settings)
        if key not in runs:
            kinds = wanted[key]
            runs[key] = finished_run(
                claim.settings, errors="errors" in kinds, indicators="indicators" in kinds
            )
        holds, words = claim.tested(runs[key], lesson.instant)
        yield holds, f"{'+' if holds else '-'} {claim.claim} {words}"
