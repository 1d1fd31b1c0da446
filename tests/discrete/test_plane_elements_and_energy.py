"""Rectangular elements are right; on cycles, work is stored or taken by friction."""

from __future__ import annotations

import numpy as np
import pytest
from plane import solved as driven
from scipy.sparse.linalg import spsolve

from solver.discrete import Body, Lattice
from solver.discrete.elements import EDGE_MASS, dofs_of, elastic_matrix
from solver.discrete.plane.body_parts import ShapePart
from solver.discrete.schur_complement import SchurComplement

STATES = ["strain", "stress"]


def rectangle(state="strain", poisson=0.3, columns=4, rows=3, width=0.5, height=0.25):
    """A lattice as a single part, in units of a metre and of Young's modulus."""
    shape = Lattice(columns, rows, width, height)
    body = Body("rectangle", shape, 1.0, poisson)
    elements = np.arange(columns * rows)
    return ShapePart(body, elements, shape.grid.ravel(), (1.0, 1.0), state)


def on_side(mesh, name):
    return mesh.body.shape.side(name)


def solved(mesh, held, values, force):
    """Solve for all nodes with some degrees of freedom prescribed."""
    whole = mesh.stiffness.tocsc()
    free = np.setdiff1d(np.arange(whole.shape[0]), held)
    found = np.zeros(whole.shape[0])
    found[held] = values
    found[free] = spsolve(
        whole[free][:, free], force[free] - whole[free][:, held] @ values
    )
    return found


@pytest.mark.parametrize("state", STATES)
def test_uniform_strain_has_no_forces_inside_and_its_own_stress(state):
    mesh = rectangle(state)
    gradient = np.array([[0.3, -0.7], [0.2, 0.5]])
    displacement = mesh.body.shape.nodes @ gradient.T
    force = (mesh.stiffness @ displacement.ravel()).reshape(-1, 2)
    inner = np.setdiff1d(mesh.nodes, mesh.outline.kept // 2)
    np.testing.assert_allclose(force[inner], 0.0, atol=1e-14)
    strain = [gradient[0, 0], gradient[1, 1], gradient[0, 1] + gradient[1, 0]]
    elastic = elastic_matrix(1.0, 0.3, state)
    expected = np.broadcast_to(elastic @ strain, (len(mesh.elements), 3))
    np.testing.assert_allclose(mesh.stress(displacement), expected, atol=1e-14)


@pytest.mark.parametrize(
    ("state", "factor"), [("stress", 1.0), ("strain", 1.0 / (1.0 - 0.09))]
)
def test_one_thin_row_of_elements_bends_as_a_beam(state, factor):
    length = 10.0
    height = 0.1
    columns = 20
    mesh = rectangle(state, 0.3, columns, 1, length / columns, height)
    left = on_side(mesh, "left")
    right = on_side(mesh, "right")
    force = np.zeros((len(mesh.nodes), 2))
    moment = 1e-3
    stress = np.array([6.0, -6.0]) * moment / height**2
    force[right, 0] = height * EDGE_MASS @ stress
    found = solved(mesh, dofs_of(left), np.zeros(2 * len(left)), force.ravel()).reshape(
        -1, 2
    )
    inertia = height**3 / 12.0
    assert found[right, 1].mean() == pytest.approx(
        moment * length**2 / (2.0 * factor * inertia), rel=2e-3
    )


def test_a_nearly_incompressible_bent_beam_does_not_lock():
    ends = []
    for poisson in (0.3, 0.4999):
        mesh = rectangle("strain", poisson, 20, 2, 0.5, 0.05)
        left = on_side(mesh, "left")
        right = on_side(mesh, "right")
        force = np.zeros((len(mesh.nodes), 2))
        force[right[[0, -1]], 0] = [1.0, -1.0]
        held = dofs_of(left)
        found = solved(mesh, held, np.zeros(len(held)), force.ravel()).reshape(-1, 2)
        ends.append(found[right, 1].mean() / (1.0 - poisson**2))
    # The clamp holds the width, which stiffens a little; locking would cost more than
    # half.
    assert ends[1] == pytest.approx(ends[0], rel=0.05)


@pytest.mark.parametrize(
    "sides", [("bottom",), ("left", "top"), ("left", "right", "bottom", "top")]
)
def test_condensed_displacements_are_recovered(sides):
    mesh = rectangle()
    random = np.random.default_rng(7)
    force = random.normal(size=(2 * len(mesh.nodes), 3))
    nodes = np.unique(np.concatenate([on_side(mesh, side) for side in sides]))
    held = SchurComplement(mesh.outline, dofs_of(nodes))
    values = random.normal(size=(len(held.kept), 3))
    found = held.recover(values, force).reshape(-1, 3)
    for column in range(3):
        wanted = solved(mesh, held.kept, values[:, column], force[:, column])
        np.testing.assert_allclose(found[:, column], wanted, atol=1e-10)
    reaction = mesh.stiffness @ found - force
    np.testing.assert_allclose(
        held.stiffness @ values - held.condense(force), reaction[held.kept], atol=1e-10
    )


TURNS = [0.0, 1.0, 0.0, -1.0, 0.0, 1.0, 0.0, -1.0, 0.0]
STEPS = 8


def cycles(size):
    """Two cycles of a path, at rest until 0.2 s, over 1 s."""
    times = np.linspace(0.2, 1.0, len(TURNS))
    points = zip(times.tolist(), TURNS, strict=True)
    turns = [[time, size * turn] for time, turn in points]
    return [[0.0, 0.0], *turns]


def at_once(size):
    """A value that is there from 0.1 s on."""
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
    """Work of forces from an instant on; exact for linear elasticity, J."""
    mean = 0.5 * (force[:, first + 1 :] + force[:, first:-1])
    return float(np.sum(mean * np.diff(displacement[:, first:], axis=1)))


def stored(problem, displacement):
    """Elastic energy at every instant, scaled, up to what loads inside hold."""
    energy = np.zeros(problem.n_instants)
    for part in problem.substructures:
        own = displacement[part.dofs]
        energy += 0.5 * np.einsum("ij,ij->j", own, part.elasticity.stiffness @ own)
    return energy


@pytest.mark.parametrize("scene", SCENES)
def test_work_on_a_closed_cycle_is_stored_or_dissipated(scene):
    iterate = driven(
        scene, instants=10 * STEPS + 1, violation=1e-9, most=3000, **SCENES[scene]
    )
    problem = iterate.problem
    scale = problem.scales.force * problem.scales.displacement
    first = 6 * STEPS
    external = 0.0
    displacement = problem.mean_of_rows @ iterate.boundary_displacement
    for side in ("top", "right"):
        if side in problem.interfaces:
            rows = problem.interfaces[side].rows
            prescribed = problem.interfaces[side].values
            external += work(iterate.boundary_force[rows], prescribed, first)
    for part in problem.substructures:
        if part.body_force is not None:
            external += work(part.body_force, displacement[part.dofs], first)
    energy = stored(problem, displacement)
    dissipated = 0.0
    for name in problem.contacts:
        fields = iterate.contact(name)
        dissipated -= work(fields.tangential_force, fields.slip, first)
    kept = (energy[-1] - energy[first]) * scale
    assert dissipated > 0.0
    assert external * scale == pytest.approx(kept + dissipated, rel=1e-6)
