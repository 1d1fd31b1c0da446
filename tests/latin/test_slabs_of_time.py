"""Slabs of time have the solution of the whole, and settle under periodic loads."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from runs import distance_of, settings_of

from solver.commands.cli import main
from solver.discrete.problem import Problem
from solver.latin import (
    Ending,
    Latin,
    Stop,
    solve,
)
from solver.latin.slabs import first_slab, next_slab, solve_in_slabs
from solver.reference.distance import distance_to
from solver.reference.incremental import reference_of
from solver.refusal import RefusedError
from solver.scenes import discretise
from solver.scenes.method import method_of

CYCLE = 12
TIGHT = Latin(finish=None, stop=Stop(tolerance=1e-20, iterations=800))
ROUGH = replace(TIGHT, stop=Stop(accuracy=0.01, tolerance=1e-3, iterations=400))


LOADED: dict[str, dict[str, Any]] = {
    "block": {
        "elements": 16,
        "elements_up": 8,
        "substructures": 2,
        "top_normal_load": [[0.0, 0.0], [0.25, -4e-5]],
        "top_tangential_displacement": 2e-5,
        "top_tangential_load": "sine",
    },
    "bar": {"load": "sine", "elements": 20, "substructures": 4},
    "strand": {"load": "triangle", "elements": 20, "substructures": 2},
    "incline": {},
}


def cyclic(scene: str, cycles: int = 4, **changes: Any) -> Problem:
    """Make a scene whose load repeats itself, 12 instants a cycle."""
    own = {"cycles": cycles, "instants": CYCLE * cycles + 1, "duration": float(cycles)}
    return discretise(settings_of(scene, **(LOADED[scene] | own | changes)))


@pytest.mark.parametrize(
    ("scene", "changes"),
    [
        ("block", {}),
        ("bar", {}),
        ("bar", {"friction_law": "compliant"}),
        ("bar", {"pressure_load": "shaken"}),
        ("strand", {}),
        ("incline", {}),
    ],
)
def test_slabs_have_the_solution_of_the_whole_interval(
    scene: str, changes: dict[str, Any]
) -> None:
    problem = cyclic(scene, 3, **changes)
    found = solve_in_slabs(
        problem, TIGHT, CYCLE + 2
    )  # neither a cycle, nor a part of the whole
    distance = distance_of(problem)
    assert distance.of_friction_force(found.iterate) < 1e-6
    assert distance.of_displacement(found.iterate) < 1e-6
    assert found.records[-1].iteration == found.iterate.number


def test_a_periodic_slab_takes_one_iteration() -> None:
    problem = cyclic("block", 6)
    slab = first_slab(problem, ROUGH, CYCLE)
    counts = []
    while slab is not None:
        found = solve(slab.problem, slab.latin, start=slab.start)
        counts.append(len(found.records))
        slab = next_slab(problem, slab, found.iterate, CYCLE)
    assert len(counts) == 6
    assert counts[-1] == 1
    assert max(counts) < 40
    whole = solve_in_slabs(problem, ROUGH, CYCLE)
    assert len(whole.records) <= sum(counts)  # its first slab is certified
    distance = distance_of(problem)
    assert distance.of_friction_force(whole.iterate) < 0.01


def test_the_first_slab_is_certified_and_all_are_on_one_clock() -> None:
    problem = cyclic("block", 3)
    distance = distance_of(problem)
    found = solve_in_slabs(problem, ROUGH, CYCLE, distance=distance, spent=100.0)
    *_, last = found.records
    assert last.error_force == distance.of_friction_force(found.iterate) < 1e-3
    seconds = [one.seconds for one in found.records]
    assert seconds == sorted(seconds)
    assert seconds[0] > 100.0
    limited = replace(ROUGH, stop=replace(ROUGH.stop, seconds=50.0))
    ended = solve_in_slabs(problem, limited, CYCLE, spent=100.0)
    assert ended.status.ending is Ending.EXHAUSTED
    assert len(ended.records) == 3
    assert ended.iterate.displacement.shape == (problem.n_dofs, problem.n_instants)


def test_the_command_solves_in_slabs(
    capsys: pytest.CaptureFixture[str], tmp_path: Any
) -> None:
    asked = [
        "run",
        "bar",
        "--set",
        "load=cycles",
        "--set",
        "elements=20",
        "--set",
        "instants=33",
    ]
    out = tmp_path / "result.npz"
    assert main([*asked, "--slab", "10", "--json", "--out", str(out)]) == 0
    said = json.loads(capsys.readouterr().out)
    assert said["error_force"] < 0.01
    assert np.load(out)["displacement"].shape[1] == 33
    assert main([*asked, "--slab", "0"]) == 2
    assert '--slab = "0" is refused' in capsys.readouterr().err


@pytest.mark.parametrize(
    ("scene", "changes", "method", "length", "name"),
    [
        ("bar", {"friction_law": "slip-dependent"}, TIGHT, CYCLE, "friction_law"),
        ("bar", {}, TIGHT, 0, "slab"),
    ],
)
def test_slabs_refuse_structures_with_more_memory(
    scene: str, changes: dict[str, Any], method: Latin, length: int, name: str
) -> None:
    with pytest.raises(RefusedError, match=f"^{name} = "):
        solve_in_slabs(cyclic(scene, **changes), method, length)


def test_a_slab_that_is_far_by_its_changes_does_not_end_by_a_low_indicator() -> None:
    """A tendon with the paper's k was called converged at five times its accuracy."""
    settings = settings_of(
        "belt",
        guide="duct",
        wobble=0.0099,
        young=1.4e11,
        pull=18.5,
        pull_load="ramp",
        tail_force=697.0,
        elements=169,
        substructures=17,
        instants=8,
        method="paper",
        start="nested",
        finish="at-once",
        accuracy=1.5e-4,
        max_iterations=240,
    )
    problem = discretise(settings)
    distance = distance_to(reference_of(problem), problem)
    solution = solve_in_slabs(problem, method_of(settings), 5, distance=distance)
    error = solution.records[-1].error_force
    is_converged = solution.status.ending is Ending.CONVERGED
    assert error <= settings.accuracy or not is_converged
