# SPDX-License-Identifier: MIT OR Apache-2.0
import numpy as np
import raycontact

from ..library import EXIT
from .raycontact_library import Raycontact


class RaycontactOwnExits(Raycontact):
    name = "raycontact, own exits"
    settings = "Mesh.own_exits(), double precision"
    documentation = "docs/recipes.md"
    tasks = ("self",)

    def load_body(self, body):
        self.count = body.triangles.max() + 1
        self.mesh = raycontact.Mesh(body.positions[:self.count], body.triangles)

    def exits(self, positions):
        self.mesh.set_positions(positions[:self.count])
        found = self.mesh.own_exits()
        return lambda: self.exits_of(found)

    def exits_of(self, found):
        exits = np.zeros(len(found), EXIT)
        exits["vertex"], exits["point"] = found["vertex"], found["position"]
        return exits
