"""A stack of layers pressed together, pulled and bent: a leaf spring, a flat cable."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import cached_property
from typing import ClassVar

import numpy as np

import solver.scenes.shared as shared
from solver.arrays import Array
from solver.discrete.plane.rectangles.bricks import Brick
from solver.discrete.plane.rectangles.sides import Side, SideComponent
from solver.discrete.plane.rectangles.stack import Stack
from solver.discrete.probes import LoopFields
from solver.discrete.problem import Problem
from solver.reference.closed_forms import ExactCurve
from solver.scenes.exact import exact_layers
from solver.scenes.plane import RectangleSettings
from solver.settings.definitions import BODY, LOAD, Rows, TablePreset, redefined
from solver.settings.load_paths import PRESETS
from solver.settings.profiles import UNSEEN
from solver.settings.scene import Icon


def _graduated(settings: LayersSettings) -> Rows:
    """Lengths of the layers of a leaf spring, as shares of the longest."""
    count = settings.layers
    return tuple((layer + 1.0, 1.0 - layer / count) for layer in range(count))


class LayersSettings(RectangleSettings):
    """Settings of the stack; by default it is pressed, then bent up and down."""

    scene = "layers"
    title = "Stack of layers, bent"
    source = "a leaf spring, or the section of a cable laid flat"
    icon = Icon(
        ground="M5 3V27",
        body="M5 6C18 6 28 8 40 14L38 18C28 12 18 11 5 11ZM5 11C18 11 28 12 38 18L36 22"
        "C28 17 18 16 5 16ZM5 16C18 16 28 17 36 22L34 26C28 22 18 21 5 21Z",
        load="M44 6V20M40 16L44 20L48 16",
    )
    CHIEF = ("bend_load", "deflection", "moment", "force")
    SMALL: ClassVar = {"elements": 16, "layers": 2, "instants": 13}
    GROWS = ("layers",)
    across = "thickness"

    pressure, pressure_load = shared.sized_path(
        "pressure_load",
        "pressure",
        "Pa",
        2e6,
        (0.0, 1e15),
        (0.0, 2e7),
        "Pressure on the top and the bottom of the stack.",
        "hold",
        places=("top y", "bottom y"),
    )
    pull, pull_load = shared.sized_path(
        "pull_load",
        "pull",
        "Pa",
        0.0,
        (-1e15, 1e15),
        (-1e8, 1e8),
        "Largest axial traction on the right end.",
        "hold",
        places=("right x",),
    )
    bending = LOAD.choice(
        "deflection",
        ["deflection", "moment", "force"],
        "What bends the stack at its right end. deflection: a given transverse "
        "displacement. moment: a given moment, force: a transverse force, which all "
        "layers that reach there share.",
    )
    deflection = LOAD.quantity(
        2e-3,
        (-1e12, 1e12),
        (-1e-2, 1e-2),
        "Largest transverse displacement of the right end.",
        unit="m",
        applies=lambda settings: settings.bending == "deflection",
        path="bend_load",
        places=("right y",),
    )
    moment = LOAD.quantity(
        1e3,
        (-1e15, 1e15),
        (-1e4, 1e4),
        "Largest moment on the right end, counter-clockwise, for a metre of thickness.",
        unit="N·m/m",
        applies=lambda settings: settings.bending == "moment",
        path="bend_load",
        places=("right x",),
    )
    force = LOAD.quantity(
        1e3,
        (-1e15, 1e15),
        (-1e4, 1e4),
        "Largest force on the right end, up, for a metre of thickness.",
        title="Force at the end",
        unit="N/m",
        applies=lambda settings: settings.bending == "force",
        path="bend_load",
        places=("right y",),
    )
    bend_load = LOAD.curve(
        "delayed",
        PRESETS,
        {"time": "s", "value": "m or N·m/m or N/m"},
        "Deflection, moment or force over time: a preset of the largest value, or "
        "points (s, m or N·m/m or N/m).",
        title="Path of the bending",
    )
    friction_factors = shared.friction_factors("between two layers, from the lowest on")
    layers = BODY.count(
        4,
        (2, 50),
        (2, 12),
        "Number of layers.",
    )
    length = shared.size(0.5, (0.05, 5.0), "Length", "Length of the stack.", BODY)
    thickness = shared.size(
        0.01, (0.001, 0.1), "Thickness of a layer", "Thickness of one layer.", BODY
    )
    layer_lengths = BODY.curve(
        "equal",
        {
            "equal": TablePreset("1 of each", lambda own: shared.same_for(own.layers)),
            "graduated": TablePreset(
                "each is shorter than the one below it by the same step, as in a leaf "
                "spring",
                _graduated,
            ),
        },
        {"layer": "", "share": ""},
        "Length of each layer, from the lowest on, as a share of the length, to the "
        "nearest element: a preset, or points (layer, share), one for each. What is "
        "given at the right end holds for the longest; pressure acts on all that lies "
        "open.",
        title="Length of each layer",
    )
    contrast = BODY.quantity(
        1.0,
        (1e-6, 1e6),
        (0.01, 100.0),
        "Young's modulus of every second layer over that of the others, the lowest "
        "among them.",
        title="Stiffness contrast",
    )
    elements_up = redefined(RectangleSettings.param["elements_up"], 2)
    substructures_up = redefined(RectangleSettings.param["substructures_up"], 1)
    macro_degree = redefined(RectangleSettings.param["macro_degree"], 2)

    @property
    def n_bodies(self) -> int:
        """Number of bodies."""
        return self.layers

    @property
    def spans(self) -> tuple[int, ...]:
        """Number of elements along every layer."""
        counts = np.maximum(np.rint(self._shares * self.elements), 1)
        return tuple(counts.astype(int).tolist())

    @property
    def _shares(self) -> Array:
        """Lengths of the layers as shares of the longest, (n_layers,)."""
        return np.array(self.points("layer_lengths"))[:, 1]

    @property
    def n_nodes(self) -> int:
        """Number of nodes of all layers."""
        return sum(span + 1 for span in self.spans) * self.nodes[1]

    @property
    def loop_is_over_displacement(self) -> bool:
        """Check whether the loop is a force over a displacement, not a moment."""
        return bool(self.bending != "moment")

    def check_together(self) -> None:
        """Refuse tables without one length per layer, one factor per interface."""
        shares = shared.of_each(self, "layer_lengths", self.layers, "layer")
        if shares.min() <= 0.0 or shares.max() != 1.0:
            raise self.refusal(
                "layer_lengths",
                "shares above 0, the largest of them 1",
                "give each length over that of the longest layer",
            )
        super().check_together()
        shared.factors_of(self)

    def left_out(self) -> Iterator[str]:
        """Yield sentences on lengths that a run rounds to elements."""
        yield from super().left_out()
        off = float(np.abs(np.array(self.spans) / self.elements - self._shares).max())
        if off > UNSEEN:
            yield (
                f"layer_lengths: layers end at whole elements, up to {100.0 * off:.2g} "
                "% of the length from where they should; more elements come nearer"
            )

    @cached_property
    def bodies(self) -> Stack:
        """The stack; its left end is clamped; one metre thick."""
        up = self.elements_up
        bricks = [
            Brick(0, layer * up, span, up) for layer, span in enumerate(self.spans)
        ]
        stack = replace(self.stack(), bricks=bricks)
        rest = np.zeros(self.n_instants)
        held = SideComponent(True, rest)
        free = SideComponent(False, rest)
        pressing = self.path("pressure_load")
        return replace(
            stack,
            friction=shared.factors_of(self)[:, None] * stack.friction,
            stiffness=np.where(np.arange(self.layers) % 2, self.contrast, 1.0),
            sides={
                "left": Side(held, held),
                "right": self._right_side(stack),
                "top": Side(free, SideComponent(False, -pressing, is_pressure=True)),
                "bottom": Side(free, SideComponent(False, pressing, is_pressure=True)),
            },
        )

    def _right_side(self, stack: Stack) -> Side:
        """Load of the right end: the pull along x, and the bending."""
        bend = self.path("bend_load")
        pull = SideComponent(False, self.path("pull_load"))
        if self.bending == "force":
            return Side(
                pull, SideComponent(False, bend / (stack.longest * self.thickness))
            )
        if self.bending == "moment":
            # A linear traction with the extreme s at the edges of a layer has the
            # moment s h^2 / 6, with the thickness h.
            extreme = -6.0 * bend / (stack.longest * self.thickness**2)
            free = SideComponent(False, np.zeros(self.n_instants))
            return Side(replace(pull, slope=extreme), free)
        return Side(pull, SideComponent(True, bend))

    def exact(
        self, problem: Problem, solution: LoopFields | None = None
    ) -> Iterator[ExactCurve]:
        """Force that bends the layers, if they act separately or as one."""
        return exact_layers(self.bodies, problem, solution)

    def sentence(self) -> str:
        """Describe the stack in a sentence."""
        kind = "steel" if shared.is_steel(self.young) else "elastic"
        layers = f"{self.layers} {kind} layers"
        if self.layer_lengths != "equal":
            layers = f"{layers} of different lengths"
        pressed = "lie on each other"
        if np.any(self.path("pressure_load")):
            pressed = "are pressed together and slide freely"
            if self.is_rough:
                pressed = "are pressed together and rub"
        bent = self.path("bend_load")
        pull = self.path("pull_load")
        ends = shared.acting(bent, "bent up", "bent down", "bent up and down")
        if pull.any():
            ends = f"{ends}, and {shared.acting(pull, 'pulled', 'pushed')}"
        return f"{layers}, held at the left, {pressed}; the right end is {ends}."
