"""The journal of a sweep: its plan and its rows, line by line, from which it can go on."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import IO, Any

from solver.definitions import SettingError
from solver.study.sweep.plan import Plan
from solver.study.sweep.point import LOST, STUCK, Row

NAME = "sweep.jsonl"


class Journal:
    """Rows that are safe, and where the next ones go.

    Attributes
    ----------
    rows
        By the number of their point.
    """

    def __init__(self, file: IO[str], rows: dict[int, Row]) -> None:
        self._file = file
        self.rows = rows

    @property
    def done(self) -> set[int]:
        """Points that need not be run again; those whose process was ended are."""
        return {number for number, row in self.rows.items() if row.ending not in (STUCK, LOST)}

    def add(self, row: Row) -> None:
        """Keep a row, whatever happens next."""
        self.rows[row.number] = row
        _write(self._file, asdict(row))


@contextmanager
def journal_of(plan: Plan, folder: Path) -> Iterator[Journal]:
    """Open the journal of a plan, in a folder that is there.

    Raises
    ------
    SettingError
        If the folder has the journal of another plan.
    OSError
        If it cannot be read or written.
    """
    path = folder / NAME
    head, *lines = _whole_lines(path) or [None]
    if head is not None and head != plan.plain():
        raise SettingError(
            "--out", str(folder), "a folder of the same sweep, or a new one", "name another"
        )
    rows = {one["number"]: Row(**{**one, "values": tuple(one["values"])}) for one in lines}
    with path.open("a", encoding="utf-8") as file:
        if head is None:
            _write(file, plan.plain())
        yield Journal(file, rows)


def _write(file: IO[str], entry: dict[str, Any]) -> None:
    file.write(json.dumps(entry) + "\n")
    file.flush()


def _whole_lines(path: Path) -> list[Any]:
    """Read all lines, and cut off one that was not written to its end.

    Raises
    ------
    SettingError
        For a file that is no journal.
    """
    if not path.exists():
        return []
    text = path.read_bytes()
    whole = text[: text.rfind(b"\n") + 1]
    try:
        found = [json.loads(line) for line in whole.splitlines()]
    except ValueError:
        raise SettingError("--out", str(path), "the journal of a sweep", "move it away") from None
    if len(whole) < len(text):
        with path.open("r+b") as file:
            file.truncate(len(whole))
    return found
