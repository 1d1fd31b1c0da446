"""Base of the settings of a scene, with the properties that follow from them.

A settings object is checked once, where it is made, and cannot be changed; `replace`
gives a new one.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from functools import cached_property
from typing import ClassVar, Literal, NamedTuple, Self

import numpy as np
import param

from solver.discrete import discretise
from solver.discrete.probes import LoopFields
from solver.discrete.problem import Problem
from solver.discrete.structure import Structure
from solver.reference.closed_forms import ExactCurve
from solver.refusal import RefusedError
from solver.settings.definitions import properties_of
from solver.settings.load import LoadSettings
from solver.settings.values import SettingError

LARGEST_FIELD = 25_000_000
"""Largest number of nodes times instants; a run keeps about ten fields over them."""
COARSEST = 6
"""Smallest number of elements of a coarsened mesh: fewer show no front of slip."""


class Icon(NamedTuple):
    """A small picture of a scene: paths as in SVG, on a field of 48 times 32."""

    ground: str
    body: str
    load: str


class Settings(LoadSettings):
    """Settings of a scene: of method, friction, time, and of the scene itself."""

    length: param.Number[float]
    friction: param.Number[float]
    """Every scene defines these, where it shows them."""
    SMALL: ClassVar[Mapping[str, object]]
    """Settings with which a run takes next to no time, for tests."""

    title: ClassVar[str]
    source: ClassVar[str]
    """Title and source of the scene."""
    icon: ClassVar[Icon]
    kind: ClassVar[Literal["rod", "wires", "helices", "plane"]]
    """Kind of the bodies: a rod on its support, wires beside each other, wires around a
    core, or plane bodies."""
    CHIEF: ClassVar[tuple[str, ...]]
    ALSO_CHIEF: ClassVar[tuple[str, ...]] = (
        "seed",
        "friction",
        "substructures",
        "k_scale",
    )
    """Chief settings of the scene in their order of importance: those of the scene
    itself, and those of friction and the method."""
    GROWS: ClassVar[tuple[str, ...]]
    """Settings that are raised together for a larger structure of the same kind."""
    MESH: ClassVar[tuple[str, ...]] = ("elements",)
    """Numbers of elements: twice each is a mesh of half the size."""
    PARTS: ClassVar[Mapping[str, str]] = {"substructures": "elements"}
    """Numbers of parts, and the numbers that they divide and cannot exceed."""
    opens: ClassVar[bool] = False
    """Contact may open, so that the contact pressure is an unknown."""
    has_joints: ClassVar[bool] = False
    """Bodies touch each other at joints, and not along the whole of the next one."""

    @cached_property
    def bodies(self) -> Structure:
        """The bodies, with all loads and supports, as data."""
        raise NotImplementedError

    def structure(self) -> Structure:
        """Bodies with all loads and supports."""
        return self.bodies

    def sentence(self) -> str:
        """Describe bodies, loads and friction in a sentence."""
        raise NotImplementedError

    def of_loose(self, refusal: RefusedError) -> RefusedError:
        """Refusal of loose bodies by the setting that is to hold them, if there is."""
        return refusal

    def coarser(self) -> Iterator[Problem]:
        """Yield the same problem on ever coarser meshes, without cuts.

        The last mesh is the coarsest one that shows a front of slip, has the same
        instants, and fits the settings. (In a strand, the broken wire's break moves to
        the nearest node, and friction beyond it may then carry less than the tension.)
        """
        coarse = self
        while (elements := coarse.elements // 2) >= COARSEST:
            try:
                coarse = coarse.replace(elements=elements, substructures=1)
            except SettingError:
                return
            # A start on other instants would have to be interpolated in time.
            if not np.array_equal(coarse.times(), self.times()):
                return
            yield discretise(self.on_mesh_of(coarse))

    def on_mesh_of(self, coarser: Self) -> Structure:
        """Bodies of these settings on the mesh of coarser settings."""
        return coarser.structure()

    def exact(
        self, problem: Problem, solution: LoopFields | None = None
    ) -> Iterable[ExactCurve]:
        """Closed forms of the scene, as curves; none by default.

        The solution is that of an incremental solver: closed forms of contact are for
        its forces.
        """
        return ()

    @property
    def n_jumps(self) -> int:
        """Number of jumps of all contacts: the size of a reference's matrix."""
        components = 2 if self.opens else 1
        return components * self.n_interfaces * (self.elements + 1)

    @property
    def contact_length(self) -> float:
        """Largest position along the contacts, m."""
        return float(self.length)

    @property
    def loop_is_over_displacement(self) -> bool:
        """Check whether the loop of the scene is a force over a displacement, m."""
        return True

    @property
    def n_interfaces(self) -> int:
        """Number of interfaces, each of which may have its own mu."""
        return self.n_bodies - 1

    def has(self, name: str) -> bool:
        """Check whether the scene has a setting that applies and is not 0."""
        return bool(self.values().get(name)) and self.applies(name)

    def changed_meanings(self) -> Mapping[str, str]:
        """Describe settings that had another meaning in files of the first format.

        Sentences without the name of the setting, by name, of settings that apply.
        """
        return {}

    def load_settings(self) -> Mapping[str, str]:
        """Settings that place or scale loads, by the load: "right x", "body".

        "right x" is a load along a side, "body" one throughout. Of several settings of
        a load the last one counts that is not 0, or else the first.
        """
        settings: dict[str, str] = {}
        for name, definition in self.definitions().items():
            if not self.applies(name):
                continue
            for load in properties_of(definition).places:
                # A setting that is 0 places a load only if no other does.
                if load not in settings or getattr(self, name):
                    settings[load] = name
        return settings

    def with_change(self, name: str, value: object) -> Self:
        """Copy of the settings with one change; counts of parts are lowered to fit."""
        changes = {name: value}
        for part, whole in self.PARTS.items():
            if name == whole and isinstance(value, int) and value < getattr(self, part):
                changes[part] = max(value, self.definitions()[part].bounds[0])
        return self.replace(**changes)

    @property
    def largest_counts(self) -> dict[str, int]:
        """Largest allowed number of each kind of parts, by the name of its setting."""
        return {part: getattr(self, whole) for part, whole in self.PARTS.items()}

    def check_together(self) -> None:
        """Refuse more parts than elements or wires, and fields beyond the memory."""
        super().check_together()
        for part, whole in self.PARTS.items():
            largest = getattr(self, whole)
            if getattr(self, part) > largest:
                raise self.refusal(
                    part,
                    f"{self.definitions()[part].bounds[0]} to {whole} ({largest})",
                    f"lower {part} or raise {whole}",
                )
        self._check_field()

    def _check_field(self) -> None:
        """Refuse more instants than a field of all nodes can have in memory."""
        largest = LARGEST_FIELD // self.n_nodes
        if self.n_instants <= largest:
            return
        remedy = "give paths with fewer points or cycles, or a coarser mesh"
        # More instants than were set come from points of paths.
        if self.n_instants == self.instants:
            remedy = "give fewer instants, or a coarser mesh"
        raise SettingError(
            "instants",
            self.n_instants,
            f"at most {largest} with {self.n_nodes} nodes",
            remedy,
        )
