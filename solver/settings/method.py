"""Settings of the method of all scenes, and checks and changes of settings."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache, cached_property
from typing import Any, ClassVar, Self

import param

from solver.settings.definitions import (
    DECOMPOSITION,
    METHOD,
    SettingGroup,
    properties_of,
)
from solver.settings.values import (
    SettingError,
    checked_value,
    had_no_effect,
    unknown_setting,
)

STOP = SettingGroup("Stop")


def _on_modes(settings: MethodSettings) -> bool:
    """Check whether the linear stage uses a sum of modes (PGD)."""
    return bool(settings.linear_stage == "pgd")


class MethodSettings(param.Parameterized):
    """Settings of the method; derived classes add those of load, friction and scenes.

    `checked` is the one place at which values are verified, each alone and all
    together. Settings never change; `replace` makes new ones.
    """

    scene: str = ""

    METHODS: ClassVar[Mapping[str, Mapping[str, object]]] = {
        "fast": {
            "search_direction": "auto",
            "acceleration": "anderson",
            "start": "nested",
            "relaxation": 0.8,
            "finish": "at-once",
            "tolerance": 1e-3,
        },
        "paper": {
            "search_direction": "paper",
            "acceleration": "none",
            "start": "zero",
            "relaxation": 0.8,
            "finish": "none",
            "tolerance": 1e-10,
        },
    }
    """Values of the settings that `method` sets at once. A scene without one of these
    options keeps its own default."""

    substructures = DECOMPOSITION.count(
        10,
        (1, 20_000),
        (1, 50),
        "Number of pieces (substructures) that a body is cut into. Each is solved by "
        "itself in every iteration, then joined with the others.",
    )
    multiscale = DECOMPOSITION.switch(
        True,
        "Also balance the mean forces between substructures at every iteration, by a "
        "small coarse problem. Without it, a load travels one substructure an "
        "iteration.",
        title="Multiscale (coarse problem)",
        applies=lambda settings: settings.is_divided,
    )
    method = METHOD.choice(
        "fast",
        ["fast", "paper"],
        "fast: what reaches the accuracy soonest. paper: the iteration of the paper. "
        "Sets search direction, acceleration, start, relaxation, finish and tolerance "
        "at once; each can be changed afterwards.",
    )
    search_direction = METHOD.choice(
        "auto",
        ["paper", "auto"],
        "How k, the stiffness that joins the two stages of an iteration, is chosen. "
        "paper: from the length of a substructure. auto: at points that may slip, from "
        "the length that is expected to slide; between bodies that turn out to slip "
        "nowhere, from their depth.",
    )
    k_scale = METHOD.quantity(
        1.0,
        (1e-6, 1e6),
        (0.01, 100.0),
        "Multiplies the search direction k, the stiffness along which a point goes to "
        "and fro between its contact law and balance: other iterations, the same "
        "solution.",
        title="Factor on k",
    )
    relaxation = METHOD.quantity(
        0.8,
        (0.01, 1.0),
        (0.1, 1.0),
        "How far an iteration goes towards its new result: 1 all the way "
        "(Peaceman-Rachford), 0.5 half of it (Douglas-Rachford). Less is slower and "
        "safer.",
    )
    linear_stage = METHOD.choice(
        "full",
        ["full", "pgd"],
        "full: a value for every point and instant. pgd: a sum of a few modes, each a "
        "shape in space times a function of time (model reduction). That holds many "
        "cycles of a load in a fraction of the memory; full fields come sooner to any "
        "error.",
    )
    pgd_modes = METHOD.count(
        10,
        (1, 1000),
        (1, 20),
        "Most modes kept for a substructure; the smallest are dropped. Many cycles of "
        "a load need no more than one.",
        title="Most PGD modes",
        applies=_on_modes,
    )
    pgd_tolerance = METHOD.quantity(
        1e-7,
        (1e-14, 1.0),
        (1e-12, 1e-3),
        "Share of a substructure's field that may be lost: so much is dropped with the "
        "smallest modes, and no mode is added for a residual below it. Most of a field "
        "is displacement: with 1e-4, 15 % of a contact force were lost.",
        title="PGD tolerance",
        applies=_on_modes,
    )
    pgd_pairs = METHOD.count(
        2,
        (1, 1000),
        (1, 10),
        "Most modes that one iteration adds to a substructure.",
        title="PGD pairs per iteration",
        applies=_on_modes,
    )
    pgd_sharing = METHOD.quantity(
        1e-5,
        (0.0, 1.0),
        (0.0, 0.5),
        "Equal substructures use the same modes if these miss at most this share of "
        "each one's field. 0: each has modes of its own.",
        title="PGD basis sharing",
        applies=lambda settings: _on_modes(settings) and settings.is_divided,
    )
    acceleration = METHOD.choice(
        "anderson",
        ["none", "anderson"],
        "anderson: combine the last iterates so that the two stages agree best, which "
        "saves iterations. none: take the newest as it is.",
        applies=lambda settings: not _on_modes(settings),
    )
    start = METHOD.choice(
        "nested",
        ["zero", "nested"],
        "zero: start from nothing. nested: start from the solution on half the "
        "elements, which the incremental solver finds; the run time includes that.",
    )
    finish = METHOD.choice(
        "at-once",
        ["none", "accuracy", "at-once"],
        "When a status step ends the run: keep the present stick, slip and opening, "
        "solve the linear problem that is left, and take its solution if it obeys all "
        "laws. at-once: as soon as one holds. accuracy: once the iterates themselves "
        "are within the accuracy; the answer is then put beside them. none: only "
        "iterate.",
    )
    accuracy = STOP.quantity(
        0.01,
        (1e-12, 1.0),
        (1e-6, 0.1),
        "The run ends when friction, and pressure where it is not known, are each "
        "estimated to be wrong by less than this share; 0.01 is 1 %.",
    )
    tolerance = STOP.quantity(
        1e-3,
        (1e-30, 1.0),
        (1e-16, 1e-2),
        "Unless a status step ends it, a run also goes on until the LATIN indicator η "
        "is below this. η is not an error.",
        title="Tolerance on η",
    )
    max_iterations = STOP.count(
        1000,
        (1, 1_000_000),
        (10, 5000),
        "The run stops after so many iterations, converged or not.",
        title="Most iterations",
    )
    threads = METHOD.count(
        1,
        (1, 64),
        (1, 4),
        "Threads that share an iteration on a large structure, where the machine has "
        "nothing else to do. The results are the same to the bit.",
    )

    @property
    def n_bodies(self) -> int:
        """Number of bodies, each of which is cut into substructures."""
        return 1

    @property
    def is_divided(self) -> bool:
        """Check whether there is more than one substructure."""
        return self.n_bodies * self.substructures > 1

    @classmethod
    @cache
    def definitions(cls) -> Mapping[str, Any]:
        """Definition of every setting, by name, in the order of their groups."""
        definitions = {}
        for name in cls.param:
            parameter = cls.param[name]
            # Parameters of param itself, as `name`, are no settings.
            if "about" in (parameter.metadata or {}):
                definitions[name] = parameter
        return definitions

    @classmethod
    def checked(cls, values: Mapping[str, object]) -> Self:
        """Make settings from values by name; others follow from method or defaults.

        Raises
        ------
        SettingError
            If a name is unknown, a value has a wrong type or is out of range, or values
            do not fit together.
        """
        return cls._of(cls._clean(values))

    @classmethod
    def _clean(cls, values: Mapping[str, object]) -> dict[str, Any]:
        """Plain values by name, each checked separately."""
        definitions = cls.definitions()
        clean = {}
        for name, value in values.items():
            if had_no_effect(name, value):
                continue
            if name not in definitions:
                raise unknown_setting(name, value, cls.scene, definitions)
            clean[name] = checked_value(definitions[name], name, value)
        return clean

    @classmethod
    def _of(cls, values: dict[str, Any]) -> Self:
        """Settings of plain values that have been checked separately."""
        usual = cls.defaults("fast")
        complete = {**cls.defaults(values.get("method", "fast"))} | values
        # To set a value takes param some time, even where it is the default, which is
        # that of the fast method.
        changed = {}
        for name, value in complete.items():
            if value is not usual[name]:
                changed[name] = value
        settings = cls(**changed)
        settings.check_together()
        return settings

    @classmethod
    @cache
    def defaults(cls, method: str) -> Mapping[str, Any]:
        """Value of every setting if only the method is given, by name."""
        definitions = cls.definitions()
        values = {name: each.default for name, each in definitions.items()}
        for name, value in cls.METHODS[method].items():
            options = getattr(definitions[name], "objects", (value,))
            # A scene may lack an option of a choice, as a nested start.
            if value in options:
                values[name] = value
        return values

    @classmethod
    def of_method(cls, method: str) -> dict[str, Any]:
        """Values of the settings that a method sets, by name."""
        return {name: cls.defaults(method)[name] for name in cls.METHODS[method]}

    def check_together(self) -> None:
        """Refuse values that are inconsistent; derived classes extend this."""

    def values(self) -> dict[str, Any]:
        """Plain value of every setting, by name."""
        return dict(self._values)

    @cached_property
    def _values(self) -> Mapping[str, Any]:
        """Value of every setting, by name."""
        # Values never change, and param takes longer for all of them than an iteration.
        return {name: getattr(self, name) for name in self.definitions()}

    def changed(self, base: Self | None = None) -> dict[str, Any]:
        """Values that differ from those of other settings, or from the defaults.

        Where the method differs, too, the settings that it sets are compared with the
        values that it sets.
        """
        defaults = self.defaults(self.method)
        if base:
            defaults = base.values()
            # Values that come with another method are no choice of their own.
            if base.method != self.method:
                defaults |= self.of_method(self.method)
        changed = {}
        for name, value in self._values.items():
            if value != defaults[name]:
                changed[name] = value
        return changed

    def replace(self, /, **changes: object) -> Self:
        """Copy of the settings with some values changed, checked as a whole.

        Another method brings its own values of all settings that a method sets.
        """
        values = self.values()
        if changes.get("method", self.method) != self.method:
            # Values that the old method brought would count as chosen.
            for name in self.METHODS[self.method]:
                del values[name]
        # Values that stay have been checked before.
        return self._of(values | self._clean(changes))

    def refusal(self, name: str, allowed: str, remedy: str) -> SettingError:
        """Refusal of the value of a setting, with what is allowed and a remedy."""
        return SettingError(name, getattr(self, name), allowed, remedy)

    def applies(self, name: str) -> bool:
        """Check whether a setting has an effect under the present values."""
        record = properties_of(self.definitions()[name])
        if record.path and not isinstance(getattr(self, record.path), str):
            return False
        return record.applies(self)
