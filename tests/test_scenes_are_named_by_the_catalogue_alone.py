"""No scene, interface or load is named outside `solver/scenes`, but by what its entry says."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path
from typing import get_args, get_type_hints

from solver.discrete.stack.data import SIDES
from solver.discrete.structure import Hold
from solver.scenes import CATALOGUE, discretise, loads_of

ROOT = Path(__file__).resolve().parents[1]
SCENES = "solver/scenes/"
EXPERIMENTS = (
    "solver/study/stability/",
    "solver/study/quantities/memory.py",
    "solver/study/figures/paper_runs.py",
    "solver/study/proof/",
)
"""They measure scenes of their choice."""
READING = "solver/units.py", "solver/columns.py", "solver/curves.py"
"""They read units and quantities by whatever people call them."""
STRUCTURES = "solver/discrete/"
"""Interfaces are made, and so named, there."""
HELD = "views/layout.py", "views/acts.py", "/remarks.py"
"""They draw, or speak of, what holds bodies, by its kind."""


def sources() -> Iterator[tuple[str, ast.AST]]:
    for folder in ("solver", "app"):
        for path in sorted((ROOT / folder).rglob("*.py")):
            name = str(path.relative_to(ROOT))
            if not name.startswith((SCENES, *EXPERIMENTS, *READING)):
                yield name, ast.parse(path.read_text(encoding="utf-8"))


def named(tree: ast.AST, words: set[str]) -> list[str]:
    """Give the words that stand alone as a string."""
    return [
        node.value
        for node in ast.walk(tree)
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and node.value in words
    ]


def test_no_scene_is_named() -> None:
    assert {name: found for name, tree in sources() if (found := named(tree, {*CATALOGUE}))} == {}


def test_no_module_of_a_scene_is_imported() -> None:
    modules = {f"solver.scenes.{scene}" for scene in CATALOGUE}
    imported = {
        name: node.module
        for name, tree in sources()
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom) and node.module in modules
    }
    assert imported == {}


def test_no_interface_is_named() -> None:
    """Sides and loads are those of any body, and what all scenes have is no scene's own."""
    settings = [entry.settings.checked({}) for entry in CATALOGUE.values()]
    interfaces = {name for one in settings for name in discretise(one).interfaces}
    assert {"spring", "contact 1-2"} <= interfaces
    interfaces -= {"load", *SIDES}.union(
        set.intersection(*(set(one.definitions()) for one in settings))
    )
    kinds = set(get_args(get_type_hints(Hold)["kind"]))
    found = {
        name: words
        for name, tree in sources()
        if not name.startswith(STRUCTURES)
        and (words := named(tree, interfaces - kinds if name.endswith(HELD) else interfaces))
    }
    assert found == {}


def test_every_scene_says_what_loads_it_and_nobody_else_does() -> None:
    loads = [loads_of(entry.settings.checked({})) for entry in CATALOGUE.values()]
    assert all(loads)
    words = {name for names in loads for name in names}
    assert {"peak", "slope"} <= words
    assert {name: found for name, tree in sources() if (found := named(tree, words))} == {}
