"""`python -m solver figures` writes what it promises, or says in one line why not."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from solver import report_commands
from solver.cli import main
from solver.study.chart import Panel, PanelAxis, PanelCurve
from solver.study.figures.figure import Finding, PaperFigure
from solver.study.figures.figure_report import paper_figures

ROOT = Path(__file__).resolve().parents[1]
NUMBERS = (3, 4, 5, 6, 7, 8)
SIGNATURE = b"\x89PNG\r\n\x1a\n"
SMALL = PaperFigure(
    3,
    "A <small> figure",
    (
        Panel(
            "Panel",
            PanelAxis("Place", "m"),
            PanelAxis("Force", "N"),
            [PanelCurve("c", *np.eye(2), 1)],
        ),
    ),
    "It is < the paper's.",
    (Finding("One is 1.", {"one": 1.0}, True), Finding("Two is 1.", {"two": 1.0}, False)),
    "Caption.",
)


@pytest.fixture(scope="module")
def figures(paper_runs):
    return paper_figures(paper_runs)


def test_all_figures_together_solve_nothing_twice(figures, solved):
    assert tuple(figure.number for figure in figures) == NUMBERS
    assert solved.count("incremental") == 1
    assert solved.count("solve") == 2 * 4  # to the early iterate, and on from there


@pytest.fixture(scope="module")
def written(tmp_path_factory, figures):
    folder = tmp_path_factory.mktemp("made") / "by" / "the command"
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(report_commands, "paper_figures", lambda: figures)
        assert main(["figures", "--out", str(folder)]) == 0
    return folder


def test_six_pictures_and_a_page_are_written(written):
    names = {f"figure-{number}.png" for number in NUMBERS} | {"figures.html"}
    assert {file.name for file in written.iterdir()} == names
    for number in NUMBERS:
        content = (written / f"figure-{number}.png").read_bytes()
        assert content.startswith(SIGNATURE)
        assert 5_000 < len(content) < 60_000


def test_the_page_stands_alone_and_shows_every_figure_with_claim_numbers_and_caption(
    written, figures
):
    page = (written / "figures.html").read_text(encoding="utf-8")
    assert page.count("data-root-id") == sum(len(figure.panels) for figure in figures)
    assert not re.search(r"<link|<script src|<img|@import", page)
    plain = page.replace("&#x27;", "'").replace("&lt;", "<").replace("&quot;", '"')
    for figure in figures:
        for words in (figure.claim, figure.caption, figure.title, figure.verdict):
            assert words in plain
        for found in figure.findings:
            assert found.text in plain


def test_every_axis_has_a_unit_or_is_a_pure_number_and_every_caption_tells_the_load(figures):
    pure = {"Iteration", "Mode n", "LATIN indicator η", "Relative error"}
    pure |= {"Singular value / largest"}
    for figure in figures:
        assert "900 N" in figure.caption
        for panel in figure.panels:
            for axis in (panel.x, panel.y):
                assert bool(axis.unit) != (axis.quantity in pure)
            for curve in panel.curves:
                assert curve.label
                assert curve.x.shape == curve.y.shape
                assert np.isfinite(curve.y).all()


def test_fig_3_multiscale_gains_early_in_the_error_more_than_in_the_indicator(figures):
    values = figures[0].values
    assert values["error_displacement_mono"] > 2.5 * values["error_displacement_multi"]
    assert 1.2 < values["indicator_mono"] / values["indicator_multi"] < 2.0
    early = [values[f"early_indicator_{version}"] for version in ("multi", "mono")]
    assert early[0] == pytest.approx(early[1], rel=0.3)


def test_fig_3_the_rates_agree_in_the_end_but_not_while_the_indicator_is_large(figures):
    values = figures[0].values
    for name in ("indicator", "error_displacement", "error_force"):
        assert values[f"rate_400_800_{name}"] == pytest.approx(1.0, abs=0.15)
    assert values["rate_30_200_indicator"] == pytest.approx(1.0, abs=0.2)
    assert values["rate_30_80_indicator"] > 1.5


def test_fig_4_only_multiscale_balances_the_bar_after_ten_iterations(figures):
    values = figures[1].values
    assert abs(values["total_multiscale"]) < 1e-3 * values["size"]
    assert values["total_monoscale"] > 0.1 * values["size"]


@pytest.mark.parametrize("instant", ["0.5", "1"])
def test_fig_4_multiscale_has_the_global_answer_but_not_yet_the_friction_force(figures, instant):
    values = figures[1].values
    assert values[f"displacement_mono_{instant}"] > 2.0 * values[f"displacement_multi_{instant}"]
    assert 0.25 < values[f"force_multi_{instant}"] < 0.45 < values[f"force_mono_{instant}"]


def test_claim_numbers_and_verdict_are_printed_and_the_default_folder_is_figures(
    tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(report_commands, "paper_figures", lambda: [SMALL])
    assert main(["figures"]) == 0
    out, err = capsys.readouterr()
    assert err == ""
    assert out.splitlines() == [
        "Fig. 3: A <small> figure (holds in part)",
        "  + One is 1.",
        "  - Two is 1.",
        "2 files in figures",
    ]
    page = (tmp_path / "figures" / "figures.html").read_text(encoding="utf-8")
    assert "A &lt;small&gt; figure" in page
    assert "<small>" not in page.partition("<h1>")[2]


@pytest.mark.parametrize(
    "obstacle", ["folder is a file", "picture is a folder", "parent is a file"]
)
def test_a_folder_that_cannot_be_written_to_is_refused_in_one_line(
    tmp_path, monkeypatch, capsys, obstacle
):
    monkeypatch.setattr(report_commands, "paper_figures", lambda: [SMALL])
    folder = tmp_path / "out"
    if obstacle == "picture is a folder":
        (folder / "figure-3.png").mkdir(parents=True)
    else:
        folder.write_text("in the way", encoding="utf-8")
    target = folder / "below" if obstacle == "parent is a file" else folder
    assert main(["figures", "--out", str(target)]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert len(err.splitlines()) == 1
    assert "--out" in err
    assert "a folder that can be made and written to" in err


def program(text, folder):
    return subprocess.run(
        [sys.executable, "-c", text],
        cwd=folder,
        env={"PYTHONPATH": str(ROOT), "HOME": str(folder)},
        capture_output=True,
        text=True,
        check=False,
    )


def test_without_matplotlib_there_is_the_page_alone_and_a_line_says_what_to_install(
    tmp_path, monkeypatch, capsys
):
    monkeypatch.setattr(report_commands, "paper_figures", lambda: [SMALL])
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    for module in [name for name in sys.modules if name.startswith("matplotlib.")]:
        monkeypatch.delitem(sys.modules, module)
    assert main(["figures", "--out", str(tmp_path)]) == 0
    assert {file.name for file in tmp_path.iterdir()} == {"figures.html"}
    assert "PNG files need matplotlib: pip install 'slipfront[figures]'" in (
        capsys.readouterr().out.splitlines()
    )


def test_nothing_else_loads_matplotlib(tmp_path):
    done = program(
        "import sys\nfrom solver.cli import main\nimport solver.study.figures.figure_report\n"
        "main(['scenes'])\nsys.exit('matplotlib' in sys.modules)\n",
        tmp_path,
    )
    assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("number", [3, 5])
def test_the_pictures_of_the_measurements_are_small(number):
    name = f"static/figure-{number}.png"
    assert name in (ROOT / "solver" / "study" / "README.md").read_text(encoding="utf-8")
    assert (ROOT / name).stat().st_size < 60_000
