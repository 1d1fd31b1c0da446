"""Figs. 3 to 8 of the paper, drawn again from the engine (paper, section 3).

The paper prints curves without numbers, so each figure comes with the paper's claim and with the
numbers that bear it out or do not.
"""

from __future__ import annotations

import numpy as np

from solver.arrays import Array
from solver.latin import Iterate
from solver.reduction.svd import Decomposition, front_decay
from solver.reference.distance import Fields
from solver.study.chart import Line, Panel, PanelAxis, PanelCurve
from solver.study.figures import paper_findings as findings
from solver.study.figures.figure_data import PaperFigure
from solver.study.figures.paper_runs import EARLY, LONG, PaperRuns

LOAD = (
    "The paper's load path (Fig. 2b) is lost; taken here: one period of a sine of 900 N, "
    "relaxation 0.8, all else as in Table 1."
)
SHOWN = 300
"""Iterations that Fig. 3 shows."""
INSTANTS = (0.5, 1.0)
"""Instants of Fig. 4, s."""
PLACE = PanelAxis("Position x", "m")
MODE = PanelAxis("Space mode", "1/√m")


def paper_figures(runs: PaperRuns | None = None) -> list[PaperFigure]:
    """Make Figs. 3 to 8 from one set of runs."""
    runs = runs or PaperRuns()
    return [make(runs) for make in MAKERS]


def figure_3(runs: PaperRuns) -> PaperFigure:
    """Draw the LATIN indicator, mono- and multiscale, with the true errors beside it."""
    multi, mono = runs.multiscale.records, runs.monoscale.records
    iterations = PanelAxis("Iteration")
    numbers = np.arange(1.0, SHOWN + 1.0)

    def curves(name: str, word: str, line: Line) -> list[PanelCurve]:
        return [
            PanelCurve(
                f"{word}, {version}", numbers, findings.column(records, name)[:SHOWN], hue, line
            )
            for hue, (version, records) in enumerate(
                {"multiscale": multi, "monoscale": mono}.items(), start=1
            )
        ]

    indicator = Panel(
        "What the method computes",
        iterations,
        PanelAxis("LATIN indicator η", logarithmic=True),
        tuple(curves("indicator", "η", "dashed")),
    )
    errors = Panel(
        "What is true",
        iterations,
        PanelAxis("Relative error", logarithmic=True),
        (
            *curves("error_force", "friction force", "solid"),
            *curves("error_displacement", "displacement", "dotted"),
        ),
    )
    return PaperFigure(
        3,
        "LATIN indicator, monoscale and multiscale",
        (indicator, errors),
        "The multiscale version gains hugely in the first iterations; after that both converge at "
        "the same rate.",
        (
            findings.gain(multi, mono, "indicator", 1e-4),
            findings.gain(multi, mono, "error_displacement", 1e-2),
            findings.first_iterations(multi, mono),
            findings.rates(multi, mono, (30, 200)),
            findings.rates(multi, mono, (30, 80), ("indicator",)),
            findings.rates(multi, mono, (LONG // 2, LONG)),
        ),
        f"10 substructures, the indicator of eq. 2 (squared norms) and, as it is no error, the "
        f"distance to the incremental solution in L2 over space and time. {LOAD}",
    )


def figure_4(runs: PaperRuns) -> PaperFigure:
    """Draw the friction force after ten iterations at two instants, against the reference."""
    solutions: dict[str, Fields] = {
        "reference": runs.reference,
        "multiscale": runs.multiscale.early,
        "monoscale": runs.monoscale.early,
    }
    problem = runs.multiscale.early.problem
    law = problem.friction
    lengths = law.by_point(law.weights)[1:]
    moments = {time: int(np.argmin(np.abs(problem.instants - time))) for time in INSTANTS}
    root = np.sqrt(lengths)[:, None]
    forces = {label: fields.contact_force[1:] for label, fields in solutions.items()}
    weighted = {label: fields.displacement[1:] * root for label, fields in solutions.items()}
    panels = tuple(
        Panel(
            f"t = {instant:g} s",
            PLACE,
            PanelAxis("Friction force per length", "N/m"),
            tuple(
                PanelCurve(label, law.positions[1:], force[:, moment] / lengths, hue)
                for hue, (label, force) in enumerate(forces.items())
            ),
        )
        for instant, moment in moments.items()
    )
    return PaperFigure(
        4,
        f"Friction force after {EARLY} iterations",
        panels,
        "After a few iterations the multiscale version captures the global behaviour very well, "
        "while the monoscale one is far from the reference, the load not fully propagated.",
        (
            findings.balance(solutions, moments[INSTANTS[0]]),
            findings.distances("displacement", "the displacement", weighted, moments),
            findings.distances(
                "force",
                "the friction force",
                {label: force / root for label, force in forces.items()},
                moments,
            ),
        ),
        "10 substructures. The clamped node is left out: its friction force is part of the "
        "reaction. Here the load is zero at both instants, so that t = 1 s is t = 0.5 s with "
        f"the sign changed. {LOAD}",
    )


def figure_5(runs: PaperRuns) -> PaperFigure:
    """Draw the singular values of the friction force in every substructure."""
    found = runs.friction_forces
    largest = max(each.values[0] for each in found)
    noise = runs.five.records[-1].error_force
    orders = np.arange(1.0, len(found[-1].values) + 1.0)
    curves = [
        PanelCurve(f"substructure {number}", orders, each.values / largest, number, "points")
        for number, each in enumerate(found, start=1)
    ]
    front = PanelCurve("1/(2n − 1)", orders, front_decay(len(orders)), 0, "dotted")
    error = PanelCurve("error of the solution", orders, np.full(len(orders), noise), 0, "dashed")
    panels = tuple(
        Panel(
            title,
            PanelAxis("Mode n", whole=True),
            PanelAxis("Singular value / largest", logarithmic=True, limits=limits),
            (*shown, front, *below),
        )
        for title, limits, shown, below in (
            ("All, numbered from the clamp", (1e-11, 3.0), curves, [error]),
            ("Those that the front sweeps", (1e-2, 1.5), curves[2:], []),
        )
    )
    return PaperFigure(
        5,
        "Singular values of the friction force, 5 substructures",
        panels,
        "In substructures 1 and 2, which mostly stick, the singular values fall very rapidly; in 3 "
        "to 5, which a large sliding front sweeps, very slowly.",
        (
            findings.mode_counts(found, noise),
            findings.decay(found),
            findings.as_a_front(found[2:]),
        ),
        "SVD of the converged friction force per length, weighted in space and time, relative to "
        "the largest value of all substructures; dotted: a front of constant speed. Values below "
        f"{noise:.0e} of the largest are below the solution's own error: at 900 N nothing slides "
        "in substructure 1, and of substructure 2 only the end, so their fast decay is the load's "
        f"doing. {LOAD}",
    )


def figure_6(runs: PaperRuns) -> PaperFigure:
    """Draw the friction force's space modes 1, 3 and 5 in substructures 4 and 5."""
    fourth, fifth = runs.friction_forces[3:]
    turned = fifth.space_modes * np.sign(fourth.correlations(fifth.space_modes))
    inside = fourth.positions - fourth.positions[0]
    top = 1.1 * float(np.abs([fourth.space_modes[:, :5], turned[:, :5]]).max())
    panels = tuple(
        Panel(
            f"Mode {order + 1}",
            PanelAxis("Position in the substructure", "m"),
            PanelAxis(MODE.quantity, MODE.unit, limits=(-top, top)),
            (
                PanelCurve("substructure 4", inside, fourth.space_modes[:, order], 4),
                PanelCurve("substructure 5", inside, turned[:, order], 5, "dashed"),
            ),
        )
        for order in (0, 2, 4)
    )
    return PaperFigure(
        6,
        "SVD modes of the friction force in substructures 4 and 5",
        panels,
        "Substructures 4 and 5 stick and slide alike, so their modes have similar shapes, global "
        "in the first modes and local in the later ones.",
        (
            findings.likeness(fourth, fifth, (4, 5)),
            findings.sign_changes(fourth, fifth),
        ),
        "5 substructures, converged; modes orthonormal in L2 over the substructure, the sign of "
        f"those of 5 chosen to fit those of 4. {LOAD}",
    )


def figure_7(runs: PaperRuns) -> PaperFigure:
    """Draw the first three SVD modes of the displacement of substructure 5."""
    found = runs.displacements[-1]
    panel = Panel(
        "SVD of the converged displacement",
        PLACE,
        MODE,
        tuple(
            PanelCurve(f"mode {order}", found.positions, found.space_modes[:, order - 1], order)
            for order in (1, 2, 3)
        ),
    )
    return PaperFigure(
        7,
        "SVD modes of the displacement of substructure 5",
        (panel,),
        "The first three SVD modes of the displacement of substructure 5 are what those of the PGD "
        "(Fig. 8) are to be compared with.",
        (findings.rank_errors(found, runs.friction_forces[-1]),),
        f"5 substructures, converged; modes orthonormal in L2 over the substructure. {LOAD}",
    )


def figure_8(runs: PaperRuns) -> PaperFigure:
    """Draw the first three displacement modes of the PGD in substructure 5."""
    exact, last = runs.displacements[-1], runs.five_reduced.last
    kept = _displacement_modes(last)[:, :3]
    sorted_ = _orthonormalised(kept, exact.space_weights)
    panels = tuple(
        Panel(title, PLACE, MODE, tuple(_beside_svd(exact, modes)))
        for title, modes in (
            ("PGD modes, orthonormalised in order", sorted_),
            ("PGD modes as the iteration keeps them", kept),
        )
    )
    return PaperFigure(
        8,
        "PGD modes of the displacement of substructure 5",
        panels,
        "With sorting and downsizing, the first three PGD modes of the displacement correlate well "
        "with the first three SVD modes.",
        (
            findings.correlation(exact, sorted_, "sorted", "orthonormalised in order"),
            findings.correlation(exact, kept, "kept", "as the iteration keeps them"),
            findings.reduced_errors(runs.five_reduced, exact, runs.friction_forces[-1]),
        ),
        f"5 substructures, PGD at its default settings, iterate {last.number}; dotted: the SVD "
        "modes of Fig. 7. The PGD keeps displacement and force in one basis, orthonormal and "
        "sorted in the norm of the search direction, so the displacement parts of its modes "
        "overlap. Left, they are made orthonormal in L2 one after the other, which leaves their "
        f"span as it is. {LOAD}",
    )


def _displacement_modes(iterate: Iterate) -> Array:
    """Give the PGD's displacement modes of the last substructure on its friction rows."""
    part = iterate.problem.substructures[-1]
    rubs = np.isin(part.rows, iterate.problem.friction.tangent.above)
    found: Array = iterate.bases[-1].displacement_modes[rubs]
    return found


def _orthonormalised(modes: Array, weights: Array) -> Array:
    """Orthonormalise modes in their order, in the inner product of the weights."""
    root = np.sqrt(weights)[:, None]
    found: Array = np.linalg.qr(modes * root)[0] / root
    return found


def _beside_svd(exact: Decomposition, modes: Array) -> list[PanelCurve]:
    """Draw modes at length one, turned to the side of the SVD modes that are dotted."""
    turned = modes * np.sign(exact.correlations(modes)) / np.sqrt(exact.space_weights @ modes**2)
    curves = []
    for place in range(modes.shape[1]):
        order = place + 1
        curves += [
            PanelCurve(f"PGD {order}", exact.positions, turned[:, place], order),
            PanelCurve(
                f"SVD {order}", exact.positions, exact.space_modes[:, place], order, "dotted"
            ),
        ]
    return curves


MAKERS = (figure_3, figure_4, figure_5, figure_6, figure_7, figure_8)
"""Each makes its figure from the runs that all share; a run is done when it is first asked for."""
