"""A user's mesh: bodies of any shape in frictional contact."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from functools import cache, cached_property
from itertools import chain
from typing import ClassVar

import numpy as np

import solver.scenes.shared as shared
from solver.discrete.plane.bodies import Bodies
from solver.discrete.plane.body import Body
from solver.discrete.plane.joint import Joint
from solver.discrete.plane.makers.named_mesh import NamedMesh
from solver.discrete.plane.makers.named_mesh_refused import check_named
from solver.discrete.problem import Problem
from solver.refusal import RefusedError, Words
from solver.scenes.mesh_files import from_text, read_example
from solver.scenes.named_sides import ALLOWED, MeshSides, conditions_of, split_phrase
from solver.scenes.plane import ShapedSettings
from solver.settings.definitions import BODY, LOAD, Rows, TablePreset, redefined
from solver.settings.load_paths import PRESETS, PRESSURES
from solver.settings.scene import Icon
from solver.settings.values import SettingError

EXAMPLES = {
    "bolted": "a plate between two covers that a bolt presses together, moved along",
    "dovetail": "the root of a blade in the groove of a disk, pulled out of it",
}
"""Meshes that come with the scene."""
LARGEST_BODY = 4_000
"""Largest number of corners of a part: its inside is condensed by dense matrices."""


@cache
def mesh_of(text: str) -> NamedMesh:
    """Checked mesh of the setting `mesh`: an example, or the text of a file."""
    if text in EXAMPLES:
        mesh = read_example(text)
    else:
        mesh = from_text(text)
    check_named(mesh)
    return mesh


def _same_for_all(settings: MeshSettings) -> Rows:
    """Rows of the table of materials if all bodies have the same."""
    row = settings.young, settings.poisson, settings.unit_weight
    return tuple((number, *row) for number in range(1, settings.n_bodies + 1))


class MeshSettings(ShapedSettings):
    """Settings of a mesh; by default plates that a bolt presses together."""

    scene = "mesh"
    title = "Mesh of one's own"
    source = "from first principles; meshes by Gmsh and what else meshio reads"
    icon = Icon(
        ground="M4 29H44",
        body="M18 3H30V10L35 17H13L18 10ZM6 12H12L9 19V22H39V19L36 12H42V28H6Z",
        load="M24 1V8M22 3L24 1L26 3",
    )
    CHIEF = ("mesh", "displacement", "traction", "pressure", "load")
    ALSO_CHIEF = ("friction", "substructures", "multiscale")
    GROWS = ("substructures",)
    MESH = ()
    PARTS: ClassVar = {}
    SMALL: ClassVar = {"instants": 9}
    across = "length"

    mesh = BODY.text(
        "bolted",
        EXAMPLES,
        "a file that meshio reads, as .msh of Gmsh",
        "Mesh of all bodies: one that comes with Slipfront, or a file. Names of its "
        "surfaces are bodies. Named lines between two bodies are contacts, those "
        "outside are sides; behind the name of a side may stand what happens to it, as "
        "in “left held”.",
        is_file=True,
        title="Mesh",
    )
    scale = BODY.quantity(
        1.0,
        (1e-9, 1e9),
        (1e-3, 1.0),
        "Length of a unit of the coordinates in the mesh: 0.001 m where it is in mm.",
        title="Unit of the mesh",
        unit="m",
    )
    sides = LOAD.text(
        "",
        {"": "as the names of the sides say: bottom and fixed are held, top is moved"},
        ALLOWED,
        "What happens to sides, between commas, as in “left held, right moved x”: "
        "free, held, held x, held y, moved x, moved y, pulled (by the traction), "
        "pressed (by the pressure). Sides that are left out do as their names say.",
        title="Sides",
    )
    displacement = LOAD.quantity(
        3e-5,
        (-1e6, 1e6),
        (-1e-4, 1e-4),
        "Largest displacement of sides that are moved.",
        unit="m",
        applies=lambda settings: settings.has_condition("moved"),
        path="load",
        places=("body",),
    )
    traction = LOAD.quantity(
        1e7,
        (-1e15, 1e15),
        (0.0, 1e8),
        "Largest traction on sides that are pulled, outwards.",
        unit="Pa",
        applies=lambda settings: settings.has_condition("pulled"),
        path="load",
        places=("body",),
    )
    load = LOAD.curve(
        "sine",
        PRESETS,
        {"time": "s", "value": "m or Pa"},
        "Displacement or traction over time: a preset of the largest value, or points "
        "(s, m or Pa).",
        title="Path of the load",
        applies=lambda settings: settings.has_condition("moved", "pulled"),
    )
    pressure, pressure_load = shared.sized_path(
        "pressure_load",
        "pressure",
        "Pa",
        5e7,
        (0.0, 1e15),
        (0.0, 2e8),
        "Pressure on sides that are pressed.",
        "steady",
        PRESSURES,
        applies=lambda settings: settings.has_condition("pressed"),
    )
    unit_weight = shared.unit_weight(
        0.0,
        "all bodies",
        applies=lambda settings: settings.materials == "same",
    )
    materials = BODY.curve(
        "same",
        {"same": TablePreset("E, ν and weight of all bodies", _same_for_all)},
        {"body": "", "modulus": "Pa", "ratio": "", "weight": "N/m^3"},
        "Material of each body: a preset, or rows (body, Young's modulus, Poisson's "
        "ratio, weight per volume), one for each in the order of the mesh, numbered "
        "from 1 on.",
        bounds=((1, 100_000), (1.0, 1e18), (0.0, 0.4999), (0.0, 1e12)),
        title="Materials",
    )
    friction_factors = shared.friction_factors("of the mesh, in its order")
    young = redefined(
        ShapedSettings.param["young"],
        210e9,
        applies=lambda settings: settings.materials == "same",
    )
    poisson = redefined(
        ShapedSettings.param["poisson"],
        0.3,
        applies=lambda settings: settings.materials == "same",
    )

    @cached_property
    def parts(self) -> NamedMesh:
        """Bodies, contacts and sides of the mesh; coordinates in metres.

        Raises
        ------
        SettingError
            For a mesh that is refused.
        """
        try:
            return mesh_of(self.mesh).scaled(self.scale)
        except RefusedError as refusal:
            raise _of_setting("mesh", refusal) from None

    @cached_property
    def conditions(self) -> Mapping[str, tuple[str, ...]]:
        """Conditions on each side, by the name of its line."""
        lines = dict.fromkeys(side.name for side in self.parts.sides)
        return conditions_of(list(lines), self.sides)

    @property
    def _every_condition(self) -> list[str]:
        """Conditions on any of the sides."""
        return list(chain.from_iterable(self.conditions.values()))

    def has_condition(self, *verbs: str) -> bool:
        """Check whether any side is moved, pulled or pressed."""
        try:
            every = self._every_condition
        except RefusedError:
            # Settings that are refused show all of their controls.
            return True
        return any(condition.startswith(verbs) for condition in every)

    @property
    def n_bodies(self) -> int:
        """Number of bodies."""
        return len(self.parts.names)

    @property
    def n_interfaces(self) -> int:
        """Number of contacts."""
        return len(self.parts.contacts)

    @property
    def n_nodes(self) -> int:
        """Number of nodes of all bodies."""
        return sum(len(shape.nodes) for shape in self.parts.shapes)

    @property
    def n_jumps(self) -> int:
        """Number of components of all contacts."""
        return 2 * sum(len(contact.nodes) for contact in self.parts.contacts)

    @property
    def length(self) -> float:  # type: ignore[override]  # follows from the mesh
        """Longer side of a rectangle about the mesh, m."""
        return self.parts.size

    @property
    def contact_unit(self) -> float:
        """Unit of `contact_stiffness`, N/m^3, by the modulus of the stiffest body."""
        moduli = [young for _, young, *_ in self.points("materials")]
        return max(moduli) / self.length

    @property
    def largest_counts(self) -> dict[str, int]:
        """Largest number of parts of each body."""
        counts = [len(shape.elements) for shape in self.parts.shapes]
        return {"substructures": min(counts)}

    def coarser(self) -> Iterator[Problem]:
        """Yield nothing: a mesh from a file has no coarser mesh."""
        return iter(())

    def check_together(self) -> None:
        """Refuse a mesh, sides or materials that do not fit together."""
        try:
            conditions = self.conditions
        except RefusedError as refusal:
            raise _of_setting(refusal.name, refusal) from None
        every = {condition.split()[0] for condition in self._every_condition}
        if not every & {"held", "moved"}:
            names = ", ".join(split_phrase(line)[0] for line in conditions) or "no name"
            raise self.refusal(
                "sides",
                "at least one side that is held or moved",
                f"write what holds one of the sides of the mesh: {names}",
            )
        if {"moved", "pulled"} <= every:
            raise self.refusal(
                "sides",
                "sides that are moved or pulled, as both have one path",
                "take pressed for one of them",
            )
        super().check_together()
        self._check_tables()
        largest = self.largest_counts["substructures"]
        if self.substructures > largest:
            raise self.refusal(
                "substructures",
                f"at most {largest}, the elements of the smallest body",
                "lower it, or make the mesh finer",
            )
        corners = max(shape.n_corners for shape in self.parts.shapes)
        if corners > LARGEST_BODY * self.substructures:
            raise self.refusal(
                "substructures",
                f"parts of at most {LARGEST_BODY} corners of elements",
                f"a body has {corners}: give more, or make the mesh coarser",
            )

    def _check_tables(self) -> None:
        """Refuse tables without a row for each body or contact."""
        shared.factors_of(self)
        numbers = [row[0] for row in self.points("materials")]
        if numbers != list(range(1, self.n_bodies + 1)):
            names = ", ".join(self.parts.names)
            raise self.refusal(
                "materials",
                f"{self.n_bodies} rows, one for each body, numbered from 1",
                f"there are {len(numbers)}: give those of {names}, in this order",
            )

    def of_loose(self, refusal: RefusedError) -> RefusedError:
        """Refusal of sides that leave bodies free."""
        return SettingError(
            "sides",
            refusal.value,
            "sides that leave no body free to move or to turn, where all contacts are "
            "closed and stick",
            "hold one more side, or one along the other axis, too",
        )

    def left_out(self) -> Iterator[str]:
        """Yield sentences on names and rows of tables that a run ignores."""
        yield from super().left_out()
        between = [name for name, bodies in self.parts.groups if len(bodies) > 1]
        for name in dict.fromkeys(between):
            _, conditions = split_phrase(name)
            if conditions:
                yield (
                    f"mesh: “{name}” is a contact where it lies between two bodies; "
                    f"{' and '.join(conditions)} says nothing there"
                )

    @cached_property
    def bodies(self) -> Bodies:
        """The bodies; one metre thick."""
        bodies = list(self._bodies())
        sides = MeshSides(self.parts, self.conditions)
        drive = np.zeros(self.n_instants)
        if self.has_condition("moved", "pulled"):
            drive = self.path("load")
        held = list(sides.held(drive))
        loads = list(sides.loads(bodies, drive, self.path("pressure_load")))
        moved = [each.name for each in held if np.any(each.displacement)]
        pulled = [load.name for load in loads]
        shown = [*moved, *pulled, None]
        return Bodies(
            bodies=bodies,
            joints=list(self._joints()),
            held=held,
            loads=loads,
            instants=self.times(),
            duration=self.duration,
            state=self.plane,
            friction_law=self.law,
            macro_degree=self.macro_degree,
            shown=shown[0],
        )

    def _bodies(self) -> Iterator[Body]:
        """Bodies with their materials."""
        rows = self.points("materials")
        for name, shape, row in zip(
            self.parts.names, self.parts.shapes, rows, strict=True
        ):
            _, young, poisson, weight = row
            yield Body(
                name,
                shape,
                young,
                poisson,
                weight=self.weight(weight),
                substructures=self.substructures,
            )

    def _joints(self) -> Iterator[Joint]:
        """Contacts with their mu."""
        factors = shared.factors_of(self)
        for contact, factor in zip(self.parts.contacts, factors, strict=True):
            yield Joint(
                contact.name,
                contact.above,
                contact.nodes,
                contact.below,
                contact.nodes_below,
                contact.normals,
                friction=float(self.friction * factor),
            )

    def sentence(self) -> str:
        """Describe the bodies in a sentence."""
        parts = []
        for line, conditions in self.conditions.items():
            if conditions and conditions != ("free",):
                said = [re.sub(r" ([xy])$", r" along \1", each) for each in conditions]
                parts.append(f"“{split_phrase(line)[0]}” {' and '.join(said)}")
        sides = shared.listed(parts)
        bodies = f"{self.n_bodies} bodies of a mesh"
        return f"{bodies} {self.touch} each other; sides: {sides}."


def _of_setting(name: str, refusal: RefusedError) -> SettingError:
    """Refusal of a setting from the refusal of its content."""
    found = refusal.value
    if refusal.name != name:
        found = Words(f"{refusal.name} {refusal.value}")
    return SettingError(name, found, refusal.allowed, refusal.remedy)
