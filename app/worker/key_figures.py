"""The figures that a run comes to: what became of the thing, and behind it how the method did."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from html import escape
from typing import NamedTuple

import numpy as np

from app.languages.language import Language
from app.picture.glossary import explained
from app.picture.labels import FEW, changes_of, label_of
from app.picture.recording import Recording
from app.picture.sampler import Frame
from app.picture.shown import STATUS_OPEN, STRESSES, has_reference, instant_of
from app.picture.units import measured
from app.views.catalogue import VIEWS
from app.views.scene import Scene
from app.worker.words import UNKNOWN, number, percent
from solver.latin import Solution
from solver.latin.criteria.status import CANCELLED
from solver.phrases import Phrase
from solver.study.quantities.finished import FinishedRun

NONE_YET = "no iteration done by then"
ERRORS = ("Displacement error", "Friction force error", "Iterations to 1 %")
NONE = 1e-6
"""Share from which an error counts as none where it is told in plain words."""


def key_figures(scene: Scene) -> str:
    """Give what became of the thing, and the figures of the method beside others (HTML).

    These fold away unless two runs go in step. The run before stands there at its end, a run A at
    equal iteration and at equal run time.
    Errors are those beside a reference; where there is none, they are left out.
    """
    run, before, iteration = scene.run, scene.before, scene.frame.iteration
    say = scene.look.say
    rows = [_Row("this run", _cells(run, iteration))]
    if before is not None and scene.is_paired:
        rows = _paired(run, before, iteration, scene.look.units)
    elif before is not None:
        name = Phrase("run before ({})", escape(before.title))
        rows.append(_Row(name, _cells(before, before.iteration)))
    shown = [name for name in FIGURES if has_reference(run.settings) or name not in ERRORS]
    head = "".join(f"<th>{explained(say(name), say=say)}</th>" for name in shown)
    body = "".join(
        f'<tr><th title="{say(row.whole or row.name)}" aria-label="{say(row.whole or row.name)}">'
        f"{say(row.name)}</th>{_row(row.cells, shown, say)}</tr>"
        for row in rows
    )
    kind = "method paired" if scene.is_paired else "method"
    table = f"<thead><tr><th></th>{head}</tr></thead><tbody>{body}</tbody>"
    return f'{_of_the_thing(scene)}<table class="{kind}">{table}</table>'


def _of_the_thing(scene: Scene) -> str:
    """Say what became of the thing, of run A below that of run B (HTML)."""
    lines = [(scene.run, scene.frame, scene.frame.iteration)]
    if scene.is_paired and scene.before is not None and scene.shadow is not None:
        lines.append((scene.before, scene.shadow, scene.before.shown))
    found, say = [], scene.look.say
    for name, (run, frame, iteration) in zip("BA", lines, strict=False):
        said = [f"{say(title)} <b>{value}</b>" for title, value in thing(run, frame).items()]
        said = [f"<b>{name}</b>", *said] if scene.is_paired else said
        how = f'<span class="how">{say(_in_short(run, iteration))}</span>'
        words = "".join(f"<span>{explained(one, say=say)}</span>" for one in said)
        found.append(f'<div class="thing">{words}{how}</div>')
    return "".join(found) + _from_theirs(scene)


def _from_theirs(scene: Scene) -> str:
    """Say how far it is from results of another program that lie beside it (HTML)."""
    beside, say = scene.beside, scene.look.say
    if beside is None:
        return ""
    brought, distance = beside.brought, beside.of(scene.frame.iterate)
    name = f"<i>{escape(brought.source)}</i>"
    far = f"<b>{percent(distance)}</b>" if math.isfinite(distance) else say("nothing to compare")
    of = say(brought.quantity.capitalize())
    words = f"<span>{say('Distance to')} {name}: {of} {far}</span>"
    rows = say(Phrase("{} of {} rows", beside.counted, len(brought.times)))
    return f'<div class="thing">{words}<span class="how">{rows}</span></div>'


def thing(run: Recording, frame: Frame) -> dict[str, str]:
    """Give what became of the thing: at the chosen instant, and the energy of all of them."""
    loop, look, fields = run.stand.loop, frame.look, frame.fields
    column = instant_of(look.phase, len(fields.end_displacement))
    values = (fields.end_displacement, run.stand.load if fields.load is None else fields.load)
    both = zip((loop.across, loop.up), values, strict=True)
    known = [(*one, own) for one, own in both if own is not None]
    # A moment over a rotation has neither.
    title, unit, along = next((one for one in known if one[1] in ("m", "N")), known[0])
    status = fields.status[:, instant_of(look.phase, fields.status.shape[1])]
    if frame.strand is not None:
        status = frame.strand.status
    solution = Solution(frame.iterate, [], run.status or CANCELLED)
    energy = FinishedRun(run.settings, solution, False, frame.sampler.loop).dissipated.sum()
    found = {
        title: measured(float(along[column]), unit, look.units),
        "Slips": percent(float(np.mean((status != 0) & (status != STATUS_OPEN)))),
        "Energy lost": measured(float(energy), "J", look.units),
    }
    if (stress := _stress(frame)) is not None:
        found["Largest stress"] = measured(stress, "Pa", look.units)
    found |= _of_strand(run, frame)
    return {name: text.replace("-", "−") for name, text in found.items()}


def _of_strand(run: Recording, frame: Frame) -> dict[str, str]:
    """Give how stiff a strand is as it is bent now, and how far stress swings in the last cycle."""
    strand, field, moment = run.stand.strand, frame.strand, frame.fields.load
    if strand is None or field is None or moment is None:
        return {}
    curvature = frame.fields.end_displacement
    now = instant_of(frame.look.phase, len(curvature))
    step = slice(max(now - 1, 0), max(now, 1) + 1)
    bent = np.ptp(curvature[step])
    found = {"Stress range": measured(float(field.ranges().max()), "Pa", frame.look.units)}
    if bent > 0.0:
        share = float(np.ptp(moment[step]) / bent) / strand.bending.stuck
        found["Bending stiffness"] = percent(share)
    return found


def _stress(frame: Frame) -> float | None:
    """Give the largest von Mises stress at the chosen instant, Pa, where bodies are drawn."""
    look = frame.look
    if not any(view.plot.equal and view.name in look.views for view in VIEWS):
        return None
    mesh = frame.mesh
    if mesh is not None and look.stress != STRESSES[0]:
        mesh = frame.sampler.mesh_field(frame.iterate, replace(look, stress=STRESSES[0]))
    return None if mesh is None else float(mesh.stress.max())


def _in_short(run: Recording, iteration: int) -> str:
    """Say in a few words how the method did."""
    now = run.figures_of(iteration)
    if now is None:
        return UNKNOWN
    done = min(iteration, run.searched)
    counted = "{} iteration, {} wrong, {} s" if done == 1 else "{} iterations, {} wrong, {} s"
    error = now["error_force"] if math.isfinite(now["error_force"]) else now["estimated_error"]
    wrong = "0 %" if error < NONE else percent(error)
    return Phrase(counted, done, wrong, f"{now['seconds']:.2g}")


def _row(cells: Mapping[str, str], shown: Sequence[str], say: Language) -> str:
    if not cells:
        return f'<td colspan="{len(shown)}">{say(NONE_YET)}</td>'
    return "".join(f"<td>{say(cells[name])}</td>" for name in shown)


class _Row(NamedTuple):
    """A run's name (HTML) and figures; its whole name, where that is longer than there is room."""

    name: str
    cells: Mapping[str, str]
    whole: str = ""


def _paired(run: Recording, twin: Recording, iteration: int, units: str) -> list[_Row]:
    """Give the figures of run B, and of run A as far as B in iterations, and in time."""
    return [
        _compared("B", run, twin, "as A", iteration, units),
        _compared("A", twin, run, "as B", twin.shown, units),
        _at_equal_time(run, twin, iteration),
    ]


def _compared(
    name: str, run: Recording, other: Recording, alike: str, iteration: int, units: str
) -> _Row:
    """Give the figures of a run, which is called by what it has other than the other one."""
    changes = changes_of(run.settings, other.settings)
    few, all_of_them = (
        f"{name} ({escape(label_of(run.settings, changes, units, most) or alike)})"
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


FIGURES: dict[str, Callable[[Mapping[str, float], Recording], str]] = {
    "Iteration": lambda now, run: run.called(int(now["iteration"])).removeprefix("iteration "),
    "LATIN indicator η": lambda now, run: number(now["indicator"]),
    "k-free indicator": lambda now, run: number(now["behaviour"]),
    "Estimated force error": lambda now, run: percent(now["estimated_error"]),
    "Displacement error": lambda now, run: percent(now["error_displacement"]),
    "Friction force error": lambda now, run: percent(now["error_force"]),
    "Run time": lambda now, run: f"{1e3 * now['seconds']:.1f} ms",
    "Iterations to 1 %": lambda now, run: str(run.first_within(0.01) or UNKNOWN),
}
"""What is told of an iteration of a run."""
