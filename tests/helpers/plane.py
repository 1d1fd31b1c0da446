"""Runs of the plane scenes, shared by tests: driven until the interface laws hold."""

from itertools import islice

import numpy as np

from solver.latin import iterations
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of

LOOK = 10


def solved(scene, *, violation=1e-8, most=1500, **values):
    """Iterate until the k-free indicator, looked at now and then, is low enough."""
    settings = CATALOGUE[scene].checked(values)
    problem = discretise(settings)
    for iterate in islice(
        iterations(problem, method_of(settings)), LOOK - 1, most, LOOK
    ):
        found = iterate.violation
        if found <= violation:
            return iterate
    raise AssertionError(
        f"the laws are violated by {found} after {iterate.number} iterations"
    )


def lengths(iterate, name="support"):
    """Tributary length of every point of a contact, shape (n_points, 1), m."""
    law = iterate.problem.contacts[name]
    return law.by_point(law.weights[:, None])


def reaction(iterate, side):
    """Resultant of the forces on a held side, along x and y, (2, n_instants), N."""
    problem = iterate.problem
    rows = problem.interfaces[side].rows
    force = iterate.boundary_force[rows] * problem.scales.force
    along = problem.inside.directions[problem.row_dofs[rows], :2]
    return along.T @ force


def stress(iterate, instant=-1):
    """Stresses (xx, yy, xy) of all elements at an instant, (n_elements, 3), Pa."""
    inside = iterate.problem.inside
    found = inside.displacement(iterate.displacement, [instant])
    return inside.stress(found[:, :, 0])


def whole_force_error(reference, iterate):
    """Error of the contact force as one field, pressure and friction together, (-)."""
    wanted = reference.contact_force
    return float(
        np.linalg.norm(iterate.contact_force - wanted) / np.linalg.norm(wanted)
    )
