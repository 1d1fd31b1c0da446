"""The paper's figures as the page draws them."""

from __future__ import annotations

import sys

import numpy as np
import pytest

from app.views import paper_figures
from app.views.panels import overlay
from app.views.paper_figures import PaperFigures, compute


@pytest.fixture(scope="module")
def figures():
    return compute().result(60)


def test_they_are_computed_once(figures):
    assert compute().result(0) is figures
    assert [figure.number for figure in figures] == [3, 4, 5, 6, 7, 8]


def test_every_curve_is_drawn_with_its_values(figures):
    for figure in figures:
        for panel in figure.panels:
            drawn = {part.label: part for part in overlay(panel) if type(part).__name__ == "Curve"}
            assert list(drawn) == [curve.label for curve in panel.curves]
            for curve in panel.curves:
                part = drawn[curve.label]
                assert np.array_equal(part.dimension_values(0), curve.x)
                shown = part.dimension_values(1)
                fits = (curve.y > 0.0) if panel.y.logarithmic else np.ones(len(curve.y), bool)
                assert np.array_equal(shown[fits], curve.y[fits])
                assert np.isnan(shown[~fits]).all()


def test_claims_and_findings_stand_beside_them(figures):
    view = PaperFigures("")
    view.open()
    compute().result(60)
    texts = [card[0].object for card in view.view]
    for text, figure in zip(texts, figures, strict=True):
        assert f"Fig. {figure.number}" in text
        assert figure.verdict in text
        assert text.count("<li>") == len(figure.findings)


def test_a_failure_is_told_and_not_kept(monkeypatch, figures):
    monkeypatch.setattr(paper_figures, "WORK", sys.exit)
    monkeypatch.setattr(paper_figures, "_computed", None)
    failed = compute()
    assert failed.exception(60) is not None
    view = PaperFigures("")
    view._show(failed)
    assert "could not be computed" in view.view[0].object
    assert compute() is not failed
