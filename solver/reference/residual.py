"""How far any fields are from solving a problem, by its equations alone."""

from __future__ import annotations

import numpy as np
from scipy import sparse

from solver.arrays import Array
from solver.discrete import Problem
from solver.reference.assembly import assembled_stiffness, external_force, jumps
from solver.reference.distance import Fields, determinate_forces
from solver.reference.rules import rules_of

ELASTIC = 1e-4
"""Share of the forces inside elements that counts like a contact force: they leave so much more
rounding. In slender bodies they are 1e5 times what acts on them."""


def kkt_residual(fields: Fields, problem: Problem) -> float:
    """Largest violation of equilibrium and laws, as a share of the forces in play.

    By the equations alone, at every instant, however the fields were found.

    Parameters
    ----------
    fields
        Displacement and contact force, SI.
    problem
        Whose equations they should obey.

    Returns
    -------
    Relative to the largest contact force, or to a small share of what the displacement alone makes
    of forces inside elements, which rounding is a share of; and to the load where all vanish.
    """
    displacement = fields.displacement / problem.scales.displacement
    force = fields.contact_force / problem.scales.force
    stiffness, all_jumps = assembled_stiffness(problem), jumps(problem)
    outer = external_force(problem)
    free = np.setdiff1d(np.arange(problem.n_dofs), problem.prescribed[0])
    inner = stiffness @ displacement
    unbalanced = (inner - outer - all_jumps.T @ force)[free]
    elastic = abs(stiffness) @ np.abs(displacement)
    size = max(
        float(np.abs(part).max(initial=0.0)) for part in (ELASTIC * elastic, ELASTIC * outer, force)
    )
    jump = all_jumps @ displacement + rules_of(problem).compliance[:, None] * force
    broken = _broken_laws(problem, stiffness, jump, force)
    largest = max(float(np.abs(part).max(initial=0.0)) for part in (unbalanced, broken))
    return largest / size if size > 0.0 else largest


def _broken_laws(problem: Problem, stiffness: sparse.csr_array, jump: Array, force: Array) -> Array:
    """How far contacts are from their laws, as forces, shape (n_forces, n_instants).

    A pair of quantities of which one vanishes, such as pressing force and opening, is as wrong as
    the smaller one; lengths become forces by the stiffness of the jump's own degrees of freedom.
    """
    rules = rules_of(problem)
    unit = (abs(jumps(problem)) @ stiffness.diagonal())[:, None]
    unit = unit / (1.0 + unit * rules.compliance[:, None])
    opening = unit * (jump + rules.gap[:, None])
    moved = np.diff(jump, axis=1, prepend=0.0)
    slip, bound = unit * moved, rules.bounds(force, moved, opening)
    overlap, tension = np.maximum(-opening, 0.0), np.maximum(-force, 0.0)
    apart = np.minimum(np.maximum(opening, 0.0), np.maximum(force, 0.0))
    of_normal = np.maximum(np.maximum(overlap, tension), apart)
    beyond = np.maximum(np.abs(force) - bound, 0.0)
    against = np.minimum(np.abs(slip), np.abs(force + bound * np.sign(slip)))
    of_friction = np.maximum(beyond, against)
    wrong = np.where(rules.normal[:, None], of_normal, of_friction)
    return np.asarray(wrong * determinate_forces(problem))
