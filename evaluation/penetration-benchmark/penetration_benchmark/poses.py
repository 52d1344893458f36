# SPDX-License-Identifier: MIT OR Apache-2.0
"""Poses to start from, drawn from a seed: the same seed gives the same files.

Only random.random() is used, whose numbers Python promises for ever, and what is drawn is rounded to nine digits before
it is judged.
"""

import math
import random

import numpy as np

from . import exact, shapes
from .files import rotation_of

# How many of each kind in a full set.
COUNTS = {"deep": 60, "concentric": 26, "coincident": 13, "contained": 30, "edges": 20, "shallow": 40, "apart": 20,
          "fine": 12, "drop": 26, "impact": 26, "part": 26}
FREE = ("deep", "concentric", "coincident", "contained", "edges", "shallow")
SCENES = ("drop", "impact", "part")


class Draw:
    def __init__(self, seed, kind, number):
        # A stream for each pose: more poses of one kind change no other.
        self.random = random.Random(f"{seed} {kind} {number}").random

    def pick(self, items):
        return items[int(self.random() * len(items))]

    def between(self, low, high):
        return low + (high - low) * self.random()

    def quaternion(self):
        """All orientations alike (Shoemake 1992)."""
        u, v, w = self.random(), 2 * math.pi * self.random(), 2 * math.pi * self.random()
        a, b = math.sqrt(1 - u), math.sqrt(u)
        return rounded([a * math.sin(v), a * math.cos(v), b * math.sin(w), b * math.cos(w)])

    def direction(self):
        z, turn = self.between(-1, 1), 2 * math.pi * self.random()
        r = math.sqrt(1 - z * z)
        return np.array([r * math.cos(turn), r * math.sin(turn), z])

    def points_inside(self, shape, count):
        low, high = shape.positions.min(0), shape.positions.max(0)
        found = np.empty((0, 3))
        while len(found) < count:
            points = np.array([[self.between(low[i], high[i]) for i in range(3)] for _ in range(8 * count)])
            found = np.concatenate([found, points[exact.classify(points, shape.positions, shape.triangles) > 0]])
        return found[:count]


def rounded(values):
    return [float(f"{x:.9g}") + 0.0 for x in values]


class Shape:
    def __init__(self, name):
        self.name, (self.positions, self.triangles) = name, shapes.make(name)


class Pair:
    def __init__(self, first, second):
        self.names, self.shapes = (first.name, second.name), (first, second)
        self.apart = exact.Apart((first.triangles, second.triangles))

    def positions(self, q, t):
        first, second = self.shapes
        return first.positions, second.positions @ rotation_of(*q).T + np.array(t)

    def are_apart(self, q, t):
        return self.apart(self.positions(q, t))

    def count_inside(self, q, t):
        """Of the first in the second, and of the second in the first."""
        (a, b), (x, y) = self.shapes, self.positions(q, t)
        return (exact.classify(x, y, b.triangles) >= 0).sum(), (exact.classify(y, x, a.triangles) >= 0).sum()

    def is_linked(self, q, t):
        """Two tori through one another, which no rigid motion parts."""
        if self.names != ("torus", "torus"):
            return False
        turn = 2 * np.pi * np.arange(256) / 256
        circle = 0.36 * np.stack([np.cos(turn), np.sin(turn), 0 * turn], 1)
        points = circle @ rotation_of(*q).T + np.array(t)
        passes = points[:, 2] * np.roll(points[:, 2], -1) < 0
        return (passes & (np.hypot(points[:, 0], points[:, 1]) < 0.36)).sum() % 2 == 1


def draw(seed, kind, number, shape):
    """(pair, kind, quaternion, translation) of one pose; shape(name) gives a Shape."""
    random_ = Draw(seed, kind, number)
    while True:
        pair, q, t = globals()[f"draw_{kind}"](random_, number, shape)
        if not pair.is_linked(q, t):
            return pair.names, kind, q, t


def draw_deep(random_, _, shape):
    """A random point inside one on a random point inside the other; of six draws the one that overlaps most."""
    pair = Pair(shape(random_.pick(shapes.BODIES)), shape(random_.pick(shapes.BODIES)))
    first, second = pair.shapes
    inside, best = [random_.points_inside(body, 24) for body in pair.shapes], (-1.0, None, None)
    for _ in range(6):
        q = random_.quaternion()
        t = rounded(random_.pick(inside[0]) - rotation_of(*q) @ random_.pick(inside[1]))
        if pair.is_linked(q, t):
            continue
        moved = inside[1] @ rotation_of(*q).T + np.array(t)
        share = (exact.classify(moved, first.positions, first.triangles) > 0).mean()
        best = max(best, (share, q, t))
    return (pair, *best[1:]) if best[1] else draw_deep(random_, 0, shape)


def draw_concentric(random_, number, shape):
    """A body and the same again, turned about its middle."""
    body = shape(shapes.BODIES[number % len(shapes.BODIES)])
    pair = Pair(body, body)
    while True:
        q, t = random_.quaternion(), rounded(0.02 * random_.direction())
        # The middle of an L is outside it.
        if not pair.are_apart(q, t):
            return pair, q, t


def draw_coincident(_, number, shape):
    """A body and the same again in the same place."""
    body = shape(shapes.BODIES[number % len(shapes.BODIES)])
    return Pair(body, body), [1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0]


def draw_contained(random_, _, shape):
    """A small body swallowed by another."""
    holders = [name for name in shapes.BODIES if name not in ("plate", "bowl", "helix")]
    while True:
        pair = Pair(shape(random_.pick(holders)), shape(random_.pick(shapes.SMALL)))
        q, t = random_.quaternion(), rounded(random_.points_inside(pair.shapes[0], 1)[0])
        first, second = pair.positions(q, t)
        if pair.count_inside(q, t) == (0, len(second)) and not (
                exact.edges_meet(first, pair.apart.edges[0], second, pair.shapes[1].triangles)
                or exact.edges_meet(second, pair.apart.edges[1], first, pair.shapes[0].triangles)):
            return pair, q, t


def draw_edges(random_, _, shape):
    """Surfaces that cross with no vertex of either inside the other."""
    while True:
        pair = Pair(shape(random_.pick(("bar", "plate", "box", "cross"))), shape(random_.pick(("bar", "plate"))))
        q, t = random_.quaternion(), rounded(random_.between(0, 0.4) * random_.direction())
        if pair.count_inside(q, t) == (0, 0) and not pair.are_apart(q, t):
            return pair, q, t


def touching(pair, random_):
    """Direction and the way along it from which on the second body is away from the first."""
    q, way = random_.quaternion(), random_.direction()
    return q, way, free_way(pair, q, np.zeros(3), way)


def free_way(pair, q, start, way):
    near, far = 0.0, 3.0
    for _ in range(24):
        middle = (near + far) / 2
        near, far = (near, middle) if pair.are_apart(q, start + middle * way) else (middle, far)
    return far


def draw_shallow(random_, _, shape):
    """Pressed by 0.1 to 1 % of the size from a touch."""
    pair = Pair(shape(random_.pick(shapes.BODIES)), shape(random_.pick(shapes.BODIES)))
    while True:
        q, way, far = touching(pair, random_)
        t = rounded((far - random_.between(0.001, 0.01)) * way)
        if not pair.are_apart(q, t):
            return pair, q, t


def draw_apart(random_, _, shape):
    """A gap of up to 1 % of the size along a line."""
    pair = Pair(shape(random_.pick(shapes.BODIES)), shape(random_.pick(shapes.BODIES)))
    while True:
        q, way, far = touching(pair, random_)
        t = rounded((far + random_.between(0.001, 0.01)) * way)
        if pair.are_apart(q, t):
            return pair, q, t


def draw_fine(random_, number, shape):
    """Thousands of triangles: touching by 1 % or with the middle of one in the surface of the other."""
    names = (("ball_fine", "ball_fine"), ("torus_fine", "torus_fine"), ("torus_fine", "ball_fine"))[number % 3]
    pair = Pair(*map(shape, names))
    if number % 2:
        q, way = random_.quaternion(), random_.direction()
        return pair, q, rounded(0.3 * way)
    while True:
        q, way, far = touching(pair, random_)
        t = rounded((far - 0.01) * way)
        if not pair.are_apart(q, t):
            return pair, q, t


def draw_drop(random_, number, shape):
    """One hundredth above a slab or a bumpy tray."""
    pair = Pair(shape(shapes.GROUNDS[number % 2]), shape(shapes.BODIES[number % len(shapes.BODIES)]))
    q, start = random_.quaternion(), np.array([random_.between(-0.3, 0.3), random_.between(-0.3, 0.3), 0.0])
    up = np.array([0.0, 0.0, 1.0])
    return pair, q, rounded(start + (free_way(pair, q, start, up) + 0.01) * up)


draw_impact, draw_part = draw_drop, draw_deep
