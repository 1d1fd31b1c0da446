"""Tables and settings are read from files as people write them, or refused with the line."""

from __future__ import annotations

from pathlib import Path

import pytest
from valid_settings import refusal

from app.link import read as read_address
from solver.files import settings_from_command, settings_from_toml


def test_a_csv_is_found_beside_the_settings_file_or_in_the_working_folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    folder = tmp_path / "deep"
    folder.mkdir()
    (folder / "path.csv").write_text("time,force\n0,0\n0.5, 100\n1,-1e2\n", encoding="utf-8-sig")
    (folder / "run.toml").write_text('scene = "bar"\nload = "path.csv"\n', encoding="utf-8")
    expected = ((0.0, 0.0), (0.5, 100.0), (1.0, -100.0))
    assert settings_from_command("deep/run.toml", [])[0].load == expected
    assert settings_from_command("bar", ["load=deep/path.csv"])[0].load == expected


def test_a_csv_may_have_quoted_names_in_capitals_and_empty_lines(tmp_path):
    file = tmp_path / "load.csv"
    file.write_text('"Time", Force\n\n0,0\n , \n1,"700"\n\n', encoding="utf-8")
    settings, _ = settings_from_command("bar", [f"load={file}"])
    assert settings.load == ((0.0, 0.0), (1.0, 700.0))


@pytest.mark.parametrize(
    ("rows", "remedy"),
    [
        ("", "no points"),
        ("time,force\n", "no points"),
        ("0,0\n\n1\n", "line 3"),
        ("0,0\n1\n", "line 2"),
        ("0,0\n1,\n", "line 2"),
        ("0,0\n1,2,3\n", "line 2"),
        ("0,0\n1,much\n", "line 2"),
        ("0;0\n0,5;1.5\n", "line 2"),
        ('0,0\n1,"1,000"\n', "line 2"),
        ("time (lb),force (N)\n0,0\n", "line 1 says lb: give it in s, ms, min, h"),
        ("time;force\ns;lbf\n0;0\n", "line 2 says lbf: give it in N, kN, MN"),
        ("much,1\n1,1\n", "line 1"),
        ("0,0\n1,nan\n", "line 2"),
        ("0,0\n1,inf\n", "line 2"),
        ("1,0\n0,0\n", "must increase"),
        ("0,0\n0,1\n", "must increase"),
    ],
    ids=repr,
)
def test_a_bad_csv_is_refused_with_its_line(tmp_path, rows, remedy):
    file = tmp_path / "load.csv"
    file.write_text(rows, encoding="utf-8")
    text = refusal(lambda: settings_from_command("bar", [f"load={file}"]))
    assert text.startswith("load = ")
    assert "allowed: ramp, triangle" in text
    assert remedy in text


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
        assert "load = " in text
        assert remedy in text
    assert "no readable CSV file" in refusal(lambda: settings_from_command(str(nul), []))


@pytest.mark.parametrize(
    "text",
    [
        "scene = bar",
        'scene = "bar"\npeak =',
        "[[[",
        'scene = "bar"\nscene = "bar"',
        "\x00",
        'scene = "bar"\npeak = ' + "9" * 5000,
        'scene = "bar"\npeak = ' + "[" * 20_000,
    ],
    ids=lambda text: text[:20],
)
def test_a_broken_settings_file_is_refused(text):
    assert "allowed: TOML" in refusal(lambda: settings_from_toml(text))


def test_a_settings_file_that_cannot_be_read_is_refused(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Path("binary.toml").write_bytes(b"\xff\xfe")
    Path("folder.toml").mkdir()
    for name in ("none.toml", "binary.toml", "folder.toml"):
        text = refusal(lambda name=name: settings_from_command(name, []))
        assert name in text
        assert "readable TOML file" in text


@pytest.mark.parametrize("path", ["/etc/passwd", "load.csv", "../load.csv"])
def test_an_address_never_reads_a_file(tmp_path, monkeypatch, path):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "load.csv").write_text("0,0\n1,100\n", encoding="utf-8")
    opened = []
    monkeypatch.setattr(Path, "read_text", lambda self, *rest, **more: opened.append(self))
    for text in (path, f'"{path}"'):
        place, complaint = read_address(f"?load={text}")
        assert place.settings.load == "sine"
        assert "choose a preset" in complaint
    assert not opened


def test_an_uploaded_file_never_names_another():
    text = 'scene = "bar"\nload = "/etc/passwd"\n'
    assert "choose a preset" in refusal(lambda: settings_from_toml(text))
