# SPDX-License-Identifier: MIT OR Apache-2.0
"""The solid of the hosts of raycontact and of the IPC Toolkit, which judges those of the others too."""

import numpy as np
from scipy import sparse

YOUNG, POISSON, DENSITY = 1e5, 0.4, 1000.0
MU, LAMBDA = YOUNG / (2 + 2 * POISSON), YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON))


class Solid:
    """A stable neo-Hookean solid: energy, its gradient, and its second derivative without negative eigenvalues."""

    def __init__(self, scene):
        self.tetrahedra, x = scene.tetrahedra, scene.rest
        edges = x[self.tetrahedra[:, 1:]] - x[self.tetrahedra[:, :1]]
        self.inverse = np.linalg.inv(edges.transpose(0, 2, 1))
        self.volume = np.linalg.det(edges) / 6
        self.mass = np.zeros(len(x))
        np.add.at(self.mass, self.tetrahedra.ravel(), np.repeat(DENSITY * self.volume / 4, 4))
        # The deformation gradient is the sum of each node's position times its weights.
        self.weights = np.concatenate([-self.inverse.sum(axis=1, keepdims=True), self.inverse], axis=1)
        places = 3 * self.tetrahedra[:, :, None] + np.arange(3)
        flat = places.reshape(len(places), 12)
        self.rows, self.columns = np.repeat(flat, 12, axis=1).ravel(), np.tile(flat, (1, 12)).ravel()
        self.shape = (x.size, x.size)

    def gradients(self, x):
        return np.einsum("eni,enj->eij", x[self.tetrahedra], self.weights)

    def energy(self, x):
        f = self.gradients(x)
        stretch = np.linalg.det(f) - 1 - MU / LAMBDA
        return (self.volume * (MU / 2 * ((f ** 2).sum(axis=(1, 2)) - 3) + LAMBDA / 2 * stretch ** 2)).sum()

    @staticmethod
    def cofactors(f):
        return np.stack([np.cross(f[:, :, 1], f[:, :, 2]), np.cross(f[:, :, 2], f[:, :, 0]),
                         np.cross(f[:, :, 0], f[:, :, 1])], axis=2)

    def slope(self, x):
        f = self.gradients(x)
        stress = MU * f + (LAMBDA * (np.linalg.det(f) - 1 - MU / LAMBDA))[:, None, None] * self.cofactors(f)
        result = np.zeros_like(x)
        np.add.at(result, self.tetrahedra, np.einsum("e,eij,enj->eni", self.volume, stress, self.weights))
        return result

    def curvature(self, x):
        f = self.gradients(x)
        stretch, cofactors = np.linalg.det(f) - 1 - MU / LAMBDA, self.cofactors(f).reshape(-1, 9)
        sign = np.zeros((3, 3, 3))
        for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
            sign[i, j, k], sign[i, k, j] = 1, -1
        second = np.einsum("ikm,jln,emn->eijkl", sign, sign, f).reshape(-1, 9, 9)
        local = MU * np.eye(9) + LAMBDA * (cofactors[:, :, None] * cofactors[:, None] + stretch[:, None, None] * second)
        values, vectors = np.linalg.eigh(local)
        local = np.einsum("eik,ek,ejk->eij", vectors, np.maximum(values, 0), vectors).reshape(-1, 3, 3, 3, 3)
        blocks = np.einsum("e,eijkl,enj,eml->enimk", self.volume, local, self.weights, self.weights)
        return sparse.csc_array((blocks.ravel(), (self.rows, self.columns)), shape=self.shape)
