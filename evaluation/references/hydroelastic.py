#!/usr/bin/env python3
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Writes hydroelastic.csv: the hydroelastic contact force on the first body of each pose, and its torque about that
body's origin, as Drake computes them: python3 hydroelastic.py

Both bodies are compliant. The pressure field of each is STIFFNESS times the distance to its own surface; Drake scales a
field by the largest distance in the mesh, so each modulus is STIFFNESS times that. Where the two fields are equal lies
the contact surface, over which Drake's linear pressure is integrated exactly.
"""
import csv
import pathlib

import numpy
from pydrake.common import MemoryFile
from pydrake.common.eigen_geometry import Quaternion
from pydrake.geometry import (
    AddCompliantHydroelasticProperties,
    FramePoseVector,
    GeometryFrame,
    GeometryInstance,
    HydroelasticContactRepresentation,
    InMemoryMesh,
    Mesh,
    ProximityProperties,
    SceneGraph,
)
from pydrake.math import RigidTransform

import volume_mesh

HERE = pathlib.Path(__file__).parent
STIFFNESS = 1.0


def vtk(mesh):
    lines = ["# vtk DataFile Version 3.0", "volume mesh", "ASCII", "DATASET UNSTRUCTURED_GRID"]
    lines += [f"POINTS {len(mesh.vertices)} double"] + [" ".join(map(repr, map(float, v))) for v in mesh.vertices]
    lines += [f"CELLS {len(mesh.tetrahedra)} {5 * len(mesh.tetrahedra)}"]
    lines += ["4 " + " ".join(map(str, t)) for t in mesh.tetrahedra]
    lines += [f"CELL_TYPES {len(mesh.tetrahedra)}"] + ["10"] * len(mesh.tetrahedra)
    return "\n".join(lines) + "\n"


class Pair:
    """Two bodies in a scene of their own; the first stays at the origin."""

    def __init__(self, first, second):
        self.graph = SceneGraph()
        self.source = self.graph.RegisterSource("pair")
        self.frames, self.geometries = [], []
        for name, mesh in (("first", first), ("second", second)):
            self.frames.append(self.graph.RegisterFrame(self.source, GeometryFrame(name)))
            shape = Mesh(InMemoryMesh(mesh_file=MemoryFile(vtk(mesh), ".vtk", name)))
            instance = GeometryInstance(RigidTransform(), shape, name)
            self.geometries.append(self.graph.RegisterGeometry(self.source, self.frames[-1], instance))
            properties = ProximityProperties()
            AddCompliantHydroelasticProperties(1.0, STIFFNESS * mesh.distance.max(), properties)
            self.graph.AssignRole(self.source, self.geometries[-1], properties)
        self.context = self.graph.CreateDefaultContext()

    def force_and_torque(self, placement):
        poses = FramePoseVector()
        poses.set_value(id=self.frames[0], value=RigidTransform())
        poses.set_value(id=self.frames[1], value=placement)
        self.graph.get_source_pose_port(self.source).FixValue(self.context, poses)
        query = self.graph.get_query_output_port().Eval(self.context)
        force, torque = numpy.zeros(3), numpy.zeros(3)
        for surface in query.ComputeContactSurfaces(HydroelasticContactRepresentation.kTriangle):
            # The normals point into M.
            sign = 1 if surface.id_M() == self.geometries[0] else -1
            mesh, field = surface.tri_mesh_W(), surface.tri_e_MN()
            vertices = numpy.array(mesh.vertices())
            pressure = numpy.array([field.EvaluateAtVertex(v) for v in range(len(vertices))])
            triangles = numpy.array([[t.vertex(i) for i in range(3)] for t in mesh.triangles()])
            corner, p = vertices[triangles], pressure[triangles]
            area = sign * 0.5 * numpy.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
            force += (p.mean(1)[:, None] * area).sum(0)
            # The rule of the three edge middles is exact for position times pressure.
            middle, at_middle = (corner + corner[:, [1, 2, 0]]) / 2, (p + p[:, [1, 2, 0]]) / 2
            torque += numpy.cross((middle * at_middle[..., None]).mean(1), area).sum(0)
        return force, torque


def read_poses():
    with open(HERE / "poses.csv") as file:
        return list(csv.DictReader(file))


def placement(row):
    # Normalised here since Drake refuses a quaternion whose length is off by more than rounding.
    q = numpy.array([float(row["quaternion_" + c]) for c in "wxyz"])
    return RigidTransform(Quaternion(q / numpy.linalg.norm(q)), [float(row["translation_" + c]) for c in "xyz"])


class Pairs:
    def __init__(self, sectors):
        self.sectors, self.meshes, self.pairs = sectors, {}, {}

    def mesh(self, name):
        if name not in self.meshes:
            self.meshes[name] = volume_mesh.make(name, self.sectors)
        return self.meshes[name]

    def __getitem__(self, pair):
        if pair not in self.pairs:
            self.pairs[pair] = Pair(*(self.mesh(name) for name in pair.split("-")))
        return self.pairs[pair]


def write(rows):
    pairs = Pairs(16)
    lines = ["id,force_x,force_y,force_z,torque_x,torque_y,torque_z"]
    for row in rows:
        force, torque = pairs[row["pair"]].force_and_torque(placement(row))
        lines.append(",".join([row["id"]] + [repr(float(x)) for x in (*force, *torque)]))
    (HERE / "hydroelastic.csv").write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    write(read_poses())
