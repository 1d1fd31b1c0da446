"""How the fields of both stages are held: in full, or as a few modes (PGD)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, NamedTuple

from solver.arrays import Array
from solver.discrete.problem import Problem
from solver.latin.blocks import Blocks
from solver.latin.clock import Clock
from solver.latin.cycle import Everywhere, LocalPart
from solver.latin.linear import FullLinearStage, LinearStage
from solver.latin.local import LocalStage
from solver.latin.reduced_linear import ReducedLinearStage
from solver.latin.reduced_local import AtReferences, ReducedLocalStage
from solver.reduction.enrichment import Enrichment
from solver.refusal import check_range


class Stages(NamedTuple):
    """Both stages, ready for one problem and one k."""

    local: LocalPart
    linear: LinearStage[Any]


@dataclass(frozen=True)
class Full:
    """A value for every point and instant.

    Attributes
    ----------
    remedy
        What helps a run that does not converge, in a sentence; nothing that it knows of.
    """

    remedy: ClassVar[str] = ""

    def at_work(
        self, problem: Problem, k: Array, blocks: Blocks, clock: Clock, *, multiscale: bool
    ) -> Stages:
        """Factor the linear stage, and prepare the laws.

        Parameters
        ----------
        problem, k
            What to solve, and the search direction of the rows, shape (n_rows,), scaled.
        blocks
            Of instants, in which both work.
        clock
            On which nothing is billed that only a viewer wants.
        multiscale
            Whether the coarse problem is part of the linear stage.
        """
        linear = FullLinearStage(problem, k, multiscale=multiscale, blocks=blocks)
        return Stages(Everywhere(LocalStage(problem, k, blocks=blocks), linear), linear)


@dataclass(frozen=True)
class References:
    """A local stage at some points and instants, from which the modes give the rest.

    Attributes
    ----------
    points, instants
        Share of the friction points, and of the instants, at which the laws are evaluated; at least
        one for each mode.
    """

    points: float = 0.5
    instants: float = 0.5

    def __post_init__(self) -> None:
        for name in ("points", "instants"):
            check_range(self, name, 0.0, 1.0)


@dataclass(frozen=True)
class PGD:
    """A sum of a few modes, each a shape in space times a function of time (paper, section 2.2).

    Attributes
    ----------
    modes
        Most modes of a substructure; the smallest are dropped.
    tolerance
        Share of a substructure's field that may be lost with them; no mode is added for a residual
        below it.
    enrichment
        Modes are added only if new time functions for the old ones leave more than this share of
        the residual: 0 always, 1 never.
    pairs
        Most modes that one iteration adds to a substructure.
    sharing
        Equal substructures use the same modes if these miss at most this share of each one's field;
        0: each has modes of its own.
    local
        Where the laws are evaluated; None is everywhere.
    remedy
        What helps a run that does not converge, in a sentence.
    """

    remedy: ClassVar[str] = "The modes may be too few: raise pgd_modes, lower pgd_tolerance."

    modes: int = 10
    tolerance: float = 1e-4
    enrichment: float = 0.1
    pairs: int = 2
    sharing: float = 0.0
    local: References | None = None

    def __post_init__(self) -> None:
        for name in ("modes", "pairs"):
            check_range(self, name, 1, 1000)
        for name in ("tolerance", "enrichment", "sharing"):
            check_range(self, name, 0.0, 1.0)

    def at_work(
        self, problem: Problem, k: Array, blocks: Blocks, clock: Clock, *, multiscale: bool
    ) -> Stages:
        """Factor the linear stage, and prepare the laws; as `Full.at_work` says."""
        rule = Enrichment(self.enrichment, self.tolerance, self.pairs, self.modes, self.sharing)
        linear = ReducedLinearStage(problem, k, rule, multiscale=multiscale)
        stage = LocalStage(problem, k, blocks=blocks)
        if self.local is None:
            return Stages(Everywhere(stage, linear), linear)
        shares = self.local.points, self.local.instants
        few = ReducedLocalStage(problem, k, shares, linear)
        return Stages(AtReferences(stage, linear, few, clock), linear)
