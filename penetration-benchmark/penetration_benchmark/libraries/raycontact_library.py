# SPDX-License-Identifier: MIT OR Apache-2.0
import raycontact

from ..library import Contacts, Library


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


class RaycontactPaper(Raycontact):
    name = "raycontact, paper"
    settings = "as in the paper: rays from vertices, its law, no areas, no edges, no escape"
    detection = raycontact.paper_detection_options()
    response = {"weighting": raycontact.Weighting.VERTEX}


class RaycontactNoEscape(Raycontact):
    name = "raycontact, no escape"
    settings = "default without escapes: contacts alone"
    detection = {"escape": 0}
