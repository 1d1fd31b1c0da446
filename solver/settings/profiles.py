"""Tables over a place along a body, as a mesh sees them."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from solver.arrays import Array, Indices
from solver.settings.definitions import Rows
from solver.settings.load_paths import interpolate


class Profile(NamedTuple):
    """A preset along a body: a line on it, and points over shares of the length."""

    description: str
    points: Rows


UNSEEN = 0.01
"""Share of its range by which a table may differ between nodes from the line through
them."""
STEEP = 1e-8
"""Relative change over a piece below which the mean of the inverse is that of the
middle."""


def _pieces(tables: list[Rows], edges: Array) -> tuple[Array, list[Array], Indices]:
    """Ends of pieces of shares between points, the tables there, and each share's first piece."""
    points = np.concatenate([np.array(table)[:, 0] for table in tables])
    ends: Array = np.union1d(edges, points[(points > edges[0]) & (points < edges[-1])])
    values = [interpolate(table, ends) for table in tables]
    return ends, values, np.searchsorted(ends, edges[:-1])


def shares_of(nodes: Array) -> Array:
    """Ends of the shares of nodes in a row, which meet half-way, (n_nodes + 1,), of (n_nodes,)."""
    return np.concatenate([nodes[:1], nodes[:-1] + 0.5 * np.diff(nodes), nodes[-1:]])


def means(tables: list[Rows], edges: Array) -> Array:
    """Mean of the product of one or two tables over every share, from their ends, m."""
    ends, values, first = _pieces(tables, edges)
    left = math.prod(one[:-1] for one in values)
    right = math.prod(one[1:] for one in values)
    middle = math.prod(0.5 * (one[:-1] + one[1:]) for one in values)
    # Simpson's rule is exact for products of three linear functions.
    whole = np.diff(ends) * (left + 4.0 * middle + right) / 6.0
    return np.asarray(np.add.reduceat(whole, first) / np.diff(edges))


def harmonic_means(table: Rows, edges: Array) -> Array:
    """Inverse of the mean of the inverse of a table over every share."""
    ends, (values,), first = _pieces([table], edges)
    change = np.diff(values) / values[:-1]
    is_steep = np.abs(change) > STEEP
    inverse = np.log1p(change, where=is_steep, out=1.0 - 0.5 * change)
    inverse = np.where(is_steep, inverse / np.where(is_steep, change, 1.0), inverse)
    whole = np.diff(ends) * inverse / values[:-1]
    return np.asarray(np.diff(edges) / np.add.reduceat(whole, first))


def gap_at(table: Rows, nodes: Array) -> Array:
    """Gap at nodes; a point between two that is lower than both is put at the nearer.

    A slope or a curve that the nodes tell stays as it is: only what would touch first
    and lies between nodes is moved.
    """
    gap = interpolate(table, nodes)
    x, values = np.array(table).T
    inside = (x > nodes[0]) & (x < nodes[-1])
    x = x[inside]
    values = values[inside]
    after = np.searchsorted(nodes, x, side="right").clip(1, len(nodes) - 1)
    is_left = x - nodes[after - 1] <= nodes[after] - x
    nearer = np.where(is_left, after - 1, after)
    lowest = gap.copy()
    is_lower = values < np.minimum(gap[after - 1], gap[after])
    np.minimum.at(lowest, nearer[is_lower], values[is_lower])
    return lowest


def off_nodes(table: Rows, length: float, pieces: int) -> Array:
    """How far points are off the line through evenly spaced nodes, shape (n_points,)."""
    x, values = np.array(table).T
    nodes = np.linspace(0.0, length, pieces + 1)
    off = np.abs(np.interp(x, nodes, interpolate(table, nodes)) - values)
    return np.where((x >= 0.0) & (x <= length), off, 0.0)
