# SPDX-License-Identifier: MIT OR Apache-2.0
"""The shapes: closed, outward, manifold; their size is about 1. Written to files by files.py."""

import itertools

import numpy as np

CONVEX = ("box", "tetrahedron", "plate", "bar", "ball", "ball_fine", "ball_small", "box_small", "tetrahedron_small",
          "slab")


def make(name):
    """(positions, triangles) of one of NAMES."""
    positions, triangles = SHAPES[name]()
    # Nine digits: the file is the same on every machine.
    return np.round(np.asarray(positions, float), 9) + 0.0, np.asarray(triangles, np.uint32)


def block(x, y, z):
    positions, triangles = cells([(0, 0, 0)])
    return (positions - 0.5) * [x, y, z], triangles


def cells(filled):
    """The boundary of a union of unit cubes."""
    filled, number, triangles = set(filled), {}, []
    for cell, axis, side in itertools.product(sorted(filled), range(3), (0, 1)):
        beside = list(cell)
        beside[axis] += 2 * side - 1
        if tuple(beside) in filled:
            continue
        corners = []
        for u, v in ((0, 0), (1, 0), (1, 1), (0, 1)):
            corner = list(cell)
            corner[axis] += side
            corner[(axis + 1) % 3] += u
            corner[(axis + 2) % 3] += v
            corners.append(number.setdefault(tuple(corner), len(number)))
        a, b, c, d = corners if side else corners[::-1]
        triangles += [(a, b, c), (a, c, d)]
    return np.array(list(number), float), np.array(triangles)


def drawn(text, thickness):
    """Cells where the rows of a drawing have an x, so many thick; centred, the longer side 1."""
    rows = text.split()
    filled = [(i, j, k) for j, row in enumerate(reversed(rows)) for i, mark in enumerate(row) if mark == "x"
              for k in range(thickness)]
    positions, triangles = cells(filled)
    low, high = positions.min(0), positions.max(0)
    return (positions - (low + high) / 2) / (high - low).max(), triangles


def tetrahedron(size=1.0):
    corners = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]], float) * size / 2
    return corners, [(0, 1, 2), (0, 3, 1), (0, 2, 3), (1, 3, 2)]


def icosahedron():
    g = (1 + 5**0.5) / 2
    corners = [(-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g), (0, -1, -g), (0, 1, -g),
               (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1)]
    triangles = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2),
                 (10, 7, 6), (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11),
                 (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    return np.array(corners) / np.linalg.norm(corners[0]), triangles


def ball(halvings, radius=0.5):
    positions, triangles = icosahedron()
    positions = [np.array(p) for p in positions]
    for _ in range(halvings):
        middles, finer = {}, []

        def middle(a, b):
            key = (min(a, b), max(a, b))
            if key not in middles:
                middles[key] = len(positions)
                point = positions[a] + positions[b]
                positions.append(point / np.linalg.norm(point))
            return middles[key]

        for a, b, c in triangles:
            ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
            finer += [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        triangles = finer
    return radius * np.array(positions), triangles


def star():
    """A spike on each face of an icosahedron."""
    positions, faces = icosahedron()
    points, triangles = list(0.22 * positions), []
    for a, b, c in faces:
        out = positions[a] + positions[b] + positions[c]
        triangles += [(a, b, len(points)), (b, c, len(points)), (c, a, len(points))]
        points.append(0.5 * out / np.linalg.norm(out))
    return np.array(points), triangles


def torus(columns, rows, large=0.36, small=0.14):
    points, triangles = [], []
    for i, j in itertools.product(range(columns), range(rows)):
        u, v = 2 * np.pi * i / columns, 2 * np.pi * j / rows
        ring = large + small * np.cos(v)
        points.append((ring * np.cos(u), ring * np.sin(u), small * np.sin(v)))
        a, b = i * rows + j, (i + 1) % columns * rows + j
        c, d = (i + 1) % columns * rows + (j + 1) % rows, i * rows + (j + 1) % rows
        triangles += [(a, b, c), (a, c, d)]
    return np.array(points), triangles


def helix(columns=56, rows=8, turns=2.5, large=0.4, small=0.09):
    """A tube along a screw line, closed at both ends."""
    u = 2 * np.pi * turns * np.arange(columns + 1) / columns
    pitch = 0.28 / (2 * np.pi)
    core = np.stack([large * np.cos(u), large * np.sin(u), pitch * (u - u[-1] / 2)], 1)
    along = np.stack([-large * np.sin(u), large * np.cos(u), np.full_like(u, pitch)], 1)
    along /= np.linalg.norm(along, axis=1)[:, None]
    out = np.stack([np.cos(u), np.sin(u), np.zeros_like(u)], 1)
    up = np.cross(along, out)
    v = 2 * np.pi * np.arange(rows) / rows
    rings = core[:, None] + small * (np.cos(v)[:, None] * out[:, None] - np.sin(v)[:, None] * up[:, None])
    points, triangles = [*rings.reshape(-1, 3), core[0], core[-1]], []
    for j in range(rows):
        k = (j + 1) % rows
        for i in range(columns):
            a, b, c, d = i * rows + j, (i + 1) * rows + j, (i + 1) * rows + k, i * rows + k
            triangles += [(a, b, c), (a, c, d)]
        first, last = (columns + 1) * rows, (columns + 1) * rows + 1
        triangles += [(first, j, k), (last, columns * rows + k, columns * rows + j)]
    return np.array(points), triangles


def bowl(rings=6, columns=16, radius=0.5, inner=0.82):
    """Half of a hollow ball."""
    points, triangles, number = [], [], {}
    for side, r in enumerate((radius, inner * radius)):
        for i in range(rings + 1):
            tilt = np.pi / 2 * i / rings
            for j in range(columns if i else 1):
                number[side, i, j] = len(points)
                turn = 2 * np.pi * j / columns
                points.append((r * np.sin(tilt) * np.cos(turn), r * np.sin(tilt) * np.sin(turn), -r * np.cos(tilt)))
    for j in range(columns):
        k = (j + 1) % columns
        for side in (0, 1):
            def corner(i, j, side=side):
                return number[side, i, j if i else 0]

            for i in range(rings):
                for triangle in ([(corner(i, j), corner(i + 1, k), corner(i + 1, j))]
                                 + ([(corner(i, j), corner(i, k), corner(i + 1, k))] if i else [])):
                    triangles.append(triangle[::-1] if side else triangle)
        a, b, c, d = (number[0, rings, j], number[0, rings, k], number[1, rings, k], number[1, rings, j])
        triangles += [(a, b, c), (a, c, d)]
    return np.array(points) + [0, 0, 0.3], triangles


# Cells along each side of the tray.
TRAY = (24, 24, 2)


def tray_points(steps):
    """Where so many steps of cells lead: in a block 3 × 3 × 1 whose top has bumps of 0.08, four along each side."""
    x, y, z = (np.asarray(steps, float) / TRAY).T
    bumps = 0.08 * np.cos(8 * np.pi * x) * np.cos(8 * np.pi * y)
    return np.stack([3 * x - 1.5, 3 * y - 1.5, z * (1 + bumps) - 0.5], axis=-1)


def tray():
    corners, triangles = cells(itertools.product(*map(range, TRAY)))
    return tray_points(corners), triangles


SHAPES = {
    "box": lambda: block(1, 0.8, 0.7),
    "tetrahedron": tetrahedron,
    "plate": lambda: block(1, 1, 0.05),
    "bar": lambda: block(1.4, 0.25, 0.25),
    "ball": lambda: ball(2),
    "star": star,
    "torus": lambda: torus(24, 12),
    "cross": lambda: drawn(".x. xxx .x.", 1),
    "l": lambda: drawn("x.. x.. xxx", 1),
    "clamp": lambda: drawn("xxxx x... x... xxxx", 2),
    "comb": lambda: drawn("x.x.x.x x.x.x.x x.x.x.x xxxxxxx", 2),
    "bowl": bowl,
    "helix": helix,
    "ball_small": lambda: ball(1, 0.06),
    "box_small": lambda: block(0.12, 0.1, 0.08),
    "tetrahedron_small": lambda: tetrahedron(0.12),
    "ball_fine": lambda: ball(4),
    "torus_fine": lambda: torus(96, 48),
    "slab": lambda: block(3, 3, 1),
    "tray": tray,
}
BODIES = tuple(SHAPES)[:13]
SMALL = tuple(name for name in SHAPES if name.endswith("_small"))
FINE = tuple(name for name in SHAPES if name.endswith("_fine"))
GROUNDS = ("slab", "tray")
