"""The proof: every number that is known beside ours, as lines, CSV and one HTML page."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from html import escape
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
from solver.study.known_numbers import Answer, Number
from solver.study.mesh import size_of
from solver.study.page import html_table, text_of, write_csv, write_page
from solver.study.quantities.finished import FinishedRun
from solver.study.trade_case import Case, all_cases

PARTS = CLOSED_FORMS, PUBLISHED, TRADE = (
    "Closed forms",
    "Published numbers",
    "Cases of the trade",
)
"""Parts of the report, by where what is known is from; cases of the trade are solved by
LATIN."""
SHOWN = {
    **{"holds": ("", 5), "case": ("case", 56), "solver": ("solver", 12)},
    **{
        "quantity": ("quantity", 52),
        "deviation": ("deviation", 9),
        "allowed": ("allowed", 8),
    },
}
"""Columns of a console."""
Row = dict[str, Any]
"""A number of a case by a solver, as it is written."""
HOLDS = "holds"
FAILS = "FAILS"
NUMBERS = "holds", "quantity", "unit", "known", "solver", "ours", "deviation", "allowed"
"""Columns of the page."""
CASES = Path(__file__).with_name("known_numbers.toml")
FILES = "proof.csv", "proof.html"
PAGE = "http://localhost:5006/app"
"""Where the page is served by default; links of the report open runs there."""
TITLE = "Proof: what is known beside what Slipfront finds"
WORDS = (
    f'<p>Links open the run on a page served at <a href="{PAGE}">{PAGE}</a>.</p>\n'
    "<p>Each row is a number that is known, and the same number of a run: by LATIN, ended as a run "
    "on the page ends, and but for cases of the trade by the incremental solver on the same mesh. "
    "<em>Deviation</em> is the distance of both over the number that is known, <em>allowed</em> "
    "what the mesh leaves.</p>"
)


@dataclass(frozen=True, eq=False)
class KnownCase:
    """A problem whose answer is known from a source, and the largest deviation that is allowed.

    `numbers` are what is known of an answer, beside what it has; `part` is that of the
    report.
    """

    title: str
    source: str
    allowed: float
    settings: Settings
    numbers: Callable[[Answer], Iterable[Number]]
    part: str = CLOSED_FORMS

    @property
    def address(self) -> str:
        """What follows the page's address to open this run there."""
        texts = {
            name: value
            if isinstance(value, str)
            else json.dumps(value, separators=(",", ":"))
            for name, value in self.settings.changed().items()
        }
        return f"?{urlencode({'scene': self.settings.scene, **texts})}"


def rows_of(case: KnownCase) -> Iterator[Row]:
    """Solve a case by LATIN and, unless it is of the trade, by the incremental solver too.

    A number of a run that did not come to its end proves nothing.
    """
    settings = case.settings
    problem = discretise(settings)
    solution = solve(problem, method_of(settings))
    has_converged = solution.status.ending is Ending.CONVERGED
    answers = {
        "LATIN": (has_converged, Answer(settings, problem, solution.iterate, solution))
    }
    if case.part != TRADE:
        reference = reference_of(problem)
        is_found = bool(reference.converged.all())
        answers["incremental"] = is_found, Answer(settings, problem, reference)
    for solver, (has_ended, answer) in answers.items():
        for quantity, unit, known, ours in case.numbers(answer):
            deviation = float(abs(ours - known) / abs(known))
            holds = has_ended and deviation <= case.allowed
            yield {
                **{
                    "holds": HOLDS if holds else FAILS,
                    "part": case.part,
                    "case": case.title,
                },
                **{
                    "solver": solver,
                    "quantity": quantity,
                    "unit": unit,
                    "known": float(known),
                },
                **{
                    "ours": float(ours),
                    "deviation": deviation,
                    "allowed": case.allowed,
                },
                **{
                    "mesh": size_of(settings),
                    "source": case.source,
                    "address": case.address,
                },
            }


def known_case(case: Case) -> KnownCase:
    """Make a row of the proof of a case of the trade."""
    asked = case.quantity

    def numbers(answer: Answer) -> Iterator[Number]:
        assert answer.solution is not None
        found = asked(FinishedRun(answer.settings, answer.solution))
        yield asked.title, asked.unit or "-", case.known, found

    source = f"{case.formula}. {case.how} {case.source}"
    return KnownCase(case.title, source, case.tolerance, case.settings, numbers, TRADE)


def cases() -> list[KnownCase]:
    """All cases, none of them solved yet."""
    known = []
    for group in tomllib.loads(CASES.read_text(encoding="utf-8"))["known"]:
        for title, settings in group["cases"].items():
            kind = CATALOGUE[group["scene"]]
            case = KnownCase(
                title,
                group["source"],
                group["allowed"],
                kind.checked({**group.get("common", {}), **settings}),
                getattr(known_numbers, group["numbers"]),
                group.get("part", CLOSED_FORMS),
            )
            known.append(case)
    return [*known, *map(known_case, all_cases())]


def holds(row: Row) -> bool:
    """Whether a number is as it has to be."""
    return bool(row["holds"] == HOLDS)


def summary(rows: Sequence[Row]) -> str:
    """How many rows hold."""
    return f"{sum(map(holds, rows))} of {len(rows)} numbers hold."


def write_proof(rows: Sequence[Row], folder: Path) -> None:
    """Write `FILES` into an existing folder."""
    write_csv(folder / FILES[0], list(rows[0]), [row.values() for row in rows])
    sections = [f"{WORDS}<p>{summary(rows)}</p>"]
    digits = {"known": 6, "ours": 6}
    for part in PARTS:
        lines = [list(NUMBERS)]
        of_part = (row for row in rows if row["part"] == part)
        for head, own in groupby(
            of_part, itemgetter("address", "case", "mesh", "source")
        ):
            address, title, mesh, source = map(escape, head)
            link = f'<a class="run" href="{escape(PAGE)}{address}"><b>{title}</b></a>'
            lines.append([f"{link} · {mesh}<br><small>{source}</small>"])
            lines += [
                [text_of(row[name], digits.get(name, 2)) for name in NUMBERS]
                for row in own
            ]
        sections += [f"<h2>{part}</h2>{html_table(lines)}"] * (len(lines) > 1)
    write_page(folder / FILES[1], TITLE, sections)
