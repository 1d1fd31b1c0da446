"""Draw the rooms of solver and page in floors, as their imports have them.

    python tests/benchmarks/draw_architecture.py [FILE.svg]

A room is a folder, with the packages inside it below its name; files that stand in no
folder share a box on each floor. What starts a program is at the top, all else right
below the lowest that imports it; rooms that import each other stand beside each other.
Arrows go down; those that follow from others are left out.
"""

from __future__ import annotations

import ast
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from graphlib import TopologicalSorter
from html import escape
from itertools import chain
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
TARGET = ROOT / "static" / "architecture.svg"
PACKAGES = ("solver", "app")
COLORS = {"solver": "#d7e3f4", "app": "#f6e3c9"}
"""Of the rooms of a package."""
WIDTH = 1000
FLOOR = 78
HEIGHT = 46
GAP = 12
LETTER = 5.6
"""Widths and heights, pixels; the last is the width of a small letter."""

Graph = dict[str, set[str]]


@dataclass(frozen=True)
class Box:
    """A room, or files of a package, on a floor: their parts as nodes of the graph."""

    package: str
    title: str
    words: str
    parts: frozenset[str]

    @property
    def width(self) -> float:
        """Width that its words need, pixels."""
        return 22 + max(8.0 * len(self.title), LETTER * len(self.words))


def imported(path: Path) -> Iterator[str]:
    """Names of the modules that a file imports, at work or for types."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield node.module
            yield from (f"{node.module}.{alias.name}" for alias in node.names)


def graph_of(root: Path) -> Graph:
    """Rooms and lone files, `PACKAGE.NAME`, with those that each imports."""
    files = {}
    for package in PACKAGES:
        for path in sorted((root / package).rglob("*.py")):
            first = path.relative_to(root / package).parts[0].removesuffix(".py")
            # Scripts of solver/examples are data
            if first not in ("__init__", "examples"):
                files[path] = f"{package}.{first}"
    graph: Graph = {node: set() for node in files.values()}
    for path, node in files.items():
        for name in imported(path):
            other = ".".join(name.split(".")[:2])
            if other in graph and other != node:
                graph[node].add(other)
    return graph


def reached_by(graph: Mapping[str, set[str]]) -> Graph:
    """Nodes that each imports by any way, itself among them."""
    reached = {node: {node} for node in graph}
    grows = True
    while grows:
        grows = False
        for node, others in graph.items():
            sizes = len(reached[node])
            for other in others:
                reached[node] |= reached[other]
            grows = grows or len(reached[node]) > sizes
    return reached


def floors_of(graph: Mapping[str, set[str]]) -> dict[str, int]:
    """Floor of each node, 0 the lowest; those that import each other share one.

    What nothing imports is at the top, all else right below the lowest that imports it.
    """
    reached = reached_by(graph)
    circles = {
        node: frozenset(other for other in reached[node] if node in reached[other])
        for node in graph
    }
    above: dict[frozenset[str], set[frozenset[str]]] = {
        circle: set() for circle in circles.values()
    }
    for node, others in graph.items():
        for other in others - circles[node]:
            above[circles[other]].add(circles[node])
    depths: dict[frozenset[str], int] = {}
    for circle in TopologicalSorter(above).static_order():
        depths[circle] = 1 + max((depths[other] for other in above[circle]), default=-1)
    lowest = max(depths.values())
    return {node: lowest - depths[circles[node]] for node in graph}


def boxes_of(root: Path, floors: Mapping[str, int]) -> list[list[Box]]:
    """Boxes of every floor: lone files of a package are one."""
    found: list[list[Box]] = []
    for floor in range(max(floors.values()) + 1):
        boxes = []
        for package in PACKAGES:
            level = [node for node in sorted(floors) if floors[node] == floor]
            here = [node for node in level if node.startswith(f"{package}.")]
            rooms = [node for node in here if folder_of(root, node).is_dir()]
            lone = [node for node in here if node not in rooms]
            boxes.extend(room(root, package, node) for node in rooms)
            if lone:
                words = ", ".join(node.split(".")[1] for node in lone)
                boxes.append(Box(package, package, words, frozenset(lone)))
        found.append(boxes)
    return found


def folder_of(root: Path, node: str) -> Path:
    """Folder that a node would have."""
    return root.joinpath(*node.split("."))


def room(root: Path, package: str, node: str) -> Box:
    """Box of a folder."""
    words = inner_rooms(folder_of(root, node))
    return Box(package, node.replace(".", "/"), words, frozenset([node]))


def inner_rooms(folder: Path) -> str:
    """Names of the packages inside a folder, those inside them in parentheses."""
    words = []
    for package in sorted(folder.glob("*/__init__.py")):
        name = package.parent.name
        deeper = inner_rooms(package.parent)
        if deeper:
            name = f"{name} ({deeper})"
        words.append(name)
    return ", ".join(words)


def arrows_of(boxes: list[list[Box]], graph: Graph) -> list[tuple[Box, Box]]:
    """Pairs of boxes of which one imports the other, without those by detours."""
    every = list(chain.from_iterable(boxes))
    below: dict[Box, set[Box]] = {}
    lower: list[Box] = []
    for floor in boxes:
        for box in floor:
            used = set(chain.from_iterable(graph[part] for part in box.parts))
            below[box] = {other for other in lower if used & other.parts}
        lower += floor
    reached: dict[Box, set[Box]] = {}
    for box in every:  # from the lowest floor on
        reached[box] = set(below[box])
        for other in below[box]:
            reached[box] |= reached[other]
    arrows = []
    for box in every:
        for other in every:
            detours = (reached[between] for between in below[box] - {other})
            if other in below[box] and not any(other in some for some in detours):
                arrows.append((box, other))
    return arrows


def places_of(boxes: list[list[Box]]) -> dict[Box, tuple[float, int]]:
    """Upper left corner of every box, the highest floor first."""
    places = {}
    for number, floor in enumerate(reversed(boxes)):
        free = WIDTH - sum(box.width for box in floor)
        gap = free / (len(floor) + 1)
        x = gap
        for box in floor:
            places[box] = (x, GAP + FLOOR * number)
            x += box.width + gap
    return places


def drawn_arrow(places: dict[Box, tuple[float, int]], above: Box, below: Box) -> str:
    """Arrow from the foot of a box to the head of another as SVG."""
    x, y = places[above]
    to_x, to_y = places[below]
    x += 0.5 * above.width
    to_x += 0.5 * below.width
    y += HEIGHT
    bend = 0.5 * (to_y - y)
    path = f"M{x:.0f} {y}C{x:.0f} {y + bend:.0f} {to_x:.0f} {to_y - bend:.0f}"
    return (
        f'<path d="{path} {to_x:.0f} {to_y}" fill="none" stroke="#777" '
        'marker-end="url(#end)"/>'
    )


def drawn_box(box: Box, x: float, y: int) -> list[str]:
    """Box with its title and words as SVG."""
    middle = x + 0.5 * box.width
    title_y = y + 28
    if box.words:
        title_y = y + 20
    lines = [
        f'<rect x="{x:.0f}" y="{y}" width="{box.width:.0f}" height="{HEIGHT}" '
        f'rx="6" fill="{COLORS[box.package]}" stroke="#555"/>',
        f'<text x="{middle:.0f}" y="{title_y}" '
        f'font-size="14">{escape(box.title)}</text>',
    ]
    if box.words:
        lines.append(
            f'<text x="{middle:.0f}" y="{y + 37}" font-size="10">'
            f"{escape(box.words)}</text>"
        )
    return lines


def drawn(boxes: list[list[Box]], arrows: list[tuple[Box, Box]]) -> str:
    """Boxes and arrows as SVG."""
    height = FLOOR * len(boxes) + GAP
    places = places_of(boxes)
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" '
        'font-family="sans-serif" text-anchor="middle">',
        "<title>Rooms of solver and page; arrows go to what is imported</title>",
        '<defs><marker id="end" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" '
        'markerHeight="7" orient="auto"><path d="M0 0L8 4L0 8Z" fill="#777"/></marker>'
        "</defs>",
        f'<rect width="{WIDTH}" height="{height}" fill="white"/>',
    ]
    for above, below in arrows:
        lines.append(drawn_arrow(places, above, below))
    for box, (x, y) in places.items():
        lines += drawn_box(box, x, y)
    return "\n".join([*lines, "</svg>", ""])


def main(target: Path = TARGET) -> None:
    """Draw it."""
    graph = graph_of(ROOT)
    boxes = boxes_of(ROOT, floors_of(graph))
    target.write_text(drawn(boxes, arrows_of(boxes, graph)), encoding="utf-8")
    print(target)


if __name__ == "__main__":
    main(*map(Path, sys.argv[1:2]))
