"""What is called converged has its contact force within the accuracy, or is told not to."""

from __future__ import annotations

import pytest

from solver.files import settings_from_command
from solver.latin import Ending, solve
from solver.reference.choice import reference_of
from solver.reference.distance import distance_to
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of
from solver.study.stability.case import Verdict
from solver.study.stability.outcome import AT_ROUNDING, run
from solver.study.stability.residual import kkt_residual
from solver.study.stability.verdict import judge

BLOCK = (
    "block gap=flat plane=stress poisson=0.499 length=0.01 height=0.321 elements=59 elements_up=5 "
    "substructures=5 substructures_up=3 instants=3 friction=2.273 top=traction "
    "top_normal_load=[[0,0],[0.5,-119201409.28],[1,-119201409.28]] "
    "top_tangential_load=[[0,0],[0.5,937242.781],[1,0]]"
)
FINE = [
    "bar elements=400",
    "bar elements=800",
    "bar elements=800 substructures=5 max_iterations=3000",
]
"""Bars that the paper's method leaves unsolved after a thousand iterations, some seconds each."""
HARD = [
    *FINE,
    "bar elements=200",
    "bar elements=100 substructures=5 peak=6000",
    "bar instants=7 friction=0.317 k_scale=0.437 k_update=status elements=128 load=random "
    "peak=6444.1 substructures=5 start=nested section_profile=rising",
    "bar instants=48 friction=0.133 k_scale=0.904 elements=6 load=hold peak=9862.8 "
    "substructures=5 support_displacement=5.7068957715271356e-05",
    "bar tolerance=1",
    BLOCK,
    "layers poisson=0.4999",
]
"""Commands that once were called converged with contact forces 0.2 to 11 per cent wrong."""


def from_words(command, **changes):
    scene, *assignments = command.split()
    return settings_from_command(scene, assignments)[0].replace(**changes)


def outcome_of(settings):
    return run(settings.scene, settings.changed())


@pytest.mark.parametrize("command", [one for one in HARD if one not in FINE])
def test_the_papers_method_ends_right_or_told_on_a_hard_command(command):
    settings = from_words(command)
    # Its own tolerance, 1e-10, would hide what the accuracy says, and take long.
    settings = settings.replace(method="paper", tolerance=settings.tolerance, max_iterations=1000)
    outcome = outcome_of(settings)
    assert outcome.finite
    assert judge(outcome, settings.accuracy) is not Verdict.WRONG, outcome


@pytest.mark.parametrize("command", HARD)
def test_the_fast_method_finds_the_solution_of_a_hard_command(command):
    outcome = outcome_of(from_words(command))
    assert outcome.ending == Ending.CONVERGED
    assert outcome.certified
    assert outcome.error_force < 1e-9


@pytest.mark.parametrize("elements", [59, 60])
def test_a_block_whose_solution_nobody_else_finds_is_called_converged_only_if_certified(elements):
    outcome = outcome_of(
        from_words(BLOCK.replace("height=0.321", "height=0.32"), elements=elements)
    )
    if outcome.doubt:
        # Friction is large: an iterate's statuses may lead where those of an instant before do not.
        assert outcome.ending != Ending.CONVERGED or outcome.certified
        assert not outcome.certified or outcome.residual <= AT_ROUNDING
    else:
        assert outcome.error_force <= 0.01


@pytest.mark.parametrize(
    "command",
    [
        # Ten systems an instant from any statuses, as the whole bar slides to and fro.
        "bar substructures=11 peak=6708 instants=44 support_displacement=0.000112 "
        "body_force=3836 elements=105",
        # Statuses that never settle: acceleration is off, and k changes on the way.
        "bar substructures=36 acceleration=none k_update=status peak=-19551 instants=28 "
        "support_displacement=-0.00656 body_force=-36209 friction=1.3126 friction_profile=gap "
        "elements=307",
        "strand substructures=1 search_direction=paper relaxation=0.68 peak=1191 instants=81 "
        "wires=10 elements=18 young=1403287099",
        # An instant alone: the condensation is dear beside an iteration.
        "strand substructures=40 multiscale=false k_scale=3.83 load=hold peak=933 instants=1 "
        "wires=9 elements=91",
    ],
)
def test_a_step_that_needs_more_systems_gets_them_in_time(command):
    outcome = outcome_of(from_words(command))
    assert outcome.certified, outcome
    assert outcome.error_force < 1e-9


def test_a_few_small_changes_after_a_nested_start_are_no_convergence():
    settings = from_words(
        "strand substructures=10 search_direction=paper "
        "tolerance=0.06794181529902267 "
        "instants=4 wires=8 break_position=0.18720674155082684 elements=332 max_iterations=12 "
        "load=[[0,5.829812280248028],[0.333333333333333,17.112683269926748],"
        "[0.666666666666667,40.55250457554996],[1,42.465815872553954]]"
    )
    assert judge(outcome_of(settings), settings.accuracy) is not Verdict.WRONG


def test_a_slender_stack_is_certified_up_to_the_rounding_of_its_own_forces():
    settings = from_words(
        "layers substructures=40 instants=9 plane=stress elements=93 pressure=6338757 "
        "pull=-115201152 deflection=0.91 bend_load=cycle layers=3 thickness=0.00044665 "
        "accuracy=1e-6"
    )
    outcome = outcome_of(settings)
    assert outcome.certified, outcome
    assert judge(outcome, settings.accuracy) is Verdict.RIGHT


def test_a_contact_force_that_all_but_stands_still_far_from_the_solution_is_not_believed():
    settings = from_words(
        "strand substructures=3 peak=1464.7 instants=9 wires=4 broken=3 elements=320"
    )
    problem = discretise(settings)
    certified = solve(problem, method_of(settings), watch=False)
    assert certified.is_certified
    # An incremental solver would take as long as all the runs of this file.
    assert kkt_residual(certified.iterate, problem) <= AT_ROUNDING
    alone = solve(problem, method_of(settings.replace(finish="none")), watch=False)
    error = distance_to(certified.iterate, problem).of_friction_force(alone.iterate)
    assert error <= settings.accuracy or alone.status.ending is not Ending.CONVERGED


@pytest.mark.parametrize("method", ["fast", "paper"])
def test_contacts_that_never_close_carry_a_force_that_is_known(method):
    settings = CATALOGUE["block"].settings.checked(
        {
            "method": method,
            "elements": 13,
            "elements_up": 2,
            "substructures": 1,
            "substructures_up": 1,
            "instants": 3,
            "gap": [[0.0, 1.0]],
        }
    )
    problem = discretise(settings)
    reference = reference_of(problem)
    assert not reference.contact_force.any()
    solution = solve(problem, method_of(settings), distance=distance_to(reference, problem))
    assert solution.status.ending is Ending.CONVERGED
    assert solution.records[-1].error_force < 1e-7


def test_a_body_that_lifts_off_a_clamped_side_is_known_to_by_the_papers_method():
    settings = from_words(
        "block method=paper substructures=5 multiscale=false instants=76 elements=7 "
        "elements_up=8 substructures_up=4 top_normal_displacement=-1.4529e-7 "
        "top_tangential_displacement=-2.671e-8 radius=104641 height=0.099 body_force_y=419012679"
    )
    outcome = outcome_of(settings)
    assert outcome.ending == Ending.CONVERGED, outcome
    assert outcome.error_force < 1e-4


def test_a_step_that_costs_next_to_nothing_need_not_wait_until_the_force_is_near():
    settings = from_words(
        "layers substructures=1 multiscale=false k_friction_scale=0.37 instants=6 elements=12 "
        "elements_up=4 pressure=404851 deflection=8.3e-4 bend_load=cycle layers=6 "
        "thickness=0.002665"
    )
    outcome = outcome_of(settings)
    assert outcome.certified, outcome
    assert outcome.iterations < 150


def test_a_run_whose_k_was_changed_is_not_called_stalled_while_its_indicator_falls():
    settings = from_words(
        "bar method=paper k_update=status relaxation=0.51 k_scale=0.53 substructures=4 peak=-3085 "
        "body_force=-11584 friction=1.234 elements=428 instants=17 max_iterations=400"
    )
    outcome = outcome_of(settings)
    assert outcome.ending == Ending.EXHAUSTED, outcome
