"""Bodies of any shape obey mechanics, however they are meshed, turned and cut."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from plane import whole_force_error
from shaped_bodies import (
    arch,
    belt,
    block_on_ground,
    distorted,
    grid,
    half_wire,
    in_triangles,
    rotation,
    sides,
)

from solver.arrays import Array, Indices
from solver.cache import CACHE
from solver.discrete import (
    Beam,
    Bodies,
    Body,
    Held,
    Joint,
    Load,
    Mesh,
    Problem,
    discretise,
    schur_complement,
)
from solver.discrete.probes import reaction
from solver.latin import Latin, solve
from solver.reference.assembly import external_force
from solver.reference.distance import distance_to
from solver.reference.incremental import reference_of
from solver.refusal import RefusedError

BLOCK = grid(np.linspace(0.0, 0.1, 5), np.linspace(0.0, 0.05, 4))
MESHES = {
    "quadrilaterals": BLOCK,
    "distorted": distorted(BLOCK, 0.004),
    "triangles": in_triangles(distorted(BLOCK, 0.004)),
}
CORNERS = {
    "bottom": np.arange(5),
    "top": np.arange(15, 20),
    "left": np.arange(0, 20, 5),
    "right": np.arange(4, 20, 5),
}
"""Corners of the sides of these meshes."""
STILL = np.zeros(2)
TIME = np.array([0.0, 1.0])


def moved(problem: Problem, displacement: Array, instant: int = -1) -> Array:
    assert problem.inside is not None
    return problem.inside.displacement(displacement, [instant])[:, :, 0]


GRADIENT = 1e-4 * np.array([[2.0, 1.0], [0.5, -9.0]])
"""Gradient of a displacement that presses what lies on each other."""


def pressed_patch(mesh: Mesh, angle: float, cuts: int, state: str) -> Bodies:
    """Two bodies on each other, whose outer nodes move with `GRADIENT`."""
    turn = rotation(angle)
    gradient = turn @ GRADIENT @ turn.T
    chains = {name: mesh.along(corners) for name, corners in CORNERS.items()}
    bodies = []
    held = []
    for number, name in enumerate(("lower", "upper")):
        origin = turn @ [0.0, 0.05 * number]
        body = Body(name, mesh, 1e9, 0.3, origin, angle, substructures=cuts)
        far = chains[("bottom", "top")[number]]
        rim = np.unique(np.concatenate([far, chains["left"], chains["right"]]))
        held += held_by(gradient, body, number, rim)
        bodies.append(body)
    normals = np.tile(turn @ [0.0, 1.0], (len(chains["top"]), 1))
    bed = Joint("bed", 1, chains["bottom"], 0, chains["top"], normals, friction=0.9)
    return Bodies(bodies, [bed], held, [], TIME, 1.0, state=state)


def held_by(gradient: Array, body: Body, number: int, nodes: Indices) -> list[Held]:
    """Holds of nodes, (n,), of a body that move with a gradient, (2, 2)."""
    wanted = body.nodes[nodes] @ gradient.T
    held = []
    for axis in (0, 1):
        motion = np.outer(wanted[:, axis], TIME)
        held.append(Held(f"{body.name} {axis}", number, nodes, axis, motion))
    return held


def uniform_stress(state: str) -> Array:
    """Stresses xx, yy, xy under `GRADIENT`, (3,), Pa."""
    xx, yy = np.diag(GRADIENT)
    shear = 1e9 / 2.6 * (GRADIENT[0, 1] + GRADIENT[1, 0])
    poisson = 0.3
    factor = 1e9 / 0.91
    if state == "strain":
        poisson = 0.3 / 0.7
        factor = 1e9 * 0.7 / 1.3 / 0.4
    across = factor * (yy + poisson * xx)
    return np.array([factor * (xx + poisson * yy), across, shear])


@pytest.mark.parametrize("name", MESHES)
@pytest.mark.parametrize("cuts", [1, 3, 7])
@pytest.mark.parametrize("state", ["strain", "stress"])
def test_pressed_patches_have_the_stress_of_their_uniform_strain(
    name: str, cuts: int, state: str
) -> None:
    structure = pressed_patch(MESHES[name], 0.4, cuts, state)
    problem = discretise(structure)
    found = moved(problem, reference_of(problem).displacement)
    turn = structure.bodies[0].rotation
    places = np.concatenate([body.nodes for body in structure.bodies])
    wanted = places @ (turn @ GRADIENT @ turn.T).T
    assert found == pytest.approx(wanted, abs=1e-9 * np.abs(wanted).max())
    assert problem.inside is not None
    xx, yy, xy = problem.inside.stress(found).T
    own = turn.T @ np.moveaxis(np.array([[xx, xy], [xy, yy]]), -1, 0) @ turn
    exact = uniform_stress(state)
    for number, (row, column) in enumerate(((0, 0), (1, 1), (0, 1))):
        assert own[:, row, column] == pytest.approx(exact[number], rel=1e-7)


@pytest.mark.parametrize("name", [*MESHES, "beams"])
def test_rigid_motions_cost_no_force(name: str) -> None:
    line = Beam(np.array([[0.0, 0.0], [0.1, 0.1], [0.3, 0.0]]), 1e-4, 1e-9)
    shape = MESHES.get(name, line)
    body = Body("body", shape, 1e9, 0.3, angle=1.1)
    nodes = np.arange(3)
    held = [Held(f"{axis}", 0, nodes, axis, STILL) for axis in (0, 1)]
    if name == "beams":
        held.append(Held("turn", 0, nodes, 2, STILL))
    problem = discretise(Bodies([body], [], held, [], TIME, 1.0))
    assert problem.inside is not None
    (part,) = problem.substructures
    modes = problem.inside.rigid_modes(np.arange(problem.n_dofs))
    stiffness = part.elasticity.stiffness
    size = np.abs(stiffness).max()
    assert np.abs(stiffness @ modes[part.dofs]).max() < 1e-9 * size
    assert problem.inside.rigid_motions(np.arange(0)) is not None
    assert problem.rigid_motions is None


def test_a_body_that_nothing_holds_is_refused() -> None:
    body = Body("loose", BLOCK, 1e9, 0.3)
    foot = Held("foot", 0, BLOCK.along([0, 1]), 1, STILL)
    with pytest.raises(RefusedError, match="leave free: loose is"):
        discretise(Bodies([body], [], [foot], [], TIME, 1.0))
    other = replace(body, name="other")
    with pytest.raises(RefusedError, match="'other' without a joint"):
        discretise(Bodies([body, other], [], [foot], [], TIME, 1.0))


@pytest.mark.parametrize("name", MESHES)
def test_the_answer_does_not_know_the_angle_nor_the_cuts(name: str) -> None:
    mesh = MESHES[name]
    chains = {name: mesh.along(corners) for name, corners in CORNERS.items()}
    wanted = reference_of(discretise(block_on_ground(mesh, chains)))
    assert wanted.converged.all()
    size = np.abs(wanted.contact_force).max()
    for angle in (0.3, 0.5 * np.pi, 2.0):
        turned = discretise(block_on_ground(mesh, chains, angle=angle))
        found = reference_of(turned).contact_force
        assert found == pytest.approx(wanted.contact_force, abs=1e-10 * size)
    for cuts in (3, 7):
        cut = discretise(block_on_ground(mesh, chains, angle=0.7, cuts=cuts))
        found = reference_of(cut).contact_force
        assert len(cut.substructures) == cuts
        assert found == pytest.approx(wanted.contact_force, abs=1e-9 * size)


def moment_of(body: Body, nodes: Indices, force: Array) -> Array:
    """Moment about the origin of nodal forces, (n, 2, n_instants), N m."""
    x, y = body.nodes[nodes].T
    return np.asarray(x @ force[:, 1] - y @ force[:, 0])


def test_the_ground_carries_forces_and_moments_that_act() -> None:
    structure = block_on_ground(BLOCK, sides(BLOCK, 4, 3), angle=0.4, cuts=3)
    contact = reference_of(discretise(structure)).contact("ground")
    (foot,) = structure.joints
    (load,) = structure.loads
    normal = foot.normals[0]
    tangent = np.array([normal[1], -normal[0]])
    force = np.einsum("a,nt->nat", tangent, contact.tangential_force)
    force += np.einsum("a,nt->nat", normal, contact.normal_force)
    size = np.abs(load.force).sum()
    whole = load.force.sum(axis=0) + force.sum(axis=0)
    assert np.abs(whole).max() < 1e-10 * size
    (block,) = structure.bodies
    moment = moment_of(block, load.nodes, load.force)
    moment += moment_of(block, foot.nodes, force)
    assert np.abs(moment).max() < 1e-10 * size


def test_opposite_shear_gives_mirrored_forces() -> None:
    structure = block_on_ground(BLOCK, sides(BLOCK, 4, 3))
    wanted = reference_of(discretise(structure)).contact("ground")
    (load,) = structure.loads
    other = replace(load, force=load.force * np.array([-1.0, 1.0])[:, None])
    mirrored = discretise(replace(structure, loads=[other]))
    found = reference_of(mirrored).contact("ground")
    size = np.abs(load.force).sum()
    pressing = np.asarray(wanted.normal_force)[::-1]
    sliding = -np.asarray(wanted.tangential_force)[::-1]
    assert found.normal_force == pytest.approx(pressing, abs=1e-9 * size)
    assert found.tangential_force == pytest.approx(sliding, abs=1e-9 * size)


def test_weight_on_the_ground_is_carried_by_it() -> None:
    weight = np.outer([0.0, -3e4], TIME)
    mesh = MESHES["triangles"]
    body = Body("block", mesh, 1e9, 0.3, weight=weight, substructures=3)
    foot = mesh.along(np.arange(5))
    normals = np.tile([0.0, 1.0], (len(foot), 1))
    ground = Joint("ground", 0, foot, None, None, normals, friction=0.5)
    structure = Bodies([body], [ground], [], [], TIME, 1.0)
    problem = discretise(structure)
    assert problem.inside is not None
    along = problem.inside.directions[:, 1] @ external_force(problem)
    wanted = -3e4 * 0.1 * 0.05
    assert along[-1] * problem.scales.force == pytest.approx(wanted)
    reference = reference_of(problem)
    pressing = np.asarray(reference.contact("ground").normal_force)
    assert pressing.sum(axis=0)[-1] == pytest.approx(-wanted)
    displacement, force = structure.loop(problem).along(reference)
    assert force[-1] == pytest.approx(wanted)
    assert displacement[-1] < 0.0


def cantilever(cuts: int) -> Bodies:
    """An upright line of beams, 2 m long, clamped below and pulled by 1 kN above."""
    x = np.linspace(0.0, 2.0, 9)
    line = Beam(np.stack([x, 0.0 * x], axis=1), 1e-2, 1e-5)
    body = Body("beam", line, 2e11, angle=0.5 * np.pi, substructures=cuts)
    clamp = np.array([0])
    held = [Held(name, 0, clamp, axis, STILL) for axis, name in enumerate("xyz")]
    tip = np.array([[[0.0, 1e3], [0.0, 0.0]]])
    loads = [Load("tip", 0, np.array([8]), tip)]
    # A wall far away, as only problems with a contact have a reference.
    along = np.tile([1.0, 0.0], (9, 1))
    wall = Joint("wall", 0, np.arange(9), None, None, along, gap=1.0)
    return Bodies([body], [wall], held, loads, TIME, 1.0, shown="tip")


def test_a_cantilever_of_beams_bends_as_it_should_and_its_clamp_holds_it() -> None:
    for cuts in (1, 4):
        structure = cantilever(cuts)
        problem = discretise(structure)
        reference = reference_of(problem)
        displacement, force = structure.loop(problem).along(reference)
        assert displacement[-1] == pytest.approx(1e3 * 8.0 / 3.0 / 2e11 / 1e-5)
        assert force[-1] == 1e3
        moment = reaction(problem, "z", 2).of(reference)
        assert moment[-1] == pytest.approx(1e3 * 2.0)
        assert reaction(problem, "x", 0).of(reference)[-1] == pytest.approx(-1e3)


def test_an_arch_is_as_thin_as_it_may_be() -> None:
    # Thinnest arch of 31 voussoirs: 0.10717 (theory of rigid voussoirs).
    for thickness, stands in ((0.1085, True), (0.1065, False)):
        thin = arch(31, thickness, friction=0.8, across=3, young=1e12, instants=4)
        problem = discretise(thin)
        assert bool(reference_of(problem).converged.all()) == stands


def test_a_round_wire_is_pressed_as_hertz_says_the_finer_the_better() -> None:
    half_width = 4e-4
    # 4 P R = pi E' b^2 (MATHEMATICS.md, 6).
    force = 0.25 * np.pi * 1e11 / 0.91 * half_width**2 / 0.01
    errors = []
    for fine in (4, 8, 16):
        structure = half_wire(fine, force)
        contact = reference_of(discretise(structure)).contact("ground")
        pressing = np.asarray(contact.normal_force)[:, -1]
        assert pressing.sum() == pytest.approx(force)
        nodes = structure.bodies[0].nodes[structure.joints[0].nodes]
        # Half an ellipse has the variance b^2 / 4.
        spread = 2.0 * np.sqrt(pressing @ nodes[:, 0] ** 2 / pressing.sum())
        errors.append(abs(spread / half_width - 1.0))
    assert errors[0] > errors[1] > errors[2]
    assert errors[-1] < 0.01


def test_equal_voussoirs_share_operators() -> None:
    problem = discretise(arch(31))
    operators = {id(part.elasticity) for part in problem.substructures}
    assert len(operators) == 3


@pytest.mark.parametrize(("friction", "wrap"), [(0.3, np.pi), (0.2, 1.5 * np.pi)])
def test_a_belt_holds_up_to_the_exponential_of_its_angle(
    friction: float, wrap: float
) -> None:
    limit = np.exp(friction * wrap)
    held = reference_of(discretise(belt(wrap, friction, 0.99 * limit)))
    assert held.converged.all()
    lost = reference_of(discretise(belt(wrap, friction, 1.01 * limit)))
    assert not lost.converged.all()


def test_as_many_factors_are_made_as_there_are_parts_that_differ(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    made = []
    original = schur_complement.sparse_factor

    def counted(matrix: Any) -> Any:
        made.append(matrix.shape)
        return original(matrix)

    monkeypatch.setattr(schur_complement, "sparse_factor", counted)
    for voussoirs in (9, 61):
        made.clear()
        CACHE.clear()
        discretise(arch(voussoirs))
        # Both abutments, and one voussoir for all.
        assert len(made) == 3


@pytest.mark.parametrize("kind", ["arch", "belt", "block"])
def test_latin_comes_to_the_answer_of_the_incremental_solver(kind: str) -> None:
    structures = {
        "arch": arch(9, spread=2e-5),
        "belt": belt(np.pi, 0.3, 2.0, nodes=31),
        "block": block_on_ground(BLOCK, sides(BLOCK, 4, 3), angle=0.3, cuts=3),
    }
    problem = discretise(structures[kind])
    reference = reference_of(problem)
    solution = solve(problem, Latin(), watch=False)
    assert solution.is_certified
    assert whole_force_error(reference, solution.iterate) < 1e-8
    distance = distance_to(reference, problem)
    assert distance.of_friction_force(solution.iterate) < 1e-8
