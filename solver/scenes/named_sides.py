"""Conditions on the sides of a mesh, in words: held, moved or loaded.

They stand behind the name of a side in the mesh, as in "left held", or in the setting
`sides`.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import groupby, pairwise
from typing import NamedTuple

import numpy as np

from solver.arrays import Array
from solver.discrete.plane.body import Body, Held, Load
from solver.discrete.plane.makers.named_mesh import NamedMesh, OuterLine
from solver.refusal import LONGEST, RefusedError

CONDITIONS = {
    "free": "nothing acts on it",
    "held": "it moves neither along x nor along y",
    "held x": "it does not move along x",
    "held y": "it does not move along y",
    "moved x": "it moves along x by the displacement",
    "moved y": "it moves along y by the displacement",
    "pulled": "the traction acts outwards on it",
    "pressed": "the pressure acts on it",
}
"""What may happen to a side, and what it means."""
USUAL = {
    "bottom": "held",
    "fixed": "held",
    "top": "moved y",
}
"""What happens to sides of these names if nothing else is said."""
AXES = {
    "held": (0, 1),
    "held x": (0,),
    "held y": (1,),
    "moved x": (0,),
    "moved y": (1,),
}
"""Axes along which a side is held or moved."""
_CONDITION = "|".join(sorted(CONDITIONS, key=len, reverse=True)).replace(" ", "[ _]")
_PHRASE = re.compile(
    rf"(.*?)[\s_]*(?<![^\W_])((?:{_CONDITION})(?:[ _]and[ _](?:{_CONDITION}))*)",
    re.DOTALL | re.IGNORECASE,
)
"""A name and conditions behind it; formats without blanks in names have _ there."""
ALLOWED = f"a name of a side and one or more of {', '.join(CONDITIONS)}, joined by and"


def split_phrase(phrase: str) -> tuple[str, tuple[str, ...]]:
    """Split a phrase into the name of a side and its conditions, if any."""
    match = _PHRASE.fullmatch(phrase.strip())
    if match is None:
        return phrase.strip(), ()
    name, conditions = match.groups()
    words = conditions.lower().replace("_", " ")
    return name or phrase.strip(), tuple(words.split(" and "))


def conditions_of(lines: Sequence[str], given: str) -> Mapping[str, tuple[str, ...]]:
    """Conditions on the sides of a mesh, by the names of its lines, in order.

    Phrases that are `given` between commas go before those in names; where neither says
    anything, sides have the usual condition of their name.

    Raises
    ------
    RefusedError
        For a phrase that is not understood, and a side that does not exist.
    """
    known: dict[str, tuple[str, ...]] = {}
    for line in lines:
        name, conditions = split_phrase(line)
        usual = USUAL.get(name.lower())
        if not conditions and usual:
            conditions = (usual,)
        known[line] = conditions
    names = {split_phrase(line)[0].lower(): line for line in lines}
    for phrase in given.split(","):
        if not phrase.strip():
            continue
        name, conditions = split_phrase(phrase)
        if not conditions:
            remedy = f"write “{name[:LONGEST]} held”, or another of these"
            raise RefusedError("sides", phrase.strip(), ALLOWED, remedy)
        if name.lower() not in names:
            sides = ", ".join(split_phrase(line)[0] for line in lines) or "none"
            shown = repr(name[:LONGEST])
            remedy = f"there is no side {shown}: those of the mesh are {sides}"
            raise RefusedError("sides", phrase.strip(), ALLOWED, remedy)
        known[names[name.lower()]] = conditions
    return known


class _Acted(NamedTuple):
    """A condition on a line on the outside of a body, with a unique name."""

    name: str
    condition: str
    line: OuterLine


@dataclass(frozen=True)
class MeshSides:
    """Sides of a mesh, and the conditions on them by the names of their lines."""

    mesh: NamedMesh
    conditions: Mapping[str, tuple[str, ...]]

    def held(self, drive: Array) -> Iterator[Held]:
        """Yield sides that are held, or moved by `drive`, (n_instants,), m.

        Each node is held once along an axis, by the first of its sides.
        """
        taken: set[tuple[int, int, int]] = set()
        for name, condition, line in self._acted():
            for axis in AXES.get(condition, ()):
                nodes = []
                for node in line.nodes.tolist():
                    if (line.body, node, axis) not in taken:
                        nodes.append(node)
                taken.update((line.body, node, axis) for node in nodes)
                path = np.zeros_like(drive)
                if condition.startswith("moved"):
                    path = drive
                label = name
                if condition == "held":
                    label = f"{name} along {'xy'[axis]}"
                if nodes:
                    yield Held(label, line.body, np.array(nodes), axis, path)

    def loads(
        self, bodies: Sequence[Body], traction: Array, pressure: Array
    ) -> Iterator[Load]:
        """Yield sides that are pulled by the traction or pressed, (n_instants,), Pa.

        Each edge is pulled once and pressed once, by the first of its sides.
        """
        inwards = {"pulled": -traction, "pressed": pressure}
        taken: set[tuple[str, int, frozenset[int]]] = set()
        for name, condition, line in self._acted():
            if condition not in inwards:
                continue
            body = bodies[line.body]
            edges = [frozenset(edge) for edge in pairwise(line.nodes.tolist())]
            is_free = [(condition, line.body, edge) not in taken for edge in edges]
            taken.update((condition, line.body, edge) for edge in edges)
            for number, run in enumerate(_runs(is_free), start=1):
                label = name
                if number > 1:
                    label = f"{name}, part {number}"
                nodes = line.nodes[run.start : run.stop + 1]
                inward = inwards[condition]
                load = Load.of_pressure(label, line.body, body, nodes, inward)
                # It is named as the setting is.
                yield replace(load, pressure=inward)

    def _acted(self) -> Iterator[_Acted]:
        """Yield the conditions on all lines; equal names get numbers."""
        counts: dict[str, int] = {}
        for line in self.mesh.sides:
            bodies = {
                other.body for other in self.mesh.sides if other.name == line.name
            }
            for condition in self.conditions[line.name]:
                # Titles of quantities name a side: "Force on top along y".
                name = split_phrase(line.name)[0]
                if condition in AXES:
                    name = f"{name} {condition.replace('moved', 'along')}"
                if len(bodies) > 1:
                    name = f"{name}, {self.mesh.names[line.body]}"
                counts[name] = counts.get(name, 0) + 1
                if counts[name] > 1:
                    name = f"{name} {counts[name]}"
                yield _Acted(name, condition, line)


def _runs(flags: Sequence[bool]) -> list[range]:
    """Ranges of consecutive set flags, in order."""
    runs = []
    start = 0
    for is_set, run in groupby(flags):
        stop = start + len(list(run))
        if is_set:
            runs.append(range(start, stop))
        start = stop
    return runs
