# SPDX-License-Identifier: MIT OR Apache-2.0
"""Tetrahedra of the shapes that are not convex, for libraries that need them: where their build gives them."""

import itertools

import numpy as np

from . import exact, shapes

# Points from which the whole surface of a shape is seen.
CENTRES = {"star": (0, 0, 0), "cross": (0, 0, 0), "l": None}
# Rows around the core line of each tube.
TUBES = {"torus": 12, "torus_fine": 48, "helix": 8}
CELLS = ("clamp", "comb")


def fill(surface):
    """(vertices, tetrahedra). Raises ValueError where the shape has no such build."""
    if surface.name in CENTRES:
        # The inner corner of the L is seen from everywhere beside it: the middle of its corner cell sees all.
        corner = surface.positions.min(0)
        middle = [corner[0] + 1 / 6, corner[1] + 1 / 6, 0] if surface.name == "l" else CENTRES[surface.name]
        return cone(surface.positions, surface.triangles, np.array(middle, float))
    if surface.name in TUBES:
        return tube(surface, TUBES[surface.name])
    if surface.name in CELLS:
        return cells(surface)
    if surface.name == "tray":
        return cell_cones(itertools.product(*map(range, shapes.TRAY)), shapes.tray_points)
    raise ValueError(f"the benchmark has no tetrahedra of {surface.name}")


def cone(positions, triangles, middle):
    tetrahedra = [(len(positions), *triangle) for triangle in np.asarray(triangles, int)]
    return oriented(np.vstack([positions, middle]), tetrahedra)


def tube(surface, rows):
    """Each triangle around the core line with the ring's middle that it is nearest to, and wedges between."""
    is_closed = len(surface.positions) % rows == 0
    columns = len(surface.positions) // rows
    rings = surface.positions[:columns * rows].reshape(columns, rows, 3)
    vertices = np.vstack([rings.reshape(-1, 3), rings.mean(1)])
    tetrahedra = []
    for i, j in itertools.product(range(columns if is_closed else columns - 1), range(rows)):
        k, next_ = (j + 1) % rows, (i + 1) % columns
        first, second = ([columns * rows + ring, ring * rows + j, ring * rows + k] for ring in (i, next_))
        # A wedge, split by vertex number, so that neighbours agree on their common side.
        order = sorted(range(3), key=lambda corner: first[corner] + (second[corner] if is_closed else 0))
        p, q, r = ((first[corner], second[corner]) for corner in order)
        tetrahedra += [(p[0], q[0], r[0], r[1]), (p[0], q[0], q[1], r[1]), (p[0], p[1], q[1], r[1])]
    return oriented(vertices, tetrahedra)


def cells(surface):
    """Of a drawing: those cubes whose middle is inside."""
    steps = np.unique(np.round(surface.positions[:, 0], 6))
    side, low, high = np.diff(steps).min(), surface.positions.min(0), surface.positions.max(0)
    every = np.array(list(itertools.product(*map(range, np.round((high - low) / side).astype(int)))))
    is_filled = exact.classify(low + side * (every + 0.5), surface.positions, surface.triangles) > 0
    return cell_cones(every[is_filled].tolist(), lambda keys: low + side * keys)


def cell_cones(filled, place):
    """A cone from the middle of each cell to each half of its sides; place gives points by steps of cells."""
    numbers, tetrahedra = {}, []

    def vertex(key):
        return numbers.setdefault(tuple(key), len(numbers))

    for cell in filled:
        centre = vertex(x + 0.5 for x in cell)
        for axis, end in itertools.product(range(3), (0, 1)):
            corners = []
            for u, v in ((0, 0), (1, 0), (1, 1), (0, 1)):
                corner = list(cell)
                corner[axis] += end
                corner[(axis + 1) % 3] += u
                corner[(axis + 2) % 3] += v
                corners.append(vertex(corner))
            a, b, c, d = corners
            tetrahedra += [(a, b, c, centre), (a, c, d, centre)]
    return oriented(place(np.array(list(numbers), float)), tetrahedra)


def oriented(vertices, tetrahedra):
    tetrahedra = np.array(tetrahedra)
    a, b, c, d = (vertices[tetrahedra[:, i]] for i in range(4))
    volumes = np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a)
    tetrahedra = tetrahedra[np.abs(volumes) > 1e-12]
    flip = volumes[np.abs(volumes) > 1e-12] < 0
    tetrahedra[flip] = tetrahedra[flip][:, [0, 1, 3, 2]]
    return vertices, tetrahedra
