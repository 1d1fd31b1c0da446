"""Results that loads and friction leave alone are kept, and have the same bits."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from small_scenes import SMALL

from solver.arrays import Array
from solver.cache import CACHE, Cache, content_of
from solver.discrete.schur_complement import SchurComplement
from solver.reference.condensation import Condensation
from solver.reference.incremental import reference_of
from solver.reference.solution import Reference
from solver.scenes import CATALOGUE, discretise
from solver.settings.scene import Settings
from solver.settings.values import SettingError
from solver.study.random_runs import draw

SCENES = ("block", "layers", "fault", "incline", "wall", "strand")
"""Scenes whose contacts are condensed."""
OF_ANY_SHAPE = ("arch", "belt", "bundle")
"""Scenes of bodies of any shape."""
SEED = 91
LOADS = {
    "block": {"top_tangential_displacement": 3e-5},
    "layers": {"deflection": 0.003},
    "incline": {"slope": 37.0},
    "wall": {"displacement": 3e-5},
    "strand": {"peak": 700.0},
}
"""A load of each that differs from that of its small settings."""


def small(scene: str, **changes: Any) -> Settings:
    """Small settings of a scene with some changes."""
    return CATALOGUE[scene].checked(SMALL[scene] | changes)


def with_more_friction(settings: Settings) -> Settings:
    """The same settings with a little more friction."""
    return settings.replace(friction=1.05 * settings.friction)


def solved(settings: Settings) -> Reference:
    """Reference of settings."""
    return reference_of(discretise(settings))


def is_same(first: Reference, second: Reference) -> bool:
    """Check whether two references are equal to the bit."""
    fields = ("displacement", "deformation", "contact_force", "status")
    return all(
        getattr(first, name).tobytes() == getattr(second, name).tobytes()
        for name in fields
    )


@pytest.fixture(autouse=True)
def _nothing_kept() -> None:
    CACHE.clear()


@pytest.mark.parametrize("scene", SCENES)
def test_more_friction_leaves_the_stiffness_as_it_is(scene: str) -> None:
    settings = small(scene)
    before = Condensation(discretise(settings))
    after = Condensation(discretise(with_more_friction(settings)))
    assert after.stiffness is before.stiffness
    assert after.motions is before.motions
    CACHE.clear()
    alone = Condensation(discretise(with_more_friction(settings)))
    assert alone.stiffness is not before.stiffness
    assert alone.stiffness.tobytes() == after.stiffness.tobytes()
    assert alone.load.tobytes() == after.load.tobytes()


@pytest.mark.parametrize("scene", [*SCENES, *OF_ANY_SHAPE, "bar", "rope"])
def test_a_run_after_another_is_as_the_first(scene: str) -> None:
    settings = small(scene)
    moved = with_more_friction(settings)
    first = solved(moved)
    CACHE.clear()
    solved(settings)
    assert is_same(solved(moved), first)


@pytest.mark.parametrize("scene", LOADS)
def test_a_load_changes_the_load_alone(scene: str) -> None:
    settings = small(scene)
    moved = small(scene, **LOADS[scene])
    first = solved(moved)
    CACHE.clear()
    assert not is_same(solved(settings), first)
    assert is_same(solved(moved), first)


@pytest.mark.parametrize(
    "changes",
    [{"poisson": 0.2}, {"elements": 12}, {"layers": 3}],
)
def test_another_structure_has_another_stiffness(changes: dict[str, Any]) -> None:
    before = Condensation(discretise(small("layers")))
    after = Condensation(discretise(small("layers", **changes)))
    assert after.stiffness is not before.stiffness
    CACHE.clear()
    alone = Condensation(discretise(small("layers", **changes)))
    assert after.stiffness.tobytes() == alone.stiffness.tobytes()


def test_bricks_of_the_next_run_share_the_operators() -> None:
    settings = small("wall")
    before = discretise(settings).substructures
    after = discretise(with_more_friction(settings)).substructures
    for first, second in zip(before, after, strict=True):
        assert first.elasticity is second.elasticity


@pytest.mark.parametrize("scene", ["wall", *OF_ANY_SHAPE])
def test_the_next_run_condenses_no_substructure(
    scene: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    settings = small(scene)
    discretise(settings)
    with monkeypatch.context() as patched:
        patched.setattr(SchurComplement, "__init__", None)
        discretise(with_more_friction(settings))
    CACHE.clear()
    monkeypatch.setattr(SchurComplement, "__init__", None)
    with pytest.raises(TypeError):
        discretise(settings)


@pytest.mark.parametrize(
    "changes",
    [{"thickness": 0.25}, {"young": 3e10}, {"elements": 3}, {"substructures": 2}],
)
def test_another_arch_has_the_operators_of_a_first_one(changes: dict[str, Any]) -> None:
    discretise(small("arch"))
    after = discretise(small("arch", **changes)).substructures
    CACHE.clear()
    alone = discretise(small("arch", **changes)).substructures
    for first, second in zip(after, alone, strict=True):
        assert first.elasticity is not second.elasticity
        for name in ("stiffness", "trace", "direction"):
            kept = getattr(first.elasticity, name)
            assert kept.tobytes() == getattr(second.elasticity, name).tobytes()


@pytest.mark.parametrize("scene", ["bar", "strand", "rope"])
def test_more_friction_leaves_all_pieces_of_rods_as_they_are(scene: str) -> None:
    settings = small(scene)
    before = discretise(settings).substructures
    assert discretise(with_more_friction(settings)).substructures is before


def without_one(settings: Settings) -> Iterator[Settings]:
    """The same settings, each time with another one by default, where that is one."""
    values = settings.changed()
    for name in values:
        others = {other: value for other, value in values.items() if other != name}
        with suppress(SettingError):
            yield CATALOGUE[settings.scene].checked(others)


def pieces_of(settings: Settings) -> list[bytes]:
    """Digests of all arrays of each substructure."""
    digests = []
    for part in discretise(settings).substructures:
        fields = (part.dofs, part.rows, part.body_force, part.free_force)
        given = [field for field in fields if field is not None]
        digests.append(content_of(part.elasticity.stiffness, *given))
    return digests


@pytest.mark.parametrize(("scene", "rows"), [("bar", 16), ("strand", 4), ("rope", 2)])
def test_rods_that_differ_in_one_setting_have_the_pieces_of_first_ones(
    scene: str, rows: int
) -> None:
    for row in range(rows):
        drawn = [*without_one(draw(scene, SEED, row))]
        after = [pieces_of(settings) for settings in drawn]
        for settings, pieces in zip(drawn, after, strict=True):
            CACHE.clear()
            assert pieces == pieces_of(settings), settings


def test_cached_results_are_read_only() -> None:
    condensed = Condensation(discretise(small("wall")))
    with pytest.raises(ValueError, match="read-only"):
        condensed.stiffness[0, 0] = 0.0
    piece, *_ = discretise(small("rope")).substructures
    for array in (piece.dofs, piece.rows, piece.body_force):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0


@dataclass
class Block:
    """A result of a known size."""

    nbytes: int


def test_the_oldest_results_are_dropped_at_the_limit_of_memory() -> None:
    kept = Cache(100)
    first = kept.get("first", lambda: Block(40))
    kept.get("second", lambda: Block(40))
    assert kept.get("first", lambda: Block(40)) is first
    kept.get("third", lambda: Block(40))
    assert kept.nbytes == 80
    assert kept.get("first", lambda: Block(40)) is first
    second = Block(40)
    assert kept.get("second", lambda: second) is second


def test_too_large_results_are_not_cached_and_drop_nothing() -> None:
    kept = Cache(100)
    small_one = kept.get("small", lambda: Block(60))
    kept.get("large", lambda: Block(101))
    assert kept.nbytes == 60
    assert kept.get("small", lambda: Block(60)) is small_one


def test_failures_are_not_cached() -> None:
    kept = Cache(100)

    def fail() -> Block:
        raise InterruptedError

    with pytest.raises(InterruptedError):
        kept.get("key", fail)
    assert kept.nbytes == 0


@pytest.mark.parametrize(
    "other",
    [
        np.arange(6.0).reshape(2, 3),
        np.arange(6),
        np.array([0.0, 1.0, 2.0, 3.0, 4.0, np.nextafter(5.0, 6.0)]),
    ],
)
def test_content_differs_by_shape_by_type_and_by_the_last_bit(other: Array) -> None:
    assert content_of(np.arange(6.0)) == content_of(np.arange(6.0))
    assert content_of(np.arange(6.0)) != content_of(other)
