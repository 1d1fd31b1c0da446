"""The page of proof: every number that is known beside ours, as lines, CSV and one HTML page."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Sequence
from pathlib import Path

from solver.disk import check_place, write
from solver.study.page import write_page
from solver.study.proof.case import HeldNumber, KnownCase, rows_of
from solver.study.proof.others import other_cases
from solver.study.proof.plane import plane_cases
from solver.study.proof.published import published_cases
from solver.study.proof.rods import rod_cases
from solver.study.proof.sections import proof_sections, verdict

HEAD = f"{'':<5} {'case':<56} {'solver':<12} {'quantity':<28} {'deviation':>9} {'allowed':>8}"
COLUMNS = (
    "holds",
    "part",
    "case",
    "solver",
    "quantity",
    "unit",
    "known",
    "ours",
    "deviation",
    "allowed",
    "mesh",
    "source",
    "address",
)
PAGE = "http://localhost:5006/app"
"""Where the page is served by default; links of the report open runs there."""
TITLE = "Proof: what is known beside what Slipfront finds"
LINKS = f'<p>Links open the run on a page served at <a href="{PAGE}">{PAGE}</a>.</p>'


def cases() -> Iterator[KnownCase]:
    """Give all cases, none of them solved yet."""
    yield from rod_cases()
    yield from plane_cases()
    yield from published_cases()
    yield from other_cases()


def proven(folder: Path, chosen: Sequence[KnownCase]) -> Iterator[HeldNumber]:
    """Solve cases one by one, once it is known that the report can be written.

    Raises
    ------
    OSError
        When it cannot.
    """
    for file in files_of(folder):
        check_place(file)
    for case in chosen:
        yield from rows_of(case)


def files_of(folder: Path) -> tuple[Path, Path]:
    """Name the table and the page."""
    return folder / "proof.csv", folder / "proof.html"


def line(row: HeldNumber) -> str:
    """Give one row of the console's table."""
    return (
        f"{verdict(row):<5} {row.case.title:<56} {row.solver:<12} {row.number.quantity:<28} "
        f"{row.number.deviation:9.1e} {row.case.allowed:8.0e}"
    )


def write_proof(rows: Sequence[HeldNumber], folder: Path) -> tuple[Path, Path]:
    """Write the table and the page; give their names."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerows([COLUMNS, *(_entries(row) for row in rows)])
    files = files_of(folder)
    write(files[0], text.getvalue())
    write_page(files[1], TITLE, [LINKS, *proof_sections(rows, PAGE)])
    return files


def _entries(row: HeldNumber) -> list[str]:
    number, case = row.number, row.case
    entries = [
        repr(float(number.exact)),
        repr(float(number.found)),
        f"{number.deviation:.3g}",
        f"{case.allowed:g}",
    ]
    words = [verdict(row), case.part.value, case.title, row.solver, number.quantity, number.unit]
    return [*words, *entries, case.mesh, case.source, case.address]
