"""The strand is one more scene of the same engine: all options reach the same solution on it."""

from __future__ import annotations

import json

import numpy as np
import pytest

from solver.cli import main
from solver.definitions import SettingError
from solver.latin import Ending, iterations, solve
from solver.latin.indicators import behaviour_indicator
from solver.latin.local_stage import LocalStage
from solver.laws import Contact
from solver.loads import PRESETS, PULLS
from solver.reduction.svd import InterfaceField, decompositions, friction_spectra
from solver.scenes import discretise
from solver.scenes.base import LARGEST_FIELD
from solver.scenes.method import method_of
from solver.scenes.strand import StrandSettings, strand

SMALL = {"elements": 24, "substructures": 4, "instants": 21, "break_position": 0.375}
PLAIN = {"method": "paper"}
TIGHT = {"tolerance": 1e-16, "max_iterations": 4000}
PGD = {"linear_stage": "pgd"}
FAST = {"search_direction": "auto", "acceleration": "anderson"}


def options(**changes: object) -> StrandSettings:
    return StrandSettings.checked({**SMALL, **PLAIN, **TIGHT, **changes})


def solution_of(settings):
    found = solve(discretise(settings), method_of(settings), watch=False)
    assert found.status.ending is Ending.CONVERGED
    return found.iterate


@pytest.fixture(scope="module")
def known():
    return solution_of(options(**FAST, tolerance=1e-24))


def apart(one, other):
    return max(
        float(np.linalg.norm(getattr(one, name) - getattr(other, name)))
        / float(np.linalg.norm(getattr(other, name)))
        for name in ("displacement", "friction_force")
    )


@pytest.mark.parametrize(
    "change",
    [
        {},
        {"multiscale": False, "acceleration": "anderson"},
        {"relaxation": 0.6, "k_scale": 2.0},
        {**FAST, "start": "nested"},
        {"search_direction": "auto", "start": "nested"},
        {**PGD, "pgd_modes": 60, "pgd_tolerance": 1e-14, "tolerance": 1e-13},
        {"substructures": 1, "acceleration": "anderson"},
        {"substructures": 2, **FAST},
        {"substructures": 7, **FAST},
        {"substructures": 24, **FAST},
    ],
    ids=str,
)
def test_every_method_and_any_number_of_substructures_reach_the_same_solution(known, change):
    assert apart(solution_of(options(**change)), known) < 2e-5


def test_the_k_free_indicator_agrees_that_it_is_the_solution(known):
    assert behaviour_indicator(known) < 1e-8


def test_the_k_free_indicator_sees_forces_that_do_not_cancel_between_two_wires(known):
    changed = known.outgoing.copy()
    rows = known.problem.rubbing["contact 2-3"].tangent.below
    changed[rows] += 1e-3 * np.abs(known.outgoing).max()
    broken = type(known)(**{**vars_of(known), "outgoing": changed})
    assert behaviour_indicator(broken) > 1e-4


def vars_of(iterate):
    return {name: getattr(iterate, name) for name in type(iterate).__dataclass_fields__}


@pytest.mark.parametrize("change", [{}, {"pgd_sharing": 0.3}, {"wires": 6}])
def test_separated_bases_come_close(change):
    settings = options(linear_stage="pgd", max_iterations=60, **change)
    found = solve(discretise(settings), method_of(settings), watch=False).iterate
    exact = solution_of(settings.replace(linear_stage="full", max_iterations=4000, **FAST))
    gap = np.linalg.norm(found.displacement - exact.displacement)
    assert gap < 0.03 * np.linalg.norm(exact.displacement)


def test_wires_with_the_same_pieces_share_their_operators():
    problem = discretise(options(wires=40, broken=20, substructures=8, break_position=0.5))
    shapes = {id(part.elasticity) for part in problem.substructures}
    # Edge and inner wires: held, inside. The broken wire: next to the break, on either side.
    assert len(shapes) == 2 * 2 + 2
    assert len(problem.substructures) == 40 * 8


def test_rows_of_a_contact_lie_opposite_each_other_and_cover_it_once():
    settings = options(wires=4)
    scene, problem = strand(settings), discretise(settings)
    positions = problem.positions[problem.row_dofs]
    for law in problem.rubbing.values():
        assert isinstance(law, Contact)
        np.testing.assert_array_equal(positions[law.tangent.above], positions[law.tangent.below])
        np.testing.assert_array_equal(positions[law.tangent.above], law.positions[law.points])
        half = 0.5 * scene.length / scene.elements  # of the held end
        assert law.weights.sum() == pytest.approx(scene.length - half)
    owned = np.concatenate([part.rows for part in problem.substructures])
    np.testing.assert_array_equal(np.sort(owned), np.arange(problem.n_rows))
    assert len(problem.rubbing["contact 1-2"].positions) == scene.elements + 1
    assert len(problem.rubbing["contact 3-4"].positions) == scene.elements


def test_laws_of_all_contacts_are_one_law_at_work():
    problem = discretise(options(wires=5))
    stage = LocalStage(problem, problem.direction)
    incoming = np.asfortranarray(
        np.random.default_rng(2).normal(size=(problem.n_rows, problem.n_instants)) * 1e-3
    )
    stage(incoming)
    force = problem.direction[:, None] * (stage.displacement - incoming)
    for law in problem.rubbing.values():
        np.testing.assert_allclose(force[law.tangent.above], -force[law.tangent.below], atol=1e-12)
        assert np.all(np.abs(force[law.tangent.above]) <= law.tangential.bound * (1.0 + 1e-9))


def test_singular_values_are_those_of_the_friction_on_every_piece(known):
    spectra = friction_spectra(known)
    found = decompositions(known, InterfaceField.FRICTION_FORCE)
    assert len(found) == len(known.problem.substructures)
    for values, one in zip(spectra, found, strict=True):
        np.testing.assert_allclose(values, one.values, atol=1e-9)
    assert max(values[0] for values in spectra) > 0.0


@pytest.mark.parametrize("wires", [2, 9])
def test_a_coarser_strand_is_the_same_strand(wires):
    settings = options(wires=wires, elements=48)
    coarser = settings.coarser()
    assert (coarser.elements, coarser.wires, coarser.broken) == (24, wires, 2)
    starts = [
        next(iterations(discretise(some), method_of(some)))
        for some in (settings.replace(start="nested"), settings)
    ]
    exact = solution_of(settings.replace(**FAST, tolerance=1e-14))
    assert apart(starts[0], exact) < 0.45 * apart(starts[1], exact)


@pytest.mark.parametrize(
    ("change", "name", "words"),
    [
        ({"wires": 3, "broken": 4}, "broken", "0 to wires (3)"),
        ({"elements": 5, "substructures": 6}, "substructures", "1 to elements (5)"),
        ({"load": [[0.0, 0.0], [1.0, -5.0]]}, "load", "wires cannot be pushed"),
        ({"peak": 2000.0}, "peak", "tensions below 1500 N"),
        ({"peak": 800.0, "broken": 1}, "peak", "tensions below 750 N"),
        ({"friction": 0.0}, "peak", "raise friction or pressure"),
        ({"load": [[0.0, 1500.0]]}, "load", "move the break to the left"),
        ({"wires": 200, "elements": 2000, "instants": 101}, "instants", "fewer instants"),
    ],
    ids=str,
)
def test_what_makes_no_strand_is_refused_in_words(change, name, words):
    with pytest.raises(SettingError, match=f"^{name} = ") as refused:
        StrandSettings.checked(change)
    assert words in str(refused.value)


def test_a_grip_of_given_displacement_needs_no_friction():
    assert StrandSettings.checked({"friction": 0.0, "grip": "displacement"}).friction == 0.0
    assert StrandSettings.checked({"friction": 0.0, "broken": 0}).broken == 0
    assert StrandSettings.checked({"friction": 0.0, "peak": 0.0}).peak == 0.0


def test_changes_bring_along_what_could_not_stand_beside_them():
    settings = StrandSettings.checked({"broken": 3})
    assert settings.with_change("wires", 2).broken == 2
    assert settings.with_change("elements", 4).substructures == 4
    assert settings.with_change("peak", 100.0).peak == 100.0


def test_tension_presets_have_the_names_of_the_others_and_never_push():
    assert set(PULLS) == set(PRESETS)
    phase = np.linspace(0.0, 1.0, 961)
    for path in PULLS.values():
        values = path(phase, 3)
        assert values.min() >= 0.0
        assert values.max() == pytest.approx(1.0, abs=1e-3)


def test_the_largest_strand_is_refused_by_size_and_not_by_memory():
    assert LARGEST_FIELD > 200 * 61 * 101
    assert StrandSettings.checked({"wires": 200}).wires == 200


@pytest.mark.parametrize(
    "change",
    [
        {"elements": 2, "substructures": 1},
        {"elements": 2, "substructures": 2, "grip": "displacement", "broken": 0},
        {"elements": 3, "substructures": 3, "break_position": 0.0},
        {"elements": 9, "substructures": 9, "break_position": 1.0, "grip": "displacement"},
        {"elements": 9, "substructures": 1, "broken": 0, "wires": 2},
        {"instants": 1},
        {"peak": 0.0},
        {"pressure": 0.0, "grip": "displacement"},
        {"pressure": 1e7},
    ],
    ids=str,
)
@pytest.mark.parametrize(
    "method", [{}, PLAIN, {**PLAIN, **FAST, "start": "nested"}, {"linear_stage": "pgd"}], ids=str
)
def test_the_smallest_and_oddest_strands_end_well(change, method):
    settings = StrandSettings.checked({**SMALL, "wires": 3, **method, **change})
    found = solve(discretise(settings), method_of(settings), watch=False)
    allowed = {Ending.CONVERGED, Ending.STALLED, Ending.EXHAUSTED}
    assert found.status.ending in (allowed if "linear_stage" in method else {Ending.CONVERGED})
    assert np.isfinite(found.iterate.displacement).all()
    assert np.isfinite(found.iterate.friction_force).all()


def test_the_command_line_runs_it_and_writes_each_contact(tmp_path, capsys):
    file = tmp_path / "strand.npz"
    changes = [f"--set={name}={value}" for name, value in {**SMALL, "wires": 4}.items()]
    assert main(["run", "strand", *changes, "--out", str(file), "--json"]) == 0
    printed = json.loads(capsys.readouterr().out)
    assert 0.0 < printed["error_force"] < 0.1
    with np.load(file, allow_pickle=False) as found:
        arrays = dict(found)
    points = {"contact 1-2": 25, "contact 2-3": 25, "contact 3-4": 24}
    assert arrays["x"].shape == (4 * 25 + 1,)
    assert arrays["displacement"].shape == (4 * 25 + 1, 21)
    assert arrays["friction_force"].shape == arrays["status"].shape == (sum(points.values()), 21)
    stacked = []
    for name, size in points.items():
        own = {key: arrays[f"interface/{name}/{key}"] for key in ("slip", "status")}
        assert own["slip"].shape == own["status"].shape == (size, 21)
        assert arrays[f"interface/{name}/points"].shape == (size,)
        assert f"interface/{name}/normal_force" not in arrays
        stacked.append(arrays[f"interface/{name}/tangential_force"])
    np.testing.assert_array_equal(np.concatenate(stacked), arrays["friction_force"])
    values = json.loads(str(arrays["settings"]))
    assert values.pop("scene") == "strand"
    assert (
        StrandSettings.checked(values).values()
        == StrandSettings.checked({**SMALL, "wires": 4}).values()
    )
