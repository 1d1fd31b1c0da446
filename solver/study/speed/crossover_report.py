"""The map of who is first where: as a chart, a table and a sentence."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from solver.study.chart import Map, PanelAxis, Runs
from solver.study.speed.crossover import Crossover, Duel, equal_at

MAP = "Who is first where"
TIMES = "LATIN / incremental solver"


def crossover_map(found: Crossover) -> Map:
    """Draw the ratio of times over size and instants, with the line where both take as long."""
    duels = found.duels
    ratios = np.array([one.ratio for one in duels])
    runs = Runs(
        np.arange(len(duels)),
        np.array([float(one.size) for one in duels]),
        np.array([float(one.instants) for one in duels]),
        ratios,
        np.ones(len(duels), dtype=int),
        np.isfinite(ratios),
        [_said(found, one) for one in duels],
    )
    return Map(
        f"Time of {TIMES}",
        PanelAxis(found.title, logarithmic=True, whole=True),
        PanelAxis("Instants", logarithmic=True, whole=True),
        np.array(found.sizes, dtype=float),
        np.array(found.instants, dtype=float),
        PanelAxis(TIMES, logarithmic=True),
        found.ratios,
        runs,
        level=1.0,
    )


def _said(found: Crossover, one: Duel) -> str:
    where = f"{found.title} {one.size}, {one.instants} instants"
    if one.said:
        return f"{where}: {one.said}"
    times = f"LATIN {1e3 * one.latin:.3g} ms, incremental solver {1e3 * one.incremental:.3g} ms"
    return f"{where}: {one.ratio:.2g} ({times})"


def crossover_table(found: Crossover) -> list[list[str]]:
    """Give the ratios, a row for each number of instants."""
    head = [TIMES, *(f"{found.setting} {size}" for size in found.sizes), "equal at"]
    rows = [head]
    for instants, ratios in zip(found.instants, found.ratios, strict=True):
        even = equal_at(found.sizes, ratios)
        cells = ("-" if np.isnan(ratio) else f"{ratio:.2g}" for ratio in ratios)
        rows.append([f"{instants} instants", *cells, "-" if even is None else f"{even:.2g}"])
    return rows


def crossover_notes(found: Crossover) -> list[str]:
    """Say what the map shows, and what it leaves out, in sentences."""
    ratios = found.ratios[np.isfinite(found.ratios)]
    ahead, everything = int((ratios < 1.0).sum()), ratios.size
    grows = " and ".join([found.title.lower(), *(other.lower() for other in found.others)])
    lines = [
        f"LATIN is ahead (below 1) at {ahead} of {everything} sizes. From settings to a certified "
        "or accurate end, in seconds of the processor, medians of up to three runs in turns.",
    ]
    if found.others:
        lines.append(f"What grows along the axis: {grows}.")
    return [*lines, *(_said(found, one) for one in found.duels if one.said)]


HEAD = ["setting", "size", "instants", "latin", "incremental", "said"]


def crossover_rows(found: Crossover) -> Iterator[Sequence[object]]:
    """Give the rows of `map.csv`, s."""
    for one in found.duels:
        yield found.setting, one.size, one.instants, one.latin, one.incremental, one.said
