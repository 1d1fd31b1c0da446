"""Round wires touch as Hertz says, stand as statics says, and are found quickly."""

from __future__ import annotations

import numpy as np
import pytest

from solver.arrays import sparse_factor
from solver.cache import CACHE
from solver.discrete.plane.bodies_problem import problem_of
from solver.discrete.plane.makers.wires import DOWN, UP, Packing
from solver.latin import Latin, iterations
from solver.reference.distance import distance_to
from solver.reference.incremental import reference_of
from solver.reference.limit_analysis import Motion, collapse_of
from solver.refusal import RefusedError
from solver.scenes import CATALOGUE, discretise

LOGS = {
    "arrangement": "heap",
    "rings": 2,
    "length": 0.15,
    "press": 0.0,
    "unit_weight": 6e3,
    "young": 8e8,
    "poisson": 0.49,
    "instants": 3,
}
PRESSED = {"rings": 1, "displacement": 0.0, "instants": 3}


def settings_of(**changes):
    return CATALOGUE["bundle"].checked(changes)


def forces_of(settings):
    """Pressing force and friction of all contacts at the end, N, by name."""
    reference = reference_of(discretise(settings))
    assert reference.converged.all()
    forces = {}
    for joint in settings.structure().joints:
        contact = reference.contact(joint.name)
        pressing = contact.normal_force[:, -1].sum()
        forces[joint.name] = pressing, contact.tangential_force[:, -1].sum()
    return forces


@pytest.mark.parametrize(("rings", "wires", "contacts"), [(1, 7, 16), (2, 19, 48)])
def test_wires_of_a_hexagon_touch_all_their_neighbours(rings, wires, contacts):
    settings = settings_of(rings=rings)
    assert settings.n_wires == wires
    assert settings.n_interfaces == contacts == len(settings.structure().joints)
    counts = [len(each) for each in Packing.hexagon(rings).neighbours]
    # Six of the outer ones are corners with three neighbours.
    assert counts.count(3) == 6
    assert counts.count(6) == wires - 6 * rings


def test_wires_under_plates_have_contacts_up_and_down():
    packing = Packing.heap(3)
    assert packing.rows == (3, 2, 1)
    assert DOWN in packing.directions(0, has_plate=True)
    assert UP in packing.directions(5, has_plate=True)
    assert UP not in packing.directions(5, has_plate=False)


def test_wires_in_alike_places_share_operators():
    problem = discretise(settings_of(elements=4, instants=3))
    operators = {id(part.elasticity) for part in problem.substructures}
    assert len(problem.substructures) == 20
    # All seven inner wires have one, and outer ones opposite to each other two.
    assert len(operators) <= 14
    owners = [id(part.elasticity) for part in problem.substructures]
    assert max(owners.count(owner) for owner in operators) == 7


def test_wires_of_one_shape_are_condensed_once(monkeypatch):
    structure = settings_of(elements=4, instants=3).structure()
    condensed = []

    def factor(matrix, **how):
        condensed.append(matrix.shape)
        return sparse_factor(matrix, **how)

    monkeypatch.setattr("solver.discrete.schur_complement.sparse_factor", factor)
    CACHE.clear()
    problem_of(structure)
    # Above one wire and below another the same wire has its directions turned round.
    assert len(condensed) == len({id(body.shape) for body in structure.bodies})


@pytest.mark.parametrize(("elements", "error"), [(8, 0.06), (16, 0.02)])
def test_wires_press_on_each_other_as_hertz_says(elements, error):
    """The closed form: half an ellipse, of the force that is found."""
    settings = settings_of(elements=elements, **PRESSED | {"instants": 2})
    problem = discretise(settings)
    reference = reference_of(problem)
    curves = list(settings.exact(problem, reference))
    names = {curve.interface for curve in curves}
    between = {name for name in names if " to " in name}
    # On rigid ground friction narrows a contact.
    assert len(between) == 12
    assert not any(name.startswith("ground") for name in names)
    for curve in curves:
        law = problem.contacts[curve.interface]
        force = reference.contact(curve.interface).normal_force
        found = force[:, -1] / law.by_point(law.weights[:, None])[:, 0]
        known = curve.up[:, -1]
        assert found.max() == pytest.approx(known.max(), rel=0.5 * error)
        # At its ends the pressure is steep.
        middle = found > 0.7 * known.max()
        apart = np.abs(found - known)[middle]
        assert apart.max() < error * known.max()


def test_forces_on_wires_balance_plate_band_and_weight():
    settings = settings_of(unit_weight=1e6, **PRESSED)
    forces = forces_of(settings)
    weight = 1e6 * np.pi * settings.length**2 * 7
    ground = sum(forces[name][0] for name in ("ground 1", "ground 2"))
    plate = sum(forces[name][0] for name in ("plate 6", "plate 7"))
    assert plate == pytest.approx(settings.press)
    assert ground == pytest.approx(settings.press + weight)


@pytest.mark.parametrize(("friction", "stands"), [(0.27, True), (0.25, False)])
def test_three_logs_stand_on_friction_of_fifteen_degrees(friction, stands):
    """Statics: the force on a lower log points to its contact with the ground."""
    assert np.tan(np.pi / 12.0) == pytest.approx(0.268, abs=1e-4)
    settings = settings_of(**LOGS, friction=friction)
    problem = discretise(settings)
    collapse = collapse_of(problem)
    assert (collapse is None) is stands
    assert stands or collapse.motion is Motion.FOLDS
    assert reference_of(problem).converged.all() == stands


def test_on_the_ground_logs_need_a_third_of_the_friction_between_them():
    settings = settings_of(**LOGS, friction=0.268)
    forces = forces_of(settings)
    pressing, friction = forces["ground 1"]
    weight = settings.unit_weight * np.pi * settings.length**2
    assert pressing == pytest.approx(1.5 * weight, rel=1e-5)
    assert abs(friction) / pressing == pytest.approx(0.268 / 3.0, rel=0.02)


def test_a_strip_of_a_log_on_the_ground_is_seven_tenths_of_a_millimetre_wide():
    settings = settings_of(**LOGS, friction=0.4)
    problem = discretise(settings)
    law = problem.contacts["ground 1"]
    force = reference_of(problem).contact("ground 1").normal_force[:, -1]
    distances = law.positions - law.positions @ force / force.sum()
    width = 4.0 * np.sqrt(force @ distances**2 / force.sum())
    assert width == pytest.approx(0.7e-3, rel=0.06)


@pytest.mark.parametrize("rings", [1, 2])
def test_the_search_takes_no_more_than_forty_iterations_whatever_the_wires(rings):
    """Without the coarse problem it is as wrong after as many."""
    problem = discretise(settings_of(rings=rings, elements=4, instants=7))
    distance = distance_to(reference_of(problem), problem)
    errors = []
    for method in (Latin(finish=None), Latin(finish=None, multiscale=False)):
        for iterate in iterations(problem, method):
            error = distance.of_friction_force(iterate)
            if error < 0.01 or iterate.number == 40:
                break
        errors.append(error)
    with_coarse, without = errors
    assert with_coarse < 0.01
    assert without > 0.2


def test_contacts_as_wide_as_wires_are_refused():
    with pytest.raises(RefusedError, match="contacts are narrow"):
        settings_of(young=1e9)


def test_the_sentence_of_a_bundle_describes_its_arrangement():
    assert (
        settings_of()
        .sentence()
        .startswith(
            "19 round wires lie side by side on the ground, held together by a band"
        )
    )
    assert settings_of(**LOGS).sentence() == (
        "3 round wires lie in a heap on the ground, and rub on each other."
    )
