"""One legend for charts side by side."""

from __future__ import annotations

from collections.abc import Sequence

from app.charts.layers import COLORS
from app.views.drawing.legend import Key, card_title
from solver.study.chart import Chart, Panel

MARKS = {"solid": "line", "points": "dot"}


def legend(charts: Sequence[Chart], title: str = "", *, has_ghost: bool = False) -> str:
    """Write it (HTML), behind a title."""
    panels = [chart for chart in charts if isinstance(chart, Panel)]
    curves = {one.label: one for panel in panels for one in panel.curves if one.label}.values()
    keys = [Key(COLORS[one.hue], MARKS.get(one.line, one.line), one.label) for one in curves]
    ghost = [Key("currentColor", "dashed", "the chart before")] if has_ghost else []
    return f'<div class="title">{card_title(title, [*keys, *ghost])}</div>'
