"""Settings of what is done to a bar beside pressing it: its ends, heat, a support that moves."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import param

from solver.definitions import CurveParameter, choice, quantity
from solver.discrete.rods import End, Rods
from solver.scenes.shared import sized_path
from solver.scenes.words import acting, listed

ENDS = ("held", "spring", "pulled", "free")
HOLDING = ("held", "spring")
PATHS = {
    "left": {"force": "left_load", "displacement": "support_load"},
    "right": {"force": "load", "displacement": "right_load"},
}
"""Settings of the paths of both ends."""


def is_end(side: str, *kinds: str) -> Callable[[Any], bool]:
    """Make the question whether an end is one of these."""
    return lambda settings: getattr(settings, f"{side}_end") in kinds


def end(side: str, default: str) -> param.Selector[str]:
    """Define what holds or pulls an end."""
    return choice(
        default,
        ENDS,
        f"What is at the {side} end. held: it stands still, or is moved. spring: a spring holds it "
        "to what stands still, or is moved. pulled: by a force. free: nothing.",
        group="Ends",
        title=f"{side.capitalize()} end",
    )


def spring(side: str) -> param.Number[float]:
    """Define the spring of an end."""
    return quantity(
        1e6,
        (1e-9, 1e18),
        (1e3, 1e9),
        f"Stiffness of the spring at the {side} end.",
        group="Ends",
        title=f"Spring at the {side} end",
        unit="N/m",
        applies=is_end(side, "spring"),
    )


def moved_end(side: str, path: str, preset: str) -> tuple[param.Number[float], CurveParameter]:
    """Define how far what holds an end is moved, and its path."""
    return sized_path(
        path,
        f"displacement of the {side} end",
        "m",
        0.0,
        (-1e12, 1e12),
        (0.0, 1e-3),
        f"Largest displacement of what holds the {side} end; 0 leaves it where it is.",
        preset,
        applies=is_end(side, *HOLDING),
        group="Ends",
        places=(f"{side} x",),
    )


def end_of(settings: Any, side: str) -> End:
    """The end as a part of the structure."""
    kind, paths = getattr(settings, f"{side}_end"), PATHS[side]
    if kind == "free":
        return End()
    if kind == "pulled":
        return End(force=settings.path(paths["force"]))
    stiffness = getattr(settings, f"{side}_spring") if kind == "spring" else np.inf
    return End(displacement=settings.path(paths["displacement"]), spring=stiffness)


def ends_in_words(rods: Rods) -> tuple[str, str]:
    """How the ends are held or left alone, and what is done to them."""
    still: dict[str, list[str]] = {}
    moved = []
    for side, end in rods.ends.items():
        the = f"its {side} end"
        if end.force is not None:
            outward = end.force if side == "right" else -end.force
            moved.append(f"{the} is {acting(outward, 'pulled', 'pushed')}")
        elif end.displacement is not None and end.displacement.any():
            at = f"the spring at {the}" if end.is_on_spring else the
            moved.append(f"{at} is {acting(end.displacement, 'moved', 'moved back')}")
        else:
            word = "on a spring" if end.is_on_spring else "held" if end.is_prescribed else "free"
            still.setdefault(word, []).append(the)
    rests = [
        f"{word} at {'both ends' if len(ends) == 2 else ends[0]}" for word, ends in still.items()
    ]
    return listed(rests) if rests else "", ", and ".join(moved)
