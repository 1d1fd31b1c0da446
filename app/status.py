"""What the page says of a run: the line of the status, and the key figures at an instant."""

from __future__ import annotations

from html import escape

import numpy as np

from app.frame import Frame, Selection
from app.state import PageState
from app.units import number, percent, unit_for
from solver.latin import Ending
from solver.study.quantities.finished import key_figures

ENDINGS = {
    Ending.CONVERGED: "✓ solved",
    Ending.EXHAUSTED: "■ not converged",
    Ending.STALLED: "■ stalled",
    Ending.CANCELLED: "■ stopped",
    Ending.DIVERGED: "✗ diverged",
}


def status_line(state: PageState) -> str:
    """How far the run is, or how it ended, with the method's own words behind *details* (HTML).

    What the page says beside is one line, and whole in the details.
    """
    frame, newest, said = state.frame, state.newest, _said(state)
    if frame is None or newest is None:
        progress, details = "<b>starting</b>", ""
    else:
        progress, details = _progress(state, frame, newest), _details(frame, said)
    text = " ".join(said)
    # Two lines, whatever they hold: figures below do not follow what becomes higher.
    return (
        f'<div class="progress">{progress}</div>'
        f'<div class="said">{details}<b title="{text}">{text}</b></div>'
    )


def _progress(state: PageState, frame: Frame, newest: Frame) -> str:
    wrong = percent(frame.error)
    if frame is not newest:
        return f"<b>iteration {frame.iteration}</b> of {newest.iteration} · {wrong} wrong"
    if newest.status is None:
        paused = "" if state.running else " · paused"
        return f"<b>iteration {newest.iteration}</b> · {wrong} wrong{paused}"
    counted = f"{newest.iteration} iteration{'s' * (newest.iteration != 1)}"
    if frame.run.is_idle:
        return f"<b>at rest</b> · {counted}: nothing acts here; give a load, or move a side"
    search = "search" if newest.residual is None or newest.is_answer else "answer"
    end = f"{wrong} wrong" if newest.residual is None else "certified"
    return f"<b>{ENDINGS[newest.status.ending]}</b> · {search}: {counted} · {end}"


def _details(frame: Frame, said: list[str]) -> str:
    """What the method says of itself."""
    settings = frame.run.settings
    parts = settings.n_substructures
    kind = "multiscale" if settings.multiscale else "monoscale"
    words = [
        f"{parts} substructures, {kind}" if parts > 1 else "one substructure",
        f"indicator η {number(frame.last('indicator'))}",
        f"k-free indicator {number(frame.last('behaviour'))}",
        f"force error {percent(frame.last('error_force'))}",
        f"displacement error {percent(frame.last('error_displacement'))}",
        f"estimated force error {percent(frame.last('estimated_error'))}",
        f"{number(frame.last('seconds'))} s; incremental solver "
        f"{number(frame.run.reference_seconds)} s",
    ]
    if frame.status is not None and frame.status.ending is Ending.CONVERGED:
        words.append(escape(frame.status.advice))
    lines = "".join(f"<div>{word}</div>" for word in [*words, *said])
    return f"<details><summary>details</summary><div>{lines}</div></details>"


def _said(state: PageState) -> list[str]:
    words = [escape(text) for text in (state.message, state.refusal) if text]
    frame = state.frame
    if frame is not None and frame.status is not None:
        if frame.status.ending is not Ending.CONVERGED:
            words.append(escape(frame.status.advice))
        words.extend(map(escape, frame.remarks))
    return words


def figures_line(frame: Frame, selection: Selection) -> str:
    """What became of the thing at the selected instant, as key figures in a line (HTML)."""
    run, column = frame.run, frame.run.column(selection.phase)
    axes = run.across, run.up
    # Springs stand beside the surfaces, and neither stick nor slip.
    springs = [number for number, one in enumerate(run.interfaces.values()) if one.is_spring]
    status = frame.deformed.status[~np.isin(run.geometry.chains, springs)]
    figures = {
        figure.title: unit_for(figure.largest, figure.unit)(figure.value)
        if figure.unit
        else percent(figure.value)
        for figure in key_figures(axes, frame.loop, status, frame.energy, column)
    }
    beside = frame.extras.get("beside")
    if beside is not None:
        figures[f"Distance to {beside['brought'].source}"] = percent(beside["distance"])
    spans = (f"<span>{escape(name)} <b>{value}</b></span>" for name, value in figures.items())
    return "".join(spans)
