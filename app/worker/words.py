"""What the page says in words of a run: what it is at, how it ended, and what to try."""

from __future__ import annotations

import math
from collections.abc import Mapping
from html import escape
from typing import Literal

from app.picture.glossary import explained
from app.picture.labels import in_titles
from app.picture.recording import Recording
from app.picture.sampler import Frame
from app.picture.units import power
from solver.latin import Ending
from solver.latin.run_cost import RunCost
from solver.phrases import Phrase, joined
from solver.refusal import RefusedError

ENDINGS = {
    Ending.CONVERGED: "✓ converged",
    Ending.EXHAUSTED: "■ not converged",
    Ending.STALLED: "■ not converged, stalled",
    Ending.CANCELLED: "■ stopped",
    Ending.DIVERGED: "✗ diverged",
}
SOLVED = {
    "✓ converged": "✓ solved",
    "■ not converged": "■ not solved",
    "■ not converged, stalled": "■ not solved, stalled",
}
"""What these are in the line that everybody reads."""
DETAIL = '<span class="asks" tabindex="0">details<span class="detail">{}</span></span>'
"""What is shown to a pointer, the focus, or a tap."""
STATES = {
    "running": "<b>running</b>, iteration {}",
    "paused": "<b>paused</b> at iteration {}",
    "held": "<b>waits</b> for the study to be timed, at iteration {}",
}
AT_REST, AT_WORK = "■ at rest", "at work"
COUNTED = "iteration", "friction force error"
"""Stand beside their numbers in the status line, where scripts read them; the figures mark them."""
CHANGES = {
    "slip": "{} began to slip: force over its bound",
    "turn": "{} slip the other way: force over its bound",
    "stick": "{} stick again: friction at its bound would drive the slip",
    "settle": "{} rest: they slip by no more than both stages differ by",
    "lift": "{} lift: contact would have to pull",
    "touch": "{} touch: the bodies would overlap",
}
"""Of points at instants, by what became of them."""
PROOF = ": the answer is certified"
PAUSED = "Run goes on, Step does one iteration."
REPLAYED = "The run had ended, and begins anew."
NOTHING_ACTS = "Nothing acts here, so nothing moves: give a load, or move a side or an end."
UNKNOWN = "–"


def before_a_run(cost: RunCost) -> str:
    """Say what a long or large run will take, until its first picture comes (HTML)."""
    return Phrase("<b>starting</b>: this will take about {}", str(cost))


def before_it_is_agreed(cost: RunCost, *, has_run: bool) -> str:
    """Say that a run has not begun, and how it does (HTML)."""
    asked = Phrase(
        "<b>not begun</b>: this would take about {}.<br><b>Run anyway</b>, or choose fewer "
        "elements, instants or bodies.",
        str(cost),
    )
    beside = "Until then all plots and numbers are of the run before."
    return joined(" ", (asked, beside)) if has_run else asked


def status_line(
    run: Recording,
    frame: Frame,
    state: Literal["running", "paused", "held", "by hand"],
    sought: int | None = None,
    complaint: str = "",
) -> str:
    """Say what runs, how far it is, and how it ended with what to try (HTML).

    A run "by hand" is replayed once the slider is let go; one that is held waits for a study that
    is timed. A complaint comes before the advice.
    """
    done = run.searched or frame.iteration
    line = _state(run, frame, state, done)
    if sought is not None:
        line = Phrase("{} · <b>showing {}</b>", line, run.called(sought))
    more = [f"<b>{escape(complaint)}</b>"] if complaint else []
    more += [Phrase("<b>{}</b>", escape(run.notice))] if run.notice else []
    detail = [_detail(run, frame)]
    detail += [start_line(run)] if run.is_warm else []
    if run.status is not None:
        is_solved = run.status.ending is Ending.CONVERGED and not run.stand.is_idle
        advice = NOTHING_ACTS if run.stand.is_idle else run.status.advice
        (detail if is_solved else more).append(in_titles(run.settings, escape(advice), "<i>{}</i>"))
    elif state == "paused":
        more.append(PAUSED)
    if frame.changes is not None:
        more.append(changed_since(frame.changes[0]))
    if run.status is None and more:
        line = Phrase("{}.", line)
    say, details = frame.look.say, Phrase(DETAIL, joined("<br>", detail))
    return explained(say(joined(" ", [line, *more, details])), COUNTED, say)


def changed_since(counts: Mapping[str, int]) -> str:
    """Say how many points, instant by instant, have changed their status, and why."""
    said = [Phrase(words, counts[name]) for name, words in CHANGES.items() if name in counts]
    changed = joined("; ", said) if said else "none changed"
    return Phrase("Since the iterate before, of points and instants: {}.", changed)


def _state(run: Recording, frame: Frame, state: str, done: int) -> str:
    """Say in plain words what a run is at, or what it came to."""
    if state == "by hand":
        ending = ENDINGS[run.status.ending] if run.status else "running"
        return Phrase("<b>follows the slider</b>, {} at iteration {}", ending, done)
    if run.status is None:
        return Phrase(STATES[state], done)
    ending = AT_REST if run.stand.is_idle else ENDINGS[run.status.ending]
    is_proven = frame.iterate.residual is not None
    ending = SOLVED.get(ending, ending)
    ended = "<b>{}</b> after {} iteration" if done == 1 else "<b>{}</b> after {} iterations"
    return Phrase("{}{}.", Phrase(ended, ending, done), PROOF if is_proven else "")


def _detail(run: Recording, frame: Frame) -> str:
    """Give what the method says of itself."""
    settings, parts = run.settings.values(), run.settings.n_substructures
    cut = "{} substructures, multiscale"
    cut = cut if settings["multiscale"] else "{} substructures, monoscale"
    ended = AT_REST if run.stand.is_idle else ENDINGS[run.status.ending] if run.status else ""
    found = [ended if run.status else AT_WORK]
    found.append("one substructure" if parts == 1 else Phrase(cut, parts))
    if (bases := frame.bases) is not None:
        counted = "1 mode" if bases.largest == 1 else Phrase("up to {} modes", bases.largest)
        found.append(Phrase("{} a substructure, {} in all", counted, bases.found.stored))
    if (last := run.last) is not None:
        found.append(f"η = {number(last.indicator)}")
        if math.isfinite(last.error_force):
            found.append(Phrase("friction force error {}", percent(last.error_force)))
        found.append(Phrase("{} ms per iteration", f"{1e3 * per_iteration(run):.2f}"))
    return joined(" · ", found)


def start_line(run: Recording) -> str:
    """Say from where a run started that could have started from the one before it (HTML)."""
    own = "a coarser mesh" if run.settings.start == "nested" else "zero"
    if run.choice is None:
        return Phrase("Started from {}, as there was no run before to start from.", own)
    previous, other = number(run.choice.previous), number(run.choice.own)
    figures = Phrase(
        "after one iteration its k-free indicator is {}; from {} it is {}", previous, own, other
    )
    if run.choice.is_previous:
        return Phrase("Started from the run before: {}.", figures)
    return Phrase("Started from {}. The run before is not clearly nearer: {}.", own, figures)


def per_iteration(run: Recording) -> float:
    """Give the time per iteration, s, without the set-up where more than one is done."""
    seconds = run.history.column("seconds")
    if len(seconds) == 1:
        return float(seconds[0])
    return float(seconds[-1] - seconds[0]) / (len(seconds) - 1)


def number(value: float) -> str:
    """Write a positive number over many decades."""
    if not math.isfinite(value):
        return UNKNOWN
    is_near = value == 0.0 or 1e-3 <= value < 1e3
    return f"{value:.3g}" if is_near else power(value, 2)


def percent(value: float) -> str:
    """Write a relative error."""
    if not math.isfinite(value):
        return UNKNOWN
    if value >= 1.0:
        return f"{100.0 * value:.0f} %" if value < 100.0 else f"{number(100.0 * value)} %"
    return f"{100.0 * value:.2g} %" if value >= 1e-4 else f"{number(100.0 * value)} %"


def why_it_broke(problem: Exception) -> str:
    """Say why a run is over before it has ended."""
    if isinstance(problem, RefusedError | FloatingPointError):
        return str(problem)
    return (
        f"The run broke ({type(problem).__name__}: {problem}). Change a setting, or lower the "
        "numbers of elements and instants."
    )
