# SPDX-License-Identifier: MIT OR Apache-2.0
from importlib.metadata import version

import ipctk
import numpy as np

from ..library import Contacts, Library


class IpcToolkit(Library):
    name = "IPC Toolkit"
    version = version("ipctk")
    settings = "barrier within 0.001 of the scene's diagonal, area weights, stiffness 1"
    documentation = "https://ipctk.xyz/tutorials/getting_started.html"

    def load(self, first, second):
        ipctk.set_num_threads(1)
        ipctk.set_logger_level(ipctk.LoggerLevel.off)  # it warns of every pair that touches at the start
        self.counts = (len(first.positions), len(second.positions))
        faces = np.concatenate([first.triangles, second.triangles + self.counts[0]]).astype(np.int32)
        rest = np.concatenate([first.positions, second.positions + 10.0])
        self.mesh = ipctk.CollisionMesh(np.asfortranarray(rest), ipctk.edges(faces), np.asfortranarray(faces))
        # Only one body with the other.
        self.mesh.can_collide = ipctk.make_vertex_patches_filter(np.repeat([0, 1], self.counts).astype(np.int32))
        self.found = ipctk.NormalCollisions()
        self.found.use_area_weighting = True

    def move(self, poses, positions):
        self.positions = np.asfortranarray(np.concatenate(positions))

    def inside(self):
        raise NotImplementedError("it has no inside: distances have no sign, and a start must not intersect")

    def contacts(self):
        # In the units of the scene, since no length is given from outside.
        distance = 1e-3 * np.linalg.norm(np.ptp(self.positions, axis=0))
        self.found.build(self.mesh, self.positions, distance)
        force = -ipctk.BarrierPotential(distance, 1.0).gradient(self.found, self.mesh, self.positions)
        return lambda: self.read(force.reshape(-1, 3), distance)

    def read(self, forces, distance):
        """Each vertex with its barrier's force, half of it from either side of the pairs that act there."""
        sizes = np.linalg.norm(forces, axis=1)
        pushed = np.flatnonzero(np.isfinite(sizes) & (sizes > 0))
        directions = forces[pushed] / sizes[pushed, None]
        directions[pushed >= self.counts[0]] *= -1
        points = self.positions[pushed]
        return Contacts.make(points, points, directions, np.full(len(pushed), distance), 0.5 * sizes[pushed] / distance)

    def free_share(self, positions):
        """How much of a way to other positions its step rule lets the bodies go, 0 to 1, and whether it sees them
        intersect now."""
        end = np.asfortranarray(np.concatenate(positions))
        # Its default, tight inclusion, did not end within minutes from some of the intersections.
        search = ipctk.AdditiveCCD()
        return (ipctk.compute_collision_free_stepsize(self.mesh, self.positions, end, narrow_phase_ccd=search),
                ipctk.has_intersections(self.mesh, self.positions))
