"""Public QP solvers and GetFEM, where they are installed, agree with the incremental solver."""

from __future__ import annotations

from dataclasses import replace

import pytest
from benchmarks import by_getfem, public_solvers
from benchmarks.public_solvers import PUBLIC, PeerError, solve_by

from solver.reference.distance import distance_to
from solver.reference.incremental import incremental
from solver.scenes import CATALOGUE, discretise
from solver.scenes.bar import BarSettings

WHAT_THEY_REACH = {"PIQP": 1e-6, "OSQP": 1e-7, "DAQP": 1e-9, "Clarabel": 1e-5}


@pytest.mark.parametrize("public", PUBLIC, ids=lambda public: public.name)
@pytest.mark.parametrize(
    "changes",
    [{}, {"pressure_profile": "gap"}, {"support_displacement": 1e-4}, {"body_force": 500.0}],
    ids=str,
)
def test_public_solvers_agree_with_the_incremental_solver(public, changes):
    if not public.installed:
        pytest.skip(f"{public.module} is not installed")
    problem = discretise(
        BarSettings.checked({"method": "paper", "elements": 20, "instants": 21, **changes})
    )
    distance = distance_to(incremental(problem), problem)
    fields = solve_by(public, problem, public.tolerances[-1])
    assert distance.of_friction_force(fields) < WHAT_THEY_REACH[public.name]
    assert distance.of_displacement(fields) < WHAT_THEY_REACH[public.name]


def test_getfem_finds_the_same_at_all_nodes_and_instants():
    python = by_getfem.interpreter()
    if python is None:
        pytest.skip("GetFEM is not installed")
    settings = CATALOGUE["block"].settings.checked({**by_getfem.SHEARED, "plane": "stress"})
    for name, difference in by_getfem.differences(settings, python).items():
        assert difference < 1e-9, name


def test_a_solver_that_takes_too_long_is_stopped(monkeypatch):
    monkeypatch.setattr(public_solvers, "TIME_LIMIT", -1.0)
    idle = replace(PUBLIC[0], prepare=lambda *given: lambda lower, upper: 0.0 * lower)
    with pytest.raises(PeerError, match="at instant 1"):
        solve_by(
            idle, discretise(BarSettings.checked({"method": "paper", "substructures": 2})), 1.0
        )
