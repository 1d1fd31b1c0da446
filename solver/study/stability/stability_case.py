"""A case: a run that is to be made, and what may come of it."""

from __future__ import annotations

import json
import shlex
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum

from solver.definitions import Pairs


class Verdict(StrEnum):
    """What a run is worth."""

    RIGHT = "right"
    UNSOLVED = "unsolved"
    REFUSED = "refused"
    UNCLEAR = "unclear"
    WRONG = "wrong"


RIGHT = "right answer"
UNSOLVED = "right answer, or said not to be"
MUST_REFUSE = "refused in words"
UNCLEAR = "right answer, or one that cannot be judged"
NOT_WRONG = "anything but a wrong answer"
PASSING = {
    RIGHT: {Verdict.RIGHT},
    UNSOLVED: {Verdict.RIGHT, Verdict.UNSOLVED},
    MUST_REFUSE: {Verdict.REFUSED},
    UNCLEAR: {Verdict.RIGHT, Verdict.UNSOLVED, Verdict.UNCLEAR},
    NOT_WRONG: set(Verdict) - {Verdict.WRONG},
}
"""Verdicts with which a run passes, by what is expected of it."""
PRECISE = {"accuracy": 1e-6, "tolerance": 1e-20, "max_iterations": 1500}
"""Tight, so that whoever is called converged has to be right; enough for most cases."""
RIGHT_UP_TO = 1e-6
"""Error of displacement and contact force up to which an answer is right."""
GENERAL = {"friction_law": "general"}
METHODS: dict[str, dict[str, object]] = {"fast": {}, "paper": {"method": "paper"}}


@dataclass(frozen=True)
class StabilityCase:
    """A run that is to be made, and what may come of it.

    Attributes
    ----------
    title
        What is extreme about it; or which one it is of random ones.
    values
        Settings that differ from the scene's own.
    expected
        A key of `PASSING`: `RIGHT`; `UNSOLVED` where the method is known to be slow or beyond its
        digits; `MUST_REFUSE` where there is no solution; `UNCLEAR` where friction is so large that
        there may be several.
    quick
        Whether it is one of the few for a short check.
    scene, method
        As tables name them.
    error_force, error_displacement
        Errors up to which the answer is right.
    """

    title: str
    values: Mapping[str, object] = field(default_factory=dict)
    expected: str = RIGHT
    quick: bool = False
    scene: str = "bar"
    method: str = "fast"
    error_force: float = RIGHT_UP_TO
    error_displacement: float = RIGHT_UP_TO

    def by(self, method: str) -> StabilityCase:
        """The same by one of `METHODS`, precisely."""
        return replace(self, method=method, values={**PRECISE, **METHODS[method], **self.values})

    @property
    def command(self) -> str:
        """The command that makes the run."""
        texts = {
            name: value if isinstance(value, str) else json.dumps(value)
            for name, value in self.values.items()
        }
        changes = (f"--set {shlex.quote(f'{name}={text}')}" for name, text in texts.items())
        return " ".join([f"python -m solver run {self.scene}", *changes])


def cases_with(
    scene: str, common: Mapping[str, object], usually: str = RIGHT
) -> Callable[..., StabilityCase]:
    """A function that makes cases of a scene, which have some settings in common.

    It takes what a case is called, what is expected of it, whether it is quick, and the settings
    that make it one: these are its title where it has no other.
    """

    def case(
        title: str = "", expected: str = usually, *, quick: bool = False, **values: object
    ) -> StabilityCase:
        title = title or ", ".join(f"{name}={value}" for name, value in values.items())
        return StabilityCase(title, {**common, **values}, expected, quick, scene)

    return case


def reversals(instants: int, peak: float) -> Pairs:
    """A load of full size that turns at every instant of a second, (s, N)."""
    step = 1.0 / (instants - 1)
    return tuple((number * step, peak * (-1.0) ** number) for number in range(instants))
