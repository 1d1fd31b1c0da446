"""Settings of a scene: those that all have, and what is known of a scene by its settings alone.

A settings object is checked once, at the edge, and cannot be changed; `replace` gives a
new one.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import ClassVar, Literal, NamedTuple, Self

import numpy as np
import param

from solver.discrete.problem import Problem
from solver.discrete.structure import LoopFields, Structure
from solver.reference.closed_forms import ExactCurve
from solver.settings.definitions import SettingError, about
from solver.settings.load import LoadSettings

LARGEST_FIELD = 25_000_000
"""Nodes times instants; a run keeps about ten fields over them."""
COARSEST = 6
"""Elements below which a mesh is not coarsened: a front needs a few to be seen at
all."""


class Icon(NamedTuple):
    """A small picture by which a scene is known: paths as in SVG, on a field of 48 times 32."""

    ground: str
    body: str
    load: str


class Settings(LoadSettings):
    """Settings of a scene: those of the method, of friction and of time, and its own."""

    length: param.Number[float]
    friction: param.Number[float]
    """Every scene defines these, where it shows them."""
    SMALL: ClassVar[Mapping[str, object]]
    """Settings with which a run takes next to no time, for tests."""

    title: ClassVar[str]
    source: ClassVar[str]
    """What it is called, and where it comes from."""
    icon: ClassVar[Icon]
    kind: ClassVar[Literal["rod", "wires", "helices", "plane"]]
    """What there is to see: a rod on its support, wires beside each other, wires around
    a core, or plane bodies."""
    CHIEF: ClassVar[tuple[str, ...]]
    ALSO_CHIEF: ClassVar[tuple[str, ...]] = (
        "seed",
        "friction",
        "substructures",
        "k_scale",
    )
    """Settings that a scene is about, in the order in which one thinks of them: its
    own, and those of friction and the method."""
    GROWS: ClassVar[tuple[str, ...]]
    """Settings by which the structure becomes larger as it is, all of them together."""
    MESH: ClassVar[tuple[str, ...]] = ("elements",)
    """Numbers of elements: twice each is a mesh of half the size."""
    PARTS: ClassVar[Mapping[str, str]] = {"substructures": "elements"}
    """Numbers of parts, and the numbers that they are parts of and cannot exceed."""
    opens: ClassVar[bool] = False
    """Whether contact may open, so that what presses is an unknown."""
    has_joints: ClassVar[bool] = False
    """Whether bodies touch each other at joints, and do not lie on the next all
    along."""

    def structure(self) -> Structure:
        """Bodies, with all that acts on them."""
        raise NotImplementedError

    def sentence(self) -> str:
        """What there is, what acts on it, and what rubs, for whoever sees it for the first time."""
        raise NotImplementedError

    def coarser(self) -> Iterator[Problem]:
        """Yield the same problem, uncut, on ever coarser meshes, as long as a front is seen.

        Until it does not fit its mesh, as where the break of a wire, at the nearest
        node, leaves less than the tension to friction, or where a mesh so coarse has
        more instants.
        """
        coarse = self
        while (elements := coarse.elements // 2) >= COARSEST:
            try:
                coarse = coarse.replace(elements=elements, substructures=1)
            except SettingError:
                return
            if not np.array_equal(coarse.times(), self.times()):
                return
            yield coarse.structure().discretise()

    def exact(
        self, problem: Problem, solution: LoopFields | None = None
    ) -> Iterable[ExactCurve]:
        """What is known of the scene without a mesh; often that is nothing.

        The solution is that of an incremental solver: closed forms of contact are for
        its forces.
        """
        return ()

    @property
    def jumps(self) -> int:
        """Components of all contacts, which a reference condenses; none on a lone rod."""
        return (2 if self.opens else 1) * self.n_interfaces * (self.elements + 1)

    @property
    def loop_is_over_displacement(self) -> bool:
        """Whether the force of its loop stands over a displacement, m."""
        return True

    @property
    def n_interfaces(self) -> int:
        """Number of interfaces of which each may have its own mu."""
        return self.n_bodies - 1

    def has(self, name: str) -> bool:
        """Whether there is such a setting, which does something and is not 0."""
        return bool(self.values().get(name)) and self.applies(name)

    def changed_meanings(self) -> Mapping[str, str]:
        """Describe settings that meant something else in files of before, by name.

        Of those that do something; a sentence without its name.
        """
        return {}

    def behind(self) -> Mapping[str, str]:
        """Settings that place or scale what acts on the scene, where any does.

        By what they are behind: "right x" along a side, "body" throughout. Of several
        the last counts that is not 0.
        """
        settings: dict[str, str] = {}
        for name, definition in self.definitions().items():
            for place in about(definition).places:
                if self.applies(name) and (
                    place not in settings or getattr(self, name)
                ):
                    settings[place] = name
        return settings

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
        """Refuse more parts than there is to deal out, fields beyond memory, and no law at all."""
        super().check_together()
        for part, whole in self.PARTS.items():
            value = getattr(self, part)
            most = getattr(self, whole)
            if value > most:
                raise self.refusal(
                    part,
                    f"{self.definitions()[part].bounds[0]} to {whole} ({most})",
                    f"lower {part} or raise {whole}",
                )
        most = LARGEST_FIELD // self.n_nodes
        if self.n_instants > most:
            raise SettingError(
                "instants",
                self.n_instants,
                f"at most {most} with {self.n_nodes} nodes",
                "give fewer instants, or a coarser mesh"
                if self.n_instants == self.instants
                else "give paths with fewer points or cycles, or a coarser mesh",
            )
