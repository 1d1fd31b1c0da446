"""A stiff body beside a soft spring: rigid motion hides no deformation.

Balance and closed forms: MATHEMATICS.md, 9.
"""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from runs import errors, solved

from solver.latin import Ending, solve
from solver.laws import OPEN
from solver.reference.distance import kkt_residual
from solver.reference.incremental import reference_of
from solver.scenes import CATALOGUE, discretise
from solver.scenes.incline import InclineSettings
from solver.scenes.method import method_of

SMALL = {"elements": 6, "elements_up": 3, "substructures": 2, "instants": 21}
STEEL = 2.1e11


class Slope:
    """A slope and the forces on its block:
    of the ground at all nodes, and of the spring.
    """

    def __init__(self, found, values):
        self.angle = np.radians(values.path("slope_load"))
        self.weight = values.weight
        self.mu = values.friction
        ground = found.contact("support")
        spring = found.contact("spring")
        self.pressing = ground.normal_force
        self.contacts = ground.tangential_force
        self.spring = spring.normal_force[0]
        self.status = ground.status
        self.down = values.weight * (np.sin(self.angle) - self.mu * np.cos(self.angle))
        self.up = values.weight * (np.sin(self.angle) + self.mu * np.cos(self.angle))

    def unbalanced(self, values):
        """Forces and the moment about the foot that are left over, over the weight."""
        along = (
            self.contacts.sum(axis=0) + self.spring - self.weight * np.sin(self.angle)
        )
        across = self.pressing.sum(axis=0) - self.weight * np.cos(self.angle)
        lever = np.linspace(0.0, values.length, len(self.pressing))
        turning = lever @ self.pressing + 0.5 * self.weight * (
            values.height * np.sin(self.angle) - values.length * np.cos(self.angle)
        )
        return np.abs([along, across, turning / values.length]).max() / self.weight


powers = st.floats(-1.0, 1.0)
contrasts = st.fixed_dictionaries(
    {
        "young": powers.map(lambda power: 10.0 ** (9.0 + 9.0 * power)),
        "spring": powers.map(lambda power: 10.0 ** (6.0 + 12.0 * power)),
        "slack": st.sampled_from([0.0, 2e-4, 1.0, 1e6]),
        "friction": st.sampled_from([0.0, 0.1, 0.3, 0.6]),
        "slope": st.sampled_from([5.0, 20.0, 40.0, 60.0]),
        "slope_load": st.sampled_from(["triangle", "ramp", "hold"]),
    }
)


@settings(max_examples=15)
@given(contrasts)
def test_the_reference_holds_whatever_the_stiffness_of_body_and_spring(values):
    values = InclineSettings.checked(SMALL | values)
    problem = discretise(values)
    found = reference_of(problem)
    forces = Slope(found, values)
    noise = 1e-9 * values.weight
    assert found.converged.all()
    assert kkt_residual(found, problem) < 1e-9
    # Of a hard spring that is far away the slack is not known to the last newton.
    is_far = values.spring * values.slack > 1e20
    assert forces.unbalanced(values) < (1e-9 if is_far else 1e-12)
    assert min(forces.pressing.min(), forces.spring.min()) >= -noise
    most = values.friction * forces.pressing
    assert np.all(np.abs(forces.contacts) <= most + noise)
    slips = (forces.status != OPEN) & (forces.status != 0)
    against = forces.contacts + forces.status * most
    assert np.abs(against[slips]).max(initial=0.0) < noise
    assert np.all(forces.spring >= forces.down - noise)
    assert np.all(forces.spring <= np.maximum(forces.up, 0.0) + noise)


HARD = {
    "steel": {"young": STEEL},
    "a slope of 20 degrees": {"young": STEEL, "slope": 20.0},
    "no slack": {"young": STEEL, "slack": 0.0},
    "no friction": {"young": STEEL, "friction": 0.0},
    "far to slide": {"young": STEEL, "slack": 1e6},
    "a soft spring": {"spring": 1e-6},
    "a hard spring": {"young": STEEL, "spring": 1e18},
    "a soft body": {"young": 1.0},
    "a hard body": {"young": 1e18},
}


@pytest.mark.parametrize("case", HARD)
def test_a_run_ends_certified_and_its_forces_balance(case):
    values = InclineSettings.checked(SMALL | HARD[case])
    run = solved(values)
    assert run.is_certified
    assert run.records[-1].error_force < 1e-9
    assert run.records[-1].error_displacement < 1e-9
    assert Slope(run.iterate, values).unbalanced(values) < 1e-12


@pytest.mark.parametrize("stiffness", [1e-3, 1.0, 1e9])
@pytest.mark.parametrize(
    ("scene", "changes"),
    [
        (
            "block",
            {
                "gap": "flat",
                "top": "traction",
                "top_normal_traction": -1e8,
                "top_tangential_traction": 2e7,
                "elements_up": 3,
            },
        ),
        ("layers", {"elements_up": 1, "layers": 3}),
    ],
)
def test_contacts_that_give_way_hold_bodies_however_softly(scene, changes, stiffness):
    law = {"friction_law": "compliant", "contact_stiffness": stiffness}
    sizes = {"elements": 8, "substructures": 2, "instants": 13}
    problem = discretise(CATALOGUE[scene].checked(sizes | law | changes))
    found = reference_of(problem)
    assert found.converged.all()
    assert kkt_residual(found, problem) < 1e-10


@pytest.mark.parametrize("method", ["paper", "fast"])
def test_the_iteration_itself_does_not_see_how_soft_the_spring_is(method):
    """A shift of the whole body takes no iterations: its own deformation takes all."""
    own = {**SMALL, "young": STEEL, "method": method, "finish": "none"}
    soft, steel, hard = (
        errors(InclineSettings.checked({**own, "spring": spring}), 100)
        for spring in (2e6, 2e9, 1e18)
    )
    for course in (soft, steel, hard):
        assert course[-1] < 1e-3
    if method == "paper":  # an acceleration makes much of rounding on its way
        np.testing.assert_allclose(soft, steel, rtol=0.3, atol=1e-6)
        np.testing.assert_allclose(hard, steel, rtol=0.3, atol=1e-6)


@pytest.mark.parametrize("finish", ["none", "at-once"])
def test_a_run_that_rigid_motion_hides_from_says_what_to_do_and_that_helps(finish):
    hidden = {**SMALL, "young": STEEL, "spring": 2.0, "method": "paper"}
    values = InclineSettings.checked({**hidden, "accuracy": 1e-4, "finish": finish})
    run = solve(discretise(values), method_of(values), watch=False)
    assert run.is_certified == (finish == "at-once")
    if finish == "none":
        assert run.status.ending is Ending.STALLED
        assert "finish=at-once" in run.status.advice
