"""A stack bends like one beam where friction glues it, and like loose beams without friction."""

from __future__ import annotations

import functools

import numpy as np
import pytest
from plane import lengths, reaction, solved

from solver.reference.closed_forms.cantilever import cantilever

YOUNG, POISSON, LENGTH, THICKNESS, DEFLECTION = 210e9, 0.3, 0.5, 0.01, 1e-4


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
    """Give the end force that bending adds to that of pressing, for a unit of deflection, N/m."""
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
    for name, law in iterate.problem.rubbing.items():
        middle = np.abs(law.positions / LENGTH - 0.5) < 0.3
        pressure = iterate.contact(name).normal_force / lengths(iterate, name)
        np.testing.assert_allclose(pressure[middle], 1e5, rtol=0.02)
