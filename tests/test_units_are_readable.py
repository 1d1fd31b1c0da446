"""Values stand in units that one reads: chosen by size, or those of mm, N and MPa, or of SI."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from shown_pages import ALL, SMALL, Shown

from app.components.form import LADDERS
from app.controls.refusals import field_of
from app.picture.labels import changes_of, label_of
from app.picture.units import BY_SIZE, MM, SI, SYSTEMS, measured, scale_of, steps
from app.shell.address import Sight, query_of, sight_from_query
from app.views.catalogue import fitting
from app.views.drawing.in_units import in_units
from app.worker.tables import table
from solver.definitions import about
from solver.scenes import CATALOGUE
from solver.scenes.bar import BarSettings
from solver.scenes.block import BlockSettings

IN_SI = {
    **{"m": 1.0, "mm": 1e-3, "µm": 1e-6, "nm": 1e-9, "N": 1.0, "kN": 1e3, "Pa": 1.0, "kPa": 1e3},
    **{"MPa": 1e6, "GPa": 1e9, "mm²": 1e-6, "m²": 1.0, "J": 1.0, "mJ": 1e-3, "N/mm": 1e3},
}


@pytest.mark.parametrize(
    ("value", "unit", "said"),
    [
        (4.2e-05, "m", "42 µm"),
        (5e-5, "m", "50 µm"),
        (5e6, "Pa", "5 MPa"),
        (-4e-5, "m", "-40 µm"),
        (900.0, "N", "900 N"),
        (999.8, "N", "1 kN"),
        (0.2, "m", "200 mm"),
        (2.31e8, "Pa", "231 MPa"),
        (3e9, "Pa", "3000 MPa"),
        (1e9, "N/m^3", "1000 MN/m³"),
        (-77e3, "N/m^3", "-77 kN/m³"),
        (2.1e11, "Pa", "210 GPa"),
        (3.14e-4, "m^2", "314 mm²"),
        (5000.0, "N/m", "5 kN/m"),
        (0.0, "N", "0 N"),
        (40.0, "°", "40 °"),
        (0.3, "", "0.3"),
        (1e30, "Pa", "1·10³⁰ Pa"),
        (-1.11e-3, "J", "-1.11 mJ"),
        (3e-15, "J", "3·10⁻¹⁵ J"),
    ],
)
def test_a_value_is_told_as_one_says_it(value: float, unit: str, said: str) -> None:
    assert measured(value, unit) == said


@pytest.mark.parametrize(
    ("value", "unit", "in_mm", "in_si"),
    [
        (5e-5, "m", "0.05 mm", "5·10⁻⁵ m"),
        (3.46e8, "Pa", "346 MPa", "3.46·10⁸ Pa"),
        (2.1e11, "Pa", "210000 MPa", "2.1·10¹¹ Pa"),
        (1200.0, "N", "1200 N", "1200 N"),
        (5000.0, "N/m", "5 N/mm", "5000 N/m"),
        (0.0, "m", "0 mm", "0 m"),
        (0.25, "J", "250 mJ", "0.25 J"),
        (90.0, "°", "90 °", "90 °"),
    ],
)
def test_a_chosen_system_holds_whatever_the_size(
    value: float, unit: str, in_mm: str, in_si: str
) -> None:
    assert measured(value, unit, MM) == in_mm
    assert measured(value, unit, SI) == in_si


@given(st.floats(1e-9, 9e11), st.sampled_from(["m", "N", "Pa", "J"]))
def test_no_number_has_many_zeros(size: float, unit: str) -> None:
    factor, name = scale_of(size, unit)
    assert 0.999 <= size / factor < (10_000.0 if name == "MPa" else 1000.0)


@pytest.mark.parametrize(("name", "factor"), IN_SI.items())
def test_a_unit_is_as_large_as_it_says(name: str, factor: float) -> None:
    found = {
        one.factor
        for unit in ("m", "m^2", "N", "Pa", "J", "N/m")
        for system in SYSTEMS
        for one in steps(unit, system)
        if one.name == name
    }
    assert found == {factor}


@pytest.mark.parametrize("scene", list(CATALOGUE))
def test_every_setting_has_a_unit_in_every_system(scene: str) -> None:
    for definition in CATALOGUE[scene].settings.definitions().values():
        unit = about(definition).unit
        assert unit in LADDERS or unit in ("", "s", "°", "1/m", "m^2/s")


AT_HAND = {
    "m": {"µm", "mm", "m"},
    "m^2": {"mm²"},
    "N": {"N", "kN"},
    "Pa": {"MPa", "GPa"},
    "N/m": {"kN/m", "MN/m"},
    "N/m^3": {"kN/m³", "MN/m³"},
    "N·m/m": {"kN·m/m"},
}
"""Units in which one thinks of what is set."""


@pytest.mark.parametrize("scene", list(CATALOGUE))
def test_every_field_is_at_first_in_a_unit_that_one_thinks_in(scene: str) -> None:
    settings = CATALOGUE[scene].settings.checked({})
    for name, definition in settings.definitions().items():
        unit = about(definition).unit
        if unit in AT_HAND:
            size, shown = field_of(settings, name, BY_SIZE)
            value, (_, end) = getattr(settings, name), definition.softbounds
            assert shown in AT_HAND[unit], name
            # Zero has the unit in which its slider ends.
            assert value or 1.0 <= end / size <= 1000.0, name


@pytest.mark.parametrize(
    ("kind", "changes", "said"),
    [
        (BlockSettings, {"top_normal_displacement": -5e-5}, "top normal displacement -50 µm"),
        (BarSettings, {"young": 7e10, "elements": 60}, "elements 60, young 70 GPa"),
        (BarSettings, {"peak": 920.0}, "peak 920 N"),
        (BarSettings, {"multiscale": False}, "multiscale off"),
    ],
)
def test_runs_are_called_by_readable_values(kind: type, changes: dict, said: str) -> None:
    usual, other = kind.checked({}), kind.checked(changes)
    assert label_of(other, changes_of(other, usual)) == said


@pytest.fixture(scope="module")
def block() -> Shown:
    shown = Shown()
    shown.run(1, "block", SMALL["block"])
    return shown


def test_what_is_drawn_is_the_same_in_every_unit(block: Shown) -> None:
    scene = block.scene()
    for view in fitting(scene.run.settings):
        drawing = view.draw(scene, None)
        assert drawing is not None
        for system in (BY_SIZE, MM):
            shown = in_units(drawing, system)
            for axis in ("x", "y"):
                own, other = getattr(drawing, axis), getattr(shown, axis)
                known = {one.name: one.factor for one in steps(own.unit if own else "", system)}
                size = known[other.unit] if other else 1.0
                for before, after in zip(drawing.curves, shown.curves, strict=True):
                    there = size * np.asarray(getattr(after, axis), float)
                    assert there == pytest.approx(
                        getattr(before, axis), rel=1e-6, abs=0.0, nan_ok=True
                    )
                if own is not None:
                    assert size * other.high == pytest.approx(own.high)


def test_bodies_are_to_one_scale_in_every_unit(block: Shown) -> None:
    scene = block.scene()
    (view,) = (one for one in fitting(scene.run.settings) if one.name == "Deformed bodies")
    drawing = view.draw(scene, None)
    shown = in_units(drawing, BY_SIZE)
    assert (shown.x.unit, shown.y.unit, shown.colors.unit) == ("mm", "mm", "MPa")
    assert shown.bodies.places == pytest.approx(1e3 * drawing.bodies.places)
    assert shown.bodies.box.right == pytest.approx(1e3 * drawing.bodies.box.right)


def test_a_table_is_in_the_chosen_system_and_in_si_where_the_size_chooses(block: Shown) -> None:
    texts = {
        units: table("points", block.scene(replace(ALL, units=units))).splitlines()
        for units in SYSTEMS
    }
    rows = {units: [one for one in all_ if one[0] != "#"] for units, all_ in texts.items()}
    assert rows[BY_SIZE] == rows[SI]
    assert rows[SI][0] == "run,time (s),position (m),friction (Pa),pressure (Pa),status"
    assert rows[MM][0] == "run,time (s),position (mm),friction (MPa),pressure (MPa),status"
    for own, other in zip(rows[MM][1:], rows[SI][1:], strict=True):
        mm, si = (list(map(float, row.split(",")[2:5])) for row in (own, other))
        assert [1e-3 * mm[0], 1e6 * mm[1], 1e6 * mm[2]] == pytest.approx(si, rel=1e-6)


def test_an_address_has_units_that_hold_over_what_the_browser_keeps() -> None:
    settings = BarSettings.checked({})
    query = query_of(settings, Sight(units=MM))
    assert "&units=mm" in query
    assert sight_from_query(query, SI)[0].units == MM
    assert sight_from_query("", SI)[0].units == SI
    assert sight_from_query("", "furlongs")[0].units == BY_SIZE
    assert "units" not in query_of(settings, Sight())
