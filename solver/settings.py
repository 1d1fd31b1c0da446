"""Settings: each is defined once here or in its scene, and checked once at the edge.

Widgets, URL state, command-line flags and saved files all derive from these
definitions. A settings object cannot be changed; `replace` gives a new one.
"""

from __future__ import annotations

import copy
import difflib
import json
import math
import tomllib
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path
from typing import Any, Self

import param

Pairs = tuple[tuple[float, float], ...]
Parameter = param.Parameter[Any]


class SettingError(ValueError):
    """A refused setting: the message names it, its value, the allowed range and the remedy."""

    def __init__(self, name: str, value: object, allowed: str, remedy: str) -> None:
        shown = json.dumps(value, default=str)
        shown = shown if len(shown) <= 60 else shown[:57] + "..."
        super().__init__(f"{name} = {shown} is refused; allowed: {allowed}; {remedy}")
        self.name = name


@dataclass(frozen=True)
class About:
    """What a front needs to know of a setting beyond its value.

    Attributes
    ----------
    group
        Heading under which it stands.
    title
        What a widget calls it.
    unit
        SI unit, empty for a pure number.
    logarithmic
        Whether a slider over it should be logarithmic.
    applies
        Whether it does anything, given all the settings.
    essential
        Whether it stands in the open on the page, not behind "more".
    """

    group: str
    title: str
    unit: str = ""
    logarithmic: bool = False
    applies: Callable[[Any], bool] = lambda settings: True
    essential: bool = False


class Curve(Parameter):
    """A path given by a preset's name or by pairs (abscissa, value), linear in between."""

    __slots__ = ["abscissa", "ordinate", "presets"]

    def __init__(
        self, default: str, presets: Iterable[str], abscissa: str, ordinate: str, **rest: Any
    ) -> None:
        super().__init__(default=default, **rest)
        self.presets = tuple(presets)
        self.abscissa = abscissa
        self.ordinate = ordinate


def about(parameter: Parameter) -> About:
    """Give the record of a setting's definition."""
    found: About = parameter.metadata["about"]
    return found


def quantity(
    default: float,
    bounds: tuple[float, float],
    slider: tuple[float, float],
    doc: str,
    **record: Any,
) -> param.Number[float]:
    """Define a real setting: hard `bounds`, and the range that a `slider` shows."""
    return param.Number(
        default=default,
        bounds=bounds,
        softbounds=slider,
        doc=doc,
        constant=True,
        metadata={"about": About(**record)},
    )


def count(
    default: int, bounds: tuple[int, int], slider: tuple[int, int], doc: str, **record: Any
) -> param.Integer[int]:
    """Define a whole-number setting."""
    return param.Integer(
        default=default,
        bounds=bounds,
        softbounds=slider,
        doc=doc,
        constant=True,
        metadata={"about": About(**record)},
    )


def switch(default: bool, doc: str, **record: Any) -> param.Boolean[bool]:
    """Define an on/off setting."""
    return param.Boolean(
        default=default, doc=doc, constant=True, metadata={"about": About(**record)}
    )


def choice(default: str, options: Iterable[str], doc: str, **record: Any) -> param.Selector[str]:
    """Define a setting that is one of a few names."""
    return param.Selector(
        default=default,
        objects=list(options),
        doc=doc,
        constant=True,
        metadata={"about": About(**record)},
    )


def curve(
    default: str, presets: Iterable[str], abscissa: str, ordinate: str, doc: str, **record: Any
) -> Curve:
    """Define a path: a preset's name or a table of points."""
    return Curve(
        default,
        presets,
        abscissa,
        ordinate,
        doc=doc,
        constant=True,
        metadata={"about": About(**record)},
    )


def redefined(definition: Any, default: object, **record: Any) -> Any:
    """Define a setting again for some scenes, with another default and other entries of `About`."""
    found = copy.copy(definition)
    found.default = default
    found.metadata = {"about": replace(about(definition), **record)}
    return found


def _is_reduced(settings: Settings) -> bool:
    return settings.is_reduced


def _is_sampled(settings: Settings) -> bool:
    return _is_reduced(settings) and settings.local_stage == "reduced"


class Settings(param.Parameterized):
    """Settings of the method, common to all scenes; a scene adds its own.

    `Settings.checked` is the one edge at which values are verified.
    """

    scene: str = ""

    substructures = count(
        10,
        (1, 20_000),
        (1, 50),
        "Number of substructures; their sizes differ by at most one element.",
        group="Decomposition",
        title="Substructures",
        essential=True,
    )
    multiscale = switch(
        True,
        "Solve the coarse problem: macro forces between substructures are in equilibrium at every "
        "iteration.",
        group="Decomposition",
        title="Multiscale (coarse problem)",
        applies=lambda settings: settings.n_substructures > 1,
        essential=True,
    )
    search_direction = choice(
        "paper",
        ["paper", "auto"],
        "Rule for the search direction: the paper's, from the length of a substructure, or on "
        "friction points from the length that is expected to slide and that of an element.",
        group="Method",
        title="Search direction",
        essential=True,
    )
    k_scale = quantity(
        1.0,
        (1e-6, 1e6),
        (0.01, 100.0),
        "Factor on the search direction k. Changes the path, not the limit.",
        group="Method",
        title="Factor on k",
        logarithmic=True,
        essential=True,
    )
    k_friction_scale = quantity(
        1.0,
        (1e-6, 1e6),
        (0.01, 100.0),
        "Further factor on the search direction of the friction points alone.",
        group="Method",
        title="Friction k factor",
        logarithmic=True,
    )
    relaxation = quantity(
        0.8,
        (0.01, 1.0),
        (0.1, 1.0),
        "Share of the new iterate that is kept; 0.5 is Douglas-Rachford, 1 Peaceman-Rachford.",
        group="Method",
        title="Relaxation",
        essential=True,
    )
    linear_stage = choice(
        "full",
        ["full", "pgd"],
        "How the linear stage is solved: full space-time fields, or a separated basis (PGD).",
        group="Method",
        title="Linear stage",
        essential=True,
    )
    pgd_modes = count(
        10,
        (1, 1000),
        (1, 20),
        "Most modes that a substructure's basis keeps; more are dropped, the smallest first.",
        group="Method",
        title="Most PGD modes",
        applies=_is_reduced,
        essential=True,
    )
    pgd_tolerance = quantity(
        1e-4,
        (1e-14, 1.0),
        (1e-8, 1e-1),
        "Share of a substructure's field that downsizing may drop; a residual below it is left.",
        group="Method",
        title="PGD tolerance",
        logarithmic=True,
        applies=_is_reduced,
    )
    pgd_enrichment = quantity(
        0.1,
        (0.0, 1.0),
        (0.0, 1.0),
        "Share of the residual that the update of the time functions may leave before modes are "
        "added; 0 always adds, 1 never does.",
        group="Method",
        title="PGD enrichment threshold",
        applies=_is_reduced,
    )
    pgd_pairs = count(
        2,
        (1, 1000),
        (1, 10),
        "Most pairs of modes that one iteration adds to a substructure's basis.",
        group="Method",
        title="PGD pairs per iteration",
        applies=_is_reduced,
    )
    pgd_solver = choice(
        "fixed_point",
        ["fixed_point", "singular_pair"],
        "How a pair is found: the alternating fixed point of the paper, or the leading singular "
        "pair of the residual at once.",
        group="Method",
        title="PGD pair",
        applies=_is_reduced,
    )
    pgd_fixed_point_steps = count(
        4,
        (1, 1000),
        (1, 20),
        "Most steps of the alternating fixed point.",
        group="Method",
        title="Fixed-point steps",
        applies=lambda settings: _is_reduced(settings) and settings.pgd_solver == "fixed_point",
    )
    pgd_stagnation = quantity(
        0.01,
        (0.0, 1.0),
        (0.0, 0.1),
        "The fixed point stops when a step changes the size of the pair by less than this share.",
        group="Method",
        title="Fixed-point stagnation",
        applies=lambda settings: _is_reduced(settings) and settings.pgd_solver == "fixed_point",
    )
    pgd_sharing = quantity(
        0.0,
        (0.0, 1.0),
        (0.0, 0.5),
        "Substructures of equal operators share one basis when at most this share of each one's "
        "field lies outside the other's; 0 shares nothing.",
        group="Method",
        title="PGD basis sharing",
        applies=lambda settings: _is_reduced(settings) and settings.n_substructures > 1,
    )
    local_stage = choice(
        "full",
        ["full", "reduced"],
        "Where the interface laws are evaluated: everywhere, or at reference points and instants "
        "alone, from which the basis rebuilds the field.",
        group="Method",
        title="Local stage",
        applies=_is_reduced,
    )
    local_points = quantity(
        0.5,
        (0.0, 1.0),
        (0.1, 1.0),
        "Share of the friction points that are reference points, at least one for each mode.",
        group="Method",
        title="Reference points",
        applies=_is_sampled,
    )
    local_instants = quantity(
        0.5,
        (0.0, 1.0),
        (0.1, 1.0),
        "Share of the instants that are reference instants, at least one for each mode.",
        group="Method",
        title="Reference instants",
        applies=_is_sampled,
    )
    local_refresh = count(
        5,
        (1, 1000),
        (1, 20),
        "Every so many iterations the laws are evaluated everywhere, and new references chosen.",
        group="Method",
        title="Full local stage every",
        applies=_is_sampled,
    )
    acceleration = choice(
        "none",
        ["none", "anderson"],
        "Anderson mixes the newest iterate with those before, so that their residual is least.",
        group="Method",
        title="Acceleration",
        applies=lambda settings: not _is_reduced(settings),
        essential=True,
    )
    anderson_memory = count(
        15,
        (1, 100),
        (2, 30),
        "Iterates that Anderson acceleration remembers.",
        group="Method",
        title="Anderson memory",
        applies=lambda settings: not _is_reduced(settings) and settings.acceleration == "anderson",
    )
    start = choice(
        "zero",
        ["zero", "nested"],
        "Where the iteration starts: from zero, or from the solution of coarser meshes, uncut and "
        "accelerated, each started so itself. Their time is billed to the run.",
        group="Method",
        title="Start",
        essential=True,
    )
    nested_iterations = count(
        40,
        (1, 10_000),
        (5, 100),
        "Most iterations on every coarser mesh; it gets fewer once it has given what it can.",
        group="Method",
        title="Iterations per coarser mesh",
        applies=lambda settings: settings.start == "nested",
    )
    k_update = choice(
        "none",
        ["none", "status"],
        "How the search direction changes along the run: not at all, or once, when the contact "
        "status has settled, with a smaller k where points slip; taken back if it does not help.",
        group="Method",
        title="Update of k",
        applies=lambda settings: not _is_reduced(settings),
    )
    tolerance = quantity(
        1e-10,
        (1e-30, 1.0),
        (1e-16, 1e-2),
        "The run ends when the LATIN indicator eta falls below this. Eta is not an error.",
        group="Stop",
        title="Tolerance on η",
        logarithmic=True,
        essential=True,
    )
    max_iterations = count(
        1000,
        (1, 1_000_000),
        (10, 5000),
        "The run ends after this many iterations.",
        group="Stop",
        title="Most iterations",
        logarithmic=True,
    )

    @property
    def n_substructures(self) -> int:
        """Number of substructures in all."""
        return self.substructures

    @classmethod
    def definitions(cls) -> dict[str, Parameter]:
        """Give the definition of every setting, by name, in the order of their groups."""
        return {
            name: cls.param[name]
            for name in cls.param
            if (cls.param[name].metadata or {}).get("about") is not None
        }

    @classmethod
    def checked(cls, values: Mapping[str, object]) -> Self:
        """Check values and make a settings object of them.

        Parameters
        ----------
        values
            Plain values by name; what is left out takes its default.

        Raises
        ------
        SettingError
            For an unknown name, a wrong type, a value out of range, or values that do not fit
            together.
        """
        definitions = cls.definitions()
        clean = {}
        for name, value in values.items():
            if name not in definitions:
                raise _unknown(name, value, definitions)
            clean[name] = _checked_value(definitions[name], name, value)
        settings = cls(**clean)
        settings.check_together()
        return settings

    def check_together(self) -> None:
        """Check what no setting can check alone; a scene extends this."""

    def values(self) -> dict[str, Any]:
        """Give every setting's plain value by name."""
        return {name: getattr(self, name) for name in self.definitions()}

    def changed(self) -> dict[str, Any]:
        """Give the settings that differ from their defaults."""
        definitions = self.definitions()
        return {
            name: value
            for name, value in self.values().items()
            if value != definitions[name].default
        }

    def replace(self, **changes: object) -> Self:
        """Give new settings with some values changed, checked as a whole."""
        return self.checked({**self.values(), **changes})

    def with_change(self, name: str, value: object) -> Self:
        """Change one setting and bring along those that could not stand beside it."""
        return self.replace(**{name: value})

    @property
    def n_jumps(self) -> int:
        """Components of all contacts that open or lie between bodies, which a reference condenses.

        None on a rigid support of known bound.
        """
        return 0

    @property
    def is_reduced(self) -> bool:
        """Whether the linear stage works on separated bases."""
        return bool(self.linear_stage == "pgd")

    def applies(self, name: str) -> bool:
        """Tell whether a setting does anything under the present values."""
        return about(self.definitions()[name]).applies(self)


def allowed(definition: Parameter) -> str:
    """Describe in words which values a setting takes."""
    unit = f" {about(definition).unit}" if about(definition).unit else ""
    if isinstance(definition, Curve):
        pairs = f"pairs [[{definition.abscissa}, {definition.ordinate}], ...]"
        return f"{', '.join(definition.presets)}, or {pairs}"
    if isinstance(definition, param.Boolean):
        return "true or false"
    if isinstance(definition, param.Selector):
        return ", ".join(definition.objects)
    low, high = definition.bounds
    kind = "a whole number" if isinstance(definition, param.Integer) else "a number"
    return f"{kind} from {low:g} to {high:g}{unit}"


def _unknown(name: str, value: object, known: Iterable[str]) -> SettingError:
    names = list(known)
    near = difflib.get_close_matches(name, names, n=1)
    remedy = f"did you mean {near[0]}?" if near else "correct the name or leave it out"
    return SettingError(name, value, ", ".join(names), f"there is no such setting, {remedy}")


def _checked_value(definition: Parameter, name: str, value: object) -> Any:
    def refuse(remedy: str) -> SettingError:
        return SettingError(name, value, allowed(definition), remedy)

    if isinstance(definition, Curve):
        return _checked_curve(definition, value, refuse)
    if isinstance(definition, param.Boolean):
        if not isinstance(value, bool):
            raise refuse("write true or false")
        return value
    if isinstance(definition, param.Selector):
        if value not in definition.objects:
            raise refuse("choose one of these")
        return value
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise refuse("write a number")
    if isinstance(value, float) and not math.isfinite(value):
        raise refuse("write a finite number")
    low, high = definition.bounds
    if not low <= value <= high:
        raise refuse("choose a value inside this range")
    if isinstance(definition, param.Integer):
        if value != int(value):
            raise refuse("write a whole number")
        return int(value)
    return float(value)


def _checked_curve(
    definition: Curve, value: object, refuse: Callable[[str], SettingError]
) -> str | Pairs:
    if isinstance(value, str):
        if value not in definition.presets:
            raise refuse("choose a preset, or give a table of points")
        return value
    if not isinstance(value, list | tuple) or not value:
        raise refuse("give at least one pair")
    pairs = []
    for row, pair in enumerate(value, start=1):
        if not isinstance(pair, list | tuple) or len(pair) != 2:
            raise refuse(f"row {row} must be a pair of numbers")
        if any(isinstance(entry, bool) or not isinstance(entry, int | float) for entry in pair):
            raise refuse(f"row {row} has an entry that is not a number")
        if not all(math.isfinite(entry) for entry in pair if isinstance(entry, float)):
            raise refuse(f"row {row} has an entry that is not finite")
        if any(abs(entry) > 1e15 for entry in pair):
            raise refuse(f"row {row} has an entry beyond 1e15 in size")
        pairs.append((float(pair[0]), float(pair[1])))
    for row, (before, after) in enumerate(pairwise(pairs), start=2):
        if after[0] <= before[0]:
            raise refuse(f"row {row}: {definition.abscissa} must increase from row to row")
    return tuple(pairs)


def read_table(text: str, definition: Curve, name: str, source: str) -> list[list[float]]:
    """Read a table of two columns for a curve setting.

    Parameters
    ----------
    text
        CSV whose rows are abscissa, value; a first row of names is passed over.
    definition, name, source
        The setting it is for, and where the text comes from, used in messages.

    Raises
    ------
    SettingError
        For a row without exactly two numbers.
    """
    rows: list[list[float]] = []
    for number, line in enumerate(text.rstrip().splitlines(), start=1):
        cells = [cell.strip() for cell in line.split(",")]
        if cells == [definition.abscissa, definition.ordinate] and not rows:
            continue
        try:
            first, second = cells
            rows.append([float(first), float(second)])
        except ValueError:
            remedy = f"line {number} is {line!r}, not two numbers"
            raise SettingError(name, source, allowed(definition), remedy) from None
    return rows


def _read_file(path: Path, definition: Curve, name: str) -> list[list[float]]:
    try:
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, ValueError) as problem:  # no text, or no path at all
        remedy = f"it is no preset, and no readable CSV file ({type(problem).__name__})"
        raise SettingError(name, str(path), allowed(definition), remedy) from None
    return read_table(text, definition, name, str(path))


def parse(text: str) -> object:
    """Read a setting's value from text, as typed on a command line or in an address."""
    try:
        found: dict[str, object] = tomllib.loads(f"value = {text}")
    except (ValueError, RecursionError):  # no TOML, digits beyond Python's limit, deep nesting
        return text
    return found["value"] if len(found) == 1 else text


def resolve(definition: Parameter, name: str, value: object, folder: Path) -> object:
    """Replace the name of a CSV file, sought in a folder, by its points.

    Reading files is for fronts whose user owns the machine, so nothing else does it.
    """
    if not isinstance(definition, Curve) or not isinstance(value, str):
        return value
    return value if value in definition.presets else _read_file(folder / value, definition, name)


def dump(settings: Settings) -> str:
    """Write settings as the text of a TOML file that every front reads."""
    lines = [f"{name} = {json.dumps(value)}" for name, value in settings.values().items()]
    return "\n".join([f"scene = {json.dumps(settings.scene)}", *lines, ""])
