"""Views: a Bokeh figure that is made once, and updated from frames."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cached_property
from itertools import zip_longest
from typing import Any, ClassVar

import numpy as np
import panel as pn
from bokeh import models
from bokeh.core.properties import validate, value
from bokeh.events import LegendItemClick
from bokeh.models import (
    AllIndices,
    ColorBar,
    ColumnDataSource,
    CrosshairTool,
    CustomJS,
    Glyph,
    GlyphRenderer,
    Legend,
    LegendItem,
    NoOverlap,
    Range1d,
    Scatter,
    Title,
    UnionRenderers,
)
from bokeh.plotting import figure
from bokeh.settings import settings
from numpy.typing import ArrayLike

from app.frame import Floats, Frame, Selection
from app.state import PageState
from app.views.axis import Axis
from app.views.colors import CUT, FLAG, PAPER
from app.views.flags import Place, curves_of, place_off
from app.views.parts import LEAST, visuals
from solver.settings.scene import Settings

TOOLS = "pan,wheel_zoom,reset,save,fullscreen"
SHORT = 200
"""Length of a curve up to which it is sent as a list: faster there than an array."""
TEXT = "12px"
WORDS = "14px"
"""Type sizes of plots, and of words at arrows, as CSS has them."""
WIDTH = 380.0
HEIGHT = 160.0
"""Size of a plot until the browser reports its own, px."""
LETTER = 0.56
ROW = 1.3
"""Width of a letter and height of a line of words over their type size, about."""
TICKS = 6
FEW_TICKS = 3
"""Number of ticks up an axis that have room, and those in large type."""
FONT = value("Roboto, sans-serif")
"""The page's font, for texts that are drawn in plots."""
KEEP = "if (cb_obj.tags.length) { cb_obj.setv(cb_obj.tags[0]) }"
"""Script that keeps sizes that are not the theme's: the browser sets those of the theme
as it draws a figure."""
ABOVE = {"margin-left": "-52px", "top": "-1px"}
"""Style of a legend that begins at the left end of the figure."""
CLOSE = """
.bk-grid { gap: 6px 5px !important; }
.bk-item { gap: 4px !important; }
.bk-item .bk-label { min-width: 0 !important; }
"""
"""Style sheet by which a legend of seven entries stands in one line; the theme keeps
entries farther apart."""
FLOWING = """
.bk-grid {
  display: flex !important;
  flex-wrap: wrap;
  width: auto !important;
  gap: 0 5px !important;
}
:host(.column) .bk-grid { flex-direction: column; gap: 6px !important; }
"""
"""Style sheet by which the entries of a legend follow each other, and take a second
line where the first has no room; or stand below each other."""
WRAPPED = ":host { width: calc(100% + 52px); }"
"""Style sheet of a legend above a plot, which is as wide whatever its entries are: a
figure is painted once more when the size of its legend changes."""


HIDE = """
const [shown] = cb_obj.item.renderers
const is_mark = shown.name == null
const others = (each) => each.name == shown.name && each != shown
const hidden = is_mark ? [shown] : plot.renderers.filter(others)
for (const each of hidden) each.visible = !each.visible
"""
"""Script that hides the glyph whose copy in the legend is clicked, or shows it again;
marks stay as they are."""

INSPECT = """
const view = Bokeh.index.find_one(cb_obj)
const turn = () => {
  for (const tool of cb_obj.toolbar.inspectors) { tool.active = !cb_obj.hold_render }
  view?.repainted.disconnect(turn)
}
if (cb_obj.hold_render) { turn() } else { view?.repainted.connect(turn) }
"""
"""Script that has a figure show what is under the pointer once it is painted, and not
while it waits: what it draws has no place on the screen before."""


class View:
    """A view: a figure, made when first visible, below a legend of its curves.

    A second figure may stand `beside` it.

    A click on an entry of the legend hides its curve. A tap or a drag in the figure
    selects in the state of the page. `x` and `y` are the axes, `sources` the data of
    the glyphs, by name.
    """

    name: ClassVar[str]
    """Title of the view's tab."""
    needs: ClassVar[frozenset[str]] = frozenset()
    """Names of the extras of a frame that the view shows."""
    applies: ClassVar[Callable[[Settings], bool]] = staticmethod(lambda settings: True)
    """Check whether the view applies to a run with some settings."""

    def __init__(self, state: PageState) -> None:
        self.state = state
        self._type = TEXT
        self._figure: figure | None = None
        self.beside: figure | None = None
        self.is_held = False
        self.sources: dict[str, ColumnDataSource] = {}
        self._size: dict[str, float] = {}
        self._items: dict[str, LegendItem] = {}

    @cached_property
    def figure(self) -> figure:
        """The figure, made by `make`."""
        # In no source anything is selected or filtered: all share these models, as each
        # model costs time.
        self._selects = {
            "selected": models.Selection(),
            "selection_policy": UnionRenderers(),
        }
        self._filter = AllIndices()
        # Bokeh checks each value, and each default that it replaces, if it checks
        # documents (`lighten`, `server.py`): a third of the time of a figure.
        with validate(settings.perform_document_validation()):
            self.make()
        self._figure.html_attributes = {"role": "figure", "aria-label": self.name}
        # A size that was asked for before there was a figure.
        size = self._type
        self._type = TEXT
        self.magnify(size)
        return self._figure

    @property
    def layout(self) -> Any:
        """The figure for a card: alone, or laid out with another one."""
        return self.figure

    def follow_size(self, width: float, height: float) -> None:
        """Follow the size of the figure, px, and begin with a size."""
        self.lay_out(width, height)
        for name in self._size:
            self._figure.on_change(name, self._resize)

    def lay_out(self, width: float, height: float) -> None:
        """Lay out what is drawn for a size of the figure, px."""
        self._size = {"inner_width": width, "inner_height": height}

    def _resize(self, name: str, old: float, new: float) -> None:
        # A figure that is out of sight reports a size of zero.
        self._size[name] = max(float(new), LEAST)

    def hold(self, is_held: bool) -> None:
        """Hold back all painting of the figures, or resume it."""
        self.is_held = is_held
        for plot in (self._figure, self.beside):
            if plot is not None:
                plot.hold_render = is_held
                # From then on `INSPECT` says when they look for what is under the
                # pointer.
                plot.toolbar.active_inspect = None

    def magnify(self, size: str) -> None:
        """Set the type size of all figures, as CSS has it."""
        is_same = size == self._type
        self._type = size
        if is_same or self._figure is None:
            return
        self._magnify(self._figure)
        if self.beside is not None:
            self._magnify(self.beside)

    def _magnify(self, plot: figure) -> None:
        """Set the type size of a figure."""
        magnify(plot, self._type, self.words)

    @property
    def type_size(self) -> float:
        """Type size of the figure, px."""
        return float(self._type.removesuffix("px"))

    @property
    def words(self) -> str:
        """Type size of words at arrows, as CSS has it."""
        return WORDS if self._type == TEXT else self._type

    def make(self) -> None:
        """Make the figure, by `begin` and `add`; each view overrides it."""
        raise NotImplementedError

    def update(self, frame: Frame, selection: Selection, ghost: Frame | None) -> None:
        """Show a frame; the ghost is the frame of the run that it is compared with."""
        raise NotImplementedError

    @property
    def ghost_name(self) -> str:
        """Name of the run that is compared with the present one."""
        return "last run" if self.state.pinned is None else "pinned run"

    def add_flag(self) -> None:
        """Add the mark of the known number of a case, which `show_flag` places."""
        self.add("level", "HSpan", "y", color=FLAG, line_dash="dashed", line_width=1.5)
        look = {"marker": "inverted_triangle", "size": 12, "color": FLAG}
        self.add("flag", "Scatter", "x y", **look)
        self._flag_text = self.add(
            "flag text",
            "Text",
            "x y text text_align text_baseline y_offset",
            text_color=FLAG,
            text_font_style="bold",
            text_font_size=self.words,
            # What it lies on, where no place is free, is to be read through.
            background_fill_alpha=0.75,
        )
        self._flagged: Frame | None = None
        self.follow_size(WIDTH, HEIGHT)
        for name in self._size:
            self._figure.on_change(name, lambda attr, old, new: self._move_flag())

    def _move_flag(self) -> None:
        """Place the name of the flag again, in a figure of another size."""
        # Before it was shown the axes have no limits.
        if self._flagged is not None:
            with pn.io.hold():
                self.show_flag(self._flagged)

    def show_flag(self, frame: Frame) -> None:
        """Mark the known number of the case if it stands in this plot."""
        self._flagged = frame
        case = self.state.trade_case
        flag = None
        if case is not None and case.knows(frame.run.settings):
            flag = case.flag
        if flag is None or flag.plot != self.name:
            for name in ("level", "flag", "flag text"):
                self.fill(name, **{key: [] for key in self.sources[name].data})
            return
        x = float(self.x(flag.x))
        y = float(self.y(flag.y))
        # Any x: a line.
        levels = []
        marks = [(x, y)]
        if math.isnan(x):
            levels = [y]
            marks = []
        self.fill("level", y=levels)
        self.fill("flag", x=[at[0] for at in marks], y=[at[1] for at in marks])
        place = self._place_of_flag(flag.text, x, y)
        start, end = _limits(self._figure.x_range)
        across = start + place.x / self._size["inner_width"] * (end - start)
        self.fill(
            "flag text",
            x=[across],
            y=[y],
            text=[flag.text],
            text_align=[place.text_align],
            text_baseline=[place.text_baseline],
            y_offset=[place.y_offset],
        )
        paper = PAPER[self.state.is_dark]
        self._flag_text.glyph.background_fill_color = paper

    def _place_of_flag(self, text: str, x: float, y: float) -> Place:
        """Place of the name of a flag at a point in units of the axes.

        At x NaN it names a line.
        """
        room = np.array([*self._size.values()])
        across = _limits(self._figure.x_range)
        up = _limits(self._figure.y_range)
        low = np.array([across[0], up[0]])
        at = (np.array([x, y]) - low) / ([across[1], up[1]] - low) * room
        anchors = [(at[0], "left"), (at[0], "right"), (at[0], "center")]
        if at[0] > 0.5 * room[0]:
            anchors = [(at[0], "right"), (at[0], "left"), (at[0], "center")]
        if math.isnan(x):
            width = float(room[0])
            anchors = [(0.0, "left"), (width, "right"), (0.5 * width, "center")]
        letters = np.array([LETTER * len(text), ROW])
        size = float(self.words.removesuffix("px")) * letters
        curves = curves_of(self._figure, across, up, room)
        return place_off(curves, anchors, float(at[1]), size, room)

    def begin(
        self, x: tuple[str, ...] = ("",), y: tuple[str, ...] = ("",), **more: Any
    ) -> figure:
        """A new figure whose axes have a title and an SI unit; `add` fills it."""
        ranges = {"x_range": Range1d(0, 1), "y_range": Range1d(0, 1)}
        plot = figure(
            sizing_mode="stretch_both",
            min_height=120,
            # It stands nearer than the label of an axis, which the theme moves away.
            title=Title(align="center", standoff=2),
            title_location="below",
            tools=TOOLS,
            active_drag=None,
            active_scroll="wheel_zoom",
            **(ranges | more),
        )
        plot.add_tools(CrosshairTool(line_color=CUT, line_alpha=0.5))
        plot.js_on_change("hold_render", CustomJS(code=INSPECT))
        plot.toolbar.autohide = True
        plot.toolbar.logo = None
        plot.min_border = 2
        plot.min_border_right = 10
        plot.outline_line_color = None
        plot.axis.major_label_standoff = 3
        plot.axis.minor_tick_line_color = None
        plot.axis.major_tick_in = 0
        plot.axis.major_tick_out = 3
        # In a small plot, or in large type, numbers would lie on each other.
        plot.axis.major_label_policy = NoOverlap()
        plot.grid.grid_line_alpha = 0.3
        self._figure = plot
        self.x = Axis(plot, "x", *x)
        self.y = Axis(plot, "y", *y)
        return plot

    def add(
        self,
        name: str,
        glyph: str = "Line",
        columns: str = "x y",
        *,
        also: str = "",
        on: str = "",
        **look: Any,
    ) -> GlyphRenderer:
        """Add a glyph of Bokeh, with a name for `fill` and `legend`.

        `columns` are the columns of its source, called as properties of the glyph;
        `also` are further ones, for tips or other glyphs. The source is called as the
        glyph, or `on`, which several glyphs may share.
        """
        kind = getattr(models, glyph)
        fields = columns.split()
        source_name = on or name
        if source_name not in self.sources:
            empty = {column: [] for column in (*fields, *also.split())}
            self.sources[source_name] = self._source(empty)
        look = {column: column for column in fields} | look
        if glyph == "Text":
            look["text_font"] = FONT
        drawn = kind(**visuals(kind, look))
        return self._render(self.sources[source_name], drawn, name)

    def _render(
        self, source: ColumnDataSource, glyph: Glyph, name: str | None = None
    ) -> GlyphRenderer:
        renderer = self._figure.add_glyph(
            source,
            glyph,
            name=name,
            # By default Bokeh makes further glyphs for selections, which none here has.
            selection_glyph=None,
            nonselection_glyph=None,
            muted_glyph=None,
        )
        # In the renderer's own view: Bokeh makes that even where another is given.
        renderer.view.filter = self._filter
        return renderer

    def _source(self, columns: dict[str, Any]) -> ColumnDataSource:
        return ColumnDataSource(columns, **self._selects)

    def mark(self, colors: Mapping[str, str], **look: Any) -> None:
        """Add marks to the legend only, by name.

        The marks share a glyph, as each glyph costs time.
        """
        nowhere = [np.nan] * len(colors)
        columns = {"x": nowhere, "y": nowhere, "color": list(colors.values())}
        look = {"marker": "square", "size": 10, "color": "color"} | look
        marks = self._render(self._source(columns), Scatter(**visuals(Scatter, look)))
        for index, name in enumerate(colors):
            self._items[name] = LegendItem(renderers=[marks], index=index)

    def legend(self, *names: str, place: str = "above", **titles: str) -> Legend:
        """Name glyphs in a legend, in this order, by their names or by titles.

        The legend shows copies of them without data, as Bokeh makes it again whenever
        the data of a glyph in it change.
        """
        titles = {name: name for name in names} | titles
        # Of glyphs of one name the first.
        drawn: dict[str, GlyphRenderer] = {}
        columns: dict[str, list[float]] = {}
        for renderer in self._figure.renderers:
            if renderer.name in titles:
                drawn.setdefault(renderer.name, renderer)
        for renderer in drawn.values():
            columns |= {column: [np.nan] for column in renderer.data_source.data}
        nowhere = self._source(columns)
        for name, renderer in drawn.items():
            copy = self._render(nowhere, renderer.glyph, name)
            self._items[name] = LegendItem(renderers=[copy])
        for name, title in titles.items():
            self._items[name].label = value(title)
        box = legend(self._figure, [self._items[name] for name in titles], place)
        box.click_policy = "hide"
        hide = CustomJS(args={"plot": self._figure}, code=HIDE)
        box.js_on_event(LegendItemClick, hide)
        return box

    def show(
        self, name: str, wanted: bool | str, *, may_come_back: bool = True
    ) -> None:
        """Show or hide an entry of the legend, or give it another title.

        Nothing is hidden that may come back with the next frame.
        """
        if may_come_back and self.state.is_fleeting and not wanted:
            return
        item = self._items.get(name)
        if item is not None:
            item.visible = bool(wanted)
            if isinstance(wanted, str) and wanted and item.label != value(wanted):
                item.label = value(wanted)

    def fill(self, name: str, title: str = "", **columns: Any) -> None:
        """Fill a source; show its entry in the legend, with a title, if it has data."""
        target = self.sources[name]
        columns = {column: _sent(values) for column, values in columns.items()}
        new = [
            column
            for column in columns
            if not _equal(target.data[column], columns[column])
        ]
        # A column that is the same is not sent again.
        if len(new) == 1 < len(columns):
            target.data[new[0]] = columns[new[0]]
        elif new:
            target.data = columns
        has_data = any(len(values) for values in columns.values())
        if has_data and title:
            self.show(name, title)
        else:
            self.show(name, has_data)

    def draw(self, name: str, x: ArrayLike, y: ArrayLike, title: str = "") -> None:
        """Draw a curve of values in SI, shape (n,) each."""
        self.fill(name, title, x=self.x(x), y=self.y(y))

    def draw_each(
        self,
        names: Sequence[str],
        x: ArrayLike,
        ys: Sequence[ArrayLike],
        titles: Sequence[str],
    ) -> None:
        """Draw curves over one x, shape (n,), in SI; clear names without a curve."""
        for name, y, title in zip_longest(names, ys, titles):
            if y is None:
                self.draw(name, [], [])
            else:
                self.draw(name, x, y, title)


class ExtraView(View):
    """A view of one extra, which the worker sends when the view is visible."""

    def update(self, frame: Frame, selection: Selection, ghost: Frame | None) -> None:
        """Show the extra of a frame, if the frame has it."""
        (name,) = self.needs
        extra = frame.extras.get(name)
        if extra is not None:
            self._show(extra, frame, selection)

    def _show(self, extra: Any, frame: Frame, selection: Selection) -> None:
        raise NotImplementedError


def _limits(axis: Range1d) -> Floats:
    """Limits of an axis that has not been zoomed, shape (2,)."""
    return np.array([axis.reset_start, axis.reset_end])


def _sent(values: Any) -> Any:
    """Values with short curves as lists, as arrays need two further messages."""
    if isinstance(values, list):
        return [_sent(each) for each in values]
    is_curve = isinstance(values, np.ndarray) and values.ndim == 1
    if is_curve and len(values) <= SHORT:
        return values.tolist()
    return values


def _equal(old: Any, new: Any) -> bool:
    """Check whether values are equal, with NaN equal to NaN."""
    if isinstance(new, np.ndarray):
        return np.array_equal(old, new, equal_nan=new.dtype.kind == "f")
    if isinstance(new, list):
        return len(old) == len(new) and all(map(_equal, old, new))
    return bool(old == new or (old != old and new != new))


def joined(curves: Iterable[ArrayLike]) -> Floats:
    """Join curves, shape (2, n) each, with NaN in between, shape (2, n_all)."""
    gap = np.full((2, 1), np.nan)
    pieces: list[Floats] = []
    for curve in curves:
        if pieces:
            pieces.append(gap)
        pieces.append(np.asarray(curve))
    if not pieces:
        return gap[:, :0]
    return np.concatenate(pieces, axis=1)


def magnify(plot: figure, size: str, words: str) -> None:
    """Set the type size of a figure, and that of words in it, as CSS has them."""
    keep = CustomJS(code=KEEP)
    # Each by itself: an em is 13 pixels to axes, whatever the style.
    for model in (plot, *plot.legend):
        model.styles = {**model.styles, "font-size": size}
    # Marks of legends are as large as their words: on a projector colours are seen.
    pixels = round(float(size.removesuffix("px")))
    marks = dict.fromkeys(("glyph_width", "glyph_height", "label_height"), pixels)
    for box in plot.legend:
        box.update(tags=[marks], **marks)
        if not box.js_property_callbacks:
            box.js_on_change("glyph_width", keep)
    # Bokeh's own search would go through the figure for each kind.
    parts = plot.references()
    for part in parts:
        if isinstance(part, models.Text):
            part.text_font_size = words
    ticks = FEW_TICKS
    if size == TEXT:
        ticks = TICKS
    for axis in plot.yaxis:
        if isinstance(axis.ticker, models.ContinuousTicker):
            axis.ticker.desired_num_ticks = ticks
    titled = [part for part in parts if isinstance(part, Title | ColorBar)]
    for model in (*plot.axis, *titled):
        names = [name for name in model.properties() if name.endswith("text_font_size")]
        sizes = dict.fromkeys(names, size)
        tags = []
        if size != TEXT:
            tags = [sizes]
        model.update(tags=tags, **sizes)
        if not model.js_property_callbacks:
            model.js_on_change(names[0], keep)


def legend(plot: figure, items: Sequence[Any], place: str = "above") -> Legend:
    """A legend in one line: above the plot, or inside."""
    styles = {"font-size": TEXT}
    sheets = [CLOSE, FLOWING]
    if place == "above":
        styles |= ABOVE
        sheets.append(WRAPPED)
    box = Legend(
        items=items,
        orientation="horizontal",
        location="top_left",
        padding=0,
        margin=2,
        label_height=12,
        glyph_height=12,
        glyph_width=12,
        background_fill_alpha=0.0,
        # The page's theme has none, but not that of a page that is saved.
        border_line_color=None,
        styles=styles,
        stylesheets=sheets,
    )
    plot.add_layout(box, place)
    return box
