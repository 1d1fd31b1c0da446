"""Sweeps: a quantity of a run over one or two settings.

    plan = plan_of(settings, ["friction=0.1:0.6:21", "peak=300:1500:21"], ["dissipation@1"])
    with opened("processes", limit=patience(60.0)) as executor:
        for row in sweep(plan, executor, limit=60.0):
            ...

Points are numbered through the grid, the last axis fastest: `plan.point(n)` is what varies there,
`plan.settings_at(n)` all settings of that run. `sweep` yields a `Row` for every point, as they
come, in any order. `Row.holds` tells whether its run has converged; if not, `ending` and `reason`
say why, and `values` are what the run had come to, or NaN.
"""

from solver.executors import opened
from solver.study.sweep.plan import Plan, Row, plan_of
from solver.study.sweep.run import patience, sweep

__all__ = [
    "Plan",
    "Row",
    "opened",
    "patience",
    "plan_of",
    "sweep",
]
