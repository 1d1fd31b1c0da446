"""What a page gives to take away holds: tables and a program give the numbers of its run."""

from __future__ import annotations

import base64
import csv
import io
import json
import re
import struct
from functools import cache
from typing import Any

import numpy as np
import pytest
from shown_pages import SMALL, Shown

from app.picture.recording import COLUMNS
from app.picture.shown import instant_of
from app.takeaway.snippet import NOTE, snippet
from app.wire.orders import Tabulate
from app.worker.offline import OFFLINE
from app.worker.tables import TABLES, table
from solver.files import settings_from_toml
from solver.scenes import CATALOGUE
from solver.scenes.bar import BarSettings


def told(scene: str, **options: Any) -> Shown:
    shown = Shown()
    shown.run(1, scene, {**SMALL[scene], "max_iterations": 4}, **options)
    return shown


@cache
def run_of(scene: str) -> Shown:
    """Give a run that is looked at alone."""
    return told(scene)


def read(text: str) -> tuple[list[str], list[dict[str, str]]]:
    """Give the comments of a table, and its rows."""
    lines = text.splitlines(keepends=True)
    rows = list(csv.DictReader(io.StringIO("".join(x for x in lines if x[0] != "#"))))
    return [line[2:] for line in lines if line[0] == "#"], rows


def column(rows: list[dict[str, str]], run: str, name: str) -> list[float]:
    return [float(row[name] or "nan") for row in rows if row["run"] == run]


@pytest.mark.parametrize("scene", list(CATALOGUE))
def test_a_program_gives_the_records_of_the_page_again(scene: str) -> None:
    recording = run_of(scene).recording
    found: dict[str, Any] = {}
    exec(snippet(recording.settings), found)
    records = found["solution"].records
    assert len(records) == len(recording.history)
    for name in set(COLUMNS) - {"seconds"}:
        alone = [getattr(record, name) for record in records]
        assert recording.history.column(name) == pytest.approx(alone, rel=1e-9, nan_ok=True)


def test_a_program_has_no_reference_where_the_page_has_none() -> None:
    large = CATALOGUE["strand"].settings.checked({"elements": 1500})
    assert "reference_of" not in snippet(large)
    assert "reference_of" in snippet(BarSettings.checked({}))
    assert snippet(large, was_warm=True) == NOTE + snippet(large)


@pytest.mark.parametrize("what", list(TABLES))
@pytest.mark.parametrize("scene", list(CATALOGUE))
def test_every_table_has_the_settings_in_front_and_equal_rows(scene: str, what: str) -> None:
    shown = run_of(scene)
    comments, rows = read(table(what, shown.scene()))
    first = comments.index("settings of LATIN:\n") + 1
    settings = settings_from_toml("".join(comments[first:]))
    assert settings.values() == shown.recording.settings.values()
    assert rows
    assert all(None not in row and None not in row.values() for row in rows)


def test_points_are_those_of_the_chosen_instant() -> None:
    scene = run_of("block").scene()
    chosen = instant_of(scene.look.phase, scene.frame.fields.friction.shape[1])
    _, rows = read(table("points", scene))
    fields, stand = scene.frame.fields, scene.run.stand
    assert scene.run.reference is not None
    assert fields.pressure is not None
    assert column(rows, "LATIN", "position (m)") == pytest.approx(stand.positions, rel=1e-6)
    assert column(rows, "LATIN", "friction (Pa)") == pytest.approx(
        fields.friction[:, chosen], rel=1e-6
    )
    assert column(rows, "LATIN", "pressure (Pa)") == pytest.approx(
        fields.pressure[:, chosen], rel=1e-6
    )
    assert column(rows, "LATIN", "status") == fields.status[:, chosen].tolist()
    other = scene.run.reference.friction[:, chosen]
    assert column(rows, "reference", "friction (Pa)") == pytest.approx(other, rel=1e-6)
    assert {float(row["time (s)"]) for row in rows} == {float(stand.instants[chosen])}


def test_tables_of_two_runs_have_both_and_the_settings_of_both() -> None:
    twin = BarSettings.checked({**SMALL["bar"], "friction": 0.4, "max_iterations": 7}).values()
    shown = told("bar", twin=twin)
    comments, rows = read(table("iterations", shown.scene()))
    numbers = shown.recording.history.column("iteration")
    assert len(numbers) > 1
    assert np.array_equal(column(rows, "B", "iteration"), numbers)
    assert shown.runs._twin is not None
    history = shown.runs._twin.recording.history
    assert np.array_equal(column(rows, "A", "indicator"), history.column("indicator"))
    assert "friction = 0.4\n" in comments[comments.index("settings of A:\n") :]
    _, rows = read(table("instants", shown.scene()))
    assert {row["run"] for row in rows} == {"A", "B", "reference"}


def test_a_table_that_is_asked_for_goes_to_the_browser_alone_and_once() -> None:
    shown = told("bar")
    shown.obey(Tabulate("iterations", 3))
    ((name, text, number),) = shown.files
    assert (name, number) == ("slipfront-bar-iterations.csv", 3)
    assert len(read(text)[1]) == len(shown.recording.history)
    shown.obey(Tabulate("iterations", 4))
    assert [file[2] for file in shown.files] == [3, 4]


@pytest.mark.parametrize("scene", list(CATALOGUE))
def test_a_page_of_a_run_has_all_instants_and_the_tables_in_it(scene: str) -> None:
    shown = told(scene)
    shown.obey(Tabulate(OFFLINE, 5))
    ((name, page, number),) = shown.files
    assert (name, number) == (f"slipfront-{scene}.html", 5)
    run = json.loads(re.findall(r"^const run = (.*)$", page, re.M)[0])
    recording = shown.recording
    assert len(run["pictures"]) == len(run["words"]) == len(recording.stand.instants)
    assert len({words["caption"] for words in run["words"]}) == len(run["words"])
    pictures = [base64.b64decode(picture) for picture in run["pictures"]]
    heads = [json.loads(one[4 : 4 + struct.unpack_from("<I", one)[0]]) for one in pictures]
    # What changes with time comes again and again, the rest once.
    assert all("stick-and-slip.curves" in head for head in heads)
    assert sum("convergence.y" in head for head in heads) == 1
    assert all(f'"name":"{one}"' in page or f'id="{one}"' in page for one in heads[0])
    kept = dict(re.findall(r'download="slipfront-\w+-(\w+).csv" href="[^,]*,([^"]*)"', page))
    looked_at = shown.scene()
    assert {what: base64.b64decode(text).decode() for what, text in kept.items()} == {
        what: table(what, looked_at) for what in TABLES
    }
