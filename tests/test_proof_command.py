"""`python -m solver proof` sets what is known beside what is found, and fails where a row does."""

from __future__ import annotations

import csv
import json
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any
from urllib.parse import parse_qsl

import pytest

import solver.reference.closed_forms as closed_forms
from app.link import read as read_address
from solver.cli import main
from solver.reference.choice import reference_of
from solver.scenes import CATALOGUE, discretise
from solver.study.proof import published, report
from solver.study.proof.case import Answer, KnownCase, KnownNumber, rows_of

CASES = list(report.cases())
CLOSED_FORMS = {
    "bent_strand",
    "cantilever",
    "changing_friction_bar",
    "compliant_bar",
    "half_plane",
    "slip_front",
}


def read(folder: Path) -> list[dict[str, str]]:
    with (folder / "proof.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def wrong(case: KnownCase) -> KnownCase:
    """Give a case that claims one more in a hundred than is true."""

    def numbers(settings: Any, answer: Answer) -> Iterator[KnownNumber]:
        for number in case.numbers(settings, answer):
            yield replace(number, exact=1.01 * number.exact)

    return replace(case, numbers=numbers)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("proof")
    assert main(["proof", "--out", str(made)]) == 0
    return made


def test_every_number_holds_by_both_solvers(folder: Path) -> None:
    rows = read(folder)
    assert {row["case"] for row in rows} == {case.title for case in CASES}
    assert {row["solver"] for row in rows} == {"LATIN", "incremental"}
    for row in rows:
        known, ours = float(row["known"]), float(row["ours"])
        assert row["holds"] == "holds"
        assert abs(ours / known - 1.0) <= float(row["allowed"])
        assert float(row["allowed"]) <= 0.07
        assert all(row[name] for name in ("mesh", "source", "unit"))


def test_the_page_has_every_row_and_loads_nothing(folder: Path) -> None:
    page = (folder / "proof.html").read_text(encoding="utf-8")
    rows = read(folder)
    parts = {row["part"] for row in rows}
    numbers = {(row["case"], row["quantity"]) for row in rows}
    assert page.count("<tr>") == len(numbers) + len(CASES) + len(parts)
    assert page.count(">holds</td>") == len(numbers)
    assert set(re.findall("<h2>(.*?)</h2>", page)) == parts == {"Closed forms", "Published numbers"}
    assert not re.search(r"<(script|link|img|iframe)", page)


@pytest.mark.parametrize("case", CASES, ids=lambda one: one.title)
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


def test_a_run_that_does_not_end_proves_nothing() -> None:
    case = CASES[0]
    (row, *_) = rows_of(case)
    assert row.holds
    assert not replace(row, ended=False).holds
    assert not replace(row, number=replace(row.number, found=float("nan"))).holds


def test_every_closed_form_that_has_a_file_of_its_own_is_used() -> None:
    sources = [
        file.read_text(encoding="utf-8") for file in Path(report.__file__).parent.glob("*.py")
    ]
    there = {file.stem for file in Path(closed_forms.__file__).parent.glob("*.py")}
    assert there >= CLOSED_FORMS
    for name in CLOSED_FORMS:
        assert any(f"{closed_forms.__name__}.{name}" in source for source in sources), name


def test_slip_in_an_infinite_body_is_nearer_on_a_finer_mesh(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def deviation() -> float:
        *_, case = published.published_cases()
        problem = discretise(case.settings)
        answer = Answer(problem, reference_of(problem))
        return max(number.deviation for number in case.numbers(case.settings, answer))

    coarse = deviation()
    fine = {"elements": 192, "elements_up": 96, "substructures": 16, "substructures_up": 8}
    monkeypatch.setattr(published, "FAULT", {**published.FAULT, **fine})
    monkeypatch.setattr(published, "ZONE", 2 * published.ZONE)
    assert coarse > 1.4 * deviation()


def test_a_folder_that_cannot_be_made_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "file").write_text("")
    assert main(["proof", "--out", str(tmp_path / "file")]) == 2
    assert "--out" in capsys.readouterr().err
