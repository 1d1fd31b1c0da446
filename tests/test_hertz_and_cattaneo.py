"""A parabola on a large block: Hertz, partial slip of Cattaneo and Mindlin, and its energy."""

from __future__ import annotations

import functools

import numpy as np
import pytest
from plane import lengths, solved

from solver.reference.assembly import jumps
from solver.reference.closed_forms.elastic_bodies import HalfPlane
from solver.reference.incremental import reference_of
from solver.scenes import discretise
from solver.scenes.block import BlockSettings

RADIUS, FRICTION, MESHES = 10.0, 0.3, [40, 80, 160]


class Contact:
    """A converged contact beside the closed forms for its own resultants.

    Johnson, Contact Mechanics, 1985, sections 4.2 and 7.2.
    """

    def __init__(self, elements, poisson, **values):
        self.element = 1.0 / elements
        iterate = solved(
            "block",
            gap="parabola",
            radius=RADIUS,
            length=1.0,
            height=1.0,
            elements=elements,
            elements_up=elements,
            substructures=4,
            substructures_up=4,
            poisson=poisson,
            **values,
        )
        self.fields = iterate.contact("support")
        self.weights = lengths(iterate)[:, 0]
        self.pressure = self.fields.normal_force[:, -1] / self.weights
        self.total = self.fields.normal_force[:, -1].sum()
        x = iterate.problem.rubbing["support"].positions
        self.x = x - x @ self.fields.normal_force[:, -1] / self.total
        stiffness = 210e9 / (1.0 - poisson**2)
        self.exact = HalfPlane(self.total, RADIUS, stiffness)
        self.half_width, self.peak = self.exact.half_width, self.exact.peak

    def root(self, half_width):
        return np.sqrt(np.maximum(1.0 - (self.x / half_width) ** 2, 0.0))


@functools.cache
def pressed(elements, interpolation="bilinear"):
    # The resultant for which the half-width is a tenth of the length.
    total = np.pi * 210e9 / (1.0 - 0.3**2) * 0.1**2 / (4.0 * RADIUS)
    return Contact(
        elements,
        0.3,
        interpolation=interpolation,
        friction=0.0,
        instants=1,
        top="traction",
        top_normal_traction=-total,
    )


@functools.cache
def reversed_(elements):
    """Slide everywhere, so that the pressing is forgotten, then go back a little.

    At nu = 0.4999 tangential forces do not move the surface along the normal, as Mindlin assumes.
    """

    def path(*values):
        return [[time, value] for time, value in zip((0.0, 0.3, 0.6, 0.9), values, strict=True)]

    return Contact(
        elements,
        0.4999,
        friction=FRICTION,
        instants=4,
        duration=0.9,
        top_normal_load=path(0.0, -8e-4, -8e-4, -8e-4),
        top_tangential_load=path(0.0, 0.0, -5e-3, -4e-3),
    )


def relative(found, exact):
    return np.linalg.norm(found - exact) / np.linalg.norm(exact)


def test_the_pressure_approaches_that_of_hertz_under_refinement():
    errors = []
    for elements in MESHES:
        contact = pressed(elements)
        exact = contact.peak * contact.root(contact.half_width)
        errors.append(relative(contact.pressure, exact))
    assert errors[0] > 1.5 * errors[1] > 2.25 * errors[2]
    assert errors[-1] < 0.03


def test_biquadratic_elements_come_as_near_to_hertz_with_as_many_nodes():
    for elements, bound in ((20, 0.12), (40, 0.06), (80, 0.03)):
        contact = pressed(elements, "biquadratic")
        exact = contact.peak * contact.root(contact.half_width)
        assert relative(contact.pressure, exact) < bound
        assert contact.pressure.max() == pytest.approx(contact.peak, rel=0.02)


@pytest.mark.parametrize("elements", MESHES)
def test_peak_and_half_width_are_those_of_hertz(elements):
    contact = pressed(elements)
    assert contact.pressure.max() == pytest.approx(contact.peak, rel=0.02)
    second_moment = contact.fields.normal_force[:, -1] @ contact.x**2 / contact.total
    assert 2.0 * np.sqrt(second_moment) == pytest.approx(contact.half_width, rel=0.02)
    touching = np.count_nonzero(contact.pressure > 1e-6 * contact.peak)
    assert abs(0.5 * touching * contact.element - contact.half_width) < 1.5 * contact.element


@pytest.mark.parametrize("run", [pressed, reversed_])
def test_the_pressure_rises_and_falls_once_without_spurious_oscillation(run):
    pressure = run(80).pressure
    assert np.abs(np.diff(pressure)).sum() == pytest.approx(2.0 * pressure.max(), rel=1e-6)


@pytest.mark.parametrize("elements", MESHES)
def test_the_stuck_part_has_the_width_of_cattaneo_and_mindlin(elements):
    contact = reversed_(elements)
    stuck = 0.5 * np.count_nonzero(contact.fields.status[:, -1] == 0) * contact.element
    assert abs(stuck - stick_half_width(contact)) < contact.element


def stick_half_width(contact):
    """The constant c after a reversal from sliding everywhere: twice the friction is at hand."""
    shear = -contact.fields.tangential_force[:, -1].sum() / (FRICTION * contact.total)
    return contact.exact.stuck(0.5 * (1.0 + shear))


def test_friction_summed_along_the_contact_approaches_two_square_roots():
    errors = []
    for elements in MESHES:
        contact = reversed_(elements)
        wide, narrow = contact.half_width, stick_half_width(contact)
        back = contact.root(wide) - narrow / wide * contact.root(narrow)
        exact = FRICTION * contact.peak * (2.0 * back - contact.root(wide))
        gap = np.cumsum(-contact.fields.tangential_force[:, -1] - exact * contact.weights)
        errors.append(np.abs(gap).max() / (FRICTION * contact.total))
    assert errors[0] > errors[1] > errors[2]
    assert errors[-1] < 0.03


LENGTH, NARROW_RADIUS, MU, STEPS, SHARE = 0.1, 5.0, 0.3, 6, 0.5
STIFFNESS = 210e9 / (1.0 - 0.4999**2)


@functools.cache
def cycle(half_width, pressing):
    """Press a block as high as long to a half-width, m, and shear it by half of what slides it.

    Gives the energy of a cycle over that of a half-plane, and how far the contact moves, in
    half-widths, along each of which there are twelve elements.
    """
    elements = round(12 * LENGTH / half_width)
    shear = SHARE * MU * np.pi * STIFFNESS * half_width**2 / (4.0 * NARROW_RADIUS) / LENGTH
    settings = BlockSettings.checked(
        {
            "radius": NARROW_RADIUS,
            "length": LENGTH,
            "height": LENGTH,
            "poisson": 0.4999,
            "friction": MU,
            "elements": elements,
            "elements_up": 60,
            "substructures": 1,
            "substructures_up": 1,
            "duration": 6.0,
            "instants": 6 * STEPS + 1,
            "top": "pushed",
            "top_normal_load": [[0.0, 0.0], [1.0, pressing]],
            "top_tangential_load": [[1.0, 0.0], [2.0, shear], [4.0, -shear], [6.0, shear]],
        }
    )
    problem = discretise(settings)
    found = reference_of(problem)
    assert found.converged.all()
    normal, tangential = problem.contact_places["support"]
    pressed, rubbed = found.contact_force[normal], found.contact_force[tangential]
    slip = np.diff((jumps(problem) @ found.displacement)[tangential], axis=1)
    taken = -(rubbed[:, 1:] * slip)[:, 2 * STEPS :].sum()
    total = pressed.sum(axis=0)
    middle = problem.rubbing["support"].positions @ pressed[:, 1:] / total[1:]
    moved = 0.5 * abs(middle[2 * STEPS - 1] - middle[4 * STEPS - 1]) / half_width
    share = abs(rubbed[:, -1].sum()) / (MU * total[-1])
    return taken / HalfPlane(total[-1], NARROW_RADIUS, STIFFNESS).energy(MU, share), moved


WIDE, NARROW = (0.02, -1.06e-4), (0.01, -3.31e-5)


def test_a_contact_of_a_fifth_of_the_body_takes_what_it_would_of_a_half_plane():
    energy, _ = cycle(*NARROW)
    assert energy == pytest.approx(1.0, abs=0.07)


def test_a_contact_of_two_fifths_of_a_high_body_rolls_and_takes_far_less():
    energy, moved = cycle(*WIDE)
    assert energy < 0.8
    assert moved > 1.5 * cycle(*NARROW)[1]
