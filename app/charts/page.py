"""Charts inside of a page that needs nothing beside it: the engine's entry point for its files."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

from bokeh.embed import components
from bokeh.resources import Resources

from app.charts.draw import draw
from app.charts.keys import legend
from solver.study.page import PlotSection

STYLE = """<style>
.panels { display: grid; gap: 0 1rem; grid-template-columns:
  repeat(auto-fit, minmax(min(26rem, 100%), 1fr)); }
.key { margin-right: 1rem; white-space: nowrap; }
.key i { display: inline-block; width: 1.2rem; margin-right: 0.3rem; vertical-align: middle;
  border-top: 3px solid var(--mark); }
.key .dashed { border-top-style: dashed; }
.key .dotted { border-top-style: dotted; }
.key .dot { width: 0.6rem; height: 0.6rem; border: 0; border-radius: 50%; background: var(--mark); }
</style>"""


def render(plots: Sequence[PlotSection]) -> tuple[str, Sequence[str]]:
    """Draw the charts of a page.

    Returns
    -------
    What all of them need, and each section (HTML).
    """
    figures = [draw(chart) for plot in plots for chart in plot.charts]
    script, places = components(figures, wrap_script=True)
    # Not `Resources.render`, which brings what Panel would have a page load.
    library = Resources(mode="inline", components=["bokeh"]).js_raw
    waiting = iter(places)
    sections = [
        f'<div role="figure" aria-label="{escape(plot.heading)}">{legend(plot.charts)}'
        f'<div class="panels">{"".join(next(waiting) for _ in plot.charts)}</div></div>'
        for plot in plots
    ]
    once = "\n".join(f"<script>{text}</script>" for text in library)
    return f"{STYLE}\n{once}\n{script}", sections
