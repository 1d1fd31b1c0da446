"""Key figures of the page are those of the run, however many instants it has."""

from __future__ import annotations

import pytest

from app.messages import Needs
from app.worker.sampling import MOST_INSTANTS, Sampler
from solver.scenes import CATALOGUE
from solver.study.quantities.finished import figures_of, finished_run, key_figures


def test_a_peak_between_the_instants_that_are_shown_is_shown() -> None:
    """Of 1000 instants 401 are shown: a narrow peak lay between two of them."""
    peak = [[0.3, 200.0], [0.3016, 900.0], [0.303, -700.0], [0.31, 0.0]]
    settings = CATALOGUE["bar"].checked(
        {
            "elements": 6,
            "substructures": 1,
            "instants": 1001,
            "load": [[0.0, 0.0], *peak, [1.0, 0.0]],
        }
    )
    run = finished_run(settings, errors=False, indicators=False)
    sampler = Sampler(run.problem, settings, 1)
    assert len(sampler.columns) < 1.5 * MOST_INSTANTS < run.problem.n_instants
    frame = sampler.frame(
        run.iterate, run.solution.records, run.solution.status, Needs()
    )
    shown = key_figures((frame.run.across, frame.run.up), frame.loop)
    for figure, whole in zip(shown, figures_of(run), strict=True):
        assert figure.largest == pytest.approx(whole.largest, rel=1e-6)
        assert figure.last == pytest.approx(whole.last, rel=1e-6)
