# SPDX-License-Identifier: MIT OR Apache-2.0
from importlib.metadata import version

import numpy as np
from pydrake.common import MemoryFile
from pydrake.geometry import (
    AddCompliantHydroelasticProperties,
    Convex,
    FramePoseVector,
    GeometryFrame,
    GeometryInstance,
    HydroelasticContactRepresentation,
    InMemoryMesh,
    Mesh,
    ProximityProperties,
    SceneGraph,
)
from pydrake.math import RigidTransform, RotationMatrix

from ..library import Contacts, Library
from ..volumes import fill


class Drake(Library):
    name = "Drake, hydroelastic"
    version = version("drake")
    settings = "both bodies compliant; Convex where a shape is convex, else a tetrahedral Mesh; pressure 1 a length"
    documentation = "https://drake.mit.edu/doxygen_cxx/group__hydroelastic__user__guide.html"

    def __init__(self):
        self.shapes = {}

    def load(self, first, second):
        self.graph = SceneGraph()
        self.source = self.graph.RegisterSource("pair")
        self.frames, self.geometries = [], []
        for name, surface in (("first", first), ("second", second)):
            if (surface.name, len(surface.positions)) not in self.shapes:
                self.shapes[surface.name, len(surface.positions)] = shape_of(surface)
            shape, depth = self.shapes[surface.name, len(surface.positions)]
            self.frames.append(self.graph.RegisterFrame(self.source, GeometryFrame(name)))
            instance = GeometryInstance(RigidTransform(), shape, name)
            self.geometries.append(self.graph.RegisterGeometry(self.source, self.frames[-1], instance))
            properties = ProximityProperties()
            # A field is scaled to 1 where a body is deepest.
            AddCompliantHydroelasticProperties(depth, depth, properties)
            self.graph.AssignRole(self.source, self.geometries[-1], properties)
        self.context = self.graph.CreateDefaultContext()

    def move(self, poses, positions):
        vector = FramePoseVector()
        for frame, pose in zip(self.frames, poses):
            vector.set_value(frame, RigidTransform(RotationMatrix.ProjectToRotationMatrix(pose[:, :3]), pose[:, 3]))
        self.graph.get_source_pose_port(self.source).FixValue(self.context, vector)
        self.positions = positions

    def query(self):
        return self.graph.get_query_output_port().Eval(self.context)

    def inside(self):
        query, marks = self.query(), []
        for own, points in enumerate(self.positions):
            other = self.geometries[1 - own]
            found = (query.ComputeSignedDistanceToPoint(point, 0.0) for point in points)
            marks.append(np.array([any(a.id_G == other and a.distance < 0 for a in answer) for answer in found]))
        return tuple(marks)

    def contacts(self):
        surfaces = self.query().ComputeContactSurfaces(HydroelasticContactRepresentation.kTriangle)
        return lambda: self.read(surfaces)

    def read(self, surfaces):
        parts = [Contacts.make([], [], [], [])]
        for surface in surfaces:
            # The normals point into M.
            sign = 1 if surface.id_M() == self.geometries[0] else -1
            mesh, field = surface.tri_mesh_W(), surface.tri_e_MN()
            vertices = np.array(mesh.vertices())
            pressure = np.array([field.EvaluateAtVertex(v) for v in range(len(vertices))])
            triangles = np.array([[t.vertex(i) for i in range(3)] for t in mesh.triangles()])
            corners = vertices[triangles]
            normals = 0.5 * np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
            areas = np.linalg.norm(normals, axis=1)
            kept = areas > 0
            middles, directions = corners.mean(1)[kept], sign * normals[kept] / areas[kept, None]
            # With pressure 1 a length the surface lies as deep in the one body as in the other: they part by both.
            depths = 2 * pressure[triangles].mean(1)[kept]
            parts.append(Contacts.make(middles, middles, directions, depths, 0.5 * areas[kept]))
        return np.concatenate(parts)


def shape_of(surface):
    """A shape of Drake's, and how deep it is."""
    if surface.is_convex:
        lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in surface.positions.tolist()]
        lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in surface.triangles.tolist()]
        file = MemoryFile("\n".join(lines) + "\n", ".obj", surface.name)
        return Convex(InMemoryMesh(mesh_file=file)), depth_of(surface, surface.positions.mean(0)[None])
    vertices, tetrahedra = fill(surface)
    lines = ["# vtk DataFile Version 3.0", surface.name, "ASCII", "DATASET UNSTRUCTURED_GRID",
             f"POINTS {len(vertices)} double", *(f"{x!r} {y!r} {z!r}" for x, y, z in vertices.tolist()),
             f"CELLS {len(tetrahedra)} {5 * len(tetrahedra)}",
             *("4 " + " ".join(map(str, t)) for t in tetrahedra.tolist()),
             f"CELL_TYPES {len(tetrahedra)}", *["10"] * len(tetrahedra)]
    file = MemoryFile("\n".join(lines) + "\n", ".vtk", surface.name)
    outer = set(map(tuple, surface.positions.round(6)))
    inner = np.array([vertex for vertex in vertices if tuple(vertex.round(6)) not in outer])
    return Mesh(InMemoryMesh(mesh_file=file)), depth_of(surface, inner)


def depth_of(surface, points):
    """The distance to the surface from the deepest of the points, to a few per cent: by a grid on each triangle."""
    pieces = 12 if len(surface.triangles) < 1000 else 2
    weights = np.array([(i, j, pieces - i - j) for i in range(pieces + 1) for j in range(pieces + 1 - i)]) / pieces
    grid = np.einsum("wc,tcx->twx", weights, surface.positions[surface.triangles]).reshape(-1, 3)
    return float(max(np.sqrt(((grid - point) ** 2).sum(1).min()) for point in points))
