"""On a cycle of the loads, their work is what the bodies store and what friction dissipates."""

from __future__ import annotations

import numpy as np
import pytest
from plane import solved

TURNS = [0.0, 1.0, 0.0, -1.0, 0.0, 1.0, 0.0, -1.0, 0.0]
STEPS = 8


def cycles(size):
    """Give two cycles of a path, at rest until 0.2 s, over 1 s."""
    times = np.linspace(0.2, 1.0, len(TURNS))
    return [[0.0, 0.0], *([float(t), size * turn] for t, turn in zip(times, TURNS, strict=True))]


def at_once(size):
    """Give a value that is there from 0.1 s on."""
    return [[0.0, 0.0], [0.1, size], [1.0, size]]


SCENES = {
    "block": {
        "gap": "flat",
        "elements": 24,
        "elements_up": 12,
        "top_normal_load": at_once(-1e-5),
        "top_tangential_load": cycles(1e-5),
    },
    "layers": {
        "elements": 24,
        "layers": 3,
        "deflection": 2e-3,
        "pressure_load": at_once(5e6),
        "bend_load": cycles(2e-3),
    },
}


def work(force, displacement, first):
    """Give the work of forces from an instant on; exact for linear elasticity, J."""
    mean = 0.5 * (force[:, first + 1 :] + force[:, first:-1])
    return float(np.sum(mean * np.diff(displacement[:, first:], axis=1)))


def stored(problem, displacement):
    """Give the elastic energy at every instant, scaled, up to what loads inside hold."""
    energy = np.zeros(problem.n_instants)
    for part in problem.substructures:
        own = displacement[part.dofs]
        energy += 0.5 * np.einsum("ij,ij->j", own, part.elasticity.stiffness @ own)
    return energy


@pytest.mark.parametrize("scene", SCENES)
def test_work_on_a_closed_cycle_is_stored_or_dissipated(scene):
    iterate = solved(scene, instants=10 * STEPS + 1, violation=1e-9, most=3000, **SCENES[scene])
    problem = iterate.problem
    scale = problem.scales.force * problem.scales.displacement
    first = 6 * STEPS
    external = 0.0
    displacement = problem.mean_of_rows @ iterate.boundary_displacement
    for side in ("top", "right"):
        if side in problem.interfaces:
            rows = problem.interfaces[side].rows
            prescribed = problem.interfaces[side].displacement
            external += work(iterate.boundary_force[rows], prescribed, first)
    for part in problem.substructures:
        if part.body_force is not None:
            external += work(part.body_force, displacement[part.dofs], first)
    energy = stored(problem, displacement)
    dissipated = 0.0
    for name in problem.rubbing:
        fields = iterate.contact(name)
        dissipated -= work(fields.tangential_force, fields.slip, first)
    kept = (energy[-1] - energy[first]) * scale
    assert dissipated > 0.0
    assert external * scale == pytest.approx(kept + dissipated, rel=1e-6)


def test_with_lift_off_the_normal_force_works_only_within_steps_and_less_in_shorter_ones():
    found = []
    for steps in (8, 16, 32):
        iterate = solved(
            "block",
            instants=10 * steps + 1,
            elements=48,
            elements_up=24,
            top_normal_load=at_once(-4e-5),
            top_tangential_load=cycles(2e-5),
        )
        problem, fields, first = iterate.problem, iterate.contact("support"), 6 * steps
        law = problem.interfaces["top"]
        scale = problem.scales.force * problem.scales.displacement
        external = work(iterate.boundary_force[law.rows], law.displacement, first) * scale
        dissipated = -work(fields.tangential_force, fields.slip, first)
        normal = -work(fields.normal_force, fields.opening, first)
        assert external == pytest.approx(dissipated + normal, rel=1e-6)
        found.append(abs(normal) / dissipated)
    assert found[0] > 1.5 * found[1] > 2.25 * found[2]
