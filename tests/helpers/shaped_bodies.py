"""Small structures of bodies of any shape, shared by tests."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from solver.discrete import Beam, Bodies, Body, Held, Joint, Load, Mesh

Numbers = NDArray[np.intp]


def grid(x: Any, y: Any) -> Mesh:
    """Quadrilaterals between lines along x and y; corners row by row from below."""
    corners = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
    numbers = np.arange(len(corners)).reshape(len(y), len(x))
    ends = numbers[:-1, :-1], numbers[:-1, 1:], numbers[1:, 1:], numbers[1:, :-1]
    return Mesh(corners, np.stack([each.ravel() for each in ends], axis=1))


def sides(mesh: Mesh, n_x: int, n_y: int) -> dict[str, Numbers]:
    """Chains of the sides of a grid of n_x by n_y elements, in ascending order."""
    numbers = np.arange((n_x + 1) * (n_y + 1)).reshape(n_y + 1, n_x + 1)
    lines = {
        "bottom": numbers[0],
        "top": numbers[-1],
        "left": numbers[:, 0],
        "right": numbers[:, -1],
    }
    return {name: mesh.along(corners) for name, corners in lines.items()}


def in_triangles(mesh: Mesh) -> Mesh:
    """Each quadrilateral of a mesh as two triangles."""
    a, b, c, d = mesh.elements.T
    halves = [np.stack([a, b, c], axis=1), np.stack([c, d, a], axis=1)]
    return Mesh(mesh.corners, np.concatenate(halves))


def distorted(mesh: Mesh, size: float) -> Mesh:
    """A mesh whose inner corners are moved by up to a size."""
    low = mesh.corners.min(axis=0)
    high = mesh.corners.max(axis=0)
    is_inner = np.all((mesh.corners > low) & (mesh.corners < high), axis=1)
    moved = np.random.default_rng(1).uniform(-size, size, mesh.corners.shape)
    return Mesh(mesh.corners + moved * is_inner[:, None], mesh.elements)


def voussoir(radii: NDArray[np.float64], half: float) -> Mesh:
    """A voussoir about the crown, from its right joint to its left one."""
    flat = grid(radii, 0.5 * np.pi + np.linspace(-half, half, 4))
    r, angles = flat.corners.T
    polar = np.stack([r * np.cos(angles), r * np.sin(angles)], axis=1)
    return Mesh(polar, flat.elements)


def radial_joints(
    voussoirs: int,
    friction: float,
    of_stone: dict[str, Numbers],
    of_block: Numbers,
) -> list[Joint]:
    """Joints of an arch from left to right, and with both abutments."""
    joints = []
    for number in range(voussoirs + 1):
        angle = np.pi * (1.0 - number / voussoirs)
        above = of_stone["bottom"]
        below = of_stone["top"]
        if number == 0:
            above = of_block[::-1]
        if number == voussoirs:
            below = of_block
        normals = np.tile([-np.sin(angle), np.cos(angle)], (len(above), 1))
        joint = Joint(
            f"joint {number}",
            above=number,
            nodes=above,
            below=number + 1,
            nodes_below=below,
            normals=normals,
            friction=friction,
        )
        joints.append(joint)
    return joints


def arch(
    voussoirs: int = 15,
    thickness: float = 0.15,
    *,
    across: int = 2,
    friction: float = 0.6,
    spread: float = 0.0,
    young: float = 1e10,
    instants: int = 21,
    density: float = 2e4,
) -> Bodies:
    """Semicircle of mean radius 1 m; the right abutment moves out after the weight."""
    t = np.linspace(0.0, 1.0, instants)
    radii = np.linspace(1.0 - 0.5 * thickness, 1.0 + 0.5 * thickness, across + 1)
    stone = voussoir(radii, 0.5 * np.pi / voussoirs)
    block = grid(radii, np.linspace(-0.15, 0.0, 4))
    left_block = grid(-radii[::-1], np.linspace(-0.15, 0.0, 4))
    weight = density * np.outer([0.0, -1.0], np.minimum(t / 0.3, 1.0))
    # From left to right; of two neighbours the one on the right is below.
    bodies = [Body("left abutment", left_block, young, 0.2)]
    for number in range(voussoirs):
        turn = np.pi * (0.5 - (number + 0.5) / voussoirs)
        name = f"voussoir {number + 1}"
        bodies.append(Body(name, stone, young, 0.2, angle=turn, weight=weight))
    bodies.append(Body("right abutment", block, young, 0.2))
    top = sides(block, across, 3)["top"]
    joints = radial_joints(voussoirs, friction, sides(stone, across, 3), top)
    move = np.clip((t - 0.3) / 0.7, 0.0, 1.0) * spread
    foot = sides(block, across, 3)["bottom"]
    held = [
        Held("left x", 0, foot, 0, 0.0 * t),
        Held("left y", 0, foot, 1, 0.0 * t),
        Held("right x", voussoirs + 1, foot, 0, move),
        Held("right y", voussoirs + 1, foot, 1, 0.0 * t),
    ]
    return Bodies(bodies, joints, held, (), t, 1.0, shown="right x")


def belt(
    wrap: float,
    friction: float,
    ratio: float,
    *,
    nodes: int = 61,
    instants: int = 21,
) -> Bodies:
    """Belt on a rigid drum of radius 0.1 m, held by 1 kN, pulled up to a multiple."""
    t = np.linspace(0.0, 1.0, instants)
    angles = 0.5 * np.pi + np.linspace(0.5 * wrap, -0.5 * wrap, nodes)
    outward = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    first = np.array([np.sin(angles[0]), -np.cos(angles[0])])
    last = np.array([np.sin(angles[-1]), -np.cos(angles[-1])])
    arc = 0.1 * outward
    line = np.concatenate([[arc[0] - 0.05 * first], arc, [arc[-1] + 0.05 * last]])
    shape = Beam(line, area=1e-4, second_moment=1e-11)
    on_drum = np.arange(1, nodes + 1)
    drum = Joint("drum", 0, on_drum, None, None, outward, friction=friction)
    up = np.minimum(t / 0.3, 1.0)
    pull = np.clip((t - 0.3) / 0.7, 0.0, 1.0)
    tight = 1e3 * np.outer(last, up + (ratio - 1.0) * pull)
    slack = -1e3 * np.outer(first, up)
    loads = [
        Load("pull", 0, np.array([nodes + 1]), tight[None]),
        Load("tail", 0, np.array([0]), slack[None]),
    ]
    return Bodies([Body("belt", shape, 1e11)], [drum], [], loads, t, 1.0)


def leaf(elements: int, *, friction: float, count: int = 1, cuts: int = 1) -> Bodies:
    """Leaves of 1 m, one on the other and on the ground, pressed and pulled."""
    t = np.linspace(0.0, 1.0, 9)
    x = np.linspace(0.0, 1.0, elements + 1)
    every = np.arange(elements + 1)
    up = np.tile([0.0, 1.0], (elements + 1, 1))
    line = Beam(np.stack([x, 0.0 * x], axis=1), area=1e-2, second_moment=1e-6)
    bodies = [
        Body(f"leaf {number}", line, 1e9, substructures=cuts) for number in range(count)
    ]
    joints = [Joint("ground", 0, every, None, None, up, friction=friction)]
    for number in range(1, count):
        below = number - 1
        name = f"joint {number}"
        joints.append(Joint(name, number, every, below, every, up, friction=friction))
    press = np.zeros((elements + 1, 2, len(t)))
    press[:, 1] = -1e4 * line.shares(every)[:, None]
    pull = np.zeros((1, 2, len(t)))
    pull[0, 0] = 1250.0 * np.sin(2.0 * np.pi * t)
    loads = [Load("press", count - 1, every, press), Load("pull", 0, every[-1:], pull)]
    held = [Held("left", count - 1, every[:1], 0, np.zeros_like(t))]
    return Bodies(bodies, joints, held, loads, t, 1.0)


def leaf_spring(elements: int, count: int, *, friction: float = 0.3) -> Bodies:
    """Clamped leaves of 0.5 m by 5 mm, pressed together, whose end is moved up."""
    t = np.linspace(0.0, 1.0, 9)
    x = np.linspace(0.0, 0.5, elements + 1)
    every = np.arange(elements + 1)
    line = Beam(np.stack([x, 0.0 * x], axis=1), area=5e-3, second_moment=1.04e-8)
    bodies = [Body(f"leaf {number}", line, 2e11) for number in range(count)]
    free = every[1:]
    up = np.tile([0.0, 1.0], (elements, 1))
    joints = [
        Joint(f"joint {number}", number, free, number - 1, free, up, friction=friction)
        for number in range(1, count)
    ]
    press = np.zeros((elements + 1, 2, len(t)))
    press[:, 1] = -2e5 * np.outer(line.shares(every), np.minimum(4.0 * t, 1.0))
    loads = [
        Load("press", count - 1, every, press),
        Load("press from below", 0, every, -press),
    ]
    held = []
    for number in range(count):
        for axis in range(3):
            name = f"clamp {number} {axis}"
            held.append(Held(name, number, every[:1], axis, 0.0 * t))
    path = 0.01 * np.clip(2.0 * t - 0.5, 0.0, 1.0)
    held.append(Held("end", 0, every[-1:], 1, path))
    return Bodies(bodies, joints, held, loads, t, 1.0)


def rotation(angle: float) -> NDArray[np.float64]:
    """Matrix that turns vectors by an angle, rad, (2, 2)."""
    c = np.cos(angle)
    s = np.sin(angle)
    return np.array([[c, -s], [s, c]])


def block_on_ground(
    mesh: Mesh, chains: dict[str, Numbers], *, angle: float = 0.0, cuts: int = 1
) -> Bodies:
    """A block 0.1 by 0.05 m pressed on a rigid support and sheared, turned as a whole.

    The top is pressed and sheared by tractions, so that nothing holds an axis.
    """
    t = np.linspace(0.0, 1.0, 11)
    turn = rotation(angle)
    press = -1e6 * np.minimum(3.0 * t, 1.0)
    shear = 2.2e5 * np.sin(2.0 * np.pi * np.clip(1.5 * t - 0.5, 0.0, 1.0))
    body = Body("block", mesh, 2e10, 0.3, angle=angle, substructures=cuts)
    foot = chains["bottom"]
    top = chains["top"]
    load = Load.of_traction("top", 0, body, top, turn @ np.stack([shear, press]))
    normals = np.tile(turn @ [0.0, 1.0], (len(foot), 1))
    ground = Joint("ground", 0, foot, None, None, normals, friction=0.3)
    return Bodies([body], [ground], [], [load], t, 1.0)


def half_ring(angles: NDArray[np.float64], radii: NDArray[np.float64]) -> Mesh:
    """A mesh between radii and angles, which both ascend; circle by circle outward."""
    flat = grid(angles, radii)
    a, r = flat.corners.T
    polar = np.stack([r * np.cos(a), r * np.sin(a)], axis=1)
    return Mesh(polar, flat.elements[:, ::-1].copy())


def pressed_wire(wire: Mesh, n_angles: int, force: float, foot: Numbers) -> Bodies:
    """Lower half of a round wire of radius 0.01 m on a flat, pressed by a force.

    Without friction, which would keep the wire from widening under the contact.
    """
    t = np.linspace(0.0, 1.0, 4)
    up = np.tile([0.0, 1.0], (len(foot), 1))
    gap = wire.nodes[foot, 1] + 0.01
    ground = Joint("ground", 0, foot, None, None, up, gap)
    left = wire.along(np.arange(0, wire.n_corners, n_angles))
    right = wire.along(np.arange(n_angles - 1, wire.n_corners, n_angles))
    faces = np.concatenate([left, right])
    shares = np.tile(wire.shares(left), 2)
    down = np.outer(shares / shares.sum(), [0.0, -force])
    held = Held("faces", 0, faces, 0, 0.0 * t)
    load = Load("press", 0, faces, np.multiply.outer(down, t))
    wires = [Body("wire", wire, 1e11, 0.3)]
    return Bodies(wires, [ground], [held], [load], t, 1.0, shown="press")


def half_wire(fine: int, force: float) -> Bodies:
    """Half of a round wire with a bore, with `fine` elements on 0.08 rad each side."""
    beyond = np.geomspace(0.08, 0.5 * np.pi, 2 * fine + 1)
    outer = np.append(np.linspace(0.0, 0.08, fine + 1), beyond[1:])
    angles = -0.5 * np.pi + np.append(-outer[:0:-1], outer)
    steps = np.cumsum(1.3 ** np.arange(14))
    wire = half_ring(angles, 0.01 - 0.007 * np.append(0.0, steps)[::-1] / steps[-1])
    below = wire.n_corners - len(outer)
    foot = wire.along(np.arange(below - fine, below + fine + 1))
    return pressed_wire(wire, len(angles), force, foot)


def courses_of_blocks(columns: int, courses: int) -> Bodies:
    """Blocks 0.1 by 0.05 m beside and above each other; each has joints all round.

    Those of the lowest course are held at their feet, which no joint reaches.
    """
    mesh = grid(np.linspace(0.0, 0.1, 5), np.linspace(0.0, 0.05, 3))
    chains = sides(mesh, 4, 2)
    bodies = []
    joints = []
    for course in range(courses):
        for column in range(columns):
            number = len(bodies)
            origin = np.array([0.1 * column, 0.05 * course])
            bodies.append(Body(f"block {number}", mesh, 2e10, 0.2, origin=origin))
            if course:
                joints.append(
                    _joint_below(chains, number, number - columns, ("bottom", "top"))
                )
            if column:
                joints.append(
                    _joint_below(chains, number, number - 1, ("left", "right"))
                )
    t = np.linspace(0.0, 1.0, 5)
    held = [
        Held(f"foot {number} {axis}", number, chains["bottom"], axis, 0.0 * t)
        for number, axis in np.ndindex(columns, 2)
    ]
    return Bodies(bodies, joints, held, [], t, 1.0)


def _joint_below(
    chains: dict[str, Numbers], above: int, below: int, names: tuple[str, str]
) -> Joint:
    """Joint of equal blocks, along their sides by name, that of the one above first."""
    nodes = chains[names[0]]
    normal = {"bottom": [0.0, 1.0], "left": [1.0, 0.0]}[names[0]]
    normals = np.tile(normal, (len(nodes), 1))
    name = f"{below} and {above}"
    return Joint(name, above, nodes, below, chains[names[1]], normals, friction=0.5)
