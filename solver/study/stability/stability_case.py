"""A case: a run that is to be made, and what may come of it."""

from __future__ import annotations

import json
import shlex
import tomllib
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

from solver.scenes import CATALOGUE

CASES = Path(__file__).with_name("cases.toml")


class Verdict(StrEnum):
    """What a run is worth."""

    RIGHT = "right"
    UNSOLVED = "unsolved"
    REFUSED = "refused"
    UNCLEAR = "unclear"
    WRONG = "wrong"


NOT_WRONG = "not wrong"
PASSING = {
    "right": {Verdict.RIGHT},
    "unsolved": {Verdict.RIGHT, Verdict.UNSOLVED},
    "unclear": {Verdict.RIGHT, Verdict.UNSOLVED, Verdict.UNCLEAR},
    "refused": {Verdict.REFUSED},
    NOT_WRONG: set(Verdict) - {Verdict.WRONG},
}
"""Verdicts with which a run passes, by what is expected of it."""
PRECISE = {"accuracy": 1e-6, "tolerance": 1e-20, "max_iterations": 1500}
"""Tight, so that whoever is called converged has to be right; enough for most cases."""
RIGHT_UP_TO = 1e-6
"""Error of displacement and contact force up to which an answer is right."""
METHODS: dict[str, dict[str, object]] = {"fast": {}, "paper": {"method": "paper"}}


@dataclass(frozen=True)
class StabilityCase:
    """A run that is to be made, and what may come of it.

    Attributes
    ----------
    title
        What is extreme about it; or which one it is of random ones.
    scene, values
        Settings that differ from the scene's own.
    expected
        A key of `PASSING`.
    method
        As tables name it.
    error_force, error_displacement
        Errors up to which the answer is right.
    """

    title: str
    scene: str
    values: Mapping[str, object]
    expected: str = "right"
    method: str = "fast"
    error_force: float = RIGHT_UP_TO
    error_displacement: float = RIGHT_UP_TO

    @property
    def command(self) -> str:
        """The command that makes the run."""
        texts = {
            name: value if isinstance(value, str) else json.dumps(value)
            for name, value in self.values.items()
        }
        changes = (f"--set {shlex.quote(f'{name}={text}')}" for name, text in texts.items())
        return " ".join([f"python -m solver run {self.scene}", *changes])


def extreme_cases(scenes: Collection[str] = (), *, quick: bool = False) -> Iterator[StabilityCase]:
    """Cases of some scenes, or of all, by each method; with `quick` only the few for a check."""
    for scene, groups in tomllib.loads(CASES.read_text(encoding="utf-8")).items():
        if scene not in (scenes or CATALOGUE):
            continue
        common = groups.pop("common", {})
        for expected, cases in groups.items():
            for title, values in cases.items():
                if values.pop("quick", False) or not quick:
                    for method, own in METHODS.items():
                        all_values = {**PRECISE, **own, **common, **values}
                        yield StabilityCase(title, scene, all_values, expected, method)
