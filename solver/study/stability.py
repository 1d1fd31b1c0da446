"""Stability: runs that are to be made, what they come to, what that is worth, and its report."""

from __future__ import annotations

import json
import math
import shlex
import time
import tomllib
import warnings
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from solver.latin import Ending, Solution
from solver.reference.distance import distance_to
from solver.reference.laws_obeyed import LawResiduals, RowFields, law_residuals
from solver.refusal import RefusedError
from solver.scenes import CATALOGUE
from solver.study.page import (
    aligned,
    line_of,
    text_of,
    write_csv,
    write_page,
)
from solver.study.quantities.finished import (
    BROKEN,
    REFUSED,
    finished_run,
    known_reference,
)

CASES = Path(__file__).with_name("stability_cases.toml")
LONGEST = 60.0
"""Seconds after which a run is ended, and its reference given up: one that takes longer
counts as unsolved, and keeps nobody from the other rows."""


class Verdict(StrEnum):
    """What a run is worth."""

    RIGHT = "right"
    UNSOLVED = "unsolved"
    REFUSED = "refused"
    UNCLEAR = "unclear"
    WRONG = "wrong"


class Judge(StrEnum):
    """The judge of a run."""

    LAWS = "laws"
    REFERENCE = "reference"
    NOTHING = "nothing"


MEANING: dict[str, str] = {
    Verdict.RIGHT: "balance and all laws hold up to rounding; or the distance to a reference that "
    "obeys them is as small as it has to be",
    Verdict.UNSOLVED: "not the right answer, and the run says so, and what to try",
    Verdict.REFUSED: "a problem without a solution, or senseless, is refused in words",
    Verdict.UNCLEAR: "called converged, not certified, and not judged, as the reference finds "
    "several solutions or none, or breaks a law",
    Verdict.WRONG: "called converged with a larger error, certified and breaks a law, not finite, "
    "or ended in a warning or an exception",
}
JUDGES: dict[str, str] = {
    Judge.LAWS: "the answer obeys balance and all laws up to rounding, or is certified and does "
    "not; a certified answer is what the reference's own solver finds, so its distance to the "
    "reference says nothing",
    Judge.REFERENCE: "by the distance to a reference that obeys them",
    Judge.NOTHING: "no judge is needed, or there is none: not solved, refused, broken off, unclear",
}
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
AT_ROUNDING = 1e-8
"""Largest violation of any law that rounding may leave, as a share of what is in
play."""
APART = 1e-6
"""Distance from which on two fields that solve the equations are two solutions."""
RIGHT_UP_TO = 1e-6
"""Error of displacement and contact force up to which an answer is right."""
Row = dict[str, Any]
METHODS: dict[str, dict[str, object]] = {"fast": {}, "paper": {"method": "paper"}}
FILES = "stability.csv", "stability.html"
COLUMNS = (
    *(
        "scene",
        "case",
        "method",
        "expected",
        "verdict",
        "passed",
        "status",
        "certified",
    ),
    *("judged_by", "laws", "worst_law", "reference_laws"),
    *("iterations", "estimated_error", "error_displacement", "error_force"),
    *("indicator", "behaviour", "seconds", "doubt", "advice", "settings"),
)
LONG = "doubt", "advice", "settings"
"""Columns of words: beside numbers there is no room for them on a screen."""
SHOWN = {
    **{
        "passed": ("", 5),
        "verdict": ("", 8),
        "scene": ("scene", 7),
        "case": ("run", 44),
    },
    **{
        "method": ("method", 12),
        "status": ("status", 10),
        "certified": ("certified", 9),
    },
    **{
        "iterations": ("iter.", 5),
        "estimated_error": ("estimate", 8),
        "seconds": ("s", 6),
    },
    **{"error_displacement": ("error W", 8), "error_force": ("error F", 8)},
    **{"judged_by": ("judged by", 9), "laws": ("laws", 8)},
}
"""Columns of a console."""
NOTES = (
    "A run passes if it comes to what is expected of it. Right is an answer that breaks no law by "
    "more than 1e-8; of runs that are not certified also errors of at most 1e-6, and of random "
    "runs errors of the contact force of at most the accuracy.",
    "Laws: the largest violation of balance, held displacements, cuts, Signorini's and Coulomb's "
    "law at any place and instant, as a share of the largest contact force, or jump.",
    "Errors: distance to the reference solution over space and time, as a share of it; where it is "
    "zero, as a share of the load, or in m and N.",
)


@dataclass(frozen=True)
class StabilityCase:
    """A run that is to be made, by what is extreme about it, and what may come of it.

    Its values are settings that differ from the scene's own; what is expected is a key
    of `PASSING`, and errors are those up to which the answer is right.
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
        changes = (
            f"--set {shlex.quote(f'{name}={text}')}" for name, text in texts.items()
        )
        return " ".join([f"python -m solver run {self.scene}", *changes])


def extreme_cases(
    scenes: Collection[str] = (), *, quick: bool = False
) -> Iterator[StabilityCase]:
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


@dataclass(frozen=True)
class Outcome:
    """What a run came to; NaN where something is not known.

    Attributes
    ----------
    ending, advice
        Its status; `REFUSED` or `BROKEN`, and why.
    laws, worst_law
        Largest violation of any law by the answer, and by which kind of law.
    reference_laws
        The same of the reference; one that breaks a law judges no answer.
    doubt
        Why the reference is not the one solution, or empty.
    """

    ending: str
    advice: str
    certified: bool = False
    iterations: int = 0
    seconds: float = 0.0
    estimated_error: float = math.nan
    indicator: float = math.nan
    behaviour: float = math.nan
    error_displacement: float = math.nan
    error_force: float = math.nan
    laws: float = math.nan
    worst_law: str = ""
    reference_laws: float = math.nan
    doubt: str = ""


def run(scene: str, values: Mapping[str, object]) -> Outcome:
    """Run a scene of the catalogue to its stop rule, and measure what comes out.

    Its settings differ by the values from the scene's own; a warning breaks it.
    """
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        try:
            settings = CATALOGUE[scene].checked(values)
            finished = finished_run(
                settings, errors=False, indicators=False, cancelled=_alarm()
            )
            return _measured(finished.solution)
        except RefusedError as refusal:
            return Outcome(REFUSED, str(refusal))
        except Exception as trouble:  # whatever it is belongs in the table
            return Outcome(BROKEN, f"{type(trouble).__name__}: {trouble}")


def _alarm() -> Callable[[], bool]:
    """Clock that says, when it is asked, whether `LONGEST` seconds have gone."""
    end = time.perf_counter() + LONGEST
    return lambda: time.perf_counter() > end


def _measured(solution: Solution) -> Outcome:
    """Compare a solution with the laws, and with the reference where there is one."""
    iterate = solution.iterate
    status = solution.status
    problem = solution.iterate.problem
    if not all(
        np.isfinite(field).all()
        for field in (iterate.displacement, iterate.contact_force)
    ):
        return Outcome(BROKEN, "not all fields are finite", iterations=iterate.number)
    rows = RowFields(iterate.boundary_displacement, iterate.boundary_force)
    laws = law_residuals(iterate, problem, rows)
    reference, doubt, _ = known_reference(problem, _alarm())
    distance = None
    of_reference = None
    error = math.nan
    if reference is not None:
        distance = distance_to(reference, problem)
        of_reference = law_residuals(reference, problem)
        error = distance.of_friction_force(iterate)
    last = None
    if solution.records:
        last = solution.records[-1]
    return Outcome(
        status.ending,
        status.advice,
        certified=solution.is_certified,
        iterations=iterate.number,
        seconds=last.seconds if last else iterate.seconds,
        estimated_error=last.estimated_error if last else math.nan,
        indicator=iterate.indicator,
        behaviour=iterate.violation,
        error_displacement=distance.of_displacement(iterate) if distance else math.nan,
        error_force=error,
        laws=laws.largest,
        worst_law=laws.worst,
        reference_laws=of_reference.largest if of_reference else math.nan,
        doubt=doubt or _doubt(laws, of_reference, error),
    )


def _doubt(laws: LawResiduals, of_reference: LawResiduals | None, error: float) -> str:
    """Why a reference is not the one solution, from its own laws and those of an answer."""
    if of_reference is None:
        return ""
    if not of_reference.largest <= AT_ROUNDING:
        return f"the reference breaks a law ({of_reference.worst}) by {of_reference.largest:.1e}"
    if laws.largest <= AT_ROUNDING and error > APART:
        return "there are several solutions: this one, and the reference"
    return ""


class Judgement(NamedTuple):
    """A verdict, and the judge that found it."""

    verdict: Verdict
    by: Judge


def judge(outcome: Outcome, force: float, displacement: float = math.inf) -> Judgement:
    """Judge an outcome by its numbers and its status alone.

    Laws come first, and of a certified answer they alone count. Otherwise it is right
    up to these errors of contact force and displacement.
    """
    if outcome.ending == BROKEN or not outcome.advice:
        return Judgement(Verdict.WRONG, Judge.NOTHING)
    if outcome.ending == REFUSED:
        return Judgement(Verdict.REFUSED, Judge.NOTHING)
    if outcome.laws <= AT_ROUNDING:
        return Judgement(Verdict.RIGHT, Judge.LAWS)
    if outcome.certified:
        return Judgement(Verdict.WRONG, Judge.LAWS)
    has_reference = outcome.reference_laws <= AT_ROUNDING
    is_near = (
        outcome.error_force <= force and outcome.error_displacement <= displacement
    )
    if has_reference and is_near:
        return Judgement(Verdict.RIGHT, Judge.REFERENCE)
    if outcome.ending != Ending.CONVERGED:
        return Judgement(Verdict.UNSOLVED, Judge.NOTHING)
    if outcome.doubt:
        return Judgement(Verdict.UNCLEAR, Judge.NOTHING)
    if has_reference:
        by = Judge.REFERENCE
    else:
        by = Judge.NOTHING
    return Judgement(Verdict.WRONG, by)


def row_of(case: StabilityCase, outcome: Outcome) -> Row:
    """A run as it is written: a case, what it came to, and what that is worth."""
    judgement = judge(outcome, case.error_force, case.error_displacement)
    return {
        **{**vars(case), **vars(outcome)},
        "case": case.title,
        "verdict": str(judgement.verdict),
        "judged_by": str(judgement.by),
        "passed": "pass" if judgement.verdict in PASSING[case.expected] else "FAIL",
        "status": str(outcome.ending),
        "settings": json.dumps(case.values),
        "command": case.command,
    }


def passed(row: Row) -> bool:
    """Whether a run came to what it has to."""
    return bool(row["passed"] == "pass")


def judged_runs(cases: Iterable[StabilityCase]) -> Iterator[Row]:
    """Run cases, and yield each as soon as it is done."""
    return (row_of(case, run(case.scene, case.values)) for case in cases)


def summary(runs: Sequence[Row]) -> str:
    """How many runs came to what they have to."""
    return f"{sum(map(passed, runs))} of {len(runs)} runs pass."


def counts(runs: Sequence[Row]) -> list[list[str]]:
    """Numbers of runs by verdict, and what each means; with a head."""
    return _counted(runs, "verdict", MEANING)


def judges(runs: Sequence[Row]) -> list[list[str]]:
    """Numbers of runs by what judged them, and what each means; with a head."""
    return _counted(runs, "judged_by", JUDGES)


def _counted(
    runs: Sequence[Row], column: str, meaning: Mapping[str, str]
) -> list[list[str]]:
    numbers = Counter(run[column] for run in runs)
    rows = ([str(name), str(numbers[name]), text] for name, text in meaning.items())
    return [[column.replace("_", " "), "runs", "what it means"], *rows]


def last_lines(runs: Sequence[Row]) -> list[str]:
    """What a console ends with; what did not pass, with the command that repeats it."""
    tables = [aligned(counts(runs)), "", aligned(judges(runs))]
    lines = ["", summary(runs), *tables, "", *NOTES]
    for run in runs:
        if not passed(run):
            lines += [
                "",
                line_of(run, SHOWN),
                f"      {run['advice']}",
                f"      {run['command']}",
            ]
    return lines


def write_stability(runs: Sequence[Row], folder: Path) -> None:
    """Write `FILES` into an existing folder."""
    short = [column for column in COLUMNS if column not in LONG]
    cells = []
    shown = []
    for row in runs:
        cells.append([row[column] for column in COLUMNS])
        words = " · ".join(str(row[column]) for column in LONG if row[column])
        shown.append(([text_of(row[column]) for column in short], words))
    write_csv(folder / FILES[0], COLUMNS, cells)
    write_page(
        folder / FILES[1],
        "stability.html",
        [],
        title="Stability on extreme or random runs",
        summary=summary(runs),
        counts=counts(runs),
        judges=judges(runs),
        notes=NOTES,
        names=[column.replace("_", " ") for column in short],
        runs=shown,
    )
