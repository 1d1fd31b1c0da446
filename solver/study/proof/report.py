"""The proof: every number that is known beside ours, as lines, CSV and one HTML page."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from html import escape
from itertools import groupby
from pathlib import Path
from urllib.parse import urlencode

from solver.latin import Ending, solve
from solver.reference.incremental import reference_of
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of
from solver.settings import Settings
from solver.study.cases.case import Case, all_cases
from solver.study.mesh import size_of
from solver.study.page import html_table, text_of, write_csv, write_page
from solver.study.proof import known_numbers
from solver.study.proof.known_numbers import Answer, Number
from solver.study.quantities.finished import FinishedRun

PARTS = CLOSED_FORMS, PUBLISHED, TRADE = "Closed forms", "Published numbers", "Cases of the trade"
"""Parts of the report, by where what is known is from; cases of the trade are solved by LATIN."""
SHOWN = {
    **{"holds": ("", 5), "case": ("case", 56), "solver": ("solver", 12)},
    **{"quantity": ("quantity", 52), "deviation": ("deviation", 9), "allowed": ("allowed", 8)},
}
"""Columns of a console."""
NUMBERS = "holds", "quantity", "unit", "known", "solver", "ours", "deviation", "allowed"
"""Columns of the page."""
CASES = Path(__file__).with_name("cases.toml")
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

    `numbers` are what is known of an answer, beside what it has; `part` is that of the report.
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
            name: value if isinstance(value, str) else json.dumps(value, separators=(",", ":"))
            for name, value in self.settings.changed().items()
        }
        return f"?{urlencode({'scene': self.settings.scene, **texts})}"


@dataclass(frozen=True)
class ProofRow:
    """One number of one case by one solver, as it is known and as that has it.

    `ended` is whether the run came to its end; a number of one that did not proves nothing.
    """

    case: KnownCase
    solver: str
    ended: bool
    quantity: str
    unit: str
    exact: float
    found: float

    @property
    def deviation(self) -> float:
        """Distance of the two over what is known."""
        return float(abs(self.found - self.exact) / abs(self.exact))

    @property
    def holds(self) -> bool:
        """Whether it is as it has to be."""
        return self.ended and self.deviation <= self.case.allowed


def rows_of(case: KnownCase) -> Iterator[ProofRow]:
    """Solve a case by LATIN and, unless it is of the trade, by the incremental solver too."""
    settings = case.settings
    problem = discretise(settings)
    solution = solve(problem, method_of(settings))
    ended = solution.status.ending is Ending.CONVERGED
    for number in case.numbers(Answer(settings, problem, solution.iterate, solution)):
        yield ProofRow(case, "LATIN", ended, *number)
    if case.part != TRADE:
        reference = reference_of(problem)
        for number in case.numbers(Answer(settings, problem, reference)):
            yield ProofRow(case, "incremental", bool(reference.converged.all()), *number)


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


def entries(row: ProofRow) -> dict[str, object]:
    """Entries of a row by column."""
    case = row.case
    return {
        **{"holds": "holds" if row.holds else "FAILS", "part": case.part, "case": case.title},
        **{"solver": row.solver, "quantity": row.quantity, "unit": row.unit},
        **{"known": float(row.exact), "ours": float(row.found), "deviation": row.deviation},
        **{"allowed": case.allowed, "mesh": size_of(case.settings)},
        **{"source": case.source, "address": case.address},
    }


def summary(rows: Sequence[ProofRow]) -> str:
    """How many rows hold."""
    return f"{sum(row.holds for row in rows)} of {len(rows)} numbers hold."


def write_proof(rows: Sequence[ProofRow], folder: Path) -> None:
    """Write `FILES` into an existing folder."""
    written = [entries(row) for row in rows]
    write_csv(folder / FILES[0], list(written[0]), [entry.values() for entry in written])
    sections = [f"{WORDS}<p>{summary(rows)}</p>"]
    ordered = sorted(rows, key=lambda row: PARTS.index(row.case.part))
    for part, of_part in groupby(ordered, lambda row: row.case.part):
        lines = [list(NUMBERS)]
        for case, own in groupby(of_part, lambda row: row.case):
            address, title = escape(PAGE + case.address), escape(case.title)
            link = f'<a class="run" href="{address}"><b>{title}</b></a>'
            lines.append(
                [f"{link} · {size_of(case.settings)}<br><small>{escape(case.source)}</small>"]
            )
            for entry in map(entries, own):
                digits = {"known": 6, "ours": 6}
                lines.append([text_of(entry[name], digits.get(name, 2)) for name in NUMBERS])
        sections.append(f"<h2>{part}</h2>{html_table(lines)}")
    write_page(folder / FILES[1], TITLE, sections)
