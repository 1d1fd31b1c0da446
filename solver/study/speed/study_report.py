"""The report of a study: who is first where, tables, and CSV files."""

from __future__ import annotations

import csv
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import astuple
from pathlib import Path

from solver.disk import whole_file
from solver.study.speed.crossover import Crossover
from solver.study.speed.crossover_report import HEAD, crossover_rows
from solver.study.speed.error_against_time import GOAL, INCREMENTAL, LEVELS, MOST_ITERATIONS, Study
from solver.study.speed.growth import Growth

Row = list[str]
TIMES = "Time to an error of the friction force"
TIMES_NOTE = "In brackets: iterations of LATIN."
WINNERS = "Who is first"
WINNERS_NOTE = (
    "The last columns are the time of the best form of LATIN over that of each other solver: below "
    "1, LATIN is quicker."
)
GROWTH_NOTE = (
    "Time of one iteration of LATIN, and of the whole solution by increments. Twice the size takes "
    "2 to the power of the exponent as long (a least-squares fit over all sizes, with its margin "
    "at 95 %)."
)
BILLED = (
    "The time of a method is all that it takes from settings to result: discretisation, "
    "factorisation, the coarser mesh, iterations. Imports and the computation of errors are not "
    "counted.",
    f"The forms of LATIN end at a friction force error of {GOAL:g}, or after {MOST_ITERATIONS} "
    "iterations.",
    "Errors are relative L2 distances over space and time to the result of the incremental solver "
    "on the same mesh and instants, whose own error is therefore 0.",
)


def conditions(study: Study) -> list[str]:
    """Give under which conditions the study was measured, in sentences."""
    changed = study.settings.changed()
    values = ", ".join(f"{name} = {value}" for name, value in changed.items()) or "defaults"
    lines = [
        f"Scene: {study.settings.scene} ({values}).",
        f"Machine: {study.machine}.",
        f"All methods in one process, in turns; medians of {study.repeats} passes.",
        *BILLED,
    ]
    return [*lines, *study.troubles]


def winners(study: Study) -> list[Row]:
    """Say which method is first at each level, and how the best form of LATIN compares."""
    others = [course.method for course in study.courses if course.kind != "latin"]
    head = ["to an error of", "first", "ms", "best form of LATIN", "ms"]
    rows = [[*head, *(f"LATIN / {method}" for method in others)]]
    for name, level in LEVELS.items():
        times = {
            course.method: reached[0]
            for course in study.courses
            if (reached := course.reached(level)) is not None
        }
        first = min(times, key=times.__getitem__)
        forms = {method: seconds for method, seconds in times.items() if method not in others}
        rows.append([name, first, _ms(times[first]), *_best(forms, times, others)])
    return rows


def _best(forms: Mapping[str, float], times: Mapping[str, float], others: Sequence[str]) -> Row:
    """Give the quickest form of LATIN, its time, and that over the times of all others."""
    if not forms:
        return ["none gets there", *("-" for _ in ("ms", *others))]
    best = min(forms, key=forms.__getitem__)
    ratios = (f"{forms[best] / times[one]:.2g}" if one in times else "-" for one in others)
    return [best, _ms(forms[best]), *ratios]


def table(study: Study) -> list[Row]:
    """Give the time to each level, with the iterations in brackets, and what an iteration costs."""
    rows = [["friction force error", *LEVELS, "ms/iteration", "least error"]]
    for course in study.courses:
        cells = []
        for level in LEVELS.values():
            reached = course.reached(level)
            number = f" ({reached[1]:.0f})" if reached and course.kind == "latin" else ""
            cells.append(f"{_ms(reached[0])} ms{number}" if reached else "not reached")
        each = course.seconds_per_iteration
        cost = f"{1e3 * each:.3f}" if each is not None else "-"
        rows.append([course.method, *cells, cost, f"{course.error_force.min():.1e}"])
    return rows


def growth_table(found: Sequence[Growth]) -> list[Row]:
    """Give the fitted exponents, and the iterations to 1 %, with the sizes they come from."""
    rows = [["growth with", "method", "exponent", "sizes", "ms", "iterations to 1 %"]]
    for one in found:
        whole = one.method == INCREMENTAL
        iterations = (str(size.iterations or ">300") for size in one.sizes)
        cells = [
            one.setting,
            f"{one.method} ({'whole' if whole else 'an iteration'})",
            str(one.exponent or "-"),
            " ".join(str(size.size) for size in one.sizes),
            " ".join(f"{1e3 * size.seconds:.2g}" for size in one.sizes),
            "-" if whole else " ".join(iterations),
        ]
        rows += [cells]
    return rows


def write_curves(study: Study, folder: Path) -> list[Path]:
    """Write `curves.csv` and `levels.csv` (s; errors as fractions).

    Raises
    ------
    OSError
        When a file cannot be written.
    """
    return [
        _write(
            folder / "curves.csv",
            ["method", "kind", "step", "seconds", "error_displacement", "error_force"],
            (
                (course.method, course.kind, *map(float, point))
                for course in study.courses
                for point in zip(
                    course.steps,
                    course.seconds,
                    course.error_displacement,
                    course.error_force,
                    strict=True,
                )
            ),
        ),
        _write(
            folder / "levels.csv",
            ["method", "kind", "level", "seconds", "step", "seconds_per_iteration"],
            (
                (
                    course.method,
                    course.kind,
                    level,
                    *(course.reached(level) or ("", "")),
                    course.seconds_per_iteration,
                )
                for course in study.courses
                for level in LEVELS.values()
            ),
        ),
    ]


def write_growth(found: Sequence[Growth], folder: Path) -> list[Path]:
    """Write `growth.csv`, if there is any; raises as `write_curves`."""
    head = ["setting", "exponent", "margin", "method", "size", "seconds"]
    head += ["iterations_to_1_percent", "seconds_to_1_percent"]
    return [_write(folder / "growth.csv", head, _growth_rows(found))] if found else []


def write_map(sizes: Crossover, folder: Path) -> Path:
    """Write `map.csv`; raises as `write_curves`."""
    return _write(folder / "map.csv", HEAD, crossover_rows(sizes))


def _growth_rows(found: Sequence[Growth]) -> Iterator[Sequence[object]]:
    for one in found:
        law = astuple(one.exponent) if one.exponent else ("", "")
        for size in one.sizes:
            yield one.setting, *law, one.method, *astuple(size)


def _write(file: Path, head: Row, rows: Iterable[Sequence[object]]) -> Path:
    with whole_file(file) as open_file:
        writer = csv.writer(open_file)
        writer.writerow(head)
        writer.writerows(rows)
    return file


def _ms(seconds: float) -> str:
    return f"{1e3 * seconds:.3g}"
