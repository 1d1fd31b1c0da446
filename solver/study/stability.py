"""Stability: cases with extreme settings, and the row of each with its verdict."""

from __future__ import annotations

import json
import shlex
import tomllib
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from solver.scenes import CATALOGUE
from solver.study.outcomes import Outcome, run
from solver.study.verdicts import Verdict, judge

CASES = Path(__file__).with_name("stability_cases.toml")
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
"""Settings of the stop rules so tight that a run called converged has to be right."""
RIGHT_UP_TO = 1e-6
"""Error of displacement and contact force up to which an answer is right."""
Row = dict[str, Any]
"""Entries of a run by column."""
METHODS: dict[str, dict[str, object]] = {"fast": {}, "paper": {"method": "paper"}}
"""Settings of the methods by which every case is run."""


@dataclass(frozen=True)
class StabilityCase:
    """A run, and the verdicts with which it passes.

    Attributes
    ----------
    title
        Name of the case: the extreme that it has.
    scene, values
        Scene, and the settings that differ from the scene's own.
    expected
        Key of `PASSING`.
    method
        Name of the method.
    error_force, error_displacement
        Relative errors up to which the answer is right.
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
        """Command that makes the run."""
        words = [f"python -m solver run {self.scene}"]
        for name, value in self.values.items():
            text = value
            if not isinstance(value, str):
                text = json.dumps(value)
            words.append(f"--set {shlex.quote(f'{name}={text}')}")
        return " ".join(words)


def extreme_cases(
    scenes: Collection[str] = (), *, quick: bool = False
) -> Iterator[StabilityCase]:
    """Extreme cases of some or all scenes by each method, or only the quick ones."""
    for scene, groups in tomllib.loads(CASES.read_text(encoding="utf-8")).items():
        if scene not in (scenes or CATALOGUE):
            continue
        common = groups.pop("common", {})
        for expected, cases in groups.items():
            for title, values in cases.items():
                is_quick = values.pop("quick", False)
                if is_quick or not quick:
                    case = StabilityCase(title, scene, common | values, expected)
                    yield from _by_each_method(case)


def _by_each_method(case: StabilityCase) -> Iterator[StabilityCase]:
    """Yield a case by each method, with strict stop rules unless it has others."""
    for method, settings in METHODS.items():
        values = PRECISE | settings | dict(case.values)
        yield replace(case, values=values, method=method)


def row_of(case: StabilityCase, outcome: Outcome) -> Row:
    """Row of a run: its case, its outcome, and the verdict."""
    judgement = judge(outcome, case.error_force, case.error_displacement)
    mark = "FAIL"
    if judgement.verdict in PASSING[case.expected]:
        mark = "pass"
    return vars(case) | {
        # Errors of the run, which replace the largest ones that the case allows.
        **vars(outcome),
        "case": case.title,
        "verdict": str(judgement.verdict),
        "judged_by": str(judgement.by),
        "passed": mark,
        "status": str(outcome.ending),
        "settings": json.dumps(case.values),
        "command": case.command,
    }


def passed(row: Row) -> bool:
    """Check whether the verdict on a run is one of those expected."""
    return bool(row["passed"] == "pass")


def judged_runs(cases: Iterable[StabilityCase]) -> Iterator[Row]:
    """Run cases, and yield the row of each when it is done."""
    for case in cases:
        yield row_of(case, run(case.scene, case.values))
