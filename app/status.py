"""Texts on a run: the status line, and key figures at an instant."""

from __future__ import annotations

import math
import re
from functools import cache
from html import escape
from typing import NamedTuple

import numpy as np
from markupsafe import Markup

from app.frame import LOCAL, Extremes, Floats, Frame, Selection
from app.refusals import in_titles
from app.state import PageState
from app.templates import html
from app.units import percent, settled
from app.widgets import MEANINGS
from solver.files.amounts import number, unit_for
from solver.latin import Ending

ENDINGS = {
    Ending.CONVERGED: "✓ solved",
    Ending.EXHAUSTED: "■ not converged",
    Ending.STALLED: "■ stalled",
    Ending.CANCELLED: "■ stopped",
    Ending.DIVERGED: "✗ diverged",
}

TERMS = (
    "certified",
    "wrong",
    "iteration",
    "iterations",
    "search",
    "answer",
    "solved",
    "not converged",
    "stalled",
    "diverged",
    "substructure",
    "substructures",
    "multiscale",
    "monoscale",
    "indicator η",
    "k-free indicator",
    "force error",
    "displacement error",
    "estimated force error",
    "incremental solver",
)
"""Words of the glossary in the status and its details."""
LONGEST_FIRST = sorted(TERMS, key=len, reverse=True)
TERM = re.compile(rf"(?<!\w)({'|'.join(LONGEST_FIRST)})(?!\w)")
"""Pattern of one of these; of some that begin alike it takes the longest."""
LEFT = 1e-5
"""Share of its largest value below which a key figure is 0: iterates leave as much
where nothing acts."""
SMALL = 1e-3
"""Number of units below which a key figure would have a power of ten."""
LOST = "no figures are told, as no solution is found at some instants"
"""Hint over figures in place of which there is a dash."""
ON_ITS_WAY = "in an iterate on its way sides are not yet moved as the load says"
"""Hint over a displacement that may differ from the prescribed one in the picture."""
OWNER = "after the linear stage that follows:"
"""Words before the figures of an iteration that is shown up to its local stage."""


def status_line(state: PageState) -> str:
    """HTML of progress or end of the run, with the method's message as *details*.

    Messages of the page are next to it in one line, and in full in the details.
    """
    frame = state.frame
    newest = state.newest
    said = _said(state)
    lead = _without_iterate(state)
    rest = ""
    details = []
    if frame is not None and newest is not None:
        lead, rest = _progress(state, frame, newest)
        details = [*_details(frame), *said]
    return html(
        "status.html",
        lead=explained(lead),
        rest=explained(rest),
        details=[explained(sentence) for sentence in details],
        said=" ".join(said),
    )


def explained(text: str) -> Markup:
    """HTML of a text with explanations of the terms in the glossary.

    It shows under the pointer, and once the term is tapped or has the focus.
    """
    return Markup(TERM.sub(lambda found: _with_meaning(found[0]), escape(text)))


# The same terms stand in the words of each picture.
@cache
def _with_meaning(term: str) -> str:
    """A term of the glossary, with its meaning at hand (HTML)."""
    return html("term.html", term=term, meaning=MEANINGS[term])


def spoken_status(state: PageState) -> str:
    """Text for screen readers: messages, and the status of a paused or ended run."""
    sentences = _said(state)
    frame = state.frame
    newest = state.newest
    goes_on = state.running and not state.is_over
    if frame is not None and newest is not None and not goes_on:
        sentences.insert(0, "".join(_progress(state, frame, newest)))
    return " ".join(sentences)


def _without_iterate(state: PageState) -> str:
    """State of a run of which there is no iterate yet."""
    if state.has_failed:
        return "not run"
    if state.is_costly:
        return "not run yet"
    if state.frame is None:
        return "starting"
    return "solving …"


def _progress(state: PageState, frame: Frame, newest: Frame) -> tuple[str, str]:
    """State of the run in bold, and its iterations and error."""
    if state.is_stale:
        return _without_iterate(state), ""
    # Before the first estimate nobody knows.
    wrong = ""
    if math.isfinite(frame.error):
        wrong = f" · {percent(frame.error)} wrong"
    counted = f"iteration {frame.iteration}"
    if state.selection.stage == LOCAL:
        return counted, " · local stage, paused"
    if frame is not newest:
        return counted, f" of {newest.iteration}{wrong}"
    if newest.status is None:
        paused = "" if state.running else " · paused"
        return counted, f"{wrong}{paused}"
    count = newest.iteration
    if newest.is_followed:
        count = 0
    if frame.run.is_idle:
        hint = "nothing acts here; give a load, or move a side"
        return "at rest", f" · {iterations(count)}: {hint}"
    search = "search"
    end = wrong
    if newest.residual is not None:
        end = " · certified"
        if not newest.is_answer:
            search = "answer"
    return ENDINGS[newest.status.ending], f" · {search}: {iterations(count)}{end}"


def iterations(count: int) -> str:
    """Text of a number of iterations."""
    if count == 1:
        return "1 iteration"
    return f"{count} iterations"


def _details(frame: Frame) -> list[str]:
    """Sentences on the method and the end of the run, and key figures over time."""
    settings = frame.run.settings
    parts = frame.run.n_substructures
    decomposition = "one substructure"
    if parts > 1:
        kind = "multiscale" if settings.multiscale else "monoscale"
        decomposition = f"{parts} substructures, {kind}"
    sentences = [
        decomposition,
        f"indicator η {number(frame.last('indicator'))}",
        f"k-free indicator {number(frame.last('behaviour'))}",
        f"force error {percent(frame.last('error_force'))}",
        f"displacement error {percent(frame.last('error_displacement'))}",
        f"estimated force error {percent(frame.last('estimated_error'))}",
        f"{number(frame.last('seconds'))} s; incremental solver "
        f"{number(frame.run.reference_seconds)} s",
    ]
    # Of a run that failed the advice stands on the page itself, beside the details.
    if frame.status is not None and frame.status.ending is Ending.CONVERGED:
        sentences.append(in_titles(settings, frame.status.advice))
    if not _is_lost(frame):
        for figure in _of_loop(frame):
            sentences.append(f"{figure.title}: {_over_time(frame, figure)}")
    return sentences


def _said(state: PageState) -> list[str]:
    """Messages of the page, then those on the shown run."""
    messages = [text for text in (state.message, state.refusal) if text]
    frame = state.frame
    if frame is not None and frame.status is not None:
        remarks = list(frame.remarks)
        if frame.status.ending is not Ending.CONVERGED:
            remarks.insert(0, frame.status.advice)
        settings = frame.run.settings
        for remark in remarks:
            messages.append(in_titles(settings, remark))
    return messages


def figures_line(frame: Frame, selection: Selection) -> str:
    """HTML line of key figures of the structure at the selected instant.

    The largest and the last value appear over each of them. A run that is known to have
    no solution at some instants has dashes in place of values. Figures are those of a
    whole iteration: at its local stage bodies have no displacement of their own.
    """
    run = frame.run
    column = run.column(selection.phase)
    figures = {}
    hints = {}
    for figure in _of_loop(frame):
        value = float(figure.values[column])
        if abs(value) < LEFT * abs(figure.largest):
            value = 0.0
        figures[figure.title] = figure.in_words(value)
        hints[figure.title] = _over_time(frame, figure)
        if figure.unit == "m" and frame.status is None and _is_moved(frame):
            hints[figure.title] += f"; {ON_ITS_WAY}"
    figures["Slips"] = percent(float(frame.slips[column]))
    hints["Slips"] = MEANINGS["Slips"]
    energy = _energy(frame)
    figures[energy.title] = energy.in_words(float(energy.values[column]))
    total = energy.in_words(energy.largest)
    hints[energy.title] = f"{MEANINGS[energy.title]} At the end: {total}."
    beside = frame.extras.get("beside")
    if beside is not None:
        figures[f"Distance to {beside['brought'].source}"] = percent(beside["distance"])
    if _is_lost(frame):
        figures = dict.fromkeys(figures, "–")
        hints = dict.fromkeys(figures, LOST)
    owner = ""
    if selection.stage == LOCAL:
        owner = OWNER
    return html("figures.html", figures=figures, hints=hints, owner=owner)


def _is_moved(frame: Frame) -> bool:
    """Check whether a load of a run is the motion of a side."""
    return any(act.unit == "m" for act in frame.run.geometry.description.acts)


def _is_lost(frame: Frame) -> bool:
    """Check whether some instants of a run have no solution, as far as known."""
    return frame.status is not None and frame.status.lost_from is not None


class _Figure(NamedTuple):
    """A number over time: values at the shown instants, and of the whole run, SI."""

    title: str
    unit: str
    values: Floats
    extremes: Extremes

    @property
    def largest(self) -> float:
        """Value that is largest in size."""
        return self.extremes.largest

    def in_words(self, value: float) -> str:
        """A value in the unit of the figure, or in a smaller one if it is small."""
        # Shares are in per cent.
        if not self.unit:
            return percent(value)
        unit = unit_for(abs(self.largest), self.unit)
        if 0.0 < abs(value) < SMALL * unit.factor:
            # Too small for it.
            unit = unit_for(abs(value), self.unit)
        return unit(value)


def _of_loop(frame: Frame) -> list[_Figure]:
    """Key figures of the loop of a frame; displacement of a held side is zero."""
    figures = []
    moved = float(np.nanmax(np.abs(frame.deformed.nodes), initial=0.0))
    axes = frame.run.across, frame.run.up
    for axis, values, extremes in zip(axes, frame.loop, frame.extremes, strict=True):
        figure = _Figure(*axis, values, extremes)
        if figure.unit == "m" and settled(figure.largest, moved) == 0.0:
            nothing = Extremes(0.0, float(frame.run.instants[0]), 0.0)
            figure = figure._replace(values=np.zeros_like(values), extremes=nothing)
        figures.append(figure)
    return figures


def _energy(frame: Frame) -> _Figure:
    """Energy dissipated up to each instant; what rounding leaves is zero."""
    across, up = frame.extremes
    # The work that the largest force does on the largest displacement.
    work = across.largest * up.largest
    energy = np.array([settled(float(each), work) for each in frame.energy])
    end = float(energy[-1])
    extremes = Extremes(end, float(frame.run.instants[-1]), end)
    return _Figure("Energy dissipated", "J", energy, extremes)


def _over_time(frame: Frame, figure: _Figure) -> str:
    """Largest value of a key figure with its instant, and its last value."""
    largest, largest_at, last = figure.extremes
    when = unit_for(float(frame.run.instants[-1]), "s")(largest_at)
    return f"largest {figure.in_words(largest)} at {when}, last {figure.in_words(last)}"
