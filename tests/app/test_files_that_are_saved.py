"""Files that are taken away hold the numbers that are on the page."""

from __future__ import annotations

import csv
import io
import json
import math
import re
import runpy
from functools import cache
from itertools import chain
from pathlib import Path
from typing import Any

import frames
import numpy as np
import pandas as pd
import pytest
from bokeh.models import Axis, ColorBar, Text, Title
from pictures import boxes_of_words
from small_scenes import SMALL as SMALLEST

from app.files.export import (
    contact_table,
    history_table,
    offers,
    path_table,
    plot_table,
    program,
)
from app.files.offline_page import NARROWEST, _copies, offline_page
from app.files.tables import table_of
from app.frame import Frame, Selection
from app.messages import TABLE, Needs, Start
from app.state import PageState, default_settings
from app.views.catalogue import CARDS
from app.views.contact_force import ContactForce
from app.views.obstacles import Obstacles
from app.views.pieces import PiecesView
from app.views.rope import WireSection
from app.views.scene import Scene
from app.views.status_map import StatusMap
from app.views.timeline import Timeline
from app.views.type_size import TEXT
from app.views.view import View
from app.worker.references import ReferenceCache
from app.worker.runner import Runner
from solver.study.comparison import FRICTION, results_in

KINDS = tuple(chain.from_iterable(CARDS))
NEEDS = frozenset(chain.from_iterable(kind.needs for kind in KINDS))

SMALL: dict[str, dict[str, Any]] = {
    "bar": {"elements": 20, "instants": 21, "substructures": 4},
    "block": {"instants": 9},
    "layers": {"instants": 9},
    "rope": {"instants": 9, "elements": 20},
}
PHONE = 390 - 2 * 12
"""Width of a phone without the margins of a saved page, px."""


@cache
def ended(scene: str) -> tuple[Runner, Frame]:
    """A run that has ended, and what is shown of it."""
    settings = default_settings(scene).replace(**SMALL[scene])
    # A view tells runs apart by their numbers.
    number = 1 + list(SMALL).index(scene)
    start = Start(number, settings, math.inf)
    runner = Runner(start, ReferenceCache(), lambda: False)
    while runner.rest() is not None:
        runner.advance()
    return runner, runner.frame(Needs(extras=NEEDS | {TABLE}))


@cache
def page_of_all() -> tuple[PageState, list[View]]:
    """The state of a page, and each of its views."""
    state = PageState(default_settings("bar"))
    return state, [kind(state) for kind in (Scene, Timeline, *KINDS)]


def page(scene: str) -> tuple[PageState, list[View]]:
    """The state of a page that shows that run, and every view that applies."""
    _, frame = ended(scene)
    state, each = page_of_all()
    state.settings = frame.run.settings
    state.newest = state.frame = frame
    views = [view for view in each if view.applies(state.settings)]
    for view in views:
        assert view.figure is not None
        view.update(frame, state.selection, None)
    return state, views


def rows_of(table: str) -> list[dict[str, str]]:
    """Rows of a table below one line of heads."""
    return list(csv.DictReader(io.StringIO(table)))


def test_the_program_gives_the_records_of_the_run_again(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    runner, frame = ended("bar")
    file = tmp_path / "run.py"
    file.write_text(program(frame.run.settings), encoding="utf-8")
    runpy.run_path(str(file))
    *lines, ending = capsys.readouterr().out.splitlines()
    records = [line.split() for line in lines]
    assert ending == "converged"
    assert [int(iteration) for iteration, _, _ in records] == [
        r.iteration for r in runner.history
    ]
    for (_, indicator, error), record in zip(records, runner.history, strict=True):
        assert float(indicator) == record.indicator
        assert float(error) == pytest.approx(record.error_force, abs=1e-15)


def test_tables_hold_what_is_drawn() -> None:
    _, frame = ended("bar")
    view = next(view for view in page("bar")[1] if isinstance(view, ContactForce))
    table = plot_table(view)
    drawn = {np.float32(row["latin"]) for row in rows_of(table) if row["latin"]}
    assert drawn >= set(view.sources["friction"].data["latin"])
    # Numbers have the digits that frames have, and none of their conversion.
    cuts = [row["x, m"] for row in rows_of(table) if row["curve"] == "cuts"]
    assert all(len(x) < 12 for x in cuts), cuts
    assert {"x, m", "force, kN/m"} <= rows_of(table)[0].keys()
    iterations = rows_of(history_table(frame))
    assert len(iterations) == len(frame.history["indicator"])
    assert [row["iteration"] for row in iterations][:2] == ["1", "2"]
    assert np.float32(iterations[-1]["indicator"]) == frame.history["indicator"][-1]


def test_loads_are_a_table_of_values_with_units() -> None:
    _, frame = ended("bar")
    loads = pd.read_csv(io.StringIO(path_table(frame)))
    assert list(loads.columns) == ["t, s", "F, N", "p, kN/m"]
    assert loads["F, N"].max() == pytest.approx(900.0)
    assert loads["p, kN/m"].tolist() == pytest.approx([5.0] * len(loads))


@pytest.mark.parametrize("scene", SMALL)
def test_contact_is_read_again_as_results_and_by_pandas(scene: str) -> None:
    _, frame = ended(scene)
    text = contact_table(frame)
    read = pd.read_csv(io.StringIO(text))
    assert not read.isna().any(axis=None)
    assert {"x, m", "t, s", "slip, m", "status"} <= set(read.columns)
    # A force per area and one per length are named as on the plot.
    (head,) = [name for name in read.columns if name.startswith("friction")]
    heads = {"plane": "friction traction, Pa"}
    assert head == heads.get(frame.run.settings.kind, "friction force, N/m")
    several = len(frame.run.interfaces) > 1
    assert ("contact" in read.columns) == several
    brought = results_in(table_of(text.encode(), "contact.csv"), frame.run.settings)
    assert brought.quantity == FRICTION
    assert "'contact'" not in brought.message
    names = list(frame.run.interfaces)
    for name, fields in frame.contact.items():
        rows = read
        if several:
            rows = read[read["contact"] == name]
        np.testing.assert_array_equal(rows["slip, m"].astype("f4"), fields.slip.ravel())
        sticks = rows["status"].to_numpy() == "stick"
        np.testing.assert_array_equal(sticks, fields.status.ravel() == 0)
        results = brought.on(name, names)
        shape = fields.friction.shape
        np.testing.assert_array_equal(
            results.values.astype("f4").reshape(shape), fields.friction
        )
        np.testing.assert_array_equal(
            results.times.reshape(shape)[0], frame.run.instants
        )


@pytest.mark.parametrize("scene", SMALL)
def test_every_plot_of_every_kind_of_scene_is_a_table(scene: str) -> None:
    for view in page(scene)[1]:
        rows = rows_of(plot_table(view))
        assert rows, view.name
        # What is drawn beside curves, as words and colours, is no data.
        heads = " ".join(rows[0])
        assert not re.search("text|color|width", heads), heads


def test_the_offline_page_holds_each_instant_and_loads_nothing() -> None:
    # Two pictures, and two plots.
    state, views = page("bar")
    views = views[:4]
    before = [view.figure.height for view in views]
    text = offline_page(state, views)
    assert "<script src" not in text
    assert "<link" not in text
    match = re.search(
        r'<script type="application/json"[^>]*>(.*?)</script>', text, re.S
    )
    assert match is not None
    kept = json.dumps(json.loads(match[1]))
    instants = set(re.findall(r"At ([\d.]+) s of 1 s\.", kept))
    assert instants == {f"{time:g}" for time in np.linspace(0, 1, 21).round(2)}
    for view in views[2:]:
        assert f"<figcaption>{view.name}</figcaption>" in text
    # Beside the margins of a phone of 390 px.
    widths = [int(width) for width in re.findall(r'"min_width": (\d+)', kept)]
    assert widths
    assert max(widths) <= PHONE
    # The page's own figures are as they were.
    assert [view.figure.height for view in views] == before


@pytest.mark.parametrize(("instants", "is_seen"), [(1, False), (2, True)])
def test_the_offline_page_has_a_slider_where_there_is_an_instant_to_choose(
    instants: int, is_seen: bool, caplog: pytest.LogCaptureFixture
) -> None:
    values = SMALLEST["bar"] | {"instants": instants, "load": "ramp"}
    settings = default_settings("bar").replace(**values)
    frame = frames.frame_of(settings, Needs(extras=frozenset()), ends=False)
    assert len(frame.run.instants) == instants
    state = PageState(settings, frame=frame, newest=frame)
    text = offline_page(state, [Scene(state), Timeline(state)])
    slider = text.partition('"name":"Slider"')[2].partition('"name":"Div"')[0]
    assert ('"visible":false' in slider) != is_seen
    # Bokeh logs a slider both of whose ends are one.
    assert not caplog.records


@pytest.mark.parametrize("scene", ["block", "rope", "wall", "arch", "belt", "mesh"])
def test_the_offline_page_is_made_of_every_kind_of_scene(scene: str) -> None:
    settings = default_settings(scene).replace(**SMALLEST[scene])
    frame = frames.frame_of(settings, Needs(extras=frozenset()), ends=False)
    state = PageState(settings, frame=frame, newest=frame)
    views = [Scene(state), Timeline(state), ContactForce(state)]
    text = offline_page(state, views)
    assert "<figcaption>Contact force</figcaption>" in text


@pytest.mark.parametrize("scene", ["block", "wall", "arch", "belt", "mesh"])
def test_words_of_a_saved_picture_are_whole_on_a_phone_without_the_font(
    scene: str,
) -> None:
    settings = default_settings(scene).replace(**SMALLEST[scene])
    frame = frames.frame_of(settings, Needs(extras=frozenset()), ends=False)
    state = PageState(settings, frame=frame, newest=frame)
    (view,) = _copies([Scene(state)], frame.run)
    view.update(frame, Selection(0.4), None)
    (size,) = {glyph.text_font_size for glyph in view.figure.select(Text)}
    # A bold letter of DejaVu Sans; the picture is as wide as the phone.
    letter = 0.7 * float(size.removesuffix("px")) * NARROWEST / PHONE
    for text, box in boxes_of_words(view, letter=letter):
        assert box[0, 0] >= 0.0, text
        assert box[1, 0] <= NARROWEST, text


def test_a_saved_cross_section_is_as_wide_as_high_at_any_size() -> None:
    settings = default_settings("rope").replace(**SMALLEST["rope"])
    needs = Needs(extras=frozenset({"section"}))
    frame = frames.frame_of(settings, needs, ends=False)
    (view,) = _copies([WireSection(PageState(settings, frame=frame))], frame.run)
    view.update(frame, Selection(0.4), None)
    plot = view.figure
    assert plot.match_aspect
    # The browser computes their ends.
    assert np.isnan([plot.x_range.start, plot.y_range.end]).all()


def test_words_above_saved_pieces_are_whole_on_a_phone() -> None:
    state, _ = page("bar")
    assert state.frame is not None
    (view,) = _copies([PiecesView(state)], state.frame.run)
    view.update(state.frame, Selection(0.4), None)
    (words,) = [part for part in view.figure.above if isinstance(part, Title)]
    assert words.text.startswith("Linear stage")
    assert 6.0 * max(map(len, words.text.splitlines())) <= NARROWEST


def test_the_name_of_a_weight_stands_at_its_arrow_in_a_saved_picture() -> None:
    frame = frames.ran(frames.arch(finish="at-once"))
    (view,) = _copies([Scene(PageState(frame.run.settings, frame=frame))], frame.run)
    for phase in (0.25, 0.75):
        view.update(frame, Selection(phase), None)
        boxes = dict(boxes_of_words(view))
        (name,) = [text for text in boxes if text.startswith("W = ")]
        (arrow,) = Obstacles(view.picture).weights.values()
        low, high = boxes[name]
        away = np.hypot(*(arrow - np.clip(arrow, low, high)).T).min()
        assert away < 1.5 * view.picture.layout.row
        assert not view.sources["leaders"].data["xs"]


def test_light_and_dark_saved_plots_have_type_of_one_size() -> None:
    state, views = page("block")
    for view in _copies(views, state.frame.run):
        for model in view.figure.references():
            if isinstance(model, Axis | ColorBar | Title):
                names = [name for name in model.properties() if "font_size" in name]
                assert {getattr(model, name) for name in names} == {TEXT}


def test_the_offline_page_tells_status_and_all_settings_as_the_page_does() -> None:
    state, views = page("bar")
    # A long name goes on in the next line behind a dash, on a phone.
    text = offline_page(state, views[:2]).replace("<wbr>", "")
    assert "certified" in text
    for name in state.settings.definitions():
        assert (f"<code>{name}</code>" in text) == state.settings.applies(name), name
    row = "<td>Peak load</td><td>900 N</td><td><code>peak</code></td>"
    assert row in text


def test_the_dialog_offers_a_file_of_each_plot_in_sight() -> None:
    state, views = page("bar")
    offered = offers(state, views)
    names = [getattr(offer, "filename", "") for offer in offered]
    assert {
        "slipfront-bar.html",
        "slipfront-bar.py",
        "slipfront-bar-all-iterations.csv",
    } <= {*names}
    tables = {name for name in names if name.endswith(".csv")}
    pictures = Scene | Timeline | StatusMap
    curves = {view.name for view in views if not isinstance(view, pictures)}
    assert len(tables) == 3 + len(curves)
    # What is drawn there is in the table of the contact.
    assert "slipfront-bar-contact-over-x-and-t.csv" in tables
    assert "slipfront-bar-stick-and-slip.csv" not in tables
    for offer in offered[1:4]:
        assert offer.callback().getvalue()
