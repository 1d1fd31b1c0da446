"""Stiff and extreme cases, each with a verdict: a tab whose table fills row by row."""

from __future__ import annotations

import time
from collections.abc import Sequence
from functools import partial
from html import escape
from typing import Any

import panel_material_ui as pmui

from app.errand import Errand
from app.views.report import Report, bullets
from app.worker.studies import StabilityFound, stability_of
from app.worker.words import number
from solver.study.stability import Row, Verdict
from solver.study.stability_cases import REFUSED, RIGHT, TOLD, UNCLEAR
from solver.study.stability_report import COLOURS, notes, said, summary

WORDS = (
    "Stiff and extreme cases of every scene, whatever the settings of the page: does every one of "
    "them end with the right answer, or with a status that says that it is not? The run of this "
    "page goes on beside, so seconds in the files are no measurement."
)
CASES = {"a quarter of the cases": True, "all cases": False}
EVERY, WRONG = "All runs", "Not right"
HEADS = (
    "Verdict",
    "Scene",
    "Case",
    "Method",
    "Expected",
    "Ending",
    "Iterations",
    "Displacement error",
    "Friction force error",
    "Condition number, structure",
    "Condition number, substructures",
    "What the status says",
)
PLAIN = {"& button": {"textTransform": "none", "whiteSpace": "nowrap", "padding": "4px 14px"}}
EXPECTED = {
    RIGHT: "right",
    TOLD: "right or told",
    REFUSED: "refused",
    UNCLEAR: "right, told or unclear",
}
REDRAW_EVERY = 0.5
"""Seconds: the whole table is sent each time."""


class StabilityReport(Report):
    """The stability matrix.

    Parameters
    ----------
    errand, style
        As for `Report`.
    """

    def __init__(self, errand: Errand, style: str) -> None:
        super().__init__(errand, style, "Stability on stiff and extreme cases", WORDS)
        self._matrix = self._text("")
        self._drawn: tuple[object, ...] = ()
        self._drawn_at = 0.0

    def _choices(self) -> list[Any]:
        self._cases = pmui.Select(
            label="Cases", options=list(CASES), width=230, size="small", value=next(iter(CASES))
        )
        self._filter = pmui.RadioButtonGroup(
            options=[EVERY, WRONG], value=EVERY, size="small", margin=(8, 10), sx=PLAIN
        )
        self._filter.param.watch(lambda event: self._show(), "value")
        return [self._cases, self._filter]

    def _ask(self) -> None:
        quick = CASES[self._cases.value]
        self._errand.ask(self._cases.value, partial(stability_of, quick))

    def _show(self) -> None:
        errand, rows = self._errand, self._errand.parts
        state = (len(rows), errand.is_busy, self._filter.value, errand.last)
        now = time.monotonic()
        soon = errand.is_busy and now - self._drawn_at < REDRAW_EVERY
        if state == self._drawn or (soon and self._filter.value == self._drawn[2]):
            return
        self._drawn, self._drawn_at = state, now
        if not rows:
            self._results[:] = []
            return
        self._matrix.object = matrix(rows, only_wrong=self._filter.value == WRONG)
        parts: list[Any] = [self._matrix]
        if errand.last is not None:
            found: StabilityFound = errand.last.result
            parts += [self._text(bullets(notes(found.apart))), self._downloads(found.files)]
        if not self._results.objects or len(self._results[0]) != len(parts):
            self._results[:] = [self._card(*parts)]


def matrix(rows: Sequence[Row], *, only_wrong: bool) -> str:
    """Write rows as a table under one sentence about all of them (HTML)."""
    shown = [row for row in rows if not only_wrong or row.verdict is not Verdict.RIGHT]
    heads = "".join(f"<th>{head}</th>" for head in HEADS)
    body = "".join(map(_row, shown))
    hidden = f" {len(shown)} are shown." if len(shown) < len(rows) else ""
    return (
        f"<p><b>{escape(summary(rows))}</b>{hidden}</p>"
        f'<div class="scroll"><table class="matrix"><thead><tr>{heads}</tr></thead>'
        f"<tbody>{body}</tbody></table></div>"
    )


def _row(row: Row) -> str:
    """Write one row; what the status says is worth the space only where it is not the answer."""
    found, case = row.outcome, row.case
    advice = "" if row.verdict is Verdict.RIGHT else said(row)
    cells = [
        escape(case.scene),
        escape(f"{case.group}: {case.name}"),
        escape(row.method),
        f"{'✓' if row.as_expected else '✗ not'} {EXPECTED[case.expected]}",
        escape(found.ending),
        str(found.iterations),
        number(found.error_displacement),
        number(found.error_force),
        number(found.condition_structure),
        number(found.condition_substructure),
        escape(advice),
    ]
    verdict = (
        f'<td class="verdict" style="border-left-color: {COLOURS[row.verdict]}">{row.verdict}</td>'
    )
    return f"<tr>{verdict}{''.join(f'<td>{cell}</td>' for cell in cells)}</tr>"
