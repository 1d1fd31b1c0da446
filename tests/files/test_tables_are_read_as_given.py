"""Tables of any look give the solver their numbers, or say why not."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from refusals import refusal

from app.link import read as read_address
from solver.commands.cli import main
from solver.files.curves import curve_of
from solver.files.saved import settings_from_command, settings_from_toml
from solver.files.tables import read_table
from solver.scenes import CATALOGUE
from solver.settings.values import SettingError

TIMES = {"s": 1.0, "SEC": 1.0, "ms": 1e-3, "min": 60.0, "h": 3600.0}
POUND = 4.4482216152605
"""Newtons."""
FORCES = {
    "N": 1.0,
    "kN": 1e3,
    "KN": 1e3,
    "MN": 1e6,
    "mN": 1e-3,
    "daN": 10.0,
    "lbf": POUND,
    "kips": 1e3 * POUND,
}
STYLES = [
    "{} [{}]",
    "{} ({})",
    "{}/{}",
    "{} / {}",
    "{} in {}",
    "{}, {}",
    "{} {}",
    "{}_{}",
    "row",
]
BETWEEN = {",": ",", ";": ";", "tab": "\t", "blank": " ", "blanks": "   "}
NUMBERS = st.floats(-1e6, 1e6, allow_subnormal=False)


@dataclass(frozen=True)
class Written:
    """A file, with the points in SI that it was written from."""

    data: bytes
    points: np.ndarray
    units: tuple[str, str]


@dataclass(frozen=True)
class Dialect:
    """Way in which somebody writes numbers, and the remark beside them."""

    decimal: str
    thousands: str
    minus: str
    exponent: str
    remark: str

    def write(self, value: float) -> str:
        """Write a number in all its digits."""
        if self.thousands:
            text = format(value, ",")
        else:
            text = repr(value)
        signs = {
            ".": self.decimal,
            ",": self.thousands,
            "-": self.minus,
            "e": self.exponent,
        }
        return "".join(signs.get(char, char) for char in text)


@st.composite
def dialects(draw: st.DrawFn, separator: str) -> Dialect:
    """Draw one in which nothing may be read otherwise."""
    decimal = draw(st.sampled_from(".,"))
    # Signs that stand between columns stand in quotes within a number, blanks cannot.
    thousands = draw(st.sampled_from(["", "'", "\u202f", ".,".replace(decimal, "")]))
    exponent = draw(st.sampled_from(["e", "E", "D"]))
    minus = draw(st.sampled_from(["-", "\N{MINUS SIGN}"]))
    marks = ["", "  # slips", "  // slips", "  ! slips, 3 times"]
    remark = draw(st.sampled_from(marks if separator != "\t" else marks[:2]))
    return Dialect(decimal, thousands, minus, exponent, remark)


@st.composite
def heads(
    draw: st.DrawFn, order: list[str], separator: str
) -> tuple[list[list[str]], tuple[str, str]]:
    """Draw the rows of words over the columns, and the units of time and force."""
    forces = ["force", "Kraft", "F", "load", "Last", "Standardkraft"]
    names = {
        "time": draw(st.sampled_from(["time", "Zeit", "t", "Prüfzeit", "TIME"])),
        "force": draw(st.sampled_from(forces)),
        "extra": draw(st.sampled_from(["Weg", "displacement", "Kanal"])),
    }
    units = {
        "time": draw(st.sampled_from(list(TIMES))),
        "force": draw(st.sampled_from([*FORCES])),
        "extra": "mm",
    }
    styles = STYLES
    if separator == " ":
        styles = [style for style in STYLES if " " not in style]
    style = draw(st.sampled_from(styles))
    if style == "row":
        rows = [[names[key] for key in order], [units[key] for key in order]]
    else:
        rows = [[style.format(names[key], units[key]) for key in order]]
    return rows, (units["time"], units["force"])


def joined(cells: list[str], separator: str) -> str:
    """Cells in a line; those that have the separator in them stand in quotes."""
    quoted = [f'"{cell}"' if separator in cell else cell for cell in cells]
    return separator.join(quoted)


@st.composite
def tables(
    draw: st.DrawFn, values: np.ndarray, above: list[list[str]], separator: str
) -> list[str]:
    """Draw the lines of a table of values, (n_rows, n_columns), below its heads."""
    dialect = draw(dialects(separator))
    rows = [[dialect.write(cell) for cell in row] for row in values.tolist()]
    # Rows that lack a number are left out, and pages begin with the head again.
    gap = draw(st.sampled_from(["", "NaN", "n/a", "-"]))
    if gap:
        rows.insert(1, [gap] * len(rows[0]))
    page = draw(st.sampled_from([[], above]))
    ends = draw(st.sampled_from(["", separator]))
    filled = [*above, *rows[:-1], *page, rows[-1]]
    lines = [joined(row, separator) + ends for row in filled]
    lines[-1] += dialect.remark
    return lines


@st.composite
def files(draw: st.DrawFn) -> Written:
    """Draw points, and a file of them as somebody might write it."""
    count = draw(st.integers(2, 8))
    steps = draw(st.lists(st.floats(1e-3, 1e3), min_size=count, max_size=count))
    forces = draw(st.lists(NUMBERS, min_size=count, max_size=count))
    columns = {
        "time": np.cumsum(steps),
        "force": np.array(forces),
        "extra": np.arange(count) * 0.5,
    }
    others = draw(st.sampled_from([[], ["extra"]]))
    order = draw(st.permutations(["time", "force", *others]))
    separator = BETWEEN[draw(st.sampled_from(list(BETWEEN)))]
    above, units = draw(heads(order, separator))
    values = np.stack([columns[key] for key in order], axis=1)
    lines = draw(tables(values, above, separator))
    return Written(
        data=draw(encoded(lines)),
        points=np.array(
            [columns["time"] * TIMES[units[0]], columns["force"] * FORCES[units[1]]]
        ).T,
        units=units,
    )


@st.composite
def encoded(draw: st.DrawFn, lines: list[str]) -> bytes:
    """Draw what stands above the lines, their ends, and the bytes of it all."""
    remarks = st.sampled_from(["Rate (Hz),100", "Prüfung 3", "", "# 7 N"])
    above = draw(st.lists(remarks, max_size=2))
    text = draw(st.sampled_from(["\n", "\r\n"])).join([*above, *lines, ""])
    encodings = ["utf-8", "utf-8-sig", "utf-16", "utf-16-le", "cp1252"]
    if {"\u202f", "\N{MINUS SIGN}"} & set(text):
        encodings.remove("cp1252")
    return text.encode(draw(st.sampled_from(encodings)))


def read(
    data: bytes | str, name: str = "load", scene: str = "bar", **changes: Any
) -> tuple[list[list[float]], str]:
    values = CATALOGUE[scene].checked(changes)
    table = read_table(data, "file.csv", name, "a table")
    return curve_of(table, values.definitions()[name], name, values.curve_units(name))


@given(files())
@settings(max_examples=70)
def test_points_are_those_that_were_given(file: Written) -> None:
    read_points, message = read(file.data)
    points = np.array(read_points)
    np.testing.assert_allclose(points, file.points, rtol=1e-12)
    (times, forces) = points.T
    (wanted_times, wanted) = file.points.T
    assert (forces.argmax(), forces.argmin()) == (wanted.argmax(), wanted.argmin())
    turns = np.sign(np.diff(forces)), np.sign(np.diff(wanted))
    np.testing.assert_array_equal(*turns)
    work = np.trapezoid(np.abs(wanted), wanted_times)
    difference = np.trapezoid(forces, times) - np.trapezoid(wanted, wanted_times)
    assert abs(difference) <= 1e-11 * work
    time, force = file.units
    for part in (
        f" in {time}, ",
        f" in {force}, {len(points)} points, from ",
        f" {force}",
    ):
        assert part in message


@pytest.mark.parametrize(
    ("text", "points"),
    [
        ("time (s),displacement (mm),force (N)\n0,0,0\n1,5,7\n", [[0, 0], [1, 7]]),
        ("force,time\n0,0\n7,1\n", [[0, 0], [1, 7]]),
        ("# time force\n0.000e+00 0.000e+00\n1.000e+00 7.000e+00\n", [[0, 0], [1, 7]]),
        ("  time [s]   force [N]\n  0  0\n  1  7\n", [[0, 0], [1, 7]]),
        ("Rate (Hz),100\ntime,force\n0,0\n1,7\n", [[0, 0], [1, 7]]),
        ("Range,0,100\n\nTest;7\ntime;force;\n0;0;\n1;7;\n", [[0, 0], [1, 7]]),
        ("Zeit;Weg;Kraft\nt;s;F\ns;mm;kN\n0;0;0\n1;2;0,007\n", [[0, 0], [1, 7]]),
        ("Zeit;Kraft\ns;kN\n;Kanal 1\n0;0\n1;0,007\n", [[0, 0], [1, 7]]),
        ("name,t,F\nN1,0,0\nN2,1,7\n", [[0, 0], [1, 7]]),
        ("time,load step,force\n0,1,0\n1,2,7\n", [[0, 0], [1, 7]]),
        ("A [s],B [kN]\n0,0\n1,0.007\n", [[0, 0], [1, 7]]),
        ("time,value\n0,0\n1,7\n", [[0, 0], [1, 7]]),
    ],
    ids=repr,
)
def test_columns_are_chosen_by_name(text: str, points: list[list[float]]) -> None:
    assert read(text)[0] == points


@pytest.mark.parametrize(
    ("text", "remedy"),
    [
        (
            "displacement,force\n0,0\n1,1\n",
            "no time .*a loop, as force over displacement",
        ),
        ("0,0\n1,1\n0.5,0\n", "line 3: time must increase.*of a loop"),
        ("time,velocity\n0,0\n1,1\n", "no force in N, kN, MN .*'velocity'"),
        ("time,force [mm]\n0,0\n1,1\n", "line 1 says mm: give it in N, kN, MN"),
        ("Zeit;Kraft\ns;V\n0;0\n1;1\n", "line 2 says V: give it in N"),
        ("time [ms],force [kN]\ns,kN\n0,0\n1,1\n", "line 2 says s, and line 1 ms"),
        ("time,A,B\n0,0,0\n1,1,1\n", "no force .*'A', 'B'.*name one of them load"),
        ("time,force,Kraft\n0,0,0\n1,1,1\n", "'force' and 'Kraft' may both be meant"),
        ("time s force kN\n0 0\n1 1\n", "line 1 has 4 names for 2 columns"),
        ("time,force\n0,0,0,5\n1,0,1,5\n", "line 1 has 2 names for 4 columns"),
        ("time,force\n0,0\n1,1,1\n", "line 3 has 3 cells for 2 columns"),
        ("0,0,0\n1,1,1\n", "3 columns: name time and force in its first line"),
        ("0;0\n0,5;1,5\n1;2.5\n1,5;3,5\n", "line 3 has '2.5', with a decimal point"),
        ("0;0\n0.5;1.234,5\n1.5;2.5\n", "line 2 has '1.234,5', with a decimal comma"),
        (
            "Rate (Hz),100\n0,0\n1,1\n",
            "line 1 is 'Rate .Hz.,100', not 2 finite numbers",
        ),
        ("time,force\n0,0\nmuch,1\n", "line 3 has 'much' as time"),
        ("time;force\ns;kg\n0;0\n", "line 2 says kg: give it in N, kN, MN"),
        ("", "no points"),
        ("0,0\n1,much\n", "line 2"),
        ("0,0\n1,inf\n", "line 2"),
        ('0,0\n1,"1,000"\n', "line 2"),
    ],
    ids=repr,
)
def test_tables_with_two_readings_are_refused_with_a_reason(
    text: str, remedy: str
) -> None:
    with pytest.raises(SettingError, match=remedy):
        read(text)


def test_a_path_of_a_side_is_in_the_unit_of_what_is_given_there() -> None:
    name = "top_normal_load"
    text = "time,displacement [mm]\n0,0\n1,-2\n"
    given, _ = read(text, name, "block", top="displacement")
    assert given == [[0.0, 0.0], [1.0, -2e-3]]
    with pytest.raises(SettingError, match="no pressure in Pa, kPa"):
        read(text, name, "block", top="traction")
    pressure, _ = read("time,Druck [N/mm2]\n0,0\n1,2\n", name, "block", top="traction")
    assert pressure[1] == [1.0, 2e6]


def test_the_command_says_what_it_understood(tmp_path: Path, capsys: Any) -> None:
    file = tmp_path / "load.csv"
    file.write_bytes(
        "Prüfung\nZeit;Weg (mm);Kraft (kN)\n0;0;0\n1;2;0,9\n".encode("cp1252")
    )
    said = (
        "Zeit in s (no unit given), Kraft in kN, 2 points, from 0 to 0.9 kN; passed "
        "over: 'Weg'"
    )
    sizes = ["--set=elements=10", "--set=substructures=2", "--set=instants=11"]
    command = ["run", "bar", *sizes, f"--set=load={file}", "--json"]
    assert main(command) == 0
    out, err = capsys.readouterr()
    assert f"slipfront: load: {said}\n" in err
    assert json.loads(out)["tables"] == {"load": said}
    saved = tmp_path / "saved.toml"
    saved.write_text('scene = "bar"\nload = "load.csv"\n')
    main(["run", str(saved), *sizes])
    assert f"slipfront: load: {said}\n" in capsys.readouterr().err


@given(st.binary(max_size=60) | st.text('0159.,; \t\n"#xtN[]()/_-eE', max_size=60))
@settings(max_examples=150)
def test_anything_else_is_read_or_refused_in_words(data: bytes | str) -> None:
    try:
        points = read(data)[0]
    except SettingError:
        return
    assert np.isfinite(points).all()


def test_a_csv_is_found_beside_the_settings_file_or_in_the_working_folder(
    tmp_path, monkeypatch
):
    monkeypatch.chdir(tmp_path)
    folder = tmp_path / "deep"
    folder.mkdir()
    (folder / "path.csv").write_text(
        "time,force\n0,0\n0.5, 100\n1,-1e2\n", encoding="utf-8-sig"
    )
    (folder / "run.toml").write_text(
        'scene = "bar"\nload = "path.csv"\n', encoding="utf-8"
    )
    expected = ((0.0, 0.0), (0.5, 100.0), (1.0, -100.0))
    assert settings_from_command("deep/run.toml", [])[0].load == expected
    assert settings_from_command("bar", ["load=deep/path.csv"])[0].load == expected


def test_a_csv_that_is_missing_binary_or_a_folder_is_refused(tmp_path):
    binary = tmp_path / "binary.csv"
    binary.write_bytes(b"\x89PNG\r\n\x1a\n\x00\x00\x00\rIHDR")
    nul = tmp_path / "nul.toml"
    nul.write_text('scene = "bar"\nload = "a\\u0000b"\n')
    for path, remedy in (
        (tmp_path / "none.csv", "no readable CSV file"),
        (tmp_path, "no readable CSV file"),
        (binary, "it is no text: save the table as CSV"),
    ):
        text = refusal(lambda path=path: settings_from_command("bar", [f"load={path}"]))
        assert text.startswith("load = ")
        assert "allowed: ramp, triangle" in text
        assert remedy in text
    assert "no readable CSV file" in refusal(
        lambda: settings_from_command(str(nul), [])
    )


@pytest.mark.parametrize(
    "text",
    [
        "scene = bar",
        'scene = "bar"\npeak =',
        'scene = "bar"\nscene = "bar"',
        "\x00",
        'scene = "bar"\npeak = ' + "9" * 5000,
    ],
    ids=lambda text: text[:20],
)
def test_a_broken_settings_file_is_refused(text):
    assert "allowed: TOML" in refusal(lambda: settings_from_toml(text))


@pytest.mark.parametrize("path", ["/etc/passwd", "load.csv", "../load.csv"])
def test_an_address_never_reads_a_file(tmp_path, monkeypatch, path):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "load.csv").write_text("0,0\n1,100\n", encoding="utf-8")
    opened = []
    monkeypatch.setattr(
        Path, "read_text", lambda self, *rest, **more: opened.append(self)
    )
    for text in (path, f'"{path}"'):
        place, complaint = read_address(f"?load={text}")
        assert place["settings"].load == "sine"
        assert "choose a preset" in complaint
    assert not opened


def test_an_uploaded_file_never_names_another():
    text = 'scene = "bar"\nload = "/etc/passwd"\n'
    assert "choose a preset" in refusal(lambda: settings_from_toml(text))
