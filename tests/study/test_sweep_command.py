"""Sweeps: the command, and its plan."""

from __future__ import annotations

import csv
from collections.abc import Callable
from contextlib import nullcontext
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sweeps import TINY, Here, rows_of, tiny

from solver.commands import reports as report_commands
from solver.commands.cli import main
from solver.scenes.bar import BarSettings
from solver.settings.values import SettingError
from solver.study.page import Map, Panel
from solver.study.sweep.charts import chart_of
from solver.study.sweep.plan import Row, axis_of, plan_of
from solver.study.sweep.report import write_sweep
from solver.study.sweep.run import snake

SMALL = [f"--set={name}={value}" for name, value in TINY.items()]


@pytest.fixture
def here(monkeypatch: pytest.MonkeyPatch) -> Here:
    """Run sweeps of the command in this process, and draw no page."""
    monkeypatch.setattr(report_commands, "write_sweep", lambda *given: None)
    executor = Here()
    monkeypatch.setattr(report_commands, "opened", lambda *given: nullcontext(executor))
    return executor


def command(folder: Path, *more: str, vary: str = "peak=300:900:4") -> int:
    if "--of" in more:
        of = []
    else:
        of = ["--of", "peak_displacement,iterations"]
    return main(
        ["sweep", "bar", *SMALL, "--vary", vary, *of, "--out", str(folder), *more]
    )


def table(folder: Path) -> list[dict[str, str]]:
    lines = (folder / "sweep.csv").read_text(encoding="utf-8").splitlines()
    return list(csv.DictReader(line for line in lines if not line.startswith("#")))


@pytest.mark.usefixtures("here")
def test_the_table_holds_what_varies_what_is_asked_and_what_is_fixed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert command(tmp_path) == 0
    rows = table(tmp_path)
    assert [float(row["peak"]) for row in rows] == [300.0, 500.0, 700.0, 900.0]
    expected = [
        run.values for run in rows_of(tiny(["peak=300:900:4"], ["peak_displacement"]))
    ]
    assert [(float(row["peak_displacement"]),) for row in rows] == expected
    head = (tmp_path / "sweep.csv").read_text(encoding="utf-8")
    assert "# elements = 20\n" in head
    assert "# peak = " not in head
    assert "# peak_displacement: Largest displacement (m)\n" in head
    assert "4 of 4 runs: 4 converged." in capsys.readouterr().out


@pytest.mark.usefixtures("here")
def test_the_page_needs_nothing_beside_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(report_commands, "write_sweep", write_sweep)
    assert command(tmp_path, "--vary", "friction=0.2,0.3,0.4") == 0
    page = (tmp_path / "sweep.html").read_text(encoding="utf-8")
    assert page.count("data-root-id") == 2
    assert "<link" not in page
    assert "<script src" not in page
    assert page.count("<tr>") == 1 + 12


def rewrite(folder: Path, change: Callable[[list[str]], list[str]]) -> None:
    """Change the rows of the table of a sweep, as lines."""
    lines = (folder / "sweep.csv").read_text(encoding="utf-8").splitlines(keepends=True)
    n_rows = len(table(folder))
    text = "".join([*lines[:-n_rows], *change(lines[-n_rows:])])
    (folder / "sweep.csv").write_text(text, encoding="utf-8")


def test_a_sweep_that_was_killed_while_it_wrote_a_row_goes_on_where_it_was(
    tmp_path: Path, here: Here
) -> None:
    assert command(tmp_path) == 0
    whole = table(tmp_path)
    calls = here.calls
    rewrite(tmp_path, lambda rows: [*rows[:2], rows[2][:20]])
    assert command(tmp_path) == 0
    assert here.calls == calls + 2
    answers = "peak", "peak_displacement", "iterations", "ending"
    assert [[row[name] for name in answers] for row in table(tmp_path)] == [
        [row[name] for name in answers] for row in whole
    ]
    assert table(tmp_path)[:2] == whole[:2]
    assert command(tmp_path) == 0
    assert here.calls == calls + 2


def test_runs_whose_process_was_ended_are_tried_again(
    tmp_path: Path, here: Here
) -> None:
    assert command(tmp_path) == 0
    calls = here.calls
    rewrite(
        tmp_path,
        lambda rows: [
            row.replace("converged", ending)
            for row, ending in zip(
                rows, ["stuck", "lost", "refused", "broken"], strict=True
            )
        ],
    )
    assert command(tmp_path) == 1
    assert here.calls == calls + 2
    endings = [row["ending"] for row in table(tmp_path)]
    assert endings == ["converged", "converged", "refused", "broken"]


@pytest.mark.usefixtures("here")
@pytest.mark.parametrize(
    "more",
    [["--vary", "friction=0.2,0.3"], ["--set", "friction=0.2"], ["--of", "stiffness"]],
)
def test_the_folder_of_another_sweep_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], more: list[str]
) -> None:
    assert command(tmp_path) == 0
    assert command(tmp_path, *more) == 2
    assert command(tmp_path, vary="peak=300:901:4") == 2
    assert "a folder of the same sweep" in capsys.readouterr().err
    assert len(table(tmp_path)) == 4


@pytest.mark.usefixtures("here")
def test_a_table_of_something_else_is_not_overwritten(tmp_path: Path) -> None:
    (tmp_path / "sweep.csv").write_text("a,b\n1,2\n", encoding="utf-8")
    assert command(tmp_path) == 2
    assert (tmp_path / "sweep.csv").read_text(encoding="utf-8") == "a,b\n1,2\n"


@pytest.mark.parametrize(
    "more",
    [
        ["--of", "dissipated"],
        ["--of", ""],
        ["--on", "threads"],
        ["--limit", "0"],
        ["--vary", "peak=1:2:3"],
        ["--vary", "friction=-3"],
        ["--out", "/dev/null/sweep"],
    ],
    ids=str,
)
def test_bad_arguments_are_refused_in_a_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], more: list[str]
) -> None:
    assert command(tmp_path, *more) == 2
    said = capsys.readouterr().err
    assert said.startswith("slipfront: ")
    assert len(said.splitlines()) == 1


@pytest.mark.usefixtures("here")
def test_a_setting_that_does_nothing_is_told(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert command(tmp_path, vary="pgd_modes=2,3") == 0
    assert "pgd_modes does nothing" in capsys.readouterr().err
    assert command(tmp_path / "other", vary="substructures=1,30") == 1
    assert capsys.readouterr().err == ""


def holding(value: float, number: int = 0, ending: str = "converged") -> Row:
    return Row(number, ending, "", (value,))


@pytest.mark.parametrize(
    ("vary", "across", "size"),
    [
        (["friction=0.1:0.5:5"], "Friction coefficient μ", None),
        (["friction=0.1:0.5:5", "peak=100:900:9"], "Friction coefficient μ", (9, 5)),
        (["friction=0.1:0.5:5", "peak=100,900"], "Friction coefficient μ", None),
        (["acceleration=none,anderson", "peak=100:900:9"], "Peak load", None),
        (["multiscale=true,false"], "Multiscale (coarse problem)", None),
    ],
)
def test_two_numbers_make_a_map_and_names_or_few_values_make_curves(
    vary: list[str], across: str, size: tuple[int, int] | None
) -> None:
    plan = tiny(vary, ["seconds"])
    chart = chart_of(plan, [holding(float(n), n) for n in range(plan.size)])
    assert chart.x.quantity == across
    assert (chart.z.shape if isinstance(chart, Map) else None) == size
    assert chart.runs is not None
    for number, x in enumerate(chart.runs.x):
        value = plan.point(number)[plan.axes[0].name]
        assert x == (list(plan.axes[0].values).index(value) if chart.x.names else value)


def test_values_of_a_report_are_in_units_that_people_read() -> None:
    plan = tiny(["peak=300,900000", "settlement=0.00001,0.002"], ["peak_displacement"])
    chart = chart_of(plan, [holding(2.5e-4, 3)])
    assert isinstance(chart, Panel)
    labels = [curve.label for curve in chart.curves]
    assert [label.rpartition("Settlement ")[2] for label in labels] == ["10 µm", "2 mm"]
    assert chart.runs is not None
    (message,) = chart.runs.said
    assert message == "Peak load 900 kN, Settlement 2 mm: 250 µm"


BAR = BarSettings.checked({})
ANY = settings(max_examples=60)


def values_of(text: str) -> list[Any]:
    return list(axis_of(BAR, text).values)


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("friction=0.1:0.6:6", [0.1, 0.2, 0.3, 0.4, 0.5, 0.6]),
        ("k_scale=0.01:100:5:log", [0.01, 0.1, 1.0, 10.0, 100.0]),
        ("load=triangle,sine,triangle", ["triangle", "sine"]),
        ("multiscale=true,false", [True, False]),
        ("substructures=1:4:31", [1, 2, 3, 4]),
    ],
)
def test_a_range_holds_its_ends_and_what_is_between_and_a_list_each_value_once(
    text: str, values: list[Any]
) -> None:
    assert values_of(text) == values


FOOLISH = [
    (
        ["frction=0.1:0.6:3"],
        ["iterations"],
        "did you mean friction (Coefficient of friction",
    ),
    (["friction"], ["iterations"], "name a setting and its values"),
    (["friction=0.1:0.6"], ["iterations"], "three numbers"),
    (["friction=0.1:0.6:1"], ["iterations"], "whole number from 2"),
    (["friction=0.1:0.1:5"], ["iterations"], "the two ends differ"),
    (["friction=-0.1:0.1:5"], ["iterations"], "inside this range"),
    (["peak=-1:1:5:log"], ["iterations"], "above zero"),
    (["load=sine:ramp:3"], ["iterations"], "list its values"),
    (["friction=0.1,,0.2"], ["iterations"], "write a number"),
    (["friction=0.1,0.2", "friction=0.3,0.4"], ["iterations"], "each of them once"),
    (["friction=0.1:1:150", "peak=1:900:150"], ["iterations"], "22500"),
    (
        ["friction=0.1,0.2", "peak=1,2", "elements=9,10"],
        ["iterations"],
        "vary one or two",
    ),
    (["friction=0.1,0.2"], [], "at least one"),
    (["friction=0.1,0.2"], ["dissipated"], "choose one of these"),
    (["friction=0.1,0.2"], ["iterations@3"], "takes no parameter"),
]


@pytest.mark.parametrize(
    ("vary", "of", "words"), FOOLISH, ids=lambda value: str(value)[:40]
)
def test_a_foolish_plan_is_refused_in_a_line(
    vary: list[str], of: list[str], words: str
) -> None:
    with pytest.raises(SettingError) as refusal:
        plan_of(BAR, vary, of)
    assert words in str(refusal.value)
    assert "\n" not in str(refusal.value)


@ANY
@given(st.lists(st.integers(1, 12), min_size=1, max_size=2))
def test_the_path_goes_through_every_point_once_from_neighbour_to_neighbour(
    shape: list[int],
) -> None:
    path = snake(shape)
    if len(shape) == 2:
        size = shape[0] * shape[-1]
    else:
        size = shape[0]
    assert sorted(path) == list(range(size))
    for one, next_one in pairwise(path):
        places = [divmod(number, shape[-1]) for number in (one, next_one)]
        assert sum(abs(a - b) for a, b in zip(*places, strict=True)) == 1
