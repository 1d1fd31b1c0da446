"""What a view is: a Bokeh figure made once, and an update from a frame."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cached_property
from itertools import zip_longest
from typing import Any, ClassVar

import numpy as np
from bokeh import models
from bokeh.core.properties import value
from bokeh.events import LegendItemClick
from bokeh.models import (
    AllIndices,
    CDSView,
    ColorBar,
    ColumnDataSource,
    CrosshairTool,
    CustomJS,
    Glyph,
    GlyphRenderer,
    HoverTool,
    Legend,
    LegendItem,
    LinearColorMapper,
    Range1d,
    Scatter,
    Title,
    UnionRenderers,
)
from bokeh.plotting import figure
from numpy.typing import ArrayLike

from app.frame import Floats, Frame, Selection
from app.state import PageState
from app.views.axis import Axis
from app.views.colors import CUT
from solver.settings.scene import Settings

TOOLS = "pan,wheel_zoom,reset,save,fullscreen"
SHORT = 200
"""Numbers of a curve up to which it is sent as a list, which then takes less time than
an array."""
TEXT = "12px"
WORDS = "14px"
"""Sizes of what is written in plots, and of what belongs to arrows."""
KEEP = "if (cb_obj.tags.length) { cb_obj.setv(cb_obj.tags[0]) }"
"""Keeps sizes that are not the theme's, as the browser sets these when it draws a
figure."""
ABOVE = {"margin-left": "-60px", "top": "-1px"}
"""Has a legend begin at the left end of the figure."""
CLOSE = """
.bk-grid { gap: 6px 5px !important; }
.bk-item { gap: 4px !important; }
.bk-item .bk-label { min-width: 0 !important; }
"""
"""Lets a legend of seven entries stand in one line; the theme keeps them farther
apart."""


HIDE = """
const [shown] = cb_obj.item.renderers
const is_mark = shown.name == null
const others = (each) => each.name == shown.name && each != shown
for (const each of is_mark ? [shown] : plot.renderers.filter(others)) each.visible = !each.visible
"""
"""Hides the glyph that a copy in the legend is of, or shows it again; marks stay as
they are."""


class View:
    """A figure, made when it is first seen, below a legend that names what is there.

    A click on an entry of the legend hides its curve. What is done in the figure, as a
    tap, selects in the state of the page. `x` and `y` are the axes, `sources` what is
    drawn, by name.
    """

    name: ClassVar[str]
    """What its tab is called."""
    needs: ClassVar[frozenset[str]] = frozenset()
    """Names of the extras of a frame that it shows."""
    applies: ClassVar[Callable[[Settings], bool]] = staticmethod(lambda settings: True)
    """Whether it says anything about a run with such settings."""

    def __init__(self, state: PageState) -> None:
        self.state = state
        self._type = TEXT
        self._made: figure | None = None
        self.sources: dict[str, ColumnDataSource] = {}
        self._items: dict[str, LegendItem] = {}

    @cached_property
    def figure(self) -> figure:
        """The figure."""
        # Nothing in it is selected or left out: what would say so is shared, as each
        # model counts.
        self._selects = {
            "selected": models.Selection(),
            "selection_policy": UnionRenderers(),
        }
        self._filter = AllIndices()
        self.make()
        size = self._type
        self._type = TEXT
        self.magnify(size)
        return self._made

    def magnify(self, size: str) -> None:
        """Have its type in a size, as CSS has it."""
        made = self._made
        keep = CustomJS(code=KEEP)
        is_same = size == self._type
        self._type = size
        if is_same or made is None:
            return
        # Each by itself: an em is 13 pixels to axes, whatever the style.
        for model in (made, *made.legend):
            model.styles = {**model.styles, "font-size": size}
        for words in made.select(models.Text):
            words.text_font_size = self.words
        for model in (*made.axis, *made.select(Title), *made.select(ColorBar)):
            names = [
                name for name in model.properties() if name.endswith("text_font_size")
            ]
            sizes = dict.fromkeys(names, size)
            model.update(tags=[sizes] if size != TEXT else [], **sizes)
            if not model.js_property_callbacks:
                model.js_on_change(names[0], keep)

    @property
    def words(self) -> str:
        """Size of the type of what belongs to arrows, as CSS has it."""
        return WORDS if self._type == TEXT else self._type

    def make(self) -> None:
        """Make the figure, by `begin` and `add`."""
        raise NotImplementedError

    def update(self, frame: Frame, selection: Selection, ghost: Frame | None) -> None:
        """Show a frame; the ghost is that of the run that it is compared with."""
        raise NotImplementedError

    @property
    def ghost_name(self) -> str:
        """What the run is called that is drawn beside the present one."""
        return "last run" if self.state.pinned is None else "pinned run"

    def begin(
        self, x: tuple[str, ...] = ("",), y: tuple[str, ...] = ("",), **more: Any
    ) -> figure:
        """A new figure whose axes have a title and an SI unit; `add` fills it."""
        made = self._made = figure(
            sizing_mode="stretch_both",
            min_height=120,
            # It stands nearer than the label of an axis, which the theme moves away.
            title=Title(align="center", standoff=2),
            title_location="below",
            tools=TOOLS,
            active_drag=None,
            active_scroll="wheel_zoom",
            **({"x_range": Range1d(0, 1), "y_range": Range1d(0, 1)} | more),
        )
        made.add_tools(CrosshairTool(line_color=CUT, line_alpha=0.5))
        made.toolbar.autohide = True
        made.toolbar.logo = None
        made.min_border = 2
        made.min_border_right = 10
        made.outline_line_color = None
        made.axis.major_label_standoff = 3
        made.axis.minor_tick_line_color = None
        made.axis.major_tick_in = 0
        made.axis.major_tick_out = 3
        made.grid.grid_line_alpha = 0.3
        self.x = Axis(made, "x", *x)
        self.y = Axis(made, "y", *y)
        return made

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
        """A glyph of Bokeh's, columns called as its properties, on a source called as it or `on`.

        The source has also other columns, for whoever hovers, or other glyphs on it.
        """
        kind = getattr(models, glyph)
        own = columns.split()
        if (on or name) not in self.sources:
            self.sources[on or name] = self._source(
                {each: [] for each in (*own, *also.split())}
            )
        look = {column: column for column in own} | look
        return self._render(self.sources[on or name], kind(**visuals(kind, look)), name)

    def _render(
        self, source: ColumnDataSource, glyph: Glyph, name: str | None = None
    ) -> GlyphRenderer:
        without = {
            f"{state}_glyph": None for state in ("selection", "nonselection", "muted")
        }
        view = CDSView(filter=self._filter)
        return self._made.add_glyph(source, glyph, name=name, view=view, **without)

    def _source(self, columns: dict[str, Any]) -> ColumnDataSource:
        return ColumnDataSource(columns, **self._selects)

    def mark(self, colors: Mapping[str, str], **look: Any) -> None:
        """Marks that stand in the legend only, by name; they share a glyph, as each costs time."""
        nowhere = [np.nan] * len(colors)
        columns = {"x": nowhere, "y": nowhere, "color": list(colors.values())}
        look = {"marker": "square", "size": 10, "color": "color"} | look
        marks = self._render(self._source(columns), Scatter(**visuals(Scatter, look)))
        for place, name in enumerate(colors):
            self._items[name] = LegendItem(renderers=[marks], index=place)

    def legend(self, *names: str, place: str = "above", **titles: str) -> Legend:
        """Name glyphs in a legend, in this order, by their own names or by titles.

        It shows copies of them without data: it is made anew whenever the data of what
        it shows change.
        """
        titles = {name: name for name in names} | titles
        drawn = {r.name: r for r in reversed(self._made.renderers) if r.name in titles}
        columns = {
            column for each in drawn.values() for column in each.data_source.data
        }
        nowhere = self._source({column: [np.nan] for column in columns})
        for name, each in drawn.items():
            self._items[name] = LegendItem(
                renderers=[self._render(nowhere, each.glyph, name)]
            )
        for name, title in titles.items():
            self._items[name].label = value(title)
        box = legend(self._made, [self._items[name] for name in titles], place)
        box.click_policy = "hide"
        box.js_on_event(LegendItemClick, CustomJS(args={"plot": self._made}, code=HIDE))
        return box

    def show(self, name: str, wanted: bool | str) -> None:
        """Show or hide an entry of the legend, unless it comes back, or give it another title."""
        if self.state.is_fleeting and not wanted:
            return
        item = self._items.get(name)
        if item is not None:
            item.visible = bool(wanted)
            if isinstance(wanted, str) and wanted and item.label != value(wanted):
                item.label = value(wanted)

    def fill(self, name: str, title: str = "", **columns: Any) -> None:
        """Fill a source; the legend has it, by a title, if there is anything in it."""
        target = self.sources[name]
        columns = {column: _sent(values) for column, values in columns.items()}
        new = [
            column
            for column in columns
            if not _equal(target.data[column], columns[column])
        ]
        # What is the same is not sent again.
        if len(new) == 1 < len(columns):
            target.data[new[0]] = columns[new[0]]
        elif new:
            target.data = columns
        self.show(name, any(map(len, columns.values())) and (title or True))

    def draw(self, name: str, x: ArrayLike, y: ArrayLike, title: str = "") -> None:
        """Draw a curve of values in SI."""
        self.fill(name, title, x=self.x(x), y=self.y(y))

    def draw_each(
        self,
        names: Sequence[str],
        x: ArrayLike,
        ys: Sequence[ArrayLike],
        titles: Sequence[str],
    ) -> None:
        """Draw curves over the same places; names that are left over are of none."""
        for name, y, title in zip_longest(names, ys, titles):
            self.draw(name, *([], []) if y is None else (x, y, title))


class ExtraView(View):
    """A view of the one extra that it needs, which the worker sends once the view is in sight."""

    def update(self, frame: Frame, selection: Selection, ghost: Frame | None) -> None:
        """Show what a frame has of it."""
        (name,) = self.needs
        extra = frame.extras.get(name)
        if extra is not None:
            self._show(extra, frame, selection)

    def _show(self, extra: Any, frame: Frame, selection: Selection) -> None:
        raise NotImplementedError


def bare(
    least: int, across: tuple[float, float], up: tuple[float, float], **more: Any
) -> figure:
    """A figure without tools, frame and grid, at least so many pixels high, with ends of axes."""
    made = figure(
        sizing_mode="stretch_both", min_height=least, tools="", toolbar_location=None, title=None,
        x_range=Range1d(*across), y_range=Range1d(*up), min_border=0, y_axis_type=None, **more,
    )  # fmt: skip
    made.center = []
    made.outline_line_color = None
    made.background_fill_alpha = made.border_fill_alpha = 0.0
    return made


def color_bar(made: figure, colors: LinearColorMapper, **look: Any) -> ColorBar:
    """A bar beside a figure that says what its colours mean."""
    bar = ColorBar(
        color_mapper=colors, width=9, padding=2, margin=0, title_standoff=4,
        title_text_font_style="normal", background_fill_alpha=0.0, **look,
    )  # fmt: skip
    made.add_layout(bar, "right")
    return bar


def hover(
    made: figure, renderers: list[GlyphRenderer], tips: Mapping[str, str]
) -> None:
    """Show values where the pointer is: names, and columns of the renderers' sources."""
    made.add_tools(HoverTool(renderers=renderers, tooltips=list(tips.items())))


def visuals(kind: type[Glyph], look: Mapping[str, Any]) -> dict[str, Any]:
    """Properties of a kind of glyph; `color`, `alpha`, `width`, `dash` are of line and fill."""
    names = kind.properties()
    properties = {}
    for trait, given in look.items():
        if trait in names:
            both = [trait]
        else:
            both = [f"line_{trait}", f"fill_{trait}"]
        properties |= {name: given for name in both if name in names}
    return properties


def _sent(values: Any) -> Any:
    """Values with short curves as lists: an array is sent by itself, in two messages."""
    if isinstance(values, list):
        return [_sent(each) for each in values]
    is_short = (
        isinstance(values, np.ndarray) and values.ndim == 1 and len(values) <= SHORT
    )
    if is_short:
        return values.tolist()
    return values


def _equal(old: Any, new: Any) -> bool:
    """Whether values are the same, as is NaN and NaN."""
    if isinstance(new, np.ndarray):
        return np.array_equal(old, new, equal_nan=new.dtype.kind == "f")
    if isinstance(new, list):
        return len(old) == len(new) and all(map(_equal, old, new))
    return bool(old == new or (old != old and new != new))


def joined(curves: Iterable[ArrayLike]) -> Floats:
    """Curves, shape (2, n) each, one after the other as one, NaN between them."""
    gap = np.full((2, 1), np.nan)
    pieces = [piece for curve in curves for piece in (np.asarray(curve), gap)]
    return np.concatenate(pieces[:-1] or [gap[:, :0]], axis=1)


def legend(made: figure, items: Sequence[Any], place: str = "above") -> Legend:
    """A legend in one line, above the plot, where it covers no curve, or in it."""
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
        styles={"font-size": TEXT} | (ABOVE if place == "above" else {}),
        stylesheets=[CLOSE],
    )
    made.add_layout(box, place)
    return box
