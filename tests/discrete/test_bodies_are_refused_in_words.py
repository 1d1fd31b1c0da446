"""Bodies of any shape that cannot be are refused by the name of what is wrong."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import shaped_bodies

from solver.discrete import Beam, Bodies, Body, Held, Joint, Load, Mesh
from solver.refusal import RefusedError

INSTANTS = np.linspace(0.0, 1.0, 3)
SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
QUAD = Mesh(SQUARE, np.array([[0, 1, 2, 3]]))
UP = np.tile([0.0, 1.0], (3, 1))
LOWER = Body("lower", QUAD, 1e9, 0.2)
UPPER = Body("upper", QUAD, 1e9, 0.2, origin=np.array([0.0, 1.0]))
JOINT = Joint("bed", 1, QUAD.along([0, 1]), 0, QUAD.along([3, 2]), UP, 0.0, 0.5)
TURNED = Joint("turned", 0, QUAD.along([2, 3]), 1, QUAD.along([1, 0]), -UP, 0.0, 0.5)
FOOT = Held("foot", 0, QUAD.along([0, 1]), 1, np.zeros(3))
PULL = Load.of_traction("pull", 1, UPPER, QUAD.along([3, 2]), np.ones((2, 3)))


def bodies(**changes: Any) -> Bodies:
    fields: dict[str, Any] = {
        "bodies": (LOWER, UPPER),
        "joints": (JOINT,),
        "held": (FOOT,),
        "loads": (PULL,),
        "instants": INSTANTS,
        "duration": 1.0,
    }
    return Bodies(**(fields | changes))


def test_a_chain_has_the_middles_of_its_edges_and_their_lengths() -> None:
    x = np.array([[0.0, 0.0], [2.0, 0.0], [3.0, 0.0], [0.0, 1.0], [2.0, 1.0], [3, 1]])
    triangles = np.array([[0, 1, 4], [4, 3, 0], [1, 2, 5], [1, 5, 4]])
    for elements in (np.array([[0, 1, 4, 3], [1, 2, 5, 4]]), triangles):
        mesh = Mesh(x, elements)
        chain = mesh.along([0, 1, 2])
        assert mesh.nodes[chain, 0] == pytest.approx([0.0, 1.0, 2.0, 2.5, 3.0])
        shares = np.array([2.0, 8.0, 3.0, 4.0, 1.0]) / 6.0
        assert mesh.shares(chain) == pytest.approx(shares)
        assert mesh.outward(chain) == pytest.approx(np.outer(shares, [0.0, -1.0]))
        backward = mesh.outward(chain[::-1])
        assert backward == pytest.approx(mesh.outward(chain)[::-1])
        assert mesh.areas.sum() == pytest.approx(3.0)


def test_a_pressure_pushes_against_a_turned_body_with_its_resultant() -> None:
    body = replace(UPPER, angle=0.3)
    pressure = np.array([0.0, 1.0, 2.0])
    load = Load.of_pressure("press", 1, body, QUAD.along([2, 3]), pressure)
    wanted = np.outer([np.sin(0.3), -np.cos(0.3)], pressure)
    assert load.force.sum(axis=0) == pytest.approx(wanted)


def bad_mesh(elements: list[list[int]], corners: Any = SQUARE) -> Any:
    return replace(LOWER, shape=Mesh(corners, np.array(elements)))


FAR = np.concatenate([SQUARE, SQUARE + 5.0])
SIDE = QUAD.along([1, 2])
WRONG = {
    "of no or negative area": lambda: bad_mesh([[3, 2, 1, 0]]),
    "corner 3 that no element has": lambda: bad_mesh([[0, 1, 2]]),
    "a mesh of 2 pieces": lambda: bad_mesh([[0, 1, 2, 3], [4, 5, 6, 7]], FAR),
    "beam 1 of no length": lambda: replace(
        LOWER, shape=Beam(SQUARE[[0, 1, 1]], 1.0, 1.0)
    ),
    "Body 'lower'.substructures = 2": lambda: replace(LOWER, substructures=2),
    "Body 'lower'.young = -1": lambda: replace(LOWER, young=-1.0),
    "2 with the name 'lower'": lambda: bodies(bodies=(LOWER, replace(LOWER))),
    "2 with the name 'bed'": lambda: bodies(held=(replace(FOOT, name="bed"),)),
    "Held 'supports'.name": lambda: bodies(held=(replace(FOOT, name="supports"),)),
    "Joint 'bed' on body = 2": lambda: bodies(joints=(replace(JOINT, above=2),)),
    "3 nodes of Body 'upper'": lambda: bodies(
        joints=(replace(JOINT, nodes=np.array([0, 1, 2])),)
    ),
    "too far apart": lambda: bodies(joints=(replace(JOINT, nodes_below=SIDE),)),
    "normal 0 of length 2": lambda: bodies(joints=(replace(JOINT, normals=2.0 * UP),)),
    "normal 0 out of Body 'upper'": lambda: bodies(
        joints=(replace(JOINT, normals=-UP),)
    ),
    "the pairs of nodes of Joint 'bed'": lambda: bodies(
        joints=(JOINT, replace(JOINT, name="again", friction=0.2))
    ),
    "pairs that touch in one joint only": lambda: bodies(joints=(JOINT, TURNED)),
    "Held 'foot'.nodes = 9": lambda: bodies(held=(replace(FOOT, nodes=np.array([9])),)),
    "Held 'foot'.axis = 2": lambda: bodies(held=(replace(FOOT, axis=2),)),
    "Held 'foot'.displacement = of shape [4]": lambda: bodies(
        held=(replace(FOOT, displacement=np.zeros(4)),)
    ),
    "Load 'pull'.force = of shape [3, 2, 2]": lambda: bodies(
        loads=(replace(PULL, force=np.zeros((3, 2, 2))),)
    ),
    'Bodies.shown = "top"': lambda: bodies(shown="top"),
}


@pytest.mark.parametrize("words", WRONG)
def test_inconsistent_bodies_are_refused_by_name(words: str) -> None:
    with pytest.raises(RefusedError) as caught:
        WRONG[words]()
    assert words in str(caught.value)


def test_nodes_that_are_held_along_both_axes_are_clamped() -> None:
    structure = shaped_bodies.arch(3, spread=1e-3)
    described = structure.description()
    assert [footing.kind for footing in described.footings or ()] == ["clamp", "clamp"]
    for footing in described.footings or ():
        assert footing.points[:, 1] == pytest.approx(np.zeros(len(footing.points)))
        assert footing.outward[:, 1] == pytest.approx(-np.ones(len(footing.points)))
    (moved,) = (act for act in described.acts if act.unit == "m")
    assert (moved.side, moved.away) == ("bottom", (0.0, -1.0))


def test_a_load_at_a_point_has_room_along_itself() -> None:
    described = shaped_bodies.belt(np.pi, 0.3, 1.2).description()
    for act in described.acts:
        direction = np.asarray(act.towards)[:, -1]
        assert abs(direction @ act.away) == pytest.approx(1.0)


def test_described_loads_and_supports_lie_on_the_bodies() -> None:
    described = bodies().description()
    assert (described.length, described.height) == (1.0, 2.0)
    (act,) = described.acts
    assert act.points == pytest.approx(np.array([[0.5, 1.0]]))
    assert act.values == pytest.approx(np.full(3, np.sqrt(2.0)))
    (foot,) = described.footings
    assert foot.points[:, 1] == pytest.approx(np.zeros(3))
    assert foot.outward[:, 1] == pytest.approx(-np.ones(3))


def test_names_of_laws_are_refused_for_interfaces_alone() -> None:
    for field, named in (("joints", JOINT), ("held", FOOT)):
        message = f"{type(named).__name__} 'contacts'.name"
        with pytest.raises(RefusedError, match=message):
            bodies(**{field: (replace(named, name="contacts"),)})
    # Loads and bodies are no interfaces.
    assert bodies(loads=(replace(PULL, name="contacts"),)).loads[0].name == "contacts"
    named = (replace(LOWER, name="supports"), UPPER)
    assert bodies(bodies=named).bodies[0].name == "supports"
