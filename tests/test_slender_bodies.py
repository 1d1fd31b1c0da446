"""Slender bodies converge as soon as others: k and the macro basis follow their shape."""

from __future__ import annotations

from itertools import islice

import numpy as np
import pytest
from plane import whole_force_error

from solver.discrete.elements import elastic_matrix
from solver.discrete.macro import HIGHEST_DEGREE, side_basis
from solver.discrete.plane import Rectangle
from solver.latin import iterations, solve
from solver.latin.directions import automatic
from solver.reference.choice import reference_of
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of


def problem_of(scene, **values):
    settings = CATALOGUE[scene].settings.checked({"instants": 13, **values})
    return settings, discretise(settings)


def layers_of(ratio, **values):
    """Give layers so many times as long as thick, pressed so that they slide a part of the time."""
    own = {"thickness": 0.5 / ratio, "pressure": 2e6 * (50 / ratio) ** 2, "instants": 33}
    return problem_of("layers", **{**own, **values})


def error_after(most, settings, problem):
    """Give the largest error of the contact force in the last three of so many iterations."""
    reference = reference_of(problem)
    found = islice(iterations(problem, method_of(settings)), most - 3, most)
    return max(whole_force_error(reference, one) for one in found)


def degree_of(columns, rows, **values):
    rectangle = Rectangle(columns, rows, 1.0, 1.0, elastic_matrix(1.0, 0.3, "strain"))
    return side_basis(rectangle, "top", columns + 1, **values).shape[1] - 1


@pytest.mark.parametrize("ratio", [50, 200, 1000])
@pytest.mark.parametrize(
    "cuts", [{}, {"substructures": 1}, {"substructures_up": 2}], ids=["four", "uncut", "two up"]
)
def test_layers_of_any_slenderness_come_within_one_percent_in_fifty_iterations(ratio, cuts):
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
    """A fault of 40 m below 1600 m: 24 elements up are 80 times as high as wide, one 1920 times."""
    uncut = {"substructures": 1, "substructures_up": 1, "elements_up": elements_up}
    column = {"length": 40.0, "height": 1600.0, "shear_stress": 5.5e6, "diffusivity": 0.003}
    settings, problem = problem_of("fault", **column, **uncut)
    found = reference_of(problem)
    slips = found.status != 0
    assert found.converged.all()
    assert slips[:, 1:].mean() > 0.9
    contact = problem.rubbing["support"]
    bound = settings.strength(contact.positions) * contact.weights[:, None]
    friction = found.contact("support").tangential_force
    np.testing.assert_allclose(np.abs(friction)[slips], bound[slips], rtol=1e-9)
    assert solve(problem, method_of(settings)).is_certified


def test_the_macro_degree_grows_with_the_root_of_length_over_depth():
    short, long, longer = (degree_of(columns, 2, degree=1) for columns in (4, 50, 200))
    assert (short, long, longer) == (1, 3, 6)


def test_a_long_side_keeps_a_degree_of_zero_and_what_its_points_and_the_most_allow():
    assert degree_of(400, 1, degree=0) == 0
    assert degree_of(400, 1, degree=2) == HIGHEST_DEGREE
    assert degree_of(5, 1, degree=8) == 5


def test_the_macro_basis_of_a_long_side_has_independent_columns():
    rectangle = Rectangle(12, 1, 1.0, 0.01, elastic_matrix(1.0, 0.3, "strain"))
    assert np.linalg.cond(side_basis(rectangle, "top", 13, 2)) < 100.0


def test_k_between_bodies_knows_their_shape_and_not_their_cuts():
    def total(ratio, **values):
        _, problem = layers_of(ratio, **values)
        law = problem.rubbing["contact 1-2"]
        k = automatic(problem)
        return k[law.normal.component.above].sum(), k[law.tangent.above].sum()

    np.testing.assert_allclose(total(200, substructures=8), total(200), rtol=1e-12)
    np.testing.assert_allclose(total(10), (7.0, 1.0), rtol=1e-12)
    # Elements as long as the layers are thick leave the root of 40 / ratio; the held end point is
    # no part of the contact.
    fine = total(200, elements=200)
    np.testing.assert_allclose(fine, np.sqrt(40 / 200) * np.array((7.0, 1.0)), rtol=1e-4)


def test_k_of_a_support_is_at_least_the_stiffness_of_what_is_squeezed_on_it():
    for height, expected in ((0.05, 7.0), (1e-3, 100.0)):
        _, problem = problem_of("block", height=height)
        law = problem.rubbing["support"]
        k = automatic(problem)
        np.testing.assert_allclose(k[law.normal.component.above].sum(), expected, rtol=1e-12)
        np.testing.assert_allclose(k[law.tangent.above].sum(), expected, rtol=1e-12)


def test_k_of_a_support_grows_with_the_cube_root_of_its_points_on_fine_meshes_of_deep_bodies():
    def total(**values):
        _, problem = problem_of("block", elements_up=4, substructures=8, **values)
        law = problem.rubbing["support"]
        return automatic(problem)[law.normal.component.above].sum()

    np.testing.assert_allclose(total(elements=96), 7.0, rtol=1e-12)
    np.testing.assert_allclose(total(elements=768), 14.0, rtol=1e-12)
    np.testing.assert_allclose(total(elements=768, height=1e-3), 100.0, rtol=1e-12)
