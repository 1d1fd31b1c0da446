"""The command line: its parser, exit codes, and the lists of scenes and settings."""

from __future__ import annotations

import argparse
import contextlib
import json
import os
import sys
from collections.abc import Sequence
from importlib.metadata import entry_points, version
from pathlib import Path

from solver.commands.console import INTERRUPTED, add_command, warn
from solver.commands.examples import add_examples
from solver.commands.reports import add_reports
from solver.commands.runs import add_checks
from solver.commands.single_run import add_run
from solver.files.disk import why
from solver.files.saved import scene_settings
from solver.reference.assembly import NoReferenceError
from solver.refusal import RefusedError
from solver.scenes import CATALOGUE
from solver.settings.definitions import lines_of, properties_of
from solver.settings.values import allowed

DESCRIPTION = (
    "Commands of `python -m solver`: run a scene, list what there is, measure, draw "
    "figures."
)
REFUSED = 2
OUT_OF_MEMORY = 3
"""Exit codes."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Exit code of one command.

    0: converged. 1: stopped otherwise. 2: refused input. 3: out of memory. 130: ended
    by Ctrl-C.
    """
    try:
        return _exit_code(arguments)
    except KeyboardInterrupt:
        warn("ended; files that are written stay")
        return INTERRUPTED


def _exit_code(arguments: Sequence[str] | None) -> int:
    """Run a command; errors that a user can correct become messages, exit codes."""
    parser = _parser()
    chosen, options = parser.parse_known_args(arguments)
    if options and not hasattr(chosen, "passed_on"):
        parser.error(f"unrecognized arguments: {' '.join(options)}")
    chosen.passed_on = options
    if sys.stdout is None:
        print(
            "slipfront: nothing can be printed: standard output is closed",
            file=sys.stderr,
        )
        return REFUSED
    code = 0
    try:
        code = chosen.command(chosen)
        sys.stdout.flush()
    except RefusedError as refusal:
        warn(str(refusal))
        return REFUSED
    except NoReferenceError as refusal:
        warn(f"there is nothing to compare with: {refusal}")
        return REFUSED
    except OSError as trouble:
        # Python would complain at its exit if the reader is gone, as of "| head".
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        if not isinstance(trouble, BrokenPipeError):
            warn(f"nothing can be printed: {why(trouble)}")
            return REFUSED
    except MemoryError:
        remedy = "take a coarser mesh or fewer instants, or for `run` --no-reference"
        warn(f"this takes more memory than there is: {remedy}")
        return OUT_OF_MEMORY
    return code


def _parser() -> argparse.ArgumentParser:
    """Make the parser of all commands, those of other installed packages included."""
    prog = "python -m solver"
    if Path(sys.argv[0]).stem == "slipfront":
        prog = "slipfront"
    parser = argparse.ArgumentParser(prog=prog, description=DESCRIPTION)
    parser.add_argument(
        "--version", action="version", version=f"slipfront {version('slipfront')}"
    )
    commands = parser.add_subparsers(required=True)
    add_run(commands)
    add_command(commands, "scenes", "list the scenes", _scenes)
    settings = add_command(
        commands, "settings", "list the settings of a scene", _settings
    )
    settings.add_argument("scene")
    add_reports(commands)
    add_checks(commands)
    add_examples(commands)
    for further in entry_points(group="slipfront.commands"):
        with contextlib.suppress(ImportError):  # the package of the page may be missing
            further.load()(commands)
    return parser


def _scenes(_chosen: argparse.Namespace) -> int:
    """List the scenes."""
    for name, kind in CATALOGUE.items():
        print(f"{name:<10} {kind.title} ({kind.source})")
    return 0


def _settings(chosen: argparse.Namespace) -> int:
    """List the settings of a scene, with units, defaults, values and help."""
    kind = scene_settings(chosen.scene)
    definitions = kind.definitions()
    of_paper = kind.defaults("paper")
    width = max(len(name) for name in definitions) + 1
    for name, definition in definitions.items():
        unit = properties_of(definition).unit or "-"
        default = json.dumps(definition.default)
        if of_paper[name] != definition.default:
            default += f" (method=paper: {json.dumps(of_paper[name])})"
        print(f"{name:<{width}} {unit:<5} default {default:<10} {allowed(definition)}")
        print(f"{'':<{width}} {definition.doc}")
        for line in lines_of(definition):
            print(f"{'':<{width}}   {line}")
    return 0
