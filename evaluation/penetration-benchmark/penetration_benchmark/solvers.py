# SPDX-License-Identifier: MIT OR Apache-2.0
"""The scenes of `simulate`, rigid bodies, each library in its own solver with its own documented settings.

Usage: python -m penetration_benchmark.solvers [--quick] [--share S] [--seed N] [--libraries NAMES] [CSV]

Starts apart (drop, impact) and deep starts (part) are never added. Bodies have a density of 1000 kg/m³, a size of 1 m
and Coulomb's coefficient 0.5; mass and inertia are the same for all. Each library has up to three declared
stiffnesses, or what it has in their place. That with which most scenes of seed 1 and the same start end well, at
steps of 1/60 s, is run on another seed, drawn when all are known. Time steps: 1/60 and 1/240 s, and the one of a
library's documentation. All else is a library's default, but for what its `settings` say.

Outcomes are those of `simulate`, by its judge, and *thrown*: parted, but faster than a shot. `depth` is how far the
body must be lifted at the end to be free of the ground or, where it was to part, the shortest way out, in its size.
`cost` is the processor's time of the steps, in seconds for a second, without building and judging."""

import argparse
import contextlib
import csv
import functools
import importlib.metadata
import importlib.util
import itertools
import os
import pathlib
import secrets
import sys
import tempfile
import time

from .__main__ import Progress  # before numpy: it sets the number of threads

import numpy as np  # isort: skip

from . import files, poses, shapes
from .c_library import SurfaceStruct
from .generate import generate
from .library import Surface
from .simulate import MOST_GAINED, REST_SECONDS, REST_SPEED, SECONDS, SPEEDS, Scene
from .tasks import group

TIME_STEPS = (1 / 60, 1 / 240)
DENSITY, FRICTION = 1000.0, 0.5
TUNED_SEED = 1
# How often a solver is asked where the bodies are, in seconds, and at every how many of these the judge.
FRAME, JUDGED = 1 / 60, 4
HEAD = ["phase", "scene", "kind", "shapes", "pair", "library", "version", "stiffness", "time_step", "outcome", "depth",
        "cost"]


@functools.lru_cache(maxsize=None)
def convex_parts(name):
    """By CoACD with its defaults, as (positions, triangles)."""
    with contextlib.suppress(ImportError):
        import pydrake.all  # noqa: F401, since it fails where CoACD was loaded before it
    import coacd

    coacd.set_log_level("off")
    positions, triangles = shapes.make(name)
    return coacd.run_coacd(coacd.Mesh(positions, triangles.astype(np.int32)))


def text(array):
    return " ".join(map(repr, np.asarray(array).ravel().tolist()))


class Solver:
    """A scene in a library's own solver. `stiffnesses`: by what they are called, the first is the documented one."""

    name, package, settings, documentation = "", "", "", ""
    modules: tuple = ()
    stiffnesses: dict = {"default": None}
    time_steps, own_step = TIME_STEPS, 1 / 60
    # Whether a start may overlap by the library's contract, and whether convex scenes are another row's.
    may_overlap, only_concave = True, False

    def __init__(self, scene, surfaces, stiffness, time_step):
        self.scene, self.surfaces, self.time_step = scene, surfaces, time_step
        self.masses = [DENSITY * body.mass for body in scene.bodies]
        self.inertias = [DENSITY * body.inertia for body in scene.bodies]
        self.moving = [i for i, body in enumerate(scene.bodies) if not body.is_fixed]
        self.build(stiffness)

    @classmethod
    def version(cls):
        return importlib.metadata.version(cls.package)

    def each(self):
        return zip(self.surfaces, self.scene.bodies, self.masses, self.inertias)

    def build(self, stiffness):
        raise NotImplementedError

    def advance(self, steps):
        """Timed."""
        raise NotImplementedError

    def read(self):
        """Puts the bodies of the scene where they are."""


class Raycontact(Solver):
    name, package, modules = "raycontact", "raycontact", ("raycontact",)
    settings = "contact system with implicit Euler and up to three solves; Material of a depth at rest"
    documentation = "docs/recipes.md"
    stiffnesses = {"depth 0.001": 1e-3, "depth 0.0001": 1e-4, "depth 0.00001": 1e-5}

    def build(self, stiffness):
        import raycontact

        self.raycontact = raycontact
        self.contact, self.system, self.numbers = raycontact.Scene(threads=1), raycontact.ContactSystem(), []
        self.system.set_node_masses([])
        for surface, body, mass, inertia in self.each():
            number = self.contact.add(raycontact.Mesh(body.rest, surface.triangles))
            pressure = self.masses[1] * 9.81 / self.scene.bodies[1].size ** 2
            material = raycontact.Material(pressure / stiffness, friction=FRICTION)
            if body.is_fixed:
                self.system.add_moved(self.contact, number, material)
            else:
                self.system.add_rigid(self.contact, number, mass, inertia, material)
            self.numbers.append(number)

    def advance(self, steps):
        nodes, pull = np.zeros(0), np.concatenate([self.time_step * self.scene.gravity, np.zeros(3)])
        for _ in range(steps):
            for body, number in zip(self.scene.bodies, self.numbers):
                free = body.velocity if body.is_fixed else body.velocity + pull
                self.system.set_motion(number, body.centre, body.rotation, body.velocity, free)
            self.system.begin(self.contact, self.time_step, nodes, nodes, nodes)
            for _ in range(3):
                is_wrong = self.system.linearise(nodes) > 0.01
                if not self.system.detect_again(self.contact, nodes) and not is_wrong:
                    break
            self.system.finish(nodes)
            for i in self.moving:
                self.scene.bodies[i].velocity = self.system.rigid_velocity(self.numbers[i])
                self.scene.bodies[i].move(self.time_step)


class Mujoco(Solver):
    name, package, modules = "MuJoCo", "mujoco", ("mujoco", "coacd")
    settings = "mj_step; concave bodies are geoms of type mesh of their convex parts by CoACD and the tray is a hfield"
    documentation = "https://mujoco.readthedocs.io/en/stable/modeling.html#solver-parameters"
    stiffnesses = {"solref 0.02": 0.02, "solref 0.01": 0.01, "solref 0.005": 0.005}
    own_step = 0.002

    def geoms(self, name, surface, body):
        """(assets, geoms) of one body, in its frame, with its centre of mass as the origin."""
        if surface.name == "tray":
            steps = np.array(list(itertools.product(range(shapes.TRAY[1] + 1), range(shapes.TRAY[0] + 1))))
            heights = shapes.tray_points([(x, y, shapes.TRAY[2]) for y, x in steps])[:, 2]
            low, up = heights.min(), np.ptp(heights)
            asset = (f'<hfield name="{name}" nrow="{shapes.TRAY[1] + 1}" ncol="{shapes.TRAY[0] + 1}" '
                     f'elevation="{text((heights - low) / up)}" size="1.5 1.5 {up} {low + 0.5}"/>')
            return asset, f'<geom type="hfield" hfield="{name}" pos="{text(np.array([0, 0, low]) - body.middle)}"/>'
        parts = [surface[1:3]] if surface.is_convex else convex_parts(surface.name)
        return ("".join(f'<mesh name="{name}{i}" vertex="{text(points - body.middle)}" face="{text(triangles)}"/>'
                        for i, (points, triangles) in enumerate(parts)),
                "".join(f'<geom type="mesh" mesh="{name}{i}"/>' for i in range(len(parts))))

    def build(self, stiffness):
        import mujoco

        self.mujoco = mujoco
        assets, bodies = [], []
        for name, (surface, body, mass, inertia) in zip("ab", self.each()):
            asset, geoms = self.geoms(name, surface, body)
            assets.append(asset)
            quaternion = np.zeros(4)
            mujoco.mju_mat2Quat(quaternion, body.rotation.ravel())
            full = inertia[[0, 1, 2, 0, 0, 1], [0, 1, 2, 1, 2, 2]]
            inner = "" if body.is_fixed else (
                f'<freejoint/><inertial pos="0 0 0" mass="{mass}" fullinertia="{text(full)}"/>')
            bodies.append(f'<body pos="{text(body.centre)}" quat="{text(quaternion)}">{inner}{geoms}</body>')
        self.model = mujoco.MjModel.from_xml_string(
            f'<mujoco><compiler inertiafromgeom="false"/>'
            f'<option gravity="{text(self.scene.gravity)}" timestep="{self.time_step}"/><size memory="256M"/>'
            f'<default><geom friction="{FRICTION} 0.005 0.0001" solref="{stiffness} 1"/></default>'
            f'<asset>{"".join(assets)}</asset><worldbody>{"".join(bodies)}</worldbody></mujoco>')
        self.data = mujoco.MjData(self.model)
        for slot, i in enumerate(self.moving):
            self.data.qvel[6 * slot:6 * slot + 3] = self.scene.bodies[i].velocity[:3]
        mujoco.mj_forward(self.model, self.data)

    def advance(self, steps):
        self.mujoco.mj_step(self.model, self.data, steps)

    def read(self):
        bad = self.mujoco.mjtWarning
        if any(self.data.warning[kind].number for kind in (bad.mjWARN_BADQPOS, bad.mjWARN_BADQVEL, bad.mjWARN_BADQACC)):
            # It has begun anew.
            raise FloatingPointError
        for slot, i in enumerate(self.moving):
            body, turn = self.scene.bodies[i], np.zeros(9)
            self.mujoco.mju_quat2Mat(turn, self.data.qpos[7 * slot + 3:7 * slot + 7])
            body.rotation, body.centre = turn.reshape(3, 3), self.data.qpos[7 * slot:7 * slot + 3].copy()
            # A free joint turns in the body's own frame.
            velocity = self.data.qvel[6 * slot:6 * slot + 6]
            body.velocity = np.concatenate([velocity[:3], body.rotation @ velocity[3:]])


class MujocoSdf(Mujoco):
    name = "MuJoCo with sdf"
    settings = "mj_step; geoms of type sdf with 40 starting points and 10 iterations"
    documentation = "https://mujoco.readthedocs.io/en/stable/XMLreference.html#body-geom-type"
    only_concave = True

    def geoms(self, name, surface, body):
        points = surface.positions - body.middle
        return (f'<mesh name="{name}" vertex="{text(points)}" face="{text(surface.triangles)}"/>',
                f'<geom type="sdf" mesh="{name}"/>')


class Drake(Solver):
    name, package, modules = "Drake", "drake", ("pydrake",)
    settings = ("MultibodyPlant with the discrete approximation lagged; compliant hydroelastic bodies of tetrahedra "
                "and a rigid one for the bowl; modulus 1e7 and dissipation 10; resolution hint 0.1")
    documentation = "https://drake.mit.edu/doxygen_cxx/group__hydroelastic__user__guide.html"
    # With the dissipation: bodies part with at most 1 / dissipation, in m/s.
    stiffnesses = {"modulus 1e7": (1e7, 10.0), "modulus 1e6": (1e6, 10.0), "dissipation 0.5": (1e7, 0.5)}
    own_step = 0.001

    @staticmethod
    @functools.lru_cache(maxsize=None)
    def shape(surface_name):
        from .libraries.drake import shape_of

        positions, triangles = shapes.make(surface_name)
        return shape_of(Surface(surface_name, positions, triangles, surface_name in shapes.CONVEX))[0]

    def build(self, stiffness):
        import pydrake.all as drake

        self.drake = drake
        builder = drake.DiagramBuilder()
        config = drake.MultibodyPlantConfig(time_step=self.time_step, discrete_contact_approximation="lagged")
        plant, _ = drake.AddMultibodyPlant(config, builder)
        plant.mutable_gravity_field().set_gravity_vector(self.scene.gravity)
        links = []
        for name, (surface, body, mass, inertia) in zip("ab", self.each()):
            properties = drake.ProximityProperties()
            drake.AddContactMaterial(stiffness[1], None, drake.CoulombFriction(FRICTION, FRICTION), properties)
            try:
                shape = self.shape(surface.name)
                drake.AddCompliantHydroelasticProperties(0.1, stiffness[0], properties)
            except ValueError:
                lines = [f"v {text(point)}" for point in surface.positions]
                lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in surface.triangles.tolist()]
                file = drake.MemoryFile("\n".join(lines) + "\n", ".obj", surface.name)
                shape = drake.Mesh(drake.InMemoryMesh(mesh_file=file))
                drake.AddRigidHydroelasticProperties(0.1, properties)
            pose = drake.RigidTransform(drake.RotationMatrix.ProjectToRotationMatrix(body.rotation), body.centre)
            offset = drake.RigidTransform(-body.middle)
            if body.is_fixed:
                link, place = plant.world_body(), pose @ offset
            else:
                moments = drake.RotationalInertia(*inertia.diagonal(), inertia[0, 1], inertia[0, 2], inertia[1, 2])
                link = plant.AddRigidBody(name, drake.SpatialInertia.MakeFromCentralInertia(mass, np.zeros(3), moments))
                place = offset
                plant.SetDefaultFloatingBaseBodyPose(link, pose)
            plant.RegisterCollisionGeometry(link, place, shape, name, properties)
            links.append(link)
        plant.Finalize()
        diagram = builder.Build()
        self.plant, self.links, self.steps = plant, links, 0
        self.simulator = drake.Simulator(diagram)
        self.context = plant.GetMyMutableContextFromRoot(self.simulator.get_mutable_context())
        for i in self.moving:
            velocity = drake.SpatialVelocity(np.zeros(3), self.scene.bodies[i].velocity[:3])
            plant.SetFreeBodySpatialVelocity(self.context, links[i], velocity)
        self.simulator.Initialize()

    def advance(self, steps):
        self.steps += steps
        self.simulator.AdvanceTo(self.steps * self.time_step)

    def read(self):
        for i in self.moving:
            body = self.scene.bodies[i]
            pose = self.plant.EvalBodyPoseInWorld(self.context, self.links[i])
            velocity = self.plant.EvalBodySpatialVelocityInWorld(self.context, self.links[i])
            body.rotation, body.centre = pose.rotation().matrix(), pose.translation()
            body.velocity = np.concatenate([velocity.translational(), velocity.rotational()])


class Bullet(Solver):
    name = "Bullet"
    settings = ("btDiscreteDynamicsWorld with its manifolds kept; concave bodies are btGImpactMeshShape and a concave "
                "ground btBvhTriangleMeshShape; margin 0.001; single precision")
    documentation = "https://github.com/bulletphysics/bullet3/blob/master/docs/Bullet_User_Manual.pdf"
    stiffnesses = {"erp 0.2": 0.2, "erp 0.1": 0.1, "erp 0.8": 0.8}
    HULLS, GIMPACT, STATIC_MESH = range(3)

    @classmethod
    def version(cls):
        return "3.24"

    def parts_of(self, surface, is_fixed):
        if surface.is_convex:
            return self.HULLS, [surface[1:3]]
        return (self.STATIC_MESH if is_fixed else self.GIMPACT), [surface[1:3]]

    def build(self, stiffness):
        import ctypes

        self.ctypes = ctypes
        self.library = ctypes.CDLL(os.path.join(os.environ["PENETRATION_BUILD"], "bullet.so"))
        self.library.bullet_step.argtypes = [ctypes.c_double, ctypes.c_int]
        doubles = lambda values: np.ascontiguousarray(values, float).ctypes.data_as(ctypes.c_void_p)  # noqa: E731
        self.library.bullet_begin(doubles(self.scene.gravity), ctypes.c_double(stiffness))
        self.frames, kept = [], []
        for surface, body, mass, inertia in self.each():
            # Bullet's bodies have their principal axes as their own.
            moments, frame = np.linalg.eigh(inertia)
            frame[:, 0] *= np.sign(np.linalg.det(frame))
            kind, parts = self.parts_of(surface, body.is_fixed)
            structs = (SurfaceStruct * len(parts))()
            for struct, (points, triangles) in zip(structs, parts):
                points = np.ascontiguousarray((points - body.middle) @ frame, float)
                triangles = np.ascontiguousarray(triangles, np.uint32)
                kept += [points, triangles]
                struct.positions, struct.triangles = points.ctypes.data, triangles.ctypes.data
                struct.vertex_count, struct.triangle_count = len(points), len(triangles)
                struct.is_convex = int(kind == self.HULLS)
            self.frames.append(frame)
            pose = np.column_stack([body.rotation @ frame, body.centre])
            self.library.bullet_add(structs, len(parts), kind, ctypes.c_double(0.0 if body.is_fixed else mass),
                                    doubles(moments), doubles(pose), doubles(body.velocity[:3]))

    def advance(self, steps):
        self.library.bullet_step(self.time_step, steps)

    def read(self):
        state = np.zeros((2, 18))
        self.library.bullet_read(state.ctypes.data_as(self.ctypes.c_void_p))
        for i in self.moving:
            body, pose = self.scene.bodies[i], state[i, :12].reshape(3, 4)
            body.rotation, body.centre = pose[:, :3] @ self.frames[i].T, pose[:, 3]
            body.velocity = state[i, 12:].copy()


class BulletParts(Bullet):
    name, modules = "Bullet with convex parts", ("coacd",)
    settings = ("btDiscreteDynamicsWorld with its manifolds kept; concave bodies are a btCompoundShape of their convex "
                "parts by CoACD and a concave ground btBvhTriangleMeshShape; margin 0.001; single precision")
    only_concave = True

    def parts_of(self, surface, is_fixed):
        is_split = not surface.is_convex and not is_fixed
        return (self.HULLS, convex_parts(surface.name)) if is_split else super().parts_of(surface, is_fixed)


class IpcToolkit(Solver):
    name, package, modules = "IPC Toolkit", "ipctk", ("ipctk", "scipy")
    settings = ("affine bodies of stiffness 1e8 Pa; Newton with additive CCD in the line search; barrier within 0.001 "
                "of the diagonal; adaptive stiffness; lagged friction")
    documentation = "https://ipctk.xyz/tutorials/getting_started.html"
    stiffnesses = {"adaptive": None}
    # Steps of 1/240 s would take as long as all other libraries together.
    time_steps, own_step, may_overlap = TIME_STEPS[:1], 0.01, False
    # Of a body's affine energy, in Pa.
    RIGIDITY, MOST_ITERATIONS = 1e8, 50

    def build(self, stiffness):
        import ipctk

        self.ipctk = ipctk
        ipctk.set_num_threads(1)
        ipctk.set_logger_level(ipctk.LoggerLevel.off)
        counts = [len(body.rest) for body in self.scene.bodies]
        first, second = (surface.triangles.astype(np.int32) for surface in self.surfaces)
        faces = np.vstack([first, second + counts[0]])
        self.start = np.vstack([body.positions() for body in self.scene.bodies])
        self.mesh = ipctk.CollisionMesh(np.asfortranarray(self.start), ipctk.edges(faces), np.asfortranarray(faces))
        self.mesh.can_collide = ipctk.make_vertex_patches_filter(np.repeat([0, 1], counts).astype(np.int32))
        # Points are these of bodies that stand still, and this matrix times twelve numbers of each that moves.
        are_fixed = np.repeat([body.is_fixed for body in self.scene.bodies], counts)[:, None]
        self.fixed = np.where(are_fixed, self.start, 0)
        self.jacobian = np.zeros((self.start.size, 12 * len(self.moving)))
        self.mass = np.zeros((12 * len(self.moving),) * 2)
        self.q, self.v, pull = [], [], []
        for slot, i in enumerate(self.moving):
            body, first, at = self.scene.bodies[i], 3 * sum(counts[:i]), 12 * slot
            moments = 0.5 * np.trace(self.inertias[i]) * np.eye(3) - self.inertias[i]
            for axis in range(3):
                rows = slice(first + axis, first + 3 * counts[i], 3)
                self.jacobian[rows, at + axis] = 1
                its = slice(at + 3 + 3 * axis, at + 6 + 3 * axis)
                self.jacobian[rows, its] = body.rest
                self.mass[at + axis, at + axis], self.mass[its, its] = self.masses[i], moments
            self.q += [body.centre, body.rotation.ravel()]
            self.v += [body.velocity[:3], np.zeros(9)]
            pull += [self.scene.gravity, np.zeros(9)]
        self.q, self.v, self.pull = map(np.concatenate, (self.q, self.v, pull))
        self.diagonal = np.linalg.norm(np.ptp(self.start, axis=0))
        self.reach = 1e-3 * self.diagonal
        self.friction = ipctk.FrictionPotential(1e-3 * self.diagonal)
        self.barrier, self.stiffness, self.most, self.before = ipctk.ClampedLogBarrier(), None, None, None

    def outer(self, q):
        return np.asfortranarray((self.jacobian @ q).reshape(-1, 3) + self.fixed)

    def collisions(self, x):
        found = self.ipctk.NormalCollisions()
        found.build(self.mesh, x, self.reach)
        return found

    def potential(self):
        return self.ipctk.BarrierPotential(self.reach, 1.0 if self.stiffness is None else self.stiffness)

    def shears(self, q):
        """(place, factor, affine part, its strain) of each body."""
        for slot, i in enumerate(self.moving):
            place = slice(12 * slot + 3, 12 * slot + 12)
            affine = q[place].reshape(3, 3)
            yield place, self.RIGIDITY * self.scene.bodies[i].mass, affine, affine.T @ affine - np.eye(3)

    def total(self, q, aim, before, found, rubbing):
        h, away, x = self.time_step, q - aim, self.outer(q)
        inner = sum(factor * (strain ** 2).sum() for _, factor, _, strain in self.shears(q))
        slip = self.friction(rubbing, self.mesh, np.asfortranarray((x - before) / h)) if not rubbing.empty() else 0.0
        push = self.potential()(found, self.mesh, x) if not found.empty() else 0.0
        return away @ self.mass @ away / 2 + h ** 2 * (inner + push + h * slip)

    def slope(self, q, aim):
        """Without the collisions, and its derivative."""
        h = self.time_step
        slope, matrix = self.mass @ (q - aim), self.mass.copy()
        for place, factor, affine, strain in self.shears(q):
            slope[place] += h ** 2 * 4 * factor * (affine @ strain).ravel()
            curved = (np.einsum("ik,lj->ijkl", np.eye(3), strain) + np.einsum("il,kj->ijkl", affine, affine)
                      + np.einsum("ik,lj->ijkl", affine @ affine.T, np.eye(3))).reshape(9, 9)
            values, vectors = np.linalg.eigh(curved)
            matrix[place, place] += h ** 2 * 4 * factor * (vectors * np.maximum(values, 0)) @ vectors.T
        return slope, matrix

    def step(self):
        ipctk, h, jacobian = self.ipctk, self.time_step, self.jacobian
        # Its default, tight inclusion, takes a quarter of a second for two boxes with parallel sides.
        search = ipctk.AdditiveCCD(max_iterations=100_000)
        q, before = self.q.copy(), self.outer(self.q)
        aim = q + h * self.v + h ** 2 * self.pull
        found, rubbing = self.collisions(before), ipctk.TangentialCollisions()
        if not found.empty():
            rubbing.build(self.mesh, before, found, self.potential(), FRICTION)
        for _ in range(self.MOST_ITERATIONS):
            x = self.outer(q)
            slope, matrix = self.slope(q, aim)
            if not found.empty():
                if self.stiffness is None:
                    push = jacobian.T @ self.potential().gradient(found, self.mesh, x)
                    average = sum(self.masses[i] for i in self.moving) / len(self.moving)
                    self.stiffness, self.most = ipctk.initial_barrier_stiffness(
                        self.diagonal, self.barrier, self.reach, average, slope / h ** 2, push)
                potential, psd = self.potential(), ipctk.PSDProjectionMethod.CLAMP
                slope = slope + h ** 2 * (jacobian.T @ potential.gradient(found, self.mesh, x))
                matrix += h ** 2 * (jacobian.T @ (potential.hessian(found, self.mesh, x, psd) @ jacobian))
            if not rubbing.empty():
                speeds = np.asfortranarray((x - before) / h)
                slope = slope + h ** 2 * (jacobian.T @ self.friction.gradient(rubbing, self.mesh, speeds))
                bend = self.friction.hessian(rubbing, self.mesh, speeds, ipctk.PSDProjectionMethod.CLAMP)
                matrix += h * (jacobian.T @ (bend @ jacobian))
            way = -np.linalg.solve(matrix, slope)
            there = self.outer(q + way)
            if np.abs(there - x).max() < 1e-3 * h:
                break
            part = ipctk.compute_collision_free_stepsize(self.mesh, x, there, narrow_phase_ccd=search)
            energy = self.total(q, aim, before, found, rubbing)
            while part > 1e-12:
                after = self.collisions(self.outer(q + part * way))
                if self.total(q + part * way, aim, before, after, rubbing) <= energy:
                    break
                part /= 2
            q, found = q + part * way, after
            nearest = found.compute_minimum_distance(self.mesh, self.outer(q)) if not found.empty() else np.inf
            if self.stiffness is not None and self.before is not None and np.isfinite(nearest):
                self.stiffness = ipctk.update_barrier_stiffness(
                    self.before, nearest, self.most, self.stiffness, self.diagonal)
            self.before = nearest if np.isfinite(nearest) else None
        self.q, self.v = q, (q - self.q) / h

    def advance(self, steps):
        for _ in range(steps):
            self.step()

    def read(self):
        for slot, i in enumerate(self.moving):
            body, q, v = self.scene.bodies[i], self.q[12 * slot:12 * slot + 12], self.v[12 * slot:12 * slot + 12]
            # Affine: the judge sees the very points.
            body.centre, body.rotation = q[:3].copy(), q[3:].reshape(3, 3).copy()
            spin = v[3:].reshape(3, 3) @ np.linalg.inv(body.rotation)
            body.velocity = np.concatenate([v[:3], 0.5 * np.array([spin[2, 1] - spin[1, 2], spin[0, 2] - spin[2, 0],
                                                                   spin[1, 0] - spin[0, 1]])])


LIBRARIES = (Raycontact, Mujoco, MujocoSdf, Drake, Bullet, BulletParts, IpcToolkit)


def run(library, surfaces, pose, stiffness, time_step, put_in):
    """(outcome, depth, cost)."""
    scene = Scene(surfaces, pose)
    solver = library(scene, surfaces, library.stiffnesses[stiffness], time_step)
    steps, gone, frames, calm, spent, moved = max(1, round(FRAME / time_step)), 0.0, 0, 0.0, 0.0, scene.bodies[1]
    try:
        while gone < SECONDS[pose.kind] - 1e-9:
            start = time.process_time()
            solver.advance(steps)
            spent += time.process_time() - start
            gone, frames = gone + steps * time_step, frames + 1
            solver.read()
            if not all(np.isfinite(part).all() for body in scene.bodies for part in (body.placement(), body.velocity)):
                raise FloatingPointError
            if pose.kind != "part" and (scene.energy() - scene.start) / put_in > MOST_GAINED:
                return "exploded", None, spent / gone
            calm = calm + steps * time_step if moved.speed() < REST_SPEED * moved.size else 0.0
            if pose.kind == "drop" and calm >= REST_SECONDS:
                break
            if pose.kind != "drop" and frames % JUDGED == 0 and scene.is_over():
                break
    except (FloatingPointError, RuntimeError):
        return "exploded", None, spent / max(gone, time_step)
    ended, depth = scene.outcome(calm >= REST_SECONDS)
    if pose.kind == "part" and ended == "done" and max(body.speed() for body in scene.bodies) > SPEEDS["impact"]:
        ended = "thrown"
    is_out = pose.kind == "part" and ended != "stuck"
    depth = 0.0 if is_out else scene.way_out() / moved.size if pose.kind == "part" else scene.lift()
    return ended, depth, spent / gone


def scenes(seed, share):
    """(pose, its two surfaces) of a share of the scenes of a seed, evenly among those of each kind."""
    with tempfile.TemporaryDirectory() as folder:
        generate(folder, seed, kinds=poses.SCENES)
        surfaces = {path.stem: files.read_shape(path) for path in pathlib.Path(folder, "shapes").glob("*.obj")}
        drawn = files.read_poses(pathlib.Path(folder, "poses.csv"))
    # Every so many; an odd number, since every other ground is a tray.
    every = round(1 / share) | 1
    by_kind = [[pose for pose in drawn if pose.kind == kind][::every] for kind in poses.SCENES]
    kept = itertools.chain(*zip(*by_kind))
    return [(pose, [surfaces[name] for name in pose.pair]) for pose in kept]


def measure(phase, drawn, runs, progress):
    """Rows of all scenes; runs: of each library its stiffnesses, by whether a scene starts deep, and time steps."""
    for done, (pose, surfaces) in enumerate(drawn):
        put_in, kind = Scene(surfaces, pose).put_in(), group(surfaces)
        for library, (stiffnesses, time_steps) in runs.items():
            if library.only_concave and kind == "convex":
                continue
            what = [phase, pose.id, pose.kind, kind, "-".join(pose.pair), library.name, library.version()]
            for stiffness, time_step in itertools.product(stiffnesses[pose.kind == "part"], time_steps):
                given = [*what, stiffness, f"1/{round(1 / time_step)}"]
                if pose.kind == "part" and not library.may_overlap:
                    yield [*given, "does not apply", "", ""]
                    continue
                ended, depth, cost = run(library, surfaces, pose, stiffness, time_step, put_in)
                yield [*given, ended, "" if depth is None else f"{depth:.3g}", f"{cost:.3g}"]
        progress(done + 1, len(drawn))


def best_stiffness(library, is_deep, rows):
    """That with which most scenes of this start end well; of equals the first declared."""
    well = dict.fromkeys(library.stiffnesses, 0)
    for row in (dict(zip(HEAD, row)) for row in rows):
        if row["library"] == library.name and (row["kind"] == "part") == is_deep:
            well[row["stiffness"]] += row["outcome"] == "done"
    return max(well, key=well.get)


def is_installed(library):
    is_built = library.package or os.path.exists(os.path.join(os.environ.get("PENETRATION_BUILD", ""), "bullet.so"))
    return bool(is_built) and all(importlib.util.find_spec(name) for name in library.modules)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("csv", nargs="?", default="-", help="where the figures go (default: printed)")
    parser.add_argument("--libraries", default="", metavar="NAMES",
                        help="with / between (default: all that are installed of "
                        f"{'/'.join(library.name for library in LIBRARIES)})")
    parser.add_argument("--share", type=float, default=0.25, help="of the 26 scenes of each kind (default: 0.25)")
    parser.add_argument("--seed", type=int, help="of the scenes that count (default: drawn once stiffnesses are known)")
    parser.add_argument("--quick", action="store_true", help="two scenes of each kind at 1/60 s, stiffnesses not tuned")
    options = parser.parse_args()
    if not options.share > 0:
        parser.error(f"a share of {options.share} has no scenes; give a number above 0")
    names = options.libraries.split("/") if options.libraries else [library.name for library in LIBRARIES]
    unknown = set(names) - {library.name for library in LIBRARIES}
    if unknown:
        parser.error(f"there is no library '{unknown.pop()}'; see --help")
    taking_part = [library for library in LIBRARIES if library.name in names and is_installed(library)]
    for name in names:
        if name not in [library.name for library in taking_part]:
            print(f"{name} is left out: not installed", file=sys.stderr)
    taken = {library: [next(iter(library.stiffnesses))] * 2 for library in taking_part}
    out = sys.stdout if options.csv == "-" else open(options.csv, "w", newline="", encoding="utf-8")
    with out:
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow(HEAD)
        if not options.quick:
            tuned = {library: ([library.stiffnesses] * 2, TIME_STEPS[:1]) for library in taking_part
                     if len(library.stiffnesses) > 1}
            rows = list(measure("tuned", scenes(TUNED_SEED, options.share / 2), tuned, Progress("tuning")))
            writer.writerows(rows)
            taken.update((library, [best_stiffness(library, is_deep, rows) for is_deep in (False, True)])
                         for library in tuned)
        seed = secrets.randbelow(10**6) if options.seed is None else options.seed
        steps = {library: TIME_STEPS[:1] if options.quick else dict.fromkeys((*library.time_steps, library.own_step))
                 for library in taking_part}
        runs = {library: ([[one] for one in taken[library]], steps[library]) for library in taking_part}
        drawn = scenes(seed, 1 / 13 if options.quick else options.share)
        for row in measure(f"seed {seed}", drawn, runs, Progress("scenes")):
            writer.writerow(row)
            out.flush()


if __name__ == "__main__":
    main()
