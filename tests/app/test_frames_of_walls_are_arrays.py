"""A frame takes no work of Python for each joint but a few calls."""

from __future__ import annotations

from itertools import islice

from counting import calls_of

from app.messages import Needs
from app.worker.sampling import Sampler
from solver.latin import iterations
from solver.scenes import CATALOGUE, discretise
from solver.scenes.method import method_of


def test_three_frames_of_a_wall_take_few_calls_a_joint() -> None:
    wall = CATALOGUE["wall"]
    settings = wall(bricks=12, courses=6, instants=11)
    problem = discretise(settings)
    joints = len(problem.contacts)
    assert joints == 201
    iterates = list(islice(iterations(problem, method_of(settings)), 3))
    sampler = Sampler(problem, settings, 1)
    needs = Needs(extras=frozenset({"thrust"}))

    def frames() -> None:
        for iterate in iterates:
            frame = sampler.frame(iterate, [], None, needs)
            assert len(frame.contact) == joints

    # A frame takes 14 calls a joint; with a law for each joint it took 216.
    assert calls_of(frames) <= 20_000
    # Each brick is a substructure; joints and supports are arrays.
    assert calls_of(lambda: discretise(settings)) <= 50_000
