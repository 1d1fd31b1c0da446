"""Slender bodies converge as soon as others, and layers bend like beams."""

from __future__ import annotations

import functools
from itertools import islice

import numpy as np
import pytest
from plane import lengths, reaction, solved, whole_force_error
from runs import assert_goes_on, errors, settings_of

from solver.latin import iterations, solve
from solver.latin.direction.directions import LOOK
from solver.reference.closed_forms.elastic_bodies import cantilever
from solver.reference.incremental import reference_of
from solver.scenes import discretise
from solver.scenes.method import method_of


def problem_of(scene, **values):
    settings = settings_of(scene, **{"instants": 13, **values})
    return settings, discretise(settings)


def layers_of(ratio, **values):
    """Slender layers, pressed so that they slide a part of the time."""
    own = {
        "thickness": 0.5 / ratio,
        "pressure": 2e6 * (50 / ratio) ** 2,
        "instants": 33,
    }
    return problem_of("layers", **(own | values))


def error_after(most, settings, problem):
    """Largest error of the contact force in the last three of some iterations."""
    reference = reference_of(problem)
    found = islice(iterations(problem, method_of(settings)), most - 3, most)
    return max(whole_force_error(reference, one) for one in found)


@pytest.mark.parametrize("ratio", [50, 1000])
@pytest.mark.parametrize(
    "cuts",
    [{}, {"substructures": 1}, {"substructures_up": 2}],
    ids=["four", "uncut", "two up"],
)
def test_layers_of_any_slenderness_come_within_one_percent_in_fifty_iterations(
    ratio, cuts
):
    assert error_after(50, *layers_of(ratio, **cuts)) <= 0.01


@pytest.mark.parametrize("gap", ["flat", "parabola"])
def test_a_block_a_thousand_times_as_long_as_high_takes_twenty_iterations(gap):
    thin = {"height": 1e-4, "elements": 32, "elements_up": 2}
    assert error_after(20, *problem_of("block", gap=gap, **thin)) <= 0.01


def test_a_column_cut_into_parts_twenty_times_as_high_as_wide_takes_twenty_iterations():
    tall = {"height": 1.0, "elements": 16, "elements_up": 64, "substructures_up": 2}
    assert error_after(20, *problem_of("block", gap="flat", **tall)) <= 0.01


@pytest.mark.parametrize("elements_up", [1, 2, 8, 24])
def test_a_column_of_slender_elements_that_slips_everywhere_is_certified(elements_up):
    """A fault of 40 m below 1600 m:
    24 elements up are 80 times as high as wide, one 1920 times.
    """
    uncut = {"substructures": 1, "substructures_up": 1, "elements_up": elements_up}
    column = {
        "length": 40.0,
        "height": 1600.0,
        "shear_stress": 5.5e6,
        "diffusivity": 0.003,
    }
    settings, problem = problem_of("fault", **column, **uncut)
    found = reference_of(problem)
    slips = found.status != 0
    assert found.converged.all()
    assert slips[:, 1:].mean() > 0.9
    contact = problem.contacts["support"]
    bound = settings.largest_friction(contact.positions) * contact.weights[:, None]
    friction = found.contact("support").tangential_force
    np.testing.assert_allclose(np.abs(friction)[slips], bound[slips], rtol=1e-9)
    assert solve(problem, method_of(settings), watch=False).is_certified


THIN = {
    "length": 2.0,
    "thickness": 0.01,
    "elements": 24,
    "instants": 13,
    "finish": "none",
}


@pytest.mark.parametrize("ratio", [200, 1000])
@pytest.mark.parametrize("layers", [4, 10])
def test_thin_layers_that_stick_come_within_one_percent_in_thirty_iterations(
    ratio, layers
):
    thin = settings_of("layers", **{**THIN, "length": 0.01 * ratio, "layers": layers})
    assert max(errors(thin, 33)[-4:]) <= 0.01


@pytest.mark.parametrize("place", [LOOK - 2, LOOK - 1, LOOK, LOOK + 4])
def test_a_run_of_layers_resumes_from_any_checkpoint_to_the_bit(place):
    assert_goes_on(settings_of("layers", **THIN, acceleration="none"), LOOK + 8, place)


def test_layers_that_stick_are_soon_solved_by_a_status_step():
    settings = settings_of("layers", **{**THIN, "instants": 81, "finish": "at-once"})
    solution = solve(discretise(settings), method_of(settings), watch=False)
    assert solution.is_certified
    assert solution.iterate.number <= 12


YOUNG = 210e9
POISSON = 0.3
LENGTH = 0.5
THICKNESS = 0.01
DEFLECTION = 1e-4


alone = functools.partial(cantilever, LENGTH, young=YOUNG, poisson=POISSON)


@functools.cache
def bent(layers, friction, elements=48, elements_up=2, pressure=1e6):
    return solved(
        "layers",
        layers=layers,
        friction=friction,
        elements=elements,
        elements_up=elements_up,
        plane="stress",
        length=LENGTH,
        thickness=THICKNESS,
        pressure=pressure,
        pressure_load=[[0.0, pressure], [1.0, pressure]],
        deflection=DEFLECTION,
        bend_load=[[0.0, 0.0], [0.5, 0.0], [1.0, DEFLECTION]],
        instants=3,
        violation=1e-7,
    )


def stiffness(iterate):
    """End force that bending adds, for a unit of deflection, N/m."""
    force = reaction(iterate, "right")[1]
    return (force[-1] - force[-2]) / DEFLECTION


@pytest.mark.parametrize("layers", [2, 3, 6])
def test_without_friction_every_layer_bends_alone(layers):
    exact = layers * alone(THICKNESS)
    assert stiffness(bent(layers, 0.0, pressure=1e5)) == pytest.approx(exact, rel=3e-3)


@pytest.mark.parametrize("layers", [2, 3, 6])
def test_with_much_friction_the_stack_bends_as_one_beam(layers):
    exact = alone(layers * THICKNESS)
    assert stiffness(bent(layers, 10.0)) == pytest.approx(exact, rel=4e-3)


def test_both_stiffnesses_converge_under_refinement():
    for friction in (0.0, 10.0):
        found = [stiffness(bent(3, friction, 2**n, 2)) for n in (3, 4, 5, 6)]
        steps = np.abs(np.diff(found))
        assert steps[0] > 1.5 * steps[1] > 2.25 * steps[2], steps


def test_stiffness_lies_between_the_limits_and_rises_with_friction():
    found = [stiffness(bent(3, friction)) for friction in (0.0, 0.01, 0.05, 10.0)]
    assert np.all(np.diff(found) > 0.0)


def test_the_inner_pressure_away_from_the_ends_is_that_on_the_faces():
    iterate = bent(3, 0.0, pressure=1e5)
    for name, law in iterate.problem.contacts.items():
        middle = np.abs(law.positions / LENGTH - 0.5) < 0.3
        pressure = iterate.contact(name).normal_force / lengths(iterate, name)
        np.testing.assert_allclose(pressure[middle], 1e5, rtol=0.02)
