"""A loop is read as that loop, as rigs, spreadsheets or programs write it."""

from __future__ import annotations

import io
import os
import sys
from pathlib import Path
from typing import Any

import numpy as np
import openpyxl
import pytest
from small_scenes import SMALL

from solver import discrete
from solver.commands.cli import main
from solver.discrete.structure import Axes
from solver.files.tables import Table, read_table
from solver.scenes import CATALOGUE, discretise
from solver.settings.values import SettingError
from solver.study.measured_loop import CAN, MeasuredLoop, loop_in
from solver.study.table_use import Use, use_of

AXES = (("End displacement", "m"), ("Force", "N"))
TIMES = [0.0, 0.5, 1.0, 1.5]
"""Seconds."""
DISPLACEMENTS = [0.0, 1.5, 2.25, -1.0]
"""Millimetres."""
FORCES = [0.0, 1234.5, 2000.0, -500.25]
"""Newtons."""

PLAIN = (
    "time [s],displacement [mm],force [N]\n0,0,0\n0.5,1.5,1234.5\n1,2.25,2000\n"
    "1.5,-1,-500.25\n"
)
GERMAN = "0;0;0\n0,5;1,5;1234,5\n1;2,25;2000\n1,5;-1;-500,25\n"
ROWS = "0 0 0\n0.5 1.5 1234.5\n1 2.25 2000\n1.5 -1 -500.25\n"
KINDS: dict[str, str | bytes] = {
    "plain": PLAIN,
    "tabs and a mark at the beginning": PLAIN.replace(",", "\t").encode("utf-8-sig"),
    "of UTF-16": PLAIN.replace(",", "\t").encode("utf-16"),
    "columns the other way round": (
        "force (N);disp (mm);t (s)\n0;0;0\n1234.5;1.5;0.5\n2000;2.25;1\n"
        "-500.25;-1;1.5\n"
    ),
    "separators at the ends": (
        "t [s];u [mm];F [N];\n0;0;0;\n0.5;1.5;1234.5;\n1;2.25;2000;\n1.5;-1;-500.25;\n"
    ),
    "accents of Windows": ("Prüfzeit (s);Weg (mm);Prüfkraft (N)\n" + GERMAN).encode(
        "cp1252"
    ),
    "quoted, with decimal commas": (
        '"Zeit in s","Weg in mm","Kraft in N"\n"0","0","0"\n'
        '"0,5","1,5","1234,5"\n"1","2,25","2000"\n'
        '"1,5","-1","-500,25"\n'
    ),
    "quoted, with quantities and units in lines of their own": (
        '"Time","Extension","Load"\n"(s)","(mm)","(N)"\n"0","0","0"\n'
        '"0.5","1.5","1234.5"\n'
        '"1","2.25","2000"\n"1.5","-1","-500.25"\n'
    ),
    "units in capitals": "Zeit;Weg;Kraft\nSEC;MM;N\n" + GERMAN,
    "units alone": "Sec;mm;N\n" + GERMAN,
    "capitals throughout": (
        "TIME,DISP,LOAD\nSEC,MM,KN\n0,0,0\n0.5,1.5,1.2345\n1,2.25,2\n1.5,-1,-0.50025\n"
    ),
    "units in words": (
        "Time in seconds,Displacement in millimetres,Force in newtons\n"
        + PLAIN.partition("\n")[2]
    ),
    "inches and pounds": (
        "t,stroke (in),load (lbf)\n0,0,0\n0.5,0.059055118110,277.526640257\n"
        "1,0.088582677165,449.617886195\n1.5,-0.039370078740,-112.460673784\n"
    ),
    "feet and kips": (
        "time min,pos ft,load kips\n0,0,0\n"
        "0.0083333333333,0.0049212598425,0.277526640257\n"
        "0.0166666666667,0.0073818897638,0.449617886195\n"
        "0.025,-0.0032808398950,-0.112460673784\n"
    ),
    "names as variables": "t_s,u_mm,F_N\n" + PLAIN.partition("\n")[2],
    "names of a finite element program": (
        "               TIME          UX [mm]         FX [N]\n\n"
        + ROWS.replace(" ", "        ")
    ),
    "a comment at the end of lines": (
        "# t u[mm] F[N]\n0 0 0 # start\n0.5 1.5 1234.5 ! slips\n1 2.25 2000 // peak\n"
        "1.5 -1 -500.25 % end of it\n"
    ),
    "comments anywhere": PLAIN.replace("1,2.25", "# paused 10 s\n! valve, 3\n1,2.25"),
    "comments behind semicolons": "t u[mm] F[N]\n"
    + ROWS.replace("1.5 1234.5", "1.5 1234.5 ; slips"),
    "saved by NumPy": (
        "# time displacement_mm force_N\n0.0e+00,0.0e+00,0.0e+00\n"
        "5.0e-01,1.5e+00,1.2345e+03\n"
        "1.0e+00,2.25e+00,2.0e+03\n1.5e+00,-1.0e+00,-5.0025e+02\n"
    ),
    "exponents of Fortran": (
        " t [s] u [m] F [N]\n 0.0D0 0.0D0 0.0D+00\n 5.0D-01 1.5D-03 1.2345D+03\n"
        " 0.1D+01 0.225d-2 0.2D+004\n 15.-001 -1.D-3 -.50025D+3\n"
    ),
    "a printed minus": PLAIN.replace("-", "−"),
    "blanks between thousands": (
        "t;u [mm];F [N]\n0;0;0\n0,5;1,5;1 234,5\n1;2,25;2 000\n1,5;-1;-500,25\n"
    ),
    "narrow blanks between thousands, and blanks between columns": (
        "t u[mm] F[N]\n"
        + ROWS.replace("1234.5", "1\u202f234.5").replace("2000", "2\u00a0000")
    ),
    "blanks between thousands in a printout": (
        "t [s]   u [mm]   F [N]\n0   0   0\n0.5   1.5   1 234.5\n1   2.25   2 000\n"
        "1.5   -1   -500.25\n"
    ),
    "commas between thousands": (
        "t\tu [mm]\tF [N]\n0\t0\t0\n0.5\t1.5\t1,234.5\n1\t2.25\t2,000\n"
        "1.5\t-1\t-500.25\n"
    ),
    "quoted commas between thousands": (
        'time,disp [mm],force [N]\n0,0,0\n0.5,1.5,"1,234.5"\n1,2.25,"2,000"\n'
        "1.5,-1,-500.25\n"
    ),
    "points between thousands": (
        "t;u [mm];F [N]\n0;0;0\n0,5;1,5;1.234,5\n1;2,25;2.000\n1,5;-1;-500,25\n"
    ),
    "apostrophes between thousands": PLAIN.replace("1234.5", "1'234.5").replace(
        "2000", "2'000"
    ),
    "results before the data": "Test report\nMax force: 2000 N\nMax disp: 2.25\n\n"
    + PLAIN,
    "results in columns before the data": (
        "Specimen,Max force,Max displacement\n1,2000,2.25\n\n" + PLAIN
    ),
    "settings of the machine before the data": "Rate,100\nOperator,Meier\nRange,0,100\n"
    + PLAIN,
    "sums before the data": "4 2000 2.25 -500.25\nt u[mm] F[N]\n" + ROWS,
    "a head that comes again": (
        "t u[mm] F[N]\n0 0 0\n0.5 1.5 1234.5\n\fSlip rig   Page 2\nt u[mm] F[N]\n"
        "-----------\n"
        "1 2.25 2000\n1.5 -1 -500.25\n"
    ),
    "text between head and data": (
        "time,disp,force\ns,mm,N\nZeroed by Meier; loaded slowly\n===,===,===\n"
        + PLAIN.partition("\n")[2]
    ),
    "words on what happens between rows": (
        "t;u [mm];F [N]\n0;0;0\n0.5;1.5;1234.5\nphase 2;slow;unloading\n1;2.25;2000\n"
        "1.5;-1;-500.25\n"
    ),
    "units above the names": "s;mm;N\nZeit;Weg;Kraft\n" + GERMAN,
    "a column of remarks": (
        "t,u [mm],F [N],remark\n0,0,0,\n0.5,1.5,1234.5,slips, loudly\n1,2.25,2000,\n"
        "1.5,-1,-500.25,back\n"
    ),
    "remarks without a name": "t u[mm] F[N]\n"
    + ROWS.replace("1234.5\n", "1234.5 slips here\n"),
    "a column of names in front": (
        "point,t,u [mm],F [N]\nA,0,0,0\nB,0.5,1.5,1234.5\nC,1,2.25,2000\n"
        "D,1.5,-1,-500.25\n"
    ),
    "the time of day beside the time": (
        "Time;Time [s];Disp. [mm];Axial Force [N]\n12:00:00;0;0;0\n"
        "12:00:00;0,5;1,5;1234,5\n"
        "12:00:01;1;2,25;2000\n12:00:01;1,5;-1;-500,25\n"
    ),
    "rows without a number": (
        "t,u [mm],F [N]\n0,0,0\n0.2,NaN,3\n0.3,,\n0.4,0.1,n/a\n0.5,1.5,1234.5\n"
        "0.6,-,-\n"
        "1,2.25,2000\n1.2,*****,7\n1.5,-1,-500.25\n"
    ),
    "a last line that was cut off": "t u[mm] F[N]\n" + ROWS + "2.0 -3\n",
    "a line that names the separator": "sep=;\nt;u [mm];F [N]\n" + GERMAN,
    "bars between columns": PLAIN.replace(",", "|"),
    "a table of Markdown, with decimal commas": (
        "| t [s] | u [mm] | F [N] |\n|---|---:|:---|\n| 0 | 0 | 0 |\n"
        "| 0,5 | 1,5 | 1234,5 |\n| 1 | 2,25 | 2000 |\n| 1,5 | -1 | -500,25 |\n"
    ),
    "lines of a Mac of before 2001, and the end of a file of DOS": PLAIN.replace(
        "\n", "\r"
    )
    + "\x1a",
}


def table_of(data: str | bytes) -> Table:
    return read_table(data, "rig.csv", "--with", CAN)


def assert_is_the_loop(loop: MeasuredLoop) -> None:
    """Check it in SI, with its times where the file has them."""
    np.testing.assert_allclose(
        1e3 * loop.displacement, DISPLACEMENTS, rtol=1e-9, atol=1e-9
    )
    np.testing.assert_allclose(loop.force, FORCES, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(loop.times, TIMES, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("kind", KINDS)
def test_a_loop_is_the_same_however_it_is_written(kind: str) -> None:
    table = table_of(KINDS[kind])
    assert use_of(table, AXES) is Use.LOOP
    assert_is_the_loop(loop_in(table, AXES))


@pytest.mark.parametrize(
    ("kind", "said"),
    [
        (
            "rows without a number",
            "4 points, .*left out 5 rows without a number .lines 3, 4, 5, 7",
        ),
        ("a last line that was cut off", "left out 1 row without a number .line 6"),
        ("a head that comes again", "its head comes again once; passed over line 4"),
        ("results in columns before the data", "another table passed over .line 2"),
        ("a column of remarks", "passed over: 'remark'"),
        ("commas between thousands", "thousands with commas"),
        ("points between thousands", "thousands with points"),
        (
            "units in capitals",
            "Zeit in SEC, Weg in MM, Kraft in N, 4 points, from −500.25 to 2000",
        ),
        ("inches and pounds", "t in s .no unit given., stroke in in, load in lbf"),
    ],
)
def test_messages_state_how_a_table_was_understood(kind: str, said: str) -> None:
    message = loop_in(table_of(KINDS[kind]), AXES).message
    with pytest.raises(AssertionError, match=said):
        raise AssertionError(message)


@pytest.mark.parametrize("scene", CATALOGUE)
def test_a_loop_is_read_whose_head_has_the_titles_of_its_scene(scene: str) -> None:
    """A loop of *Slip at the well* was taken for a path of the fluid."""
    axes = CATALOGUE[scene].checked(SMALL[scene]).structure().axes
    heads = ["time [s]"]
    heads += [f"{title} [{unit}]" for title, unit in axes]
    rows = "0,0,0\n0.5,1.5e6,1234.5e3\n1,2.25e6,2e6\n1.5,-1e6,-5e5\n"
    table = table_of(",".join(heads) + "\n" + rows)
    assert use_of(table, axes) is Use.LOOP
    loop = loop_in(table, axes)
    assert np.ptp(loop.displacement) == 3.25e6
    assert "from −500000 to 2·10⁶" in loop.message


@pytest.mark.parametrize(
    ("heads", "axes"),
    [
        ("Zeit;Neigungswinkel [Grad];Federkraft [N]", (("Angle", "°"), ("Force", "N"))),
        ("t;Krümmung [1/m];Drehmoment [Nm]", (("Bend", "1/m"), ("Moment", "N·m"))),
        ("t;Gleitweg [m];Scherkraft [N]", (("Slip at the well", "m"), ("Force", "N"))),
    ],
)
def test_german_heads_of_all_kinds_of_loops_are_read(heads: str, axes: Axes) -> None:
    table = table_of(f"{heads}\n0;0;0\n0,5;1,5;2\n1;2,25;3\n1,5;-1;0,5\n")
    assert use_of(table, axes) is Use.LOOP
    assert loop_in(table, axes).displacement.tolist() == [0.0, 1.5, 2.25, -1.0]


@pytest.mark.parametrize(
    ("data", "why"),
    [
        (
            "t\tu\tF\n0\t0\t0\n1\t1,234\t2\n",
            "line 3 has '1,234', which may be 1.234 or 1234",
        ),
        (
            "u;F\n0;0\n0,5;1\n0.7;2\n1,5;3\n",
            "line 4 has '0.7', with a decimal point where others",
        ),
        (
            "u;F\n0;0\n1,5;1.234.567,5\n1;12,345.5\n",
            "line 4 has '12,345.5', with a decimal point",
        ),
        ("u,F\n0,0\n1,1\n2,2\n3,inf\n", "line 5 has 'inf' as F: leave such rows out"),
        ("u,F\n0,0\n1,l2\n2,2\n3,4\n", "line 3 has 'l2' as F: give a number"),
        ("u,F\n0,0\n1,2,3\n2,3\n", "line 3 has 3 cells for 2 columns"),
        (
            "u,F\n0,0\n1,2\n\nu,F,t\n0,0,0\n1,2,3\n",
            "tables of 2 rows begin at lines 2 and 6",
        ),
        ("u [mm],F [kg]\n0,0\n1,2\n", "line 1 says kg: give it in N, kN, MN"),
        ("u,F,load\n0,0,1\n1,2,3\n", "'F' and 'load' may both be meant: rename"),
        (
            "u,F\n0,-\nNaN,2\n,\n",
            "none of its rows has a number in each of these columns",
        ),
        ("Max force: 3 N\nRate: 7\n", "it has no points: give lines of numbers"),
        ("", "it has no points"),
        (
            b"\x89PNG\r\n\x1a\n\x00\x00\x00\rIHDR",
            "it is no text: save the table as CSV",
        ),
        (bytes(range(1, 200)), "it is no text: save the table as CSV"),
        (b"PK\x03\x04 of something else", "it is no workbook .*save the table as CSV"),
        (
            b"\xd0\xcf\x11\xe0 of before 2007",
            "it is no workbook .*save the table as CSV",
        ),
        (b"1,2\n" * 1_000_001, "it has more than 4 MB"),
    ],
    ids=lambda value: str(value)[:40],
)
def test_ambiguous_tables_are_refused_with_the_place(
    data: str | bytes, why: str
) -> None:
    with pytest.raises(SettingError, match=why) as caught:
        loop_in(table_of(data), AXES)
    assert "rig.csv" in str(caught.value)


def workbook(rows: list[list[Any]], title: str = "Messung") -> bytes:
    book = openpyxl.Workbook()
    sheet = book.active
    sheet.title = title
    for row in rows:
        sheet.append(row)
    book.create_sheet("Notes").append(["time", "displacement", "force"])
    file = io.BytesIO()
    book.save(file)
    return file.getvalue()


def test_the_first_sheet_of_a_workbook_is_read() -> None:
    head = [["Slip rig"], [], ["t", "Weg", "Kraft", "remark"], ["s", "mm", "N"]]
    rows = [list(row) for row in zip(TIMES, DISPLACEMENTS, FORCES, strict=True)]
    rows[1].append("slips")
    loop = loop_in(table_of(workbook([*head, *rows])), AXES)
    assert_is_the_loop(loop)
    assert "4 points" in loop.message
    assert "sheet 'Messung' of 2" in loop.message


def test_a_cell_of_a_workbook_is_refused_with_its_row() -> None:
    rows = [["u", "F"], [0, 0], [None, 1.0], [2.5, "much"], [3, 4]]
    with pytest.raises(SettingError, match="line 4 has 'much' as F"):
        loop_in(table_of(workbook(rows)), AXES)


def test_without_openpyxl_a_workbook_is_refused_with_what_to_do(
    monkeypatch: Any,
) -> None:
    data = workbook([["u", "F"], [0, 1]])
    monkeypatch.setitem(sys.modules, "openpyxl", None)
    with pytest.raises(
        SettingError, match=r"save the table as CSV, or .*slipfront\[excel\]"
    ):
        table_of(data)


@pytest.mark.parametrize(
    ("head", "rows", "use"),
    [
        ("x,t,friction force", "0.1,0,1\n0.2,0,2\n0.1,1,3\n0.2,1,4\n", Use.RESULTS),
        ("x,t,displacement", "0.1,0,1\n0.2,0,2\n0.1,1,3\n0.2,1,4\n", Use.RESULTS),
        ("x,t,F", "0.1,0,1\n0.2,0,2\n0.1,1,3\n0.2,1,4\n", Use.RESULTS),
        ("x,friction force", "0.1,0\n0.2,1\n", Use.RESULTS),
        ("position,force", "0.1,0\n0.2,1\n", Use.LOOP),
        ("t,x,F", "0,0.1,1\n1,0.2,2\n2,0.3,2\n", Use.LOOP),
        ("time,position,displacement,force", "0,1,0,1\n0,2,0,2\n", Use.LOOP),
        ("u,friction", "0,1\n1,2\n", Use.LOOP),
        ("time,force", "0,1\n1,2\n", Use.PATH),
        ("time,displacement", "0,1\n1,2\n", Use.PATH),
    ],
)
def test_a_table_is_a_loop_or_results_or_a_path_by_its_head(
    head: str, rows: str, use: Use
) -> None:
    assert use_of(table_of(f"{head}\n{rows}"), AXES) is use


@pytest.mark.parametrize("scene", CATALOGUE)
def test_the_axes_of_a_loop_are_those_of_its_structure(scene: str) -> None:
    structure = CATALOGUE[scene].checked(SMALL[scene]).structure()
    assert structure.axes == structure.loop(discrete.discretise(structure)).axes


def test_values_a_thousand_times_off_the_run_are_doubted() -> None:
    bare = loop_in(table_of(PLAIN.replace(" [mm]", "").replace(" [N]", "")), AXES)
    run = np.array(DISPLACEMENTS) * 1e-3, 2.0 * np.array(FORCES)
    (doubt,) = bare.doubts(*run)
    assert (
        "displacement has no unit, and taken in m it is 1000 times that of the run"
        in doubt
    )
    assert "if it is in mm, name that in the head, as in displacement [mm]" in doubt
    kilo = run[0] * 1e3, 1e3 * run[1]
    (doubt,) = bare.doubts(*kilo)
    assert "as in force [kN]" in doubt
    assert loop_in(table_of(PLAIN), AXES).doubts(*kilo) == []


SIZES = ["--set=elements=10", "--set=substructures=2", "--set=instants=11"]


def test_the_command_doubts_loops_and_paths_without_a_unit(
    tmp_path: Path, capsys: Any
) -> None:
    loop = tmp_path / "loop.csv"
    loop.write_text("u,F\n0,0\n0.3,500\n0.5,900\n0.2,-100\n")
    load = "--set=load=[[0,0],[0.6,900],[1,-100]]"
    assert main(["compare", "bar", *SIZES, load, "--with", str(loop)]) == 0
    assert "as in u [mm]" in capsys.readouterr().err
    path = tmp_path / "path.csv"
    path.write_text("time,force\n0,0\n1,0.9\n")
    assert main(["run", "bar", *SIZES, f"--set=load={path}"]) == 0
    assert "as in force [kN]" in capsys.readouterr().err
    path.write_text("position,friction factor\n0,1\n1000,2\n")
    assert main(["run", "bar", *SIZES, f"--set=friction_profile={path}"]) == 0
    said = capsys.readouterr().err
    assert (
        "position has no unit, and taken in m it is 1000 times that of the scene"
        in said
    )
    assert "if it is in mm" in said


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="there are no named pipes")
@pytest.mark.parametrize("command", ["compare", "run", "saved"])
def test_a_pipe_or_a_device_is_refused_at_once(
    command: str, tmp_path: Path, capsys: Any
) -> None:
    pipe = tmp_path / "pipe.toml"
    os.mkfifo(pipe)
    arguments = {
        "compare": ["compare", "bar", "--with", str(pipe)],
        "run": ["run", "bar", f"--set=load={pipe}"],
        "saved": ["run", str(pipe)],
    }
    assert main(arguments[command]) == 2
    assert (
        "it is a pipe or a device: save what it gives to a file"
        in capsys.readouterr().err
    )
    arguments["compare"][-1] = os.devnull
    if command == "compare":
        assert main(arguments[command]) == 2
        assert "it is a pipe or a device" in capsys.readouterr().err


def test_opening_a_file_reads_it_once_and_makes_no_problem(monkeypatch: Any) -> None:
    """A page without a frame yet knows what a loop is over by the structure alone."""
    from app.files import opener, tables
    from app.state import PageState, default_settings

    calls = []

    def counted(*given: Any) -> Table:
        calls.append(given)
        return read_table(*given)

    monkeypatch.setattr(tables, "read_table", counted)
    settings = default_settings("block")
    problem = type(discretise(settings))
    monkeypatch.setattr(
        problem, "__init__", lambda *given: pytest.fail("it made a problem")
    )
    state = PageState(settings)
    for text in (
        PLAIN,
        "x,t,friction force\n" + "0.1,0.1,1\n" * 4,
        "time,force\n0,0\n1,2\n",
    ):
        calls.clear()
        made = opener.TableOpener(state, "Open", tables.TABLES, 200)
        made.file.filename = "rig.csv"
        made.file.value = text.encode()
        assert len(calls) == 1
        assert made.message.object


def test_rows_without_times_are_doubted_where_a_run_stands_as_its_force_changes() -> (
    None
):
    """A fit of an arch, whose weight comes first, found nothing and did not say why."""
    displacement = np.array([0.0, 0.0, 1.0, 2.0])
    force = np.array([0.0, 5.0, 4.0, 6.0])
    loop = "displacement [m],force [N]\n0,0\n0,5\n1,4\n2,6\n"
    (doubt,) = loop_in(table_of(loop), AXES).doubts(displacement, force)
    assert "need their times" in doubt
    assert not loop_in(table_of(loop), AXES).doubts(np.arange(4.0), force)
    rows = loop.splitlines()
    timed = "\n".join(f"{n},{row}" for n, row in enumerate(rows[1:]))
    with_times = loop_in(table_of(f"time [s],{rows[0]}\n{timed}\n"), AXES)
    assert not with_times.doubts(displacement, force)
