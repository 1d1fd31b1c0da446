"""A helical wire of a strand that is bent is a rod with a body force, held to a closed form."""

from __future__ import annotations

import numpy as np
import pytest

from solver import Latin, Rods, solve
from solver.arrays import Array
from solver.discrete.rope.helical_wire import HelicalWire
from solver.latin import Auto, Stop
from solver.reference.choice import incremental_solver
from solver.reference.closed_forms.bent_wire import BentWire
from solver.reference.incremental import incremental
from solver.refusal import RefusedError

WIRE = HelicalWire(stiffness=1.5e6, radius=4e-3, lay=np.radians(12.0))
BENT = BentWire(WIRE, bound=3000.0)


def rods(curvature: Array, elements: int = 40, substructures: int = 4) -> Rods:
    """Make half a pitch of the wire; by symmetry neither of its ends slips."""
    arc = np.linspace(0.0, WIRE.half_pitch, elements + 1)
    instants = np.linspace(0.0, 1.0, len(curvature))
    return Rods(
        length=WIRE.half_pitch,
        stiffness=WIRE.stiffness,
        elements=elements,
        substructures=substructures,
        bound=np.full(elements + 1, BENT.bound),
        load=np.zeros(len(curvature)),
        instants=instants,
        duration=1.0,
        rigid_grip=True,
        body_force=WIRE.body_force(arc, curvature),
    )


def moments(curvature: Array, elements: int = 40) -> Array:
    """Give the wire's moment by the incremental solver."""
    scene = rods(curvature, elements)
    return WIRE.moment(scene.nodes, incremental(scene.discretise()).displacement, curvature)


def to_and_fro(peak: float, steps: int = 60) -> Array:
    up = np.linspace(0.0, peak, steps + 1)
    down, back = np.linspace(peak, -peak, 2 * steps + 1), np.linspace(-peak, peak, 2 * steps + 1)
    return np.concatenate([up, down[1:], back[1:]])


def test_first_bending_meets_the_closed_form() -> None:
    curvature = BENT.first_slip * np.linspace(0.0, 1.8, 91)
    exact = BENT.moment(curvature)
    assert np.abs(moments(curvature) - exact).max() < 0.005 * exact[-1]


def test_it_comes_nearer_with_order_two() -> None:
    curvature = BENT.first_slip * np.linspace(0.0, 1.4, 15)
    exact = BENT.moment(curvature)
    off = [np.abs(moments(curvature, n) - exact).max() for n in (20, 40, 80, 160)]
    orders = np.log2(np.array(off[:-1]) / np.array(off[1:]))
    assert np.mean(orders) == pytest.approx(2.0, abs=0.3)


def test_bent_back_it_follows_masings_rule() -> None:
    peak = 1.3 * BENT.first_slip
    curvature = to_and_fro(peak)
    back = slice(60, 181)
    exact = BENT.after_return(peak, curvature[back])
    assert np.abs(moments(curvature)[back] - exact).max() < 0.005 * exact.max()


@pytest.mark.parametrize("share", [1.2, 1.5])
def test_a_cycle_loses_the_energy_of_masings_rule(share: float) -> None:
    peak = share * BENT.first_slip
    curvature = to_and_fro(peak)
    moment = moments(curvature)
    loop = np.trapezoid(moment[60:], curvature[60:])
    assert abs(loop) == pytest.approx(BENT.energy(peak), rel=0.01)


def test_what_friction_dissipates_is_what_the_loop_encloses() -> None:
    peak = 1.5 * BENT.first_slip
    curvature = to_and_fro(peak)
    scene = rods(curvature)
    found = incremental(scene.discretise())
    slips = np.diff(found.displacement[:, 60:], axis=1)
    force = found.contact_force[:, 61:]
    # The loop is a wire's mean share in the moment of a metre of strand.
    strand = WIRE.half_pitch * np.cos(WIRE.lay)
    lost = -np.sum(force * slips) / strand
    moment = WIRE.moment(scene.nodes, found.displacement, curvature)
    assert lost == pytest.approx(abs(np.trapezoid(moment[60:], curvature[60:])), rel=0.01)


def test_the_closed_form_has_its_landmarks() -> None:
    step = 1e-6 * BENT.first_slip
    stuck = WIRE.stiffness * WIRE.radius**2 * np.cos(WIRE.lay) ** 3 / 2.0
    kappas = np.array([0.3, 1.0, 1.0 + 1e-9, 0.5 * np.pi, 3.0]) * BENT.first_slip
    small, first, after, full, beyond = BENT.moment(kappas)
    assert small == pytest.approx(0.3 * BENT.first_slip * stuck, rel=1e-12)
    assert after == pytest.approx(first, rel=1e-6)
    assert full == beyond == pytest.approx(4.0 / np.pi * first, rel=1e-9)
    slope = np.diff(BENT.moment(np.array([1.2 * BENT.first_slip, 1.2 * BENT.first_slip + step])))
    assert 0.0 < slope[0] / step < stuck
    assert BENT.energy(0.9 * BENT.first_slip) == pytest.approx(0.0, abs=1e-9 * first)


def test_latin_finds_the_same_and_certifies_it() -> None:
    curvature = to_and_fro(1.3 * BENT.first_slip, 20)
    scene = rods(curvature)
    problem = scene.discretise()
    method = Latin(direction=Auto(), stop=Stop(accuracy=0.001, iterations=400))
    solution = solve(problem, method)
    found = solution.iterate
    assert solution.is_certified
    exact = incremental_solver(problem).march()
    scale = np.abs(exact.contact_force).max()
    inner = slice(1, -1)
    assert np.abs(found.contact_force - exact.contact_force)[inner].max() < 0.01 * scale
    assert (
        np.abs(found.displacement - exact.displacement).max()
        < 0.01 * np.abs(exact.displacement).max()
    )


def test_cuts_change_nothing() -> None:
    curvature = to_and_fro(1.3 * BENT.first_slip, 10)
    whole, cut = (rods(curvature, 40, n).discretise() for n in (1, 7))
    one, other = incremental(whole), incremental(cut)
    np.testing.assert_allclose(one.displacement[:, -1].max(), other.displacement[:, -1].max())
    np.testing.assert_allclose(one.contact_force, other.contact_force, atol=1e-9 * BENT.bound)


def test_a_uniform_field_is_a_uniform_body_force() -> None:
    load = 1000.0 * np.sin(np.linspace(0.0, 6.0, 31))
    own = {
        "length": 1.0,
        "stiffness": 659_400.0,
        "elements": 20,
        "substructures": 3,
        "bound": np.full(21, 800.0),
        "load": np.zeros(31),
        "instants": np.linspace(0.0, 1.0, 31),
        "duration": 1.0,
    }
    one = incremental(Rods(**own, body_force=load).discretise())
    other = incremental(Rods(**own, body_force=np.tile(load, (21, 1))).discretise())
    np.testing.assert_array_equal(one.displacement, other.displacement)
    np.testing.assert_array_equal(one.contact_force, other.contact_force)


def test_a_coarser_mesh_has_the_same_body_force_at_its_nodes() -> None:
    scene = rods(BENT.first_slip * np.linspace(0.0, 1.2, 7))
    coarser = scene.coarser()
    assert coarser is not None
    assert coarser.body_force is not None
    assert scene.body_force is not None
    np.testing.assert_allclose(coarser.body_force, scene.body_force[::2], rtol=1e-12)


def test_its_body_force_is_drawn_where_it_acts() -> None:
    scene = rods(BENT.first_slip * np.linspace(0.0, 1.2, 7))
    (act,) = (one for one in scene.described().acts if one.where == "body")
    assert act.values.shape == (len(act.places), 7)
    assert scene.body_force is not None
    np.testing.assert_array_equal(act.values[0], scene.body_force[4])


def test_a_body_force_of_another_shape_is_refused() -> None:
    curvature = BENT.first_slip * np.linspace(0.0, 1.2, 7)
    good = rods(curvature)
    assert good.body_force is not None
    with pytest.raises(RefusedError, match="body_force"):
        Rods(**{**vars(good), "body_force": good.body_force.T})
