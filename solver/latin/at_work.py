"""The method at work on a problem: where it starts, its two stages in turn, what it shows."""

from __future__ import annotations

from math import inf

from solver.arrays import Array
from solver.discrete.problem import Problem
from solver.latin.clock import Clock
from solver.latin.cycle import Cycle, read_only
from solver.latin.iterate import Checkpoint, Iterate
from solver.latin.method import Latin

STARTING = 0.5
"""Share of the time that a run may take which its start may take."""


class AtWork:
    """The method at work on a problem.

    Parameters
    ----------
    problem, latin, start
        As for `iterations`.
    clock
        What it bills.

    Attributes
    ----------
    cycle
        Both stages at work.
    """

    def __init__(
        self, problem: Problem, latin: Latin, start: Checkpoint | None, clock: Clock
    ) -> None:
        self._problem, self._latin, self._clock = problem, latin, clock
        self._direction = latin.direction.at_work(problem, start)
        parts = latin.plugged(problem, self._direction.k)
        if start is None:
            start = _own_start(problem, latin, parts.k)
        self.cycle = Cycle(problem, parts, start)
        if start is not None:
            self._recall(start)
        self._history = list(start.history) if start else []
        self._outgoing = self._before = self.cycle.outgoing
        self._read = self.cycle.incoming

    def _recall(self, start: Checkpoint) -> None:
        """Bring back what the parts remember, from a checkpoint of the same run."""
        cycle = self.cycle
        acceleration = cycle.parts.acceleration
        if start.memory is None or acceleration is None:
            return
        _, differences, _ = start.memory
        acceleration.restore((0, max(differences - len(start.history) + 1, 0), inf))
        for outgoing in start.history:
            cycle.put(Checkpoint(0, 0.0, outgoing))
            cycle.local_stage()
            cycle.linear_stage(mixes=False)
        acceleration.restore(start.memory)
        cycle.put(start)

    def choose_direction(self) -> None:
        """Change k if it is time to; W and F stay, or go back to earlier ones."""
        if not self._direction.is_due:
            return
        cycle = self.cycle
        displacement = 0.5 * (self._outgoing + cycle.incoming)
        force = cycle.parts.k[:, None] * (self._outgoing - displacement)
        found = self._direction.turn(displacement, force)
        if found is None:
            return
        displacement, force = found
        parts = self._latin.plugged(self._problem, self._direction.k)
        outgoing = displacement + force / parts.k[:, None]
        self.cycle = Cycle(self._problem, parts, Checkpoint(0, 0.0, outgoing))
        self._outgoing, self._history = self.cycle.outgoing, []

    def local_stage(self) -> None:
        """Obey the interface laws."""
        self.cycle.local_stage()
        stage = self.cycle.parts.local
        self._read = read_only(stage.incoming)
        self._direction.see(stage.displacement, self._read)

    def linear_stage(self) -> None:
        """Solve the elasticity of all substructures."""
        self._before = self._outgoing
        self.cycle.linear_stage()
        self._outgoing = self.cycle.outgoing

    def snapshot(self, number: int, *, resumable: bool = True) -> Iterate:
        """Show where the method stands."""
        cycle = self.cycle
        parts = cycle.parts
        mix = parts.acceleration
        remembered = mix.remembered if mix else 0
        if resumable and remembered:
            self._history = [*self._history, self._before][-remembered:]
        return Iterate(
            number=number,
            seconds=self._clock.seconds,
            problem=self._problem,
            k=parts.k,
            outgoing=self._outgoing,
            incoming=cycle.incoming,
            local_displacement=read_only(parts.local.displacement),
            local_incoming=self._read,
            reduction=parts.linear.reduction(cycle.state),
            history=tuple(self._history) if resumable and remembered else (),
            memory=mix.memory if mix else None,
            course=self._direction.course,
        )


def _own_start(problem: Problem, latin: Latin, k: Array) -> Checkpoint | None:
    """Give the start of the method's own choice; None is zero fields."""
    if problem.rest is not None:
        return Checkpoint(0, 0.0, problem.rest[problem.row_dofs])
    return latin.start.at_work(problem, k, STARTING * latin.stop.seconds) if latin.start else None
