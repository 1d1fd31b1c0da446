"""What a view is: a Bokeh figure made once, and an update from a frame."""

from __future__ import annotations

from functools import cached_property
from typing import Any, ClassVar

from bokeh.models import ColumnDataSource, GlyphRenderer, Legend
from bokeh.plotting import figure

from app.frame import Frame, Selection
from app.state import PageState
from solver.settings import Settings

TOOLS = "pan,box_zoom,wheel_zoom,reset,hover,crosshair,save,fullscreen"


class View:
    """A figure, made when it is first seen.

    Parameters
    ----------
    state
        Of the page; what is done in the figure, as a tap, selects there.

    Attributes
    ----------
    name
        What its tab is called.
    needs
        Names of the extras of a frame that it shows.
    """

    name: ClassVar[str]
    needs: ClassVar[frozenset[str]] = frozenset()

    def __init__(self, state: PageState) -> None:
        self.state = state

    @staticmethod
    def applies(settings: Settings) -> bool:  # noqa: ARG004  # most say something of any
        """Whether it says anything about such a run."""
        return True

    @cached_property
    def figure(self) -> figure:
        """The figure."""
        return self.make()

    def make(self) -> figure:
        """A new figure, with the sources that `update` fills."""
        raise NotImplementedError

    def update(self, frame: Frame, selection: Selection, ghost: Frame | None) -> None:
        """Show a frame; the ghost is that of the run that it is compared with."""
        raise NotImplementedError


def plot(x: str, y: str, **more: Any) -> figure:
    """A figure with the look that all plots share."""
    made = figure(
        x_axis_label=x,
        y_axis_label=y,
        sizing_mode="stretch_both",
        min_height=120,
        tools=TOOLS,
        active_drag=None,
        **more,
    )
    made.toolbar.autohide, made.toolbar.logo = True, None
    made.min_border = 4
    made.outline_line_color = None
    for axis in made.axis:
        axis.axis_label_text_font_size = axis.major_label_text_font_size = "11px"
        axis.axis_label_text_font_style = "normal"
        axis.axis_label_standoff, axis.major_label_standoff = 4, 3
    made.grid.grid_line_alpha = 0.4
    return made


def source(*columns: str) -> ColumnDataSource:
    """An empty source."""
    return ColumnDataSource({name: [] for name in columns})


def legend(made: figure, entries: dict[str, list[GlyphRenderer]]) -> Legend:
    """A legend in one line above the plot, where it covers no curve; a click hides a curve."""
    box = Legend(
        items=list(entries.items()),
        orientation="horizontal",
        label_text_font_size="11px",
        padding=0,
        margin=0,
        spacing=8,
        border_line_alpha=0,
        background_fill_alpha=0,
        glyph_height=12,
        label_height=12,
        click_policy="hide",
    )
    made.add_layout(box, "above")
    return box
