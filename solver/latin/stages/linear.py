"""Linear stage: elasticity of substructures at all instants (paper, problem 2.2)."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from solver.arrays import Array
from solver.discrete.problem import Problem
from solver.latin.iterate import Checkpoint
from solver.latin.stages.blocks import Blocks
from solver.latin.stages.coarse import CoarseProblem
from solver.latin.stages.group import Group
from solver.latin.stages.pgd import PGD
from solver.reduction.basis import SharedBasis


@dataclass(frozen=True)
class Full:
    """Full fields in the linear stage: a value for every point and instant."""

    def group(self, problem: Problem, numbers: list[int], k: Array) -> Group:
        """Group of identical substructures with the same k, shape (n_rows,)."""
        return Group(problem, numbers, k)


class LinearStage:
    """Elasticity along the search direction E-, factored for one problem and one k.

    With y = W + F/k of a substructure, W = H k y + W_f, where H = B (K + B^T k B)^-1
    B^T and W_f comes from body forces; then W - F/k = 2 W - y (MATHEMATICS.md, 2).
    The state of the stage is y: relaxation mixes y, and everything else follows from
    it. The groups hold y, in full, block by block of instants, or on separated bases.

    Parameters
    ----------
    problem
        The problem to be solved.
    k
        Search direction of the rows, shape (n_rows,), scaled.
    form
        Form in which the groups hold y.
    blocks
        Blocks of instants.
    multiscale
        Whether the coarse problem brings macro forces into equilibrium.
    """

    def __init__(
        self,
        problem: Problem,
        k: Array,
        form: Full | PGD,
        blocks: Blocks,
        *,
        multiscale: bool,
    ) -> None:
        self.groups = [form.group(problem, alike, k) for alike in _alike(problem, k)]
        self.is_full = isinstance(form, Full)
        # A basis spans all instants, so its groups cannot work on some of them.
        if self.is_full:
            self._blocks = blocks
        else:
            self._blocks = Blocks(1, problem.n_instants)
        self._coarse = None
        has_macro = any(law.macro is not None for law in problem.contacts.laws.values())
        if multiscale and (problem.cuts or has_macro):
            self._coarse = CoarseProblem(problem, self.groups, self._blocks)
        self._shape = (problem.n_rows, problem.n_instants)

    def restore(self, checkpoint: Checkpoint | None) -> None:
        """Set the state to that of a checkpoint, or to zero without one."""
        for group in self.groups:
            group.restore(checkpoint)

    def bases(self) -> tuple[SharedBasis, ...]:
        """Separated bases of the state, one per substructure; empty for full fields."""
        bases: dict[int, SharedBasis] = {}
        for group in self.groups:
            bases.update(group.bases())
        return tuple(bases[number] for number in sorted(bases))

    def read(self, target: Array) -> None:
        """Set the targets of all groups to W^ + F^/k of the local stage.

        `target` has shape (n_rows, n_instants), scaled.
        """
        self._each(lambda group, instants: group.gather(target, instants))

    def advance(self, relaxation: float) -> None:
        """Solve the linear stage; the new state enters with the share `relaxation`."""
        if self._coarse is not None:
            self._coarse.add_multiplier()
        self._each(lambda group, instants: group.relax(relaxation, instants))

    def outgoing(self) -> Array:
        """W + F/k, shape (n_rows, n_instants), scaled."""
        boundary = np.empty(self._shape, order="F")
        for group in self.groups:
            group.scatter(group.outgoing(), boundary)
        return boundary

    def incoming(self) -> Array:
        """W - F/k, shape (n_rows, n_instants), scaled."""
        boundary = np.empty(self._shape, order="F")
        self._each(
            lambda group, some: group.scatter(group.reflect(some), boundary, some)
        )
        return boundary

    def _each(self, work: Callable[[Group, slice], None]) -> None:
        """Call `work` for every group and every block of instants."""

        def of_block(instants: slice) -> None:
            for group in self.groups:
                work(group, instants)

        self._blocks.each(of_block)


def _alike(problem: Problem, k: Array) -> list[list[int]]:
    """Numbers of substructures with one elasticity and one k, (n_rows,), together."""
    groups: dict[tuple[int, bytes], list[int]] = {}
    for number, part in enumerate(problem.substructures):
        # Equal bytes of k give the same operator, to the bit.
        operator = (id(part.elasticity), k[part.rows].tobytes())
        groups.setdefault(operator, []).append(number)
    return list(groups.values())
