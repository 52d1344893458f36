# SPDX-License-Identifier: MIT OR Apache-2.0
"""Bodies of tetrahedra that overlap themselves, drawn from a seed: bars and sheets bent along a curve that comes back
to where it has been. No tetrahedron is turned inside out.
"""

import itertools

import numpy as np

from .files import rotation_of
from .library import Body
from .poses import Draw

# How many of each kind in a full set.
COUNTS = {"ring": 6, "eight": 6, "pinch": 6, "fold": 6}
# How far vertices are shifted, in the side of a cell, so that surfaces are uneven and nothing lies in one plane.
SHIFT = 0.05


def make(seed, kind, number):
    """One Body: its longest side is 1, and it lies turned at random."""
    random_ = Draw(seed, kind, number)
    while True:
        counts, is_closed, sides, curve = globals()[f"draw_{kind}"](random_, 1 + number % 3)
        grid, tetrahedra = blocks(counts, is_closed)
        shift = np.array([random_.between(-SHIFT, SHIFT) for _ in range(grid.size)]).reshape(-1, 3)
        positions = bent((grid + shift) / counts, sides, curve)
        positions = positions @ rotation_of(*random_.quaternion()).T
        low, high = positions.min(0), positions.max(0)
        positions = (positions - (low + high) / 2) / (high - low).max()
        # Nine digits: the file is the same on every machine.
        body = from_tetrahedra(f"{kind}_{number}", np.round(positions, 9) + 0.0, tetrahedra)
        # A curve too tight for its bar turns tetrahedra inside out, at its inner side: another draw.
        if (volumes(body.positions, body.tetrahedra) > 0).all():
            return body


def draw_ring(random_, fineness):
    """A bar of which the ends lie in one another: a circle and a part of a second turn, as a screw or a spiral."""
    width, turns = random_.between(0.2, 0.35), random_.between(1.08, 1.2)
    pitch, growth = random_.between(0.1, 0.7) * width, random_.between(-0.5, 0.5) * width

    def curve(s):
        angle, radius = 2 * np.pi * turns * s, 1 + growth * s
        return np.stack([radius * np.cos(angle), radius * np.sin(angle), pitch * s], -1)

    return (24 * fineness, 2 * fineness, 2 * fineness), False, (width, width), curve


def draw_eight(random_, fineness):
    """A closed tube along an eight, which passes through itself in the middle."""
    radius, share = random_.between(0.2, 0.3), random_.between(0.2, 0.8)

    def curve(s):
        u = 2 * np.pi * s
        return np.stack([1.4 * np.sin(u), 0.5 * np.sin(2 * u), share * radius * np.cos(u)], -1)

    return (30 * fineness, 2 * fineness, 2 * fineness), True, (2 * radius, 2 * radius), curve


def draw_pinch(random_, fineness):
    """A bar bent like a U too narrow, so that its arms cross."""
    return hairpin(random_, fineness, (0.25, 0.25), (24, 3, 3))


def draw_fold(random_, fineness):
    """A thick sheet folded over so far that its halves cross."""
    return hairpin(random_, fineness, (0.08, 1.0), (24, 1, 10))


def hairpin(random_, fineness, sides, cells):
    """Straight, an arc of more than half a turn, and straight."""
    angle, radius = random_.between(1.12, 1.4) * np.pi, random_.between(0.9, 1.3) * max(sides[0], 0.15)
    arm, lift = random_.between(2.2, 3.2) * radius / np.tan(angle / 2 - np.pi / 2) ** 0.5, random_.between(-0.3, 0.3)
    half = angle * radius / 2

    def curve(s):
        way = (2 * s - 1) * (half + arm)
        turn = np.clip(way, -half, half) / radius
        beyond = way - radius * turn
        return np.stack([radius * np.cos(turn) - beyond * np.sin(turn), radius * np.sin(turn) + beyond * np.cos(turn),
                         lift * sides[1] * s], -1)

    return tuple(fineness * count for count in cells), False, sides, curve


def blocks(counts, is_closed):
    """(grid points, tetrahedra): each cell cut into six around its diagonal, so that neighbours agree."""
    layers = counts[0] + (not is_closed)
    grid = np.array(list(itertools.product(range(layers), range(counts[1] + 1), range(counts[2] + 1))), float)

    def number(i, j, k):
        return ((i % layers) * (counts[1] + 1) + j) * (counts[2] + 1) + k

    tetrahedra = []
    for cell in itertools.product(*map(range, counts)):
        for order in itertools.permutations(range(3)):
            corner, corners = list(cell), [number(*cell)]
            for axis in order:
                corner[axis] += 1
                corners.append(number(*corner))
            is_even = order in ((0, 1, 2), (1, 2, 0), (2, 0, 1))
            tetrahedra.append(corners if is_even else [corners[0], corners[1], corners[3], corners[2]])
    return grid, np.array(tetrahedra)


def bent(shares, sides, curve):
    """Of points in a unit box: the first share goes along the curve, the others across it."""
    s, step = shares[:, 0], 1e-5
    along = curve(s + step) - curve(s - step)
    along /= np.linalg.norm(along, axis=1)[:, None]
    across = np.cross([0.0, 0, 1], along)
    across /= np.linalg.norm(across, axis=1)[:, None]
    up = np.cross(along, across)
    return curve(s) + sides[0] * (shares[:, 1:2] - 0.5) * across + sides[1] * (shares[:, 2:] - 0.5) * up


def from_tetrahedra(name, positions, tetrahedra):
    """The Body with the vertices of its surface first."""
    triangles = surface_of(tetrahedra)
    is_outer = np.isin(np.arange(len(positions)), triangles)
    order = np.concatenate([np.flatnonzero(is_outer), np.flatnonzero(~is_outer)])
    number = np.empty(len(order), np.uint32)
    number[order] = np.arange(len(order))
    return Body(name, positions[order], number[triangles], number[tetrahedra])


# The faces of a tetrahedron, counter-clockwise seen from outside.
FACES = np.array([(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)])


def surface_of(tetrahedra):
    faces = tetrahedra[:, FACES].reshape(-1, 3)
    _, first, count = np.unique(np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True)
    return faces[np.sort(first[count == 1])]


def volumes(positions, tetrahedra):
    a, b, c, d = (positions[tetrahedra[:, i].astype(int)] for i in range(4))
    return np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) / 6
