# SPDX-License-Identifier: MIT OR Apache-2.0
import mujoco
import numpy as np

from ..library import Contacts, Library

OPTIONS = '<option gravity="0 0 0" sdf_iterations="20" sdf_initpoints="80"/><size memory="256M"/>'


class Mujoco(Library):
    name = "MuJoCo"
    version = mujoco.__version__
    settings = "geoms of type mesh where both shapes are convex, else sdf with 80 starting points and 20 iterations"
    documentation = "https://mujoco.readthedocs.io/en/stable/XMLreference.html#body-geom-type"

    def __init__(self):
        self.models = {}

    def load(self, first, second):
        key = first.name, second.name
        if key not in self.models:
            kind = "mesh" if first.is_convex and second.is_convex else "sdf"
            self.models[key] = model_of({s.name: s for s in (first, second)}, key, kind)
        self.model = self.models[key]
        self.data = mujoco.MjData(self.model)
        mujoco.mj_forward(self.model, self.data)

    def move(self, poses, positions):
        for body, pose in enumerate(poses):
            self.data.qpos[7 * body:7 * body + 3] = pose[:, 3]
            mujoco.mju_mat2Quat(self.data.qpos[7 * body + 3:7 * body + 7], np.ascontiguousarray(pose[:, :3]).ravel())

    def inside(self):
        raise NotImplementedError("the Python package has no query for the distance of a point to a mesh")

    def contacts(self):
        mujoco.mj_kinematics(self.model, self.data)
        mujoco.mj_comPos(self.model, self.data)
        mujoco.mj_collision(self.model, self.data)
        return self.read

    def read(self):
        """Normals lead from a contact's first geom to its second; overlaps are negative distances."""
        contact = self.data.contact
        normals = np.array(contact.frame).reshape(-1, 9)[:, :3]
        normals = np.where(np.array(contact.geom).reshape(-1, 2)[:, :1] == 0, normals, -normals)
        middle, depths = np.array(contact.pos).reshape(-1, 3), -np.array(contact.dist)
        kept = (depths > 0) & np.isfinite(normals).all(1)
        half = 0.5 * depths[:, None] * normals
        return Contacts.make((middle + half)[kept], (middle - half)[kept], -normals[kept], depths[kept])


def model_of(surfaces, names, kind):
    meshes = "".join(
        f'<mesh name="{s.name}" vertex="{" ".join(map(repr, s.positions.ravel().tolist()))}" '
        f'face="{" ".join(map(str, s.triangles.ravel()))}"/>' for s in surfaces.values())
    bodies = "".join(f'<body><freejoint/><geom type="{kind}" mesh="{name}"/></body>' for name in names)
    text = f"<mujoco>{OPTIONS}<asset>{meshes}</asset><worldbody>{bodies}</worldbody></mujoco>"
    return mujoco.MjModel.from_xml_string(text)
