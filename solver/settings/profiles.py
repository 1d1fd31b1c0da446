"""Profiles: tables over the position along a body, and their values on a mesh."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from solver.arrays import Array, Indices
from solver.settings.definitions import Rows
from solver.settings.load_paths import interpolate


class Profile(NamedTuple):
    """A preset along a body: its description, and points (share of length, value)."""

    description: str
    points: Rows


UNSEEN = 0.01
"""Largest difference between a table and the line through nodes that needs no remark,
as a share of the table's range."""
STEEP = 1e-8
"""Relative change over a piece below which the mean of the inverse is that of the
middle."""


def _pieces(tables: list[Rows], edges: Array) -> tuple[Array, list[Array], Indices]:
    """Divide intervals at the points of tables, so that tables are linear on pieces.

    `edges` are the ends of the intervals, (n_intervals + 1,), m.

    Returns
    -------
    Ends of the pieces, (n_pieces + 1,), m; values of each table there, (n_pieces + 1,);
    and the first piece of each interval, (n_intervals,).
    """
    points = np.concatenate([np.array(table)[:, 0] for table in tables])
    ends: Array = np.union1d(edges, points[(points > edges[0]) & (points < edges[-1])])
    values = [interpolate(table, ends) for table in tables]
    return ends, values, np.searchsorted(ends, edges[:-1])


def shares_of(nodes: Array) -> Array:
    """Ends of tributary lengths, (n_nodes + 1,), m, halfway between the nodes."""
    return np.concatenate([nodes[:1], nodes[:-1] + 0.5 * np.diff(nodes), nodes[-1:]])


def means(tables: list[Rows], edges: Array) -> Array:
    """Mean of the product of one or two tables on every interval, (n_intervals,).

    `edges` are the ends of the intervals, (n_intervals + 1,), m.
    """
    ends, values, first = _pieces(tables, edges)
    left = math.prod(each[:-1] for each in values)
    right = math.prod(each[1:] for each in values)
    middle = math.prod(0.5 * (each[:-1] + each[1:]) for each in values)
    # Simpson's rule is exact for products of three linear functions.
    whole = np.diff(ends) * (left + 4.0 * middle + right) / 6.0
    return np.asarray(np.add.reduceat(whole, first) / np.diff(edges))


def harmonic_means(table: Rows, edges: Array) -> Array:
    """Harmonic mean of a table on every interval, (n_intervals,).

    `edges` are the ends of the intervals, (n_intervals + 1,), m.
    """
    ends, (values,), first = _pieces([table], edges)
    change = np.diff(values) / values[:-1]
    is_steep = np.abs(change) > STEEP
    # The integral of 1 / (1 + c x) is log(1 + c) / c, whose digits are lost where c is
    # small.
    inverse = np.log1p(change, where=is_steep, out=1.0 - 0.5 * change)
    inverse = np.where(is_steep, inverse / np.where(is_steep, change, 1.0), inverse)
    whole = np.diff(ends) * inverse / values[:-1]
    return np.asarray(np.diff(edges) / np.add.reduceat(whole, first))


def gap_at(table: Rows, nodes: Array) -> Array:
    """Gap at nodes, both of shape (n_nodes,), m, from a table (position, gap).

    A point between two nodes that is lower than both, and so would touch first, counts
    at the nearer node. Slopes and curves that nodes show stay as they are.
    """
    gap = interpolate(table, nodes)
    x, values = np.array(table).T
    inside = (x > nodes[0]) & (x < nodes[-1])
    x = x[inside]
    values = values[inside]
    after = np.searchsorted(nodes, x, side="right").clip(1, len(nodes) - 1)
    is_left = x - nodes[after - 1] <= nodes[after] - x
    # A peak that no node sees would let bodies pass through each other.
    nearer = np.where(is_left, after - 1, after)
    lowest = gap.copy()
    is_lower = values < np.minimum(gap[after - 1], gap[after])
    np.minimum.at(lowest, nearer[is_lower], values[is_lower])
    return lowest


def off_nodes(table: Rows, length: float, pieces: int) -> Array:
    """Distances of a table's points from the line between nodes, (n_points,), m.

    There are as many `pieces` between evenly spaced nodes over the length, m. Points
    outside the length have a distance of zero.
    """
    x, values = np.array(table).T
    nodes = np.linspace(0.0, length, pieces + 1)
    # The run sees the line through the nodes, not the table.
    off = np.abs(np.interp(x, nodes, interpolate(table, nodes)) - values)
    return np.where((x >= 0.0) & (x <= length), off, 0.0)
