"""Views: a Bokeh figure that is made once, and updated from frames."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
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
    ColumnDataSource,
    CrosshairTool,
    CustomJS,
    FullscreenTool,
    Glyph,
    GlyphRenderer,
    Legend,
    LegendItem,
    NoOverlap,
    Range1d,
    SaveTool,
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
from app.views.colors import CUT, UNSEEN
from app.views.legends import legend
from app.views.parts import LEAST, visuals
from app.views.type_size import FONT, TEXT, WORDS, magnify
from solver.settings.scene import Settings

TOOLS = "pan,wheel_zoom,reset"
SHORT = 200
"""Length of a curve up to which it is sent as a list: faster there than an array."""


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
        self._shown: tuple[Frame, Selection, Frame | None] | None = None

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
        """Follow the size of the figure, px, from a size on; draw again for another."""
        self.lay_out(width, height)
        for name in self._size:
            self._figure.on_change(name, self._resize)

    def lay_out(self, width: float, height: float) -> None:
        """Lay out what is drawn for a size of the figure, px."""
        self._size = {"inner_width": width, "inner_height": height}

    def _resize(self, name: str, old: float, new: float) -> None:
        # A figure that is out of sight reports a size of zero.
        self._size[name] = max(float(new), LEAST)
        with pn.io.hold():
            if self._shown is not None:
                self.update(*self._shown)

    def _newest(self, frame: Frame) -> Frame:
        """The newest frame of the run of a frame."""
        newest = self.state.newest
        if newest is None or newest.run.number != frame.run.number:
            return frame
        return newest

    @property
    def room(self) -> Floats:
        """Width and height of the figure for which it is laid out, px, shape (2,)."""
        return np.array([*self._size.values()])

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
        magnify(self._figure, self._type, self.words)
        if self.beside is not None:
            magnify(self.beside, self._type, self.words)

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
        plot.add_tools(
            # Without a name the browser asks for one.
            SaveTool(filename=self.name),
            FullscreenTool(),
            CrosshairTool(line_color=CUT, line_alpha=0.5),
        )
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
        """Add marks to the legend only, by name; one without a colour waits for `show`.

        The marks share a glyph, as each glyph costs time.
        """
        nowhere = [np.nan] * len(colors)
        columns = {"x": nowhere, "y": nowhere, "color": list(colors.values())}
        look = {"marker": "square", "size": 10, "color": "color"} | look
        marks = self._render(self._source(columns), Scatter(**visuals(Scatter, look)))
        for index, (name, color) in enumerate(colors.items()):
            is_seen = color != UNSEEN
            item = LegendItem(renderers=[marks], index=index, visible=is_seen)
            self._items[name] = item

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
            # Before a first frame `fill` knows no data of a glyph.
            has_data = name not in self.sources
            self._items[name] = LegendItem(renderers=[copy], visible=has_data)
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

    def clear(self, *names: str) -> None:
        """Leave no data in sources, by default in all."""
        for name in names or self.sources:
            self.fill(name, **{column: [] for column in self.sources[name].data})

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
                self.clear(name)
            else:
                self.draw(name, x, y, title)


class ExtraView(View):
    """A view of one extra, which the worker sends when the view is visible."""

    _of_scene = ""

    def update(self, frame: Frame, selection: Selection, ghost: Frame | None) -> None:
        """Show the extra of a frame, if the frame has it."""
        self._shown = frame, selection, ghost
        (name,) = self.needs
        extra = frame.extras.get(name)
        scene = frame.run.settings.scene
        if extra is not None:
            self._of_scene = scene
            self._show(extra, frame, selection)
        elif scene != self._of_scene:
            # What is there is of the scene before.
            self.clear()

    def _show(self, extra: Any, frame: Frame, selection: Selection) -> None:
        raise NotImplementedError


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
