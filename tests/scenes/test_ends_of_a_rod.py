"""A rod with ends of its own, heat, and a support that moves (MATHEMATICS.md, 8)."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as examples
from hypothesis import strategies as st

from solver.discrete.probes import AxialForce
from solver.files.saved import settings_from_command
from solver.latin import Ending, solve
from solver.reference.distance import distance_to, kkt_residual
from solver.reference.incremental import reference_of
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of
from solver.settings.values import SettingError
from solver.study.quantities import QUANTITIES
from solver.study.scene_run import finished_run


def bar(**changes):
    return CATALOGUE["bar"].checked(changes)


def answer(settings):
    """The solution, its displacement beside the support, and the axial force."""
    problem = discretise(settings)
    fields = reference_of(problem)
    assert fields.converged.all()
    return (
        fields,
        problem.absolute(fields.displacement),
        AxialForce(problem)(fields.displacement),
    )


def test_a_long_rail_breathes_at_its_ends_and_comes_back_by_half():
    """theory: N = -ES e in the middle, u = ES e^2/(2 q) at an end; cooled, half."""
    e = 1.2e-5 * 40.0
    bound = 0.5 * 2e4
    rail = bar(
        length=400.0,
        section=7.7e-3,
        friction=0.5,
        pressure=2e4,
        left_end="free",
        right_end="free",
        temperature=40.0,
        temperature_load="triangle",
        elements=1600,
    )
    stiffness = rail.young * rail.section
    _, moved, axial = answer(rail)
    hottest = int(np.argmax(rail.path("temperature_load")))
    end = stiffness * e**2 / (2.0 * bound)
    assert axial[800, hottest] == pytest.approx(-stiffness * e, rel=1e-9)
    assert moved[-1, hottest] == pytest.approx(end, rel=1e-3)
    assert moved[0] == pytest.approx(-moved[-1], abs=1e-9 * end)
    assert moved[-1, -1] == pytest.approx(0.5 * end, rel=1e-3)


def test_force_beyond_friction_reaches_the_other_end():
    """The reaction of a clamp, and of a spring, is the pull less all friction."""
    for left in ({"left_end": "held"}, {"left_end": "spring", "left_spring": 1e5}):
        run = finished_run(bar(peak=2000.0, load="ramp", **left))
        assert QUANTITIES["left_force"](run) == pytest.approx(-500.0, rel=0.04)
        assert QUANTITIES["right_force"](run) == 2000.0


def test_a_spring_is_a_clamp_where_it_is_stiff_and_nothing_where_it_is_soft():
    held, free = (answer(bar(left_end=end, elements=20))[1] for end in ("held", "free"))
    for stiffness, limit in ((5e14, held), (1e-3, free)):
        _, moved, _ = answer(bar(left_end="spring", left_spring=stiffness, elements=20))
        np.testing.assert_allclose(moved, limit, atol=1e-7 * np.abs(limit).max())


def test_the_loop_of_a_spring_that_is_pulled_out_holds_the_energy_that_friction_takes():
    settings = bar(
        left_end="free", right_end="spring", right_displacement=5e-3, right_load="cycle"
    )
    fields, _, _ = answer(settings)
    loop = settings.structure().loop(fields.problem)
    force = loop.force(fields)
    moved = loop.displacement(fields.displacement)
    contact = fields.contact("friction")
    taken = np.diff(contact.slip, axis=1) * fields.contact_force[:, 1:]
    stored = AxialForce(fields.problem)(fields.displacement)[:, -1] ** 2
    elastic = (
        stored / (settings.young * settings.section) / settings.elements
    ).sum() / 2.0
    # Work by the trapezoidal rule: friction is what it is after each increment.
    work = (0.5 * (force[1:] + force[:-1]) * np.diff(moved)).sum()
    assert work == pytest.approx(-taken.sum() + elastic, rel=0.05)


def test_right_and_left_are_mirror_images():
    force = [[0.0, 0.0], [0.4, 900.0], [1.0, -300.0]]
    mirrored = [[time, -value] for time, value in force]
    right = answer(bar(load=force, elements=23))[1]
    left = answer(
        bar(left_end="pulled", left_load=mirrored, right_end="held", elements=23)
    )[1]
    np.testing.assert_allclose(left[::-1], -right, atol=1e-12 * np.abs(right).max())


def test_a_support_that_moves_as_one_carries_a_free_bar_along():
    _, moved, axial = answer(
        bar(
            left_end="free",
            right_end="free",
            settlement=1e-3,
            settlement_profile="uniform",
        )
    )
    np.testing.assert_allclose(
        moved, np.tile(np.linspace(0.0, 1e-3, 101), (51, 1)), atol=1e-15
    )
    assert not axial.any()


def test_a_clamp_that_moves_one_way_is_a_support_that_moves_the_other():
    """Friction feels what one does over the other."""
    clamp, _, _ = answer(bar(support_displacement=2e-3, peak=300.0))
    support, _, _ = answer(
        bar(
            settlement=-2e-3,
            settlement_profile="uniform",
            settlement_load="sine",
            peak=300.0,
        )
    )
    largest = np.abs(clamp.contact_force).max()
    np.testing.assert_allclose(
        support.contact_force, clamp.contact_force, atol=1e-9 * largest
    )


def test_a_bar_between_two_clamps_holds_all_of_its_heat():
    settings = bar(
        right_end="held",
        temperature=30.0,
        friction=0.0,
        section_profile="rising",
        elements=40,
    )
    fields, moved, axial = answer(settings)
    loop = settings.structure().loop(fields.problem)
    force = loop.force(fields)
    assert loop.across == ("Strain without force", "")
    np.testing.assert_allclose(axial[:, -1], force[-1], rtol=1e-9)
    _, mean = answer(
        bar(right_end="held", temperature=30.0, friction=0.0, elements=40)
    )[1:]
    harmonic = fields.problem.scales.force / (settings.young * settings.section)
    assert force[-1] == pytest.approx(harmonic * mean[0, -1], rel=1e-9)
    assert moved[0, -1] == moved[-1, -1] == 0.0


ENDS = st.sampled_from(["held", "spring", "pulled", "free"])


@examples(max_examples=12)
@given(left=ENDS, right=ENDS, seed=st.integers(0, 1000), parts=st.integers(1, 9))
def test_the_method_meets_the_incremental_solver_whatever_holds_the_ends(
    left, right, seed, parts
):
    generator = np.random.default_rng(seed)
    sizes = generator.uniform(-1.0, 1.0, 5)
    settings = bar(
        left_end=left,
        right_end=right,
        left_force=400.0 * sizes[0],
        peak=400.0 * sizes[1],
        support_displacement=1e-3 * sizes[2],
        right_displacement=1e-3 * sizes[3],
        left_spring=10.0 ** generator.uniform(4.0, 8.0),
        temperature=50.0 * sizes[4],
        settlement=1e-3 * sizes[0],
        settlement_load="random",
        temperature_load="sine",
        seed=seed,
        elements=24,
        instants=21,
        substructures=parts,
    )
    problem = discretise(settings)
    reference = reference_of(problem)
    assert reference.converged.all()
    distance = distance_to(reference, problem)
    solution = solve(problem, method_of(settings), distance=distance, watch=False)
    assert solution.status.ending is Ending.CONVERGED
    assert solution.records[-1].error_force < 1e-2


def test_points_that_stood_still_while_slipping_do_not_end_the_search():
    """Points that went back at once ended the incremental solver out of balance."""
    section = [[0.2, 4.0], [0.33, 3.6], [0.34, 0.216], [0.74, 0.34], [0.85, 0.17]]
    settled = [[0.205, 0.37], [0.511, 5.06], [0.578, 1.7], [0.595, 3.1]]
    pressed = [[0.178, 0.167], [0.486, 0.172], [0.66, 5.52], [0.752, 0.0]]
    fields, _, _ = answer(
        bar(
            right_end="free",
            support_displacement=0.0435,
            settlement=2.88e-4,
            settlement_profile=settled,
            friction=1.239,
            pressure=6036.0,
            pressure_profile=pressed,
            section_profile=section,
            elements=420,
            instants=17,
        )
    )
    assert kkt_residual(fields, fields.problem) < 1e-10


def test_forces_beyond_all_friction_are_refused_where_nothing_else_holds():
    with pytest.raises(
        SettingError, match=r"left_end = \"free\" .*1500 N.*hold an end"
    ):
        bar(left_end="free", peak=1500.0)
    bar(left_end="free", peak=1400.0)
    with pytest.raises(SettingError, match="left_end"):
        bar(left_end="free", right_end="free", friction=0.0, temperature=10.0)


def test_a_table_of_temperatures_is_read_with_its_unit(tmp_path):
    file = tmp_path / "day.csv"
    file.write_text("time [h],temperature [°C]\n0,0\n8,35\n16,-5\n")
    given = [f"temperature_load={file}", "duration=57600"]
    settings, messages = settings_from_command("bar", given)
    assert settings.temperature_load[1] == (28800.0, 35.0)
    assert "°C" in messages["temperature_load"]
