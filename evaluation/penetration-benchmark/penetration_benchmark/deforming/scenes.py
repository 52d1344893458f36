# SPDX-License-Identifier: MIT OR Apache-2.0
"""Elastic bodies of tetrahedra, in metres, and the scenes made of them; what is loaded is loaded along x."""

import itertools

import numpy as np

from .. import bodies, exact
from ..poses import Draw

SPEED, INTO = 1.0, 0.2
# Between bodies that start apart: of those that run into one another, and of those that are loaded.
GAP, LOAD_GAP = 0.05, 0.01
LOADED, GRAVITY = 0.5, 9.81


# ---- Bodies of about size 1 ----

def box(cells=(4, 4, 4), sides=(1, 1, 1)):
    grid, tetrahedra = bodies.blocks(cells, False)
    return (grid / cells - 0.5) * sides, tetrahedra


def ball():
    points, tetrahedra = box()
    # Shells of the cube become shells of the ball.
    length = np.linalg.norm(points, axis=1)
    return points * (np.abs(points).max(axis=1) / np.where(length > 0, length, 1))[:, None], tetrahedra


def torus():
    grid, tetrahedra = bodies.blocks((16, 2, 2), True)
    angle, across = 2 * np.pi * grid[:, 0] / 16, grid[:, 1:] - 1
    length = np.linalg.norm(across, axis=1)
    across = 0.15 * across * (np.abs(across).max(axis=1) / np.where(length > 0, length, 1))[:, None]
    radius = 0.35 + across[:, 0]
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), -across[:, 1]], 1), tetrahedra


def scan(path, cells=8):
    """The cubes of a grid whose middles lie inside a closed surface."""
    with open(path, encoding="utf-8") as file:
        lines = [line.split() for line in file]
    points = np.array([[float(word) for word in words[1:4]] for words in lines if words[:1] == ["v"]])
    corners = [words[1:4] for words in lines if words[:1] == ["f"]]
    triangles = np.array([[int(word.split("/")[0]) - 1 for word in words] for words in corners])
    points = (points - points.min(0)) / np.ptp(points, axis=0).max() * cells
    grid, tetrahedra = bodies.blocks((cells, cells, cells), False)
    inside = exact.classify(grid[tetrahedra[::6]].min(axis=1) + 0.5, points, triangles) > 0
    tetrahedra = tetrahedra.reshape(-1, 6, 4)[inside].reshape(-1, 4)
    used, tetrahedra = np.unique(tetrahedra, return_inverse=True)
    return grid[used] / cells - 0.5, tetrahedra.reshape(-1, 4)


class Body:
    """At rest. Vertices of the surface come first."""

    def __init__(self, points, tetrahedra):
        made = bodies.from_tetrahedra("", points, tetrahedra)
        self.points, self.triangles, self.tetrahedra = made[1], made[2].astype(int), made[3].astype(int)

    def placed(self, x=0.0, y=0.0, z=0.0, turn=0.0, size=1.0):
        """A copy, turned about the x axis."""
        cos, sin = np.cos(turn), np.sin(turn)
        copy = Body.__new__(Body)
        copy.triangles, copy.tetrahedra = self.triangles, self.tetrahedra
        copy.points = size * self.points @ np.array([[1, 0, 0], [0, cos, sin], [0, -sin, cos]]) + [x, y, z]
        return copy

    def low(self):
        return self.points[:, 0].min()

    def high(self):
        return self.points[:, 0].max()


class Scene:
    """Bodies, their nodes one after the other. `fixed` nodes are held where they are, `pushed` ones are moved along x
    with a speed, until `LOADED`, and held then."""

    seconds, gravity, fixed, pushed, push = 1.0, 0.0, (), (), 0.0

    def __init__(self, name, start, made):
        self.name, self.start, self.bodies = name, start, made
        self.firsts = np.cumsum([0, *(len(body.points) for body in made)])
        self.rest = np.vstack([body.points for body in made])
        self.velocities = np.zeros_like(self.rest)
        self.tetrahedra = np.vstack([body.tetrahedra + first for body, first in zip(made, self.firsts)])
        self.triangles = np.vstack([body.triangles + first for body, first in zip(made, self.firsts)])
        self.is_pair = start != "loaded"
        self.is_apart = exact.Apart([body.triangles for body in made]) if self.is_pair else None

    def held(self):
        return np.concatenate([self.fixed, self.pushed]).astype(int)

    def pushed_speed(self, time):
        return self.push if time < LOADED - 1e-9 else 0.0

    def parts(self, x):
        return np.split(x, self.firsts[1:-1])

    def depth(self, x):
        """Of the deepest vertex in another body, by all its triangles."""
        deepest = 0.0
        for (own, _), (other, body) in itertools.permutations(zip(self.parts(x), self.bodies), 2):
            for point in own[exact.classify(own, other, body.triangles) > 0]:
                deepest = max(deepest, distance(point, other[body.triangles]))
        return deepest


def distance(p, corners):
    a, b, c = corners.transpose(1, 0, 2)
    squared = np.full(len(a), np.inf)
    for start, end in ((a, b), (b, c), (c, a)):
        way = end - start
        t = np.clip(np.einsum("ij,ij->i", p - start, way) / np.einsum("ij,ij->i", way, way), 0, 1)
        squared = np.minimum(squared, ((start + t[:, None] * way - p) ** 2).sum(axis=1))
    normal = np.cross(b - a, c - a)
    is_above = np.minimum.reduce([np.einsum("ij,ij->i", np.cross(end - start, p - start), normal)
                                  for start, end in ((a, b), (b, c), (c, a))]) >= 0
    plane = np.einsum("ij,ij->i", p - a, normal) ** 2 / np.einsum("ij,ij->i", normal, normal)
    squared[is_above] = np.minimum(squared, plane)[is_above]
    return squared.min() ** 0.5


# ---- Scenes; what is drawn from the seed is how the bodies lie beside one another ----

def pair(name, first, second, is_deep, draw):
    """Two that run into one another, or that start in one another at rest."""
    first = first.placed(turn=draw.between(0, 2 * np.pi))
    second = second.placed(turn=draw.between(0, 2 * np.pi))
    x = first.high() - second.low() + (-INTO if is_deep else GAP)
    made = Scene(name, "deep" if is_deep else "apart",
                 [first, second.placed(x, draw.between(-0.1, 0.1), draw.between(-0.1, 0.1))])
    if not is_deep:
        made.velocities[:, 0] = np.repeat([SPEED / 2, -SPEED / 2], np.diff(made.firsts))
    return made


def pressed(name, lower, upper, is_pushed, way, draw):
    """`upper` on `lower`, of which the lowest nodes are fixed; nodes of `upper` go down by `way`."""
    at = [draw.between(-0.05, 0.05) for _ in range(2)]
    upper = upper.placed(lower.high() - upper.low() + LOAD_GAP, *at, draw.between(-0.2, 0.2))
    made = Scene(name, "loaded", [lower, upper])
    made.fixed = np.flatnonzero(lower.points[:, 0] < lower.low() + 1e-9)
    made.pushed, made.push = made.firsts[1] + np.flatnonzero(is_pushed(upper)), -(way + LOAD_GAP) / LOADED
    return made


def tray():
    """Of 2 by 2, with a floor of a quarter and walls three times as high."""
    grid, tetrahedra = bodies.blocks((3, 8, 8), False)
    lowest = grid[tetrahedra].min(axis=1)
    is_kept = (lowest[:, 0] == 0) | (lowest[:, 1:] == 0).any(axis=1) | (lowest[:, 1:] == 7).any(axis=1)
    used, tetrahedra = np.unique(tetrahedra[is_kept], return_inverse=True)
    return grid[used] / 4 - [0.25, 1, 1], tetrahedra.reshape(-1, 4)


def pile(shapes, draw):
    """Five bodies that fall into a soft tray, four side by side and one on top."""
    made = [Body(*tray())]
    for name, y, z in (("box", -1, -1), ("ball", -1, 1), ("torus", 1, -1), ("ball", 1, 1), ("box", 0, 0)):
        body, up = shapes[name].placed(size=0.5), LOAD_GAP + 0.55 * (y == 0)
        turn = draw.between(-0.2, 0.2)
        y, z = (0.36 * at + draw.between(-0.02, 0.02) for at in (y, z))
        made.append(body.placed(up - body.low(), y, z, turn))
    made = Scene("pile", "loaded", made)
    low = made.bodies[0]
    made.fixed, made.gravity, made.seconds = np.flatnonzero(low.points[:, 0] < low.low() + 1e-9), GRAVITY, 2.0
    return made


def scenes(seed, path=""):
    """All of them; with a scanned surface one pair more."""
    shapes = {"box": Body(*box()), "ball": Body(*ball()), "torus": Body(*torus())}
    pairs = [("box", "box"), ("ball", "ball"), ("torus", "torus"), ("box", "ball"), ("ball", "torus")]
    if path:
        shapes["scan"] = Body(*scan(path))
        pairs.append(("scan", "ball"))
    for number, names in enumerate(pairs):
        for is_deep in (False, True):
            yield pair("-".join(names), *map(shapes.get, names), is_deep, Draw(seed, "pair", 2 * number + is_deep))

    def top(body):
        return body.points[:, 0] > body.high() - 1e-9

    def upper_half(body):
        return body.points[:, 0] > (body.low() + body.high()) / 2

    slab, cube, small = Body(*box((1, 4, 4), (0.2, 1, 1))), shapes["box"], shapes["ball"].placed(size=0.6)
    loads = [("column to 75 %", cube, cube, top, 0.5), ("column to 50 %", cube, cube, top, 1.0),
             ("slabs to 75 %", slab, slab, top, 0.1), ("ball in block", cube, small, upper_half, 0.5)]
    for number, load in enumerate(loads):
        yield pressed(*load, Draw(seed, "load", number))
    yield pile(shapes, Draw(seed, "pile", 0))
