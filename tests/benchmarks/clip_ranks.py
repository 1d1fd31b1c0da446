"""Rank of the argument of a clip in the plane, where the bound is mu N(x, t).

A matrix of low rank is sought that is the friction where a point sticks, and beyond the
bound where it slips: clipped at the bound it is the friction. Both factors are found at
once by L-BFGS, from singular vectors and from the solution of the rank before, first
for the distance to these sets, then for that of the clipped field.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize

from solver.arrays import Array
from solver.files.saved import scene_settings
from solver.study.scene_run import finished_run

AT_BOUND = 1e-9
STEPS = 3000
SMALL_ENOUGH = 0.005
NOISE = 1e-3
MOST = 8
SCENES = {"block": {}, "block, ramp": {"top_tangential_load": "ramp"}, "layers": {}}
Loss = Callable[[Array], tuple[float, Array]]


@dataclass(frozen=True)
class Traction:
    """Friction and its bound, times the roots of lengths and of weights of instants.

    Attributes
    ----------
    friction, bound
        Shape (n_points, n_instants).
    """

    friction: Array
    bound: Array

    @property
    def size(self) -> float:
        """Norm of the friction."""
        return float(np.linalg.norm(self.friction))

    def error(self, argument: Array) -> float:
        """Relative error of a clipped argument."""
        clipped = np.clip(argument, -self.bound, self.bound)
        return float(np.linalg.norm(clipped - self.friction)) / self.size

    def losses(self, rank: int) -> list[Loss]:
        """Both distances as functions of the factors, with their gradients."""
        reached = self.bound * (1.0 - AT_BOUND)
        low = np.where(self.friction <= -reached, -np.inf, self.friction)
        high = np.where(self.friction >= reached, np.inf, self.friction)

        def to_sets(both: Array) -> tuple[float, Array]:
            argument = product(both, rank, self.friction.shape[0])
            return self._loss(both, rank, argument - np.clip(argument, low, high))

        def of_clipped(both: Array) -> tuple[float, Array]:
            argument = product(both, rank, self.friction.shape[0])
            left = np.clip(argument, -self.bound, self.bound) - self.friction
            value, _ = self._loss(both, rank, left)
            return value, self._loss(
                both, rank, left * (np.abs(argument) < self.bound)
            )[1]

        return [to_sets, of_clipped]

    def _loss(self, both: Array, rank: int, left: Array) -> tuple[float, Array]:
        points = len(left)
        space = both[: points * rank]
        time = both[points * rank :]
        gradient = left @ time.reshape(-1, rank), left.T @ space.reshape(-1, rank)
        whole = np.concatenate([one.ravel() for one in gradient]) / self.size**2
        return 0.5 * float(np.sum(left**2)) / self.size**2, whole


def product(both: Array, rank: int, points: int) -> Array:
    """Product, (n_points, n_times), of factors that lie one behind the other."""
    space = both[: points * rank]
    time = both[points * rank :]
    return np.asarray(space.reshape(-1, rank) @ time.reshape(-1, rank).T)


def fitted(field: Traction, rank: int, start: Array) -> Array:
    """Argument of a rank, sought from a start, (n_points, n_times) both."""
    left, values, right = np.linalg.svd(start, full_matrices=False)
    root = np.sqrt(values[:rank])
    both = np.concatenate(
        [(left[:, :rank] * root).ravel(), (right[:rank].T * root).ravel()]
    )
    found = []
    options = {
        "maxiter": STEPS,
        "maxfun": 10 * STEPS,
        "maxcor": 30,
        "ftol": 1e-15,
        "gtol": 1e-12,
    }
    for loss in field.losses(rank):
        both = minimize(loss, both, jac=True, method="L-BFGS-B", options=options).x
        found.append(product(both, rank, len(start)))
    return min(found, key=field.error)


def best_products(field: Array) -> Array:
    """Error of the best approximation of every rank from 0 on, (n_ranks + 1,)."""
    squares = np.linalg.svd(field, compute_uv=False) ** 2
    left = np.append(np.cumsum(squares[::-1])[::-1], 0.0)
    return np.sqrt(left / left[0])


def cattaneo() -> Traction:
    """Traction of Cattaneo and Mindlin, on a ramp to 0.95 of full slip, over mu p0."""
    x = np.linspace(-1.0, 1.0, 402)[1:-1, None]
    stuck = 1.0 - np.linspace(0.0, 0.95, 101) - x**2
    bound = np.broadcast_to(np.sqrt(1.0 - x**2), stuck.shape)
    return Traction(bound - np.sqrt(np.maximum(stuck, 0.0)), bound)


def solved(scene: str, **changes: str) -> Traction:
    """Friction on all interfaces of a scene, and mu N."""
    run = finished_run(
        scene_settings(scene).checked(changes), errors=False, indicators=False
    )
    friction = []
    bounds = []
    for name, law in run.problem.contacts.items():
        shown = run.iterate.contact(name)
        assert shown.normal_force is not None
        root = np.sqrt(law.by_point(law.weights))[:, None]
        coefficient = law.mean_by_point(law.tangential.friction)[:, None]
        friction.append(shown.tangential_force / root)
        bounds.append(coefficient * np.maximum(shown.normal_force, 0.0) / root)
    time = np.sqrt(run.problem.time_weights)
    return Traction(np.concatenate(friction) * time, np.concatenate(bounds) * time)


def report(name: str, field: Traction) -> None:
    """Print errors over the rank, until they are small."""
    products = best_products(field.friction)
    bounds = best_products(field.bound)
    needed = [int(np.argmax(one <= 0.01)) for one in (products, bounds)]
    print(f"{name}, {field.friction.shape}: 1 % takes {needed[0]} products,", end=" ")
    print(f"its bound {needed[1]}", flush=True)
    noise = np.random.default_rng(0)
    found = field.friction
    for rank in range(1, MOST + 1):
        shaken = found + NOISE * np.abs(found).max() * noise.standard_normal(
            found.shape
        )
        tried = [fitted(field, rank, start) for start in (field.friction, shaken)]
        found = min(tried, key=field.error)
        error = field.error(found)
        print(
            f"  rank {rank}: clip {error:.2%}, products {products[rank]:.2%}",
            flush=True,
        )
        if error < SMALL_ENOUGH:
            break


if __name__ == "__main__":
    fields = {"Cattaneo": cattaneo}
    fields |= {
        name: lambda name=name, changes=changes: solved(name.split(",")[0], **changes)
        for name, changes in SCENES.items()
    }
    for name in sys.argv[1:] or fields:
        report(name, fields[name]())
