"""Cycles of a load: their loops, what each takes, and where the last one wears the interface."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from app.picture.cycled import Cycled
from app.picture.units import measured
from app.views.drawing.colors import BLUE, GREY, LINES, ORANGE, shaded
from app.views.drawing.drawing import POSITION, Curve, Drawing, Plot, View, is_plane
from app.views.drawing.legend import Key
from app.views.drawing.scales import ROOM, Limits, along, held, spanned
from app.views.scene import Scene
from solver.phrases import Phrase
from solver.settings import Settings
from solver.study.quantities.cycles import cycles_in
from solver.study.quantities.shakedown import Fate

MOST_LOOPS = 12
"""Loops that are drawn at most; more cannot be told apart."""
WIDEST, ALL_BARS = 16.0, 200.0
"""Width of a bar, and of all together, px."""


@lru_cache(maxsize=8)
def has_cycles(settings: Settings) -> bool:
    """Tell whether there are cycles to compare."""
    return cycles_in(settings) > 1


def draw_loops(scene: Scene, kept: tuple[Limits, Limits] | None) -> Drawing:
    """Draw force over displacement from the first cycle to the last, and what becomes of slip."""
    found, begun = scene.frame.cycles, scene.run.stand
    fields = scene.frame.fields
    force = begun.load if fields.load is None else fields.load
    assert force is not None
    moved, axes = fields.end_displacement, begun.loop
    limits = tuple(
        held(kept and kept[place], float(values.min()), float(values.max()))
        for place, values in enumerate((moved, force))
    )
    x, y = (
        spanned(*ends, label=title, unit=unit)
        for ends, (title, unit) in zip(limits, (axes.across, axes.up), strict=True)
    )
    ends = np.searchsorted(begun.all_instants, found.times)
    curves = [Curve(moved[: ends[0] + 1], force[: ends[0] + 1], GREY, 1.5)]
    colors, shown = _colors(found), _loops(found)
    for number in shown:
        part = slice(ends[number], ends[number + 1] + 1)
        curves.append(Curve(moved[part], force[part], colors[number]))
    return Drawing(
        x,
        y,
        curves,
        keys=_keys(colors, "line"),
        sentence=_sentence(found, scene.look.units),
        kept=limits,
    )


def draw_energy(scene: Scene, kept: Limits | None) -> Drawing:
    """Draw the energy of every cycle as a bar."""
    found = scene.frame.cycles
    energy, colors = found.energy, _colors(found)
    limits = held(kept, 0.0, max(float(energy.max()), 0.0))
    width = min(WIDEST, max(ALL_BARS / len(energy), 1.5))
    curves = [
        Curve([number + 1.0] * 2, [0.0, float(value)], colors[number], width)
        for number, value in enumerate(energy)
    ]
    return Drawing(
        spanned(0.5, len(energy) + 0.5),
        spanned(*limits, label="Energy", unit="J"),
        curves,
        keys=_keys(colors, "square"),
        sentence=_sentence(found, scene.look.units),
        kept=limits,
    )


def draw_fretting(scene: Scene, _kept: None) -> Drawing:
    """Draw slip and friction work of the last cycle along the interface, each over its largest."""
    found, places = scene.frame.cycles, scene.run.stand.positions
    unit = "J/m^2" if is_plane(scene.run.settings) else "J/m"
    curves, keys = [], []
    for name, values, own, color, width in (
        ("friction work", found.work, unit, ORANGE, 5.0),
        ("slip", found.slip, "m", BLUE, 2.5),
    ):
        largest = float(values.max())
        curves.append(Curve(places, values / (largest or 1.0), color, width))
        told = Phrase("{}, {}", name, measured(largest, own, scene.look.units))
        keys.append(Key(color, "line", told))
    y = spanned(0.0, ROOM, label=Phrase("{} ({})", "Last cycle", "of peak"))
    return Drawing(along(0.0, scene.length), y, curves, keys=keys)


def _colors(found: Cycled) -> list[str]:
    """Give a colour to each cycle, from the first to the last."""
    return shaded(len(found.energy), LINES)


def _loops(found: Cycled) -> list[int]:
    """Choose the cycles whose loops are drawn, the last above the others."""
    count = len(found.energy)
    chosen = np.linspace(0, count - 1, min(count, MOST_LOOPS))
    return sorted({round(float(one)) for one in chosen})


def _keys(colors: Sequence[str], mark: str) -> list[Key]:
    ends = {1: colors[0], len(colors): colors[-1]}
    return [Key(color, mark, Phrase("cycle {}", number)) for number, color in ends.items()]


def _sentence(found: Cycled, units: str) -> str:
    """Say what becomes of slip, with the numbers that say so."""
    if not found.slips:
        return "Nothing slips."
    fate = found.fate
    if fate is None:
        return "No three cycles that are alike, or tend to nothing, say yet what becomes of slip."
    return _WORDS[fate.word](fate, units)


_WORDS = {
    "elastic shakedown": lambda fate, units: Phrase(
        "Elastic shakedown: nothing slips from cycle {} on.", fate.since
    ),
    "shakedown with slip that dies": lambda fate, units: Phrase(
        "Shakedown with slip that dies: the last cycle slips {} of what the one before did.",
        f"{100.0 * fate.ratio:.2g} %",
    ),
    "steady slip": lambda fate, units: Phrase(
        "Steady slip: every cycle takes {}, and slips {} where it slips most.",
        *_measured(fate, units),
    ),
    "ratcheting": lambda fate, units: Phrase(
        "Ratcheting: every cycle takes {}, and leaves {} of slip behind.",
        *_measured(fate, units, fate.net),
    ),
}


def _measured(fate: Fate, units: str, slip: float | None = None) -> tuple[str, str]:
    far = abs(fate.slip if slip is None else slip)
    return measured(fate.energy, "J", units), measured(far, "m", units)


LOOPS = View("Cycles", Plot("End displacement", "Force"), draw_loops, has_cycles)
ENERGY = View("Cycle energy", Plot("Cycle", "Energy", whole="x"), draw_energy, has_cycles)
FRETTING = View("Fretting", Plot(POSITION, "Last cycle"), draw_fretting, has_cycles)
