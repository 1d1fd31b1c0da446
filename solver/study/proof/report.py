"""The page of proof: every number that is known beside ours, as lines, CSV and one HTML page."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Sequence
from html import escape
from pathlib import Path

from solver.disk import check_place, write
from solver.study.page import table, write_page
from solver.study.proof.case import HeldNumber, KnownCase, Part, rows_of
from solver.study.proof.others import absent, other_cases
from solver.study.proof.plane import plane_cases
from solver.study.proof.published import published_cases
from solver.study.proof.rods import rod_cases

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
HEADS = [name for name in COLUMNS if name not in ("part", "address")]
PAGE = "http://localhost:5006/app"
"""Where the page is served by default; links of the report open runs there."""
TITLE = "Proof: what is known beside what Slipfront finds"
WORDS = (
    "<p>Each row is a number that is known, and the same number of a run: by LATIN, ended as a run "
    "on the page ends, and by the incremental solver on the same mesh. <em>Deviation</em> is their "
    "distance over the number that is known, <em>allowed</em> what the mesh leaves. {}</p>"
)
LINKS = f'Links open the run on a page served at <a href="{PAGE}">{PAGE}</a>.'


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
        f"{_verdict(row):<5} {row.case.title:<56} {row.solver:<12} {row.number.quantity:<28} "
        f"{row.number.deviation:9.1e} {row.case.allowed:8.0e}"
    )


def write_proof(rows: Sequence[HeldNumber], folder: Path) -> tuple[Path, Path]:
    """Write the table and the page; give their names."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerows([COLUMNS, *(_entries(row) for row in rows)])
    files = files_of(folder)
    write(files[0], text.getvalue())
    write_page(files[1], TITLE, [WORDS.format(LINKS), *proof_sections(rows, PAGE)])
    return files


def proof_sections(rows: Sequence[HeldNumber], page: str) -> list[str]:
    """Give the report as far as its rows go, part by part (HTML).

    Parameters
    ----------
    rows
        In the order of their parts.
    page
        What addresses of runs follow.
    """
    sections = [f"<p>{summary(rows)}</p>"]
    for part in Part:
        own = [row for row in rows if row.case.part is part]
        note = absent() if part is Part.OTHERS else ""
        if own or note:
            found = table(HEADS, [_cells(row, page) for row in own]) if own else ""
            words = f"<p>{escape(note)}</p>" if note else ""
            sections.append(f"<h2>{part.value}</h2>{words}{found}")
    return sections


def summary(rows: Sequence[HeldNumber]) -> str:
    """Say how many rows hold."""
    return f"{sum(row.holds for row in rows)} of {len(rows)} numbers hold."


def _verdict(row: HeldNumber) -> str:
    return "holds" if row.holds else "FAILS"


def _entries(row: HeldNumber) -> list[str]:
    number, case = row.number, row.case
    entries = [
        repr(float(number.exact)),
        repr(float(number.found)),
        f"{number.deviation:.3g}",
        f"{case.allowed:g}",
    ]
    words = [_verdict(row), case.part.value, case.title, row.solver, number.quantity, number.unit]
    return [*words, *entries, case.mesh, case.source, case.address]


def _cells(row: HeldNumber, page: str) -> str:
    number, case = row.number, row.case
    title = escape(case.title)
    if case.address:
        title = f'<a href="{escape(page + case.address)}">{title}</a>'
    words = [f"<b>{_verdict(row)}</b>", title, row.solver, escape(number.quantity), number.unit]
    entries = [f"{number.exact:.6g}", f"{number.found:.6g}", f"{number.deviation:.1e}"]
    entries.append(f"{case.allowed:g}")
    cells = [f"<td>{one}</td>" for one in words]
    cells += [f'<td class="number">{one}</td>' for one in entries]
    return "".join([*cells, f"<td>{escape(case.mesh)}</td><td>{escape(case.source)}</td>"])
