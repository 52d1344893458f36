# SPDX-License-Identifier: MIT OR Apache-2.0
"""Tetrahedral meshes of the shapes on which the distance to the surface is linear in every tetrahedron.

Each tetrahedron lies on one side of the medial axis, so interpolating the distance from its corners is exact. The one
exception: about a reflex edge (in l, channel and hole) the distance is that to the edge, a cone of circles; there it is
linear in each of `sectors` equal angles and at most 1 / cos(angle / 2) times the true one, 1.0012 with 16.

A prism's distance is the lesser of the profile's in the plane and that to its two ends. So the profile is cut in two
dimensions into convex cells on which its distance is linear and entirely below or entirely above half the height, and
over each triangle of it stand three layers: nearest to the lower end, nearest to a side, nearest to the upper end.
"""
import collections
import itertools
import math

import numpy

from shapes.make import PRISMS, SHAPES

NEAR = 1e-9

# distance: of each vertex to the surface
Mesh = collections.namedtuple("Mesh", "vertices tetrahedra distance")


class Linear:
    """The function normal . p + offset in the plane."""

    def __init__(self, normal, through):
        self.normal = numpy.asarray(normal, float)
        self.offset = -self.normal @ numpy.asarray(through, float)

    def __call__(self, points):
        return numpy.asarray(points) @ self.normal + self.offset

    def minus(self, other):
        result = Linear(self.normal - other.normal, (0, 0))
        result.offset = self.offset - other.offset
        return result


def clip(polygon, function):
    """The part of a convex polygon where the function is at least zero."""
    values = [float(function(p)) for p in polygon]
    values = [0.0 if abs(v) < NEAR else v for v in values]
    result = []
    for i, (p, v) in enumerate(zip(polygon, values)):
        q, w = polygon[i - 1], values[i - 1]
        if v * w < 0:
            result.append(q + (p - q) * (w / (w - v)))
        if v >= 0:
            result.append(p)
    return result if area(result) > NEAR * NEAR and max(values) > 0 else None


def cut(polygons, function):
    negative = Linear(-function.normal, (0, 0))
    negative.offset = -function.offset
    return [part for p in polygons for part in (clip(p, function), clip(p, negative)) if part]


def area(polygon):
    if len(polygon) < 3:
        return 0.0
    x, y = numpy.array(polygon).T
    return 0.5 * float(x @ numpy.roll(y, -1) - y @ numpy.roll(x, -1))


class Side:
    """An edge of the profile, valid between the perpendiculars at its ends."""

    def __init__(self, start, end):
        self.start, self.end = numpy.array(start), numpy.array(end)
        self.along = (self.end - self.start) / numpy.linalg.norm(self.end - self.start)
        self.distance = Linear((-self.along[1], self.along[0]), start)

    def limits(self):
        return [Linear(self.along, self.start), Linear(-self.along, self.end)]

    def cuts(self):
        return self.limits() + [self.distance]

    def is_valid(self, p):
        return self.distance(p) > -NEAR and all(limit(p) > -NEAR for limit in self.limits())


class Sector:
    """The part of the profile nearest to a reflex corner, between two directions from it."""

    def __init__(self, corner, first, second):
        self.corner = numpy.array(corner)
        self.limits = [Linear((-first[1], first[0]), corner), Linear((second[1], -second[0]), corner)]
        self.distance = Linear(numpy.linalg.solve([first, second], [1, 1]), corner)

    def is_valid(self, p):
        return all(limit(p) > -NEAR for limit in self.limits)


def sectors_of(corner, before, after, count):
    """before, after: the inward normals of the sides that meet in the reflex corner, in order."""
    start, end = (math.atan2(n[1], n[0]) for n in (after, before))
    angle = (end - start) % (2 * math.pi)
    if angle > math.pi:
        start, angle = end, 2 * math.pi - angle
    directions = [(math.cos(start + angle * i / count), math.sin(start + angle * i / count)) for i in range(count + 1)]
    return [Sector(corner, *map(numpy.array, pair)) for pair in itertools.pairwise(directions)]


def cells_of_profile(loops, cap, half_height, sectors):
    """Convex polygons on which the profile's distance is linear and below or above half the height."""
    sides, zones = [], []
    for loop in loops:
        here = [Side(loop[i], loop[(i + 1) % len(loop)]) for i in range(len(loop))]
        sides += here
        for before, after in zip(here[-1:] + here[:-1], here):
            if before.along[0] * after.along[1] - before.along[1] * after.along[0] < 0:
                zones.append(sectors_of(after.start, before.distance.normal, after.distance.normal, sectors))
    points = [numpy.array(p) for loop in loops for p in loop]
    if not zones:
        pieces = [points]
    else:
        pieces = [[points[i] for i in triangle] for triangle in cap]
        for side in sides:
            for line in side.cuts():
                pieces = cut(pieces, line)
    for zone in zones:
        for sector in zone:
            uncut, inside = [], []
            for piece in pieces:
                middle = numpy.mean(piece, axis=0)
                (inside if any(s.is_valid(middle) for s in zone) else uncut).append(piece)
            pieces = uncut + cut(cut(inside, sector.limits[0]), sector.limits[1])
    cells = []
    for piece in pieces:
        middle = numpy.mean(piece, axis=0)
        sites = [s for s in sides if not zones or s.is_valid(middle)]
        sites += [s for zone in zones for s in zone if s.is_valid(middle)]
        for site in sites:
            cell = piece
            for other in sites:
                cell = cell and (cell if other is site else clip(cell, other.distance.minus(site.distance)))
            if cell:
                level = Linear(site.distance.normal, (0, 0))
                level.offset = site.distance.offset - half_height
                cells += cut([cell], level)
    return cells, sides


def triangulated(cells):
    """Vertices and conforming triangles of polygons whose corners may lie on one another's edges."""
    vertices = numpy.zeros((0, 2))

    def index(p):
        nonlocal vertices
        found = numpy.flatnonzero(((vertices - p) ** 2).sum(1) < (10 * NEAR) ** 2)
        if len(found):
            return int(found[0])
        vertices = numpy.vstack([vertices, p])
        return len(vertices) - 1

    polygons = []
    for cell in cells:
        polygon = [index(p) for p in cell]
        polygon = [v for i, v in enumerate(polygon) if v != polygon[i - 1]]
        if len(polygon) >= 3 and area([vertices[v] for v in polygon]) > NEAR:
            polygons.append(polygon)
    triangles = []
    corners = vertices.copy()
    for polygon in polygons:
        outline = []
        for start, end in zip(polygon, polygon[1:] + polygon[:1]):
            a, along = corners[start], corners[end] - corners[start]
            length = numpy.linalg.norm(along)
            at = (corners - a) @ along / length
            off = numpy.abs((corners - a) @ numpy.array([-along[1], along[0]]) / length)
            between = numpy.flatnonzero((off < 20 * NEAR) & (at > 20 * NEAR) & (at < length - 20 * NEAR))
            outline += [start] + sorted(map(int, between), key=lambda v: at[v])
        if len(outline) == 3:
            triangles.append(tuple(outline))
        else:
            middle = index(numpy.mean([vertices[v] for v in outline], axis=0))
            triangles += [(a, b, middle) for a, b in zip(outline, outline[1:] + outline[:1])]
    return vertices, triangles


def distance_to_sides(points, sides):
    result = numpy.full(len(points), math.inf)
    for side in sides:
        length = numpy.linalg.norm(side.end - side.start)
        at = numpy.clip((points - side.start) @ side.along, 0, length)
        result = numpy.minimum(result, numpy.linalg.norm(points - side.start - at[:, None] * side.along, axis=1))
    return result


def signed_volumes(vertices, tetrahedra):
    a, b, c, d = (vertices[tetrahedra[:, i]] for i in range(4))
    return numpy.einsum("ij,ij->i", numpy.cross(b - a, c - a), d - a) / 6


def oriented(vertices, tetrahedra):
    vertices, tetrahedra = numpy.array(vertices), numpy.array(tetrahedra)
    flip = signed_volumes(vertices, tetrahedra) < 0
    tetrahedra[flip] = tetrahedra[flip][:, [0, 1, 3, 2]]
    return vertices, tetrahedra


def prism(loops, cap, height, sectors):
    half = height / 2
    cells, sides = cells_of_profile(loops, cap, half, sectors)
    points, triangles = triangulated(cells)
    inner = numpy.minimum(distance_to_sides(points, sides), half)
    inner[inner < 10 * NEAR] = 0.0
    inner[half - inner < 10 * NEAR] = half
    vertices, distance, numbers = [], [], {}

    def node(i, z):
        if (i, z) not in numbers:
            numbers[i, z] = len(vertices)
            vertices.append((*points[i], z))
            distance.append(min(inner[i], half - abs(z)))
        return numbers[i, z]

    # Split by vertex number, so that neighbours agree on the diagonal of the quadrilateral they share.
    columns = [[node(i, z) for z in (-half, -half + c, half - c, half)] for i, c in enumerate(inner)]
    tetrahedra = []
    for triangle in triangles:
        p, q, r = (columns[i] for i in sorted(triangle))
        for low, high in ((0, 1), (1, 2), (2, 3)):
            for tetrahedron in (
                (p[low], q[low], r[low], r[high]),
                (p[low], q[low], q[high], r[high]),
                (p[low], p[high], q[high], r[high]),
            ):
                if len(set(tetrahedron)) == 4:
                    tetrahedra.append(tetrahedron)
    return Mesh(*oriented(vertices, tetrahedra), numpy.array(distance))


def cone():
    """All faces touch one ball: the medial axis is made of the segments from its centre to all edges."""
    vertices, triangles = SHAPES["cone"]
    apothem = 0.5 * math.cos(math.pi / 32)
    sine = apothem / math.hypot(apothem, 1)
    z = 0.5 * (sine - 1) / (1 + sine)
    tetrahedra = [(len(vertices), *t) for t in triangles]
    return Mesh(*oriented(vertices + [(0.0, 0.0, z)], tetrahedra), numpy.array([0.0] * len(vertices) + [z + 0.5]))


def make(name, sectors=16):
    return cone() if name == "cone" else prism(*PRISMS[name], sectors)


def nearest_on_surface(points, triangles):
    """By trying each triangle: triangles is an array of three corners each."""
    best, nearest = numpy.full(len(points), math.inf), numpy.zeros((len(points), 3))

    def take(candidates, where):
        distance = numpy.where(where, numpy.linalg.norm(points - candidates, axis=1), math.inf)
        closer = distance < best
        best[closer], nearest[closer] = distance[closer], candidates[closer]

    for a, b, c in triangles:
        normal = numpy.cross(b - a, c - a)
        normal = normal / numpy.linalg.norm(normal)
        inside = numpy.ones(len(points), bool)
        for p, q in ((a, b), (b, c), (c, a)):
            inside &= (points - p) @ numpy.cross(normal, q - p) >= 0
            at = numpy.clip((points - p) @ (q - p) / ((q - p) @ (q - p)), 0, 1)
            take(p + at[:, None] * (q - p), True)
        take(points - ((points - a) @ normal)[:, None] * normal, inside)
    return best, nearest


def check(name, mesh):
    """Holds volume, surface and conformity against the .obj; returns the largest relative error of the distance."""
    vertices, triangles = SHAPES[name]
    corners = numpy.array(vertices)[numpy.array(triangles)]
    volumes = signed_volumes(mesh.vertices, mesh.tetrahedra)
    a, b, c = corners[:, 0], corners[:, 1], corners[:, 2]
    assert abs(volumes.sum() - numpy.einsum("ij,ij", a, numpy.cross(b, c)) / 6) < 1e-8, name
    assert volumes.min() > 0, name
    corners_of_faces = ([0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3])
    faces = collections.Counter(tuple(sorted(t[f])) for t in mesh.tetrahedra for f in corners_of_faces)
    assert max(faces.values()) == 2, name
    outer = numpy.array([f for f, count in faces.items() if count == 1])
    assert mesh.distance[outer].max() == 0.0, name
    p, q, r = (mesh.vertices[outer[:, i]] for i in range(3))
    surface = numpy.linalg.norm(numpy.cross(q - p, r - p), axis=1).sum()
    assert abs(surface - numpy.linalg.norm(numpy.cross(b - a, c - a), axis=1).sum()) < 1e-6, name
    generator = numpy.random.default_rng(1)
    chosen = generator.choice(len(volumes), 20000, p=volumes / volumes.sum())
    weights = generator.dirichlet(numpy.ones(4), 20000)
    corner = mesh.tetrahedra[chosen]
    points = numpy.einsum("ij,ijk->ik", weights, mesh.vertices[corner])
    exact, _ = nearest_on_surface(points, corners)
    return float(numpy.max(numpy.abs((weights * mesh.distance[corner]).sum(1) / exact - 1)))


if __name__ == "__main__":
    for name in SHAPES:
        for sectors in (16, 32) if name in ("l", "channel", "hole") else (16,):
            mesh = make(name, sectors)
            print(f"{name}, {sectors} sectors: {len(mesh.tetrahedra)} tetrahedra, largest distance "
                  f"{mesh.distance.max():.9g}, error of the distance {check(name, mesh):.2g}", flush=True)
