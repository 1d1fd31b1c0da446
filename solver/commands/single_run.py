"""The command `run`: one scene, its key figures, and its result file."""

from __future__ import annotations

import argparse
import contextlib
import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from solver.commands.console import (
    SECONDS,
    add_command,
    announce,
    given,
    names_in,
    number_in,
    print_json,
    refusing,
    warn,
)
from solver.discrete import Problem
from solver.discrete.problem import is_unloaded
from solver.files.disk import check_place
from solver.files.paraview import PARAVIEW, check_plane, write_series
from solver.files.results import save_result, summary
from solver.latin import Ending, Solution, solve, solve_in_slabs
from solver.latin.stages.blocks import one_blas_thread
from solver.reference.distance import distance_to, held_instants
from solver.scenes import discretise
from solver.scenes.method import method_of
from solver.settings.scene import Settings
from solver.settings.values import SettingError
from solver.study.known_reference import KnownReference, known_reference
from solver.study.quantities import QUANTITIES, reading
from solver.study.quantities.finished import FinishedRun, KeyFigure, figures_of
from solver.study.quantities.quantity import Quantity, written

RESULTS = ".npz", PARAVIEW
"""Ends of the names of result files."""
CAN_BE_WRITTEN = "a file in an existing folder that can be written"
OF_WHOLE_RUN = ("slipped_share", "dissipation")
"""Quantities of the whole run, which are printed beside the key figures of the loop."""


def add_run(commands: Any) -> None:
    """Add `run`."""
    run = add_command(
        commands, "run", "run one scene to its stop rule", _run, of_scene=True
    )
    run.add_argument(
        "--out",
        type=Path,
        metavar="FILE.npz",
        help="write the result here; of a scene in the plane as FILE.pvd for ParaView",
    )
    run.add_argument(
        "--json", action="store_true", help="print the key figures as JSON"
    )
    run.add_argument(
        "--no-reference",
        action="store_false",
        dest="reference",
        help="do without errors, and without the time of the incremental solver",
    )
    run.add_argument(
        "--limit",
        metavar="SECONDS",
        help="end after so long with what there is by then; the reference is given up "
        "likewise",
    )
    run.add_argument(
        "--slab",
        metavar="INSTANTS",
        help="solve slab after slab of this number of instants, as those of a cycle of "
        "a load with many",
    )
    run.add_argument(
        "--of",
        action="append",
        default=[],
        metavar="NAME,...",
        help="print quantities of the run, too",
    )


def _run(chosen: argparse.Namespace) -> int:
    """Run a scene to its stop rule; print its key figures, and write its result."""
    limit = number_in(chosen, "limit", SECONDS, "s", above=0.0)
    if limit is None:
        limit = math.inf
    can = "a number of instants from 1"
    slab = number_in(chosen, "slab", can, above=0, is_whole=True)
    asked = [reading(name) for name in names_in(chosen.of) if name]
    if chosen.out is not None:
        _check_result_file(chosen.out)
    settings, tables = given(chosen)
    began = time.perf_counter()
    problem = discretise(settings)
    spent = time.perf_counter() - began
    for_paraview = chosen.out is not None and chosen.out.suffix == PARAVIEW
    if for_paraview:
        check_plane(problem.inside, chosen.out)
    if is_unloaded(problem):
        warn("nothing acts on the structure: all loads are zero")
    announce(settings, problem, reference=chosen.reference, limit=limit)
    if chosen.reference:
        known = _known(problem, limit)
    else:
        known = KnownReference()
    solution = _solved(chosen, settings, problem, known, asked, limit, slab, spent)
    if chosen.out is not None:
        with refusing(chosen.out, CAN_BE_WRITTEN):
            if for_paraview:
                write_series(chosen.out, solution.iterate)
            else:
                save_result(chosen.out, settings, solution)
    _warn_of_loose_bodies(solution)
    with contextlib.suppress(BrokenPipeError):  # the reader needs no more
        run = FinishedRun(settings, solution, known_loss=known.lost_from)
        _print_figures(run, asked, tables, chosen.json)
    return 0 if solution.status.ending is Ending.CONVERGED else 1


def _check_result_file(out: Path) -> None:
    """Refuse a result file that cannot be written, before the run and not after it."""
    if out.suffix not in RESULTS and not out.is_dir():
        raise SettingError(
            "--out", str(out), "FILE.npz, or FILE.pvd for ParaView", "end it so"
        )
    with refusing(out, CAN_BE_WRITTEN):
        check_place(out)


def _solved(
    chosen: argparse.Namespace,
    settings: Settings,
    problem: Problem,
    known: KnownReference,
    asked: Sequence[Quantity],
    limit: float,
    slab: int | None,
    spent: float,
) -> Solution:
    """Solve a problem as a whole or in slabs, with errors to a known reference.

    `spent` is the time that the problem took to make, s.
    """
    method = method_of(settings)
    method = replace(method, stop=replace(method.stop, seconds=limit))
    distance = None
    if known.reference is not None:
        distance = distance_to(known.reference, problem)
    if slab is not None:
        return solve_in_slabs(problem, method, slab, distance=distance, spent=spent)
    reads_indicators = any(quantity.reads == "indicators" for quantity in asked)
    watch = chosen.reference or reads_indicators
    return solve(problem, method, distance=distance, watch=watch, spent=spent)


def _warn_of_loose_bodies(solution: Solution) -> None:
    """Warn of instants at which the position of a body is not determined."""
    iterate = solution.iterate
    # Matrices are small: threads that wait for each other take longer than the run.
    with one_blas_thread:
        held = held_instants(iterate.problem, iterate.contact_force)
    count = int((~held).sum())
    if count:
        warn(
            f"at {count} of {iterate.problem.n_instants} instants nothing says where a "
            "body lies: its displacement is one of many there, and counts in no error"
        )


def _print_figures(
    run: FinishedRun,
    asked: Sequence[Quantity],
    tables: Mapping[str, str],
    as_json: bool,
) -> None:
    """Print the results of a run; no key figures if the solution ends early."""
    figures = summary(run.settings, run.solution)
    of_loop: Sequence[KeyFigure] = ()
    of_run: Sequence[Quantity] = ()
    if run.lost_from is None:
        of_loop = figures_of(run)
        of_run = [QUANTITIES[name] for name in OF_WHOLE_RUN]
    else:
        figures["lost_from"] = _loss(run.problem, run.lost_from)
    if not as_json:
        _print_lines(figures)
        for figure in of_loop:
            print(f"{figure.name:<20} {_in_words(run, figure)}")
        for quantity in of_run:
            number = written(quantity(run), quantity.unit)
            print(f"{quantity.name:<20} {number} ({quantity.title}, whole run)")
        for quantity in asked:
            print(f"{quantity.name:<20} {written(quantity(run), quantity.unit)}")
        return
    figures |= {figure.name: figure.largest for figure in of_loop}
    figures |= {quantity.name: quantity(run) for quantity in of_run}
    figures["key_figures"] = {
        figure.name: _key_figure_entry(run, figure) for figure in of_loop
    }
    if asked:
        values = {quantity.name: quantity(run) for quantity in asked}
        figures["quantities"] = values
        # JSON has no infinity: null alone would say that a run has no such value.
        figures["never"] = [name for name in values if math.isinf(values[name])]
    figures["tables"] = tables
    figures["settings"] = run.settings.values()
    print_json(figures)


def _print_lines(figures: Mapping[str, object]) -> None:
    """Print figures by name, each entry of a list on a line of its own."""
    for name, value in figures.items():
        entries = [value]
        if isinstance(value, list):
            entries = value
        for entry in entries:
            shown = entry
            if isinstance(entry, float):
                shown = f"{entry:.6g}"
            print(f"{name:<20} {shown}")


def _loss(problem: Problem, first: int) -> float:
    """Warn that there is no solution from an instant on; return that time, s."""
    count = problem.n_instants
    time_lost = float(problem.instants[first])
    lost = f"no solution is found at {count - first} of {count} instants"
    warn(f"no key figures are told: {lost}, from {time_lost:.4g} s on")
    return time_lost


def _in_words(run: FinishedRun, figure: KeyFigure) -> str:
    """Text of a key figure: its largest value with its time, and its last value."""
    at = f"at {run.problem.instants[figure.instant]:.6g} s"
    largest = written(figure.largest, figure.unit)
    last = written(figure.last, figure.unit)
    return f"{largest} ({figure.title}, largest, {at}; last {last})"


def _key_figure_entry(run: FinishedRun, figure: KeyFigure) -> dict[str, object]:
    """Entry of a key figure in JSON: largest value, its time, s, and last value."""
    return {
        "title": figure.title,
        "unit": figure.unit,
        "largest": figure.largest,
        "largest_at": float(run.problem.instants[figure.instant]),
        "last": figure.last,
    }


def _known(problem: Problem, limit: float) -> KnownReference:
    """Find the reference within a time limit, s; warn if there is none, or doubt."""
    end = time.perf_counter() + limit
    known = known_reference(problem, lambda: time.perf_counter() > end)
    if known.reference is None:
        warn(f"no errors are known: {known.doubt}")
    elif known.doubt:
        warn(f"{known.doubt}; errors are to one of them")
    return known
