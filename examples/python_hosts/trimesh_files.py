# SPDX-License-Identifier: MIT OR Apache-2.0
"""Two files of any format that trimesh reads: where they overlap, how deeply, with what force, and a picture of it.

python trimesh_files.py first.stl second.ply [picture.glb]
"""

import sys

import numpy as np
import raycontact
import trimesh

STIFFNESS = 1e5  # Pa that a surface bears for each metre of depth


def read(name):
    surface = trimesh.load_mesh(name)
    surface.merge_vertices(merge_tex=True, merge_norm=True)  # seams of texture coordinates are no holes
    if surface.is_winding_consistent and surface.volume < 0:
        surface.invert()
    return surface


surfaces = [read(name) for name in sys.argv[1:3]]
meshes = [raycontact.Mesh.from_trimesh(surface, close_holes=0.1) for surface in surfaces]
for name, mesh in zip(sys.argv[1:3], meshes):
    print(f"{name}: {mesh.triangle_count} triangles, {len(mesh.holes)} holes closed")

contacts = raycontact.query_pair(*meshes)
if not len(contacts):
    sys.exit("they do not overlap")
forces = [np.zeros((mesh.vertex_count, 3)) for mesh in meshes]
contacts.add_forces(forces, stiffness=STIFFNESS)
net = forces[0].sum(axis=0)
depths = [-mesh.signed_distances(surface.vertices) for surface, mesh in zip(surfaces, meshes[::-1])]
print(f"overlap: {len(contacts)} contacts; {np.sum(depths[0] > 0)} and {np.sum(depths[1] > 0)} vertices in the other")
print(f"depth: the deepest vertex is {max(map(np.max, depths)):.3f} m below the other's surface")
print(f"force on the first: {np.linalg.norm(net):.0f} N along", np.round(net / np.linalg.norm(net), 2) + 0.0)

# Vertices from grey to red by the force on them, the second body shown beside the first.
if len(sys.argv) > 3:
    most = max(np.linalg.norm(force, axis=1).max() for force in forces)
    for surface, force in zip(surfaces, forces):
        red = 255 * np.linalg.norm(force, axis=1) / most
        grey = 200 - red * 200 / 255
        surface.visual.vertex_colors = np.stack([200 + red * 55 / 255, grey, grey, 0 * red + 255], axis=1)
    surfaces[1].apply_translation([1.1 * (surfaces[0].bounds[1, 0] - surfaces[1].bounds[0, 0]), 0, 0])
    trimesh.Scene(surfaces).export(sys.argv[3])
