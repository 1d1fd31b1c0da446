"""How the linear stage holds its fields: in full, or as a few modes (PGD)."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import ClassVar

from solver.arrays import Array
from solver.discrete.problem import Problem
from solver.latin.blocks import Blocks
from solver.latin.linear.full import FullLinearStage
from solver.latin.linear.response import Responses
from solver.latin.linear.separated import ReducedLinearStage
from solver.reduction.enrichment import Enrichment
from solver.refusal import check_range


@dataclass(frozen=True)
class Full:
    """A value for every point and instant.

    Attributes
    ----------
    remedy
        What helps a run that does not converge, to begin a sentence with; nothing it knows of.
    has_to_prove
        Whether a run ends by proof alone, whatever that costs.
    responses
        Factors of substructures that runs with one k share; None: each run has its own.
    """

    remedy: ClassVar[str] = ""
    has_to_prove: ClassVar[bool] = False

    responses: Responses | None = field(default=None, repr=False)

    def at_work(
        self, problem: Problem, k: Array, blocks: Blocks, *, multiscale: bool
    ) -> FullLinearStage:
        """Factor the linear stage.

        Parameters
        ----------
        problem, k
            What to solve, and the search direction of the rows, shape (n_rows,), scaled.
        blocks
            Of instants, in which it works.
        multiscale
            Whether the coarse problem is part of it.
        """
        return FullLinearStage(
            problem, k, multiscale=multiscale, blocks=blocks, responses=self.responses
        )


@dataclass(frozen=True)
class PGD:
    """A sum of a few modes, each a shape in space times a function of time (paper, section 2.2).

    Attributes
    ----------
    modes
        Most modes of a substructure; the smallest are dropped.
    tolerance
        Share of a substructure's field that may be lost with them; no mode is added for a residual
        below it. It is that of W + F/k, most of which is displacement, and far below the share of
        the force: 1e-4 left 15 % of it in layers whatever `modes` was (solver/study/README.md, 8).
    pairs
        Most modes that one iteration adds to a substructure.
    sharing
        Equal substructures use the same modes if these miss at most this share of each one's field;
        0: each has modes of its own. 1e-5 costs no accuracy, 1e-3 does where modes are few
        (solver/study/README.md, 8).
    remedy, has_to_prove, responses
        As of `Full`.
    """

    remedy: ClassVar[str] = "The modes may be too few: raise pgd_modes, lower pgd_tolerance"
    has_to_prove: ClassVar[bool] = True

    modes: int = 10
    tolerance: float = 1e-7
    pairs: int = 2
    sharing: float = 1e-5
    responses: Responses | None = field(default=None, repr=False)

    def __post_init__(self) -> None:
        for name in ("modes", "pairs"):
            check_range(self, name, 1, 1000)
        for name in ("tolerance", "sharing"):
            check_range(self, name, 0.0, 1.0)

    def at_work(
        self, problem: Problem, k: Array, blocks: Blocks, *, multiscale: bool
    ) -> ReducedLinearStage:
        """Factor the linear stage, as `Full.at_work` says; it works on all instants at once."""
        rule = Enrichment(self.tolerance, self.pairs, self.modes, self.sharing)
        return ReducedLinearStage(problem, k, rule, multiscale=multiscale, responses=self.responses)
