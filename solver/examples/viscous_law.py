"""A law of a user: a damper F = F_d - c dW/dt, by backward Euler, on a bar."""

from dataclasses import dataclass, replace

import numpy as np

from solver import End, Latin, Rods, discretise, solve
from solver.latin import Stop
from solver.laws import Interface

FORCE = 900.0
STIFFNESS = 1e6
DAMPING = 2e5
"""N; E S / L, N/m; N s/m."""
times = np.linspace(0.0, 1.0, 41)


@dataclass(frozen=True)
class Damper(Interface):
    """A damper beside a load, in scaled units; force has shape (n_rows, n_instants)."""

    rows: np.ndarray
    force: np.ndarray
    per_step: float
    remembers = True  # the instants depend on each other

    def rule(self, k, n_instants):
        """Make the local stage: displacement of the damper's rows from z."""
        stiffness = k[self.rows]
        damping = self.per_step

        def solve_instants(incoming, displacement, _instants):
            before = np.zeros(len(self.rows))
            for n in range(n_instants):
                given = stiffness * incoming[self.rows, n] + self.force[:, n]
                before = (given + damping * before) / (stiffness + damping)
                displacement[self.rows, n] = before

        return solve_instants


# The bar lies on a smooth table: its end obeys c du/dt + k u = F.
bar = Rods(
    length=1.0,
    stiffness=STIFFNESS,
    elements=20,
    substructures=4,
    strength=np.zeros(21),
    left=End(displacement=0.0 * times),
    right=End(force=np.full(41, FORCE)),
    instants=times,
    duration=1.0,
)
problem = discretise(bar)
load = problem.interfaces["load"]
scales = problem.scales
per_step = DAMPING / times[1] * scales.displacement / scales.force
damper = Damper(load.rows, load.values, per_step)
damped = replace(problem, interfaces={**problem.interfaces, "load": damper})
method = Latin(stop=Stop(accuracy=1e-3, tolerance=1e-10, iterations=2000))
solution = solve(damped, method)
end = solution.iterate.displacement[-1]
decay = 1.0 + STIFFNESS * times[1] / DAMPING
exact = FORCE / STIFFNESS * (1.0 - decay ** -np.arange(1.0, 42.0))

print("status:", solution.status.ending)
print("certified:", solution.is_certified)
print("reference:", damped.no_reference)
print("distance over largest:", np.abs(end - exact).max() / exact.max())
