"""The largest modes of one substructure's separated basis, in space and in time."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from bokeh.models import ColumnDataSource, Range1d, Span

from app.views.drawing import (
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    PURPLE,
    VERMILION,
    Picture,
    decimal_scale,
    empty,
    make_figure,
    set_range,
)
from app.views.legend import Key
from app.worker.shown import Bases, ShownModes
from solver.scenes.plane import PlaneSettings
from solver.settings import Settings

RANK_COLORS = (BLUE, ORANGE, GREEN, PURPLE, GREY)
MARGIN = 1.12


class SpaceModes:
    """Displacement modes along the chosen substructure, dashed when just born."""

    name = "PGD space modes"
    watches = "modes"
    keys: Sequence[Key] = ()

    def __init__(self) -> None:
        self.figure = make_figure(
            "Position x (m)",
            "Displacement / largest",
            x_range=Range1d(0, 1),
            y_range=Range1d(-MARGIN, MARGIN),
        )
        self._lines = _lines(self.figure)

    def applies(self, settings: Settings) -> bool:
        """Only separated bases have modes, and only those of wires are curves."""
        return settings.is_reduced and not isinstance(settings, PlaneSettings)

    def draw(self, picture: Picture) -> None:
        """Draw the modes of the shown iterate."""
        bases = _bases(picture)
        if bases is None or bases.modes is None:
            return
        modes = bases.modes
        _put(self._lines, modes.positions, modes.space_modes, modes)
        # A substructure of one element may rub at one point only.
        set_range(self.figure.x_range, float(modes.positions[0]), float(modes.positions[-1]))
        self.keys = (
            Key(GREY, "bare", f"substructure {bases.substructure + 1}"),
            Key(GREY, "bare", news(modes)),
        )


class TimeFunctions:
    """The time functions of the same modes, each over its largest value, which the legend tells."""

    name = "PGD time functions"
    watches = "modes"
    keys: Sequence[Key] = ()

    def __init__(self) -> None:
        self.figure = make_figure(
            "Time t (s)",
            "Time function / largest",
            x_range=Range1d(0, 1),
            y_range=Range1d(-MARGIN, MARGIN),
        )
        self._lines = _lines(self.figure)
        self._instant = Span(location=0, dimension="height", line_color=VERMILION, line_width=2)
        self.figure.add_layout(self._instant)

    def applies(self, settings: Settings) -> bool:
        """Only separated bases have time functions, and one instant makes no function."""
        return settings.is_reduced and bool(settings.values()["instants"] > 1)

    def draw(self, picture: Picture) -> None:
        """Draw the time functions of the shown iterate."""
        bases, begun = _bases(picture), picture.run.begun
        if bases is None or bases.modes is None or begun is None:
            return
        modes, instants = bases.modes, begun.instants
        sizes = np.abs(modes.time_functions).max(axis=1, initial=0.0)
        scaled = modes.time_functions / np.where(sizes > 0.0, sizes, 1.0)[:, None]
        _put(self._lines, instants, scaled, modes)
        set_range(self.figure.x_range, float(instants[0]), float(instants[-1]))
        time = float(instants[picture.instant])
        if self._instant.location != time:
            self._instant.location = time
        self.keys = tuple(
            Key(color, "line", _length(float(size)))
            for color, size in zip(RANK_COLORS, sizes, strict=False)
        )


def news(modes: ShownModes) -> str:
    """Say in words what the iteration did to the basis, in a form whose length hardly changes."""
    counted = "1 mode" if modes.record.modes == 1 else f"{modes.record.modes} modes"
    return f"{counted}, {modes.record.added} added, {modes.lost} dropped"


def _bases(picture: Picture) -> Bases | None:
    frame = picture.frame
    return frame.bases if frame is not None and frame.ticket == picture.run.ticket else None


def _lines(figure: Any) -> ColumnDataSource:
    source = empty("xs", "ys", "color", "dash")
    figure.multi_line(
        "xs", "ys", source=source, line_color="color", line_dash="dash", line_width=2.5
    )
    return source


def _put(source: ColumnDataSource, along: np.ndarray, lines: np.ndarray, modes: ShownModes) -> None:
    """Draw lines coloured by rank, the largest mode on top."""
    order = range(len(lines))[::-1]
    source.data = {
        "xs": [along] * len(lines),
        "ys": [lines[rank] for rank in order],
        "color": [RANK_COLORS[rank] for rank in order],
        "dash": ["dashed" if modes.born[rank] else "solid" for rank in order],
    }


def _length(size: float) -> str:
    factor, unit = decimal_scale(size, "m")
    return f"{size / factor:.2g} {unit}" if size < 99.5 * factor else f"{size / factor:.0f} {unit}"
