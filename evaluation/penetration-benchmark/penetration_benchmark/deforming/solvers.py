# SPDX-License-Identifier: MIT OR Apache-2.0
"""Each library in its own solver, or in one that its users write."""

import ctypes
import dataclasses
import importlib.metadata
import os

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from .scenes import SPEED
from .solid import DENSITY, POISSON, YOUNG, Solid

# How often they are asked where the nodes are, in seconds.
FRAME = 0.01
MOST_ITERATIONS = 50
# Of held nodes in the hosts below, in parts of what they have.
HELD_MASS = 1e4


def text(array):
    return " ".join(map(repr, np.asarray(array).ravel().tolist()))


class Solver:
    """A scene in a library's own solver. `stiffnesses`: what it declares, by what they are called; the documented one
    first. `x` is where the nodes are."""

    name, package, module = "", "", ""
    stiffnesses: dict = {"": None}
    time_steps: tuple = (FRAME,)
    # Whether a start may overlap by the library's contract.
    may_overlap = True

    def __init__(self, scene, stiffness, time_step):
        self.scene, self.solid, self.time_step, self.time = scene, Solid(scene), time_step, 0.0
        self.x, self.v = scene.rest.copy(), scene.velocities.copy()
        self.fixed, self.pushed = np.asarray(scene.fixed, int), np.asarray(scene.pushed, int)
        self.held = np.concatenate([self.fixed, self.pushed])
        self.build(stiffness)

    @classmethod
    def version(cls):
        return importlib.metadata.version(cls.package)

    def build(self, stiffness):
        raise NotImplementedError

    def step(self):
        """Timed."""
        raise NotImplementedError

    def advance(self):
        """By one frame."""
        for _ in range(round(FRAME / self.time_step)):
            self.step()
            self.time += self.time_step

    def free(self):
        """The velocities that nodes would have without forces of contact and elasticity."""
        free = self.v - [self.time_step * self.scene.gravity, 0, 0]
        free[self.held] = 0
        free[self.pushed, 0] = self.scene.pushed_speed(self.time)
        return free

    def heavy(self):
        """The mass of each number, held nodes heavy."""
        mass = self.solid.mass.copy()
        mass[self.held] *= HELD_MASS
        return np.repeat(mass, 3)


class Raycontact(Solver):
    name, package, module = "raycontact", "raycontact", "raycontact"
    stiffnesses = {"elastic": 1.0, "elastic × 10": 10.0, "elastic / 10": 0.1}

    def build(self, stiffness):
        import raycontact

        self.contact, self.system = raycontact.Scene(), raycontact.ContactSystem()
        mass = self.solid.mass.copy()
        mass[self.held] = np.inf
        self.system.set_node_masses(mass)
        for body, first in zip(self.scene.bodies, self.scene.firsts):
            used = int(body.triangles.max()) + 1
            number = self.contact.add(raycontact.Mesh(body.points[:used], body.triangles))
            edge = np.linalg.norm(body.points[body.triangles[:, 0]] - body.points[body.triangles[:, 1]], axis=1).mean()
            material = raycontact.Material.elastic(YOUNG, POISSON, edge)
            material = dataclasses.replace(material, stiffness=stiffness * material.stiffness, friction=0.0)
            self.system.add_deformable(self.contact, number, int(first), used, material)

    def step(self):
        solid, system, mass, dt = self.solid, self.system, self.heavy(), self.time_step
        free = v = self.free()
        system.begin(self.contact, dt, self.x, self.v, free)
        for _ in range(6):
            there = self.x + dt * v
            forces = -solid.slope(there)
            system.add_forces(v, forces)
            contact = sparse.csr_array(system.csr(), shape=solid.shape)
            matrix = sparse.diags_array(mass) + dt * contact + dt ** 2 * solid.curvature(there)
            change = splu(matrix.tocsc()).solve(dt * forces.ravel() - mass * (v - free).ravel())
            v = v + change.reshape(v.shape)
            is_wrong = system.linearise(v) > 0.01
            is_small = np.abs(change).max() < 1e-3 * SPEED
            if not system.detect_again(self.contact, v) and not is_wrong and is_small:
                break
        system.finish(v)
        self.x, self.v = self.x + dt * v, v


class IpcToolkit(Solver):
    name, package, module, may_overlap = "IPC Toolkit", "ipctk", "ipctk", False
    stiffnesses = {"adaptive": None}

    def build(self, stiffness):
        import ipctk

        self.ipctk = ipctk
        ipctk.set_num_threads(1)
        ipctk.set_logger_level(ipctk.LoggerLevel.off)
        rest, triangles = np.asfortranarray(self.x), np.asfortranarray(self.scene.triangles, np.int32)
        self.mesh = ipctk.CollisionMesh.build_from_full_mesh(rest, ipctk.edges(triangles), triangles)
        # No body touches itself, as with the others.
        numbers = np.repeat(np.arange(len(self.scene.bodies), dtype=np.int32), np.diff(self.scene.firsts))
        outer = [self.mesh.to_full_vertex_id(i) for i in range(self.mesh.num_vertices)]
        self.mesh.can_collide = ipctk.make_vertex_patches_filter(numbers[outer])
        self.diagonal = np.linalg.norm(np.ptp(rest, axis=0))
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
        inertia = (self.heavy() * (x - aim).ravel() ** 2).sum() / 2
        return inertia + self.time_step ** 2 * (
            self.solid.energy(x) + self.potential()(found, self.mesh, self.outer(x)))

    def step(self):
        ipctk, solid, mass, dt = self.ipctk, self.solid, self.heavy(), self.time_step
        aim, x = self.x + dt * self.free(), self.x.copy()
        # Its default, tight inclusion, takes long where boxes have parallel sides.
        search = ipctk.AdditiveCCD(max_iterations=100_000)
        found = self.collisions(x)
        for _ in range(MOST_ITERATIONS):
            elastic = solid.slope(x).ravel() * dt ** 2 + mass * (x - aim).ravel()
            if self.stiffness is None and not found.empty():
                push = self.mesh.to_full_dof(self.potential().gradient(found, self.mesh, self.outer(x)))
                self.stiffness, self.most = ipctk.initial_barrier_stiffness(
                    self.diagonal, self.barrier, self.reach, float(solid.mass.mean()), elastic / dt ** 2, push)
            potential = self.potential()
            push = self.mesh.to_full_dof(potential.gradient(found, self.mesh, self.outer(x)))
            bend = self.mesh.to_full_dof(potential.hessian(
                found, self.mesh, self.outer(x), ipctk.PSDProjectionMethod.CLAMP))
            matrix = sparse.diags_array(mass) + dt ** 2 * (solid.curvature(x) + sparse.csc_array(bend))
            way = -splu(matrix.tocsc()).solve(elastic + dt ** 2 * push).reshape(x.shape)
            if np.abs(way).max() < 1e-3 * SPEED * dt:
                break
            part = ipctk.compute_collision_free_stepsize(
                self.mesh, self.outer(x), self.outer(x + way), narrow_phase_ccd=search)
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
        self.x, self.v = x, (x - self.x) / dt


class Mujoco(Solver):
    name, package, module = "MuJoCo", "mujoco", "mujoco"
    stiffnesses = {"solref 0.02": 0.02, "solref 0.01": 0.01, "solref 0.005": 0.005}
    time_steps = (0.002,)

    def build(self, stiffness):
        import mujoco

        self.mujoco, parts = mujoco, []
        for i, body in enumerate(self.scene.bodies):
            mass = self.solid.mass[self.scene.firsts[i]:self.scene.firsts[i + 1]].sum()
            parts.append(
                f'<flexcomp name="b{i}" type="direct" dim="3" radius="0.001" mass="{mass}" '
                f'point="{text(body.points)}" element="{text(body.tetrahedra)}">'
                f'<contact selfcollide="none" condim="1" solref="{stiffness} 1"/>'
                f'<elasticity young="{YOUNG}" poisson="{POISSON}" damping="0.005"/></flexcomp>')
        self.model = mujoco.MjModel.from_xml_string(
            f'<mujoco><option gravity="{-self.scene.gravity} 0 0" integrator="discrete" timestep="{self.time_step}"/>'
            f'<size memory="1G"/><worldbody>{"".join(parts)}</worldbody></mujoco>')
        held = self.model.flex_vertbodyid[self.held]
        self.model.body_mass[held] *= HELD_MASS
        self.model.body_inertia[held] *= HELD_MASS
        self.data = mujoco.MjData(self.model)
        mujoco.mj_setConst(self.model, self.data)
        self.data.qvel[:] = self.v.ravel()
        mujoco.mj_forward(self.model, self.data)

    def step(self):
        speeds, gone = self.data.qvel.reshape(-1, 3), self.data.qpos.reshape(-1, 3)
        speeds[self.held], gone[self.held, 1:], gone[self.fixed] = self.free()[self.held], 0, 0
        self.mujoco.mj_step(self.model, self.data)
        self.x = self.data.flexvert_xpos.copy()


class Bullet(Solver):
    name = "Bullet"
    # In place of a stiffness its margin, since its contact sees only what lies that near a face.
    stiffnesses = {"margin 0.001": 0.001, "margin 0.01": 0.01, "margin 0.1": 0.1}
    OWN_STEP = 1 / 240

    @classmethod
    def version(cls):
        return "3.24"

    def build(self, stiffness):
        self.library = ctypes.CDLL(os.path.join(os.environ["PENETRATION_BUILD"], "bullet_soft.so"))
        number, pointer, count = ctypes.c_double, ctypes.c_void_p, ctypes.c_int
        self.library.bullet_soft_begin.argtypes = [number] * 3
        self.library.bullet_soft_add.argtypes = [pointer] * 3 + [count, pointer, count, number]
        self.library.bullet_soft_push.argtypes = [pointer, count, number]
        self.library.bullet_soft_step.argtypes = [number, count]
        self.library.bullet_soft_read.argtypes = [pointer]
        self.library.bullet_soft_begin(YOUNG, POISSON, self.scene.gravity)
        mass = self.solid.mass.copy()
        # As it marks what does not move by itself.
        mass[self.held] = 0
        for body, *arrays in zip(self.scene.bodies, *map(self.scene.parts, (self.x, self.v, mass))):
            arrays = [np.ascontiguousarray(array) for array in arrays]
            tetrahedra = np.ascontiguousarray(body.tetrahedra, np.intc)
            self.library.bullet_soft_add(*(array.ctypes.data for array in arrays), len(body.points),
                                         tetrahedra.ctypes.data, len(tetrahedra), stiffness)

    def step(self):
        pushed = np.ascontiguousarray(self.pushed, np.intc)
        self.library.bullet_soft_push(pushed.ctypes.data, len(pushed), self.scene.pushed_speed(self.time))
        # Two or three of its own steps for each hundredth.
        steps = round((self.time + FRAME) / self.OWN_STEP) - round(self.time / self.OWN_STEP)
        self.library.bullet_soft_step(self.OWN_STEP, steps)
        self.library.bullet_soft_read(self.x.ctypes.data)


class Drake(Solver):
    name, package, module = "Drake", "drake", "pydrake"
    # Between deformable bodies its stiffness is fixed; what it declares is Hunt and Crossley's dissipation.
    stiffnesses = {"dissipation 10": 10.0, "dissipation 0.5": 0.5, "dissipation 0.1": 0.1}
    time_steps = (FRAME, 0.001)

    def build(self, stiffness):
        import pydrake.all as drake

        builder = drake.DiagramBuilder()
        config = drake.MultibodyPlantConfig(time_step=self.time_step, discrete_contact_approximation="lagged")
        plant, _ = drake.AddMultibodyPlant(config, builder)
        plant.mutable_gravity_field().set_gravity_vector([-self.scene.gravity, 0, 0])
        self.model, self.made = plant.mutable_deformable_model(), []
        for body in self.scene.bodies:
            name = f"b{len(self.made)}"
            lines = ["# vtk DataFile Version 3.0", name, "ASCII", "DATASET UNSTRUCTURED_GRID",
                     f"POINTS {len(body.points)} double", *map(text, body.points),
                     f"CELLS {len(body.tetrahedra)} {5 * len(body.tetrahedra)}",
                     *("4 " + text(corners) for corners in body.tetrahedra),
                     f"CELL_TYPES {len(body.tetrahedra)}", *["10"] * len(body.tetrahedra)]
            file = drake.MemoryFile("\n".join(lines) + "\n", ".vtk", name)
            shape = drake.Mesh(drake.InMemoryMesh(mesh_file=file))
            made, properties = drake.GeometryInstance(drake.RigidTransform(), shape, name), drake.ProximityProperties()
            drake.AddContactMaterial(stiffness, None, drake.CoulombFriction(0, 0), properties)
            made.set_proximity_properties(properties)
            solid = drake.DeformableBodyConfig()
            solid.set_youngs_modulus(YOUNG)
            solid.set_poissons_ratio(POISSON)
            solid.set_mass_density(DENSITY)
            self.made.append(self.model.RegisterDeformableBody(made, solid, 1.0))
        if len(self.fixed):
            highest = self.x[self.fixed, 0].max() + 1e-6
            self.model.SetWallBoundaryCondition(self.made[0], np.array([highest, 0, 0]), np.array([1.0, 0, 0]))
        self.joint = None
        if len(self.pushed):
            # A heavy body on a rail has all nodes in a box that begins at the lowest of the pushed ones.
            inertia = drake.SpatialInertia.SolidBoxWithMass(1e7, 1, 1, 1)
            press = plant.AddRigidBody("press", inertia)
            rail = drake.PrismaticJoint("rail", plant.world_frame(), press.body_frame(), [1, 0, 0])
            self.joint = plant.AddJoint(rail)
            middle = drake.RigidTransform([self.x[self.pushed, 0].min() - 1e-6 + 5, 0, 0])
            self.model.AddFixedConstraint(self.made[-1], press, drake.RigidTransform(), drake.Box(10, 10, 10), middle)
        plant.Finalize()
        self.simulator = drake.Simulator(builder.Build())
        self.context = plant.GetMyMutableContextFromRoot(self.simulator.get_mutable_context())
        for made, speeds in zip(self.made, self.scene.parts(self.v)):
            self.model.SetVelocities(self.context, made, np.asfortranarray(speeds.T))
        self.simulator.Initialize()

    def advance(self):
        if self.joint:
            self.joint.set_translation_rate(self.context, self.scene.pushed_speed(self.time))
        self.time += FRAME
        # A whole number of steps to the last bit; else one more is made.
        self.simulator.AdvanceTo(round(self.time / self.time_step) * self.time_step)
        self.x = np.vstack([self.model.GetPositions(self.context, made).T for made in self.made])


LIBRARIES = (Raycontact, IpcToolkit, Mujoco, Bullet, Drake)
