"""`python -m solver proof` sets what is known beside what is found, and fails where a row does."""

from __future__ import annotations

import csv
import json
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from urllib.parse import parse_qsl

import numpy as np
import pytest

from app.link import read as read_address
from solver.cli import main
from solver.scenes import CATALOGUE
from solver.study.proof import by_getfem, others, report
from solver.study.proof.case import KnownCase, KnownNumber, of_field
from solver.study.speed.error_against_time import PeerError

CASES = list(report.cases())


def read(folder: Path) -> list[dict[str, str]]:
    with (folder / "proof.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def wrong(case: KnownCase) -> KnownCase:
    """Give a case that claims one more in a hundred than is true."""

    def numbers(answer: object) -> Iterator[KnownNumber]:
        for number in case.numbers(answer):  # type: ignore[arg-type]
            yield replace(number, exact=1.01 * number.exact)

    return replace(case, numbers=numbers)


@pytest.mark.parametrize("case", [one for one in CASES if one.address], ids=lambda one: one.title)
def test_an_address_opens_the_run_of_its_row(case: KnownCase) -> None:
    place, complaint = read_address(case.address)
    settings = place.settings
    assert not complaint
    given = dict(parse_qsl(case.address.removeprefix("?")))
    assert settings.scene == given.pop("scene")
    for name, text in given.items():
        value = getattr(settings, name)
        if isinstance(value, str):
            assert value == text
        else:
            assert json.loads(json.dumps(value)) == json.loads(text)


def test_each_scene_is_proven() -> None:
    found = {dict(parse_qsl(case.address.removeprefix("?"))).get("scene") for case in CASES}
    assert found >= set(CATALOGUE)


@pytest.mark.parametrize("number", [0, 2, 7])
def test_a_wrong_number_fails_and_says_so(
    number: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(report, "cases", lambda: iter([CASES[number], wrong(CASES[number])]))
    assert main(["proof", "--out", str(tmp_path)]) == 1
    assert "FAILS" in capsys.readouterr().out
    verdicts = [row["holds"] for row in read(tmp_path)]
    half = len(verdicts) // 2
    assert verdicts[:half] == ["holds"] * half
    assert verdicts[half:] == ["FAILS"] * half


def test_a_program_that_is_not_installed_is_said_to_be_absent(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    gone = [replace(one, module="not_there") for one in others.PUBLIC]
    monkeypatch.setattr(others, "PUBLIC", gone)
    monkeypatch.setattr(by_getfem, "installed", lambda: None)
    assert not list(others.other_cases())
    _, page = report.write_proof([], tmp_path)
    assert "Not installed: PIQP, OSQP, DAQP, Clarabel, GetFEM." in page.read_text(encoding="utf-8")


def test_a_field_is_as_far_off_as_where_it_is_farthest_off() -> None:
    theirs = np.zeros((2, 5, 3))
    theirs[:, 1, 2] = 3.0, -4.0
    ours = theirs.copy()
    ours[:, 4, 0] = 0.3, 0.4
    number = of_field("displacement", "m", theirs, ours)
    assert (number.exact, number.found) == (5.0, 5.0)
    assert number.deviation == pytest.approx(0.1)
    assert of_field("displacement", "m", theirs, theirs).deviation == 0.0
    assert np.isnan(of_field("displacement", "m", theirs * np.nan, ours).deviation)


def test_a_program_that_gives_up_proves_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def give_up(*_given: object) -> object:
        raise PeerError("gave up at instant 1: no more digits")

    monkeypatch.setattr(others, "solve_by", give_up)
    monkeypatch.setattr(others, "PUBLIC", [replace(others.PUBLIC[0], module="numpy")])
    broken = by_getfem.Installed(sys.executable, "0")
    monkeypatch.setattr(by_getfem, "installed", lambda: broken)
    monkeypatch.setattr(by_getfem, "PROGRAM", tmp_path / "nowhere.py")
    found = list(others.other_cases())
    assert len(found) == 2
    for case in found:
        rows = list(report.rows_of(case))
        assert rows
        assert not any(row.holds for row in rows)


def test_a_folder_that_cannot_be_made_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "file").write_text("")
    assert main(["proof", "--out", str(tmp_path / "file")]) == 2
    assert "--out" in capsys.readouterr().err
