"""The command `example`: write a script of `solver/examples` to a folder."""

from __future__ import annotations

import argparse
import ast
from pathlib import Path
from typing import Any

import solver
from solver.commands.console import add_command, refusing
from solver.files.disk import write
from solver.settings.values import SettingError

SCRIPTS = Path(solver.__path__[0]) / "examples"


def add_examples(commands: Any) -> None:
    """Add the command."""
    purpose = "write a short script to start from; list them without a name"
    example = add_command(commands, "example", purpose, _example)
    example.add_argument("name", nargs="?", help="which one; it stands in NAME.py then")


def _example(chosen: argparse.Namespace) -> int:
    scripts = {path.stem: path for path in sorted(SCRIPTS.glob("*.py"))}
    if chosen.name is None:
        for name, path in scripts.items():
            print(f"{name:<18} {_first_line(path)}")
        return 0
    name = chosen.name.removesuffix(".py")
    if name not in scripts:
        raise SettingError("name", name, ", ".join(scripts), "choose one of these")
    target = Path(f"{name}.py")
    allowed = "a file that is not there yet, in a folder that can be written"
    if target.exists():
        remedy = "move it away, or go to another folder"
        raise SettingError("file", str(target), allowed, remedy)
    with refusing(target, allowed):
        write(target, scripts[name].read_text(encoding="utf-8"))
    print(f"{target}: {_first_line(target)}")
    return 0


def _first_line(script: Path) -> str:
    """First line of the docstring of a script."""
    text = ast.get_docstring(ast.parse(script.read_text(encoding="utf-8"))) or ""
    return text.split("\n")[0]
