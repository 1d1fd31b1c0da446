"""Sweeps: a quantity of a run over one or two settings.

    plan = plan_of(settings, ["friction=0.1:0.6:21", "peak=300:1500:21"], ["dissipation@1"])
    with opened("processes", limit=patience(60.0)) as pool:
        for row in sweep(plan, pool, done=done, limit=60.0):
            ...

`plan_of` reads and checks what is asked for, with a `SettingError` of one line for what cannot be;
`Plan.plain` is the plan as JSON holds it, `plan_from_plain` its way back, and `Plan.digest` a short
text that tells plans apart. Points are numbered through the grid, the last axis fastest:
`plan.point(n)` is what varies there, `plan.settings_at(n)` all settings of that run.

`sweep` yields a `Row` for every point that is not in `done`, as they come, in any order.
`Row.holds` tells whether its run has converged; if not, `ending` and `reason` say why, and `values`
are what the run had come to, or NaN. Closing the generator ends the sweep; the executor is
another's to close, and may do several sweeps at once. `adaptive.sweep_adaptively` takes points
where the answer bends, from the rows that are known; a process of a sweep does not need it, and
would take twice as long to start.
"""

from solver.running.executors import opened
from solver.study.sweep.drive import sweep
from solver.study.sweep.plan import Plan, Varied, plan_from_plain, plan_of
from solver.study.sweep.point import Row, VersionsDifferError, patience, run_point

__all__ = [
    "Plan",
    "Row",
    "Varied",
    "VersionsDifferError",
    "opened",
    "patience",
    "plan_from_plain",
    "plan_of",
    "run_point",
    "sweep",
]
