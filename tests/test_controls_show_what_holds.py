"""A control shows what holds, in numbers that can be read, also after an edit was refused."""

from __future__ import annotations

import re
from types import SimpleNamespace
from typing import Any

import param
import pytest
from lone_link import lone_session

from app.components.form import ENDS, POINTS, UNITS, USUAL, item_of
from app.controls.refusals import field_of, refused
from app.controls.sidebar import Sidebar
from app.picture.units import BY_SIZE, MM, SI
from app.session.undo import Undo
from app.shell import notes
from app.shell.actions import Actions
from solver.definitions import CurveParameter, SettingError, about
from solver.scenes import CATALOGUE
from solver.scenes.bar import BarSettings

TABLE = [(0.0, 0.0), (1.0, 500.0)]


@pytest.fixture
def sidebar() -> Sidebar:
    settings = BarSettings.checked({"method": "paper", "load": TABLE})
    session = lone_session(settings)
    return Sidebar(session, lambda name: None)


def edited(sidebar: Sidebar, value: Any) -> Any:
    """Edit the load path, and give what is shown of it."""
    sidebar.hear("load", value, False, 7)
    sidebar.obey()
    # What tells the browser that this edit was heard, and is to show what came of it.
    assert sidebar.view.shown[""] == 7
    return sidebar.view.shown["load"]


def test_a_refused_edit_is_answered_with_what_holds(sidebar: Sidebar) -> None:
    assert edited(sidebar, [[0, 0], [0, 500]]) == tuple(TABLE)


def test_a_slider_beyond_its_end_is_answered_with_that_when_it_is_let_go(sidebar: Sidebar) -> None:
    sidebar.hear("substructures", 51, True, 1)
    sidebar.hear("substructures", None, False, 2)
    assert (sidebar.view.shown["substructures"], sidebar.view.shown[""]) == (50, 2)


def test_what_is_brought_back_has_the_value_of_its_method(sidebar: Sidebar) -> None:
    for name, typed, usual in (("tolerance", 1e-3, 1e-10), ("pressure", 700.0, 5000.0)):
        sidebar.hear(name, typed, False, 1)
        sidebar.obey()
        assert sidebar.view.shown[name] == typed
        sidebar.hear(name, USUAL, False, 2)
        sidebar.obey()
        assert sidebar.view.shown[name] == usual


def test_a_word_in_place_of_a_number_is_refused(sidebar: Sidebar) -> None:
    sidebar.hear("pressure", "many", False, 1)
    said = "Pressure p cannot be “many”: write a number. Allowed: any number from 0 on "
    assert sidebar._session.refusal == f"{said}(to 1·10¹² kN/m)."
    assert sidebar.view.shown["pressure"] == 5000.0
    sidebar.hear("pressure", 6000.0, False, 2)
    sidebar.obey()
    assert sidebar._session.refusal == "", "it is told until the value is right"


@pytest.fixture
def strand() -> Sidebar:
    settings = CATALOGUE["strand"].settings.checked({})
    session = lone_session(settings)
    return Sidebar(session, lambda name: None)


def test_what_was_moved_is_refused_and_not_what_it_does_not_go_with(strand: Sidebar) -> None:
    strand._on_setting("friction", 0.01)
    told = strand._session.refusal
    assert told.startswith("Friction coefficient μ cannot be 0.01 while Peak tension is 600 N. ")
    assert "peak =" not in told


@pytest.mark.parametrize(
    ("units", "value", "allowed"),
    [(BY_SIZE, "2000 mm²", "1·10⁸ mm²"), (MM, "2000 mm²", "1·10⁸ mm²"), (SI, "0.002 m²", "100 m²")],
)
def test_a_refusal_is_in_the_unit_that_the_field_shows(
    sidebar: Sidebar, units: str, value: str, allowed: str
) -> None:
    sidebar.hear(UNITS, units, False, 1)
    sidebar.hear("section", -2e-3, False, 2)
    told = sidebar._session.refusal
    assert told.startswith(f"Cross section S cannot be -{value}: ")
    assert told.endswith(f" to {allowed}.")


def test_a_refusal_follows_the_value_and_where_that_is_zero_the_slider(sidebar: Sidebar) -> None:
    for held, unit in ((0.0, "kN"), (5.0, "N"), (5e3, "kN"), (-5e6, "MN")):
        settings = BarSettings.checked({"peak": held})
        assert field_of(settings, "peak", BY_SIZE)[1] == unit
        with pytest.raises(SettingError) as refusal:
            settings.with_change("peak", 1e20)
        told = refused(refusal.value, settings, "peak", 1e20)
        assert re.fullmatch(
            rf"Peak load cannot be 1·10[⁰¹²⁴⁷⁹]+ {unit}: .* 1·10[¹²⁹⁵]+ {unit} in size\)\.", told
        )


def test_a_force_that_a_refusal_names_is_in_the_unit_of_its_field() -> None:
    strong = CATALOGUE["strand"].settings.checked({"pressure": 5e6, "peak": 5e3})
    for name, value in (("peak", 9e6), ("load", [[0.0, 0.0], [1.0, 9e6]])):
        with pytest.raises(SettingError) as refusal:
            strong.with_change(name, value)
        told = refused(refusal.value, strong, name, value)
        assert f"below {'1500 kN' if name == 'peak' else '1.5·10⁶ N'}, all that" in told


def test_a_slider_that_is_dragged_ends_where_values_do(strand: Sidebar) -> None:
    told: list[str] = []
    session = strand._session
    session.param.watch(lambda event: told.append(event.new), "refusal", onlychanged=False)
    strand._on_setting("friction", 0.0, by_hand=True)
    end = session.wanted.friction
    assert 0.0 < end < 0.3
    with pytest.raises(SettingError):
        session.wanted.with_change("friction", end - 0.02)
    strand.obey()
    strand._on_setting("friction", 0.005, by_hand=True)
    strand.obey()
    assert session.wanted.friction == end
    assert len(told) == 1, "told once a drag"
    strand._on_setting("friction", 0.5, by_hand=True)
    assert (session.wanted.friction, told[1:]) == (0.5, [""])


def test_a_number_of_parts_ends_where_there_are_no_more(strand: Sidebar) -> None:
    assert strand.view.shown[ENDS]["broken"] == 3
    strand._on_setting("wires", 7)
    assert strand.view.shown[ENDS]["broken"] == 7


@pytest.mark.parametrize("scene", list(CATALOGUE))
def test_no_refusal_has_words_that_only_files_have(scene: str) -> None:
    settings = CATALOGUE[scene].settings.checked({})
    for name, definition in settings.definitions().items():
        if isinstance(definition, param.Boolean):
            continue
        for value in ("abc", -1e99, [[0, 0], [0, 1]], None):
            try:
                settings.with_change(name, value)
            except SettingError as refusal:
                words = refused(refusal, settings, name, value)
                assert words.startswith(about(definition).title)
                assert not re.search(r'"|\b[a-z]+_[a-z]+\b|true|\[\[', words), words


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
    assert made["columns"] == [["time", "s"], ["force", "N"]]
    for entry in CATALOGUE.values():
        for definition in entry.settings.definitions().values():
            if isinstance(definition, CurveParameter):
                assert definition.units[0] == {"time": "s", "position": "m"}[definition.abscissa]
                assert bool(definition.units[1]) == (definition.ordinate != "factor")


def test_a_refusal_stays_until_something_changes(monkeypatch: pytest.MonkeyPatch) -> None:
    stand: list[str] = []

    def error(text: str, duration: int) -> Any:
        assert duration == 0, "goes by itself"
        stand.append(text)
        return SimpleNamespace(destroy=stand.clear)

    area = SimpleNamespace(notifications=SimpleNamespace(error=error))
    monkeypatch.setattr(notes.pn, "state", area)
    session = lone_session(BarSettings.checked({}))
    told = notes.Notes(session)
    session.refusal = "Friction cannot be this."
    session.watch(phase=0.5)
    assert stand == ["Friction cannot be this."]
    session.change("friction", 0.4)
    assert stand == []
    assert told


def test_a_file_is_refused_in_titles_with_its_names_in_brackets(sidebar: Sidebar) -> None:
    undo = Undo(sidebar._session, lambda name: None)
    actions = Actions(sidebar._session, sidebar.obey, undo, *[lambda: None] * 2)
    for scene, name, said in (
        ("bar", "friction", "Friction coefficient μ (friction) cannot be -1: "),
        ("strand", "broken", "(broken) cannot be -1: "),
        ("bar", "frictoin", "did you mean friction?"),
    ):
        actions.hear("open", ["mine.toml", f'scene = "{scene}"\n{name} = -1'])
        assert said in sidebar._session.refusal
