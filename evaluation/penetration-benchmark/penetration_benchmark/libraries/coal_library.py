# SPDX-License-Identifier: MIT OR Apache-2.0
from importlib.metadata import version

import coal
import numpy as np

from ..library import Contacts, Library

MOST_CONTACTS = 100_000


class Coal(Library):
    name = "coal"
    version = version("coal")
    settings = "all contacts; Convex where both shapes are convex, else BVHModelOBBRSS; rigid poses"
    documentation = "https://github.com/coal-library/coal#readme"

    def load(self, first, second):
        make = convex if first.is_convex and second.is_convex else tree
        self.shapes = [make(s) for s in (first, second)]
        self.placements = [coal.Transform3s() for _ in self.shapes]
        self.request = coal.CollisionRequest()
        self.request.num_max_contacts, self.request.enable_contact = MOST_CONTACTS, True

    def move(self, poses, positions):
        for placement, pose in zip(self.placements, poses):
            placement.setRotation(np.ascontiguousarray(pose[:, :3]))
            placement.setTranslation(np.ascontiguousarray(pose[:, 3]))

    def inside(self):
        raise NotImplementedError("no query tells whether a point is inside a mesh")

    def contacts(self):
        result = coal.CollisionResult()
        coal.collide(self.shapes[0], self.placements[0], self.shapes[1], self.placements[1], self.request, result)
        return lambda: contacts_of(result)


class CoalPatches(Coal):
    """Where a pair has one contact, the corners of the patch on which it lies share its depth."""

    name = "coal, patches"
    settings = "the same with contact patches, of convex shapes"
    tasks = ("free", "simulate")

    def load(self, first, second):
        super().load(first, second)
        self.is_convex = first.is_convex and second.is_convex

    def contacts(self):
        if not self.is_convex:
            return super().contacts()
        result, patches = coal.CollisionResult(), coal.ContactPatchResult()
        pair = self.shapes[0], self.placements[0], self.shapes[1], self.placements[1]
        coal.collide(*pair, self.request, result)
        coal.computeContactPatch(*pair, result, coal.ContactPatchRequest(), patches)
        return lambda: corners_of(patches) if patches.numContactPatches() else contacts_of(result)


def corners_of(patches):
    patch = patches.getContactPatch(0)
    first = np.array([patch.getPointShape1(i) for i in range(patch.size())]).reshape(-1, 3)
    second = np.array([patch.getPointShape2(i) for i in range(patch.size())]).reshape(-1, 3)
    return Contacts.make(first, second, np.tile(-patch.getNormal(), (len(first), 1)), -patch.penetration_depth,
                         1 / max(len(first), 1))


def contacts_of(result):
    """Normals lead from the first body to the second; overlaps are negative distances."""
    found = [result.getContact(i) for i in range(result.numContacts())]
    first = np.array([c.getNearestPoint1() for c in found]).reshape(-1, 3)
    second = np.array([c.getNearestPoint2() for c in found]).reshape(-1, 3)
    normals = np.array([c.normal for c in found]).reshape(-1, 3)
    depths = np.array([-c.penetration_depth for c in found])
    is_number = (np.isfinite(normals).all(1) & np.isfinite(first).all(1) & np.isfinite(second).all(1)
                 & np.isfinite(depths) & (depths > 0))
    return Contacts.make(first[is_number], second[is_number], -normals[is_number], depths[is_number])


def tree(surface):
    model = coal.BVHModelOBBRSS()
    model.beginModel(len(surface.triangles), len(surface.positions))
    model.addVertices(np.asfortranarray(surface.positions))
    model.addTriangles(np.asfortranarray(surface.triangles.astype(np.uint64)))
    model.endModel()
    return model


def convex(surface):
    points, triangles = coal.StdVec_Vec3s(), coal.StdVec_Triangle()
    for point in surface.positions:
        points.append(point)
    for triangle in surface.triangles:
        triangles.append(coal.Triangle(*map(int, triangle)))
    return coal.Convex(points, triangles)
