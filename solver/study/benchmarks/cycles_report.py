"""What many cycles cost, as a table, a CSV file and a page with its chart."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np

from solver.disk import whole_file
from solver.running.machine import machine
from solver.study.benchmarks.ahead import GOAL, MOST
from solver.study.benchmarks.cycles import (
    FIRST,
    LONGEST,
    MODES,
    WAYS,
    Cycles,
    Taken,
    cycles_of,
)
from solver.study.benchmarks.cycles_problems import INSTANTS, CyclesProblem
from solver.study.chart import Panel, PanelAxis, PanelCurve
from solver.study.page import PlotSection, Section, bullets, plain_table, write_page

Found = dict[str, list[Cycles]]
"""By the problem's label."""
TITLE = "Speed-up over the number of cycles"
FULL, PGD, SLABS, PGD_SLABS = (way.name for way in WAYS)
SPEED_UPS = (("", PGD), (FULL, PGD), ("", SLABS), (FULL, SLABS), ("", PGD_SLABS), (FULL, PGD_SLABS))
"""Over what, and of what."""
WIDTHS = (7, 9, *(19 for _ in WAYS), *(10 for _ in SPEED_UPS))
NOTES = (
    f"Cycles of {INSTANTS} instants. Iterations and seconds of the processor until the contact "
    f"force is within {100 * GOAL:.0f} % of the incremental solver's over all instants, from the "
    "discrete problem on, with nothing that judges iterates; medians, in turns.",
    "In slabs: a cycle after the other, each from the fields, or the bases, of the one before; "
    f"the first to {100 * FIRST * GOAL:.2g} %, as its error goes on into the next.",
    f"LATIN-PGD: at most {MODES} modes of a substructure. Beside the iterations: the share of the "
    "local stage in the time. - is not there after "
    f"{MOST} iterations or {LONGEST:.0f} s, and not tried with more cycles.",
    "Last columns: speed-up S, the time of the one over that of the other; sl.: in slabs, incr.: "
    "the incremental solver.",
)


def measured(problems: Iterable[CyclesProblem], numbers: Sequence[int], repeats: int) -> Found:
    """Measure problems and print a row for each number of cycles as soon as it is there."""
    print(machine())
    print(f"medians of {repeats}, of long runs one; each row in a process of its own")
    found: Found = {}
    for problem in problems:
        print(f"\n{problem.label}\n{_aligned(_head())}")
        rows = found.setdefault(problem.label, [])
        ways = [way.name for way in WAYS]
        for number in (one for one in numbers if one <= problem.most):
            rows.append(cycles_of(problem, number, repeats, ways))
            ways = [name for name in ways if math.isfinite(rows[-1].taken[name].seconds)]
            print(_aligned(_cells(rows[-1])), flush=True)
    print("", *NOTES, sep="\n")
    return found


def _head() -> list[str]:
    ratios = (f"S {other or 'incr.'}/{way}" for other, way in SPEED_UPS)
    return ["cycles", "incr., s", *(way.name for way in WAYS), *(_short(one) for one in ratios)]


def _short(text: str) -> str:
    return text.replace("LATIN-PGD", "PGD").replace(" in slabs", " sl.").replace("S ", "")


def _cells(row: Cycles) -> list[str]:
    ratios = (_number(row.over(other, way)) for other, way in SPEED_UPS)
    ways = (_way(row.taken[way.name]) for way in WAYS)
    return [str(row.number), _number(row.incremental), *ways, *ratios]


def _way(taken: Taken) -> str:
    if math.isnan(taken.seconds):
        return "-"
    return f"{taken.iterations:.0f} in {taken.seconds:.2g}, {100 * taken.local:.0f} %"


def _number(value: float) -> str:
    return "-" if math.isnan(value) else f"{value:.2g}"


def _aligned(cells: Sequence[str]) -> str:
    return " ".join(cell.ljust(width) for cell, width in zip(cells, WIDTHS, strict=True)).rstrip()


def speed_up_panels(found: Found) -> list[Panel]:
    """Draw the speed-ups over the number of cycles, a panel for each problem."""
    return [
        Panel(
            label,
            PanelAxis("Cycles", logarithmic=True, whole=True),
            PanelAxis("Speed-up S", logarithmic=True),
            (
                PanelCurve("as long", _of_all(rows), np.ones(len(rows)), 0, "dashed"),
                *(
                    PanelCurve(
                        f"{way} over {other or 'the incremental solver'}",
                        _of_all(rows),
                        np.array([row.over(other, way) for row in rows]),
                        hue,
                        "points",
                    )
                    for hue, (other, way) in enumerate(SPEED_UPS, 1)
                ),
            ),
        )
        for label, rows in found.items()
    ]


def _of_all(rows: Sequence[Cycles]) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    return np.array([float(row.number) for row in rows])


def write_cycles(found: Found, folder: Path) -> tuple[list[Path], str]:
    """Write `cycles.csv` and `cycles.html`; give the files, and what there is to be told.

    Raises
    ------
    OSError
        When a file cannot be written.
    """
    numbers, page = folder / "cycles.csv", folder / "cycles.html"
    with whole_file(numbers) as open_file:
        writer = csv.writer(open_file)
        writer.writerow(["problem", "cycles", "way", *Taken.__dataclass_fields__])
        for label, rows in found.items():
            for row in rows:
                writer.writerow([label, row.number, "incremental solver", row.incremental])
                for name, taken in row.taken.items():
                    writer.writerow([label, row.number, name, *map(_plain, vars(taken).values())])
    tables = [
        f"<h2>{label}</h2>\n{plain_table([_head(), *map(_cells, rows)])}"
        for label, rows in found.items()
    ]
    charts = PlotSection(TITLE, speed_up_panels(found))
    report: list[Section] = [charts, *tables, bullets([machine(), *NOTES])]
    return [numbers, page], write_page(page, TITLE, report)


def _plain(value: float) -> float | str:
    return "" if math.isnan(value) else value
