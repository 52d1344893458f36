import numpy as np
import raycontact

octahedron = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], float)
faces = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]]
ends, starts = np.tril_indices(6, -1)  # a spring between each two masses
rest = np.linalg.norm(octahedron[ends] - octahedron[starts], axis=1)


def add_springs(x, f, stiffness):
    d = x[ends] - x[starts]
    pull = stiffness * (1 - rest / np.linalg.norm(d, axis=1))[:, None] * d
    np.add.at(f, starts, pull)
    np.subtract.at(f, ends, pull)


dt, mass = 0.002, 0.1  # s, kg for each vertex
x = [octahedron.copy(), octahedron + [0.5, 0, 0]]
v = [np.zeros((6, 3)), np.zeros((6, 3))]
scene, contacts = raycontact.Scene(), raycontact.Contacts()
numbers = [scene.add(raycontact.Mesh(positions, faces)) for positions in x]

for step in range(500):
    f = [np.zeros((6, 3)), np.zeros((6, 3))]
    for number, positions in zip(numbers, x):
        scene.set_positions(number, positions)
    scene.query(contacts)
    contacts.add_forces(f, x, v, stiffness=100, damping_time=0.05)  # N/m^3, s
    scene.advance(dt)
    for n in range(2):
        add_springs(x[n], f[n], 50)
        v[n] += dt * f[n] / mass
        x[n] += dt * v[n]
    if step % 100 == 0:
        print(f"step {step:3}: {len(contacts)} contacts")
momentum = mass * (v[0] + v[1])[:, 0].sum()
print(f"{len(contacts)} contacts left, momentum {'kept' if abs(momentum) < 1e-12 else 'lost'}")
