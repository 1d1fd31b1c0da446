"""Views of reduced bases: singular values, modes of separated bases, and clips."""

from __future__ import annotations

from typing import Any

import numpy as np
from bokeh.models import BasicTicker, LinearColorMapper, Range1d

from app.frame import Floats, Frame, Selection
from app.units import percent
from app.views.axis import whole
from app.views.colors import DISPLACEMENT, ERROR, LATIN, RANKS, REFERENCE, scaled
from app.views.parts import color_bar, hover
from app.views.view import ExtraView
from app.worker.cells import thinned
from app.worker.extras import MOST_MODES, MOST_SPECTRA, MOST_VALUES
from solver.files.amounts import unit_for
from solver.study.quantities.reduction_measures import can_be_clipped

SMALLEST = 1e-4
FEWEST = 8
"""Size over the largest one down to which singular values are shown, and the number of
them for which the axis has room in any case."""
MODES = [str(number) for number in range(MOST_MODES)]
LARGEST = 1_000_000
"""Number of values of a field up to which its clips are found: the worker takes no
order meanwhile (measured: 0.9 s for 1001 x 999)."""
FLOOR = 1e-6
SEEN = 1.6 * FLOOR
EXACT = 1e-9
"""Smallest error that is shown, that of a mark, and error up to which clips differ by
rounding."""
DOT = 7
"""Size of a value without a curve, px."""
STORED = {"SVD": LATIN, "PGD": DISPLACEMENT, "clips": ERROR}
"""Colours of the curves of `ClipErrors`, by the form of storage."""


class Spectra(ExtraView):
    """Singular values, a curve for each substructure; fast decay means few modes."""

    name = "Singular values"
    needs = frozenset({"spectra"})

    applies = staticmethod(lambda settings: settings.instants > 1)

    def make(self) -> None:
        """Draw the axes, the curves of all substructures and their colour bar."""
        plot = self.begin(
            ("mode",), ("size / largest",), y_axis_type="log", y_range=(SMALLEST, 2.0)
        )
        whole(plot.xaxis[0])
        self._colors = LinearColorMapper(palette=scaled(64), low=1, high=2)
        color = {"field": "part", "transform": self._colors}
        lines = self.add(
            "values", "MultiLine", "xs ys", also="part", color=color, width=1.8
        )
        # A curve of one value has no length.
        dots = self.add("alone", "Scatter", also="part", color=color, size=DOT)
        hover(plot, [lines, dots], {"mode": "$x{0}", "size": "$y{0.00e+0}"})
        ticker = BasicTicker(desired_num_ticks=4, min_interval=1, num_minor_ticks=0)
        self._bar = color_bar(plot, self._colors, ticker=ticker)

    def _show(self, spectra: Any, frame: Frame, selection: Selection) -> None:
        count = frame.run.n_substructures
        ys = [values[values > 0.1 * SMALLEST] for values in spectra]
        modes = np.arange(1.0, MOST_VALUES + 1.0, dtype=np.float32)
        lengths = [len(values) for values in ys]
        xs = [modes[:length] for length in lengths]
        parts = thinned(count, MOST_SPECTRA) + 1.0
        self.fill("values", xs=xs, ys=ys, part=parts)
        is_alone = np.equal(lengths, 1)
        sizes = [float(values[0]) for values in ys if len(values) == 1]
        self.fill("alone", x=np.ones(len(sizes)), y=sizes, part=parts[is_alone])
        title = "mode"
        if count > 1:
            title = "mode; the colour is the substructure"
        self.x.rename(title, "")
        # Values at the first mode are seen in full.
        limits = [1, max([FEWEST, *lengths])]
        self.x.hold(frame.run.number, limits, margin=0.02)
        self._bar.visible = count > 1
        self._colors.high = max(count, 2)


class ModePlot(ExtraView):
    """Curves of the largest modes, a colour for each rank."""

    needs = frozenset({"modes"})

    def make(self) -> None:
        """Draw a curve for each mode, and the selected instant."""
        self.begin(y=("value / largest",), y_range=Range1d(-1.12, 1.12))
        self.add("now", "VSpan", "x", color=ERROR, line_width=2)
        # The largest mode is added last, and so lies on top.
        ranked = list(zip(MODES, RANKS, strict=False))
        for mode, color in reversed(ranked):
            self.add(mode, color=color, width=2)
        self.legend(*MODES)


class SpaceModes(ModePlot):
    """Displacement modes along the selected substructure."""

    name = "Space modes"

    # Modes of plane bodies have no curve along x.
    applies = staticmethod(
        lambda given: given.applies("pgd_modes") and given.kind != "plane"
    )

    def _show(self, modes: Any, frame: Frame, selection: Selection) -> None:
        self.x.rename(f"x ({modes['text']})", "m")
        self.x.hold((frame.run.number, modes["substructure"]), modes["x"])
        titles = [str(rank) for rank in range(1, len(modes["space"]) + 1)]
        titles[:1] = ["mode 1"]
        self.draw_each(MODES, modes["x"], modes["space"], titles)


class TimeFunctions(ModePlot):
    """Normalised time functions of the modes; the legend shows their largest values."""

    name = "Time functions"

    applies = staticmethod(
        lambda settings: settings.applies("pgd_modes") and settings.instants > 1
    )

    def _show(self, modes: Any, frame: Frame, selection: Selection) -> None:
        run = frame.run
        self.x.rename(f"t (substructure {modes['substructure'] + 1})", "s")
        self.x.hold(run.number, run.instants)
        self.fill("now", x=self.x(run.instants[[run.column(selection.phase)]]))
        sizes = np.abs(modes["time"]).max(axis=1, initial=0.0)
        values = modes["time"] / np.where(sizes > 0.0, sizes, 1.0)[:, None]
        titles = []
        for size in sizes.tolist():
            titles.append(unit_for(size, "m")(size, 2))
        self.draw_each(MODES, run.instants, values, titles)


class ClipErrors(ExtraView):
    """Error of the friction of an iterate over the count of stored numbers."""

    name = "Clips"
    needs = frozenset({"clips"})

    applies = staticmethod(
        lambda given: (
            can_be_clipped(given) and 1 < given.instants <= LARGEST / given.n_nodes
        )
    )

    def make(self) -> None:
        """Draw a curve for each form of storage, and the size of the table."""
        plot = self.begin(
            ("numbers kept",), ("error",), x_axis_type="log", y_axis_type="log",
            x_range=(10.0, 1e5), y_range=(FLOOR, 1.0),
        )  # fmt: skip
        lines = []
        for name, color in STORED.items():
            lines.append(self.add(name, color=color, width=2.5))
        # The clips alone, without singular vectors of the rest.
        ring = {"line_color": ERROR, "line_width": 2.5, "fill_alpha": 0}
        lines.append(self.add("alone", "Scatter", size=11, **ring))
        # By this name the entry of the clips in the legend hides the ring, too.
        lines[-1].name = "clips"
        for name in ("SVD", "PGD"):
            # A form that is exact with its first vectors has a curve of one point.
            dots = self.add(f"first {name}", "Scatter", size=DOT, color=STORED[name])
            dots.name = name
            lines.append(dots)
        self.add(
            "table", "VSpan", "x", color=REFERENCE, line_dash="dashed", line_width=1.5
        )
        self.legend("SVD", "PGD", "clips", table="whole table")
        hover(plot, lines, {"numbers": "@x", "error": "@y"})

    def _show(self, clips: Any, frame: Frame, selection: Selection) -> None:
        table = float(clips["table"])
        size, error = clips["clips"][:, 0].tolist()
        exactness = percent(error)
        if error <= EXACT:
            exactness = "exact"
        titles = {"clips": f"clips, {clips['branches']} × 2 vectors: {exactness}"}
        counts = []
        for name in STORED:
            curve = np.zeros((2, 0))
            if clips[name] is not None:
                counts.append(clips[name][0])
                curve = _shown(clips[name])
            self.draw(name, *curve, titles.get(name, ""))
            if name != "clips":
                point = curve[:, : int(curve.shape[1] == 1)]
                self.draw(f"first {name}", point[0], np.maximum(point[1], SEEN))
        numbers = np.concatenate(counts)
        self.x.hold(frame.run.number, np.clip(numbers[numbers > 0], 1.0, 10.0 * table))
        # Clips that are exact have no curve, but the ring.
        self.show("clips", True)
        self.draw("alone", [max(size, 1.0)], [max(error, SEEN)])
        self.fill("table", x=[table])


def _shown(sizes: Floats) -> Floats:
    """Counts and errors, (2, n), from a count of 1 to the first negligible error."""
    stored = sizes[:, sizes[0] > 0]
    negligible = np.flatnonzero(stored[1] <= FLOOR)
    if len(negligible):
        stored = stored[:, : int(negligible[0]) + 1]
    return np.maximum(stored, np.array([[0.0], [FLOOR]], dtype=np.float32))
