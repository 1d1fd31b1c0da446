"""The command `python -m solver fit`: settings under which a run is nearest to a measured loop."""

from __future__ import annotations

import argparse
import json
import sys
import time
from pathlib import Path
from typing import Any

from solver.definitions import SettingError, about
from solver.disk import read_bytes, why
from solver.files import settings_from_command
from solver.remarks import prepared, print_tables
from solver.report_commands import writing
from solver.scenes import loop_of
from solver.settings import Settings
from solver.study.compared_runs import ComparedRun
from solver.study.fit import MOST, fit
from solver.study.fit_report import FILES, as_json, lines, write_fit, write_loop
from solver.study.measured_loop import CAN, axes_of, read_loop

OFTEN = 0.3
"""Seconds between two lines, and files, of how far it is."""


def add_fit(commands: Any) -> None:
    """Add the command."""
    parser = commands.add_parser("fit", help="settings that bring a run nearest to a measured loop")
    parser.add_argument("scene", help="a name of the catalogue, or a saved settings file (.toml)")
    parser.add_argument(
        "--with", type=Path, required=True, metavar="FILE.csv", dest="file", help="measured loop"
    )
    parser.add_argument(
        "--vary",
        required=True,
        metavar="NAME,...",
        help=f"up to {MOST} settings",
    )
    parser.add_argument("--set", action="append", default=[], metavar="NAME=VALUE", dest="changes")
    parser.add_argument("--out", type=Path, default=Path("fit"), metavar="DIR")
    parser.add_argument("--json", action="store_true", help="print what was found as JSON")
    parser.set_defaults(command=_fit)


def _fit(chosen: argparse.Namespace) -> int:
    settings, tables = settings_from_command(chosen.scene, chosen.changes)
    try:
        data = read_bytes(chosen.file)
    except (OSError, ValueError) as trouble:
        raise SettingError("--with", str(chosen.file), CAN, why(trouble)) from None
    problem = prepared(settings, chosen.changes, tables)
    measured = read_loop(data, chosen.file.name, axes_of(loop_of(settings, problem)))
    print_tables({measured.source: measured.message})
    tables = {**tables, measured.source: measured.message}
    names = [name.strip() for name in chosen.vary.split(",")]
    with writing(chosen.out, *FILES):
        found = fit(settings, measured, names, _Progress(settings, names, chosen.out))
        write_loop(found.nearest.run, chosen.out)
        if chosen.json:
            print(json.dumps({**as_json(found, measured), "tables": tables}), flush=True)
        else:
            print("\n".join(lines(found, measured)), flush=True)
        note = write_fit(found, measured, chosen.out)
    if not chosen.json:
        print("\n".join([*filter(None, [note]), f"{', '.join(FILES)} in {chosen.out}"]))
    return 0 if found.nearest.run.solution.is_certified else 1


class _Progress:
    """Print how far it is, and keep the loop of the nearest run so far in the folder."""

    def __init__(self, settings: Settings, names: list[str], folder: Path) -> None:
        self._settings, self._names, self._folder = settings, names, folder
        self._printed = 0.0

    def __call__(self, runs: int, nearest: ComparedRun) -> None:
        now = time.monotonic()
        if now - self._printed < OFTEN:
            return
        self._printed = now
        values = ", ".join(
            f"{name} {value:.4g} {about(self._settings.definitions()[name]).unit}".strip()
            for name, value in zip(self._names, nearest.values, strict=True)
        )
        far = f"{100.0 * nearest.distance:.3g} % away"
        print(f"{runs} runs: {values}, {far}", file=sys.stderr, flush=True)
        write_loop(nearest.run, self._folder)
