"""What the page says in words: the status line, and the key figures beside those before."""

from __future__ import annotations

import math
from collections.abc import Sequence
from html import escape

from app.recording import Recording
from app.worker.shown import has_reference
from solver.latin import Ending, Record

ENDINGS = {
    Ending.CONVERGED: "✓ converged",
    Ending.EXHAUSTED: "■ out of iterations",
    Ending.STALLED: "■ stalled",
    Ending.CANCELLED: "■ stopped",
    Ending.DIVERGED: "✗ diverged",
}
AT_REST = "■ at rest"
NOTHING_ACTS = "Nothing acts here, so nothing moves: give a load, or move a side or an end."
HEADS = (
    "Iteration",
    "LATIN indicator η",
    "k-free indicator",
    "Estimated force error",
    "Displacement error",
    "Friction force error",
    "Run time",
    "Iterations to 1 % force error",
)
ERRORS = ("Displacement error", "Friction force error", "Iterations to 1 % force error")
MEANINGS = {
    "LATIN indicator η": "Distance between the two stages of the method, which also depends on k.",
    "k-free indicator": "By how much the iterate breaks the laws of the interfaces, as a share of "
    "the energy in play, whatever k is.",
    "Estimated force error": "How wrong the contact force is, as the run itself estimates it, "
    "without a reference.",
    "Run time": "All that the run needs to end: set-up, iterations, indicators, estimate.",
    "Iterations to 1 % force error": "After which the friction force is within 1 % of the "
    "reference for the first time.",
}
"""What stands over a figure's name when one points at it."""


def status_line(
    run: Recording,
    running: bool,
    sought: int | None,
    *,
    held: bool = False,
    complaint: str = "",
) -> str:
    """Say what runs, how far it is, and how it ended with what to try (HTML).

    A run that is `held` waits for a study that is timed; a complaint comes before the advice.
    """
    if run.notice and not run.records:
        return f"<b>{escape(run.notice)}</b>"
    settings, parts = run.settings.values(), run.settings.n_substructures
    scale = (
        "one substructure"
        if parts == 1
        else (f"{parts} substructures, {'multiscale' if settings['multiscale'] else 'monoscale'}")
    )
    done = run.iteration or (run.newest.iteration if run.newest else 0)
    idle = run.begun is not None and run.begun.is_idle
    if run.status is not None:
        counted = "iteration" if run.iteration == 1 else "iterations"
        ending = AT_REST if idle else ENDINGS[run.status.ending]
        state = f"<b>{ending}</b> after {run.iteration} {counted}"
    elif run.is_broken:
        state = f"<b>■ stopped</b> at iteration {run.iteration}"
    elif held:
        state = f"<b>waits</b> for the study that is timed, at iteration {done}"
    elif not running:
        state = f"<b>paused</b> at iteration {done}"
    elif not done:
        state = "<b>setting up</b>"
    else:
        state = f"<b>running</b>, iteration {done}"
    line = f"{state} · {scale}"
    if run.newest is not None and run.newest.bases is not None:
        bases = run.newest.bases
        counted = "1 mode" if bases.largest == 1 else f"{bases.largest} modes"
        line += f" · {counted} at most, {bases.stored} stored"
    if run.records:
        last = run.records[-1]
        line += f" · η = {number(last.indicator)}"
        if math.isfinite(last.error_force):
            line += f" · friction force error {percent(last.error_force)}"
        line += f" · {1e3 * per_iteration(run):.2f} ms per iteration"
    if sought is not None:
        line += f" · <b>showing iteration {sought}</b>"
    more = [f"<b>{escape(complaint)}</b>"] if complaint else []
    more += [start_line(run)] if run.is_warm else []
    if run.status is not None:
        more.append(NOTHING_ACTS if idle else escape(run.status.advice))
    elif run.notice:
        more.append(escape(run.notice))
    return f"{line}<br>{' '.join(more)}" if more else line


def start_line(run: Recording) -> str:
    """Say from where a run started that could have started from the one before it (HTML)."""
    own = "coarser meshes" if run.settings.values()["start"] == "nested" else "zero"
    if run.begun is None:
        return ""
    if run.choice is None:
        return f"Started from {own}: the run before it was not at hand."
    previous, other = number(run.choice.previous), number(run.choice.own)
    figures = f"k-free indicator after one iteration {previous}, from {own} {other}"
    if run.choice.is_previous:
        return f"Started from the run before it: {figures}."
    return f"Started from {own}, since the run before it is not clearly nearer: {figures}."


def key_figures(run: Recording, before: Recording | None, shown: Record | None) -> str:
    """Set the figures of this run beside those of the run before (an HTML table).

    Errors are those beside a reference; where there is none, they are left out.
    """
    heads = HEADS if has_reference(run.settings) else tuple(_without_errors(HEADS))
    rows = [("this run", run, shown or (run.records[-1] if run.records else None))]
    if before is not None:
        rows.append(
            (
                f"before ({escape(before.title)})",
                before,
                before.records[-1] if before.records else None,
            )
        )
    head = "".join(f'<th title="{escape(MEANINGS.get(text, ""))}">{text}</th>' for text in heads)
    body = "".join(
        f"<tr><th>{name}</th>{''.join(f'<td>{cell}</td>' for cell in _cells(kept, entry))}</tr>"
        for name, kept, entry in rows
    )
    return f"<table><thead><tr><th></th>{head}</tr></thead><tbody>{body}</tbody></table>"


def _cells(run: Recording, entry: Record | None) -> Sequence[str]:
    cells = ("–",) * len(HEADS) if entry is None else _figures(run, entry)
    return cells if has_reference(run.settings) else _without_errors(cells)


def _without_errors(cells: Sequence[str]) -> list[str]:
    return [cell for cell, head in zip(cells, HEADS, strict=True) if head not in ERRORS]


def _figures(run: Recording, entry: Record) -> tuple[str, ...]:
    within = run.first_within(0.01)
    return (
        str(entry.iteration),
        number(entry.indicator),
        number(entry.behaviour),
        percent(entry.estimated_error),
        percent(entry.error_displacement),
        percent(entry.error_force),
        f"{1e3 * entry.seconds:.1f} ms",
        str(within.iteration) if within else "–",
    )


def per_iteration(run: Recording) -> float:
    """Give the time per iteration, s, without the set-up where more than one is done."""
    first, last = run.records[0], run.records[-1]
    if last.iteration == first.iteration:
        return last.seconds
    return (last.seconds - first.seconds) / (last.iteration - first.iteration)


def number(value: float) -> str:
    """Write a positive number over many decades."""
    if not math.isfinite(value):
        return "–"
    if value == 0.0:
        return "0"
    if 1e-3 <= value < 1e3:
        return f"{value:.3g}"
    digits, exponent = f"{value:.1e}".split("e")
    return f"{digits}·10<sup>{int(exponent)}</sup>"


def percent(value: float) -> str:
    """Write a relative error."""
    if not math.isfinite(value):
        return "–"
    if value >= 1.0:
        return f"{100.0 * value:.0f} %" if value < 100.0 else f"{number(100.0 * value)} %"
    return f"{100.0 * value:.2g} %" if value >= 1e-4 else f"{number(100.0 * value)} %"
