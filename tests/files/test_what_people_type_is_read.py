"""Values in a command, an address, a file, a sweep are read as a field reads them."""

from __future__ import annotations

from pathlib import Path
from urllib.parse import quote

import pytest

from app.link import read
from solver.files.saved import read_settings, settings_from_command
from solver.scenes import CATALOGUE
from solver.scenes.remarks import remarks_before
from solver.settings.values import SettingError
from solver.study.sweep.plan import axis_of

TYPED = [
    ("friction", ".49", 0.49),
    ("friction", "5e-1", 0.5),
    ("friction", "+3", 3.0),
    ("friction", "1.", 1.0),
    ("friction", "0,49", 0.49),
    ("friction", "50 %", 0.5),
    ("friction", " 0.4 ", 0.4),
    ("friction", "'0.4'", 0.4),
    ("friction", '"0,4"', 0.4),
    ("peak", "1_000", 1000.0),
    ("peak", "1 000", 1000.0),
    ("peak", "2 kN", 2000.0),
    ("peak", "0,5 kN", 500.0),
    ("peak", "2.5 N", 2.5),
    ("peak", "−2", -2.0),
    ("young", "210 GPa", 2.1e11),
    ("duration", "2 min", 120.0),
    ("instants", "12.", 12),
    ("multiscale", "False", False),
    ("multiscale", "off", False),
    ("load", "[[0,0],[.5,900],[1.,+0]]", ((0.0, 0.0), (0.5, 900.0), (1.0, 0.0))),
    ("load", " sine ", "sine"),
]
REFUSED = [
    ("friction", "2 kN", "write a number without a unit"),
    ("friction", "0.3 1", "write a number without a unit"),
    ("friction", "1/3", "write a number without a unit"),
    ("friction", "inf", "choose a value inside this range"),
    ("friction", "nan", "choose a value inside this range"),
    ("friction", "", "write a number"),
    ("friction", "=0.4", "write a number"),
    ("friction", "half", "write a number"),
    ("friction", "1,234", "write 1234 or 1.234, as the comma may mean both"),
    ("peak", "2 m", "write a number in N"),
    ("peak", "9 1 N", "write a number in N"),
    ("instants", "2.5", "write a whole number"),
    ("multiscale", "maybe", "write true or false"),
]


@pytest.mark.parametrize(("name", "text", "value"), TYPED)
def test_a_value_is_read_in_a_command_and_in_an_address(
    name: str, text: str, value: object
) -> None:
    for assignment in (f"{name}={text}", f"{name} = {text}"):
        settings, _ = settings_from_command("bar", [assignment])
        assert getattr(settings, name) == value
    shown, refused = read(f"?scene=bar&{name}={quote(text)}")
    assert not refused
    assert getattr(shown["settings"], name) == value


@pytest.mark.parametrize(("name", "text", "remedy"), REFUSED)
def test_what_cannot_be_meant_is_refused_by_name(
    name: str, text: str, remedy: str
) -> None:
    with pytest.raises(SettingError) as refused:
        settings_from_command("bar", [f"{name}={text}"])
    assert refused.value.name == name
    assert refused.value.remedy == remedy
    if text:
        _, message = read(f"?scene=bar&{name}={quote(text)}")
        assert message.startswith("From the address: ")


def test_a_text_for_a_number_in_a_file_is_read_as_typed(tmp_path: Path) -> None:
    text = 'scene = "bar"\nformat = 2\npeak = "2 kN"\nfriction = "0,4"\n'
    settings, _ = read_settings(text, "a text")
    assert (settings.peak, settings.friction) == (2000.0, 0.4)
    file = tmp_path / "saved.toml"
    file.write_text(text, encoding="utf-8")
    again, _ = settings_from_command(str(file), [])
    assert again.values() == settings.values()


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("friction=.1,.2", (0.1, 0.2)),
        ("friction = 20 %, .5", (0.2, 0.5)),
        ("friction=.1:0,5:3", (0.1, 0.3, 0.5)),
        ("peak=1 kN:3 kN:3", (1000.0, 2000.0, 3000.0)),
        ("multiscale=True,off", (True, False)),
    ],
)
def test_values_of_a_sweep_are_read_alike(text: str, values: tuple[object]) -> None:
    assert axis_of(CATALOGUE["bar"].checked({}), text).values == values


def test_a_number_with_a_unit_of_another_kind_ends_no_sweep_in_a_traceback() -> None:
    bar = CATALOGUE["bar"].checked({})
    for text in ("peak=1 m:2 m:3", "peak=1 m,2", "peak=1:2:x", "peak=a:2:3"):
        with pytest.raises(SettingError, match=r"write (a number in N|three numbers)"):
            axis_of(bar, text)


def test_blanks_before_an_equals_sign_change_no_remark() -> None:
    """Of a setting that does nothing."""
    settings, _ = settings_from_command("bar", ["left_force = 5"])
    (remark,) = remarks_before(settings, ["left_force = 5"])
    assert remark.startswith("left_force does nothing")
