"""Numerals, heads, files, lines and workbooks:
what is written is read, by whatever way.
"""

from __future__ import annotations

import io
import math
import os
import zipfile
from pathlib import Path

import openpyxl
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from solver.files.columns import are_units, column_of, quantities_of
from solver.files.disk import LARGEST, check_place, read_bytes, whole_file, write
from solver.files.numerals import decimal_signs, is_gap, is_numeral, number
from solver.files.table_blocks import block_of, fitted, headed
from solver.files.table_lines import lines_of_text, text_of
from solver.files.units import SPELLINGS, examples_of, parse_unit, size_in, unit_doubt
from solver.files.workbooks import UNPACKED, is_archive, lines_of_workbook
from solver.settings.values import SettingError

ANY = settings(max_examples=60)
FINITE = st.floats(allow_nan=False, allow_infinity=False)


def refuse(remedy: str) -> SettingError:
    return SettingError("table", "a file", "a table", remedy)


# Numerals


@ANY
@given(FINITE)
def test_a_number_that_is_written_in_full_is_read_to_the_bit(value: float) -> None:
    for text in (repr(value), f"{value:.17e}", f"{value:+.17g}"):
        for cell, sign in ((text, "."), (text.replace(".", ","), ",")):
            assert is_numeral(cell)
            assert sign in decimal_signs(cell)
            assert number(cell, sign) == value


@ANY
@given(st.integers(1_000, 10**12), st.integers(0, 99), st.booleans())
def test_groups_of_thousands_change_no_number(
    whole: int, part: int, negative: bool
) -> None:
    value = whole + part / 100
    if negative:
        value = -value
    plain = f"{value:,.2f}"
    for mark in ",'’ \u00a0\u2009\u202f":
        assert number(plain.replace(",", mark), ".") == value
    continental = plain.translate(str.maketrans(",.", ".,"))
    assert number(continental, ",") == value
    assert number(plain.replace("-", "−"), ".") == value
    if whole >= 10**6:
        # Two groups of one mark say that it is no decimal sign.
        assert decimal_signs(plain.partition(".")[0]) == "."


@ANY
@given(st.integers(-(10**6), 10**6), st.integers(-300, 300))
def test_exponents_of_fortran_are_those_of_others(mantissa: int, power: int) -> None:
    digits = f"{mantissa / 10**5:.5f}"
    wanted = float(f"{digits}e{power}")
    for letter in "eEdDqQ":
        assert number(f"{digits}{letter}{power:+03d}", ".") == wanted
    if abs(power) >= 100:
        assert number(f"{digits}{power:+04d}", ".") == wanted


@pytest.mark.parametrize("cell", ["", "-", "NaN", "n/a", "****", "#DIV/0!", "NULL"])
def test_a_gap_is_no_number(cell: str) -> None:
    assert is_gap(cell)
    assert not is_numeral(cell)
    assert math.isnan(number(cell, "."))


@pytest.mark.parametrize("cell", ["N1", "1,23,456", "1.2.3", "12-345", "0x10", "1 2"])
def test_a_word_is_neither_a_number_nor_a_gap(cell: str) -> None:
    assert not is_gap(cell)
    assert not is_numeral(cell)
    assert decimal_signs(cell) == ""


def test_one_group_of_three_may_be_of_either_sign() -> None:
    assert set(decimal_signs("1,234")) == {".", ","}
    assert number("1,234", ".") == 1234.0
    assert number("1,234", ",") == 1.234
    assert decimal_signs("1,2345") == ","
    assert decimal_signs("0,234") == ","


# Heads


@pytest.mark.parametrize("spelt", SPELLINGS)
def test_a_unit_is_the_same_however_it_is_spelt(spelt: str) -> None:
    wanted = parse_unit(SPELLINGS[spelt])
    assert wanted is not None
    # As it is written it is a nanometre.
    if spelt != "nm":
        assert parse_unit(spelt) == wanted
    assert parse_unit(spelt.upper()) == wanted


@pytest.mark.parametrize(
    ("given_unit", "unit", "size"),
    [
        ("kN/m", "N/mm", 1.0),
        ("N/mm2", "MPa", 1.0),
        ("N/mm²", "Pa", 1e6),
        ("in", "mm", 25.4),
        ("ft", "in", 12.0),
        ("ksi", "lbf/in2", 1e3),
        ("kip", "lbf", 1e3),
        ("kN-m", "Nm", 1e3),
        ("rad", "deg", 180.0 / math.pi),
        ("h", "min", 60.0),
        ("%", "1", 0.01),
        ("mN", "N", 1e-3),
        ("MN", "N", 1e6),
        ("m^-1", "1/m", 1.0),
    ],
)
def test_units_are_products_and_powers_and_convert_both_ways(
    given_unit: str, unit: str, size: float
) -> None:
    assert size_in(given_unit, unit) == pytest.approx(size, rel=1e-15)
    assert size_in(unit, given_unit) == pytest.approx(1.0 / size, rel=1e-15)
    assert size_in(given_unit, f"s or {unit}" if unit != "min" else unit) is not None


def test_units_of_other_dimensions_do_not_convert() -> None:
    assert size_in("kN", "m") is None
    assert size_in("parsec", "m") is None
    column = column_of(0, 7, "force [kN]")
    assert column.size("N", refuse) == 1e3
    with pytest.raises(SettingError, match="line 7 says kN") as caught:
        column.size("m", refuse)
    assert examples_of("m") in str(caught.value)


@pytest.mark.parametrize(
    "head", ["force [kN]", "force (kN)", "force in kN", "force / kN", "force kN"]
)
def test_a_head_has_one_name_and_unit_however_they_are_set_apart(head: str) -> None:
    column = column_of(2, 1, head)
    assert (column.number, column.name, column.unit) == (2, "force", "kN")
    assert "force" in column.quantities[0]


def test_a_letter_behind_a_name_is_a_unit_only_as_it_is_written() -> None:
    assert column_of(0, 1, "force N").unit == "N"
    assert column_of(0, 1, "channel n").unit == ""


def test_names_mean_quantities_in_german_as_in_english() -> None:
    for german, english in (
        ("Kraft", "force"),
        ("Weg", "displacement"),
        ("Zeit", "time"),
    ):
        meant = column_of(0, 1, german).quantities[0]
        assert english in meant
        assert english in quantities_of(german, "")
    assert quantities_of("no such thing", "Pa") == {"pressure"}
    assert are_units(["s", "kN", "mm"])
    assert not are_units(["time", "kN", "mm"])
    assert not are_units(["speed", "was", "in", "doubt"])


def test_a_line_of_units_says_what_a_head_leaves_open_and_not_the_opposite() -> None:
    column = column_of(1, 1, "force")
    with_units = column.with_units(2, ["s", "[kN]"], refuse)
    assert (with_units.unit, with_units.line) == ("kN", 2)
    assert with_units.with_units(3, ["s", "KN"], refuse).unit == "KN"
    with pytest.raises(SettingError, match="give one"):
        with_units.with_units(3, ["s", "N"], refuse)


@pytest.mark.parametrize(("power", "unit"), [(3, "mm"), (6, "µm"), (-3, "km")])
def test_numbers_that_are_thousands_off_are_doubted_and_others_not(
    power: int, unit: str
) -> None:
    doubt = unit_doubt("weg", "m", 2.0 * 10.0**power, 1.0, "the bar")
    assert f"weg [{unit}]" in doubt
    assert unit_doubt("weg", "m", 20.0, 1.0, "the bar") == ""
    assert unit_doubt("weg", "", 1e6, 1.0, "the bar") == ""


# Files


def test_a_file_is_whole_or_the_one_before(tmp_path: Path) -> None:
    path = tmp_path / "kept.csv"
    write(path, "before\n")

    def fail() -> None:
        with whole_file(path) as file:
            file.write("half")
            raise KeyError

    with pytest.raises(KeyError):
        fail()
    assert path.read_text() == "before\n"
    write(path, b"after\r\n")
    assert read_bytes(path, refuse) == b"after\r\n"
    check_place(path)
    assert os.listdir(tmp_path) == ["kept.csv"]


def test_text_is_written_as_it_is_on_every_system(tmp_path: Path) -> None:
    path = tmp_path / "text.csv"
    write(path, "µ;1\nü;2\r\n")
    assert path.read_bytes() == "µ;1\nü;2\r\n".encode()


def test_a_link_stays_a_link_to_the_file_that_is_written(tmp_path: Path) -> None:
    place = tmp_path / "place.csv"
    place.write_text("before")
    link = tmp_path / "link.csv"
    link.symlink_to(place)
    write(link, "after")
    assert link.is_symlink()
    assert place.read_text() == "after"


def test_too_large_missing_and_other_files_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "large.csv"
    path.write_bytes(b"1" * LARGEST)
    assert len(read_bytes(path, refuse)) == LARGEST
    path.write_bytes(b"1" * (LARGEST + 1))
    with pytest.raises(SettingError, match="more than 4 MB"):
        read_bytes(path, refuse)
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    with pytest.raises(SettingError, match="pipe or a device"):
        read_bytes(pipe, refuse)
    for missing in (tmp_path / "none.csv", tmp_path, Path("a\0b")):
        with pytest.raises(SettingError):
            read_bytes(missing, refuse)
    for place in (tmp_path, pipe, tmp_path / "no folder" / "file"):
        with pytest.raises(OSError, match=r".+"):
            check_place(place)


# Lines

ROWS = [["0", "1.5"], ["0.5", "-2"], ["1", "3e-3"]]
HEAD = ["time [s]", "force [kN]"]


def table(lines: list[list[str]], between: str) -> str:
    return "\n".join(between.join(line) for line in lines) + "\n"


def read(text: str | bytes) -> tuple[list[list[str]], list[tuple[str, str]], list[str]]:
    """Cells of all rows, names and units of columns, and what is passed over."""
    separator, lines = lines_of_text(text, refuse)
    block, passed = block_of(lines, separator, refuse)
    columns = headed(block, separator, refuse)
    cells = fitted(block, len(columns), separator, refuse)
    return cells, [(column.name, column.unit) for column in columns], passed


WANTED = ROWS, [("time", "s"), ("force", "kN")], []


@pytest.mark.parametrize("between", ["\t", ";", ",", "   ", " ; "])
def test_a_table_is_one_whatever_divides_its_columns(between: str) -> None:
    assert read(table([HEAD, *ROWS], between)) == WANTED


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16", "utf-16-le"])
@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_a_table_is_one_whatever_its_bytes_and_ends_of_lines(
    encoding: str, end: str
) -> None:
    text = table([HEAD, *ROWS], ";").replace("\n", end)
    assert read(text.encode(encoding)) == WANTED
    assert text_of(text.encode(encoding), refuse) == text


@pytest.mark.parametrize(
    "lines",
    [
        ["A title", *["{0}", "{1}"]],
        ["# A remark", "{0}", "-----;-----", "{1}"],
        ["", "{0}", "", "{1}", ""],
        ["# {0}", "{1}"],
        ["time;force", "s;kN", "{1}"],
        ["{0}", "{1}", "# end"],
        ['"time [s]";"force [kN]"', "{1}"],
    ],
)
def test_titles_rules_remarks_and_lines_of_units_change_no_table(
    lines: list[str],
) -> None:
    head = ";".join(HEAD)
    rows = table(ROWS, ";").rstrip("\n")
    text = "\n".join(line.format(head, rows) for line in lines)
    assert read(text) == WANTED


def test_of_two_tables_that_with_more_rows_is_read_and_equals_are_refused() -> None:
    other = table([["slip [mm]", "gap [mm]"], *ROWS[:2]], ";")
    cells, names, passed = read(table([HEAD, *ROWS], ";") + other)
    assert (cells, names) == WANTED[:2]
    assert passed == ["another table passed over (line 6)"]
    twice = table([HEAD, *ROWS[:2]], ";") + other
    with pytest.raises(SettingError, match="begin at lines 2 and 5"):
        read(twice)


def test_texts_without_a_table_are_refused() -> None:
    with pytest.raises(SettingError, match="no text"):
        text_of(b"\x01\x02", refuse)
    with pytest.raises(SettingError, match="no points"):
        read("only words\nand more\n")
    with pytest.raises(SettingError, match="3 cells for 2 columns"):
        read(table([HEAD, *ROWS, ["2", "3", "4"]], ";"))


# Workbooks


def workbook(rows: list[list[object]], *others: str) -> bytes:
    book = openpyxl.Workbook()
    sheet = book.worksheets[0]
    sheet.title = "loop"
    for row in rows:
        sheet.append(row)
    for name in others:
        book.create_sheet(name)
    data = io.BytesIO()
    book.save(data)
    return data.getvalue()


def test_a_workbook_has_the_lines_of_the_same_table_as_text() -> None:
    rows: list[list[object]] = [HEAD, [0, 1.5], [], [0.5, -2], [1, -1.25e-7, None]]
    data = workbook(rows, "notes")
    assert is_archive(data)
    lines, words = lines_of_workbook(data, refuse)
    assert words == "sheet 'loop' of 2"
    text = "time [s];force [kN]\n0;1.5\n\n0.5;-2\n1;-1.25e-07\n"
    assert not is_archive(text.encode())
    _, wanted = lines_of_text(text, refuse)
    assert [(line.number, line.cells) for line in lines] == [
        (line.number, line.cells) for line in wanted
    ]
    assert [line.are_numbers for line in lines] == [line.are_numbers for line in wanted]
    assert float(lines[-1].cells[1]) == -1.25e-7


def archive(name: str, data: bytes) -> bytes:
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as file:
        file.writestr(name, data)
    return packed.getvalue()


@pytest.mark.parametrize(
    ("data", "why"),
    [
        (b"PK\x03\x04 no archive", "no workbook"),
        (archive("readme.txt", b"text"), "no workbook"),
        (archive("xl/workbook.xml", b"<broken"), "no workbook"),
        (archive("xl/workbook.xml", bytes(UNPACKED + 1)), "more than 20 MB"),
    ],
    ids=["bytes", "other", "broken", "bomb"],
)
def test_other_archives_and_bombs_are_refused(data: bytes, why: str) -> None:
    assert is_archive(data)
    with pytest.raises(SettingError, match=why):
        lines_of_workbook(data, refuse)
