# SPDX-License-Identifier: MIT OR Apache-2.0
"""Closed surfaces whose volume, distance or inside is known in closed form: (positions, triangles)."""

import numpy as np

TETRAHEDRON = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]], np.uint32)


def tetrahedron(shift=0.0):
    """The corner of a cube of 1 m."""
    return np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], float) + shift, TETRAHEDRON


def box(low, high):
    corners = np.array([[x, y, z] for z in (0, 1) for y in (0, 1) for x in (0, 1)], float)
    low, high = np.asarray(low, float), np.asarray(high, float)
    sides = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    triangles = [triangle for a, b, c, d in sides for triangle in ((a, b, c), (a, c, d))]
    return low + corners * (high - low), np.array(triangles, np.uint32)


def ball(rings=40, centre=(0, 0, 0), radius=1.0):
    """By longitude and latitude, with a vertex at each pole."""
    columns = 2 * rings
    theta = np.pi * np.arange(1, rings) / rings
    phi = 2 * np.pi * np.arange(columns) / columns
    sin, cos = np.sin(theta)[:, None], np.broadcast_to(np.cos(theta)[:, None], (rings - 1, columns))
    side = np.stack([sin * np.cos(phi), sin * np.sin(phi), cos], 2)
    points = np.concatenate([[[0, 0, 1]], side.reshape(-1, 3), [[0, 0, -1]]])
    triangles, last = [], len(points) - 1
    for j in range(columns):
        k = (j + 1) % columns
        triangles.append((0, 1 + j, 1 + k))
        for i in range(rings - 2):
            a, b = 1 + i * columns + j, 1 + i * columns + k
            triangles += [(a, a + columns, b), (b, a + columns, b + columns)]
        base = 1 + (rings - 2) * columns
        triangles.append((last, base + k, base + j))
    return np.asarray(centre) + radius * points, np.array(triangles, np.uint32)


def torus(columns=60, rows=30, large=1.0, small=0.4):
    u, v = np.meshgrid(2 * np.pi * np.arange(columns) / columns, 2 * np.pi * np.arange(rows) / rows, indexing="ij")
    ring = large + small * np.cos(v)
    points = np.stack([ring * np.cos(u), ring * np.sin(u), small * np.sin(v)], 2).reshape(-1, 3)
    i, j = np.meshgrid(np.arange(columns), np.arange(rows), indexing="ij")
    a, b = i * rows + j, (i + 1) % columns * rows + j
    c, d = (i + 1) % columns * rows + (j + 1) % rows, i * rows + (j + 1) % rows
    return points, np.stack([a, b, c, a, c, d], 2).reshape(-1, 3).astype(np.uint32)


def volume(points, triangles):
    """By the divergence theorem."""
    a, b, c = (points[triangles[:, i]] for i in range(3))
    return np.einsum("ij,ij->", a, np.cross(b, c)) / 6
