"""Texts on a run: the line of its status, and key figures at an instant."""

from __future__ import annotations

from collections.abc import Callable
from html import escape

import numpy as np

from app.frame import Frame, Selection
from app.refusals import amounts_in_titles
from app.state import PageState
from app.units import number, percent, unit_for
from solver.latin import Ending
from solver.study.quantities.finished import KeyFigure, key_figures, slipping_shares

ENDINGS = {
    Ending.CONVERGED: "✓ solved",
    Ending.EXHAUSTED: "■ not converged",
    Ending.STALLED: "■ stalled",
    Ending.CANCELLED: "■ stopped",
    Ending.DIVERGED: "✗ diverged",
}


LOST = "no figures are told, as no solution is found at some instants"
"""Hint over figures that are not told."""


def status_line(state: PageState) -> str:
    """Progress or end of the run, with the method's message behind *details* (HTML).

    What the page says beside is one line, and whole in the details.
    """
    frame = state.frame
    newest = state.newest
    said = _said(state)
    if frame is None or newest is None:
        progress = "<b>starting</b>"
        details = ""
    else:
        progress = _progress(state, frame, newest)
        details = _details(frame, said)
    text = " ".join(said)
    # Two lines, whatever they hold: figures below do not follow what becomes higher.
    return (
        f'<div class="progress">{progress}</div>'
        f'<div class="said">{details}<b title="{text}">{text}</b></div>'
    )


def _progress(state: PageState, frame: Frame, newest: Frame) -> str:
    wrong = percent(frame.error)
    if frame is not newest:
        return (
            f"<b>iteration {frame.iteration}</b> of {newest.iteration} · {wrong} wrong"
        )
    if newest.status is None:
        paused = "" if state.running else " · paused"
        return f"<b>iteration {newest.iteration}</b> · {wrong} wrong{paused}"
    counted = f"{newest.iteration} iteration{'s' * (newest.iteration != 1)}"
    if frame.run.is_idle:
        return f"<b>at rest</b> · {counted}: nothing acts here; give a load, or move a side"
    search = "search" if newest.residual is None or newest.is_answer else "answer"
    if newest.residual is None:
        end = f"{wrong} wrong"
    else:
        end = "certified"
    return f"<b>{ENDINGS[newest.status.ending]}</b> · {search}: {counted} · {end}"


def _details(frame: Frame, said: list[str]) -> str:
    """Message of the method on its end."""
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
        words.append(escape(amounts_in_titles(settings, frame.status.advice)))
    if not _is_lost(frame):
        figures = [f"{one.title}: {_over_time(frame, one)}" for one in _of_loop(frame)]
        words.extend(map(escape, figures))
    lines = "".join(f"<div>{word}</div>" for word in [*words, *said])
    return f"<details><summary>details</summary><div>{lines}</div></details>"


def _said(state: PageState) -> list[str]:
    words = [escape(text) for text in (state.message, state.refusal) if text]
    frame = state.frame
    if frame is not None and frame.status is not None:
        messages = list(frame.remarks)
        if frame.status.ending is not Ending.CONVERGED:
            messages.insert(0, frame.status.advice)
        settings = frame.run.settings
        words.extend(escape(amounts_in_titles(settings, text)) for text in messages)
    return words


def figures_line(frame: Frame, selection: Selection) -> str:
    """Key figures of the structure at the selected instant, in a line (HTML).

    Its largest and last values appear over each of them. Nothing is told of a run some
    of whose instants are known to have no solution.
    """
    run = frame.run
    column = run.column(selection.phase)
    figures = {}
    hints = {}
    for figure in _of_loop(frame):
        figures[figure.title] = _unit_of(figure)(figure.at(column))
        hints[figure.title] = _over_time(frame, figure)
    # Springs stand beside the surfaces, and neither stick nor slip.
    springs = [
        number for number, one in enumerate(run.interfaces.values()) if one.is_spring
    ]
    status = frame.deformed.status[~np.isin(run.geometry.chains, springs)]
    figures["Slips"] = percent(float(slipping_shares(status)[column]))
    figures["Energy lost"] = unit_for(abs(frame.energy), "J")(frame.energy)
    beside = frame.extras.get("beside")
    if beside is not None:
        figures[f"Distance to {beside['brought'].source}"] = percent(beside["distance"])
    if _is_lost(frame):
        figures = dict.fromkeys(figures, "–")
        hints = dict.fromkeys(figures, LOST)
    spans = []
    for name, value in figures.items():
        hint = escape(hints.get(name, ""))
        spans.append(f'<span title="{hint}">{escape(name)} <b>{value}</b></span>')
    return "".join(spans)


def _is_lost(frame: Frame) -> bool:
    """Check whether some instants of a run are known to have no solution."""
    return frame.status is not None and frame.status.lost_from is not None


def _of_loop(frame: Frame) -> list[KeyFigure]:
    """Key figures of the loop of a frame."""
    return key_figures((frame.run.across, frame.run.up), frame.loop)


def _unit_of(figure: KeyFigure) -> Callable[[float], str]:
    """Unit of a key figure, chosen once for the run; shares are in per cent."""
    if not figure.unit:
        return percent
    return unit_for(abs(figure.largest), figure.unit)


def _over_time(frame: Frame, figure: KeyFigure) -> str:
    """Largest value of a key figure with its instant, and its last value."""
    instants = frame.run.instants
    unit = _unit_of(figure)
    when = unit_for(float(instants[-1]), "s")(float(instants[figure.instant]))
    return f"largest {unit(figure.largest)} at {when}, last {unit(figure.last)}"
