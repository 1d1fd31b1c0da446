"""A loop opened on the page is read as its dialog says, drawn and fitted."""

from __future__ import annotations

import time
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from bars import SMALL

from app.experiments.fit import FitTab
from app.files.opener import TableOpener
from app.files.tables import TABLES
from app.messages import Needs, Start
from app.state import PageState, default_settings
from app.worker.references import ReferenceCache
from app.worker.runner import Runner
from solver.settings.scene import Settings
from solver.study.measured_loop import MeasuredLoop
from solver.study.scene_run import finished_run
from solver.study.table_use import Use


def bar(**values: Any) -> Settings:
    law = {"load": "cycle", "friction_law": "compliant", "contact_stiffness": 8.0}
    return default_settings("bar").replace(**SMALL, **law | values)


def loop_of_a_run(settings: Settings) -> MeasuredLoop:
    run = finished_run(settings, errors=False, indicators=False)
    return MeasuredLoop(run.displacement, run.force, None, ("m", "N"), "made.csv", "")


def opener(state: PageState, text: str, name: str = "rig.csv") -> TableOpener:
    made = TableOpener(state, "Open", TABLES, 200)
    made.file.filename = name
    made.file.value = text.encode()
    return made


def finished_runner(settings: Settings) -> Runner:
    """Runner of a worker at the end of its run."""
    runner = Runner(Start(1, settings, float("inf")), ReferenceCache(), lambda: False)
    while runner.status is None:
        runner.advance()
    return runner


def test_a_loop_is_read_by_its_head_and_as_the_dialog_says() -> None:
    state = PageState(bar())
    made = opener(state, "Weg [mm],Kraft [kN]\n0,0\n1,0.5\n2,0.7\n1,0.1\n0,-0.4\n")
    loop = state.brought
    assert isinstance(loop, MeasuredLoop)
    assert made.dialog.open
    assert loop.force.tolist() == [0.0, 500.0, 700.0, 100.0, -400.0]
    assert "Weg in mm, Kraft in kN" in made.message.object
    assert (made.use.value, made.heads.value) == (Use.LOOP, "Weg [mm], Kraft [kN]")
    made.heads.value = "Weg [µm], Kraft [kN]"
    assert state.brought.displacement.max() == pytest.approx(2e-6)
    assert "passed over" not in made.message.object
    made.heads.value = "Weg [µm], Kraft [kN], time [ms]"
    assert state.brought.times.tolist() == pytest.approx([0.0, 1e-3, 2e-3, 3e-3, 4e-3])
    made.use.value = "load"
    assert state.brought is not None
    assert state.settings.load[:2] == ((0.0, 0.0), (1e-3, 500.0))
    assert state.settings.duration == pytest.approx(4e-3)
    made.heads.value = "Weg [µm], Kraft [kN], time [min]"
    assert state.settings.duration == 240.0
    made.remove_button.clicks += 1
    assert state.brought is None


def test_a_loop_without_units_is_doubted_beside_the_run_that_is_shown() -> None:
    settings = bar(start="nested", finish="at-once")
    runner = finished_runner(settings)
    state = PageState(settings)
    state.frame = runner.frame(Needs())
    loop = loop_of_a_run(settings)
    rows = "".join(
        f"{1e3 * u},{f}\n" for u, f in zip(loop.displacement, loop.force, strict=True)
    )
    made = opener(state, f"disp,force\n{rows}")
    assert "1000 times that of the run: if it is in mm" in made.message.object
    made.heads.value = "disp [mm], force"
    assert "times that of" not in made.message.object


def test_columns_without_names_are_named_and_what_is_no_number_is_said() -> None:
    state = PageState(bar())
    made = opener(state, "1,0,7,5\n2,1,7,6\n3,2,7,x\n4,3,7,9\n")
    assert "finite numbers" in made.message.object or "columns" in made.message.object
    made.use.value = Use.LOOP
    made.heads.value = "force, displacement"
    assert "4 columns" in made._understood.object
    made.heads.value = "force, displacement, 3, 4"
    assert isinstance(state.brought, MeasuredLoop)
    assert state.brought.displacement.tolist() == [0.0, 1.0, 2.0, 3.0]
    made.heads.value = "1, displacement, 3, force"
    assert "line 3" in made._understood.object
    assert state.brought.force.tolist() == [1.0, 2.0, 3.0, 4.0]


def test_a_table_of_time_and_load_is_a_path_without_a_dialog() -> None:
    state = PageState(bar())
    made = opener(state, "time,force\n0,0\n1,800\n2,0\n")
    assert state.settings.load == ((0.0, 0.0), (1.0, 800.0), (2.0, 0.0))
    assert not made.dialog.open
    assert made.use.value == "load"
    made.heads.value = "time, force [kN]"
    assert state.settings.load[1] == (1.0, 800_000.0)


def test_the_loop_comes_with_the_frame_and_its_distance() -> None:
    settings = bar(start="nested", finish="at-once")
    runner = finished_runner(settings)
    loop = loop_of_a_run(settings)
    off = MeasuredLoop(
        loop.displacement + 0.1 * np.ptp(loop.displacement),
        *(loop.force, None, loop.units, "off.csv", ""),
    )
    found = runner.frame(Needs(frozenset({"beside"}), brought=off)).extras["beside"]
    assert found["distance"] == pytest.approx(0.1, rel=1e-6)
    assert found["brought"].force.tolist() == loop.force.tolist()
    moment = MeasuredLoop(
        loop.displacement, loop.force, None, ("1/m", "N·m"), "rope.csv", ""
    )
    assert (
        runner.frame(Needs(frozenset({"beside"}), brought=moment)).extras["beside"]
        is None
    )


def test_the_tab_shows_a_fit_with_its_scene_and_its_loop_alone_and_opens_it() -> None:
    stiff = {"young": 210_123_456_789.0}
    state = PageState(bar(friction=0.3, **stiff), tab="Fit")
    tab = FitTab(state)
    assert tab.start_button.disabled
    loop = loop_of_a_run(bar(friction=0.37, **stiff))
    state.brought = loop
    assert tab.start_button.disabled
    tab.chosen.value = ["friction"]
    assert not tab.start_button.disabled
    tab.start()
    folder = tab.job.folder
    while tab.job is not None:
        assert tab.cancel_button.visible
        time.sleep(0.2)
        tab.look()
    assert not folder.exists()
    assert "standard error" in tab.page.object, tab.progress.object
    # Named as its owner does, and without digits of rounding.
    assert "less than 0.001 % from made.csv" in tab.page.object
    assert tab.use_button.visible
    fitted = state.settings
    state.settings = default_settings("rope")
    assert not tab.use_button.visible
    assert not tab.page.object
    assert "made.csv is of another scene: it has m and N" in tab.words
    state.settings = fitted
    assert "standard error" in tab.page.object
    state.brought = loop_of_a_run(bar(friction=0.4))
    assert not tab.page.object
    assert not tab.files.objects
    state.brought = loop
    tab.use()
    assert state.tab == "Live"
    assert state.settings.friction == 0.37
    # What was not fitted has all its digits.
    assert state.settings.young == stiff["young"]
    state.param.update(tab="Fit", brought=None)
    assert tab.start_button.disabled
    assert "standard error" in tab.page.object
    tab.end()


def test_progress_has_titles_of_settings_and_sentences_keep_their_words() -> None:
    tab = FitTab(PageState(bar(), tab="Fit"))
    said = tab.said("8 runs: friction 0.37, peak -900 N, young 1.9e+11 Pa, 2 % away")
    assert said == (
        "8 runs: Friction coefficient μ 0.37, Peak load −900 N, "
        "Young's modulus E 190 GPa, 2 % away"
    )
    sentence = "The loop is of no peak: friction changes nothing"
    assert tab.said(sentence) == sentence


def test_a_fit_of_any_name_is_cancelled_or_refused_in_words_and_leaves_nothing() -> (
    None
):
    state = PageState(bar(), tab="Fit")
    tab = FitTab(state)
    # It begins as an option does, and has more bytes than a system takes.
    name = f"(1) {'Δ' * 200}.csv"
    state.brought = replace(loop_of_a_run(bar(load="random")), source=name)
    tab.chosen.value = ["friction"]
    tab.start()
    folder = tab.job.folder
    while tab.job is not None:
        time.sleep(0.1)
        tab.look()
    assert "ΔΔΔ.csv: " in tab.progress.object
    assert "goes one way 3 times" in tab.progress.object
    assert not folder.exists()
    state.change(elements=400, substructures=1, instants=400)
    state.brought = loop_of_a_run(bar())
    tab.start()
    folder = tab.job.folder
    tab.cancel()
    assert tab.job is None
    assert tab.progress.object == "Fit: Cancelled."
    assert not folder.exists()
