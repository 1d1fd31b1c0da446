"""The page of a study: curves of error over time, of growth, and the tables, in one HTML file."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from pathlib import Path

from solver.study.drawing import PAGE, inline, png
from solver.study.error_against_time import Study
from solver.study.growth import Growth
from solver.study.study_panels import CAPTION, CURVES, GROWTH, error_panels, growth_panels
from solver.study.study_report import (
    GROWTH_NOTE,
    TIMES,
    TIMES_NOTE,
    Row,
    conditions,
    growth_table,
    table,
    verdicts,
)


def write_page(study: Study, found: Sequence[Growth], folder: Path) -> Path:
    """Write `study.html`, which needs nothing beside it.

    Raises
    ------
    OSError
        When the file cannot be written.
    """
    parts = [
        "<h1>Error against run time</h1>",
        _list(verdicts(study)),
        f"<figure>{inline(png(error_panels(study), CURVES), CURVES)}</figure>",
        f"<p>{CAPTION}</p>",
        f"<h2>{TIMES}</h2>",
        f"<p>{TIMES_NOTE}</p>",
        _table(table(study)),
    ]
    if found:
        parts += [
            f"<h2>{GROWTH}</h2>",
            f"<p>{GROWTH_NOTE}</p>",
            f"<figure>{inline(png(growth_panels(found), GROWTH), GROWTH)}</figure>",
            _table(growth_table(found)),
        ]
    parts += ["<h2>How it was measured</h2>", _list(conditions(study))]
    file = folder / "study.html"
    file.write_text(PAGE.format(title="error against run time", body="\n".join(parts)), "utf-8")
    return file


def _list(lines: Sequence[str]) -> str:
    return "<ul>\n" + "\n".join(f"<li>{escape(line)}</li>" for line in lines) + "\n</ul>"


def _table(rows: Sequence[Row]) -> str:
    head, *rest = rows
    lines = ["".join(f"<th>{escape(cell)}</th>" for cell in head)]
    lines += ["".join(f"<td>{escape(cell)}</td>" for cell in row) for row in rest]
    return "<table>\n" + "\n".join(f"<tr>{line}</tr>" for line in lines) + "\n</table>"
