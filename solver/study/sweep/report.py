"""Reports of a sweep: its page, and sentences on counts and growth."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from solver.arrays import Array
from solver.study.page import PlotSection, text_of, write_page
from solver.study.sweep.charts import chart_of, grid
from solver.study.sweep.plan import Plan, Row
from solver.study.sweep.table import cells, head, heads


def counts(plan: Plan, rows: Sequence[Row]) -> str:
    """Sentence on the numbers of runs by ending."""
    endings = Counter(row.ending for row in rows)
    message = ", ".join(f"{count} {ending}" for ending, count in endings.most_common())
    return f"{len(rows)} of {plan.size} runs: {message or 'none yet'}."


def growth(plan: Plan, rows: Sequence[Row]) -> list[str]:
    """Lines on the power of a logarithmic setting with which quantities grow."""
    along, *others = plan.axes
    if not along.logarithmic or any(axis.is_numeric for axis in others):
        return []
    labels = [""]
    if others:
        names = others[0]
        labels = [f", {names.name}={value}" for value in names.values]
    lines = []
    for index, name in enumerate(plan.of):
        curves = grid(plan, rows, index).T.reshape(len(labels), -1)
        for label, curve in zip(labels, curves, strict=True):
            count = int((curve > 0.0).sum())
            if count > 1:
                power = _power(np.array(along.values), curve)
                text = f"{along.name}^{power:.2f}, of {count} runs"
                lines.append(f"{name}{label}: {text}")
    return lines


def _power(sizes: Array, values: Array) -> float:
    """Power of sizes in values, (n,) each, by regression of positive values."""
    is_known = values > 0.0
    # A power law is a straight line in logarithms.
    size, value = np.log([sizes[is_known], values[is_known]])
    return float(np.polyfit(size, value, 1)[0])


def title_of(plan: Plan) -> str:
    """Title of a sweep: its quantities over its settings."""
    asked = ", ".join(_uncapitalised(quantity.title) for quantity in plan.quantities)
    over = " and ".join(_uncapitalised(axis.title) for axis in plan.axes)
    return f"{plan.settings.scene.capitalize()}: {asked} over {over}"


def _uncapitalised(title: str) -> str:
    """Title with a small first letter."""
    return title[0].lower() + title[1:]


def write_sweep(plan: Plan, rows: Sequence[Row], file: Path) -> None:
    """Write the page of a sweep, of rows in the order of their points."""
    charts = [chart_of(plan, rows, index) for index in range(len(plan.of))]
    table = [heads(plan)]
    for row in rows:
        table.append([text_of(cell, 6) for cell in cells(plan, row)])
    write_page(
        file,
        "sweep.html",
        [PlotSection(f"Charts of {len(rows)} runs", charts)],
        title=title_of(plan),
        counts=counts(plan, rows),
        all_hold=all(row.holds for row in rows),
        growth=growth(plan, rows),
        rows=table,
        settings=head(plan),
    )
