"""The proof: every number that is known beside ours, as lines, CSV and one HTML page."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from html import escape
from itertools import groupby
from pathlib import Path

from solver.study.cases.case import all_cases
from solver.study.page import cell, table, write_csv, write_page
from solver.study.proof.bodies import body_cases
from solver.study.proof.known_case import (
    CLOSED_FORMS,
    INCREMENTAL,
    LATIN,
    PUBLISHED,
    TRADE,
    KnownCase,
    ProofRow,
    known_case,
)
from solver.study.proof.rods import rod_cases

HEAD = f"{'':<5} {'case':<56} {'solver':<12} {'quantity':<52} {'deviation':>9} {'allowed':>8}"
COLUMNS = (
    *("holds", "part", "case", "solver", "quantity", "unit", "known", "ours", "deviation"),
    *("allowed", "mesh", "source", "address"),
)
FILES = "proof.csv", "proof.html"
PAGE = "http://localhost:5006/app"
"""Where the page is served by default; links of the report open runs there."""
TITLE = "Proof: what is known beside what Slipfront finds"
WORDS = (
    f'<p>Links open the run on a page served at <a href="{PAGE}">{PAGE}</a>.</p>\n'
    "<p>Each row is a number that is known, and the same number of a run: by LATIN, ended as a run "
    "on the page ends, and but for cases of the trade by the incremental solver on the same mesh. "
    "<em>Deviation</em> is the distance of each over the number that is known, <em>allowed</em> "
    "what the mesh leaves.</p>"
)
HEADS = "", "quantity", "unit", "known", LATIN, "deviation", INCREMENTAL, "deviation", "allowed"
HOLDS, FAILS = "holds", "FAILS"


def cases() -> list[KnownCase]:
    """All cases, none of them solved yet."""
    return [*rod_cases(), *body_cases(), *map(known_case, all_cases())]


def line(row: ProofRow) -> str:
    """One row of the console's table."""
    return (
        f"{_verdict(row):<5} {row.case.title:<56} {row.solver:<12} {row.quantity:<52} "
        f"{row.deviation:9.1e} {row.case.allowed:8.0e}"
    )


def summary(rows: Sequence[ProofRow]) -> str:
    """How many rows hold."""
    return f"{sum(row.holds for row in rows)} of {len(rows)} numbers hold."


def write_proof(rows: Sequence[ProofRow], folder: Path) -> tuple[Path, Path]:
    """Write the table and the page; their places."""
    table_file, page = (folder / file for file in FILES)
    write_csv(table_file, COLUMNS, map(_entries, rows))
    sections = [f"{WORDS}<p>{summary(rows)}</p>"]
    for part in (CLOSED_FORMS, PUBLISHED, TRADE):
        lines = list(_html_rows(row for row in rows if row.case.part == part))
        if lines:
            sections.append(f"<h2>{part}</h2>{table(HEADS, lines)}")
    write_page(page, TITLE, sections)
    return table_file, page


def _verdict(row: ProofRow) -> str:
    return HOLDS if row.holds else FAILS


def _entries(row: ProofRow) -> list[str]:
    case = row.case
    return [
        *(_verdict(row), case.part, case.title, row.solver, row.quantity, row.unit),
        *(repr(float(row.exact)), repr(float(row.found)), f"{row.deviation:.3g}"),
        *(f"{case.allowed:g}", case.mesh, case.source, case.address),
    ]


def _html_rows(rows: Iterable[ProofRow]) -> Iterator[str]:
    """For each case what it is, and below it a line for each of its numbers, by both solvers."""
    for case, own in groupby(rows, lambda row: row.case):
        link = (
            f'<a class="run" href="{escape(PAGE + case.address)}"><b>{escape(case.title)}</b></a>'
        )
        words = f"{link} · {escape(case.mesh)}<br><small>{escape(case.source)}</small>"
        yield f'<td colspan="{len(HEADS)}" class="more">{words}</td>'
        numbers: dict[str, dict[str, ProofRow]] = {}
        for row in own:
            numbers.setdefault(row.quantity, {})[row.solver] = row
        yield from map(_cells, numbers.values())


def _cells(rows: Mapping[str, ProofRow]) -> str:
    """The line of one number, by solver."""
    first = next(iter(rows.values()))
    word, kind = (HOLDS, "right") if all(row.holds for row in rows.values()) else (FAILS, "wrong")
    texts = [f"{first.exact:.6g}"]
    for solver in (LATIN, INCREMENTAL):
        row = rows.get(solver)
        texts += [f"{row.found:.6g}", f"{row.deviation:.1e}"] if row else ["", ""]
    texts.append(f"{first.case.allowed:g}")
    known = cell(first.quantity) + cell("" if first.unit == "-" else first.unit)
    return cell(word, f"verdict {kind}") + known + "".join(cell(text, "number") for text in texts)
