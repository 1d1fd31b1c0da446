"""A sweep as a report: charts, and a line for every run."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from html import escape

from solver.study.page import PlotSection, Section, bullets, plain_table
from solver.study.sweep.chart import charts
from solver.study.sweep.growth import growth
from solver.study.sweep.plan import Plan
from solver.study.sweep.point import Row
from solver.study.sweep.table import cells, head, heads

CAPTION = (
    "Hollow points and hatched cells are of runs that have not converged, crosses of runs without "
    "a value."
)
GROWTH = (
    "Powers by least squares of the logarithms, with their margins at 95 % where there are more "
    "than two runs; small sizes, at which other things cost, make them lower."
)


def counts(plan: Plan, rows: Sequence[Row]) -> str:
    """Say in a sentence what became of the runs."""
    endings = Counter(row.ending for row in rows)
    told = ", ".join(f"{count} {ending}" for ending, count in endings.most_common())
    return f"{len(rows)} of {plan.size} runs: {told or 'none yet'}."


def title_of(plan: Plan) -> str:
    """Say what is asked."""
    asked = ", ".join(one.title[0].lower() + one.title[1:] for one in plan.readings)
    over = " and ".join(plan.title(axis)[0].lower() + plan.title(axis)[1:] for axis in plan.axes)
    return f"{plan.settings.scene.capitalize()}: {asked} over {over}"


def sections(plan: Plan, rows: Sequence[Row]) -> list[Section]:
    """Write rows, in the order of their points."""
    drawn = charts(plan, rows)
    laws = growth(plan, rows)
    table = [heads(plan), *([_text(cell) for cell in cells(plan, row)] for row in rows)]
    return [
        f"<p><b>{escape(counts(plan, rows))}</b></p>",
        PlotSection(f"Charts of {len(rows)} runs", drawn),
        *([] if all(row.holds for row in rows) else [f'<p class="caption">{CAPTION}</p>']),
        *([f"<h2>Growth</h2>\n<p>{GROWTH}</p>\n{bullets(laws)}"] if laws else []),
        f"<h2>Every run</h2>\n{plain_table(table)}",
        f"<h2>Settings</h2>\n{bullets(head(plan))}",
    ]


def _text(cell: object) -> str:
    if not isinstance(cell, float):
        return str(cell)
    return "-" if math.isnan(cell) else "never" if math.isinf(cell) else f"{cell:.6g}"
