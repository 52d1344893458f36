# SPDX-License-Identifier: MIT OR Apache-2.0
"""One surface, and what can be asked of it."""

from __future__ import annotations

import functools
import os
import threading
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._header import MeshOptions, OctreeOptions
from ._library import NULL, Array, Doubles, Unpack, answer, call, copied, create, dtype_of, ffi, indices, library
from ._library import numbers, options, rows, to_read


class Mesh:
    """A triangle surface: fixed triangles, positions that may be renewed.

    positions: (n, 3), finite, in m; triangles: (m, 3), vertex numbers from 0, used where they lie if they are uint32; a
    vertex may have none. Questions about k `points`, (k, 3), have (k,) answers; structured ones are C's structs."""

    def __init__(self, positions: Array, triangles: Array, **mesh_options: Unpack[MeshOptions]) -> None:
        x, faces = to_read(positions, "positions"), indices(rows(triangles, "triangles", "m"), "triangles")
        self._adopt(create("mesh", options("mesh", mesh_options), [x], faces, len(faces)), mesh_options)

    @classmethod
    def from_file(cls, path: str | os.PathLike[str], **mesh_options: Unpack[MeshOptions]) -> Mesh:
        """Reads a Wavefront .obj file: vertices in the file's order, faces of all its objects together."""
        mesh, name = cls.__new__(cls), os.fsencode(path)
        if b"\0" in name:  # where C would end it
            raise ValueError(f"path is {path!r}; give one without a null character")
        mesh._adopt(create("mesh", options("mesh", mesh_options), name, way="create_from_obj"), mesh_options)
        return mesh

    @classmethod
    def from_trimesh(cls, surface: Any, **mesh_options: Unpack[MeshOptions]) -> Mesh:
        """Takes anything that has `vertices` and `faces`, such as a trimesh.Trimesh."""
        return cls(surface.vertices, surface.faces, **mesh_options)

    def _adopt(self, handle: Any, mesh_options: MeshOptions) -> None:
        self._handle, self._octree, self._is_stale, self._octree_options = handle, NULL, True, NULL
        self._mesh_options, self._lock = mesh_options, threading.Lock()

    def __repr__(self) -> str:
        return f"Mesh({self.vertex_count} vertices, {self.triangle_count} triangles)"

    def __reduce__(self) -> tuple[Any, ...]:
        """Copies and pickles are new meshes of the present positions and the same options; those of the tree are not kept."""
        return functools.partial(Mesh, **self._mesh_options), (self.vertices, self.faces)

    def set_positions(self, positions: Array) -> None:
        """Renews the positions of all vertices: (n, 3), in m. Where that raises Error, the old ones stay."""
        with self._lock:
            call(library.rayc_mesh_set_positions, self._handle, [to_read(positions, "positions")])
            self._is_stale = True

    @property
    def vertex_count(self) -> int:
        """n, with vertices that no triangle uses."""
        return int(answer(library.rayc_mesh_vertex_count, self._handle))

    @property
    def triangle_count(self) -> int:
        """m."""
        return int(answer(library.rayc_mesh_triangle_count, self._handle))

    @property
    def vertices(self) -> Doubles:
        """The present positions: (n, 3), in m. A copy for each use, to be read alone: set_positions() renews them."""
        found = np.empty((self.vertex_count, 3))
        call(library.rayc_mesh_copy_positions, self._handle, [found])
        found.flags.writeable = False
        return found

    @property
    def faces(self) -> NDArray[np.uint32]:
        """The triangles: (m, 3). A copy for each use, to be read alone."""
        all = copied(library.rayc_mesh_copy_triangles, (self.triangle_count, 3), self._handle, 3 * self.triangle_count)
        all.flags.writeable = False
        return all

    @property
    def holes(self) -> NDArray[Any]:
        """What close_holes closed: first_triangle and triangle_count of each cap in faces, area_share of its part."""
        return copied(library.rayc_mesh_copy_holes, n := answer(library.rayc_mesh_hole_count, h := self._handle), h, n)

    def closest_points(self, points: Array, bounds: Array = np.inf) -> NDArray[Any]:
        """The surface's points nearest to `points`: triangle (NO_TRIANGLE for none), is_found, distance in m, barycentric
        weights, position. bounds: how far away in m, one or (k,); tight ones save time."""
        asked = to_read(points, "points")
        limits = numbers(np.broadcast_to(bounds, len(asked)), "bounds")
        return copied(library.rayc_octree_closest_points, len(asked), self.octree(), self._handle, [asked], limits)

    def winding_numbers(self, points: Array) -> NDArray[np.int32]:
        """How often the closed surface winds around each of `points`: 0 outside, 1 inside, other numbers in folds."""
        asked = to_read(points, "points")
        return copied(library.rayc_octree_winding_numbers, len(asked), self.octree(), self._handle, [asked])

    def contains(self, points: Array) -> NDArray[np.bool_]:
        """Which of `points` are inside the closed surface."""
        return np.not_equal(self.winding_numbers(points), 0)

    def signed_distances(self, points: Array) -> Doubles:
        """How far each of `points` is from the closed surface, in m, negative inside."""
        return np.where(self.contains(points), -(d := self.closest_points(points)["distance"]), d)

    def own_exits(self) -> NDArray[Any]:
        """The vertices inside another part of the closed surface's own body, in ascending order, and their shortest
        ways out: vertex, triangle (NO_TRIANGLE where there is no other part), distance in m, weights, position."""
        exits = np.empty(self.vertex_count, dtype_of(ffi.typeof("rayc_own_exit")))
        return exits[: answer(library.rayc_octree_own_exits, self.octree(), self._handle, len(exits), exits)].copy()

    def trace_rays(self, origins: Array, directions: Array, t_max: Array = np.inf) -> NDArray[Any]:
        """Where each ray origin + t · direction, 0 ≤ t ≤ t_max, first meets the surface, from either side: triangle
        (NO_TRIANGLE for a miss), is_exit (1 where the ray leaves), t, weights (barycentric). Any may be one for all."""
        starts, ways = to_read(np.atleast_2d(origins), "origins"), to_read(np.atleast_2d(directions), "directions")
        rays = np.empty(np.broadcast(starts, ways).shape[0], dtype_of(ffi.typeof("rayc_ray")))
        rays["origin"], rays["direction"], rays["t_max"] = starts, ways, numbers(t_max, "t_max")
        return copied(library.rayc_octree_trace_rays, len(rays), self.octree(), self._handle, rays, len(rays))

    def set_octree_options(self, **octree_options: Unpack[OctreeOptions]) -> None:
        """How the search tree of this mesh is built from now on: see OctreeOptions."""
        with self._lock:
            self._octree, self._octree_options = NULL, options("octree", octree_options)

    def octree(self) -> Any:
        """The rayc_octree for the present positions, renewed when it is next needed."""
        with self._lock:
            if not self._octree:
                self._octree = create("octree", self._octree_options, self._handle)
            elif self._is_stale:
                call(library.rayc_octree_update, self._octree, self._handle)
            self._is_stale = False
            return self._octree
