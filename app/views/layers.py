"""Layers of a figure, drawn once they have data, and the legend that names them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any

from bokeh.core.properties import value
from bokeh.document import Document
from bokeh.events import LegendItemClick
from bokeh.models import (
    AllIndices,
    ColumnDataSource,
    CustomJS,
    Glyph,
    GlyphRenderer,
    HoverTool,
    Legend,
    LegendItem,
    Scatter,
    Selection,
    UnionRenderers,
)
from bokeh.plotting import figure

from app.views.parts import visuals

LEGEND = "12px"
"""Type size of a legend, as CSS has it."""
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


class Layer:
    """A glyph of a figure, and the source of its data."""

    def __init__(
        self,
        name: str | None,
        source: ColumnDataSource,
        kind: type[Glyph],
        look: Mapping[str, Any],
    ) -> None:
        self.name = name
        self.source = source
        self.renderer: GlyphRenderer | None = None
        self.tool: HoverTool | None = None
        self._kind = kind
        self._look = look

    @cached_property
    def glyph(self) -> Glyph:
        """The glyph, made when it is first asked for."""
        return self._kind(**visuals(self._kind, self._look))

    def make(self, filtered: AllIndices, *, is_seen: bool) -> None:
        """Make the renderer, which `Layers.place` puts into the figure."""
        self.renderer = GlyphRenderer(
            data_source=self.source,
            glyph=self.glyph,
            name=self.name,
            visible=is_seen,
            # By default Bokeh makes further glyphs for selections, which none here has.
            selection_glyph=None,
            nonselection_glyph=None,
            muted_glyph=None,
        )
        # In the renderer's own view: Bokeh makes that even where another is given.
        self.renderer.view.filter = filtered


class Layers:
    """Layers of a figure from the bottom to the top, and the entries of its legend.

    Each is made once it has something to show: half of a figure's curves are those of a
    reference, of another run, or of bodies in the plane, and a server with thirty pages
    made them for nothing. Some are new (`is_new`) until they are put in `place`.
    """

    def __init__(self, plot: figure) -> None:
        self._plot = plot
        # In no source anything is selected or filtered: all share these models, as each
        # model costs time.
        self._selects = {
            "selected": Selection(),
            "selection_policy": UnionRenderers(),
        }
        self._filter = AllIndices()
        self._layers: list[Layer] = []
        self._marks: dict[str, LegendItem] = {}
        self._items: dict[str, LegendItem] = {}
        self._titles: dict[str, str] = {}
        self._legend: Legend | None = None
        self._nowhere: ColumnDataSource | None = None
        self.is_new = False

    @property
    def document(self) -> Document | None:
        """The document of the figure; None until it has one."""
        return self._plot.document

    def source(self, columns: Mapping[str, Any]) -> ColumnDataSource:
        """A source with columns."""
        return ColumnDataSource(dict(columns), **self._selects)

    def add(
        self,
        name: str | None,
        source: ColumnDataSource,
        kind: type[Glyph],
        look: Mapping[str, Any],
    ) -> Layer:
        """Add a layer on top of all others."""
        layer = Layer(name, source, kind, look)
        self._layers.append(layer)
        return layer

    def draw(self, source: ColumnDataSource) -> list[Glyph]:
        """Make the layers of a source that has data; return the glyphs of new ones.

        They are in the figure once they are placed.
        """
        undrawn = [layer for layer in self._layers if layer.renderer is None]
        new = [layer for layer in undrawn if layer.source is source]
        self._make(new)
        return [layer.glyph for layer in new]

    def _make(self, layers: list[Layer]) -> None:
        for layer in layers:
            # A click on the legend may have hidden others of its name.
            hidden = {each.name for each in self._plot.renderers if not each.visible}
            layer.make(self._filter, is_seen=layer.name not in hidden)
            self.is_new = True

    def place(self) -> None:
        """Put layers and entries that are new in their place."""
        self.is_new = False
        made = [layer for layer in self._layers if layer.renderer is not None]
        self._plot.renderers = [layer.renderer for layer in made]
        for tool in {layer.tool for layer in made if layer.tool is not None}:
            tool.renderers = [each.renderer for each in made if each.tool is tool]
        if self._legend is not None:
            self._legend.items = [
                self._items[name] for name in self._titles if name in self._items
            ]

    def mark(self, colors: Mapping[str, str], **look: Any) -> None:
        """Add marks to the legend only, by name.

        The marks share a glyph, as each glyph costs time.
        """
        nowhere = [float("nan")] * len(colors)
        columns = {"x": nowhere, "y": nowhere, "color": list(colors.values())}
        look = {"marker": "square", "size": 10, "color": "color"} | look
        marks = self.add(None, self.source(columns), Scatter, look)
        self._make([marks])
        self.place()
        for index, name in enumerate(colors):
            self._marks[name] = LegendItem(renderers=[marks.renderer], index=index)

    def legend(self, titles: Mapping[str, str], place: str) -> Legend:
        """Name layers and marks in a legend, in this order, by their titles.

        Marks are there from the beginning, layers once they are shown (`show`).
        """
        self._titles = dict(titles)
        for name in titles:
            if name in self._marks:
                self._items[name] = self._marks[name]
                self._items[name].label = value(titles[name])
        self._legend = legend(self._plot, list(self._items.values()), place)
        self._legend.click_policy = "hide"
        hide = CustomJS(args={"plot": self._plot}, code=HIDE)
        self._legend.js_on_event(LegendItemClick, hide)
        return self._legend

    def show(self, name: str, title: str, *, is_seen: bool) -> None:
        """Show or hide an entry of the legend, with a title if that is not empty."""
        item = self._items.get(name)
        if item is None and is_seen and name in self._titles:
            item = self._enter(name)
        if item is None:
            return
        item.visible = is_seen
        if title and item.label != value(title):
            item.label = value(title)

    def _enter(self, name: str) -> LegendItem:
        """Enter a layer into the legend, of layers of one name the first.

        The legend shows a copy of it without data, as Bokeh makes the legend anew
        whenever the data of a glyph in it change.
        """
        if self._nowhere is None:
            columns: dict[str, list[float]] = {}
            for layer in self._layers:
                columns |= {column: [float("nan")] for column in layer.source.data}
            self._nowhere = self.source(columns)
        named = next(layer for layer in self._layers if layer.name == name)
        copy = Layer(name, self._nowhere, type(named.glyph), {})
        copy.glyph = named.glyph
        self._layers.append(copy)
        self._make([copy])
        item = LegendItem(renderers=[copy.renderer], label=value(self._titles[name]))
        self._items[name] = item
        return item


def hover(plot: figure, layers: list[Layer], tips: Mapping[str, str]) -> None:
    """Show values at the pointer: titles, and columns of the layers' sources."""
    tool = HoverTool(renderers=[], tooltips=list(tips.items()))
    for layer in layers:
        layer.tool = tool
    plot.add_tools(tool)


def legend(plot: figure, items: Sequence[Any], place: str = "above") -> Legend:
    """A legend in one line: above the plot, where it covers no curve, or inside."""
    styles = {"font-size": LEGEND}
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
        styles=styles,
        stylesheets=sheets,
    )
    plot.add_layout(box, place)
    return box
