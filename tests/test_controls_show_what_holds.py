"""A control shows what holds, in numbers that can be read, also after an edit was refused."""

from __future__ import annotations

from typing import Any

import pytest
from lone_link import LoneLink

from app.form import POINTS, USUAL, item_of
from app.pages import Pages
from app.session import Session
from app.sidebar import Sidebar
from app.worker.bench import Bench
from solver.definitions import Curve
from solver.scenes import CATALOGUE
from solver.scenes.bar import BarSettings

TABLE = [(0.0, 0.0), (1.0, 500.0)]


@pytest.fixture
def sidebar() -> Sidebar:
    settings = BarSettings.checked({"method": "paper", "load": TABLE})
    session = Session(Pages(1), Bench(), settings, LoneLink().hire)
    made = Sidebar(session, lambda: None, lambda text: None, lambda: None, lambda name: None)
    made.show(settings)
    return made


def edited(sidebar: Sidebar, value: Any) -> Any:
    """Edit the load path, and give what is shown of it."""
    sidebar.hear("load", value, False, 7)
    sidebar.obey()
    # What tells the browser that this edit was heard, and is to show what came of it.
    assert sidebar.view.shown[""] == 7
    return sidebar.view.shown["load"]


def test_a_refused_edit_is_answered_with_what_holds(sidebar: Sidebar) -> None:
    assert edited(sidebar, [[0, 0], [0, 500]]) == tuple(TABLE)


def test_a_slider_that_was_refused_is_answered_when_it_is_let_go(sidebar: Sidebar) -> None:
    sidebar.hear("substructures", 51, True, 1)
    sidebar.hear("substructures", None, False, 2)
    assert (sidebar.view.shown["substructures"], sidebar.view.shown[""]) == (10, 2)


def test_what_is_brought_back_has_the_value_of_its_method(sidebar: Sidebar) -> None:
    for name, typed, usual in (("tolerance", 1e-3, 1e-10), ("pressure", 700.0, 5000.0)):
        sidebar.hear(name, typed, False, 1)
        sidebar.obey()
        assert sidebar.view.shown[name] == typed
        sidebar.hear(name, USUAL, False, 2)
        sidebar.obey()
        assert sidebar.view.shown[name] == usual


def test_a_word_in_place_of_a_number_is_refused(sidebar: Sidebar) -> None:
    told: list[str] = []
    sidebar._complain = told.append
    sidebar.hear("pressure", "many", False, 1)
    sidebar.obey()
    (words,) = told
    assert words.startswith('pressure = "many" is refused; allowed: a number from')
    assert sidebar.view.shown["pressure"] == 5000.0


def test_an_edit_that_is_taken_stays(sidebar: Sidebar) -> None:
    assert edited(sidebar, [[0, 0], [2, 500]]) == ((0.0, 0.0), (2.0, 500.0))


def test_a_table_begins_as_the_preset_that_it_replaces(sidebar: Sidebar) -> None:
    assert edited(sidebar, "triangle") == "triangle"
    rows = edited(sidebar, POINTS)
    assert max(force for _, force in rows) == 900.0


def test_only_controls_that_apply_have_a_value(sidebar: Sidebar) -> None:
    assert "substructures" in sidebar.view.shown
    assert "seed" not in sidebar.view.shown
    edited(sidebar, "random")
    assert "seed" in sidebar.view.shown


def test_columns_of_a_table_have_units() -> None:
    made = item_of("load", BarSettings.definitions()["load"])
    assert made is not None
    assert made["columns"] == ["time (s)", "force (N)"]
    for entry in CATALOGUE.values():
        for definition in entry.settings.definitions().values():
            if isinstance(definition, Curve):
                assert definition.units[0] == {"time": "s", "position": "m"}[definition.abscissa]
                assert bool(definition.units[1]) == (definition.ordinate != "factor")
