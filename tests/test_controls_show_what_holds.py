"""A control shows what holds, in numbers that can be read, also after an edit was refused."""

from __future__ import annotations

from typing import Any

from app.controls import CurveControl, make_control
from solver.definitions import Curve, SettingError
from solver.scenes import CATALOGUE
from solver.scenes.bar import BarSettings

POINTS = [[0.0, 0.0], [1.0, 500.0]]


def edited(rows: list[list[float]]) -> CurveControl:
    """Edit the table of a load path that is `POINTS`."""
    settings = BarSettings.checked({"method": "paper", "load": POINTS})

    def change(name: str, value: Any) -> None:
        try:
            control.show(settings.with_change(name, value))
        except SettingError:
            control.show(settings)

    made = make_control("load", BarSettings.definitions()["load"], change, lambda name: [])
    assert isinstance(made, CurveControl)
    control = made
    control.show(settings)
    control._table.wanted = rows
    return control


def test_a_refused_edit_leaves_the_table_and_can_be_made_again() -> None:
    control = edited([[0.0, 0.0], [0.0, 500.0]])
    assert control._table.shown == POINTS
    # What the browser hears, and what makes the same edit another one.
    assert control._table.wanted == []


def test_an_edit_that_is_taken_stays() -> None:
    rows = [[0.0, 0.0], [2.0, 500.0]]
    table = edited(rows)._table
    assert table.shown == table.wanted == rows


def test_columns_of_a_table_have_units() -> None:
    assert edited(POINTS)._table.columns == ["time (s)", "force (N)"]
    for entry in CATALOGUE.values():
        for definition in entry.settings.definitions().values():
            if isinstance(definition, Curve):
                assert definition.units[0] == {"time": "s", "position": "m"}[definition.abscissa]
                assert bool(definition.units[1]) == (definition.ordinate != "factor")
