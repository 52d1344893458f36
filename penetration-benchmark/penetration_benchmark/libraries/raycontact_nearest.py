# SPDX-License-Identifier: MIT OR Apache-2.0
import numpy as np
import raycontact

from ..library import EXIT
from .raycontact_library import Raycontact

# How far under the surface winding numbers are asked for, in the body's size.
UNDER = 1e-6


class RaycontactNearest(Raycontact):
    name = "raycontact, nearest points"
    settings = "winding numbers tell what is inside; closest points of the surface without the part around each"
    documentation = "docs/options.md"
    tasks = ("self",)

    def load_body(self, body):
        self.triangles, self.count = body.triangles.astype(np.intp), body.triangles.max() + 1
        self.mesh = raycontact.Mesh(body.positions[:self.count], body.triangles)
        # The triangles around each vertex, one vertex after another.
        order = np.argsort(self.triangles.ravel(), kind="stable")
        self.around = order // 3
        self.starts = np.searchsorted(self.triangles.ravel()[order], np.arange(self.count))

    def exits(self, positions):
        positions = positions[:self.count]
        a, b, c = (positions[corner] for corner in self.triangles.T)
        normals = np.add.reduceat(np.cross(b - a, c - a)[self.around], self.starts)
        normals *= (UNDER / np.sqrt(np.einsum("ij,ij->i", normals, normals)))[:, None]
        self.mesh.set_positions(positions)
        # Once is the vertex's own part.
        is_inside = self.mesh.winding_numbers(positions - normals) > 1
        exits = np.zeros(is_inside.sum(), EXIT)
        if not len(exits):
            return exits
        inner = self.triangles[is_inside[self.triangles].any(1)]
        hops, edges = depth_of(is_inside, inner), positions[inner] - positions[inner[:, [1, 2, 0]]]
        # A way along the surface to where it comes out is never shorter than the shortest.
        reach = hops * np.sqrt(np.einsum("ijk,ijk->ij", edges, edges).max())
        low, high = np.minimum(np.minimum(a, b), c) - reach, np.maximum(np.maximum(a, b), c) + reach
        found = [(patch, self.nearest(positions, patch, low, high, hops)) for patch in patches(is_inside, inner)]
        exits["vertex"], exits["point"] = map(np.concatenate, zip(*found))
        return exits

    def nearest(self, positions, patch, low, high, hops):
        """The nearest points of the surface to a patch that are not on the surface around it: what lies within twice
        as many edges as the patch is wide counts as its own part."""
        is_near = ((low <= positions[patch].max(0)) & (high >= positions[patch].min(0))).all(1)
        near, own = self.triangles[is_near], np.zeros(self.count, bool)
        own[patch] = True
        for _ in range(2 * hops + 1):
            own[near[own[near].any(1)]] = True
        others, is_used = near[~own[near].any(1)], np.zeros(self.count, bool)
        is_used[others] = True
        numbers = np.cumsum(is_used) - 1
        surface = raycontact.Mesh(positions[is_used], numbers[others], open=True)
        return surface.closest_points(positions[patch])["position"]


def depth_of(is_inside, inner):
    """How many edges it is from the vertices inside to one that is not, at most."""
    left, hops = is_inside.copy(), 0
    while left.any():
        left[inner[~left[inner].all(1)]] = False
        hops += 1
    return hops


def patches(is_inside, inner):
    """The vertices inside, by connected part of the surface."""
    inside, number = np.flatnonzero(is_inside), np.cumsum(is_inside) - 1
    edges = inner[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    edges = number[edges[is_inside[edges].all(1)]]
    labels = np.arange(len(inside))
    while True:
        lower = labels.copy()
        np.minimum.at(lower, edges, labels[edges].min(1)[:, None])
        lower = lower[lower]
        if (lower == labels).all():
            return [inside[labels == label] for label in np.unique(labels)]
        labels = lower
