# SPDX-License-Identifier: MIT OR Apache-2.0
"""Two elastic blocks of scikit-fem, pressed together: Newton's method with the derivative of the contact forces."""

import numpy as np
import raycontact
import skfem
from scipy.sparse import block_diag
from scipy.sparse.linalg import LinearOperator, gmres, splu
from skfem.models.elasticity import lame_parameters, linear_elasticity

YOUNG, POISSON = 1e5, 0.3  # Pa
STIFFNESS = YOUNG / 0.05  # N/m³: a surface bears Young's modulus where it is 5 cm deep
PRESSED = 0.05  # m


def block(width, bottom, top, cells):
    across = np.linspace(-width / 2, width / 2, cells + 1)
    return skfem.MeshTet.init_tensor(across, across, np.linspace(bottom, top, cells + 1))


def surface(mesh):
    """The boundary's triangles, counter-clockwise seen from outside."""
    facets = mesh.boundary_facets()
    triangles = mesh.facets[:, facets].T
    middles = mesh.p[:, mesh.t[:, mesh.f2t[0, facets]]].mean(axis=1).T
    a, b, c = (mesh.p.T[corners] for corners in triangles.T)
    is_inward = np.einsum("ij,ij->i", np.cross(b - a, c - a), a - middles) < 0
    return np.where(is_inward[:, None], triangles[:, [0, 2, 1]], triangles)


blocks = [block(1.0, -1.0, 0.0, 6), block(0.6, 0.0, 0.6, 5)]
bases = [skfem.Basis(mesh, skfem.ElementVector(skfem.ElementTetP1())) for mesh in blocks]
elastic = block_diag([linear_elasticity(*lame_parameters(YOUNG, POISSON)).assemble(basis) for basis in bases], "csr")
rest = np.concatenate([mesh.p.T for mesh in blocks])  # of vertex v the unknowns are 3v, 3v + 1 and 3v + 2
first = blocks[0].p.shape[1]
is_top, is_bottom = rest[:, 2] == 0.6, rest[:, 2] == -1.0
free = np.flatnonzero(np.repeat(~(is_top | is_bottom), 3))
inverse = splu(elastic[free][:, free].tocsc())

scene, contacts = raycontact.Scene(), raycontact.Contacts()
for mesh in blocks:
    scene.add(raycontact.Mesh(mesh.p.T, surface(mesh)))
scene.allow_escape(0, 1, False)
# Samples that stay on their triangles: no longer than the triangles' edges, so that the derivative lacks nothing.
scene.set_detection_options(sampling="spacing", sampling_value=0.05)


def in_bodies(vector):
    """A view for each body, so that what is added to it is added to the vector."""
    return np.split(vector.reshape(-1, 3), [first])


def product(part):
    """The derivative of the residual along a change of the free unknowns."""
    change, pushed = np.zeros((2, rest.size))
    change[free] = part
    contacts.add_differential(in_bodies(change), in_bodies(pushed), scene=scene, stiffness=STIFFNESS)
    return (elastic @ change - pushed)[free]


# Both squeezed evenly, and the upper one 2 mm lower: where nothing touches yet, a derivative knows nothing of contact.
moved = np.zeros(rest.size)
moved[2::3] = -PRESSED * (rest[:, 2] + 1.0) / 1.6 - 0.002 * (~is_top & (np.arange(len(rest)) >= first))
for iteration in range(9):
    for body, positions in enumerate(in_bodies(rest + moved.reshape(-1, 3))):
        scene.set_positions(body, positions)
    scene.query(contacts)
    pushed = np.zeros(rest.size)
    contacts.add_forces(in_bodies(pushed), stiffness=STIFFNESS)
    residual = (elastic @ moved - pushed)[free]
    size = np.linalg.norm(residual)
    print(f"iteration {iteration}: residual {size:.1e} N, {len(contacts)} contacts")
    if size < 1e-8:
        break
    tangent = LinearOperator((free.size, free.size), product, dtype=float)
    preconditioner = LinearOperator(tangent.shape, inverse.solve, dtype=float)
    moved[free] -= gmres(tangent, residual, rtol=1e-8, restart=200, M=preconditioner)[0]

load = -(elastic @ moved - pushed)[2::3][is_top].sum()
print(f"pressed by {PRESSED} m with {load:.0f} N, {load / 0.6**2 / 1e3:.1f} kPa")
