"""The report of proof in its three parts, for whoever shows it: a table each (HTML)."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape
from itertools import groupby

from solver.study.page import table
from solver.study.proof.case import INCREMENTAL, LATIN, HeldNumber, KnownCase, ProofPart
from solver.study.proof.others import absent

WORDS = (
    "<p>Each row is a number that is known, and the same number of a run: by LATIN, ended as a run "
    "on the page ends, and by the incremental solver on the same mesh. <em>Deviation</em> is the "
    "distance of each over the number that is known, <em>allowed</em> what the mesh leaves. Of all "
    "nodes, the number is the largest of all, and the distance that at the node and instant where "
    "it is largest.</p>"
)
HEADS = "", "quantity", "unit", "known", LATIN, "deviation", INCREMENTAL, "deviation", "allowed"
HOLDS, FAILS = "holds", "FAILS"


def proof_sections(rows: Sequence[HeldNumber], page: str) -> list[str]:
    """Give the report as far as its rows go, part by part.

    Parameters
    ----------
    rows
        Case by case.
    page
        What the addresses of runs follow.
    """
    sections = [f"{WORDS}<p>{summary(rows)}</p>"]
    for part in ProofPart:
        own = [row for row in rows if row.case.part is part]
        note = absent() if part is ProofPart.OTHERS else ""
        if own or note:
            words = f"<p>{escape(note)}</p>" if note else ""
            found = table(HEADS, list(_lines(own, page))) if own else ""
            sections.append(f"<h2>{part.value}</h2>{words}{found}")
    return sections


def summary(rows: Sequence[HeldNumber]) -> str:
    """Say how many rows hold."""
    return f"{sum(row.holds for row in rows)} of {len(rows)} numbers hold."


def verdict(row: HeldNumber) -> str:
    """Say in a word whether a row holds."""
    return HOLDS if row.holds else FAILS


def _lines(rows: Iterable[HeldNumber], page: str) -> Iterable[str]:
    """Give for each case what it is, and below it a line for each of its numbers."""
    for case, own in groupby(rows, lambda row: row.case):
        yield f'<td colspan="{len(HEADS)}" class="more">{_said(case, page)}</td>'
        by_number: dict[str, list[HeldNumber]] = {}
        for row in own:
            by_number.setdefault(row.number.quantity, []).append(row)
        yield from map(_cells, by_number.values())


def _said(case: KnownCase, page: str) -> str:
    link = f'<a class="run" href="{escape(page + case.address)}"><b>{escape(case.title)}</b></a>'
    return f"{link} · {escape(case.mesh)}<br><small>{escape(case.source)}</small>"


def _cells(rows: Sequence[HeldNumber]) -> str:
    """Give the line of one number, by both solvers."""
    first = rows[0]
    word, kind = (HOLDS, "right") if all(row.holds for row in rows) else (FAILS, "wrong")
    solvers = {row.solver: row.number for row in rows}
    numbers = [f"{first.number.exact:.6g}"]
    for solver in (LATIN, INCREMENTAL):
        found = solvers.get(solver)
        numbers += [f"{found.found:.6g}", f"{found.deviation:.1e}"] if found else ["", ""]
    numbers.append(f"{first.case.allowed:g}")
    unit = "" if first.number.unit == "-" else first.number.unit
    words = f"<td>{escape(first.number.quantity)}</td><td>{escape(unit)}</td>"
    cells = "".join(f'<td class="number">{one}</td>' for one in numbers)
    return f'<td class="verdict {kind}">{word}</td>{words}{cells}'
