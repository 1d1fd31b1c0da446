"""What the page says in words: the status line, and the key figures beside those before."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from html import escape
from typing import Literal, NamedTuple

from app.picture.glossary import explained
from app.picture.labels import FEW, changes_of, in_titles, label_of
from app.picture.recording import Recording
from app.picture.sampler import Frame
from app.picture.shown import has_reference
from app.views.drawing import Scene
from solver.latin import Ending
from solver.latin.run_cost import RunCost

ENDINGS = {
    Ending.CONVERGED: "✓ converged",
    Ending.EXHAUSTED: "■ not converged",
    Ending.STALLED: "■ not converged, stalled",
    Ending.CANCELLED: "■ stopped",
    Ending.DIVERGED: "✗ diverged",
}
STATES = {
    "running": "<b>running</b>, iteration {}",
    "paused": "<b>paused</b> at iteration {}",
    "held": "<b>waits</b> for the study to be timed, at iteration {}",
}
AT_REST = "■ at rest"
COUNTED = "iteration", "friction force error"
"""Stand beside their numbers in the status line, where scripts read them; the figures mark them."""
PAUSED = "Run goes on, Step does one iteration."
NONE_YET = "no iteration done by then"
REPLAYED = "The run had ended, and begins anew."
NOTHING_ACTS = "Nothing acts here, so nothing moves: give a load, or move a side or an end."
UNKNOWN = "–"
ERRORS = ("Displacement error", "Friction force error", "Iterations to 1 %")
CHIEF, ESTIMATE = "Friction force error", "Estimated force error"
"""What is left where all is folded to a line, with a reference and without one."""


def before_a_run(cost: RunCost) -> str:
    """Say what a long or large run will take, until its first picture comes (HTML)."""
    return f"<b>starting</b>: this will take about {cost}"


def before_it_is_agreed(cost: RunCost, *, has_run: bool) -> str:
    """Say that a run has not begun, and how it does (HTML)."""
    beside = " Until then all plots and numbers are of the run before." if has_run else ""
    return (
        f"<b>not begun</b>: this would take about {cost}.<br><b>Run anyway</b>, or choose fewer "
        f"elements, instants or bodies.{beside}"
    )


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
    settings, parts = run.settings.values(), run.settings.n_substructures
    scale = (
        "one substructure"
        if parts == 1
        else f"{parts} substructures, {'multiscale' if settings['multiscale'] else 'monoscale'}"
    )
    done = run.iteration or frame.iteration
    counted = "iteration" if done == 1 else "iterations"
    if state == "by hand":
        ending = ENDINGS[run.status.ending] if run.status else "running"
        line = f"<b>follows the slider</b>, {ending} at iteration {done} · {scale}"
    elif run.status is not None:
        ending = AT_REST if run.stand.is_idle else ENDINGS[run.status.ending]
        line = f"<b>{ending}</b> after {done} {counted} · {scale}"
    else:
        line = f"{STATES[state].format(done)} · {scale}"
    if (bases := frame.bases) is not None:
        counted = "1 mode" if bases.largest == 1 else f"up to {bases.largest} modes"
        line += f" · {counted} a substructure, {bases.found.stored} in all"
    if (last := run.last) is not None:
        line += f" · η = {number(last.indicator)}"
        if math.isfinite(last.error_force):
            line += f" · friction force error {percent(last.error_force)}"
        line += f" · {1e3 * per_iteration(run):.2f} ms per iteration"
    if sought is not None:
        line += f" · <b>showing iteration {sought}</b>"
    more = [f"<b>{escape(complaint)}</b>"] if complaint else []
    more += [f"<b>{escape(run.notice)}</b>"] if run.notice else []
    more += [start_line(run)] if run.is_warm else []
    if run.status is not None:
        advice = NOTHING_ACTS if run.stand.is_idle else run.status.advice
        more.append(in_titles(run.settings, escape(advice), "<i>{}</i>"))
    elif state == "paused":
        more.append(PAUSED)
    return explained(f"{line}<br>{' '.join(more)}" if more else line, COUNTED)


def start_line(run: Recording) -> str:
    """Say from where a run started that could have started from the one before it (HTML)."""
    own = "a coarser mesh" if run.settings.start == "nested" else "zero"
    if run.choice is None:
        return f"Started from {own}, as there was no run before to start from."
    previous, other = number(run.choice.previous), number(run.choice.own)
    figures = f"after one iteration its k-free indicator is {previous}; from {own} it is {other}"
    if run.choice.is_previous:
        return f"Started from the run before: {figures}."
    return f"Started from {own}. The run before is not clearly nearer: {figures}."


def key_figures(scene: Scene) -> str:
    """Set the figures of the shown iteration beside those of what it is compared with (HTML).

    The run before stands there at its end, a run A at equal iteration and at equal run time.
    Errors are those beside a reference; where there is none, they are left out.
    """
    run, before, iteration = scene.run, scene.before, scene.frame.iteration
    rows = [_Row("this run", _cells(run, iteration))]
    if before is not None and scene.is_paired:
        rows = _paired(run, before, iteration)
    elif before is not None:
        name = f"run before ({escape(before.title)})"
        rows.append(_Row(name, _cells(before, before.iteration)))
    shown = [name for name in FIGURES if has_reference(run.settings) or name not in ERRORS]
    chief = CHIEF if CHIEF in shown else ESTIMATE
    head = "".join(f"<th{_mark(name, chief)}>{explained(name)}</th>" for name in shown)
    body = "".join(
        f'<tr><th title="{row.whole or row.name}" aria-label="{row.whole or row.name}">{row.name}'
        f"</th>{_row(row.cells, shown, chief)}</tr>"
        for row in rows
    )
    return f"<table><thead><tr><th></th>{head}</tr></thead><tbody>{body}</tbody></table>"


def _row(cells: Mapping[str, str], shown: Sequence[str], chief: str) -> str:
    if not cells:
        return f'<td class="chief" colspan="{len(shown)}">{NONE_YET}</td>'
    return "".join(f"<td{_mark(name, chief)}>{cells[name]}</td>" for name in shown)


def _mark(name: str, chief: str) -> str:
    return ' class="chief"' if name == chief else ""


class _Row(NamedTuple):
    """A run's name (HTML) and figures; its whole name, where that is longer than there is room."""

    name: str
    cells: Mapping[str, str]
    whole: str = ""


def _paired(run: Recording, twin: Recording, iteration: int) -> list[_Row]:
    """Give the figures of run B, and of run A as far as B in iterations, and in time."""
    return [
        _compared("B", run, twin, "as A", iteration),
        _compared("A", twin, run, "as B", twin.shown),
        _at_equal_time(run, twin, iteration),
    ]


def _compared(name: str, run: Recording, other: Recording, alike: str, iteration: int) -> _Row:
    """Give the figures of a run, which is called by what it has other than the other one."""
    changes = changes_of(run.settings, other.settings)
    few, all_of_them = (
        f"{name} ({escape(label_of(run.settings, changes, most) or alike)})"
        for most in (FEW, len(changes))
    )
    return _Row(few, _cells(run, iteration), all_of_them)


def _at_equal_time(run: Recording, twin: Recording, iteration: int) -> _Row:
    """Give A after the run time of B, or B after that of A where A has not run as long yet."""
    now, last = run.figures_of(iteration), twin.figures_of(twin.iteration)
    if now is None or last is None:
        return _Row("at equal run time", _cells(twin, 0))
    if twin.status is None and last["seconds"] < now["seconds"]:
        name, slower, done = "B at A's run time", run, run.last_within(last["seconds"])
    else:
        name, slower, done = "A at B's run time", twin, twin.last_within(now["seconds"])
    return _Row(name, _cells(slower, done) if done else {})


def _cells(run: Recording, iteration: int) -> dict[str, str]:
    found = run.figures_of(iteration)
    return {name: write(found, run) if found else UNKNOWN for name, write in FIGURES.items()}


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
    if value == 0.0:
        return "0"
    if 1e-3 <= value < 1e3:
        return f"{value:.3g}"
    digits, exponent = f"{value:.1e}".split("e")
    return f"{digits}·10<sup>{int(exponent)}</sup>"


def percent(value: float) -> str:
    """Write a relative error."""
    if not math.isfinite(value):
        return UNKNOWN
    if value >= 1.0:
        return f"{100.0 * value:.0f} %" if value < 100.0 else f"{number(100.0 * value)} %"
    return f"{100.0 * value:.2g} %" if value >= 1e-4 else f"{number(100.0 * value)} %"


FIGURES: dict[str, Callable[[Mapping[str, float], Recording], str]] = {
    "Iteration": lambda now, run: f"{now['iteration']:.0f}",
    "LATIN indicator η": lambda now, run: number(now["indicator"]),
    "k-free indicator": lambda now, run: number(now["behaviour"]),
    ESTIMATE: lambda now, run: percent(now["estimated_error"]),
    "Displacement error": lambda now, run: percent(now["error_displacement"]),
    CHIEF: lambda now, run: percent(now["error_force"]),
    "Run time": lambda now, run: f"{1e3 * now['seconds']:.1f} ms",
    "Iterations to 1 %": lambda now, run: str(run.first_within(0.01) or UNKNOWN),
}
"""What is told of an iteration of a run."""
