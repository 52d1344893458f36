# SPDX-License-Identifier: MIT OR Apache-2.0
"""The judge of self-contact: the shortest way out of a body of tetrahedra, by a growing ball.

A ball grows around a point of one tetrahedron. When it reaches a face, it goes on into the neighbour there, and nowhere
else: parts of the body that lie in the same place, but are not reached this way, do not count. The first face of the
surface that it reaches has the nearest way out. No rays and no search tree, so it shares nothing with what it judges.
"""

import heapq

import numpy as np

from .bodies import FACES
from .exact import side_of_plane

# Ways out that are longer than the shortest by no more than this part of it are as good.
MARGIN = 0.01
# Of the body's size, which is 1: how far from the surface an exit may be said to lie by rounding.
ROUNDING = 1e-5


class Judge:
    def __init__(self, body):
        self.positions, self.tetrahedra = body.positions, body.tetrahedra.astype(int)
        self.outer_count = body.triangles.max() + 1
        corners = self.tetrahedra[:, FACES].reshape(-1, 3)
        _, first, self.face_of = np.unique(np.sort(corners, axis=1), axis=0, return_index=True, return_inverse=True)
        self.face_of = self.face_of.reshape(-1, 4)
        self.corners = self.positions[corners[first]]
        self.low, self.high = self.corners.min(1), self.corners.max(1)
        self.beside = [[] for _ in first]
        for tetrahedron, faces in enumerate(self.face_of):
            for face in faces:
                self.beside[face].append(tetrahedron)

    def holders(self):
        """Of each vertex of the surface: the tetrahedra elsewhere in the body that it lies in; None where it lies on a
        face of one, which rounding may decide either way."""
        corners = self.positions[self.tetrahedra]
        order = np.argsort(corners[:, :, 0].min(1))
        low, high = corners[order].min(1), corners[order].max(1)
        widest, found = (high - low)[:, 0].max(), []
        for vertex, point in enumerate(self.positions[:self.outer_count]):
            first, last = np.searchsorted(low[:, 0], [point[0] - widest, point[0]], "right")
            near = order[first:last][((low[first:last] <= point) & (high[first:last] >= point)).all(1)]
            near = near[(self.tetrahedra[near] != vertex).all(1)]
            sides = self.sides(near, point)
            inside = near[(sides >= 0).all(1)]
            found.append(None if (sides[(sides >= 0).all(1)] == 0).any() else inside.tolist())
        return found

    def sides(self, tetrahedra, point):
        """1 on the inner side of each face, 0 on it, −1 outside."""
        a, b, c = self.positions[self.tetrahedra[tetrahedra][:, FACES].reshape(-1, 3)].transpose(1, 0, 2)
        return -side_of_plane(a, b, c, np.broadcast_to(point, a.shape)).reshape(-1, 4)

    def ways_out(self, point, tetrahedron):
        """(length, faces): of the shortest way out, and the faces of the surface with ways as good."""
        reach = 0.05
        while True:
            near = np.flatnonzero(((self.low <= point + reach) & (self.high >= point - reach)).all(1))
            distances = dict(zip(near.tolist(), np.linalg.norm(
                nearest_points(point, self.corners[near]) - point, axis=1).tolist()))
            found = self.grow(tetrahedron, distances, reach)
            if found:
                return found
            reach *= 2

    def grow(self, tetrahedron, distances, reach):
        """None where the ball must grow beyond the reach of what is known."""
        entered, waiting, length, faces = {tetrahedron}, [], np.inf, []

        def enter(tetrahedron):
            for face in self.face_of[tetrahedron].tolist():
                heapq.heappush(waiting, (distances.get(face, np.inf), face))

        enter(tetrahedron)
        while waiting:
            distance, face = heapq.heappop(waiting)
            if distance > (1 + MARGIN) * length:
                return length, faces
            if distance > reach:
                return None
            if len(self.beside[face]) == 1:
                length = min(length, distance)
                faces.append(face)
            for other in self.beside[face]:
                if other not in entered:
                    entered.add(other)
                    enter(other)
        return length, faces

    def is_as_short(self, point, exit_point, way_out):
        """Whether an exit lies on one of those faces, and its way is no longer than the margin lets it be."""
        length, faces = way_out
        gaps = np.linalg.norm(nearest_points(exit_point, self.corners[faces]) - exit_point, axis=1)
        return bool(gaps.min() <= ROUNDING
                    and np.linalg.norm(exit_point - point) <= (1 + MARGIN) * length + ROUNDING)


def nearest_points(point, corners):
    """Of each triangle, (n, 3, 3)."""
    a, b, c = corners.transpose(1, 0, 2)
    best = [nearest_on_edges(point, p, q) for p, q in ((a, b), (b, c), (c, a))]
    normal = np.cross(b - a, c - a)
    square = np.maximum(np.einsum("ij,ij->i", normal, normal), 1e-300)
    foot = point - normal * (np.einsum("ij,ij->i", point - a, normal) / square)[:, None]
    weights = np.stack([np.einsum("ij,ij->i", np.cross(q - p, foot - p), normal) for p, q in ((a, b), (b, c), (c, a))])
    is_above = (weights >= 0).all(0)
    lengths = np.stack([np.where(is_above, np.linalg.norm(foot - point, axis=1), np.inf),
                        *(np.linalg.norm(p - point, axis=1) for p in best)])
    return np.stack([foot, *best])[lengths.argmin(0), np.arange(len(corners))]


def nearest_on_edges(point, p, q):
    along = q - p
    share = np.einsum("ij,ij->i", point - p, along) / np.einsum("ij,ij->i", along, along)
    return p + np.clip(share, 0, 1)[:, None] * along
