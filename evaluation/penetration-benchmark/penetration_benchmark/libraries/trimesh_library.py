# SPDX-License-Identifier: MIT OR Apache-2.0
from importlib.metadata import version

import numpy as np
import trimesh
from trimesh.ray.ray_pyembree import RayMeshIntersector

from ..library import Library


class Trimesh(Library):
    name = "trimesh"
    version = f"{version('trimesh')}, embreex {version('embreex')}"
    settings = "contains_points on Embree, in each body's own frame"
    documentation = "https://trimesh.org/trimesh.ray.ray_pyembree.html"

    def load(self, first, second):
        self.rays = [RayMeshIntersector(trimesh.Trimesh(s.positions, s.triangles, process=False))
                     for s in (first, second)]
        for rays in self.rays:
            rays.contains_points(np.zeros((1, 3)))  # builds the tree

    def move(self, poses, positions):
        self.poses, self.positions = poses, positions

    def inside(self):
        # The tree stays: points go into the other body's frame.
        return tuple(self.rays[1 - i].contains_points(
            (self.positions[i] - self.poses[1 - i][:, 3]) @ self.poses[1 - i][:, :3]) for i in (0, 1))

    def contacts(self):
        raise NotImplementedError("it has ray queries and no contacts; its collision manager is FCL")
