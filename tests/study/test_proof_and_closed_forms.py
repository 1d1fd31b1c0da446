"""Known values stand beside found ones: in the proof, and as curves under runs."""

from __future__ import annotations

import csv
import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any
from urllib.parse import parse_qsl

import numpy as np
import pytest

from app.link import read as read_address
from solver.commands.cli import main
from solver.reference.closed_forms.elastic_bodies import HalfPlane
from solver.reference.incremental import reference_of
from solver.scenes import CATALOGUE, discretise
from solver.scenes.bar import BarSettings
from solver.scenes.block import BlockSettings
from solver.study import proof
from solver.study.known_numbers import Number, SolvedCase
from solver.study.proof import KnownCase

CASES = proof.cases()


def read(folder: Path) -> list[dict[str, str]]:
    with (folder / "proof.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def wrong(case: KnownCase) -> KnownCase:
    """A case whose known number is one per cent too large."""

    def numbers(answer: SolvedCase) -> Iterator[Number]:
        for quantity, unit, exact, found in case.numbers(answer):
            yield quantity, unit, 1.01 * exact, found

    return replace(case, numbers=numbers)


@pytest.mark.parametrize("case", CASES, ids=lambda one: one.title)
def test_an_address_opens_the_run_of_its_row(case: KnownCase) -> None:
    place, complaint = read_address(case.address)
    settings = place["settings"]
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
    found = {
        dict(parse_qsl(case.address.removeprefix("?"))).get("scene") for case in CASES
    }
    assert found >= set(CATALOGUE)


@pytest.mark.parametrize("number", [2])
def test_a_wrong_number_fails_and_says_so(
    number: int,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr(proof, "cases", lambda: [CASES[number], wrong(CASES[number])])
    assert main(["proof", "--out", str(tmp_path)]) == 1
    assert "FAILS" in capsys.readouterr().out
    verdicts = [row["holds"] for row in read(tmp_path)]
    half = len(verdicts) // 2
    assert verdicts[:half] == ["holds"] * half
    assert verdicts[half:] == ["FAILS"] * half


KNOWN = {
    "bar pulled to and fro": ["friction", "loop"],
    "bar whose pressure halves while the load stands": ["friction", "loop"],
    "bar on contact that gives way, pulled to and fro": ["loop"],
    "bar on friction that softens with slip": ["loop"],
    "broken wire between two others": ["axial force", "axial force"],
    "parabola pressed on a plane": ["pressure"],
    "parabola sheared to and fro": ["pressure", "friction"],
    "block on a slope, caught by a spring": ["loop"],
    "three layers that friction glues": ["loop"],
    "shoe on a rigid plane (SSNV503)": ["loop"],
    "slip front driven by a fluid, T = 0.5": ["front", "friction"],
    "slip under a strength that grows from the middle": ["front", "friction"],
}
"""What the run of a case of the proof is drawn over."""
APART = {"friction": 0.03, "pressure": 0.08, "loop": 0.01}
"""Mean distance to the reference's curve over its mean size, that the meshes of the
proof leave."""
PRESSED = 0.1
"""Friction summed along a parabola, over mu P: pressing what is no half-plane leaves
some."""


def settings_of(title: str) -> Any:
    (case,) = [case for case in CASES if case.title == title]
    assert dict(parse_qsl(case.address.removeprefix("?")))["scene"] in CATALOGUE
    return read_address(case.address)[0]["settings"]


@pytest.mark.parametrize(("title", "known"), KNOWN.items())
def test_a_run_of_the_proof_is_drawn_over_what_is_known_of_it(title, known):
    settings = settings_of(title)
    problem = discretise(settings)
    found = reference_of(problem)
    curves = list(settings.exact(problem, found))
    assert [one.of for one in curves] == known
    for curve in curves:
        assert np.abs(curve.up).max() > 0.0
        if curve.of == "front":
            assert_front(curve, problem, found)
        elif curve.of == "loop":
            loop = settings.structure().loop(problem)
            assert_near(curve.of, curve.up, loop.force(found))
            assert_near(curve.of, curve.across, loop.displacement(found.displacement))
        elif curve.of != "axial force":
            assert_traction(curve, settings, problem, found)


def assert_near(of, exact, ours):
    """Check that a field is near a known one, in the mean."""
    assert np.abs(exact - ours).mean() <= APART[of] * np.abs(exact).mean()


def assert_front(curve, problem, found):
    """Check that the last point that slips is at the known front, within an element."""
    places = problem.contacts["support"].positions
    slips = found.contact("support").status != 0
    last = np.where(slips, places[:, None], 0.0).max(axis=0)
    assert curve.up == pytest.approx(problem.instants)
    assert np.abs(curve.across - last).max() <= 1.1 * places[1]


def assert_traction(curve, settings, problem, found):
    """Check a pressure or friction; under a pressure that is found, its sums."""
    (name, law), *_ = problem.contacts.items()
    contact = found.contact(name)
    weights = law.by_point(law.weights)[:, None]
    if curve.of == "pressure":
        assert_near(curve.of, curve.up, contact.normal_force / weights)
    elif curve.of == "friction" and contact.normal_force is not None:
        missing = np.cumsum(curve.up * weights - contact.tangential_force, axis=0)
        largest = settings.friction * contact.normal_force.sum(axis=0).max()
        assert np.abs(missing).max() <= PRESSED * largest
    else:
        assert_near(curve.of, curve.up, contact.tangential_force / weights)


def test_traction_of_a_shear_that_turns_begins_as_cattaneos_and_carries_the_force():
    contact = HalfPlane(1e6, 5.0, 2.1e11)
    place = np.linspace(-1.2, 1.2, 4801) * contact.half_width
    most = 0.3 * contact.force
    shear = most * np.array([0.0, 0.3, 0.6, 0.1, -0.6, 0.6])
    found = contact.traction_over(place, 0.3, shear)
    assert np.trapezoid(found, place, axis=0) == pytest.approx(shear, abs=2e-3 * most)
    grown = contact.traction(place, 0.3, 0.6)
    peak = 0.3 * contact.peak
    # The levels are steps, so near the ends of what sticks it is a little off.
    for instant, sign in ((2, 1.0), (4, -1.0), (5, 1.0)):
        assert np.abs(found[:, instant] - sign * grown).mean() < 2e-3 * peak


@pytest.mark.parametrize(
    "settings",
    [
        BarSettings.checked({"body_force": 100.0}),
        BarSettings.checked(
            {"friction_law": "compliant", "pressure_load": "loosening"}
        ),
        BlockSettings.checked({"gap": "flat"}),
        BlockSettings.checked({"radius": 500.0, "elements": 12, "elements_up": 6}),
    ],
    ids=["body force", "springs under a pressure that falls", "flat", "wide contact"],
)
def test_nothing_is_drawn_where_no_closed_form_is_known(settings):
    problem = discretise(settings)
    assert list(settings.exact(problem, reference_of(problem))) == []
