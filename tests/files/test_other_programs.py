"""Results of other programs are compared with runs."""

from __future__ import annotations

import json
from functools import cache
from itertools import product
from typing import Any

import numpy as np
import pytest

from app.files.tables import table_of as on_a_page
from solver.commands.cli import main
from solver.discrete.problem import Problem
from solver.files.disk import LARGEST
from solver.files.tables import read_table
from solver.reference.distance import determinate_forces
from solver.reference.incremental import reference_of
from solver.reference.solution import Reference
from solver.scenes import CATALOGUE, discretise
from solver.settings.scene import Settings
from solver.settings.values import SettingError
from solver.study.comparison import CAN, Comparison, OtherResults, results_in

HEAD = "x,t,friction force\n"
ROWS = "0.1,0,1\n0.2,0.5,2\n0.3,0.5,3\n0.4,1,4\n"
SMALL: dict[str, dict[str, Any]] = {
    "bar": {"elements": 30, "instants": 21},
    "strand": {"wires": 3, "elements": 12, "instants": 11},
    "block": {"elements": 12, "elements_up": 4, "instants": 11},
}


def settings_of(scene: str = "bar", **changes: Any) -> Settings:
    return CATALOGUE[scene].checked(SMALL[scene] | changes)


@cache
def solved(scene: str) -> tuple[Settings, Problem, Reference]:
    settings = settings_of(scene)
    problem = discretise(settings)
    return settings, problem, reference_of(problem)


def results(text: str, source: str, settings: Settings) -> OtherResults:
    return results_in(read_table(text, source, "the results", CAN), settings)


def table(quantity: str, x: Any, t: Any, values: Any) -> str:
    """Write a field, (n_points, n_instants), as another program would."""
    points = product(np.asarray(x).tolist(), np.asarray(t).tolist())
    rows = [
        f"{place!r},{time!r},{value!r}"
        for (place, time), value in zip(points, np.ravel(values).tolist(), strict=True)
    ]
    return "\n".join([f"x,t,{quantity}", *rows])


def own_friction(scene: str) -> tuple[Any, Any, Any]:
    """Determinate friction per length or area, with its points and instants."""
    _, problem, reference = solved(scene)
    (name, *_) = problem.contacts
    law = next(iter(problem.contacts.values()))
    places = problem.contacts.forces[name][-1]
    sizes = law.by_point(law.weights)[:, None]
    known = determinate_forces(problem)[places].all(axis=1)
    force = reference.contact_force[places] / sizes
    return law.positions[known], problem.instants, force[known]


@pytest.mark.parametrize("scene", SMALL)
@pytest.mark.parametrize("factor", [1.0, 1.25, -1.0])
def test_our_own_friction_times_a_factor_is_as_far_as_the_factor_says(
    scene: str, factor: float
) -> None:
    settings, problem, reference = solved(scene)
    x, t, values = own_friction(scene)
    brought = results(table("friction force", x, t, factor * values), "a.csv", settings)
    beside = Comparison(brought, problem)
    assert beside.counted == len(brought.times) > 50
    expected = abs((factor - 1.0) / factor)
    assert beside.of(reference) == pytest.approx(expected, abs=1e-12)


def test_the_distance_to_the_closed_form_falls_with_the_mesh() -> None:
    """Results are given at places that are no nodes, and at other instants."""
    rng = np.random.default_rng(1)
    distances = []
    for elements in (20, 40, 80):
        settings = settings_of(
            load="ramp", elements=elements, instants=2 * elements + 1
        )
        fine = settings_of(load="ramp", elements=400, instants=401)
        grid = discretise(fine)
        friction, _ = fine.exact(grid)
        where = np.sort(rng.choice(np.arange(1, 400), 150, replace=False))
        when = np.sort(rng.choice(np.arange(1, 401), 60, replace=False))
        x = grid.friction.positions[where]
        t = grid.instants[when]
        text = table(
            "friction force",
            x,
            t,
            friction.up[np.ix_(where, when)],
        )
        brought = results(text, "exact.csv", settings)
        problem = discretise(settings)
        distances.append(Comparison(brought, problem).of(reference_of(problem)))
    assert distances[0] > distances[1] > distances[2]


def test_rows_that_one_of_both_does_not_cover_are_left_out() -> None:
    settings, problem, reference = solved("bar")
    x, t, values = own_friction("bar")
    text = table("friction force", x, t, values)
    # The clamped node shares its friction with the clamp, and the run is over after a
    # second.
    text += "\n0.0,0.5,1e9\n0.1,1.5,1e9\n0.1,-0.5,1e9"
    brought = results(text, "a.csv", settings)
    beside = Comparison(brought, problem)
    assert beside.counted == len(brought.times) - 3
    assert beside.of(reference) < 1e-12


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("", "it has no points"),
        (ROWS, "name its columns in the first line"),
        ("x,friction force\n0.1,1\n", "no column t"),
        ("x,t\n0.1,1\n", "neither friction force nor displacement"),
        (
            "x,t,friction force [N]\n" + ROWS,
            r"says N: give it in N/m, kN/m, N/mm; divide nodal forces",
        ),
        ("x [s],t,friction force\n" + ROWS, "says s: give it in m"),
        (
            HEAD + ROWS + "0.5,1,inf\n",
            "line 6 has 'inf' as friction force: leave such rows out",
        ),
        (HEAD + ROWS + "0.5,much,1\n", "line 6 has 'much' as t: give a number"),
        (
            HEAD + ROWS + "7,1,1\n",
            r"line 6 has x = 7 m, outside of the body.*: name its unit",
        ),
        (
            HEAD + "0.1,0,1\n0.1,1,1\n0.1,2,1\n",
            r"2 of its 3 rows lie in the run.*at least 4",
        ),
        (HEAD + "0.1,0,1\n" * 40_001, "has 40001 rows, and may have 40000"),
    ],
)
def test_results_that_cannot_be_compared_are_refused_with_a_remedy(
    text: str, why: str
) -> None:
    with pytest.raises(SettingError, match=why) as caught:
        results(text, "theirs.csv", settings_of())
    assert "theirs.csv" in str(caught.value)


def test_the_command_tells_the_distance_in_one_line(tmp_path: Any, capsys: Any) -> None:
    x, t, values = own_friction("bar")
    path = tmp_path / "theirs.csv"
    path.write_text(table("friction force", x, t, 1.25 * values))
    sizes = [f"--set={name}={value}" for name, value in SMALL["bar"].items()]
    assert main(["compare", "bar", *sizes, "--with", str(path)]) == 0
    rows = values.size
    assert capsys.readouterr().out == (
        f"friction force: 20 % from theirs.csv, at {rows} of {rows} rows\n"
    )
    assert main(["compare", "bar", *sizes, "--with", str(path), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["distance"] == pytest.approx(0.2)
    assert (found["interface"], found["rows_compared"]) == ("friction", rows)


@pytest.mark.parametrize(
    ("options", "why"),
    [
        (["--with", "/no/such.csv"], "No such file"),
        (["--with", "{}", "--interface", "ceiling"], "allowed: friction"),
    ],
)
def test_the_command_refuses_in_words(
    options: Any, why: str, tmp_path: Any, capsys: Any
) -> None:
    path = tmp_path / "theirs.csv"
    path.write_text(HEAD + ROWS)
    command = ["compare", "bar"] + [option.format(path) for option in options]
    assert main(command) == 2
    assert why in capsys.readouterr().err


def test_a_command_reads_larger_results_than_a_page(tmp_path, capsys) -> None:
    """As the contact of a rope at all points and instants, which a page writes."""
    file = tmp_path / "contact.csv"
    long = " " * 95
    rows = [f"{0.9 * row / 41_000:.6f},0.5,1{long}\n" for row in range(41_000)]
    text = HEAD + "".join(rows)
    file.write_text(text, encoding="utf-8")
    assert file.stat().st_size > LARGEST
    with pytest.raises(SettingError) as refused:
        on_a_page(text, file.name)
    assert refused.value.allowed == "a table of at most 4 MB"
    assert "give it whole to the command compare" in refused.value.remedy
    command = ["compare", "bar", "--set", "instants=21", "--with", str(file)]
    assert main(command) == 0
    assert " of 41000 rows" in capsys.readouterr().out
