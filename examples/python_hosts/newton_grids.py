# SPDX-License-Identifier: MIT OR Apache-2.0
"""A soft grid of NVIDIA Newton falls on another, on the CPU: forces go into Newton's own arrays, without copies."""

import newton
import numpy as np
import raycontact
import warp as wp

GRIDS = {(0.0, 0.0, 0.0): (6, 6, 2), (0.15, 0.15, 0.22): (3, 3, 3)}  # cells by corner
CELL = 0.1
DT, FRAMES, SUBSTEPS = 1 / 60, 60, 24
CONTACT = {"stiffness": 3e5, "damping_time": 0.01}  # N/m³, s

wp.config.quiet = True
wp.set_device("cpu")
builder = newton.ModelBuilder()
starts = []
for corner, cells in GRIDS.items():
    starts.append(len(builder.particle_q))
    builder.add_soft_grid(
        pos=wp.vec3(*corner),
        rot=wp.quat_identity(),
        vel=wp.vec3(0.0),
        dim_x=cells[0],
        dim_y=cells[1],
        dim_z=cells[2],
        cell_x=CELL,
        cell_y=CELL,
        cell_z=CELL,
        density=100.0,
        k_mu=1e4,
        k_lambda=2e4,
        k_damp=5.0,
        particle_radius=0.001,  # else its spheres push one another, within a grid too
    )
for particle in range(starts[1]):
    if builder.particle_q[particle][2] == 0:
        builder.particle_mass[particle] = 0.0  # held fast
model = builder.finalize()
solver = newton.solvers.SolverSemiImplicit(model)
now, following = model.state(), model.state()

triangles = model.tri_indices.numpy()
bodies = [slice(start, end) for start, end in zip(starts, [*starts[1:], model.particle_count])]
scene, contacts = raycontact.Scene(), raycontact.Contacts()
for body in bodies:
    own = triangles[(triangles[:, 0] >= body.start) & (triangles[:, 0] < body.stop)] - body.start
    scene.add(raycontact.Mesh(now.particle_q.numpy()[body], own))


def views(array):
    """Of the particles of each body: on the CPU numpy() shows Newton's own memory."""
    return [array.numpy()[body] for body in bodies]


for frame in range(FRAMES):
    for _ in range(SUBSTEPS):
        now.clear_forces()
        x, v, f = views(now.particle_q), views(now.particle_qd), views(now.particle_f)
        for number, positions in enumerate(x):
            scene.set_positions(number, positions)
        scene.query(contacts)
        contacts.add_forces(f, x, v, **CONTACT)
        scene.advance(DT / SUBSTEPS)
        solver.step(now, following, None, None, DT / SUBSTEPS)
        now, following = following, now
    if frame % 15 == 14:
        lowest = [positions[:, 2].min() for positions in views(now.particle_q)]
        print(f"{(frame + 1) * DT:.2f} s: {len(contacts):4} contacts, lowest points at", np.round(lowest, 2))

tetrahedra = now.particle_q.numpy()[model.tet_indices.numpy()]
volumes = np.linalg.det(tetrahedra[:, 1:] - tetrahedra[:, :1])
speeds = np.linalg.norm(now.particle_qd.numpy(), axis=1)
print(f"{np.sum(volumes <= 0)} tetrahedra inverted, the fastest particle at {speeds.max():.2f} m/s")
