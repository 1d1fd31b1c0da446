"""What a table along a body has between nodes, a run sees, or says that it does not."""

from __future__ import annotations

import json

import numpy as np
import pytest

from solver.cli import main
from solver.latin import Ending, solve
from solver.profiles import gap_at, unseen
from solver.reference.incremental import incremental
from solver.scenes import CATALOGUE, discretise, left_out, structure_of
from solver.scenes.method import method_of

ASPERITY = [[0.0, 1e-5], [0.05, 1e-5], [0.0503, 0.0], [0.0506, 1e-5], [0.1, 1e-5]]
PRESSED = {
    "top": "displacement",
    "top_normal_displacement": -5e-6,
    "top_tangential_displacement": 0.0,
    "instants": 5,
}


def drawn(seed: int, length: float, *, least: float = 0.0) -> list[list[float]]:
    """A table of factors with wide and narrow peaks, wherever the nodes are."""
    random = np.random.default_rng(seed)
    middles = random.uniform(0.02, 0.98, 5) * length
    halves = 10.0 ** random.uniform(-5.0, -2.0, 5) * length
    places = np.unique(np.concatenate([middles - halves, middles, middles + halves]))
    factors = random.uniform(least, 2.0, len(places))
    return [[float(a), float(b)] for a, b in zip(places, factors, strict=True)]


def integral(*tables: list[list[float]], over: np.ndarray) -> float:
    """Integrate a product of tables by many middles of each of their pieces."""
    points = np.concatenate([np.array(table)[:, 0] for table in tables])
    ends = np.union1d(points[(points > over[0]) & (points < over[1])], over)
    share = (np.arange(200) + 0.5) / 200
    where = ends[:-1, None] + share * np.diff(ends)[:, None]
    values = np.prod([np.interp(where, *np.transpose(table)) for table in tables], axis=0)
    return float((values.mean(axis=1) * np.diff(ends)).sum())


@pytest.mark.parametrize("seed", range(4))
def test_all_friction_of_the_bar_is_there_whatever_the_mesh(seed):
    length = 2.0
    mu, pressure = drawn(seed, length), drawn(seed + 100, length)
    whole = 0.3 * 5000.0 * integral(mu, pressure, over=np.array([0.0, length]))
    for elements in (3, 50, 400):
        changes = {"friction_profile": mu, "pressure_profile": pressure, "length": length}
        settings = CATALOGUE["bar"].settings.checked(
            {**changes, "elements": elements, "substructures": 1}
        )
        problem = discretise(settings)
        (law,) = problem.rubbing.values()
        total = structure_of(settings).bound @ law.weights
        assert total == pytest.approx(whole, rel=1e-4)


@pytest.mark.parametrize("interpolation", ["bilinear", "biquadratic"])
def test_all_strength_of_a_fault_is_there_whatever_the_mesh(interpolation):
    table = drawn(5, 600.0, least=0.9)
    whole = 0.6 * 1e7 * integral(table, over=np.array([0.0, 600.0]))
    for elements in (12, 48):
        values = {"normal_profile": table, "elements": elements, "interpolation": interpolation}
        settings = CATALOGUE["fault"].settings.checked({**values, "overpressure": 0.0})
        (law,) = discretise(settings).rubbing.values()
        nodal = settings.strength_at_nodes()[:, 0]
        assert nodal @ law.by_point(law.weights[:, None])[:, 0] == pytest.approx(whole, rel=1e-4)


def test_a_notch_between_nodes_stretches_the_bar():
    notched = [[0.0, 1.0], [0.511, 1.0], [0.512, 0.01], [0.513, 0.01], [0.514, 1.0]]
    ends = []
    for elements in (10, 1000):
        values = {"section_profile": notched, "friction": 0.0, "load": "ramp", "instants": 2}
        settings = CATALOGUE["bar"].settings.checked({**values, "elements": elements})
        ends.append(incremental(discretise(settings)).displacement[-1, -1])
    assert ends[0] == pytest.approx(ends[1], rel=1e-9)


def pressed(elements: int) -> tuple[float, list[str]]:
    """Press the block on an asperity; give the force, and what is said."""
    values = {**PRESSED, "gap": ASPERITY, "elements": elements}
    settings = CATALOGUE["block"].settings.checked(values)
    solution = solve(discretise(settings), method_of(settings), watch=False)
    assert solution.status.ending is Ending.CONVERGED
    force = solution.iterate.contact("support").normal_force[:, -1].sum()
    return abs(float(force)), left_out(settings)


def test_an_asperity_between_nodes_touches_and_the_mesh_that_sees_it_is_named():
    coarse, said = pressed(48)
    (message,) = said
    assert "332 elements would see it" in message
    fine, nothing = pressed(332)
    assert nothing == []
    # A point carries in the plane as 1 / log(size): half as much again on shares 7 times as wide.
    assert fine < coarse < 1.5 * fine


@pytest.mark.parametrize("points", [300, 1001])
def test_a_smooth_gap_in_many_points_is_that_of_its_nodes(points):
    x = np.linspace(0.0, 0.1, points)
    table = tuple(zip(x.tolist(), ((x - 0.05) ** 2 / 10.0).tolist(), strict=True))
    nodes = np.linspace(0.0, 0.1, 49)
    assert gap_at(table, nodes) == pytest.approx((nodes - 0.05) ** 2 / 10.0, abs=2e-8)
    assert unseen("gap", table, 0.1, 48, 1) is None


def test_the_command_says_what_its_mesh_does_not_see(capsys):
    command = ["run", "block", "--set", f"gap={json.dumps(ASPERITY)}", "--no-reference"]
    command += [part for name in PRESSED for part in ("--set", f"{name}={PRESSED[name]}")]
    assert main([*command, "--json"]) == 0
    (remark,) = json.loads(capsys.readouterr().out)["remarks"]
    assert main(command) == 0
    assert f"remarks              {remark}" in capsys.readouterr().out
