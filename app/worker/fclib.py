"""One instant of the run as a contact problem for other solvers."""

from __future__ import annotations

import io

from app.worker.references import has_reference
from app.worker.runner import Runner
from solver.refusal import RefusedError
from solver.study.other_programs.fclib import contacts_of, instant_at, local_problem, write_fclib


def fclib_file(runner: Runner, phase: float) -> bytes:
    """The contact problem of an instant, a share of the interval, in FCLIB's format (HDF5).

    Raises
    ------
    RefusedError
        Where the instant is no problem that FCLIB has, or too large for a page.
    """
    settings, problem, iterate = runner.settings, runner.sampler.problem, runner.iterate
    if iterate is None or not has_reference(settings):
        can = "python -m solver fclib writes it"
        raise RefusedError("FCLIB", "so many points of contact", "fewer on a page", can)
    shown = runner.sampler.run
    instant = instant_at(float(shown.instants[shown.column(phase)]), problem.instants)
    local = local_problem(
        contacts_of(problem),
        iterate,
        instant,
        settings.scene,
        certified=iterate.residual is not None,
    )
    file = io.BytesIO()
    write_fclib(file, local)
    return file.getvalue()
