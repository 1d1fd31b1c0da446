"""A tour of all controls of a scene: each is moved to its ends and back, wherever it applies."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import param
from ropes import SMALL_ROPE

from app.controls.refusals import last_that_holds
from solver.definitions import CurveParameter, Parameter, SettingError
from solver.scenes import CATALOGUE, points_of
from solver.settings import Settings

SIZES: dict[str, dict[str, Any]] = {
    "bar": {"elements": 12, "instants": 11, "substructures": 4},
    "strand": {"elements": 12, "instants": 11, "substructures": 3},
    "block": {"elements": 8, "elements_up": 3, "instants": 6},
    "layers": {"elements": 12, "instants": 11, "layers": 2, "substructures": 2},
    "fault": {"elements": 8, "elements_up": 4, "instants": 9},
    "incline": {"elements": 12, "elements_up": 4, "instants": 11},
    "rope": {**SMALL_ROPE, "elements": 8, "instants": 11},
}
"""Of every scene, so small that hundreds of runs take seconds."""
NEVER = {scene: {"start"} for scene in ("block", "fault", "layers", "incline")}
"""Settings of a scene that nothing makes apply."""
Reach = Callable[[Settings, str], list[Any]]


@dataclass(frozen=True)
class Move:
    """One control is moved.

    Attributes
    ----------
    name, value
        What is moved, and where to.
    before, after
        The settings; `after` is None where the move is refused.
    """

    name: str
    value: Any
    before: Settings
    after: Settings | None

    @property
    def starts_a_run(self) -> bool:
        return self.after is not None and self.after.values() != self.before.values()


def described(move: Move) -> str:
    return f"{move.name} = {move.value!r} after {move.before.changed()}"


def small(scene: str) -> Settings:
    return CATALOGUE[scene].settings.checked(SIZES[scene])


def never_apply(scene: str) -> set[str]:
    return NEVER.get(scene, set())


def has_choice(definition: Parameter) -> bool:
    return not isinstance(definition, param.Selector) or len(definition.objects) > 1


def all_values(settings: Settings, name: str) -> list[Any]:
    """Give both ends of a slider, and all that can be chosen, a table of points included."""
    definition = settings.definitions()[name]
    if isinstance(definition, CurveParameter):
        tables = [] if not isinstance(getattr(settings, name), str) else [points_of(settings, name)]
        return [*definition.presets, *tables]
    if isinstance(definition, param.Boolean):
        return [False, True]
    if isinstance(definition, param.Selector):
        return list(definition.objects)
    return list(definition.softbounds)


def ends(settings: Settings, name: str) -> list[Any]:
    """Give the first and the last of all values."""
    values = all_values(settings, name)
    return [values[0], values[-1]]


def one_end(settings: Settings, name: str) -> list[Any]:
    """Give the first or the last of all values, now the one and now the other; where it moves."""
    place = list(settings.definitions()).index(name) % 2
    chosen, other = ends(settings, name)[:: (-1) ** place]
    return [other if chosen == getattr(settings, name) else chosen]


def tour(base: Settings, reach: Reach) -> Iterator[Move]:
    """Move every control that applies, or can be made to, through its reach and back.

    Where an end is refused, the farthest value towards it is taken. What a move brings along is
    brought back after it. The tour ends where it began.
    """
    for preparation, names in _openings(base):
        there = base
        for name, value in preparation:
            there = yield from _step(there, name, value)
        for name in names:
            now = there
            for value in reach(there, name):
                now = yield from _step(now, name, value)
                if getattr(now, name) != value and isinstance(value, int | float):
                    nearest = last_that_holds(now, name, value)
                    if nearest is not None:
                        now = yield from _step(now, name, nearest)
            yield from back(now, there)
        yield from back(there, base)


def _step(now: Settings, name: str, value: Any) -> Iterator[Move]:
    try:
        after = now.with_change(name, value)
    except SettingError:
        yield Move(name, value, now, None)
        return now
    yield Move(name, value, now, after)
    return after


def back(now: Settings, goal: Settings) -> Iterator[Move]:
    """Bring back one setting after the other, those first that are not refused."""
    while now.values() != goal.values():
        wrong = [name for name, value in goal.values().items() if getattr(now, name) != value]
        for name in wrong:
            try:
                after = now.with_change(name, getattr(goal, name))
            except SettingError:
                continue
            yield Move(name, getattr(goal, name), now, after)
            now = after
            break
        else:
            raise AssertionError(f"no way back for {wrong}")


def _openings(base: Settings) -> list[tuple[tuple[tuple[str, Any], ...], list[str]]]:
    """Find changes after which more and more settings apply; the first is none at all."""
    definitions = base.definitions()

    def applying(settings: Settings) -> list[str]:
        return [
            name
            for name, definition in definitions.items()
            if settings.applies(name) and has_choice(definition)
        ]

    found = [((), applying(base))]
    states, known = [(base, *found[0])], set(found[0][1])
    for settings, changes, names in states:
        for name in names:
            for value in all_values(settings, name):
                try:
                    opened = settings.with_change(name, value)
                except SettingError:
                    continue
                fresh = [other for other in applying(opened) if other not in known]
                if fresh:
                    known.update(fresh)
                    way = (*changes, (name, value))
                    found.append((way, fresh))
                    states.append((opened, way, fresh))
    return found
