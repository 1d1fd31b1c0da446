"""What the settings of all scenes have alike: a mesh that is cut, and paths over time."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import fields
from typing import Any, ClassVar, Self

import numpy as np

from solver.arrays import Array
from solver.definitions import Pairs, SettingError, choice, count, quantity
from solver.laws.catalogue import FRICTION_LAWS
from solver.laws.friction_law import FrictionLaw
from solver.loads import BEGINS, PRESETS, PRESSURES, instants_of, load_path
from solver.phrases import Phrase
from solver.settings import Settings

LARGEST_FIELD = 25_000_000
"""Nodes times instants; a run keeps about ten fields over them."""
POINTS = 9
"""Of a table that stands for a preset."""
FEWEST = 4
"""Instants a cycle, with which one sees that it turns."""


class SceneSettings(Settings):
    """Settings of a scene: those of the method, and its own."""

    friction_law = choice(
        "coulomb",
        list(FRICTION_LAWS),
        " ".join(f"{name}: {law.words}" for name, law in FRICTION_LAWS.items()),
        group="Contact",
        title="Friction law",
    )
    contact_stiffness = quantity(
        100.0,
        (1e-3, 1e9),
        (1.0, 1e4),
        "Stiffness of that spring, as a multiple of E S / L² along a rod, with the harmonic "
        "mean S of its elements, or of E / L in the plane; of all wires of a rope alike, as a "
        "multiple of the stiffest E S over the square of the longest L.",
        group="Contact",
        title="Contact stiffness",
        applies=lambda settings: settings.friction_law == "compliant",
        logarithmic=True,
    )

    friction_ratio = quantity(
        1.5,
        (0.0, 1e3),
        (0.5, 2.0),
        "Last friction over the first: above 1 it hardens with slip, below it softens.",
        group="Contact",
        title="Last friction over first",
        applies=lambda settings: settings.friction_law == "slip-dependent",
    )
    slip_length = quantity(
        1e-4,
        (1e-12, 1e6),
        (1e-6, 1e-2),
        "Accumulated slip of a point at which its friction is the last.",
        group="Contact",
        title="Slip length",
        unit="m",
        applies=lambda settings: settings.friction_law == "slip-dependent",
        logarithmic=True,
    )

    cycles = count(
        1,
        (1, 5000),
        (1, 20),
        "How often what the presets of load paths do, after their beginning, is done in the "
        "interval; a preset that does not come back (ramp, hold, random) stays as it is.",
        group="Load",
        title="Cycles",
        applies=lambda settings: settings.is_repeatable,
    )

    PARTS: ClassVar[Mapping[str, str]] = {"substructures": "elements"}
    """Numbers of parts, and the numbers that they are parts of and cannot exceed."""
    MESH: ClassVar[Sequence[str]] = ("elements",)
    """Numbers of elements: twice each is a mesh of half the size."""
    LOADS: ClassVar[Sequence[str]] = ()
    """Settings that say how much it is loaded; the first that applies counts."""
    PATH: ClassVar[str] = "load"
    """Setting that says how that goes on over time."""
    SHAPES: ClassVar[Mapping[str, Callable[[Array, int], Array]]] = PRESETS
    """What the presets of paths over time stand for."""

    @classmethod
    def chief(cls) -> tuple[str, ...]:
        """Name what a scene is about: the path and size of its load, friction, cuts, and k."""
        return (cls.PATH, "seed", *cls.LOADS, "friction", "substructures", "k_scale")

    def law(self) -> FrictionLaw:
        """Give the law of friction; its attributes are named like settings."""
        kind: Any = FRICTION_LAWS[str(self.friction_law)]
        found: FrictionLaw = kind(**{one.name: getattr(self, one.name) for one in fields(kind)})
        return found

    @property
    def n_nodes(self) -> int:
        """Number of nodes of all bodies."""
        raise NotImplementedError

    def size_of(self, path: str) -> float:
        """Give the largest value that a preset of a path over time reaches."""
        raise NotImplementedError

    def behind(self) -> Mapping[str, str]:
        """Name the settings that place or scale what acts on the scene, where any does.

        By what they are behind: "right x" along a side, "body" throughout, "gap", "break".
        """
        found = self._candidates()
        return {what: name for what, name in found.items() if self.applies(name)}

    def _candidates(self) -> Mapping[str, str]:
        """Name what may be behind something; `behind` leaves out what does not apply."""
        return {}

    @property
    def is_repeatable(self) -> bool:
        """Whether any load path is a preset that comes back to where it began."""
        names = (name for name in self.definitions() if f"_{name}".endswith("_load"))
        return any(getattr(self, name) in BEGINS for name in names if self.applies(name))

    def times(self) -> Array:
        """Give the instants, shape (n_instants,), s; a single one stands at the end."""
        own: Any = self  # every scene defines these, where it shows them
        return instants_of(own.duration, own.instants)

    def path(self, name: str) -> Array:
        """Give a quantity over time from the setting of its path; a table has its own size."""
        return self._along(name, self.times())

    def points(self, name: str) -> Pairs:
        """Give points of the preset that a curve setting has at present."""
        own: Any = self
        instants = np.linspace(0.0, own.duration, (POINTS - 1) * self.cycles + 1)
        return as_points(instants, self._along(name, instants))

    def _along(self, name: str, instants: Array) -> Array:
        own: Any = self
        curve: str | Pairs = getattr(self, name)
        size = self.size_of(name) if isinstance(curve, str) else 0.0
        shapes = {**self.SHAPES, **PRESSURES}
        return load_path(curve, instants, own.duration, size, own.seed, shapes, self.cycles)

    def with_change(self, name: str, value: object) -> Self:
        """Change one setting; numbers of parts that exceed it come down with it."""
        changes = {name: value}
        for part, whole in self.PARTS.items():
            if name == whole and isinstance(value, int) and value < getattr(self, part):
                changes[part] = max(value, self.definitions()[part].bounds[0])
        return self.replace(**changes)

    @property
    def ends(self) -> dict[str, int]:
        """Largest numbers of parts that there are to deal out, by the name of their setting."""
        return {part: getattr(self, whole) for part, whole in self.PARTS.items()}

    def check_together(self) -> None:
        """Refuse more parts than there is to deal out, and fields beyond memory."""
        own: Any = self
        for part, whole in self.PARTS.items():
            value, most = getattr(self, part), getattr(self, whole)
            if value > most:
                raise SettingError(
                    part,
                    value,
                    Phrase("{} to {} ({})", self.definitions()[part].bounds[0], whole, most),
                    Phrase("lower {} or raise {}", part, whole),
                )
        if self.is_repeatable and 1 < self.cycles > (own.instants - 1) // FEWEST:
            raise SettingError(
                "cycles",
                self.cycles,
                Phrase("at most {} with {} instants", (own.instants - 1) // FEWEST, own.instants),
                "give more instants",
            )
        if self.n_nodes * own.instants > LARGEST_FIELD:
            raise SettingError(
                "instants",
                own.instants,
                Phrase("at most {} with {} nodes", LARGEST_FIELD // self.n_nodes, self.n_nodes),
                "give fewer instants, or a coarser mesh",
            )


def as_points(where: Array, values: Array) -> Pairs:
    """Give points with as many digits as one likes to read."""
    return tuple((float(f"{a:.6g}"), float(f"{b:.6g}")) for a, b in zip(where, values, strict=True))
