"""A block on a rough support, solved by GetFEM, for any Python that has it.

It reads JSON and writes JSON, and imports nothing of this project. The elements are
those of `solver.discrete.elements`, told in GetFEM's own language: bilinear, with the
bending modes of Taylor, Beresford and Wilson as unknowns of every element, two by two
Gauss points. Contact and friction at the nodes are its basic contact brick, an
augmented Lagrangian after Alart and Curnier; the unknowns are increments, so that
friction is against what has moved since the instant before.

Lengths are over that of the block, stresses over Young's modulus.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from typing import Any

import numpy as np

PRECISION = 1e-12
STEPS = 200
UP = 0.01
"""Angle to the vertical within which a face looks upward."""


def solve(asked: dict[str, Any]) -> dict[str, Any]:
    """Solve instant by instant.

    Parameters
    ----------
    asked
        `elements` along and up, `height`, the matrix `elastic` from strains to
        stresses, `gap` at the nodes of the support, `friction`, and what the top is
        moved by, `top`, (2, n_instants).

    Returns
    -------
    Pressing forces `normal` and friction on the block `tangential` of the nodes of the
    support, (n_instants, n_lowest) each, and how far all nodes have `moved`, row by row
    from below, (n_instants, n_nodes, 2).
    """
    model, mesh, nodes = _elastic(asked)
    lowest = nodes[: asked["elements"][0] + 1]
    _touching(model, mesh, lowest, asked["friction"])
    gap = np.array(asked["gap"])
    before = np.zeros(2)
    gone = model.variable("u0")
    deformed = model.variable("a0")
    found: dict[str, list[Any]] = {"normal": [], "tangential": [], "moved": []}
    for top in np.array(asked["top"]).T:
        model.set_variable("top", top - before)
        model.set_variable("u0", gone)
        model.set_variable("a0", deformed)
        model.set_variable("gap", gap + gone[lowest[:, 1]])
        model.solve("max_res", PRECISION, "max_iter", STEPS)
        before = top
        gone = gone + model.variable("u")
        deformed = deformed + model.variable("a")
        found["normal"].append((-model.variable("n")).tolist())
        found["tangential"].append(model.variable("t").tolist())
        found["moved"].append(gone[nodes].tolist())
    return found


def _elastic(asked: dict[str, Any]) -> tuple[Any, Any, Any]:
    """Make the block, moved at its top;
    with its displacements, x and y of nodes row by row.
    """
    import getfem as gf

    gf.util("trace level", 0)
    columns, rows = asked["elements"]
    up = np.linspace(0.0, asked["height"], rows + 1)
    mesh = gf.Mesh("cartesian", np.linspace(0.0, 1.0, columns + 1), up)
    displaced = gf.MeshFem(mesh, 2)
    modes = gf.MeshFem(mesh, 4)
    middles = gf.MeshFem(mesh, 2)
    displaced.set_fem(gf.Fem("FEM_QK(2,1)"))
    for one in (modes, middles):
        one.set_fem(gf.Fem("FEM_QK(2,0)"))
    points = gf.MeshIm(mesh, gf.Integ("IM_GAUSS_PARALLELEPIPED(2,3)"))
    mesh.set_region(1, mesh.outer_faces_with_direction([0.0, 1.0], UP))
    model = gf.Model("real")
    model.add_fem_variable("u", displaced)
    model.add_fem_variable("a", modes)
    model.add_initialized_fem_data("u0", displaced, np.zeros(displaced.nbdof()))
    model.add_initialized_fem_data("a0", modes, np.zeros(modes.nbdof()))
    places = middles.basic_dof_nodes()
    both = np.arange(middles.nbdof())
    model.add_initialized_fem_data("c", middles, places[both % 2, both])
    model.add_macro("P", f"(-8*(X(1)-c(1))*{float(columns**2)!r})")
    model.add_macro("Q", f"(-8*(X(2)-c(2))*{float((rows / asked['height']) ** 2)!r})")
    model.add_linear_term(points, _work(asked["elastic"], "u", "a"))
    model.add_source_term(points, f"-({_work(asked['elastic'], 'u0', 'a0')})")
    model.add_initialized_data("top", [0.0, 0.0])
    model.add_Dirichlet_condition_with_multipliers(points, "u", displaced, 1, "top")
    x, y = displaced.basic_dof_nodes()
    place = np.rint(y * rows / asked["height"]) * (columns + 1) + np.rint(x * columns)
    return model, displaced, np.argsort(place, kind="stable").reshape(-1, 2)


def _touching(model: Any, displaced: Any, lowest: Any, friction: float) -> None:
    """Add contact and friction at the lowest nodes."""
    import getfem as gf

    count = len(lowest)
    across, along = (gf.Spmat("empty", count, displaced.nbdof()) for _ in range(2))
    for place, (first, second) in enumerate(lowest.tolist()):
        across.add(place, second, -1.0)
        along.add(place, first, 1.0)
    for name in ("n", "t"):
        model.add_variable(name, count)
    model.add_initialized_data("r", 1.0)
    model.add_initialized_data("mu", friction)
    model.add_initialized_data("gap", np.zeros(count))
    model.add_basic_contact_brick("u", "n", "t", "r", across, along, "mu", "gap")


def _work(elastic: Sequence[Sequence[float]], u: str, a: str) -> str:
    """Write the work of the stresses of a displacement with its bending modes."""
    terms = []
    for line, test in zip(elastic, _strains("Test_u", "Test_a"), strict=True):
        for value, strain in zip(line, _strains(u, a), strict=True):
            if value:
                terms.append(f"({value!r})*{strain}*{test}")
    return "+".join(terms)


def _strains(u: str, a: str) -> tuple[str, str, str]:
    along = f"(Grad_{u}(1,1)+P*{a}(1))"
    up = f"(Grad_{u}(2,2)+Q*{a}(4))"
    return along, up, f"(Grad_{u}(1,2)+Grad_{u}(2,1)+P*{a}(2)+Q*{a}(3))"


if __name__ == "__main__":
    # GetFEM itself may write on lines before this one.
    sys.stdout.write(f"\n{json.dumps(solve(json.load(sys.stdin)))}\n")
