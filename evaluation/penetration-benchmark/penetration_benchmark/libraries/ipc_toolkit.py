# SPDX-License-Identifier: MIT OR Apache-2.0
from importlib.metadata import version

import ipctk
import numpy as np

from ..library import Library


class IpcToolkit(Library):
    name = "IPC Toolkit"
    version = version("ipctk")
    settings = "its step rule with additive continuous collision detection"
    # Its contract is a start without intersections, and a step rule of its own: solvers.py runs it so.
    tasks = ("intersecting",)
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

    def move(self, poses, positions):
        self.positions = np.asfortranarray(np.concatenate(positions))

    def inside(self):
        raise NotImplementedError("it has no inside: distances have no sign, and a start must not intersect")

    def contacts(self):
        raise NotImplementedError("its barrier needs its own step rule; solvers.py runs both")

    def free_share(self, positions):
        """How much of a way to other positions its step rule lets the bodies go, 0 to 1, and whether it sees them
        intersect now."""
        end = np.asfortranarray(np.concatenate(positions))
        # Its default, tight inclusion, did not end within minutes from some of the intersections.
        search = ipctk.AdditiveCCD()
        return (ipctk.compute_collision_free_stepsize(self.mesh, self.positions, end, narrow_phase_ccd=search),
                ipctk.has_intersections(self.mesh, self.positions))
