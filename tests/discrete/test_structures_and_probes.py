"""Structures need no scene:
their probes give what the inside gives, their loops balance.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import islice
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np
import pytest

from solver import discrete, solve
from solver.discrete import Problem, Side, SideComponent, Stack, Support
from solver.discrete.elements import von_mises
from solver.discrete.plane.rectangles.bricks import Brick
from solver.discrete.probes import reaction, side_mean
from solver.latin import PGD, Iterate, iterations
from solver.reference.solution import fingerprint
from solver.refusal import RefusedError
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of
from solver.settings.scene import Settings

SMALL = {"elements": 12, "elements_up": 4, "instants": 9}
PULLED = {
    "top": "traction",
    "top_normal_traction": -2e7,
    "top_tangential_traction": 4e6,
}
HEAVY = {"body_force_y": -1e8, "body_force_x": 3e7}
LAYERS = {**SMALL, "elements_up": 2, "layers": 3}


def iterate_of(
    scene: str, values: dict[str, Any], number: int
) -> tuple[Settings, Iterate]:
    settings = CATALOGUE[scene].checked(values)
    run = iterations(discretise(settings), method_of(settings))
    return settings, next(islice(run, number - 1, None))


def trapezoid(along: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Mean over a line of places, in any order; values (n_places, n)."""
    order = np.argsort(along)
    along = along[order]
    values = values[order]
    pieces = np.diff(along)[:, None] * 0.5 * (values[1:] + values[:-1])
    return np.asarray(pieces.sum(axis=0) / (along[-1] - along[0]))


def whole(problem: Problem, iterate: Iterate) -> tuple[np.ndarray, np.ndarray]:
    assert problem.inside is not None
    return problem.inside.nodes, problem.inside.displacement(
        iterate.displacement, slice(None)
    )


@pytest.mark.parametrize("side", ["top", "left", "right"])
@pytest.mark.parametrize("component", [0, 1])
def test_mean_displacement_of_a_side_is_that_of_the_recovered_nodes(
    side: str, component: int
) -> None:
    """Loads inside move the side beside the skeleton, too."""
    _, iterate = iterate_of("block", SMALL | PULLED | HEAVY, 4)
    nodes, found = whole(iterate.problem, iterate)
    axis = 1 if side == "top" else 0
    if side == "left":
        outermost = nodes[:, axis].min()
    else:
        outermost = nodes[:, axis].max()
    on = nodes[:, axis] == outermost
    expected = trapezoid(nodes[on, 1 - axis], found[on, component])
    probe = side_mean(iterate.problem, side, component)
    shown = probe(iterate.displacement)
    assert shown == pytest.approx(expected, rel=1e-9, abs=1e-9 * np.abs(expected).max())


def test_reaction_is_the_force_that_holds_the_prescribed_end() -> None:
    _, iterate = iterate_of("layers", LAYERS, 120)
    problem = iterate.problem
    law: Any = problem.interfaces["right"]
    expected = iterate.boundary_force[law.rows].sum(axis=0) * problem.scales.force
    found = reaction(problem, "right").of(iterate)
    assert found == pytest.approx(expected, abs=2e-3 * np.abs(expected).max())


def test_shear_force_on_the_support_is_the_traction_on_the_top() -> None:
    settings, iterate = iterate_of("block", SMALL | PULLED, 200)
    loop = settings.structure().loop(iterate.problem)
    expected = settings.path("top_tangential_load") * settings.values()["length"]
    assert loop.force(iterate) == pytest.approx(
        expected, abs=1e-3 * np.abs(expected).max()
    )


def test_equivalent_stress_of_pure_shear_and_of_even_pressure() -> None:
    shear = von_mises(np.array([[0.0, 0.0, 2.0]]), 0.3, "stress")
    assert shear == pytest.approx([2.0 * np.sqrt(3.0)])
    even = von_mises(np.array([[1.0, 1.0, 0.0]]), 0.5, "strain")
    assert even == pytest.approx([0.0])
    assert von_mises(np.array([[3.0, 0.0, 0.0]]), 0.3, "stress") == pytest.approx([3.0])


T = np.linspace(0.0, 1.0, 9)
DOWN = SideComponent(prescribed=True, mean=-1e-6 * np.minimum(4.0 * T, 1.0))
ALONG = SideComponent(prescribed=True, mean=1e-6 * np.sin(2.0 * np.pi * T))
BODY = Stack(
    length=0.2,
    height=0.1,
    elements=(8, 4),
    substructures=(2, 1),
    young=1e9,
    poisson=0.3,
    instants=T,
    duration=1.0,
    support=Support(gap=np.zeros(9), friction=0.3),
    sides={"top": Side(x=ALONG, y=DOWN)},
)
BEAMS = replace(
    BODY,
    bricks=[Brick(0, 4 * body, 8, 4) for body in range(3)],
    support=None,
    sides={
        "left": Side(SideComponent(True, 0.0 * T), SideComponent(True, 0.0 * T)),
        "right": Side(
            SideComponent(False, 0.0 * T, 6e5 * T), SideComponent(False, 0.0 * T)
        ),
    },
)


def test_a_side_that_is_not_named_is_free() -> None:
    free = Side(SideComponent(False, 0.0 * T), SideComponent(False, 0.0 * T))
    named = replace(
        BODY, sides=dict.fromkeys(("left", "right", "bottom"), free) | BODY.sides
    )
    assert fingerprint(discrete.discretise(named)) == fingerprint(
        discrete.discretise(BODY)
    )
    assert {act.where for act in BODY.description().acts} == {"top x", "top y"}
    assert [hold.kind for hold in BODY.description().holds] == ["support"]


@pytest.mark.parametrize(
    ("name", "part", "change"),
    [
        ("Stack.sides", BODY, {"sides": {"Top": BODY.sides["top"]}}),
        ("Stack.young", BODY, {"young": -210e9}),
        (
            "Rods.stiffness",
            CATALOGUE["bar"].checked({}).structure(),
            {"stiffness": 0.0},
        ),
        ("Rods.length", CATALOGUE["bar"].checked({}).structure(), {"length": np.nan}),
    ],
)
def test_bodies_that_cannot_be_are_refused(
    name: str, part: Any, change: dict[str, Any]
) -> None:
    with pytest.raises(RefusedError, match=name):
        replace(part, **change)


def test_numbers_of_numpy_are_numbers() -> None:
    assert PGD(modes=np.arange(5, 9)[0]) == PGD(modes=5)


def test_the_moment_of_a_loop_is_that_of_the_traction() -> None:
    """Three heights h with an extreme s carry 3 s h^2 / 6, clockwise where s is up."""
    problem = discrete.discretise(BEAMS)
    still = SimpleNamespace(displacement=np.zeros((problem.n_dofs, len(T))))
    force = BEAMS.loop(problem).force(still)
    assert force == pytest.approx(-3.0 * 6e5 * T * 0.1**2 / 6.0)


def test_two_sides_that_move_a_pile_carry_the_friction_of_its_ground() -> None:
    """Sides that share a corner share its force, and balance friction together."""
    moved = SideComponent(True, 1e-6 * T)
    pressed = SideComponent(False, -1e5 * np.minimum(4.0 * T, 1.0))
    pile = replace(
        BODY,
        bricks=[Brick(0, 4 * body, 8, 4) for body in range(2)],
        friction=0.4,
        sides={
            "top": Side(moved, pressed),
            "left": Side(moved, SideComponent(False, 0.0 * T)),
        },
    )
    problem = discrete.discretise(pile)
    run = solve(problem, watch=False)
    shear = pile.loop(problem).force(run.iterate)
    carried = sum(
        reaction(problem, side, 0).of(run.iterate) for side in ("top", "left")
    )
    assert shear[-1] > 0.0
    assert shear == pytest.approx(carried, abs=1e-9 * shear[-1])


class Framed(NamedTuple):
    """A structure of one's own."""

    body: Stack


def test_a_structure_has_a_mesher_that_its_data_does_not_know() -> None:
    framed = Framed(BODY)
    with pytest.raises(RefusedError, match=r"of type Framed.*discretise\.register"):
        discrete.discretise(framed)
    discrete.discretise.register(
        Framed, lambda structure: discrete.discretise(structure.body)
    )
    found = discrete.discretise(framed)
    assert fingerprint(found) == fingerprint(discrete.discretise(BODY))
