"""Stacked rectangular bodies as a discrete problem, condensed onto outlines of substructures."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from scipy import sparse

from solver.arrays import Array, Indices
from solver.discrete.bar import substructure_sizes
from solver.discrete.elements import elastic_matrix
from solver.discrete.macro import side_basis
from solver.discrete.plane import Condensed, Kept, Rectangle, both
from solver.discrete.problem import Elasticity, Problem, Scales, Substructure
from solver.discrete.sides import Corner, Place, along, neighbour, nodal_force
from solver.laws import Bodies, Component, Dirichlet, Friction, Interface, Perfect
from solver.scenes.rest import rigid_rest
from solver.scenes.stack import Side, Stack

OPPOSITE = {"right": "left", "top": "bottom"}


@dataclass(frozen=True)
class _Held:
    """Which rows a side of a substructure has: components, and nodes in order along the side."""

    components: tuple[int, ...]
    first: int = 0
    last: int | None = None

    @property
    def span(self) -> slice:
        return slice(self.first, self.last)


@dataclass(eq=False)
class _Part:
    """A substructure as it is made."""

    kept: Kept
    place: Place
    corner: Corner
    nodes: Indices
    held: dict[str, _Held]
    rows: dict[str, Indices]
    force: Array | None

    @property
    def rectangle(self) -> Rectangle:
        return self.kept.condensed.rectangle

    @property
    def dofs(self) -> Indices:
        """What is kept, among the degrees of freedom of all nodes."""
        return both(self.nodes.ravel())[self.kept.dofs]


class StackInside:
    """What lies inside the substructures of a stack, as `problem.Inside` says."""

    def __init__(self, scene: Stack, parts: list[_Part], grid: _Grid, skeleton: Indices) -> None:
        self._parts = parts
        self._young = scene.young
        self._length = scene.length
        self.nodes: Array = grid.positions * scene.length
        self.elements: Indices = np.concatenate(
            [part.nodes.ravel()[part.rectangle.cells] for part in parts]
        )
        self.bodies: Indices = np.repeat(
            [part.place[2] for part in parts],
            [len(part.rectangle.cells) for part in parts],
        )
        self.components: Indices = skeleton % 2
        self._places = [np.searchsorted(skeleton, part.dofs) for part in parts]
        self._size = len(skeleton), len(scene.instants)

    def displacement(self, skeleton: Array, instants: slice | list[int]) -> Array:
        """Give the displacement of all nodes, shape (n_nodes, 2, n), m."""
        chosen = skeleton[:, instants] / self._length
        found = np.zeros((len(self.nodes), 2, chosen.shape[1]))
        for part, places in zip(self._parts, self._places, strict=True):
            force = None if part.force is None else part.force[:, instants]
            found[part.nodes.ravel()] = part.kept.recover(chosen[places], force)
        return found * self._length

    def adjoint(self, weights: Array) -> tuple[Array, Array]:
        """Bring a weighted sum of all nodes' displacements onto the degrees of freedom."""
        found, constant = np.zeros(self._size[0]), np.zeros(self._size[1])
        # Substructures share the nodes on their cuts.
        counts = np.bincount(np.concatenate([part.nodes.ravel() for part in self._parts]))
        shares = weights / counts[:, None]
        for part, places in zip(self._parts, self._places, strict=True):
            own = shares[part.nodes.ravel()].reshape(-1, 1)
            if own.any():
                np.add.at(found, places, part.kept.condense(own)[:, 0])
                if part.force is not None:
                    still = np.zeros((len(places), self._size[1]))
                    inner = part.kept.recover(still, part.force).reshape(len(own), -1)
                    constant += own[:, 0] @ inner
        return found, constant * self._length

    def stress(self, displacement: Array) -> Array:
        """Give stresses (xx, yy, xy) at element centres, shape (n_elements, 3), Pa."""
        scaled = displacement / self._length
        return self._young * np.concatenate(
            [part.rectangle.stress(scaled[part.nodes.ravel()]) for part in self._parts]
        )


class _Grid:
    """Nodes of all bodies, and where they are cut."""

    def __init__(self, scene: Stack) -> None:
        columns, rows = (scene.order * number for number in scene.elements)
        bodies = scene.bodies
        self.nodes = np.arange(bodies * (rows + 1) * (columns + 1)).reshape(
            bodies, rows + 1, columns + 1
        )
        height = scene.height / scene.length
        x = np.linspace(0.0, 1.0, columns + 1)
        y = np.arange(bodies)[:, None] * height + np.linspace(0.0, height, rows + 1)
        everywhere = np.broadcast_arrays(x, y[:, :, None])
        self.positions = np.stack(everywhere, axis=-1).reshape(-1, 2)
        across, up = (
            scene.order * np.concatenate([[0], np.cumsum(substructure_sizes(number, cuts))])
            for number, cuts in zip(scene.elements, scene.substructures, strict=True)
        )
        self.cuts = across, up


def discretise_stack(scene: Stack) -> Problem:
    """Cut the bodies into rectangles and write the laws of their interfaces.

    Lengths are scaled by the length of a body, stresses by E. Search direction: E / l_sub per
    area, with l_sub the geometric mean of a substructure's sides, for cuts, contacts and
    supports alike (the paper's ES / l_sub). Tractions act on the substructures themselves, and
    need no interface. Contact forces are lumped at the nodes.
    """
    grid = _Grid(scene)
    parts = _parts(scene, grid)
    first = 0
    for part in parts:
        for side, held in part.held.items():
            width = len(held.components)
            size = width * len(part.rectangle.edge(side)[held.span])
            part.rows[side] = np.arange(first, first + size).reshape(-1, width)
            first += size
    shared: dict[tuple[object, ...], Elasticity] = {}
    skeleton = np.unique(np.concatenate([part.dofs for part in parts]))
    return Problem(
        substructures=tuple(_substructure(scene, part, skeleton, shared) for part in parts),
        interfaces=dict(_interfaces(scene, {part.place: part for part in parts})),
        positions=grid.positions[skeleton // 2] * scene.length,
        instants=scene.instants,
        scales=Scales(scene.length, scene.young * scene.length, scene.duration),
        inside=StackInside(scene, parts, grid, skeleton),
        rest=_rest(scene, grid.positions[skeleton // 2], skeleton % 2),
    )


def _rest(scene: Stack, positions: Array, components: Indices) -> Array | None:
    """Give the displacement of degrees of freedom where the body rests, (n_dofs, n_instants)."""
    rigid = rigid_rest(scene)
    if rigid is None:
        return None
    x, y = positions.T
    modes = np.stack([components, np.where(components == 1, x, -y)], axis=1)
    return np.asarray(modes @ (rigid / np.array([[scene.length], [1.0]])))


def _parts(scene: Stack, grid: _Grid) -> list[_Part]:
    across, up = grid.cuts
    width = 1.0 / scene.elements[0]
    height = scene.height / scene.length / scene.elements[1]
    shapes: dict[tuple[int, int, float], Condensed] = {}
    kinds: dict[tuple[object, ...], Kept] = {}
    parts = []
    for body in range(scene.bodies):
        for row in range(scene.substructures[1]):
            for column in range(scene.substructures[0]):
                x, y = across[column], up[row]
                span = int(across[column + 1] - x), int(up[row + 1] - y)
                shape = *span, float(scene.stiffness[body])
                if shape not in shapes:
                    elastic = elastic_matrix(shape[2], scene.poisson, scene.state)
                    size = span[0] // scene.order, span[1] // scene.order
                    rectangle = Rectangle(*size, width, height, elastic, scene.order)
                    shapes[shape] = Condensed(rectangle)
                nodes = grid.nodes[body, y : y + span[1] + 1, x : x + span[0] + 1]
                place = column, row, body
                held = {
                    side: found
                    for side in ("left", "right", "bottom", "top")
                    if (found := _held(scene, place, side)).components
                }
                kind = shape, *held.items()
                if kind not in kinds:
                    kinds[kind] = _kept(shapes[shape], held)
                force = nodal_force(scene, shapes[shape].rectangle, place, (int(x), int(y)))
                parts.append(_Part(kinds[kind], place, (int(x), int(y)), nodes, held, {}, force))
    return parts


def _kept(condensed: Condensed, held: dict[str, _Held]) -> Kept:
    edges = [
        (2 * condensed.rectangle.edge(side)[one.span, None] + np.array(one.components)).ravel()
        for side, one in held.items()
    ]
    return Kept(condensed, np.unique(np.concatenate(edges)))


def _held(scene: Stack, place: Place, side: str) -> _Held:
    """Tell which rows a side has: all at an interface, or those of prescribed components.

    A contact has none at an end where the left or right side prescribes the normal displacement:
    any pressing force would be a solution there, and so would any friction up to it.
    """
    beyond = neighbour(scene, place, side)
    if beyond == "support" or (not isinstance(beyond, str) and beyond[2] != place[2]):
        first = place[0] == 0 and scene.sides["left"].y.prescribed
        last = place[0] == scene.substructures[0] - 1 and scene.sides["right"].y.prescribed
        return _Held((0, 1), 1 if first else 0, -1 if last else None)
    if not isinstance(beyond, str):
        return _Held((0, 1))
    given = scene.sides[beyond]
    return _Held(tuple(place for place, one in enumerate((given.x, given.y)) if one.prescribed))


def _substructure(
    scene: Stack, part: _Part, skeleton: Indices, shared: dict[tuple[object, ...], Elasticity]
) -> Substructure:
    rectangle = part.rectangle
    modulus = float(scene.stiffness[part.place[2]])
    density = modulus / np.sqrt(
        rectangle.columns * rectangle.width * rectangle.rows * rectangle.height
    )
    trace, direction = [], []
    for side, held in part.held.items():
        dofs = 2 * rectangle.edge(side)[held.span, None] + np.array(held.components)
        trace.append(np.searchsorted(part.kept.dofs, dofs.ravel()))
        weights = rectangle.edge_weights(side)[held.span]
        direction.append(density * np.repeat(weights, len(held.components)))
    found = Elasticity(part.kept.stiffness, np.concatenate(trace), np.concatenate(direction))
    # Members of a group have body forces on all or on none, and see the same macro forces.
    macro = [not isinstance(neighbour(scene, part.place, side), str) for side in part.held]
    key = id(part.kept), part.force is not None, *macro
    return Substructure(
        elasticity=shared.setdefault(key, found),
        dofs=np.searchsorted(skeleton, part.dofs),
        rows=np.concatenate([rows.ravel() for rows in part.rows.values()]),
        body_force=None if part.force is None else part.kept.condense(part.force),
    )


def _interfaces(scene: Stack, parts: dict[Place, _Part]) -> Iterable[tuple[str, Interface]]:
    yield from _contacts(scene, parts)
    for place, part in parts.items():
        for side, opposite in OPPOSITE.items():
            beyond = neighbour(scene, place, side)
            if isinstance(beyond, str) or beyond[2] != place[2]:
                continue
            other = parts[beyond]
            basis = np.asarray(np.kron(_macro_basis(scene, part, side), np.eye(2)))
            yield (
                f"cut {_name(place)} to {_name(beyond)}",
                Perfect(part.rows[side].ravel(), other.rows[opposite].ravel(), basis),
            )
    for side, given in scene.sides.items():
        yield from _prescribed(scene, parts, side, given)


def _name(place: Place) -> str:
    column, row, body = place
    return f"{column + 1}.{row + 1}" + (f" of {body + 1}" if body else "")


def _macro_basis(scene: Stack, part: _Part, side: str) -> Array:
    return side_basis(part.rectangle, side, len(part.rows[side]), scene.macro_degree)


def _contacts(scene: Stack, parts: dict[Place, _Part]) -> Iterable[tuple[str, Friction]]:
    columns, rows = scene.substructures
    x = np.linspace(0.0, scene.length, scene.order * scene.elements[0] + 1)
    for body in range(scene.bodies):
        if body == 0 and scene.support is None:
            continue
        above = [parts[column, 0, body] for column in range(columns)]
        under = [parts[column, rows - 1, body - 1] for column in range(columns)] if body else None
        spans = [part.held["bottom"].span for part in above]
        places = [part.corner[0] + np.arange(part.nodes.shape[1]) for part in above]
        weights = [part.rectangle.edge_weights("bottom") for part in above]
        node = np.concatenate([own[span] for own, span in zip(places, spans, strict=True)])
        found, points = np.unique(node, return_inverse=True)
        if body == 0 and scene.support is not None:
            friction, gap = scene.support.friction, scene.support.gap[node] / scene.length
        else:
            friction, gap = scene.friction, np.zeros(len(node))
        upper = np.concatenate([part.rows["bottom"] for part in above])
        lower = None if under is None else np.concatenate([part.rows["top"] for part in under])
        # Of dense blocks SciPy 1.18 makes a matrix with a warning, and later versions an array.
        bases = [sparse.coo_array(_macro_basis(scene, part, "bottom")) for part in above]
        yield (
            "support" if body == 0 else f"contact {body}-{body + 1}",
            Friction.of_contact(
                normal=Component(upper[:, 1], None if lower is None else lower[:, 1]),
                tangent=Component(upper[:, 0], None if lower is None else lower[:, 0]),
                points=points,
                positions=x[found],
                weights=scene.length
                * np.concatenate([own[span] for own, span in zip(weights, spans, strict=True)]),
                gap=gap,
                friction=np.full(len(node), friction),
                around=Bodies(
                    moduli=(
                        float(scene.stiffness[body]),
                        np.inf if lower is None else float(scene.stiffness[body - 1]),
                    ),
                    depth=scene.height,
                ),
                macro=None if lower is None else sparse.csr_array(sparse.block_diag(bases)),
            ),
        )


def _prescribed(
    scene: Stack, parts: dict[Place, _Part], side: str, given: Side
) -> Iterable[tuple[str, Dirichlet]]:
    rows, values = [], []
    for place, part in parts.items():
        if neighbour(scene, place, side) != side or side not in part.held:
            continue
        for number, component in enumerate(part.held[side].components):
            one = (given.x, given.y)[component]
            rows.append(part.rows[side][:, number])
            where = along(scene, part.rectangle, place, part.corner, side, one)
            found = one.mean + where * one.slope
            if side in ("left", "right"):
                _settle_corners(scene, place, side, component, found)
            values.append(found / scene.length)
    if rows:
        yield side, Dirichlet(np.concatenate(rows), np.concatenate(values))


def _settle_corners(scene: Stack, place: Place, side: str, component: int, found: Array) -> None:
    """Let a corner have one displacement, that of the top or bottom, if both sides prescribe it."""
    for level, node in (("bottom", 0), ("top", -1)):
        if neighbour(scene, place, level) != level:
            continue
        other = (scene.sides[level].x, scene.sides[level].y)[component]
        if other.prescribed:
            sign = 1.0 if side == "right" else -1.0
            found[node] = other.mean + sign * other.slope
