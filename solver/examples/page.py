"""A view on a page, updated by iterations: `panel serve page.py --show` opens it."""

import numpy as np
import panel as pn
from bokeh.models import ColumnDataSource
from bokeh.plotting import figure

from solver import End, Latin, Rods, discretise, iterations
from solver.latin import Iterate, Paper

PEAK = 900.0
STIFFNESS = 1e6
STRENGTH = 1500.0
"""Largest load, N; E S, N; friction, N/m."""
TIMES = np.linspace(0.0, 1.0, 41)
FORCE = PEAK * TIMES
EXACT = 1e3 * FORCE**2 / (2.0 * STIFFNESS * STRENGTH)
"""Displacement of the end over time, mm."""

BAR = Rods(
    length=1.0,
    stiffness=STIFFNESS,
    elements=50,
    substructures=10,
    strength=np.full(51, STRENGTH),
    left=End(displacement=0.0 * TIMES),
    right=End(force=FORCE),
    instants=TIMES,
    duration=1.0,
)


class LoopView:
    """Force over the end's displacement of an iterate; dashed, of the closed form."""

    def __init__(self) -> None:
        self.source = ColumnDataSource({"x": 0.0 * TIMES, "y": FORCE})
        self.figure = figure(x_axis_label="displacement, mm", y_axis_label="force, N")
        self.figure.line(EXACT, FORCE, color="gray", line_dash="dashed")
        self.figure.line("x", "y", source=self.source)

    def update(self, iterate: Iterate) -> None:
        """Show an iterate."""
        self.source.data = {"x": 1e3 * iterate.displacement[-1], "y": FORCE}
        self.figure.title.text = f"iteration {iterate.number}"


view = LoopView()
run = iterations(
    discretise(BAR), Latin(direction=Paper(), acceleration=None, finish=None)
)


def step() -> None:
    """Do one iteration."""
    view.update(next(run))


if __name__ == "__main__":  # as a program it prints what the page comes to
    for _ in range(100):
        step()
    print("ratio to exact:", view.source.data["x"][-1] / EXACT[-1])
else:
    pn.state.add_periodic_callback(step, period=200, count=100)
    content = pn.Column("# A bar is pulled", pn.pane.Bokeh(view.figure))
    content.servable(title="A bar is pulled")
