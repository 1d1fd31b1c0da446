"""The path of a point between friction law and equilibrium; the whole field."""

from __future__ import annotations

from typing import Any

import numpy as np
from bokeh.events import Tap
from bokeh.models import GridBox
from bokeh.plotting import figure

from app.frame import LINEAR, LOCAL, Floats, Frame, Selection
from app.views.colors import ERROR, EXACT, REFERENCE, STAGES, STICK
from app.views.parts import hover
from app.views.view import ExtraView
from solver.arrays import Array
from solver.files.amounts import unit_for

ROOM = 0.08
"""Room at the ends of the axes, as a share of their length."""
FAINTEST = 0.35
"""Opacity of the oldest iterate."""
BEYOND = 3.0
"""Length of lines without end over that of the axes."""
RING = {"size": 16, "line_width": 2.5, "fill_alpha": 0}
"""Look of the ring about the newest stage."""
MARKERS = {LOCAL: "circle", LINEAR: "square"}


class Zigzag(ExtraView):
    """The path of a point at the selected instant: slip along x, friction along y.

    The local stage puts it on the graph of the friction law, along a line of slope k;
    the linear stage puts it in balance, along one of slope -k. Where the coarse problem
    or a mixture with earlier iterates moves it, too, its way is dashed. The law is that
    of the newest local stage at this instant: while it sticks the point stands where
    the instant before has left it.

    The line of balance goes through the solution, and before that is known through the
    newest linear stage. Its slope is the stiffness of the whole structure at this
    point, while all other contact forces stay as they are; it is level where contact
    alone holds a body. Iterates in balance lie beside it as long as other points move.

    Beside it are the friction forces of all points at this instant on the same scale;
    a tap chooses a point.
    """

    name = "Zigzag"
    needs = frozenset({"zigzag"})

    def make(self) -> None:
        """Draw the path of the point, and the field next to it."""
        self.beside = self._make_field()
        plot = self.begin(
            ("slip", "m"), ("friction force", "N/m"), y_range=self.beside.y_range
        )
        self.add("dead", "HStrip", "y0 y1", fill_color=STICK, alpha=0.15, line_alpha=0)
        self.add("bounds", "HSpan", "y", color=REFERENCE, line_width=1)
        self.add("graph", color=STAGES[LOCAL], width=5, alpha=0.45)
        self.add("line", color=STAGES[LINEAR], width=5, alpha=0.4)
        ways = {"along": "solid", "mixed": "dashed"}
        for name, dash in ways.items():
            self.add(
                name,
                "Segment",
                "x0 y0 x1 y1 line_alpha",
                color=REFERENCE,
                line_width=1.5,
                line_dash=dash,
            )
            # Without data, which have the opacity, a segment has no look of its own.
            self.add(f"{name} key", color=REFERENCE, width=1.5, dash=dash)
        points = []
        for stage, marker in MARKERS.items():
            look = {"marker": marker, "size": 7, "color": STAGES[stage]}
            columns = "x y fill_alpha line_alpha"
            points.append(self.add(stage, "Scatter", columns, also="iteration", **look))
        self.add("newest", "Scatter", "x y line_color", **RING)
        self.add("star", "Scatter", marker="star", size=18, color=EXACT)
        self.mark({"law": STAGES[LOCAL], "balance": STAGES[LINEAR]})
        titles = {
            "law": "law",
            "balance": "balance",
            "along key": "slope ±k",
            "mixed key": "coarse problem, too",
            "star": "solution",
        }
        self.legend(**titles)
        tips = {"iteration": "@iteration", "slip": "@x{0.00}", "force": "@y{0.00}"}
        hover(plot, points, tips)
        self._grid = GridBox(
            children=[(plot, 0, 0), (self.beside, 0, 1)],
            cols=["3fr", "2fr"],
            rows=["1fr"],
            sizing_mode="stretch_both",
        )

    @property
    def layout(self) -> GridBox:
        """The path of the point, and the field next to it."""
        self.figure  # noqa: B018  # both are made when it is first asked for
        return self._grid

    def _make_field(self) -> figure:
        """Make the figure of all points, with the y axis of the path."""
        plot = self.begin(("x", "m"), ("friction force", "N/m"))
        plot.yaxis.visible = False
        self.add("position", "VSpan", "x", color=ERROR, alpha=0.7, line_width=1)
        for stage in MARKERS:
            self.add(f"{stage} field", color=STAGES[stage], width=2)
        self.add("marked", "Scatter", "x y line_color", **RING)
        plot.on_event(Tap, self._select)
        self.across = self.x
        return plot

    def _select(self, event: Any) -> None:
        """Select the point at a tap."""
        self.state.select(position=self.across.si(event.x))

    def _show(self, extra: Any, frame: Frame, selection: Selection) -> None:
        column = frame.run.column(selection.phase)
        way = _Way(extra, column, selection.stage)
        if frame.residual is not None:
            way.newest = way.star
        self._scale(frame, extra, way, column)
        self._show_law(extra, way, column)
        self._show_way(way)
        self._show_field(extra, selection.stage, column)

    def _scale(self, frame: Frame, extra: Any, way: _Way, column: int) -> None:
        """Set the limits to law and solution, and to the iterates."""
        run = frame.run
        self.y.rename("friction force", "N/m")
        if run.settings.kind == "plane":
            self.y.rename("friction", "Pa")
        position = extra["position"]
        place = unit_for(float(np.abs(extra["x"]).max()), "m")(position)
        self.x.rename(f"slip at {place}", "m")
        slips, forces = way.points.T
        known_slip, known_force = way.star
        highest = max(float(extra["bound"].max()), abs(known_force))
        key = (run.number, position, column)
        self.x.hold(key, [0.0, known_slip], iterate=[slips], margin=ROOM)
        self.y.hold(key[:2], [-highest, highest], iterate=[forces], margin=ROOM)
        self.across.hold(key[:2], extra["x"])

    def _show_law(self, extra: Any, way: _Way, column: int) -> None:
        """Show bounds, graph of the law, solution, and line of equilibrium."""
        bound = float(extra["bound"][column])
        slider = float(extra["slider"][column])
        width, height = self._spans()
        self.fill("dead", y0=self.y([-bound]), y1=self.y([bound]))
        self.fill("bounds", y=self.y([-bound, bound]))
        give = extra["soft"] * bound
        self.draw(
            "graph",
            [slider - width, slider - give, slider + give, slider + width],
            [bound, bound, -bound, -bound],
        )
        star = np.zeros((2, 0))
        if extra["star"] is not None:
            star = np.array([way.star]).T
        self.draw("star", *star)
        line = np.zeros((2, 0))
        if extra["balance"] is not None:
            through = way.points[-1]
            if star.size:
                through = way.star
            slope = extra["balance"]
            reach = min(width, height / max(slope, height / width))
            step = np.array([reach, reach * slope])
            line = np.stack([through - step, through + step], axis=1)
        self.draw("line", *line)

    def _spans(self) -> tuple[float, float]:
        """Lengths of unbounded lines, in SI."""
        spans = []
        for axis, limits in (
            (self.x, self.figure.x_range),
            (self.y, self.figure.y_range),
        ):
            spans.append(BEYOND * axis.si(limits.end - limits.start))
        return spans[0], spans[1]

    def _show_way(self, way: _Way) -> None:
        """Show the iterates of both stages, and the steps between them."""
        for stage, points in way.stages.items():
            alpha = np.linspace(FAINTEST, 1.0, len(points))
            self.fill(
                stage,
                x=self.x(points[:, 0]),
                y=self.y(points[:, 1]),
                fill_alpha=alpha,
                line_alpha=alpha,
                iteration=way.iterations[: len(points)],
            )
        for name, steps, alpha in way.segments():
            self.fill(
                name,
                x0=self.x(steps[:, 0, 0]),
                y0=self.y(steps[:, 0, 1]),
                x1=self.x(steps[:, 1, 0]),
                y1=self.y(steps[:, 1, 1]),
                line_alpha=alpha,
            )
            self.show(f"{name} key", len(steps) > 0)
        self.fill(
            "newest",
            x=self.x(way.newest[:1]),
            y=self.y(way.newest[1:]),
            line_color=[STAGES[way.stage]],
        )

    def _show_field(self, extra: Any, stage: str, column: int) -> None:
        """Show the field of each stage, if already computed, and mark the point."""
        x = extra["x"]
        local, linear = extra["fields"][:, :, column]
        self._along("local field", x, local)
        if stage == LOCAL:
            self._along("linear field", [], [])
        else:
            self._along("linear field", x, linear)
        shown = {LOCAL: local, LINEAR: linear}[stage]
        position = extra["position"]
        self.fill("position", x=self.across([position]))
        nearest = int(np.abs(x - position).argmin())
        self.fill(
            "marked",
            x=self.across([position]),
            y=self.y(shown[[nearest]]),
            line_color=[STAGES[stage]],
        )

    def _along(self, name: str, x: Any, force: Any) -> None:
        """Draw forces over positions, shape (n,) each, SI, in the field."""
        self.fill(name, x=self.across(x), y=self.y(force))


class _Way:
    """The iterates of a point at one instant, up to a stage of the newest.

    `iterations` are their numbers, `stages` slip and force in SI by stage, (n, 2) each,
    `points` all of them, `newest` the last one, of a `stage`, and `star` the solution,
    (2,), 0 while it is not known.
    """

    def __init__(self, extra: Any, column: int, stage: str) -> None:
        self.iterations: list[int] = extra["iterations"]
        self._straight = extra["straight"][:, :, column]
        self.star = np.zeros(2)
        if extra["star"] is not None:
            self.star = extra["star"][:, column].astype(float)
        self.stages: dict[str, Floats] = {
            name: extra[name][:, :, column] for name in MARKERS
        }
        if stage == LOCAL:
            self.stages[LINEAR] = self.stages[LINEAR][:-1]
        every = np.concatenate(list(self.stages.values()))
        self.points = every[np.isfinite(every).all(axis=1)].astype(float)
        self.newest = self.stages[stage][-1]
        self.stage = stage

    def segments(self) -> list[tuple[str, Array, Array]]:
        """Steps along k, and others: name, both ends, (n, 2, 2), and opacity, (n,)."""
        local = self.stages[LOCAL]
        linear = self.stages[LINEAR]
        opacity = np.linspace(FAINTEST, 1.0, len(local))
        follows = np.diff(self.iterations) == 1
        up = np.stack([linear[: len(local) - 1], local[1:]], axis=1)[follows]
        down = np.stack([local[: len(linear)], linear], axis=1)
        ends = np.concatenate([up, down])
        alpha = np.concatenate([opacity[1:][follows], opacity[: len(linear)]])
        is_along = np.concatenate(
            [self._straight[1:, 0][follows], self._straight[: len(linear), 1]]
        )
        # The start has no local stage before it.
        is_there = np.isfinite(ends).all(axis=(1, 2))
        found = []
        ways = {"along": is_there & is_along, "mixed": is_there & ~is_along}
        for name, is_shown in ways.items():
            found.append((name, ends[is_shown], alpha[is_shown]))
        return found
