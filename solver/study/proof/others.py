"""Cases of other programs, where they are installed: the same discrete problem, solved by them."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache, partial
from typing import Any, NamedTuple

import numpy as np

from solver.arrays import Array
from solver.discrete.problem import Problem
from solver.scenes import discretise
from solver.scenes.block import block
from solver.study.other_programs.public_solvers import PUBLIC, Public, PublicFields, solve_by
from solver.study.proof import by_getfem
from solver.study.proof.case import Answer, KnownCase, KnownNumber, ProofPart, of_field, of_scene
from solver.study.speed.error_against_time import PeerError

ABSENT = "Not installed: {}."
SHEARED: dict[str, Any] = {"elements": 24, "elements_up": 12, "instants": 17}
PULLED: dict[str, Any] = {"load": "decaying", "elements": 50, "instants": 61, "substructures": 5}


class Program(NamedTuple):
    """Another program, and whether it is there."""

    name: str
    installed: bool


def other_programs() -> tuple[Program, ...]:
    """Give all that there is a case for."""
    solvers = (Program(one.name, one.installed) for one in PUBLIC)
    return (*solvers, Program(by_getfem.NAME, by_getfem.installed() is not None))


def absent() -> str:
    """Say which of them are not installed; nothing if all are."""
    names = [one.name for one in other_programs() if not one.installed]
    return ABSENT.format(", ".join(names)) if names else ""


def other_cases() -> Iterator[KnownCase]:
    """Give a case for each program that is installed, none of them solved yet."""
    for public in PUBLIC:
        if public.installed:
            yield _quadratic(public)
    there = by_getfem.installed()
    if there is not None:
        yield _block(there)


def _quadratic(public: Public) -> KnownCase:
    """Have a public QP solver pull the bar to and fro."""
    solved = cache(partial(_solved_by, public))

    def numbers(settings: Any, answer: Answer) -> Iterator[KnownNumber]:
        ours, theirs = answer.fields, solved(settings)
        end = theirs.displacement[-1, -1], ours.displacement[-1, -1]
        yield KnownNumber("end displacement", "m", float(end[0]), float(end[1]))
        moved = theirs.displacement[None], ours.displacement[None]
        yield of_field("displacement, all nodes", "m", *moved)
        friction = ours.contact("friction").tangential_force
        lost = _lost(answer.problem, theirs.displacement, theirs.contact_force)
        own = _lost(answer.problem, ours.displacement, friction)
        yield KnownNumber("energy lost to friction", "J", lost, own)

    return of_scene(
        f"bar pulled to and fro, as {public.name} has it",
        f"{public.name} {public.version}, an instant a quadratic programme, at tolerance "
        f"{public.tolerances[-1]:g}",
        1e-4,
        "bar",
        PULLED,
        numbers,
        part=ProofPart.OTHERS,
    )


def _block(there: by_getfem.Installed) -> KnownCase:
    """Have GetFEM press a block on a rough parabola, and shear it to and fro."""

    @cache
    def solved(settings: Any) -> by_getfem.GetfemFields:
        return by_getfem.solve_block(block(settings), there.python)

    def numbers(settings: Any, answer: Answer) -> Iterator[KnownNumber]:
        theirs, ours = solved(settings), answer.fields.contact("support")
        assert ours.normal_force is not None
        pressed = [one.sum(axis=0)[-1] for one in (theirs.normal_force, ours.normal_force)]
        yield KnownNumber("pressing force", "N/m", *map(float, pressed))
        known = np.stack([theirs.tangential_force, theirs.normal_force])
        found = np.stack([ours.tangential_force, ours.normal_force])
        yield of_field("contact force, all nodes", "N/m", known, found)
        inside = answer.problem.inside
        assert inside is not None
        found = inside.displacement(answer.fields.displacement, slice(None)).transpose(1, 0, 2)
        yield of_field("displacement, all nodes", "m", theirs.displacement, found)
        lost = (
            -float(np.sum(force * np.diff(moved, axis=1, prepend=0.0)))
            for force, moved in (
                (theirs.tangential_force, theirs.moved),
                (ours.tangential_force, ours.slip),
            )
        )
        yield KnownNumber("energy lost to friction", "J/m", *lost)

    return of_scene(
        f"block pressed and sheared, as {by_getfem.NAME} has it",
        f"{by_getfem.NAME} {there.version}, the same elements told in its language, contact and "
        "friction at the nodes by its augmented Lagrangian",
        1e-6,
        "block",
        SHEARED,
        numbers,
        part=ProofPart.OTHERS,
    )


def _solved_by(public: Public, settings: Any) -> PublicFields:
    """Give what it finds; what is no number where it gives up, which proves nothing."""
    problem = discretise(settings)
    try:
        return solve_by(public, problem, public.tolerances[-1])
    except PeerError:
        nothing = np.full((problem.n_dofs, problem.n_instants), np.nan)
        return PublicFields(nothing, nothing[: len(problem.friction.positions)])


def _lost(problem: Problem, displacement: Array, friction: Array) -> float:
    """Give the work of friction, J, from displacements of all nodes and friction at them."""
    law = problem.friction
    at = np.zeros(len(law.positions), dtype=np.intp)
    at[law.points] = problem.row_dofs[law.tangent.above]
    slip = np.diff(displacement[at], axis=1, prepend=0.0)
    return -float(np.sum(friction * slip))
