"""Use of a table: a measured loop, results of another program, or a path."""

from __future__ import annotations

import math
from contextlib import suppress
from enum import StrEnum

import numpy as np

from solver.discrete.structure import Axes
from solver.files.tables import Table
from solver.refusal import RefusedError
from solver.settings.scene import Settings
from solver.study.comparison import DISPLACEMENT, FRICTION, OtherResults, results_in
from solver.study.measured_loop import MeasuredLoop, columns_of, loop_in


class Use(StrEnum):
    """Use of a table: a measured loop, results of another program, or a load path."""

    LOOP = "loop"
    RESULTS = "results"
    PATH = "path"


def use_of(table: Table, axes: Axes) -> Use:
    """Use of a table by its head, for a scene whose loop has these axes.

    Results are over positions and times; a table of positions without a time, or with a
    friction force, is of results that lack something. But a position beside another
    force is the position of a machine, if no time occurs twice: then the table is a
    loop, as is every table with the columns of a loop.
    """
    named = [column.quantities[0] for column in table.columns]
    has_position = any("position" in kinds for kinds in named)
    has_friction = any(FRICTION in kinds and "force" not in kinds for kinds in named)
    has_displacement = any(DISPLACEMENT in kinds for kinds in named)
    is_loop = False
    # The same reading decides as later reads the loop.
    with suppress(RefusedError):
        columns_of(table, axes)
        is_loop = True
    # A position beside a force may be that of a testing machine.
    if has_position and (has_friction or not is_loop):
        return Use.RESULTS
    if has_position and not has_displacement and not _times_rise(table):
        return Use.RESULTS
    if is_loop:
        return Use.LOOP
    return Use.PATH


def brought_in(
    table: Table, settings: Settings, axes: Axes
) -> OtherResults | MeasuredLoop:
    """Read results of any size, or else a loop, from a table, for a loop of these axes.

    That takes as long as the table is large: too long for the server of a page.
    """
    if use_of(table, axes) is Use.RESULTS:
        return results_in(table, settings, math.inf)
    return loop_in(table, axes)


def _times_rise(table: Table) -> bool:
    """Check whether rows are in the order of their times, if the table has times."""
    times = [
        column.number for column in table.columns if "time" in column.quantities[0]
    ]
    return len(times) != 1 or bool(np.all(np.diff(table.numbers[times[0]]) > 0.0))
