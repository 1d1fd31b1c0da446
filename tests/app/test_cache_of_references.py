"""References are used again only where the problem asks for just them."""

from __future__ import annotations

import gc
import math
import sys
import weakref
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from small_scenes import SMALL

from app.messages import Needs, Start
from app.worker.references import ReferenceCache
from app.worker.runner import Runner
from solver.discrete import Problem
from solver.reference.incremental import Reference, reference_of
from solver.reference.solution import fingerprint
from solver.scenes import CATALOGUE, discretise
from solver.settings.scene import Settings

OF_THE_METHOD = {
    "k_scale": 3.0,
    "multiscale": False,
    "tolerance": 1e-3,
    "linear_stage": "pgd",
}
OF_THE_PHYSICS: dict[str, dict[str, Any]] = {
    "bar": {
        "peak": 901.0,
        "friction_profile": "rising",
        "young": 2e11,
        "duration": 2.0,
    },
    "strand": {
        "pressure": 5001.0,
        "break_position": 0.25,
        "grip": "displacement",
        "broken": 1,
    },
    "block": {"gap": "flat", "poisson": 0.31, "left": "roller", "substructures": 2},
    "layers": {"contrast": 2.0, "pull": 1e6, "substructures": 2, "friction": 0.31},
    "fault": {"overpressure": 7e6, "injection_load": "stopped", "diffusivity": 0.2},
    "incline": {"slope": 41.0, "weight": 1001.0, "slack": 1e-4, "spring": 1e6},
    "wall": {
        "courses": 2,
        "bond": "stack",
        "displacement": 4e-5,
        "slope": 5.0,
        "top": "pulled",
    },
    "mesh": {"mesh": "dovetail", "displacement": 1e-5, "young": 1e11, "pressure": 1e7},
    "rope": {"construction": "seven-wire", "curvature": 0.11, "tension_load": "shaken"},
    "bundle": {"press": 5e4, "band": 1.5, "unit_weight": 1e4, "displacement": 1e-6},
    "arch": {"live": 100.0, "fill": 1e4, "abutment": "down", "span": 120.0},
    "belt": {"wrap": 200.0, "drum_radius": 0.2, "pull": 1300.0, "tail": "held"},
}


def made(scene: str, **changes: Any) -> tuple[Settings, Problem]:
    settings = CATALOGUE[scene].checked(SMALL[scene] | changes)
    return settings, discretise(settings)


def never() -> bool:
    return False


@pytest.mark.parametrize("scene", list(CATALOGUE))
def test_what_the_solution_depends_on_changes_the_fingerprint_and_the_method_does_not(
    scene: str,
) -> None:
    own = fingerprint(made(scene)[1])
    assert fingerprint(made(scene, **OF_THE_METHOD)[1]) == own
    for name, value in OF_THE_PHYSICS[scene].items():
        assert fingerprint(made(scene, **{name: value})[1]) != own, name


@pytest.mark.parametrize("scene", list(CATALOGUE))
def test_reference_found_after_the_cuts_have_changed_is_that_of_the_problem(
    scene: str,
) -> None:
    references = ReferenceCache()
    references.of(*made(scene), never)
    settings, problem = made(scene, substructures=2)
    kept = references.of(settings, problem, never)
    fresh = reference_of(problem)
    assert kept is not None
    assert kept.problem is problem
    assert kept.displacement.shape == fresh.displacement.shape
    assert (
        np.abs(kept.displacement - fresh.displacement).max()
        < 1e-9 * np.abs(fresh.displacement).max()
    )
    name = next(iter(problem.contacts))
    assert kept.contact(name).tangential_force == pytest.approx(
        fresh.contact(name).tangential_force,
        abs=1e-6 * np.abs(fresh.contact_force).max(),
    )


def test_a_reference_is_computed_once(monkeypatch: pytest.MonkeyPatch) -> None:
    found: list[Reference] = []

    def count(*arguments: Any) -> Reference:
        found.append(reference_of(*arguments))
        return found[-1]

    monkeypatch.setattr(sys.modules[ReferenceCache.__module__], "reference_of", count)
    references = ReferenceCache()
    for changes in ({}, {"k_scale": 2.0}, {"friction": 0.2}, {"acceleration": "none"}):
        references.of(*made("block", **changes), never)
    assert len(found) == 2


def test_both_run_times_begin_with_the_making_of_the_problem(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    settings = made("block")[0]
    runner = Runner(Start(1, settings, math.inf), ReferenceCache(), lambda: False)
    alone = 1.0

    def timed(problem: Problem, *arguments: Any) -> Reference:
        return replace(reference_of(problem, *arguments), seconds=alone)

    monkeypatch.setattr(sys.modules[ReferenceCache.__module__], "reference_of", timed)
    while runner.rest() is not None:
        runner.advance()
    run = runner.frame(Needs()).run
    assert run.is_compared
    # The time of LATIN has it, too.
    assert run.reference_seconds > alone


def test_what_is_kept_keeps_no_problem_alive() -> None:
    references = ReferenceCache()
    settings, problem = made("block")
    references.of(settings, problem, never)
    watched = weakref.ref(problem)
    del problem
    gc.collect()
    assert watched() is None
    assert references.of(*made("block", k_scale=2.0), never) is not None
