"""Keys of plots, legends and colour bars, are read in full."""

import pytest
from bokeh.models import ColorBar, LinearColorMapper
from pictures import frame_of, shown, small

from app.frame import Selection
from app.state import PageState, default_settings
from app.views.bases import Spectra
from app.views.errors import Convergence, ErrorTime
from app.views.inside import Stress
from app.views.loops import HysteresisLoop
from app.views.parts import bare, color_bar
from app.views.rope import WireSection
from app.views.scene import Scene
from app.views.timeline import Timeline
from app.views.type_size import magnify
from app.views.view import View


def test_an_entry_that_changes_has_the_legend_of_the_time_line_painted() -> None:
    # Bokeh leaves its marks blank, and the figure may have no other change.
    (legend,) = Timeline(PageState(default_settings("bar"))).figure.legend
    assert legend.items
    for item in legend.items:
        for change in ("label", "visible"):
            (script,) = item.js_property_callbacks[f"change:{change}"]
            assert script.args == {"legend": legend}
            assert "change.emit" in script.code


@pytest.mark.parametrize(
    "view", [Scene, Timeline, Convergence, ErrorTime, HysteresisLoop]
)
def test_before_its_first_picture_a_legend_has_no_words_but_those_it_keeps(
    view: type[View],
) -> None:
    # A scene that is large begins some seconds after its controls are there.
    settings = small("block")
    made = view(PageState(settings))
    (legend,) = made.figure.legend
    before = {item.label.value for item in legend.items if item.visible}
    made.update(frame_of(settings), Selection(), None)
    assert before <= {item.label.value for item in legend.items if item.visible}


def test_marks_of_a_legend_are_as_large_as_its_words() -> None:
    # Colours that stand for stick and slip are seen from the last row, too.
    view = Scene(PageState(default_settings("bar")))
    (legend,) = view.figure.legend
    view.magnify("28px")
    assert legend.glyph_height == legend.glyph_width == 28
    # The browser sets sizes of the theme in their place, which a script takes back.
    assert legend.tags == [dict.fromkeys(legend.tags[0], 28)]
    assert "change:glyph_width" in legend.js_property_callbacks
    view.magnify("12px")
    assert legend.glyph_height == 12


@pytest.mark.parametrize("size", ["12px", "28px"])
def test_a_figure_is_laid_out_anew_for_other_values_of_its_colour_bar(
    size: str,
) -> None:
    # Bokeh itself leaves the bar its width.
    colors = LinearColorMapper(palette=["black", "white"], low=0.0, high=1.0)
    plot = bare(90, (0, 1), (0, 1))
    bar = color_bar(plot, colors)
    magnify(plot, size, size)
    for model, name in [(colors, "low"), (colors, "high"), (bar, "title")]:
        (script,) = model.js_property_callbacks[f"change:{name}"]
        assert script.args == {"plot": plot}
        assert "invalidate_layout" in script.code
    # Its words keep a size that is not the theme's, too.
    sizes = [name for name in bar.js_property_callbacks if "font_size" in name]
    assert len(sizes) == 1


@pytest.mark.parametrize(
    ("kind", "scene"), [(Stress, "strand"), (Stress, "block"), (WireSection, "rope")]
)
def test_a_colour_bar_has_the_limits_of_the_colours(
    kind: type[View], scene: str
) -> None:
    settings = small(scene)
    if kind is WireSection:
        settings = default_settings("rope").replace(elements=20, instants=9)
    view = shown(frame_of(settings), kind=kind)
    (bar,) = view.figure.select(ColorBar)
    assert bar.color_mapper.low == view.colors.low
    assert bar.color_mapper.high == view.colors.high
    assert bar.title
    assert bar.visible


@pytest.mark.parametrize("kind", [Stress, WireSection, Spectra])
def test_there_is_no_colour_bar_before_there_are_values(kind: type[View]) -> None:
    view = kind(PageState(default_settings("rope")))
    (bar,) = view.figure.select(ColorBar)
    assert not bar.visible
