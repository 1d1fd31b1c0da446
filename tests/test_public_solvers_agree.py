"""Public QP solvers, where they are installed, agree with the incremental solver."""

from __future__ import annotations

from dataclasses import replace

import pytest

from solver.reference.incremental import incremental
from solver.scenes import discretise
from solver.scenes.bar import BarSettings
from solver.study.other_programs import public_solvers
from solver.study.other_programs.public_solvers import PUBLIC, solve_by
from solver.study.speed.error_against_time import Peer, PeerError, error_against_time


def test_a_solver_that_takes_too_long_is_stopped(monkeypatch):
    monkeypatch.setattr(public_solvers, "TIME_LIMIT", -1.0)
    idle = replace(PUBLIC[0], prepare=lambda *given: lambda lower, upper: 0.0 * lower)
    with pytest.raises(PeerError, match="at instant 1"):
        solve_by(
            idle, discretise(BarSettings.checked({"method": "paper", "substructures": 2})), 1.0
        )


def test_other_solvers_stand_in_a_study_with_what_they_said_where_they_gave_up():
    settings = BarSettings.checked(
        {"elements": 6, "instants": 5, "substructures": 2, "max_iterations": 5}
    )

    def exact_or_nothing(problem, tolerance):
        if tolerance < 0.1:
            raise PeerError("gave up at instant 1: no more digits")
        return incremental(problem)

    study = error_against_time(settings, 1, peers=[Peer("other", (0.5, 1e-9), exact_or_nothing)])
    *_, found = study.courses
    assert (found.method, found.kind, list(found.steps)) == ("other", "peer", [0.5])
    assert found.error_force[0] < 1e-9
    assert found.seconds[0] > 0.0
    assert study.troubles == ("other at tolerance 1e-09 gave up at instant 1: no more digits.",)
