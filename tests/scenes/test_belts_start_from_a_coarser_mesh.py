"""Belts and lines of beams start from the solution on a coarser mesh."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from shaped_bodies import belt, leaf

from solver.discrete import discretise
from solver.discrete.problem import Problem
from solver.latin import Checkpoint, Ending, Latin, Nested, Paper, iterations, solve
from solver.latin.direction.directions import automatic
from solver.latin.start import prolong, wrong_waves
from solver.reference.distance import distance_to
from solver.reference.incremental import reference_of
from solver.refusal import RefusedError
from solver.scenes import CATALOGUE
from solver.scenes import discretise as problem_of
from solver.scenes.method import method_of

TENDON = {
    "guide": "duct",
    "driven": "jacked",
    "pull_load": "jack",
    "pull": 2e6,
    "wrap": 18.0,
    "young": 195e9,
    "section": 1.8e-3,
}
DRIVEN = [
    {},
    {"tail": "held"},
    {"driven": "moved", "displacement": 0.005},
    {"driven": "jacked"},
    TENDON | {"tail": "held"},
    TENDON | {"tail": "alike"},
]
"""All ways of driving; bands that slide far beyond their elongation among them."""


def settings_of(**changes):
    return CATALOGUE["belt"].checked({"instants": 13} | changes)


def iterations_to(problem: Problem, latin: Latin, error: float, most: int) -> int:
    """Iterations until the contact force is as near to the reference as an error."""
    distance = distance_to(reference_of(problem), problem)
    for iterate in iterations(problem, latin):
        if distance.of_friction_force(iterate) <= error:
            return iterate.number
        assert iterate.number < most
    raise AssertionError


@pytest.mark.parametrize("changes", DRIVEN, ids=str)
def test_from_zero_and_from_a_coarser_mesh_a_belt_ends_in_one_answer(changes):
    strict = {"finish": "none", "accuracy": 1e-6, "tolerance": 1e-9, "elements": 30}
    found = []
    for start in ("zero", "nested"):
        settings = settings_of(start=start, **strict | changes)
        solution = solve(problem_of(settings), method_of(settings), watch=False)
        assert solution.status.ending is Ending.CONVERGED
        found.append(solution.iterate)
    zero, nested = found
    for name in ("displacement", "contact_force"):
        wanted = getattr(zero, name)
        size = np.abs(wanted).max()
        assert getattr(nested, name) == pytest.approx(wanted, abs=1e-4 * size)


@pytest.mark.parametrize(
    "changes",
    [{"elements": 300}, {"elements": 120, "driven": "moved", "displacement": 0.005}],
    ids=str,
)
def test_from_a_coarser_mesh_a_fine_belt_needs_few_iterations(changes):
    settings = settings_of(start="nested", finish="none", **changes)
    assert iterations_to(problem_of(settings), method_of(settings), 0.01, 15) <= 15


@pytest.mark.parametrize("changes", DRIVEN, ids=str)
def test_a_belt_solution_prolonged_to_its_own_mesh_is_a_fixed_point(changes):
    problem = problem_of(settings_of(elements=20, substructures=3, **changes))
    uncut = problem_of(settings_of(elements=20, substructures=1, **changes))
    k = problem.direction
    start = Checkpoint(0, 0.0, prolong(reference_of(uncut), problem, k))
    method = Latin(direction=Paper(1.0), acceleration=None)
    first = next(iterations(problem, method, start))
    known = reference_of(problem)
    for name in ("displacement", "contact_force"):
        wanted = getattr(known, name)
        size = np.abs(wanted).max()
        assert getattr(first, name) == pytest.approx(wanted, abs=1e-7 * size)


def test_fields_of_a_coarse_line_are_prolonged_exactly():
    """Without friction a leaf that is pressed evenly is stretched evenly."""
    fine = discretise(leaf(24, friction=0.0, cuts=3))
    coarse = discretise(leaf(8, friction=0.0))
    k = fine.direction
    carried = prolong(reference_of(coarse), fine, k)
    wanted = prolong(reference_of(fine), fine, k)
    assert carried == pytest.approx(wanted, abs=1e-9 * np.abs(wanted).max())


def test_a_band_that_slides_far_stays_on_its_guide_on_the_finer_mesh():
    settings = settings_of(driven="moved", displacement=0.05, elements=60)
    fine = problem_of(settings)
    solution = reference_of(next(settings.coarser()))
    k = np.full(fine.n_rows, 1e300)
    carried = prolong(solution, fine, k) * fine.scales.displacement
    law = fine.contacts["guide"]
    along = carried[law.tangent.above]
    across = carried[law.normal.component.above]
    assert np.abs(along).max() == pytest.approx(0.05, rel=0.05)
    assert np.abs(across).max() <= 1e-12


@pytest.mark.parametrize("wrap", [130.0, 180.0, 500.0])
def test_the_ends_of_a_contact_start_where_the_coarser_mesh_has_them(wrap):
    """Both meshes have points there, but boxes of different sizes."""
    settings = settings_of(wrap=wrap, elements=50, driven="moved")
    fine = problem_of(settings)
    solution = reference_of(next(settings.coarser()))
    k = fine.direction
    carried = prolong(solution, fine, k)
    moved = prolong(solution, fine, np.full(fine.n_rows, 1e300))
    law = fine.contacts["guide"]
    coarse = solution.problem.contacts["guide"]
    known = solution.contact("guide")
    rows = law.tangent.above[[0, -1]]
    slip = moved[rows] * fine.scales.displacement
    size = np.abs(known.slip).max()
    assert slip == pytest.approx(known.slip[[0, -1]], rel=1e-9, abs=1e-12 * size)
    stretched = k[rows, None] * (carried[rows] - moved[rows])
    force = stretched * fine.scales.force / law.weights[[0, -1], None]
    wanted = known.tangential_force[[0, -1]] / coarse.weights[[0, -1], None]
    assert force == pytest.approx(wanted, rel=1e-6, abs=1e-8 * np.abs(wanted).max())


def test_the_start_comes_to_the_truth_as_meshes_are_refined():
    errors = []
    for elements in (20, 40, 80, 160):
        settings = settings_of(elements=elements)
        fine = problem_of(settings)
        k = np.full(fine.n_rows, 1e300)
        carried = prolong(reference_of(next(settings.coarser())), fine, k)
        known = reference_of(fine).displacement / fine.scales.displacement
        along = fine.contacts["guide"].tangent.above
        difference = carried[along] - known[fine.row_dofs[along]]
        errors.append(np.linalg.norm(difference) / np.linalg.norm(known))
    slope = np.polyfit(np.log([20, 40, 80, 160]), np.log(errors), 1)[0]
    # Friction jumps at its fronts, so displacement has a bend there.
    assert slope < -1.0
    assert errors[-1] < 1e-3


def test_on_a_coarser_mesh_a_belt_has_the_same_spans_and_the_same_ends():
    settings = settings_of(elements=40, driven="moved")
    coarse = next(settings.coarser())
    known = settings.structure()
    half = settings.on_mesh_of(settings.replace(elements=20, substructures=1))
    assert half.bodies[0].nodes[[0, -1]] == pytest.approx(
        known.bodies[0].nodes[[0, -1]], abs=1e-15
    )
    assert coarse.n_dofs == 2 * 21 + 2
    own = settings.replace(elements=20).structure()
    assert own.guide.span == pytest.approx(2.0 * known.guide.span)


def test_any_lines_of_beams_start_from_coarser_ones():
    fine = discretise(leaf(100, friction=0.3, cuts=4))
    start = Nested(lambda: [discretise(leaf(50, friction=0.3))])
    cold = iterations_to(fine, Latin(finish=None), 0.01, 200)
    nested = iterations_to(fine, Latin(finish=None, start=start), 0.01, 200)
    assert 3 * nested < cold


def test_short_waves_raise_k_on_a_support_alone():
    problem = discretise(leaf(40, friction=0.3, count=2))
    plain = automatic(problem)
    short = automatic(problem, waves=0.1)
    ground = problem.contacts["ground"].rows
    between = problem.contacts["joint 1"].rows
    assert short[ground] == pytest.approx(10.0 * plain[ground])
    assert np.array_equal(short[between], plain[between])
    assert np.array_equal(automatic(problem, waves=2.0), plain)


def test_wrong_waves_are_shorter_than_the_coarser_mesh_resolves():
    lengths = []
    for nodes in (21, 41):
        solution = reference_of(discretise(belt(np.pi, 0.3, 1.5, nodes=nodes)))
        lengths.append(wrong_waves(solution))
    assert lengths[0] == pytest.approx(2.0 * 0.1 * np.pi / 20, rel=0.01)
    assert lengths[1] == pytest.approx(0.5 * lengths[0], rel=0.01)


def test_where_no_start_is_found_a_belt_starts_where_it_has_slid_to():
    settings = settings_of(driven="moved", displacement=0.005, finish="none")
    problem = problem_of(settings)
    method = method_of(settings)
    slid = next(iterations(problem, method))
    without = replace(method, start=Nested(lambda: []))
    assert np.array_equal(next(iterations(problem, without)).outgoing, slid.outgoing)


def test_lines_are_no_start_of_another_number_of_lines():
    two = discretise(leaf(8, friction=0.3, count=2))
    one = discretise(leaf(8, friction=0.3))
    with pytest.raises(RefusedError, match="other interfaces"):
        prolong(reference_of(one), two, two.direction)


def test_a_line_of_beams_is_no_start_of_a_rod():
    rod = problem_of(CATALOGUE["bar"].checked({"elements": 8, "substructures": 1}))
    line = discretise(leaf(8, friction=0.3))
    with pytest.raises(RefusedError, match="other elements"):
        prolong(reference_of(line), rod, rod.direction)


def test_belts_start_from_zero_unless_a_nested_start_is_chosen():
    assert settings_of().start == "zero"
    assert settings_of(method="paper").start == "zero"
    assert settings_of(start="nested").applies("start")


def test_a_search_that_hardly_moves_from_a_start_that_is_near_claims_nothing() -> None:
    settings = settings_of(
        method="paper",
        start="nested",
        substructures=1,
        instants=2,
        wrap=60.2,
        pull=0.0386,
        tail_force=0.405,
        elements=222,
        max_iterations=40,
    )
    problem = problem_of(settings)
    solution = solve(problem, method_of(settings), watch=False)
    distance = distance_to(reference_of(problem), problem)
    assert distance.of_friction_force(solution.iterate) > 0.01
    assert solution.status.ending is not Ending.CONVERGED
