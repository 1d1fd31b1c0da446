"""Bodies in the plane that touch elsewhere than a stack are put together from its parts."""

from __future__ import annotations

import numpy as np
import pytest

from solver import Latin, solve
from solver.discrete import Problem
from solver.discrete.elements import elastic_matrix
from solver.discrete.plane import Condensed, Rectangle
from solver.discrete.plane_parts import Part, Trace, keep, lined_up, number_rows, problem_of
from solver.discrete.problem import Scales
from solver.latin import Ending
from solver.laws import Bodies, Component, Contact, Dirichlet, FrictionLaw, Unilateral
from solver.reference.incremental import reference_of

SIZE, TIMES = 0.25, np.linspace(0.0, 1.0, 5)
PIER, LINTEL = (2, 4), (10, 2)
"""Elements along and up, all of them squares."""
WEIGHT = 1e-4
"""Of the lintel, scaled."""


def lintel_on_two_piers() -> Problem:
    """Two piers on the ground, each below two elements of a lintel from one to the other."""
    outlines = {
        shape: Condensed(Rectangle(*shape, SIZE, SIZE, elastic_matrix(1.0, 0.2, "stress")))
        for shape in (PIER, LINTEL)
    }
    above = {"on the left": (0, 3), "on the right": (8, 11)}
    pieces = [
        (PIER, 0, 0, {"ground": Trace("bottom"), "on the left": Trace("top", has_macro=True)}),
        (PIER, 8, 0, {"ground": Trace("bottom"), "on the right": Trace("top", has_macro=True)}),
        (
            LINTEL,
            0,
            4,
            {name: Trace("bottom", (0, 1), *span, has_macro=True) for name, span in above.items()},
        ),
    ]
    parts, positions, first = [], [], 0
    for body, (shape, x, y, traces) in enumerate(pieces):
        mesh = outlines[shape].rectangle
        force = None
        if shape == LINTEL:
            areas = np.outer(mesh.edge_weights("left"), mesh.edge_weights("bottom"))
            load = np.stack([np.zeros_like(areas), -areas / areas.sum()], axis=-1)
            force = np.outer(load, WEIGHT * TIMES)
        condensed = keep(outlines[shape], traces.values())
        parts.append(Part(condensed, first + mesh.nodes, body, traces, force=force))
        first += mesh.n_nodes
        up, along = np.indices(mesh.nodes.shape)
        positions.append(SIZE * np.stack([x + along.ravel(), y + up.ravel()], axis=1))
    skeleton = number_rows(parts)
    grounds = np.concatenate([part.rows["ground"].ravel() for part in parts[:2]])
    still = np.zeros((len(grounds), len(TIMES)))
    interfaces = {name: _contact(parts[2], parts[n], name) for n, name in enumerate(above)}
    return problem_of(
        parts,
        skeleton,
        np.concatenate(positions),
        {**interfaces, "ground": Dirichlet(grounds, still)},
        scales=Scales(1.0, 1.0, 1.0),
        instants=TIMES,
    )


def _contact(lintel: Part, pier: Part, name: str) -> Contact:
    upper, weights, macro = lined_up([lintel], name, 1)
    lower, count = pier.rows[name], len(weights)
    along, across = (Component(upper[:, axis], lower[:, axis]) for axis in (0, 1))
    law = FrictionLaw().at(along, weights, (1.0, 1.0), friction=np.full(count, 0.5))
    return Contact(
        normal=Unilateral(component=across, gap=np.zeros(count)),
        tangential=law,
        points=np.arange(count),
        positions=pier.rectangle.width * np.arange(count),
        weights=weights,
        around=Bodies(moduli=(1.0, 1.0), depth=4 * SIZE),
        macro=macro,
    )


def test_two_piers_carry_half_of_a_lintel_each() -> None:
    problem = lintel_on_two_piers()
    run = solve(problem, Latin())
    assert run.status.ending is Ending.CONVERGED
    for found in (run.iterate, reference_of(problem)):
        left, right = (found.contact(name) for name in ("on the left", "on the right"))
        for side in (left, right):
            carried = side.normal_force.sum(axis=0)
            assert carried == pytest.approx(0.5 * WEIGHT * TIMES, rel=1e-2, abs=1e-9)
        thrust = left.tangential_force + right.tangential_force[::-1]
        assert np.abs(thrust).max() < 1e-2 * np.abs(left.tangential_force).max()


def test_the_lintel_sags_between_its_piers() -> None:
    problem = lintel_on_two_piers()
    assert problem.inside is not None
    moved = problem.inside.displacement(reference_of(problem).displacement, [4])[:, 1, 0]
    lintel = problem.inside.nodes[:, 1] >= 4 * SIZE
    x = problem.inside.nodes[:, 0]
    middle = lintel & np.isclose(x, 5 * SIZE)
    assert moved[middle].max() < moved[lintel & np.isclose(x, 0.0)].min()
