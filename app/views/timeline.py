"""The load path as a time line, along which the instant is dragged."""

from __future__ import annotations

from collections import Counter
from itertools import zip_longest
from typing import Any

import numpy as np
from bokeh.events import Pan, Tap
from bokeh.models import CustomJS, PanTool

from app.frame import Frame, Run, Selection
from app.views.acts import unit_of
from app.views.colors import ERROR, FORCE, UNSEEN
from app.views.layout import is_equal, is_opposite
from app.views.parts import bare
from app.views.view import View
from solver.arrays import Array
from solver.discrete.structure import Act, Description
from solver.files.amounts import Unit, number, unit_for

PATHS = {"first": FORCE, "second": "#7A7A7A", "third": "#A0A0A0", "fourth": "#56B4E9"}
"""Colours of the paths; further paths are not drawn."""
FARTHEST = 1.6
"""Ends of the axis up: paths lie between -1 and 1."""
MARK = "legend.change.emit()"
"""Script that has a legend painted. Bokeh makes its entries anew where one changes, and
leaves their marks blank until something else in the figure is painted: of a run whose
paths are those of the last one but for their sizes only the words change."""


class Timeline(View):
    """Load paths over time, relative to their largest values, and the instant."""

    name = "Load path"

    def make(self) -> None:
        """Draw the paths, and follow the pointer along them."""
        plot = bare(40, (-0.01, 1.01), (-FARTHEST, FARTHEST))
        self._figure = plot
        self._number = 0
        axis = plot.xaxis
        axis.major_label_standoff = 1
        axis.axis_line_alpha = 0.4
        axis.major_tick_out = 3
        axis.major_tick_in = 0
        axis.minor_tick_line_alpha = 0.0
        self.add("area", "VArea", "x y2", y1=0, color=FORCE, alpha=0.16)
        self.add("paths", "MultiLine", "xs ys line_color line_width")
        self.add("instant", "VSpan", "x", color=ERROR, alpha=0.5)
        self.add("now", "Scatter", color=FORCE, size=11)
        self.mark(PATHS | {"time": UNSEEN})
        box = self.legend(*PATHS, "time")
        mark = CustomJS(args={"legend": box}, code=MARK)
        for item in box.items:
            # Names of paths come with a run.
            item.visible = False
            item.js_on_change("label", mark)
            item.js_on_change("visible", mark)
        # As the range has bounds, the tool pans nothing. It only keeps a touch from
        # scrolling the page.
        plot.add_tools(PanTool(dimensions="width"))
        for event in (Pan, Tap):
            plot.on_event(event, self._select)

    def update(self, frame: Frame, selection: Selection, ghost: Frame | None) -> None:
        """Show the load paths of a run, and the instant."""
        run = frame.run
        if run.number != self._number:
            self._number = run.number
            self._show_paths(run)
        column = run.column(selection.phase)
        area = self.sources["area"].data
        self.fill("instant", x=[area["x"][column]])
        self.fill("now", x=[area["x"][column]], y=[area["y2"][column]])

    def _show_paths(self, run: Run) -> None:
        """Show the paths of a run over time; they stay until the next run."""
        unit = unit_for(float(run.instants[-1]), "s")
        times = np.float32(run.instants / unit.factor)
        ends = -0.01 * float(times[-1]), 1.01 * float(times[-1])
        # The bounds first: the browser moves ends that lie outside of them.
        self.figure.x_range.update(bounds=ends, start=ends[0], end=ends[1])
        paths = paths_of(run)[: len(PATHS)]
        heights = []
        for _, values in paths:
            largest = np.abs(values).max(initial=0.0) or 1.0
            heights.append(np.float32(values / largest))
        # The first path is the last line, which lies on top, and the widest one.
        count = len(paths)
        self.fill(
            "paths",
            xs=[times] * count,
            ys=heights[::-1],
            line_color=list(PATHS.values())[:count][::-1],
            line_width=[1.4] * (count - 1) + [2.0],
        )
        self.fill("area", x=times, y2=heights[0])
        titles = [title for title, _ in paths]
        for path, title in zip_longest(PATHS, titles, fillvalue=""):
            self.show(path, title, may_come_back=False)
        # On a phone the names of more than two paths fill the line.
        time = ""
        if count <= 2 or not self.state.is_narrow:
            time = f"t in {unit.name}"
        self.show("time", time)

    def _select(self, event: Any) -> None:
        """Select the instant under the pointer."""
        end = self.figure.x_range.end / 1.01
        if self.state.frame is not None:
            self.state.select(phase=min(max(event.x / end, 0.0), 1.0))


def paths_of(run: Run) -> list[tuple[str, Array]]:
    """Title with range, and values, (n_instants,), of all paths; constant ones last."""
    description = run.geometry.description
    changing = []
    constant = []
    for symbol, values, unit in given_in(description):
        # Adding 0 takes the sign from a zero.
        low = float(values.min()) + 0.0
        high = float(values.max()) + 0.0
        path = np.interp(run.instants, description.instants, values)
        if high - low > 1e-6 * max(abs(low), abs(high)):
            text = f"{number(low / unit.factor)} to {unit(high)}"
            changing.append((f"{symbol} = {text}", path))
        else:
            constant.append((f"{symbol} = {unit(high)}", path))
    if not changing and not constant:
        return [("nothing acts", np.zeros(len(run.instants)))]
    return [*changing, *constant]


def given_in(description: Description) -> list[tuple[str, Array, Unit]]:
    """Symbol, values, (n_given,), and unit of the tilt and of each load.

    The same pressure from both sides is a single load, as are equal loads of bodies of
    any shape; a load that varies along a side has its largest values. Symbols of
    several loads have their place beside them.
    """
    given: list[tuple[str, Array, Unit]] = []
    if description.tilt is not None:
        given.append(("slope", np.degrees(description.tilt), Unit("°")))
    acts: list[Act] = []
    for act in description.acts:
        if not any(is_opposite(act, other) or is_equal(act, other) for other in acts):
            acts.append(act)
    counts = Counter(act.symbol for act in acts)
    for act in acts:
        symbol = act.symbol
        if counts[symbol] > 1:
            symbol = f"{symbol} ({_place(act)})"
        values = act.values
        if values.ndim > 1:
            values = values[np.abs(values).max(axis=1).argmax()]
        given.append((symbol, values, unit_of(act)))
    return given


def _place(act: Act) -> str:
    """Name of the side or body where a load acts, without its direction or number."""
    place = act.where
    for end in (" along ", " on "):
        place = place.partition(end)[0]
    return place.removesuffix(" x").removesuffix(" y")
