"""A wall of bricks in contact without mortar."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import cached_property
from typing import ClassVar

import numpy as np

import solver.scenes.shared as shared
from solver.arrays import Indices
from solver.discrete.plane.rectangles.bricks import Brick, bonded, grouped, with_opening
from solver.discrete.plane.rectangles.cap_and_ground import on_strips, with_cap
from solver.discrete.plane.rectangles.sides import Side, SideComponent, Support
from solver.discrete.plane.rectangles.stack import Stack
from solver.scenes.plane import RectangleSettings
from solver.settings.definitions import (
    BODY,
    CONTACT,
    DECOMPOSITION,
    LOAD,
    redefined,
)
from solver.settings.load_paths import LATER, PRESETS
from solver.settings.profiles import UNSEEN
from solver.settings.scene import Icon

SETTLEMENTS = {"delayed ramp": LATER, **PRESETS}
"""Presets of the settlement: by the first one the wall stands before it begins."""
MOST_BRICKS = 1500
"""Largest number of bricks: with their joints they take some 2 GB."""


class WallSettings(RectangleSettings):
    """Settings of the wall; by default it is pressed, and its top moves to and fro."""

    scene = "wall"
    title = "Wall of bricks"
    source = (
        "R. K. Livesley, Int. J. Numer. Meth. Eng. 12, 1978: blocks that only touch"
    )
    icon = Icon(
        ground="M3 29H45",
        body="M7 23H23V28H7ZM25 23H41V28H25ZM7 17H14V22H7ZM16 17H32V22H16ZM34 "
        "17H41V22H34ZM7 11H23V16H7ZM25 11H41V16H25Z",
        load="M14 6H34M30 3L34 6L30 9",
    )
    CHIEF = ("top_load", "displacement", "traction", "pressure")
    SMALL: ClassVar = {
        "bricks": 3,
        "courses": 3,
        "elements": 4,
        "elements_up": 2,
        "instants": 13,
        "displacement": 5e-05,
    }
    ALSO_CHIEF = ("friction", "bricks", "courses", "multiscale")
    GROWS = ("bricks", "courses")
    has_joints = True
    PARTS: ClassVar = {}

    bricks = BODY.count(
        12, (1, 200), (1, 20), "Bricks of a course.", title="Bricks along"
    )
    courses = BODY.count(6, (1, 200), (1, 20), "Courses of bricks.")
    bond = BODY.choice(
        "running",
        ["running", "stack"],
        "running: bricks lie over the joints of the course below, and every second "
        "course begins and ends with a half. stack: joints lie one above the other.",
    )
    opening = BODY.count(
        0,
        (0, 198),
        (0, 6),
        "Width of an opening in the middle, in bricks, under a lintel; 0 leaves it "
        "out.",
    )
    opening_height = BODY.count(
        3,
        (1, 199),
        (1, 10),
        "Height of the opening, in courses; the lintel is the next one.",
        title="Height of the opening",
        applies=lambda settings: settings.opening > 0,
    )
    length = shared.size(
        0.25, (0.05, 1.0), "Length of a brick", "Length of a whole brick.", BODY
    )
    height = shared.size(
        0.12, (0.02, 0.5), "Height of a brick", "Height of a course.", BODY
    )
    pressure, pressure_load = shared.sized_path(
        "pressure_load",
        "pressure",
        "Pa",
        1e6,
        (0.0, 1e15),
        (0.0, 3e6),
        "Pressure on the highest course.",
        "hold",
        places=("top y",),
    )
    top = LOAD.choice(
        "moved",
        ["moved", "pulled"],
        "What drives the top of the wall. moved: a displacement along it, with which "
        "all of it goes. pulled: a traction along it.",
    )
    displacement = LOAD.quantity(
        1e-4,
        (-1e6, 1e6),
        (-2e-4, 2e-4),
        "Largest displacement of the top along the wall.",
        unit="m",
        applies=lambda settings: settings.top == "moved",
        path="top_load",
        places=("top x",),
    )
    traction = LOAD.quantity(
        2e5,
        (-1e15, 1e15),
        (-1e6, 1e6),
        "Largest traction on the top along the wall.",
        unit="Pa",
        applies=lambda settings: settings.top == "pulled",
        path="top_load",
        places=("top x",),
    )
    top_load = LOAD.curve(
        "delayed",
        PRESETS,
        {"time": "s", "value": "m or Pa"},
        "Displacement or traction of the top over time: a preset of the largest value, "
        "or points (s, m or Pa).",
        title="Path of the top",
    )
    slope, slope_load = shared.sized_path(
        "slope_load",
        "slope of the ground",
        "°",
        0.0,
        (-89.0, 89.0),
        (-45.0, 45.0),
        "Largest angle by which the ground is tilted, the right end upwards.",
        "delayed",
    )
    settlement, settlement_load = shared.sized_path(
        "settlement_load",
        "settlement",
        "m",
        0.0,
        (-1e3, 1e3),
        (0.0, 5e-3),
        "Largest distance by which a part of the ground goes down. The wall then "
        "stands on strips of ground, one element high and as stiff as the bricks.",
        "delayed ramp",
        SETTLEMENTS,
        title="Settlement of the ground",
        places=("bottom y",),
    )
    settled_length = LOAD.quantity(
        0.5,
        (1e-6, 1e4),
        (0.25, 3.0),
        "Length of the ground that settles, rounded to elements.",
        title="Length that settles",
        unit="m",
        applies=lambda settings: settings.is_active("settlement_load"),
    )
    settled_from = LOAD.quantity(
        1.25,
        (0.0, 1e4),
        (0.0, 3.0),
        "Distance of the ground that settles from the left end of the wall, rounded to "
        "elements.",
        title="Settles from",
        unit="m",
        applies=lambda settings: settings.is_active("settlement_load"),
    )
    cap = BODY.choice(
        "none",
        ["none", "free", "guided"],
        "A stiff plate on the highest course, as high as a course. free: it turns as "
        "the bricks below let it. guided: it stays level; its ends stand out by an "
        "element and are held upright.",
        title="Cap on the wall",
    )
    unit_weight = shared.unit_weight(2e4, "the bricks")
    friction = redefined(RectangleSettings.param["friction"], 0.6)
    head_friction = CONTACT.quantity(
        1.0,
        (0.0, 1e3),
        (0.0, 2.0),
        "Factor on μ of the joints between bricks of a course.",
        title="μ of head joints over μ",
    )
    ground_friction = CONTACT.quantity(
        1.0,
        (0.0, 1e3),
        (0.0, 2.0),
        "Factor on μ between the wall and the ground.",
        title="μ of the ground over μ",
    )
    plane = redefined(RectangleSettings.param["plane"], "stress")
    young = redefined(RectangleSettings.param["young"], 1e10)
    poisson = redefined(RectangleSettings.param["poisson"], 0.2)
    instants = redefined(RectangleSettings.param["instants"], 41)
    elements = redefined(
        RectangleSettings.param["elements"], 6, title="Elements of a brick along"
    )
    elements_up = redefined(
        RectangleSettings.param["elements_up"], 3, title="Elements of a brick up"
    )
    macro_degree = redefined(RectangleSettings.param["macro_degree"], 2)
    substructures = redefined(
        RectangleSettings.param["substructures"], 1, applies=lambda _: False
    )
    substructures_up = redefined(
        RectangleSettings.param["substructures_up"], 1, applies=lambda _: False
    )
    brick_groups = DECOMPOSITION.count(
        MOST_BRICKS,
        (1, MOST_BRICKS),
        (1, 80),
        "Groups of bricks between which macro forces are in balance; within a group "
        "none are. With as many as there are bricks the coarse problem is whole, with "
        "one there is none.",
        title="Groups of bricks",
        applies=lambda settings: settings.multiscale,
    )
    friction_profile = redefined(
        RectangleSettings.param["friction_profile"], "uniform", applies=lambda _: False
    )

    @property
    def n_bodies(self) -> int:
        """Number of bricks, halves and a lintel among them."""
        return len(self._bricks)

    @property
    def contact_length(self) -> float:
        """Largest position along the contacts, m: the length of the wall."""
        return float(self.bricks * self.length)

    @cached_property
    def _bricks(self) -> list[Brick]:
        """Bricks of the wall, halves and a lintel among them."""
        size = self.elements, self.elements_up
        bricks = bonded(self.bond, self.bricks, self.courses, size)
        if not self.opening:
            return bricks
        first = (self.bricks - self.opening) // 2
        columns = first, first + self.opening
        return with_opening(bricks, size, columns, self.opening_height)

    @property
    def _groups(self) -> Indices | None:
        """Group of every brick, (n_bricks,); None where each is a group of its own."""
        if self.brick_groups >= self.n_bodies:
            return None
        size = self.elements, self.elements_up
        return grouped(self._bricks, size, self.brick_groups)

    @property
    def largest_counts(self) -> dict[str, int]:
        """Largest number of each kind of parts: each brick may be a group."""
        return super().largest_counts | {"brick_groups": self.n_bodies}

    @property
    def n_jumps(self) -> int:
        """Number of components of all contacts: a further joint adds two bed nodes."""
        beds = self.elements * self.bricks + 2 * self.bricks + 1
        heads = self.bricks * (self.elements_up - 1)
        return int(2 * self.courses * (beds + heads))

    def check_together(self) -> None:
        """Refuse an opening, elements or numbers of bricks that do not fit together."""
        if self.opening:
            beside = f"two of {self.bricks} bricks stay beside it"
            self._check_opening("opening", self.bricks - 2, beside)
            above = f"one of {self.courses} courses is the lintel"
            self._check_opening("opening_height", self.courses - 1, above)
        super().check_together()
        is_running = self.bond == "running" and self.courses > 1
        has_halves = self.opening or is_running
        if has_halves and self.elements % 2:
            remedy = "take an even number, or bond=stack"
            raise self.refusal(
                "elements", "an even number, as there are half bricks", remedy
            )
        if self.bricks > 1 and self.elements_up < 2:
            raise self.refusal(
                "elements_up",
                "at least 2, between bricks of a course",
                "raise it",
            )
        if self.n_bodies > MOST_BRICKS:
            raise self.refusal(
                "courses",
                f"a wall of at most {MOST_BRICKS} bricks, of 2 GB",
                f"these are {self.n_bodies}: take fewer courses, or bricks of a course",
            )
        if self.cap == "guided" and self.top != "moved":
            raise self.refusal(
                "cap", "none or free where top is pulled", "take top=moved"
            )

    def _check_opening(self, name: str, largest: int, reason: str) -> None:
        """Refuse a size of the opening, in bricks or courses, beyond the largest."""
        if getattr(self, name) > largest:
            raise self.refusal(
                name,
                f"at most {max(largest, 0)}, as {reason}",
                "lower it, or build a larger wall",
            )

    @property
    def _settled(self) -> tuple[int, int]:
        """Ends of the ground that settles, in elements from the left end."""
        element = self.length / self.elements
        end = self.settled_from + self.settled_length
        return round(self.settled_from / element), round(end / element)

    @property
    def _settles(self) -> bool:
        """Check whether ground below the wall settles: it is rigid otherwise."""
        first, last = self._settled
        is_above = [
            min(last, brick.x + brick.columns) > max(first, brick.x)
            for brick in self._bricks
            if brick.y == 0
        ]
        return self.is_active("settlement_load") and any(is_above)

    def left_out(self) -> Iterator[str]:
        """Yield a sentence on ground that settles elsewhere than it should."""
        yield from super().left_out()
        if not self.is_active("settlement_load"):
            return
        wanted = np.array([self.settled_from, self.settled_from + self.settled_length])
        element = self.length / self.elements
        found = element * np.array(self._settled)
        if not self._settles:
            yield (
                f"settled_length: nothing settles below the wall from {wanted[0]:.4g} "
                f"to {wanted[1]:.4g} m, in elements of {element:.4g} m"
            )
        elif np.abs(found - wanted).max() > UNSEEN * self.settled_length:
            yield (
                f"settled_length: the ground settles from {found[0]:.4g} to "
                f"{found[1]:.4g} m, as it ends at whole elements; more elements come "
                "nearer"
            )

    @property
    def _on_ground(self) -> float:
        """Coefficient mu on the ground."""
        return float(self.friction * self.ground_friction)

    @cached_property
    def bodies(self) -> Stack:
        """The wall; one metre thick."""
        angle = np.radians(self.path("slope_load"))
        weight = self.unit_weight * self.hold
        driven = SideComponent(self.top == "moved", self.path("top_load"))
        pressed = SideComponent(False, -self.path("pressure_load"), is_pressure=True)
        stack = replace(
            self.stack(),
            bricks=self._bricks,
            groups=self._groups,
            head_friction=float(self.friction * self.head_friction),
            substructures=(1, 1),
            body_force=-weight * np.stack([np.sin(angle), np.cos(angle)]),
            sides={"top": Side(driven, pressed)},
            tilt=angle if np.any(angle) else None,
        )
        if self.cap != "none":
            stack = with_cap(stack, self.elements_up, is_guided=self.cap == "guided")
        if self._settles:
            settlement = self.path("settlement_load")
            return on_strips(stack, self._settled, settlement, self._on_ground)
        gap = np.zeros(stack.grid[0] + 1)
        return replace(stack, support=Support(gap, self._on_ground))

    def sentence(self) -> str:
        """Describe the wall in a sentence."""
        verb = "moved" if self.top == "moved" else "pulled"
        driven = shared.acting(
            self.path("top_load"),
            f"{verb} to the right",
            f"{verb} to the left",
            f"{verb} to and fro",
        )
        is_tilted = np.any(self.path("slope_load"))
        ground = "the ground"
        if is_tilted:
            ground = "a tilted ground"
        pressed = ""
        if np.any(self.path("pressure_load")):
            pressed = ", pressed from above,"
        if self.n_bodies == 1 and self.cap == "none" and not self._settles:
            return f"One brick{pressed} stands on {ground}; its top is {driven}."
        bond = "one above the other"
        if self.bond == "running":
            bond = "in running bond"
        bricks = f"{self.n_bodies} bricks {bond}"
        if self.opening:
            bricks = f"{bricks} round an opening"
        if self.cap != "none":
            pressed = f", with a stiff cap{pressed or ','}"
        if self._settles:
            ground = f"{ground}, of which a part settles"
        return (
            f"{bricks}{pressed} only touch, and {self.touch} each other and "
            f"{ground}; the top is {driven}."
        )
