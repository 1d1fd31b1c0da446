"""Bad values in a script are refused where they are given:
by name, value, range and remedy.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace
from math import inf, nan
from typing import Any

import numpy as np
import pytest
from scipy import sparse

from solver import End, Latin, Problem, Rods, Stack, iterations
from solver.discrete import Rope, Side, SideComponent, Spring, Support, discretise
from solver.discrete.plane.rectangles.bricks import Brick
from solver.discrete.substructure import Elasticity, Scales
from solver.latin import PGD, Anderson, Auto, Checkpoint, Nested, Stop
from solver.latin.end.status_step import StatusStep
from solver.laws import Dirichlet, FrictionLaw, Neumann, SlipFactor
from solver.refusal import RefusedError
from solver.scenes import CATALOGUE

T = np.linspace(0.0, 1.0, 5)
NODES = np.linspace(0.0, 1.0, 7)
Case = tuple[Any, dict[str, Any], str]


def falling(values: np.ndarray) -> np.ndarray:
    return np.asarray(values[::-1].copy())


def spoilt(values: np.ndarray, entry: float, place: Any = 0) -> np.ndarray:
    changed = values.astype(float)
    changed[place] = entry
    return changed


ROD = Rods(
    length=1.0,
    stiffness=1e6,
    elements=6,
    substructures=2,
    strength=100.0 + NODES,
    left=End(displacement=0.0 * T),
    right=End(force=200.0 * T),
    instants=T,
    duration=1.0,
)
STRAND = replace(ROD, wires=3, broken=(2, 3))
BODY = Stack(
    length=0.6,
    height=0.3,
    elements=(6, 3),
    substructures=(2, 1),
    young=1e9,
    poisson=0.3,
    instants=T,
    duration=1.0,
    support=Support(gap=0.0 * NODES, friction=0.3),
    sides={
        "top": Side(
            SideComponent(prescribed=False, mean=1e5 * T),
            SideComponent(False, -1e6 * T),
        )
    },
)
PILE = replace(BODY, bricks=[Brick(0, 0, 6, 3), Brick(0, 3, 6, 3)])
UNEVEN = SideComponent(True, 0.0 * T[1:])


def rope() -> Rope:
    values = {"elements": 10, "instants": 5, "layers": 1, "substructures": 2}
    made: Any = CATALOGUE["rope"].checked(values).structure()
    return made


ROPE = rope()
WIRE = ROPE.wires[0]
PROBLEM = discretise(ROD)
LOAD: Any = PROBLEM.interfaces["load"]
SUPPORT: Any = PROBLEM.interfaces["support"]
PIECE = PROBLEM.substructures[0]
FRICTION = PROBLEM.friction.tangential


def without(name: str) -> dict[str, Any]:
    return {key: law for key, law in PROBLEM.interfaces.items() if key != name}


RODS: list[Case] = [
    (ROD, {"length": nan}, "Rods.length"),
    (ROD, {"length": inf}, "Rods.length"),
    (ROD, {"length": "1 m"}, "Rods.length"),
    (ROD, {"length": None}, "Rods.length"),
    (ROD, {"length": np.array([1.0])}, "Rods.length"),
    (ROD, {"stiffness": -1e6}, "Rods.stiffness"),
    (ROD, {"stiffness": True}, "Rods.stiffness"),
    (ROD, {"elements": 0}, "Rods.elements"),
    (ROD, {"elements": 6.0}, "Rods.elements"),
    (ROD, {"substructures": 7}, "Rods.substructures"),
    (ROD, {"substructures": 1.5}, "Rods.substructures"),
    (ROD, {"wires": 0}, "Rods.wires"),
    (ROD, {"duration": 0.0}, "Rods.duration"),
    (ROD, {"strength": spoilt(NODES, nan)}, "Rods.strength"),
    (ROD, {"strength": spoilt(NODES, inf)}, "Rods.strength"),
    (ROD, {"strength": -NODES}, "Rods.strength"),
    (ROD, {"strength": NODES[1:]}, "Rods.strength"),
    (ROD, {"strength": np.ones((5, 7))}, "Rods.strength"),
    (ROD, {"strength": 100.0}, "Rods.strength"),
    (ROD, {"strength": list(NODES)}, "Rods.strength"),
    (ROD, {"strength": np.array(["100"] * 7)}, "Rods.strength"),
    (ROD, {"strength": NODES + 0j}, "Rods.strength"),
    (ROD, {"strength": None}, "Rods.strength"),
    (ROD, {"instants": falling(T)}, "Rods.instants"),
    (ROD, {"instants": spoilt(T, 0.25, 2)}, "Rods.instants"),
    (ROD, {"instants": spoilt(T, nan, 2)}, "Rods.instants"),
    (ROD, {"instants": T[:0]}, "Rods.instants"),
    (ROD, {"instants": T[:, None]}, "Rods.instants"),
    (ROD, {"instants": 5}, "Rods.instants"),
    (ROD, {"left": None}, "Rods.left"),
    (ROD, {"left": "held"}, "Rods.left"),
    (ROD, {"right": End(force=T[1:])}, "Rods.right.force"),
    (ROD, {"left": End(displacement=np.zeros(6))}, "Rods.left.displacement"),
    (ROD, {"body_force": np.ones(6)}, "Rods.body_force"),
    (ROD, {"body_force": spoilt(T, nan)}, "Rods.body_force"),
    (ROD, {"strain": np.ones((7, 5))}, "Rods.strain"),
    (ROD, {"settlement": np.full((7, 5), inf)}, "Rods.settlement"),
    (ROD, {"section": np.zeros(6)}, "Rods.section"),
    (ROD, {"factors": -1.0}, "Rods.factors"),
    (ROD, {"factors": np.ones(3)}, "Rods.factors"),
    (ROD, {"pressure": np.ones(4)}, "Rods.pressure"),
    (ROD, {"friction_law": "coulomb"}, "Rods.friction_law"),
    (ROD, {"broken": (1, 3)}, "Rods.wires"),
    (STRAND, {"broken": (4, 3)}, "Rods.broken"),
    (STRAND, {"broken": (2, 6)}, "Rods.broken"),
    (STRAND, {"broken": 2}, "Rods.broken"),
    (STRAND, {"broken": (2, 3, 1)}, "Rods.broken"),
    (ROD.right, {"force": 200.0}, "End.force"),
    (ROD.right, {"force": spoilt(T, nan)}, "End.force"),
    (ROD.left, {"displacement": [0.0]}, "End.displacement"),
    (ROD.left, {"spring": nan}, "End.spring"),
    (ROD.left, {"spring": 0.0}, "End.spring"),
    (ROD.left, {"spring": None}, "End.spring"),
]
STACKS: list[Case] = [
    (BODY, {"height": -0.3}, "Stack.height"),
    (BODY, {"young": nan}, "Stack.young"),
    (BODY, {"poisson": 0.5}, "Stack.poisson"),
    (BODY, {"poisson": "steel"}, "Stack.poisson"),
    (BODY, {"state": "plane stress"}, "Stack.state"),
    (BODY, {"elements": 6}, "Stack.elements"),
    (BODY, {"elements": (6, 0)}, "Stack.elements"),
    (BODY, {"elements": (6.0, 3.0)}, "Stack.elements"),
    (BODY, {"elements": (6, 3, 1)}, "Stack.elements"),
    (BODY, {"substructures": (2, 4)}, "Stack.substructures"),
    (BODY, {"substructures": (0, 1)}, "Stack.substructures"),
    (BODY, {"macro_degree": -1}, "Stack.macro_degree"),
    (BODY, {"instants": falling(T)}, "Stack.instants"),
    (BODY, {"instants": T[1:]}, "Stack.sides"),
    (BODY, {"duration": inf}, "Stack.duration"),
    (BODY, {"friction": -0.3}, "Stack.friction"),
    (BODY, {"friction": nan}, "Stack.friction"),
    (PILE, {"friction": np.full((3, 1), 0.3)}, "Stack.friction"),
    (PILE, {"friction": "rough"}, "Stack.friction"),
    (PILE, {"stiffness": np.array([1.0, -1.0])}, "Stack.stiffness"),
    (PILE, {"stiffness": np.ones(3)}, "Stack.stiffness"),
    (PILE, {"groups": np.array([0.5, 1.0])}, "Stack.groups"),
    (PILE, {"bricks": []}, "Stack.bricks"),
    (PILE, {"bricks": [(0, 0, 6, 3)]}, "Stack.bricks"),
    (PILE, {"bricks": [Brick(0, 0, 6, 3), Brick(3, 1, 6, 3)]}, "Stack.bricks"),
    (PILE, {"bricks": [Brick(0, 0, 6, 0)]}, "Stack.bricks"),
    (PILE, {"bricks": [Brick(-1, 0, 6, 3)]}, "Stack.bricks"),
    (BODY, {"body_force": np.ones((5, 2))}, "Stack.body_force"),
    (BODY, {"body_force": np.full((2, 5), nan)}, "Stack.body_force"),
    (BODY, {"tilt": np.ones(4)}, "Stack.tilt"),
    (BODY, {"support": 0.3}, "Stack.support"),
    (BODY, {"support": Support(0.0 * NODES[1:], 0.3)}, "Stack.support.gap"),
    (
        BODY,
        {"support": Support(0.0 * NODES, 0.3 * NODES[1:])},
        "Stack.support.friction",
    ),
    (
        BODY,
        {"support": Support(0.0 * NODES, 0.3, np.ones((7, 4)))},
        "Stack.support.strength",
    ),
    (BODY, {"sides": None}, "Stack.sides"),
    (BODY, {"sides": {"Top": BODY.sides["top"]}}, "Stack.sides"),
    (BODY, {"sides": {0: BODY.sides["top"]}}, "Stack.sides"),
    (BODY, {"sides": {"top": BODY.sides["top"].y}}, "Stack.sides"),
    (BODY, {"sides": {"top": Side(UNEVEN, BODY.sides["top"].y)}}, "Stack.sides"),
    (BODY, {"sides": {"top": Side(1.0, BODY.sides["top"].y)}}, "Stack.sides"),
    (BODY, {"spring": 1e5}, "Stack.spring"),
    (BODY.support, {"gap": 0.0}, "Support.gap"),
    (BODY.support, {"gap": spoilt(NODES, nan)}, "Support.gap"),
    (BODY.support, {"friction": -NODES}, "Support.friction"),
    (BODY.support, {"strength": NODES}, "Support.strength"),
    (BODY.sides["top"].y, {"mean": -1e6}, "SideComponent.mean"),
    (BODY.sides["top"].y, {"slope": "steep"}, "SideComponent.slope"),
    (BODY.sides["top"].y, {"prescribed": "yes"}, "SideComponent.prescribed"),
    (Spring(0.0, 1e5), {"stiffness": 0.0}, "Spring.stiffness"),
    (Spring(0.0, 1e5), {"slack": nan}, "Spring.slack"),
]
ROPES: list[Case] = [
    (ROPE, {"wires": []}, "Rope.wires"),
    (ROPE, {"wires": None}, "Rope.wires"),
    (ROPE, {"wires": ["wire"]}, "Rope.wires"),
    (ROPE, {"substructures": 11}, "Rope.substructures"),
    (ROPE, {"tension": 1e4}, "Rope.tension"),
    (ROPE, {"curvature": np.ones(4)}, "Rope.curvature"),
    (ROPE, {"instants": falling(ROPE.instants)}, "Rope.instants"),
    (ROPE, {"section": None}, "Rope.section"),
    (ROPE, {"wires": [replace(WIRE, tension=np.ones(4))]}, "Rope.wires[0].tension"),
    (WIRE, {"radius": nan}, "RopeWire.radius"),
    (WIRE, {"strength": -1.0}, "RopeWire.strength"),
    (WIRE, {"curvature": np.ones(5)}, "RopeWire.curvature"),
    (WIRE, {"layer_data": None}, "RopeWire.layer_data"),
    (
        ROPE.section,
        {"layers": (replace(WIRE.layer_data, diameter=nan),)},
        "CrossSection",
    ),
]
METHODS: list[Case] = [
    (Latin(), {"direction": "auto"}, "Latin.direction"),
    (Latin(), {"direction": None}, "Latin.direction"),
    (Latin(), {"linear": "pgd"}, "Latin.linear"),
    (Latin(), {"linear": PGD}, "Latin.linear"),
    (Latin(), {"multiscale": "no"}, "Latin.multiscale"),
    (Latin(), {"relaxation": nan}, "Latin.relaxation"),
    (Latin(), {"relaxation": 0.0}, "Latin.relaxation"),
    (Latin(), {"acceleration": True}, "Latin.acceleration"),
    (Latin(), {"start": "nested"}, "Latin.start"),
    (Latin(), {"finish": "at-once"}, "Latin.finish"),
    (Latin(), {"stop": 0.01}, "Latin.stop"),
    (Latin(), {"stop": None}, "Latin.stop"),
    (Latin(), {"threads": 1.5}, "Latin.threads"),
    (Stop(), {"accuracy": nan}, "Stop.accuracy"),
    (Stop(), {"tolerance": "low"}, "Stop.tolerance"),
    (Stop(), {"iterations": nan}, "Stop.iterations"),
    (Stop(), {"seconds": -1.0}, "Stop.seconds"),
    (Stop(), {"sufficient": inf}, "Stop.sufficient"),
    (Auto(), {"scale": inf}, "Auto.scale"),
    (PGD(), {"modes": 2.5}, "PGD.modes"),
    (Nested(list), {"coarser": [PROBLEM]}, "Nested.coarser"),
    (StatusStep(), {"at_once": None}, "StatusStep.at_once"),
    (FrictionLaw(), {"cohesion": nan}, "FrictionLaw.cohesion"),
    (FrictionLaw(), {"slip_factor": [(0.0, 1.0)]}, "FrictionLaw.slip_factor"),
    (SlipFactor((0.0, 1.0), (1.0, 0.5)), {"factors": (1.0, nan)}, "SlipFactor"),
]
PROBLEMS: list[Case] = [
    (PROBLEM, {"substructures": ()}, "Problem.substructures"),
    (PROBLEM, {"substructures": PROBLEM.substructures[:1]}, "Problem.substructures"),
    (PROBLEM, {"interfaces": {}}, "Problem.interfaces"),
    (PROBLEM, {"interfaces": list(PROBLEM.interfaces)}, "Problem.interfaces"),
    (PROBLEM, {"interfaces": without("load")}, "Problem.interfaces"),
    (
        PROBLEM,
        {"interfaces": {**PROBLEM.interfaces, "more": LOAD}},
        "Problem.interfaces",
    ),
    (
        PROBLEM,
        {"interfaces": {**PROBLEM.interfaces, "load": None}},
        "Problem.interfaces",
    ),
    (PROBLEM, {"positions": NODES[1:]}, "Problem.substructures"),
    (PROBLEM, {"positions": spoilt(NODES, nan)}, "Problem.positions"),
    (PROBLEM, {"instants": falling(T)}, "Problem.instants"),
    (PROBLEM, {"instants": spoilt(T, nan)}, "Problem.instants"),
    (PROBLEM, {"instants": T[:4]}, "Problem.interfaces"),
    (PROBLEM, {"scales": 1.0}, "Problem.scales"),
    (PROBLEM, {"rest": np.zeros((7, 4))}, "Problem.rest"),
    (PROBLEM, {"carried": spoilt(np.zeros((7, 5)), nan)}, "Problem.carried"),
    (Scales(1.0, 1.0, 1.0), {"force": 0.0}, "Scales.force"),
    (PIECE, {"body_force": np.zeros((3, 5))}, "Substructure.body_force"),
    (PIECE, {"dofs": PIECE.dofs[1:]}, "Substructure.dofs"),
    (PIECE, {"rows": PIECE.rows - 0.5}, "Substructure.rows"),
    (PIECE, {"elasticity": None}, "Substructure.elasticity"),
    (PIECE.elasticity, {"stiffness": np.eye(4)[:3]}, "Elasticity.stiffness"),
    (
        PIECE.elasticity,
        {"stiffness": np.diag([1.0, 1.0, 1.0, nan])},
        "Elasticity.stiffness",
    ),
    (PIECE.elasticity, {"stiffness": np.triu(np.ones((4, 4)))}, "Elasticity.stiffness"),
    (
        PIECE.elasticity,
        {"stiffness": sparse.csr_array(np.triu(np.ones((4, 4))))},
        "Elasticity.stiffness",
    ),
    (PIECE.elasticity, {"trace": PIECE.elasticity.trace + 9}, "Elasticity.trace"),
    (
        PIECE.elasticity,
        {"direction": -PIECE.elasticity.direction},
        "Elasticity.direction",
    ),
    (LOAD, {"values": spoilt(LOAD.values, nan, (0, 2))}, "Neumann.values"),
    (LOAD, {"values": LOAD.values[0]}, "Neumann.values"),
    (SUPPORT, {"rows": -SUPPORT.rows}, "Dirichlet.rows"),
    (FRICTION, {"bound": -FRICTION.bound}, "Friction.bound"),
    (PROBLEM.friction, {"tangential": None}, "Contact.tangential"),
    (PROBLEM.friction, {"points": PROBLEM.friction.points + 9}, "Contact.points"),
    (
        PROBLEM.friction,
        {"tangential": replace(FRICTION, friction=FRICTION.friction + 0.3)},
        "Contact.tangential.friction",
    ),
]
TABLES = {
    "rods": RODS,
    "stack": STACKS,
    "rope": ROPES,
    "method": METHODS,
    "problem": PROBLEMS,
}


def cases() -> Iterator[Any]:
    for table in TABLES.values():
        for number, (part, change, name) in enumerate(table):
            ((attribute, value),) = change.items()
            kind = type(value).__name__
            yield pytest.param(
                part,
                change,
                name,
                id=f"{type(part).__name__}.{attribute} {kind} {number}",
            )


@pytest.mark.parametrize(("part", "change", "name"), list(cases()))
def test_a_bad_value_is_refused_where_it_is_given(
    part: Any, change: dict[str, Any], name: str
) -> None:
    with pytest.raises(RefusedError) as refused:
        replace(part, **change)
    message = str(refused.value)
    assert message.startswith(name)
    assert refused.value.allowed
    assert refused.value.remedy
    assert "\n" not in message
    assert len(message) < 500


def test_two_displacements_of_one_point_contradict_each_other() -> None:
    """A body whose every degree of freedom has two rows."""
    part = replace(
        PIECE,
        elasticity=Elasticity(np.eye(1), np.zeros(2, int), np.ones(2)),
        dofs=np.zeros(1, int),
        rows=np.arange(2),
        free_force=None,
    )

    def held(second: float) -> Problem:
        laws = {
            "one": Dirichlet(np.array([0]), np.full((1, 5), 1.0)),
            "other": Dirichlet(np.array([1]), np.full((1, 5), second)),
        }
        return Problem((part,), laws, np.zeros(1), T, Scales(1.0, 1.0, 1.0))

    assert held(1.0 + 1e-14).prescribed[1] == pytest.approx(np.ones((1, 5)))
    with pytest.raises(RefusedError, match="two displacements"):
        held(1.1)


@pytest.mark.parametrize("name", ["dofs", "rows"])
def test_a_problem_refuses_negative_numbers_of_its_substructures(name: str) -> None:
    first, *others = PROBLEM.substructures
    wrong = replace(first, **{name: getattr(first, name) - 1})
    with pytest.raises(RefusedError, match=r"^Problem\.substructures = .* -1 "):
        replace(PROBLEM, substructures=(wrong, *others))


@pytest.mark.parametrize(
    ("arguments", "name"),
    [
        ((ROD, Latin()), "problem"),
        ((PROBLEM, None), "latin"),
        ((PROBLEM, "fast"), "latin"),
        ((PROBLEM, Latin(), PROBLEM), "start"),
        ((PROBLEM, Latin(), Checkpoint(3, 0.1, np.zeros((5, 5)))), r"start\.outgoing"),
    ],
)
def test_objects_that_are_no_problem_method_or_start_are_refused(
    arguments: tuple[Any, ...], name: str
) -> None:
    with pytest.raises(RefusedError, match=f"^{name} = "):
        next(iterations(*arguments))


def accepted() -> list[Callable[[], object]]:
    """Values that look odd and are none."""
    return [
        lambda: replace(ROD, length=np.float32(1.0), elements=np.int64(6)),
        lambda: replace(ROD, strength=np.arange(7)),
        lambda: replace(ROD, left=End(displacement=0.0 * T, spring=inf)),
        lambda: replace(ROD, instants=T - 1.0),
        lambda: replace(BODY, substructures=[2, 1], poisson=-0.2),
        lambda: replace(BODY, sides={}),
        lambda: replace(BODY, friction=np.float64(0.0)),
        lambda: Stop(accuracy=inf, iterations=inf, seconds=inf),
        lambda: Latin(acceleration=None, finish=None, start=None),
        lambda: Latin(acceleration=Anderson()),
        lambda: FrictionLaw(stiffness=inf, cap=inf),
        lambda: Neumann(np.zeros(0, int), np.zeros((0, 5)), np.zeros((0, 0))),
    ]


@pytest.mark.parametrize("make", accepted())
def test_allowed_values_are_not_refused(make: Callable[[], object]) -> None:
    assert make() is not None


def test_a_message_says_which_entry_is_wrong_and_what_to_do() -> None:
    with pytest.raises(RefusedError) as refused:
        replace(ROD, strength=spoilt(np.ones((7, 5)), nan, (3, 2)))
    assert str(refused.value) == (
        "Rods.strength = NaN is refused; allowed: an array of numbers from 0, shape "
        "[7] or [7, 5]; entry [3, 2] is no finite number, replace it"
    )
    with pytest.raises(RefusedError) as refused:
        replace(ROD, instants=spoilt(T, 0.1, 2))
    assert str(refused.value) == (
        "Rods.instants = [..., 0.25, 0.1, ...] is refused; allowed: an array of "
        "instants that increase, s, shape [n_instants], one or more; 0.1 comes after "
        "0.25: sort them, and give each once"
    )
