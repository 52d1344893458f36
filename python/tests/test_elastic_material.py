# SPDX-License-Identifier: MIT OR Apache-2.0
"""What Material.elastic is for: two blocks of corotated tetrahedra in a column, squeezed to half of its height or set free."""

import numpy as np
import raycontact

YOUNG, POISSON, DENSITY, SIZE, CELLS, DT = 1e5, 0.3, 1000.0, 0.2, 4, 0.01


def block(bottom):
    """Nodes and tetrahedra, six to a cell."""
    side = CELLS + 1
    z, y, x = np.mgrid[:side, :side, :side]
    nodes = np.stack([x, y, z], 3).reshape(-1, 3) * (SIZE / CELLS) + [0, 0, bottom]
    first = (np.arange(side**3).reshape(side, side, side)[:-1, :-1, :-1]).ravel()
    corner = [i % 2 + side * (i // 2 % 2 + side * (i // 4)) for i in range(8)]
    ways = [(1, 3), (3, 2), (2, 6), (6, 4), (4, 5), (5, 1)]
    tetrahedra = np.concatenate([first[:, None] + [0, corner[a], corner[b], corner[7]] for a, b in ways])
    return nodes, tetrahedra


def surface_of(tetrahedra):
    faces = np.concatenate([tetrahedra[:, corners] for corners in ([0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3])])
    _, place, count = np.unique(np.sort(faces, 1), axis=0, return_inverse=True, return_counts=True)
    return faces[count[place.ravel()] == 1]


def edges_of(nodes, tetrahedra):
    return np.stack([nodes[tetrahedra[:, k]] - nodes[tetrahedra[:, 0]] for k in (1, 2, 3)], 2)


class Column:
    """Implicit Euler; the rotations are those at the start of the step."""

    def __init__(self, material):
        (lower, tetrahedra), (upper, _) = block(0.0), block(SIZE)
        self.rest, self.half = np.concatenate([lower, upper]), len(lower)
        self.tetrahedra = np.concatenate([tetrahedra, tetrahedra + self.half])
        self.x, self.v = self.rest.copy(), np.zeros_like(self.rest)
        rest = edges_of(self.rest, self.tetrahedra)
        self.inverse, volume = np.linalg.inv(rest), np.linalg.det(rest) / 6
        assert volume.min() > 0
        gradient = np.concatenate([-self.inverse.sum(1, keepdims=True), self.inverse], 1)
        shear = YOUNG / (2 + 2 * POISSON)
        lame = YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON))
        outer = np.einsum("eai,ebj->eabij", gradient, gradient)
        trace = np.einsum("eabii->eab", outer)[..., None, None] * np.eye(3)
        self.stiffness = volume[:, None, None, None, None] * (
            lame * outer + shear * (np.swapaxes(outer, 3, 4) + trace)
        )
        self.mass = np.zeros(len(self.rest))
        np.add.at(self.mass, self.tetrahedra, DENSITY * volume[:, None] / 4)
        z = self.rest[:, 2]
        self.held, self.moved = (z == 0) | (z == z.max()), z == z.max()
        self.scene, self.system = raycontact.Scene(), raycontact.ContactSystem()
        self.system.set_node_masses(np.where(self.held, np.inf, self.mass))
        for first, nodes in ((0, lower), (self.half, upper)):
            body = self.scene.add(raycontact.Mesh(nodes, surface_of(tetrahedra)))
            self.system.add_deformable(self.scene, body, first, self.half, material)

    def step(self, speed):
        count, t = self.x.size, self.tetrahedra
        left, _, right = np.linalg.svd(edges_of(self.x, t) @ self.inverse)
        left[:, :, 2] *= np.sign(np.linalg.det(left @ right))[:, None]
        turn = left @ right
        blocks = np.einsum("eij,eabjk,elk->eabil", turn, self.stiffness, turn)
        moved = self.x[t] - np.einsum("eij,eaj->eai", turn, self.rest[t])
        inner, whole = np.zeros_like(self.x), np.zeros((len(self.x), 3, len(self.x), 3))
        np.subtract.at(inner, t, np.einsum("eabij,ebj->eai", blocks, moved))
        np.add.at(whole, (t[:, :, None], slice(None), t[:, None, :]), blocks)
        elastic = whole.reshape(count, count)
        v = self.v.copy()
        v[self.held] = 0
        v[self.moved, 2] = -speed
        start, free = v.copy(), np.repeat(~self.held, 3)
        self.system.begin(self.scene, DT, self.x, start, start)
        for _ in range(5):
            forces = inner.copy()
            self.system.add_forces(v, forces)
            contact = np.zeros((len(self.x), 3, len(self.x), 3))
            rows, columns, found = self.system.blocks(1)
            np.add.at(contact, (rows, slice(None), columns), found)
            matrix = DT * contact.reshape(count, count) + DT**2 * elastic
            matrix[np.diag_indices(count)] += np.repeat(self.mass, 3)
            wrong = DT * (forces.ravel() - DT * (elastic @ v.ravel())) - np.repeat(self.mass, 3) * (v - start).ravel()
            change = np.zeros(count)
            change[free] = np.linalg.solve(matrix[np.ix_(free, free)], wrong[free])
            v = v + change.reshape(v.shape)
            if self.system.linearise(v) < 0.01:
                break
        self.system.finish(v)
        self.v, self.x = v, self.x + DT * v

    def depth(self):
        """How deep the lower block's upper face lies in the upper one's lower face, where it is deepest."""
        faces = np.isclose(self.rest[:, 2], SIZE)
        lower, upper = self.x[: self.half][faces[: self.half]], self.x[self.half :][faces[self.half :]]
        return (lower[:, 2] - upper[:, 2]).max()


def test_soft_blocks_in_a_column_do_not_sink_into_one_another():
    column = Column(raycontact.Material.elastic(YOUNG, POISSON, SIZE / CELLS))
    steps = 100
    for step in range(steps):
        column.step(SIZE / (steps * DT))  # both blocks together lose half of their height
        if step == 79:
            assert column.depth() < 0.001
    for _ in range(20):
        column.step(0.0)
    assert column.depth() < 0.002
    turned = np.linalg.det(edges_of(column.x, column.tetrahedra) @ column.inverse)
    assert turned.min() > 0


def test_blocks_set_free_from_a_fifth_in_one_another_part_gently():
    column = Column(raycontact.Material.elastic(YOUNG, POISSON, SIZE / CELLS))
    column.x[column.half :, 2] -= SIZE / 5
    column.held[:] = column.moved[:] = False
    column.system.set_node_masses(column.mass)
    energy = []  # of motion, J
    for _ in range(40):
        column.step(0.0)
        energy.append((column.mass @ column.v**2).sum() / 2)
    centres = (column.x[part].mean(0) for part in (slice(column.half), slice(column.half, None)))
    apart = np.subtract(*centres)[2] * -1 - SIZE * 4 / 5
    print(f"energy of motion: {max(energy):.3f} J; {1000 * apart:.0f} mm of {1000 * SIZE / 5:.0f} in 0.4 s")
    assert max(energy) < 0.1 and apart > 0.01
