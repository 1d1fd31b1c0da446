"""The page of a study: curves of error over time, of growth, and the tables, in one HTML file."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from pathlib import Path

import numpy as np

from solver.discrete.problem import Array
from solver.study.drawing import PAGE, inline, png
from solver.study.error_against_time import INCREMENTAL, Course, Study
from solver.study.figure_data import Axis, Curve, Line, Panel
from solver.study.growth import MEASURED, Growth
from solver.study.study_report import Row, conditions, growth_table, table, verdicts

SPAN = (1e-9, 2.0)
"""Errors that are shown; smaller ones are drawn at SMALLEST, just above the lower edge."""
SMALLEST = 2e-9
CURVES = "Error against run time, set-up included"
GROWTH = "Growth with the size of the problem"


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
        "<p>Points are runs of a public solver at several tolerances; those below the lower edge "
        "stand on it. The dashed line is when the incremental solver is done.</p>",
        "<h2>Time to an error of the friction force</h2>",
        "<p>Iterations of LATIN are in brackets.</p>",
        _table(table(study)),
    ]
    if found:
        parts += [
            f"<h2>{GROWTH}</h2>",
            "<p>Time of one iteration of LATIN, of the whole solution by increments; the exponent "
            "is the slope of its logarithm over that of the size, by least squares.</p>",
            f"<figure>{inline(png(growth_panels(found), GROWTH), GROWTH)}</figure>",
            _table(growth_table(found)),
        ]
    parts += ["<h2>How it was measured</h2>", _list(conditions(study))]
    file = folder / "study.html"
    file.write_text(PAGE.format(title="error against run time", body="\n".join(parts)), "utf-8")
    return file


def error_panels(study: Study) -> list[Panel]:
    """Draw errors of displacement and of friction force over time, a curve for each method."""
    panels = []
    for name, title in (
        ("error_displacement", "Displacement"),
        ("error_force", "Friction force"),
    ):
        numbers = {"latin": 0, "peer": 0}
        curves = []
        for course in study.courses:
            if course.kind != "incremental":
                numbers[course.kind] += 1
            curves.append(_curve(course, getattr(course, name), numbers.get(course.kind, 0)))
        panels.append(
            Panel(
                title,
                Axis("Time", "s", logarithmic=True),
                Axis("Relative error", logarithmic=True, limits=SPAN),
                tuple(curves),
            )
        )
    return panels


def _curve(course: Course, errors: Array, hue: int) -> Curve:
    """Give a method's line: a vertical one where the solver itself is the reference."""
    if course.kind == "incremental":
        seconds = np.repeat(course.seconds, 2)
        return Curve(course.method, seconds, np.array(SPAN), 0, "dashed")
    line: Line = "solid" if course.kind == "latin" else "points"
    return Curve(course.method, course.seconds, np.maximum(errors, SMALLEST), hue, line)


def growth_panels(found: Sequence[Growth]) -> list[Panel]:
    """Draw times over sizes, a panel for each setting that changes."""
    hues = {method: hue for hue, method in enumerate((INCREMENTAL, *MEASURED))}
    return [
        Panel(
            setting.capitalize(),
            Axis(f"Number of {setting}", logarithmic=True, whole=True),
            Axis("Time", "s", logarithmic=True),
            tuple(
                Curve(
                    one.method,
                    np.array([float(size.size) for size in one.sizes]),
                    np.array([size.seconds for size in one.sizes]),
                    hues[one.method],
                    "points",
                )
                for one in found
                if one.setting == setting
            ),
        )
        for setting in dict.fromkeys(one.setting for one in found)
    ]


def _list(lines: Sequence[str]) -> str:
    return "<ul>\n" + "\n".join(f"<li>{escape(line)}</li>" for line in lines) + "\n</ul>"


def _table(rows: Sequence[Row]) -> str:
    head, *rest = rows
    lines = ["".join(f"<th>{escape(cell)}</th>" for cell in head)]
    lines += ["".join(f"<td>{escape(cell)}</td>" for cell in row) for row in rest]
    return "<table>\n" + "\n".join(f"<tr>{line}</tr>" for line in lines) + "\n</table>"
