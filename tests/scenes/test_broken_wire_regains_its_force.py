"""A broken wire regains force from its neighbours no faster than friction lets it."""

from __future__ import annotations

import numpy as np
import pytest

from solver.latin import Ending, solve
from solver.reference.closed_forms.pulled_bar import broken_wire
from solver.scenes import discretise
from solver.scenes.method import method_of
from solver.scenes.strand import StrandSettings

FAST = {
    "finish": "none",
    "tolerance": 1e-18,
    "max_iterations": 2000,
    "instants": 41,
}
PAIR = {"wires": 2, "broken": 1, "peak": 437.0}
GRIPPED = {"grip": "displacement"}


def solved(**changes):
    """Scene of some settings, and its converged iterate."""
    settings = StrandSettings.checked(FAST | changes)
    solution = solve(discretise(settings), method_of(settings), watch=False)
    assert solution.status.ending is Ending.CONVERGED
    return settings.structure(), solution.iterate


def axial_forces(scene, displacement):
    """Axial force of every element, shape (n_wires, n_elements, n_instants), N."""
    elongation = np.diff(displacement, axis=0)
    between = (scene.elements + 1) * np.arange(1, scene.wires) - 1
    if scene.broken is not None:
        wire, node = scene.broken
        between += np.arange(1, scene.wires) >= wire
        between = np.append(between, (wire - 1) * (scene.elements + 1) + node)
    stiffness = scene.stiffness * scene.elements / scene.length
    inside = np.delete(elongation, between, axis=0)
    return stiffness * inside.reshape(scene.wires, scene.elements, -1)


def wire_forces(**changes):
    scene, iterate = solved(**changes)
    return axial_forces(scene, iterate.displacement)


def points(scene):
    """Nodes, that of the break twice, which are points of the interfaces: none held."""
    return slice(1, -1 if scene.right.is_prescribed else None)


def relative(found, exact):
    return float(np.linalg.norm(found - exact) / np.linalg.norm(exact))


@pytest.mark.parametrize(
    "change",
    [{"peak": 437.0}, PAIR | GRIPPED | {"break_position": 0.3}],
    ids=["middle of three", "pair in a grip"],
)
def test_a_broken_wire_converges_to_the_closed_form(change):
    errors = []
    for elements in (20, 80):
        scene, iterate = solved(
            **change, elements=elements, instants=21, tolerance=1e-14
        )
        exact = broken_wire(scene)
        number = scene.broken[0]
        contact = iterate.contact("contact 1-2")
        side = 1.0 if number == 2 else -1.0
        friction = scene.rubbing_sides * side * contact.tangential_force
        errors.append(
            [
                relative(side * contact.slip, exact.slip[points(scene)]),
                relative(friction, exact.friction_force[points(scene)]),
            ]
        )
    slopes = np.log2(np.array(errors[0]) / errors[-1]) / 2.0
    assert slopes[0] > 0.9
    assert errors[-1][0] < 4e-3
    assert errors[-1][1] < 1e-3


@pytest.mark.parametrize("load", ["triangle", "decaying", "random"])
def test_the_closed_form_holds_on_any_tension_path(load):
    scene, iterate = solved(load=load, peak=333.0, elements=60)
    contact = iterate.contact("contact 1-2")
    exact = broken_wire(scene)
    assert relative(contact.slip, exact.slip[points(scene)]) < 0.03
    assert (
        relative(2.0 * contact.tangential_force, exact.friction_force[points(scene)])
        < 1e-5
    )


def test_a_broken_wire_slips_entirely_where_friction_is_too_small():
    scene, iterate = solved(**GRIPPED, load="ramp", peak=2000.0, friction=0.03)
    found = axial_forces(scene, iterate.displacement)[1, :, -1]
    place = (np.arange(60) + 0.5) / 60
    np.testing.assert_allclose(found, 300.0 * np.abs(place - 0.5), atol=1e-3)
    status = iterate.contact("contact 1-2").status[:, -1]
    np.testing.assert_array_equal(status, np.repeat([-1, 1], 30))


def test_without_friction_a_broken_wire_carries_nothing():
    scene, iterate = solved(**GRIPPED, friction=0.0, wires=4)
    found = axial_forces(scene, iterate.displacement)
    np.testing.assert_allclose(found[1], 0.0, atol=1e-3)
    for whole in (0, 2, 3):
        np.testing.assert_allclose(
            found[whole], scene.load + 0.0 * found[whole], atol=1e-3
        )


def test_the_break_mirrored_mirrors_everything():
    four = GRIPPED | {"wires": 4, "elements": 24, "substructures": 4, "instants": 21}
    left = wire_forces(**four, break_position=0.25)
    right = wire_forces(**four, break_position=0.75)
    assert relative(right[:, ::-1], left) < 1e-5
    last = wire_forces(**four, break_position=0.25, broken=3)
    assert relative(last[::-1], left) < 1e-5


@pytest.mark.parametrize("wires", [2, 5])
@pytest.mark.parametrize("grip", ["force", "displacement"])
def test_equal_wires_without_a_break_never_slip(wires, grip):
    scene, iterate = solved(wires=wires, broken=0, grip=grip, elements=30)
    found = axial_forces(scene, iterate.displacement)
    assert relative(found, scene.load + 0.0 * found) < 1e-7
    for number in range(1, wires):
        contact = iterate.contact(f"contact {number}-{number + 1}")
        assert np.abs(contact.tangential_force).max() < 1e-4
        assert not contact.status.any()


def strain_energy(scene, forces):
    """Energy of axial forces, shape (n_instants,), J."""
    element = scene.length / scene.elements
    return 0.5 * element / scene.stiffness * (forces**2).sum(axis=(0, 1))


def work_of_the_grip(iterate):
    """Work of each step, by the force at its end, shape (n_instants,), J."""
    rows = iterate.problem.interfaces["load"].rows
    scales = iterate.problem.scales
    steps = np.diff(iterate.boundary_displacement[rows], axis=1, prepend=0.0)
    work = (iterate.boundary_force[rows] * steps).sum(axis=0)
    return work * scales.force * scales.displacement


def dissipation(iterate):
    """Bound times the slip of each step, shape (n_instants,), J."""
    found = np.zeros(iterate.problem.n_instants)
    for name, law in iterate.problem.contacts.items():
        bound = (
            law.by_point(law.tangential.largest_bound.max(axis=1))
            * iterate.problem.scales.force
        )
        found += bound @ np.abs(
            np.diff(iterate.contact(name).slip, axis=1, prepend=0.0)
        )
    return found


@pytest.mark.parametrize(
    "change", [PAIR, {"wires": 5}, PAIR | GRIPPED | {"peak": 2000.0}]
)
def test_the_work_of_a_cycle_is_stored_or_dissipated(change):
    """By backward Euler a step also takes the strain energy of its increment."""
    scene, iterate = solved(**change, elements=30, tolerance=1e-22, max_iterations=4000)
    forces = axial_forces(scene, iterate.displacement)
    stored = strain_energy(scene, forces)
    taken = strain_energy(scene, np.diff(forces, axis=2, prepend=0.0))
    # the peaks of the tension
    first = 8
    second = 24
    cycle = slice(first + 1, second + 1)
    dissipated = dissipation(iterate)[cycle].sum()
    left_over = work_of_the_grip(iterate)[cycle].sum() - taken[cycle].sum() - dissipated
    assert dissipated > 0.01
    assert left_over == pytest.approx(
        stored[second] - stored[first], abs=1e-6 * dissipated
    )
    if scene.wires == 2:
        # Each side of the break is a friction bar, whose cycles are closed
        # (MATHEMATICS.md, 6).
        assert stored[second] == pytest.approx(stored[first], abs=1e-6 * dissipated)
