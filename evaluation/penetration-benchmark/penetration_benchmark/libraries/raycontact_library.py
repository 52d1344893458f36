# SPDX-License-Identifier: MIT OR Apache-2.0
import numpy as np
import raycontact

from ..library import EXIT, Contacts, Library


class Raycontact(Library):
    name = "raycontact"
    version = raycontact.__version__
    settings = "default, double precision"
    documentation = "docs/options.md"
    detection: dict = {}
    response: dict = {}

    def load(self, first, second):
        self.scene, self.found = raycontact.Scene(threads=1), raycontact.Contacts()
        self.scene.set_detection_options(**self.detection)
        self.meshes = [raycontact.Mesh(surface.positions, surface.triangles) for surface in (first, second)]
        self.bodies = [self.scene.add(mesh) for mesh in self.meshes]

    def move(self, poses, positions):
        self.positions = positions

    def inside(self):
        for mesh, positions in zip(self.meshes, self.positions):
            mesh.set_positions(positions)
        (first, second), (x, y) = self.meshes, self.positions
        return second.contains(x), first.contains(y)

    def contacts(self):
        for body, positions in zip(self.bodies, self.positions):
            self.scene.set_positions(body, positions)
        self.scene.query(self.found)
        return self.read

    def read(self):
        array = self.found.to_array()
        weights = self.found.coefficients(**self.response)
        first, second = array["p1"]["position"].copy(), array["p2"]["position"].copy()
        direction = array["direction"].copy()
        is_second = array["colliding"] == self.bodies[1]
        first[is_second], second[is_second] = second[is_second], first[is_second].copy()
        direction[is_second] *= -1
        return Contacts.make(first, second, direction, array["depth"], weights)

    def load_body(self, body):
        # Vertices within the volume are nothing to a surface.
        self.count = body.triangles.max() + 1
        self.scene, self.found = raycontact.Scene(threads=1), raycontact.Contacts()
        self.scene.set_detection_options(sampling=raycontact.Sampling.VERTICES)
        self.body = self.scene.add(raycontact.Mesh(body.positions[:self.count], body.triangles))
        self.scene.set_self_collision(self.body, True)

    def exits(self, positions):
        self.scene.set_positions(self.body, positions[:self.count])
        self.scene.query(self.found)
        return self.read_exits

    def read_exits(self):
        array = self.found.to_array()
        exits = np.zeros(len(array), EXIT)
        # A ray that starts from a vertex has it first.
        exits["vertex"], exits["point"] = array["p1"]["vertices"][:, 0], array["p2"]["position"]
        return exits


# Self-contact has no areas, no edges and no escapes: it is the same for all three.
PAIRS = ("detect", "measure", "free", "intersecting", "simulate")


class RaycontactPaper(Raycontact):
    name = "raycontact, paper"
    tasks = PAIRS
    settings = "as in the paper: rays from vertices, its law, no areas, no edges, no escape; double precision"
    detection = raycontact.paper_detection_options()
    response = {"weighting": raycontact.Weighting.VERTEX}


class RaycontactNoEscape(Raycontact):
    name = "raycontact, no escape"
    tasks = PAIRS
    settings = "default without escapes: contacts alone"
    detection = {"escape": 0}
