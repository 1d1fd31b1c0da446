"""Results of a run: key figures, and the arrays of a result file."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from solver.files.disk import whole_file
from solver.latin import Answer, Iterate, Solution
from solver.reference.distance import determinate_forces, held_instants
from solver.scenes.remarks import remarks_on
from solver.settings.scene import Settings

INDICATORS = (
    "indicator",
    "behaviour",
    "estimated_error",
)
"""Indicators of every iteration."""
ERRORS = (
    "error_displacement",
    "error_force",
)
"""Errors of every iteration where there is a reference."""


def summary(settings: Settings, solution: Solution) -> dict[str, Any]:
    """Key figures of a finished run."""
    last = None
    seconds = solution.iterate.seconds
    if solution.records:
        last = solution.records[-1]
        seconds = last.seconds
    figures = {
        "scene": settings.scene,
        "status": str(solution.status.ending),
        "advice": solution.status.advice,
        "remarks": remarks_on(settings, solution.iterate),
        "iterations": solution.iterate.iterations,
    }
    for name in INDICATORS:
        figures[name] = getattr(last, name, None)
    figures["certified"] = solution.is_certified
    figures["residual"] = None
    if isinstance(solution.iterate, Answer):
        figures["residual"] = solution.iterate.residual
    for name in ERRORS:
        figures[name] = getattr(last, name, None)
    figures["seconds"] = seconds
    return figures


def result_arrays(settings: Settings, solution: Solution) -> Mapping[str, Any]:
    """Arrays of a result file (SI; space first, time last; solver/README.md, 12).

    In the plane `displacement` has shape (n_nodes, 2, n_instants), and
    `displacement_determinate`, (n_instants,), is false at instants at which nothing
    determines the position of a body.
    """
    iterate = solution.iterate
    residual = math.nan
    if isinstance(iterate, Answer):
        residual = iterate.residual
    arrays: dict[str, Any] = {"t": iterate.problem.instants}
    arrays |= _body_arrays(iterate)
    arrays |= interface_arrays(iterate)
    arrays |= _history_arrays(solution)
    arrays["certified"] = solution.is_certified
    arrays["residual"] = residual
    arrays["settings"] = json.dumps({"scene": settings.scene, **settings.values()})
    return arrays


def _body_arrays(iterate: Iterate) -> dict[str, Any]:
    """Arrays of bodies: of nodes along rods, or of nodes and elements in the plane."""
    problem = iterate.problem
    # Along rods every node is an unknown; in the plane inner nodes are condensed, and
    # follow from the sides.
    inside = problem.inside
    if inside is None:
        return {
            "x": problem.positions,
            "displacement": problem.absolute(iterate.displacement),
            "friction_force": iterate.friction_force,
            "determinate": determinate_forces(problem),
            "status": iterate.status,
        }
    return {
        "x": inside.nodes,
        "elements": inside.elements,
        "displacement": inside.displacement(iterate.displacement, slice(None)),
        "displacement_determinate": held_instants(problem, iterate.contact_force),
    }


def _history_arrays(solution: Solution) -> dict[str, Any]:
    """Arrays of figures of every iteration, each of shape (n_iterations,)."""
    names = [*INDICATORS, *ERRORS, "seconds"]
    arrays = {}
    for name in names:
        arrays[name] = np.array([getattr(entry, name) for entry in solution.records])
    if solution.iterate.bases:
        arrays["pgd_modes"] = np.array([entry.modes for entry in solution.records])
    return arrays


def interface_arrays(iterate: Iterate) -> dict[str, Any]:
    """Arrays `interface/NAME/...` of all interfaces, except a single rod's.

    `determinate`, (n_points,), is false at points whose force is an arbitrary share of
    the total that a support or a ring of bodies carries.
    """
    arrays: dict[str, Any] = {}
    determinate = determinate_forces(iterate.problem)
    contacts = iterate.problem.contacts
    positions = contacts.of_points([law.positions for law in contacts.laws.values()])
    # A single rod on its support has its fields under short names at the top level.
    is_plain = all(law.is_plain for law in contacts.laws.values())
    if is_plain and len(contacts) == 1:
        return arrays
    for name in contacts:
        fields = iterate.contact(name)
        *_, tangential = contacts.forces[name]
        entries = {
            "points": positions[contacts.points[name]],
            "determinate": determinate[tangential],
            "normal_force": fields.normal_force,
            "tangential_force": fields.tangential_force,
            "gap": fields.opening,
            "slip": fields.slip,
            "status": fields.status,
        }
        for key, field in entries.items():
            if field is not None:
                arrays[f"interface/{name}/{key}"] = field
    return arrays


def save_result(path: Path, settings: Settings, solution: Solution) -> None:
    """Write a result file (npz), complete or not at all."""
    with whole_file(path, "wb") as file:
        np.savez_compressed(file, **result_arrays(settings, solution))
