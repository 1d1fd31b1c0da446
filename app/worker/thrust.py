"""Resultant forces of joints, their points of action, and hinges."""

from __future__ import annotations

from typing import Any

import numpy as np

from app.messages import Needs
from app.worker.cells import NONE, floats
from solver.arrays import Array, Indices, largest_size
from solver.discrete import Problem
from solver.discrete.contact_groups import Stacked
from solver.latin import Iterate
from solver.laws import OPEN
from solver.study.quantities.arch_measures import are_hinges


class Thrusts:
    """Joints of bodies, for the extra of the thrust.

    `corner` is the one from which positions are drawn, (2,), m, `columns` are the
    instants that are shown, (n_shown,).
    """

    def __init__(self, problem: Problem, corner: Array, columns: Indices) -> None:
        self._problem = problem
        self._columns = columns
        self._positions = problem.positions - corner
        contacts = problem.contacts
        self._above = np.full(len(contacts), NONE)
        self._below = np.full(len(contacts), NONE)
        bodies = problem.inside.body_of_dofs
        for stacked in contacts.stacks:
            above, *below = [
                problem.row_dofs[rows] for rows in stacked.law.tangent.sides
            ]
            _, firsts = np.unique(stacked.law.interface_of_pairs, return_index=True)
            self._above[stacked.numbers] = bodies[above[firsts]]
            if below:
                self._below[stacked.numbers] = bodies[below[0][firsts]]
        self._middles = self._middles_of_bodies() - corner
        # In a chain of bodies the thrust goes from joint to joint.
        ends = np.concatenate([self._above, self._below])
        joints = np.bincount(ends[ends != NONE], minlength=len(self._middles))
        self._is_chain = len(joints) > 2 and joints.max() <= 2

    def of(self, iterate: Iterate, needs: Needs) -> dict[str, Any]:
        """Resultant force in every joint, and its point of action.

        "lines" go from the middle of one body over the point where the resultant acts
        to the middle of the other, (n_joints, 3, 2, n_shown), m; on a support they end
        there. In a chain of bodies they go from joint to joint. "forces" are their
        sizes, (n_joints, n_shown), N, and "largest" the largest of them at any instant
        of the run. "hinges" is 1 where a joint of a chain is a hinge, else 0,
        (n_joints, n_shown).
        """
        contacts = self._problem.contacts
        shape = len(contacts), len(self._columns)
        points = np.zeros((len(contacts), 2, len(self._columns)))
        forces = np.zeros(shape)
        hinges = np.zeros(shape)
        largest = 0.0
        for stacked in contacts.stacks:
            normal, tangential = [
                iterate.contact_force[numbers] for numbers in stacked.forces
            ]
            pressed = np.maximum(normal, 0.0)
            sizes, places = self._resultants(stacked, pressed, tangential)
            largest = max(largest, largest_size(sizes))
            forces[stacked.numbers] = sizes[:, self._columns]
            points[stacked.numbers] = places[..., self._columns]
            if self._is_chain:
                status = iterate.status[stacked.points][:, self._columns]
                found = are_hinges(stacked.law, status != OPEN)
                hinges[stacked.numbers] = found
        return {
            "lines": floats(self._lines(points)),
            "forces": floats(forces),
            "largest": largest,
            "hinges": floats(hinges),
        }

    def _resultants(
        self, stacked: Stacked, pressed: Array, tangential: Array
    ) -> tuple[Array, Array]:
        """Size, N, and point, m, of the resultants of the joints of a law.

        From pressing and tangential forces of points, (n_points, n_instants), N.
        Returned are (n_joints, n_instants) and (n_joints, 2, n_instants).
        """
        problem = self._problem
        law = stacked.law
        firsts = np.cumsum(law.sizes) - law.sizes
        _, pairs = np.unique(law.points, return_index=True)
        # Every point has a normal of its own.
        normal, tangent = [
            problem.inside.directions[problem.row_dofs[each.above[pairs]], :2, None]
            for each in law.components
        ]
        forces = normal * pressed[:, None] + tangent * tangential[:, None]
        sums = np.add.reduceat(forces, firsts)
        whole = np.add.reduceat(pressed, firsts)
        weights = _shares_of_points(pressed, whole, law.sizes)
        places = self._positions[problem.row_dofs[law.tangent.above[pairs]]]
        points = np.add.reduceat(places[:, :, None] * weights[:, None], firsts)
        return np.hypot(sums[:, 0], sums[:, 1]), points

    def _lines(self, points: Array) -> Array:
        """Lines of thrust over joints, (n_joints, 3, 2, n_shown), m.

        `points` are those where the resultants act, (n_joints, 2, n_shown), m.
        """
        shape = len(self._middles), *points.shape[1:]
        middles = np.broadcast_to(self._middles[:, :, None], shape)
        if self._is_chain:
            sums = np.zeros(shape)
            counts = np.zeros(shape[0])
            for bodies in (self._above, self._below):
                has_joint = bodies != NONE
                np.add.at(sums, bodies[has_joint], points[has_joint])
                np.add.at(counts, bodies[has_joint], 1.0)
            middles = sums / np.maximum(counts, 1.0)[:, None, None]
        is_body = (self._below != NONE)[:, None, None]
        ends = np.where(is_body, middles[self._below], points)
        return np.stack([middles[self._above], points, ends], axis=1)

    def _middles_of_bodies(self) -> Array:
        """Mean position of the nodes of every body, shape (n_bodies, 2), m."""
        inside = self._problem.inside
        nodes = inside.elements.ravel()
        bodies = np.repeat(inside.bodies, inside.elements.shape[1])
        each = np.unique(np.stack([bodies, nodes], axis=1), axis=0)
        counts = np.bincount(each[:, 0])
        along_x, along_y = inside.nodes[each[:, 1]].T
        sums = [
            np.bincount(each[:, 0], weights=along_x),
            np.bincount(each[:, 0], weights=along_y),
        ]
        return np.asarray(np.stack(sums, axis=1) / counts[:, None])


def _shares_of_points(pressed: Array, whole: Array, sizes: Indices) -> Array:
    """Share of each point in the resultant of its joint, (n_points, n_instants).

    A resultant acts at the mean of the points by their pressing force, (n_points,
    n_instants), N; in the middle of a joint that is open. `whole` are the sums of these
    forces, (n_joints, n_instants), N, `sizes` the numbers of points, (n_joints,).
    """
    divisor = np.repeat(np.where(whole > 0.0, whole, 1.0), sizes, axis=0)
    is_closed = np.repeat(whole > 0.0, sizes, axis=0)
    even = np.repeat(1.0 / sizes, sizes)[:, None]
    return np.where(is_closed, pressed / divisor, even)
