# SPDX-License-Identifier: MIT OR Apache-2.0
"""Pairs of elastic bodies, each library in its own solver: do they come apart, and what does it take?

Usage: python -m penetration_benchmark.deforming [--scenes NAME,...] [--libraries NAME,...] [--scan OBJ] [CSV]

Two bodies of tetrahedra, without gravity or friction. *Apart*: they start apart and run into one another at one size
a second. *Deep*: the same bodies start at rest, the second moved a quarter of the size into the first. Each runs for a
second in steps of a hundredth, MuJoCo in steps of its own default, Bullet of 1/240 s. Density 1000 kg/m³, Young's modulus 1e5 Pa,
Poisson's ratio 0.4, size 1 m.
  raycontact    the contact system, `Material.elastic` of the scene's moduli and a surface edge, no friction; the host
                below: implicit Euler by Newton's method, a stable neo-Hookean solid
  IPC Toolkit   the same host and solid; barrier with the documented adaptive stiffness, activation distance 0.001 of
                the scene's diagonal; Newton's method with continuous collision detection in the line search
  MuJoCo        its own flexes, `mj_step`, the integrator that it names for elastic ones, damping 0.005, no friction,
                else defaults
  Bullet        its deformable world as in its examples (c/bullet_soft.cpp): implicit steps of 1/240 s, linear elasticity
                with damping, contact of vertices on faces, margin 0.001, no friction
The judge is `exact`: bodies are apart when their surfaces have no point in common and neither is in the other. `depth`
is the deepest vertex inside the other body at the end, by all its triangles, in parts of the size; `inverted` the
tetrahedra turned inside out at the end; `seconds` the processor's time of the run, and `parted_after` that until the
bodies were first apart, having met."""

import argparse
import csv
import ctypes
import importlib.metadata
import os
import sys
import time

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(variable, "1")

import numpy as np  # noqa: E402, after the number of threads
from scipy import sparse  # noqa: E402
from scipy.sparse.linalg import splu  # noqa: E402

from . import bodies, exact  # noqa: E402

YOUNG, POISSON, DENSITY = 1e5, 0.4, 1000.0
MU, LAMBDA = YOUNG / (2 + 2 * POISSON), YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON))
DT, SECONDS, SPEED, GAP, INTO = 0.01, 1.0, 1.0, 0.05, 0.25
MOST_ITERATIONS = 50


# ---- Bodies of about size 1 ----

def box():
    grid, tetrahedra = bodies.blocks((4, 4, 4), False)
    return grid / 4 - 0.5, tetrahedra


def ball():
    points, tetrahedra = box()
    # Shells of the cube become shells of the ball.
    length = np.linalg.norm(points, axis=1)
    return points * (np.abs(points).max(axis=1) / np.where(length > 0, length, 1))[:, None], tetrahedra


def torus():
    grid, tetrahedra = bodies.blocks((16, 2, 2), True)
    angle, across = 2 * np.pi * grid[:, 0] / 16, grid[:, 1:] - 1
    length = np.linalg.norm(across, axis=1)
    across = 0.15 * across * (np.abs(across).max(axis=1) / np.where(length > 0, length, 1))[:, None]
    radius = 0.35 + across[:, 0]
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), -across[:, 1]], 1), tetrahedra


def scan(path, cells=8):
    """The cubes of a grid whose middles lie inside a closed surface."""
    with open(path, encoding="utf-8") as file:
        lines = [line.split() for line in file]
    points = np.array([[float(word) for word in words[1:4]] for words in lines if words[:1] == ["v"]])
    corners = [words[1:4] for words in lines if words[:1] == ["f"]]
    triangles = np.array([[int(word.split("/")[0]) - 1 for word in words] for words in corners])
    points = (points - points.min(0)) / np.ptp(points, axis=0).max() * cells
    grid, tetrahedra = bodies.blocks((cells, cells, cells), False)
    inside = exact.classify(grid[tetrahedra[::6]].min(axis=1) + 0.5, points, triangles) > 0
    tetrahedra = tetrahedra.reshape(-1, 6, 4)[inside].reshape(-1, 4)
    used, tetrahedra = np.unique(tetrahedra, return_inverse=True)
    return grid[used] / cells - 0.5, tetrahedra.reshape(-1, 4)


class Body:
    def __init__(self, points, tetrahedra):
        made = bodies.from_tetrahedra("", points, tetrahedra)
        self.points, self.triangles, self.tetrahedra = made[1], made[2].astype(int), made[3].astype(int)


class Scene:
    """Two bodies, their nodes one after the other."""

    def __init__(self, first, second, is_deep):
        low = second.points[:, 0].min()
        start = first.points[:, 0].max() - low + (-INTO if is_deep else GAP)
        self.bodies, self.is_deep = (first, second), is_deep
        # A little beside, so that no two vertices meet exactly.
        self.rest = np.vstack([first.points, second.points + [start, 0.031, 0.017]])
        self.split = len(first.points)
        self.velocities = np.zeros_like(self.rest)
        if not is_deep:
            self.velocities[: self.split, 0], self.velocities[self.split:, 0] = SPEED / 2, -SPEED / 2
        self.tetrahedra = np.vstack([first.tetrahedra, second.tetrahedra + self.split])
        self.triangles = np.vstack([first.triangles, second.triangles + self.split])
        self.is_apart = exact.Apart([first.triangles, second.triangles])

    def halves(self, x):
        return x[: self.split], x[self.split:]

    def depth(self, x):
        deepest, pair = 0.0, self.halves(x)
        for own, other, body in ((pair[0], pair[1], self.bodies[1]), (pair[1], pair[0], self.bodies[0])):
            inside = own[exact.classify(own, other, body.triangles) > 0]
            for point in inside:
                deepest = max(deepest, distance(point, other[body.triangles]))
        return deepest


def distance(p, corners):
    a, b, c = corners.transpose(1, 0, 2)
    squared = np.full(len(a), np.inf)
    for start, end in ((a, b), (b, c), (c, a)):
        way = end - start
        t = np.clip(np.einsum("ij,ij->i", p - start, way) / np.einsum("ij,ij->i", way, way), 0, 1)
        squared = np.minimum(squared, ((start + t[:, None] * way - p) ** 2).sum(axis=1))
    normal = np.cross(b - a, c - a)
    is_above = np.minimum.reduce([np.einsum("ij,ij->i", np.cross(end - start, p - start), normal)
                                  for start, end in ((a, b), (b, c), (c, a))]) >= 0
    plane = np.einsum("ij,ij->i", p - a, normal) ** 2 / np.einsum("ij,ij->i", normal, normal)
    squared[is_above] = np.minimum(squared, plane)[is_above]
    return squared.min() ** 0.5


# ---- The host of raycontact and of the IPC Toolkit ----

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


class Raycontact:
    name = "raycontact"
    settings = "contact system, Material.elastic(E, ν, edge), no friction"

    def __init__(self, scene):
        import dataclasses

        import raycontact

        self.version, self.solid = importlib.metadata.version("raycontact"), Solid(scene)
        self.scene, self.system = raycontact.Scene(), raycontact.ContactSystem()
        self.system.set_node_masses(self.solid.mass)
        first = 0
        for body in scene.bodies:
            used = int(body.triangles.max()) + 1
            number = self.scene.add(raycontact.Mesh(body.points[:used], body.triangles))
            edge = np.linalg.norm(body.points[body.triangles[:, 0]] - body.points[body.triangles[:, 1]], axis=1).mean()
            material = dataclasses.replace(raycontact.Material.elastic(YOUNG, POISSON, edge), friction=0.0)
            self.system.add_deformable(self.scene, number, first, used, material)
            first += len(body.points)
        self.x, self.v = scene.rest.copy(), scene.velocities.copy()

    def step(self):
        solid, system, mass = self.solid, self.system, np.repeat(self.solid.mass, 3)
        free = v = self.v
        system.begin(self.scene, DT, self.x, v, v)
        for _ in range(6):
            there = self.x + DT * v
            forces = -solid.slope(there)
            system.add_forces(v, forces)
            contact = sparse.csr_array(system.csr(), shape=solid.shape)
            matrix = sparse.diags_array(mass) + DT * contact + DT ** 2 * solid.curvature(there)
            change = splu(matrix.tocsc()).solve(DT * forces.ravel() - mass * (v - free).ravel())
            v = v + change.reshape(v.shape)
            is_wrong = system.linearise(v) > 0.01
            is_small = np.abs(change).max() < 1e-3 * SPEED
            if not system.detect_again(self.scene, v) and not is_wrong and is_small:
                break
        system.finish(v)
        self.x, self.v = self.x + DT * v, v


class IpcToolkit:
    name = "IPC Toolkit"
    settings = "Newton, barrier within 0.001 of the diagonal, adaptive stiffness, tight inclusion"

    def __init__(self, scene):
        import ipctk

        self.ipctk, self.version, self.solid = ipctk, importlib.metadata.version("ipctk"), Solid(scene)
        ipctk.set_num_threads(1)
        ipctk.set_logger_level(ipctk.LoggerLevel.off)
        edges = ipctk.edges(scene.triangles)
        self.mesh = ipctk.CollisionMesh.build_from_full_mesh(
            np.asfortranarray(scene.rest), edges, np.asfortranarray(scene.triangles, np.int32))
        self.x, self.v = scene.rest.copy(), scene.velocities.copy()
        self.diagonal = np.linalg.norm(np.ptp(scene.rest, axis=0))
        self.reach = 1e-3 * self.diagonal
        self.barrier, self.stiffness, self.most, self.before = ipctk.ClampedLogBarrier(), None, None, None

    def outer(self, x):
        return np.asfortranarray(self.mesh.vertices(np.asfortranarray(x)))

    def collisions(self, x):
        found = self.ipctk.NormalCollisions()
        found.build(self.mesh, self.outer(x), self.reach)
        return found

    def potential(self):
        return self.ipctk.BarrierPotential(self.reach, 1.0 if self.stiffness is None else self.stiffness)

    def total(self, x, aim, found):
        inertia = (self.solid.mass[:, None] * (x - aim) ** 2).sum() / 2
        return inertia + DT ** 2 * (self.solid.energy(x) + self.potential()(found, self.mesh, self.outer(x)))

    def step(self):
        ipctk, solid, mass = self.ipctk, self.solid, np.repeat(self.solid.mass, 3)
        aim, x = self.x + DT * self.v, self.x.copy()
        found = self.collisions(x)
        for _ in range(MOST_ITERATIONS):
            elastic = solid.slope(x).ravel() * DT ** 2 + mass * (x - aim).ravel()
            if self.stiffness is None and not found.empty():
                push = self.mesh.to_full_dof(self.potential().gradient(found, self.mesh, self.outer(x)))
                self.stiffness, self.most = ipctk.initial_barrier_stiffness(
                    self.diagonal, self.barrier, self.reach, float(solid.mass.mean()), elastic / DT ** 2, push)
            potential = self.potential()
            push = self.mesh.to_full_dof(potential.gradient(found, self.mesh, self.outer(x)))
            bend = self.mesh.to_full_dof(potential.hessian(
                found, self.mesh, self.outer(x), ipctk.PSDProjectionMethod.CLAMP))
            matrix = sparse.diags_array(mass) + DT ** 2 * (solid.curvature(x) + sparse.csc_array(bend))
            way = -splu(matrix.tocsc()).solve(elastic + DT ** 2 * push).reshape(x.shape)
            if np.abs(way).max() < 1e-3 * SPEED * DT:
                break
            part = ipctk.compute_collision_free_stepsize(self.mesh, self.outer(x), self.outer(x + way))
            energy = self.total(x, aim, found)
            while part > 1e-12:
                after = self.collisions(x + part * way)
                if self.total(x + part * way, aim, after) <= energy:
                    break
                part /= 2
            x, found = x + part * way, after
            nearest = found.compute_minimum_distance(self.mesh, self.outer(x)) if not found.empty() else np.inf
            if self.stiffness is not None and self.before is not None and np.isfinite(nearest):
                self.stiffness = ipctk.update_barrier_stiffness(
                    self.before, nearest, self.most, self.stiffness, self.diagonal)
            self.before = nearest if np.isfinite(nearest) else None
        self.x, self.v = x, (x - self.x) / DT


class Mujoco:
    name = "MuJoCo"
    settings = "flexes of dimension 3, mj_step, integrator discrete, radius 0.001, damping 0.005, condim 1"

    def __init__(self, scene):
        import mujoco

        self.mujoco, self.version = mujoco, importlib.metadata.version("mujoco")
        text = lambda array: " ".join(map(str, np.ravel(array)))  # noqa: E731
        mass = Solid(scene).mass
        parts = []
        for name, body, points, its in zip("ab", scene.bodies, scene.halves(scene.rest), scene.halves(mass)):
            parts.append(
                f'<flexcomp name="{name}" type="direct" dim="3" radius="0.001" mass="{its.sum()}" '
                f'point="{text(points)}" element="{text(body.tetrahedra)}">'
                '<contact selfcollide="none" condim="1"/>'
                f'<elasticity young="{YOUNG}" poisson="{POISSON}" damping="0.005"/></flexcomp>')
        self.model = mujoco.MjModel.from_xml_string(
            '<mujoco><option gravity="0 0 0" integrator="discrete"/><size memory="1G"/>'
            f'<worldbody>{"".join(parts)}</worldbody></mujoco>')
        self.data = mujoco.MjData(self.model)
        self.data.qvel[:] = scene.velocities.ravel()
        mujoco.mj_forward(self.model, self.data)

    def step(self):
        for _ in range(round(DT / self.model.opt.timestep)):
            self.mujoco.mj_step(self.model, self.data)
        self.x = self.data.flexvert_xpos.copy()


class Bullet:
    name, version = "Bullet", "3.24"
    settings = "deformable world, implicit, linear elasticity, vertices on faces, margin 0.001, erp 0.3, no friction"

    def __init__(self, scene):
        self.scene, solid = scene, Solid(scene)
        self.library = ctypes.CDLL(os.path.join(os.environ["PENETRATION_BUILD"], "bullet_soft.so"))
        number, pointer = ctypes.c_double, ctypes.c_void_p
        self.library.bullet_soft_begin.argtypes = [number, number]
        self.library.bullet_soft_add.argtypes = [pointer] * 3 + [ctypes.c_int, pointer, ctypes.c_int, number]
        self.library.bullet_soft_step.argtypes = [number, ctypes.c_int]
        self.library.bullet_soft_read.argtypes = [pointer]
        self.time = 0.0
        self.library.bullet_soft_begin(YOUNG, POISSON)
        masses = solid.mass[: scene.split], solid.mass[scene.split:]
        for body, *arrays in zip(scene.bodies, scene.halves(scene.rest), scene.halves(scene.velocities), masses):
            arrays = [np.ascontiguousarray(array) for array in arrays]
            tetrahedra = np.ascontiguousarray(body.tetrahedra, np.intc)
            self.library.bullet_soft_add(*(array.ctypes.data for array in arrays), len(body.points),
                                         tetrahedra.ctypes.data, len(tetrahedra), 0.001)

    def step(self):
        # Two or three of its own steps for each hundredth.
        before, self.time = self.time, self.time + DT
        self.library.bullet_soft_step(1 / 240, round(240 * self.time) - round(240 * before))
        self.x = np.empty_like(self.scene.rest)
        self.library.bullet_soft_read(self.x.ctypes.data)


LIBRARIES = (Raycontact, IpcToolkit, Mujoco, Bullet)
HEAD = ["scene", "start", "tetrahedra", "library", "version", "settings", "parted", "depth", "inverted", "seconds",
        "parted_after"]


def run(library, scene, solid):
    start = time.process_time()
    its, has_met, parted_after, judged = library(scene), scene.is_deep, None, 0.0
    for _ in range(round(SECONDS / DT)):
        its.step()
        before = time.process_time()
        if not np.isfinite(its.x).all():
            break
        is_apart = scene.is_apart(scene.halves(its.x))
        has_met = has_met or not is_apart or near(scene, its.x)
        if has_met and is_apart and parted_after is None and not near(scene, its.x):
            parted_after = before - start - judged
        judged += time.process_time() - before
    spent = time.process_time() - start - judged
    if not np.isfinite(its.x).all():
        return its, "exploded", "", "", spent, None
    parted = ("yes" if has_met else "never met") if scene.is_apart(scene.halves(its.x)) else "no"
    inverted = int((np.linalg.det(solid.gradients(its.x)) <= 0).sum())
    return its, parted, f"{scene.depth(its.x):.3g}", inverted, spent, parted_after


def near(scene, x):
    """Whether the boxes are as near as a bouncing pair's are."""
    first, second = scene.halves(x)
    return second[:, 0].min() - first[:, 0].max() < 0.2 * GAP


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("csv", nargs="?", default="-", help="where the figures go (default: printed)")
    parser.add_argument("--scenes", default="", help="names, with commas between (default: all)")
    parser.add_argument("--libraries", default="", help="names, with commas between (default: all)")
    parser.add_argument("--scan", default="", help="a closed surface, .obj, of which one more pair is made")
    options = parser.parse_args()
    shapes = {"box": Body(*box()), "ball": Body(*ball()), "torus": Body(*torus())}
    pairs = [("box", "box"), ("ball", "ball"), ("torus", "torus"), ("box", "ball"), ("ball", "torus")]
    if options.scan:
        shapes["scan"] = Body(*scan(options.scan))
        pairs += [("scan", "ball")]
    rows = []
    for names in pairs:
        name = "-".join(names)
        if options.scenes and name not in options.scenes.split(","):
            continue
        for is_deep in (False, True):
            scene = Scene(*(shapes[each] for each in names), is_deep)
            solid = Solid(scene)
            for library in LIBRARIES:
                if options.libraries and library.name not in options.libraries.split(","):
                    continue
                where = [name, "deep" if is_deep else "apart", len(scene.tetrahedra), library.name]
                if is_deep and library is IpcToolkit:
                    version = importlib.metadata.version("ipctk")
                    rows.append([*where, version, library.settings, "does not apply", *4 * [""]])
                    continue
                its, parted, depth, inverted, spent, after = run(library, scene, solid)
                rows.append([*where, its.version, its.settings, parted, depth, inverted, f"{spent:.3g}",
                             "" if after is None else f"{after:.3g}"])
                print(*rows[-1], sep=", ", file=sys.stderr)
    out = sys.stdout if options.csv == "-" else open(options.csv, "w", newline="", encoding="utf-8")
    with out:
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow(HEAD)
        writer.writerows(rows)


if __name__ == "__main__":
    main()
