# SPDX-License-Identifier: MIT OR Apache-2.0
"""One surface, and what can be asked of it."""

from __future__ import annotations

import os
import threading
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._arrays import Vectors, converted, copied, corners, pointer, show, to_read
from ._ffi import ffi
from ._header import MeshOptions, OctreeOptions
from ._library import DTYPES, NULL, answer, check, create, library, options

if TYPE_CHECKING:
    from typing_extensions import Unpack


class Mesh:
    """A triangle surface: fixed triangles, positions that may be renewed.

    positions: (n, 3), finite, in m; triangles: (m, 3), vertex numbers from 0, used where they lie if they are uint32.
    The surface must be closed, or with open=True may have a border, as a floor or a piece of cloth. Vertices that no
    triangle uses are allowed. Options: see MeshOptions. Every fault of the surface has its own Status.
    """

    def __init__(self, positions: ArrayLike, triangles: ArrayLike, **mesh_options: Unpack[MeshOptions]) -> None:
        vectors, faces = Vectors(positions, "positions"), corners(triangles)
        self._adopt(create("mesh", options("mesh", mesh_options), vectors.struct, pointer(faces), len(faces)))

    @classmethod
    def from_obj(cls, path: str | os.PathLike[str], **mesh_options: Unpack[MeshOptions]) -> Mesh:
        """Reads a Wavefront .obj file: vertices in the file's order, faces of all its objects together."""
        mesh = cls.__new__(cls)
        mesh._adopt(create("mesh", options("mesh", mesh_options), os.fsencode(path), way="create_from_obj"))
        return mesh

    def _adopt(self, handle: Any) -> None:
        self._handle, self._octree, self._is_stale, self._octree_options = handle, NULL, True, NULL
        self._lock = threading.Lock()

    def set_positions(self, positions: ArrayLike) -> None:
        """Renews the positions of all vertices: (n, 3), in m. Where that raises Error, the old ones stay."""
        vectors = Vectors(positions, "positions")
        with self._lock:
            check(library.rayc_mesh_set_positions(self._handle, vectors.struct))
            self._is_stale = True

    @property
    def vertex_count(self) -> int:
        """n, with vertices that no triangle uses."""
        return int(answer("size_t", library.rayc_mesh_vertex_count, self._handle))

    @property
    def triangle_count(self) -> int:
        """m."""
        return int(answer("size_t", library.rayc_mesh_triangle_count, self._handle))

    def positions(self) -> NDArray[np.float64]:
        """A copy of the present positions: (n, 3), in m."""
        array, struct = np.empty((self.vertex_count, 3)), ffi.new("rayc_vectors_mut *")
        show(struct, array)
        check(library.rayc_mesh_copy_positions(self._handle, struct))
        return array

    def triangles(self) -> NDArray[np.uint32]:
        """A copy of the triangles: (m, 3)."""
        array = np.empty((self.triangle_count, 3), np.uint32)
        check(library.rayc_mesh_copy_triangles(self._handle, array.size, pointer(array)))
        return array

    def closest_points(self, points: ArrayLike, bounds: ArrayLike = np.inf) -> NDArray[Any]:
        """The points of the surface, open or closed, that are nearest to `points`, (k, 3).

        bounds: how far away the surface may be to count, in m, one number or (k,); a tight one saves time. Returns (k,)
        with the fields of rayc_closest_point: triangle (NO_TRIANGLE where none is within the bound), is_found, distance
        in m, weights (barycentric), position. Fastest where each 16 points that follow one another are neighbours.
        """
        vectors = Vectors(points, "points")
        limits = converted(np.broadcast_to(bounds, len(vectors.array)), "bounds")
        surface = self.octree(), self._handle, vectors.struct, pointer(limits)
        return copied("closest_point", len(limits), library.rayc_octree_closest_points, *surface)

    def winding_numbers(self, points: ArrayLike) -> NDArray[np.int32]:
        """How often the closed surface winds around each of `points`, (k, 3): 0 outside, 1 inside, more where it folds
        over itself, negative where it is inside out. Returns (k,)."""
        vectors = Vectors(points, "points")
        numbers = np.empty(len(vectors.array), np.int32)
        surface = self.octree(), self._handle
        check(library.rayc_octree_winding_numbers(*surface, vectors.struct, pointer(numbers)))
        return numbers

    def contains(self, points: ArrayLike) -> NDArray[np.bool_]:
        """Which of `points`, (k, 3), are inside the closed surface. Returns (k,)."""
        return np.not_equal(self.winding_numbers(points), 0)

    def signed_distances(self, points: ArrayLike) -> NDArray[np.float64]:
        """How far each of `points`, (k, 3), is from the closed surface, in m, negative inside. Returns (k,)."""
        distances = self.closest_points(points)["distance"]
        return np.where(self.contains(points), -distances, distances)

    def own_exits(self) -> NDArray[Any]:
        """The vertices inside another part of the closed surface's own body, in ascending order, with their shortest ways
        out: (k,) with the fields of rayc_own_exit: vertex, triangle (NO_TRIANGLE where there is no other part), distance in
        m, weights (barycentric), position."""
        exits = np.empty(self.vertex_count, DTYPES["own_exit"])
        given = self.octree(), self._handle, len(exits), pointer(exits)
        return exits[: answer("size_t", library.rayc_octree_own_exits, *given)].copy()

    def trace_rays(self, origins: ArrayLike, directions: ArrayLike, t_max: ArrayLike = np.inf) -> NDArray[Any]:
        """Where each ray origin + t · direction, 0 ≤ t ≤ t_max, first meets the surface, from either side.

        origins, directions: (k, 3), or one for all; t_max: (k,) or one number. Returns (k,) with the fields of
        rayc_hit: triangle (NO_TRIANGLE for a miss), is_exit (1 where the ray leaves), t, weights (barycentric).
        """
        starts = to_read(np.atleast_2d(origins), "origins")
        ways = to_read(np.atleast_2d(directions), "directions")
        rays = np.empty(np.broadcast(starts, ways).shape[0], DTYPES["ray"])
        rays["origin"], rays["direction"] = starts, ways
        rays["t_max"] = converted(np.asarray(t_max), "t_max")
        surface = self.octree(), self._handle
        return copied("hit", len(rays), library.rayc_octree_trace_rays, *surface, pointer(rays), len(rays))

    def set_octree_options(self, **octree_options: Unpack[OctreeOptions]) -> None:
        """How the search tree of this mesh is built from now on: see OctreeOptions."""
        given = options("octree", octree_options)
        with self._lock:
            self._octree, self._octree_options = NULL, given

    def octree(self) -> Any:
        """The rayc_octree for the present positions, renewed when it is next needed."""
        with self._lock:
            if not self._octree:
                self._octree = create("octree", self._octree_options, self._handle)
            elif self._is_stale:
                check(library.rayc_octree_update(self._octree, self._handle))
            self._is_stale = False
            return self._octree
