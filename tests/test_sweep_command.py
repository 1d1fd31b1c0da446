"""The command sweeps, goes on where it was, and refuses what is foolish in a line."""

from __future__ import annotations

import csv
import json
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from processes import started, wait_for
from sweeps import TINY, Here, rows_of, tiny

from solver import sweep_command
from solver.cli import main
from solver.study.chart import Chart, Map, Panel, PanelCurve
from solver.study.page import write_page
from solver.study.sweep import Plan
from solver.study.sweep.chart import chart_of, charts, ordered
from solver.study.sweep.point import Row

SMALL = [part for name, value in TINY.items() for part in ("--set", f"{name}={value}")]


@pytest.fixture
def here(monkeypatch: pytest.MonkeyPatch) -> Here:
    """Run sweeps of the command in this process, and draw no page."""
    monkeypatch.setattr(sweep_command, "write_page", lambda *given: "")
    pool = Here()

    class Opened:
        def __init__(self, *_: object) -> None: ...
        def __enter__(self) -> Here:
            return pool

        def __exit__(self, *_: object) -> None: ...

    monkeypatch.setattr(sweep_command, "opened", Opened)
    return pool


def command(folder: Path, *more: str, vary: str = "peak=300:900:4") -> int:
    of = [] if "--of" in more else ["--of", "peak_displacement,iterations"]
    return main(["sweep", "bar", *SMALL, "--vary", vary, *of, "--out", str(folder), *more])


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
    expected = [run.values for run in rows_of(tiny(["peak=300:900:4"], ["peak_displacement"]))]
    assert [(float(row["peak_displacement"]),) for row in rows] == expected
    head = (tmp_path / "sweep.csv").read_text(encoding="utf-8")
    assert "# elements = 20\n" in head
    assert "# peak = " not in head
    assert "# peak_displacement: Largest displacement (m)\n" in head
    assert "4 of 4 runs: 4 converged." in capsys.readouterr().out


@pytest.mark.usefixtures("here")
def test_the_page_needs_nothing_beside_it(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sweep_command, "write_page", write_page)
    assert command(tmp_path, "--vary", "friction=0.2,0.3,0.4") == 0
    page = (tmp_path / "sweep.html").read_text(encoding="utf-8")
    assert page.count("data-root-id") == 2
    assert "<link" not in page
    assert "<script src" not in page
    assert page.count("<tr>") == 1 + 12


def test_a_sweep_that_was_stopped_goes_on_where_it_was(tmp_path: Path, here: Here) -> None:
    assert command(tmp_path) == 0
    journal, whole = tmp_path / "sweep.jsonl", (tmp_path / "sweep.csv").read_text(encoding="utf-8")
    lines = journal.read_bytes().splitlines(keepends=True)
    # It was killed while it wrote its third row.
    journal.write_bytes(b"".join(lines[:3]) + lines[3][:20])
    before = here.calls
    assert command(tmp_path) == 0
    assert here.calls - before <= 2
    again = table(tmp_path)
    assert [(row["peak"], row["peak_displacement"]) for row in again] == [
        (row["peak"], row["peak_displacement"])
        for row in csv.DictReader(line for line in whole.splitlines() if line[0] != "#")
    ]
    assert command(tmp_path) == 0
    assert here.calls - before <= 2


def test_runs_whose_process_was_ended_are_tried_again(tmp_path: Path, here: Here) -> None:
    assert command(tmp_path) == 0
    journal = tmp_path / "sweep.jsonl"
    head, *lines = journal.read_text(encoding="utf-8").splitlines()
    rows = [json.loads(line) for line in lines]
    rows[0]["ending"], rows[1]["ending"] = "stuck", "lost"
    journal.write_text("\n".join([head, *map(json.dumps, rows), ""]), encoding="utf-8")
    assert command(tmp_path) == 0
    assert {row["ending"] for row in table(tmp_path)} == {"converged"}


@pytest.mark.usefixtures("here")
def test_a_folder_keeps_one_sweep(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert command(tmp_path) == 0
    assert command(tmp_path, vary="peak=300:900:5") == 2
    assert "a folder of the same sweep" in capsys.readouterr().err
    assert len(table(tmp_path)) == 4
    (tmp_path / "sweep.jsonl").write_text("no journal\n", encoding="utf-8")
    assert command(tmp_path) == 2


@pytest.mark.usefixtures("here")
def test_a_run_that_fails_is_a_line_and_the_exit_code_says_so(tmp_path: Path) -> None:
    assert command(tmp_path, vary="substructures=2,30") == 1
    fits, refused = table(tmp_path)
    assert (fits["ending"], refused["ending"]) == ("converged", "refused")
    assert "substructures = 30" in refused["reason"]


@pytest.mark.usefixtures("here")
def test_fields_can_be_kept(tmp_path: Path) -> None:
    assert command(tmp_path) == 0
    assert command(tmp_path, "--fields") == 0
    fields = sorted((tmp_path / "fields").iterdir())
    assert len(fields) == 4
    with np.load(fields[2]) as found:
        assert json.loads(str(found["settings"]))["peak"] == 700.0


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
def test_what_is_foolish_is_refused_in_a_line(
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


def test_a_killed_command_is_gone_on_with(tmp_path: Path) -> None:
    asked = [sys.executable, "-m", "solver", "sweep", "bar", "--vary", "peak=300:900:60"]
    asked += [*SMALL, "--of", "iterations", "--on", "processes:1", "--out", str(tmp_path)]
    journal = tmp_path / "sweep.jsonl"
    with started(asked):
        wait_for(lambda: journal.exists() and journal.read_bytes().count(b"\n") > 3)
    kept = journal.read_bytes()
    assert 3 < kept.count(b"\n") < 60
    assert main(asked[3:]) == 0
    assert journal.read_bytes().startswith(kept[: kept.rfind(b"\n") + 1])
    numbers = [json.loads(line)["number"] for line in journal.read_bytes().splitlines()[1:]]
    assert sorted(numbers) == list(range(60))


@pytest.mark.usefixtures("here")
def test_parquet_is_written_where_it_can_be(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "pyarrow", None)
    assert command(tmp_path) == 0
    assert not (tmp_path / "sweep.parquet").exists()
    written: dict[Path, dict[str, list[object]]] = {}

    class Table(dict[str, list[object]]):
        def replace_schema_metadata(self, metadata: dict[str, str]) -> Table:
            assert json.loads(metadata["slipfront"])["of"] == ["peak_displacement", "iterations"]
            return self

    arrow, parquet = ModuleType("pyarrow"), ModuleType("pyarrow.parquet")
    arrow.__dict__.update(table=Table, parquet=parquet)
    parquet.__dict__.update(write_table=lambda table, file: written.update({file: table}))
    monkeypatch.setitem(sys.modules, "pyarrow", arrow)
    monkeypatch.setitem(sys.modules, "pyarrow.parquet", parquet)
    assert command(tmp_path) == 0
    (columns,) = written.values()
    assert columns["peak"] == [300.0, 500.0, 700.0, 900.0]
    assert columns["ending"] == ["converged"] * 4


def holding(value: float, number: int = 0, ending: str = "converged") -> Row:
    return Row(number, ending, "", (value,))


def curves_of(chart: Chart) -> tuple[PanelCurve, ...]:
    """Give the curves through answers."""
    assert isinstance(chart, Panel)
    return tuple(curve for curve in chart.curves if curve.line == "solid")


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
    for number, x in zip(chart.runs.numbers, chart.runs.x, strict=True):
        value = next(iter(v for k, v in plan.point(int(number)).items() if k == axis_name(plan)))
        assert x == (list(plan.axes[0].values).index(value) if chart.x.names else value)


def axis_name(plan: Plan) -> str:
    return ordered(plan)[0].name


def test_a_map_has_its_values_where_they_belong_whatever_their_order() -> None:
    plan = tiny(["peak=900,300,500", "friction=0.7:0.1:7"], ["iterations"])
    chart = chart_of(plan, [holding(7.0, 8)])
    assert isinstance(chart, Map)
    assert chart.x_values.tolist() == [300.0, 500.0, 900.0]
    assert chart.y_values[-1] == 0.7
    assert np.argwhere(np.isfinite(chart.z)).tolist() == [[5, 0]]
    assert plan.point(8) == {"peak": 300.0, "friction": 0.6}


@pytest.mark.parametrize("turned", [False, True])
def test_names_make_a_curve_each(turned: bool) -> None:
    vary = ["k_scale=0.1:10:3:log", "acceleration=none,anderson"]
    plan = tiny(vary[::-1] if turned else vary, ["iterations"])
    rows = [holding(float(plan.point(n)["k_scale"]), n) for n in range(6)]
    (panel,) = charts(plan, rows)
    curves = curves_of(panel)
    assert [curve.label for curve in curves] == ["Acceleration none", "Acceleration anderson"]
    assert all(curve.y.tolist() == [0.1, 1.0, 10.0] for curve in curves)
    assert panel.x.logarithmic
    assert panel.y.logarithmic


def test_rows_become_points_whatever_came_of_them_and_say_it() -> None:
    plan = tiny(["friction=0.1:0.5:5"], ["iterations_to_force@0.1"])
    rows = [
        Row(4, "converged", "", (3.0,)),
        Row(0, "exhausted", "Raise max_iterations.", (12.0,)),
        Row(1, "converged", "", (np.inf,)),
        Row(2, "refused", "no", (np.nan,)),
    ]
    chart = chart_of(plan, rows)
    runs = chart.runs
    assert runs is not None
    assert runs.numbers.tolist() == [4, 0, 1, 2]
    assert runs.holds.tolist() == [True, False, False, False]
    assert [said.partition(": ")[2] for said in runs.said] == [
        "3",
        "12; exhausted: Raise max_iterations.",
        "never",
        "refused: no",
    ]
    (curve,) = curves_of(chart)
    assert curve.x.tolist() == [0.1, 0.2, 0.3, 0.5]
    assert np.isfinite(curve.y).tolist() == [False, False, False, True]
