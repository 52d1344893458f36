# SPDX-License-Identifier: MIT OR Apache-2.0
from importlib.metadata import version

import fcl
import numpy as np

from ..library import Contacts, Library

MOST_CONTACTS = 100_000


class Fcl(Library):
    name = "FCL"
    version = f"python-fcl {version('python-fcl')}"
    settings = "all contacts; Convex where both shapes are convex, else BVHModel (OBBRSS); rigid poses"
    documentation = "https://github.com/flexible-collision-library/fcl#readme"

    def load(self, first, second):
        make = convex if first.is_convex and second.is_convex else tree
        self.objects = [fcl.CollisionObject(make(s), fcl.Transform()) for s in (first, second)]

    def move(self, poses, positions):
        for body, pose in zip(self.objects, poses):
            body.setTransform(fcl.Transform(np.ascontiguousarray(pose[:, :3]), np.ascontiguousarray(pose[:, 3])))

    def inside(self):
        raise NotImplementedError("no query tells whether a point is inside a mesh")

    def contacts(self):
        result = fcl.CollisionResult()
        fcl.collide(*self.objects, fcl.CollisionRequest(num_max_contacts=MOST_CONTACTS, enable_contact=True), result)
        return lambda: contacts_of(result)


def contacts_of(result):
    """Normals lead from the first body into the second."""
    found = result.contacts
    points = np.array([contact.pos for contact in found]).reshape(-1, 3)
    normals = np.array([contact.normal for contact in found]).reshape(-1, 3)
    depths = np.abs([contact.penetration_depth for contact in found])
    is_number = np.isfinite(normals).all(1) & np.isfinite(points).all(1) & (np.linalg.norm(normals, axis=1) > 0)
    return Contacts.make(points[is_number], points[is_number], -normals[is_number], depths[is_number])


def tree(surface):
    model = fcl.BVHModel()
    model.beginModel(len(surface.positions), len(surface.triangles))
    model.addSubModel(surface.positions, surface.triangles.astype(np.int64))
    model.endModel()
    return model


def convex(surface):
    faces = np.column_stack([np.full(len(surface.triangles), 3), surface.triangles]).ravel()
    return fcl.Convex(surface.positions, len(surface.triangles), faces)
