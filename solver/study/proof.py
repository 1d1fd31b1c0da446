"""The proof: known and computed numbers of all cases, as CSV and an HTML page."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby
from operator import itemgetter
from pathlib import Path
from typing import Any
from urllib.parse import urlencode

from solver.latin import Ending, solve
from solver.reference.incremental import reference_of
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of
from solver.settings.scene import Settings
from solver.study import known_numbers
from solver.study.known_numbers import Number, SolvedCase
from solver.study.mesh import size_of
from solver.study.page import text_of, write_csv, write_page
from solver.study.quantities.finished import FinishedRun
from solver.study.trade_case import Case, cases_by_name

CLOSED_FORMS = "Closed forms"
PUBLISHED = "Published numbers"
TRADE = "Cases of the trade"
"""Part of the report whose cases LATIN alone solves."""
PARTS = (CLOSED_FORMS, PUBLISHED, TRADE)
"""Parts of the report, by the source of the known numbers."""
SHOWN = {
    "holds": ("", 5),
    "case": ("case", 56),
    "solver": ("solver", 12),
    "quantity": ("quantity", 52),
    "deviation": ("deviation", 9),
    "allowed": ("allowed", 8),
}
"""Columns on a console: head and width by name."""
Row = dict[str, Any]
"""Entries of a row of the proof by column: a number of a case by a solver."""
HOLDS = "holds"
FAILS = "FAILS"
NUMBERS = (
    "holds",
    "quantity",
    "unit",
    "known",
    "solver",
    "ours",
    "deviation",
    "allowed",
)
"""Columns of the page."""
CASE = ("address", "case", "mesh", "source")
"""Columns that say of which case a row is."""
CASES = Path(__file__).with_name("known_numbers.toml")
FILES = "proof.csv", "proof.html"
PAGE = "http://localhost:5006/app"
"""Default address of the page, on which links of the report open runs."""
TITLE = "Proof: what is known beside what Slipfront finds"


@dataclass(frozen=True, eq=False)
class KnownCase:
    """A problem whose answer is known from a source.

    Attributes
    ----------
    title, source, settings
        Title of the case, source of the known numbers, and settings of the run.
    allowed
        Largest relative deviation that is allowed.
    numbers
        Function of an answer that gives known numbers beside those of the answer.
    part
        Part of the report.
    """

    title: str
    source: str
    allowed: float
    settings: Settings
    numbers: Callable[[SolvedCase], Iterable[Number]]
    part: str = CLOSED_FORMS

    @property
    def address(self) -> str:
        """Query string that opens the run on the page."""
        texts = {"scene": self.settings.scene}
        for name, value in self.settings.changed().items():
            # Texts stand in an address as they are, all else as JSON.
            if isinstance(value, str):
                texts[name] = value
            else:
                texts[name] = json.dumps(value, separators=(",", ":"))
        return f"?{urlencode(texts)}"


def rows_of(case: KnownCase) -> Iterator[Row]:
    """Solve a case by LATIN and by the incremental solver.

    A case of the trade is solved by LATIN alone. A number of a run that has not
    converged does not hold.
    """
    settings = case.settings
    problem = discretise(settings)
    solution = solve(problem, method_of(settings))
    has_converged = solution.status.ending is Ending.CONVERGED
    answer = SolvedCase(settings, problem, solution.iterate, solution)
    yield from _rows_by("LATIN", case, answer, has_converged)
    if case.part != TRADE:
        reference = reference_of(problem)
        is_found = bool(reference.converged.all())
        answer = SolvedCase(settings, problem, reference)
        yield from _rows_by("incremental", case, answer, is_found)


def _rows_by(
    solver: str, case: KnownCase, answer: SolvedCase, has_ended: bool
) -> Iterator[Row]:
    """Rows of a case by a solver, which has converged or not."""
    for quantity, unit, known, ours in case.numbers(answer):
        # Known numbers are never zero: such a case would be no test.
        deviation = float(abs(ours - known) / abs(known))
        verdict = FAILS
        if has_ended and deviation <= case.allowed:
            verdict = HOLDS
        yield {
            "holds": verdict,
            "part": case.part,
            "case": case.title,
            "solver": solver,
            "quantity": quantity,
            "unit": unit,
            "known": float(known),
            "ours": float(ours),
            "deviation": deviation,
            "allowed": case.allowed,
            "mesh": size_of(case.settings),
            "source": case.source,
            "address": case.address,
        }


def known_case(case: Case) -> KnownCase:
    """Make a case of the proof from a case of the trade."""
    asked = case.quantity

    def numbers(answer: SolvedCase) -> Iterator[Number]:
        assert answer.solution is not None
        found = asked(FinishedRun(answer.settings, answer.solution))
        yield asked.title, asked.unit or "-", case.known, found

    source = f"{case.formula}. {case.how} {case.source}"
    return KnownCase(case.title, source, case.tolerance, case.settings, numbers, TRADE)


def cases() -> list[KnownCase]:
    """All cases, not solved yet."""
    known = []
    for group in tomllib.loads(CASES.read_text(encoding="utf-8"))["known"]:
        kind = CATALOGUE[group["scene"]]
        for title, settings in group["cases"].items():
            case = KnownCase(
                title=title,
                source=group["source"],
                allowed=group["allowed"],
                settings=kind.checked(group.get("common", {}) | settings),
                numbers=getattr(known_numbers, group["numbers"]),
                part=group.get("part", CLOSED_FORMS),
            )
            known.append(case)
    return known + [known_case(case) for case in cases_by_name().values()]


def holds(row: Row) -> bool:
    """Check whether a computed number is within its tolerance."""
    return bool(row["holds"] == HOLDS)


def summary(rows: Sequence[Row]) -> str:
    """Sentence on the number of rows that hold."""
    return f"{sum(holds(row) for row in rows)} of {len(rows)} numbers hold."


def write_proof(rows: Sequence[Row], folder: Path) -> None:
    """Write `FILES` into an existing folder."""
    write_csv(folder / FILES[0], list(rows[0]), [row.values() for row in rows])
    parts = {}
    for part in PARTS:
        of_part = [row for row in rows if row["part"] == part]
        if of_part:
            parts[part] = _by_case(of_part)
    write_page(
        folder / FILES[1],
        "proof.html",
        [],
        title=TITLE,
        page=PAGE,
        summary=summary(rows),
        names=NUMBERS,
        parts=parts,
    )


def _by_case(rows: Sequence[Row]) -> list[dict[str, Any]]:
    """Group rows by case: entries by the columns of `CASE`, and lines (`rows`)."""
    digits = {"known": 6, "ours": 6}
    cases = []
    # Rows of a case follow each other.
    for case, of_case in groupby(rows, itemgetter(*CASE)):
        lines = []
        for row in of_case:
            lines.append([text_of(row[name], digits.get(name, 2)) for name in NUMBERS])
        cases.append({**dict(zip(CASE, case, strict=True)), "rows": lines})
    return cases
