# SPDX-License-Identifier: MIT OR Apache-2.0
"""A step's contact on the unknowns that a simulator solves for."""

from __future__ import annotations

from dataclasses import astuple, dataclass
from typing import Any, Sequence

import numpy as np
from numpy.typing import NDArray

from ._header import ContactSystemOptions
from ._library import NULL, Array, Doubles, Unpack, alike, answer, call, call_for, copied, copy_of, create, ffi
from ._library import indices, library, numbers, options, packed, to_write
from .scene import Contacts, Scene, filled

Weights = tuple[Array, Array, Array]


@dataclass(frozen=True)
class Material:
    """A surface: N/m³, s, Coulomb's coefficient, the depth in m of the most force in a step, restitution, 0 to 1."""

    stiffness: float
    damping_time: float = 0.05
    friction: float = 0.5
    depth_cap: float = float("inf")
    restitution: float = 0.0

    @classmethod
    def bearing(cls, pressure: float, depth: float) -> Material:
        """One that bears `pressure` (Pa) at `depth` (m); for rigid bodies ten times those at rest and allowed."""
        return material_by(library.rayc_bearing_material, pressure, depth)

    @classmethod
    def elastic(cls, youngs_modulus: float, poissons_ratio: float, element_edge: float) -> Material:
        """That of an elastic body with elements of this edge (m): it bears its modulus at a fortieth of the edge."""
        return material_by(library.rayc_elastic_material, youngs_modulus, poissons_ratio, element_edge)


def material_by(function: Any, *given: float) -> Material:
    found = answer(function, *given, ffi.sizeof("rayc_material"))
    return Material(*(getattr(found, name) for name in Material.__annotations__))


def struct_of(material: Material | None) -> Any:
    """The C struct; NULL for none."""
    return NULL if material is None else ffi.new("rayc_material *", (ffi.sizeof("rayc_material"), *astuple(material)))


class ContactSystem:
    """What a simulator needs of contact beyond forces: rows that only push, on the host's own unknowns, friction that
    holds, rigid bodies, skins on cages, floors. Options: see ContactSystemOptions.

    A step: set_motion() for bodies that are not deformable, begin(); a solve with add_forces() and add_product(), then
    linearise() and detect_again(), as often as needed; finish(). SI units. Unknowns are x, y, z of each node, in any
    shape, then six numbers of each rigid body that is kept, used where they lie if packed and all of one float type."""

    def __init__(self, **system_options: Unpack[ContactSystemOptions]) -> None:
        self._handle = create("contact_system", options("contact_system", system_options))

    def set_node_masses(self, masses: Array) -> None:
        """The mass of each node in kg, infinity for one held fast; before bodies that have these nodes are added."""
        (m,) = alike("masses", masses, dtype=np.float64)
        call(library.rayc_contact_system_set_node_masses, self._handle, m.size, m)

    def add_deformable(
        self, scene: Scene, body: int, first: int, count: int, material: Material, weights: Weights | None = None
    ) -> None:
        """Adds a body of the scene with `count` nodes: one for each vertex, or by offsets, nodes and weights of each."""
        table: Any = (NULL, 0, NULL, NULL)
        if weights is not None:
            offsets, nodes = indices(weights[0], "offsets"), indices(weights[1], "nodes")
            table = offsets, nodes.size, nodes, numbers(weights[2], "weights", nodes.size)
        given = scene._handle, body, first, count, *table, struct_of(material)
        call(library.rayc_contact_system_add_deformable, self._handle, *given)

    def add_rigid(self, scene: Scene, body: int, mass: float, inertia: Array, material: Material) -> None:
        """Adds a rigid body: mass in kg, inertia in kg m², (3, 3), about the origin of the mesh, its centre of mass."""
        given = scene._handle, body, mass, numbers(inertia, "inertia", 9), struct_of(material)
        call(library.rayc_contact_system_add_rigid, self._handle, *given)

    def add_moved(self, scene: Scene, body: int, material: Material) -> None:
        """Adds a body that stands still or that the host moves."""
        call(library.rayc_contact_system_add_moved, self._handle, scene._handle, body, struct_of(material))

    def add_half_space(self, normal: Array, offset: float, material: Material) -> None:
        """Adds a floor, solid where normal · x < offset."""
        given = numbers(normal, "normal", 3), offset, struct_of(material)
        call(library.rayc_contact_system_add_half_space, self._handle, *given)

    def remove_body(self, body: int) -> None:
        """Removes a body from the system; to be removed from the scene too."""
        call(library.rayc_contact_system_remove_body, self._handle, body)

    def set_pair_material(self, a: int, b: int, material: Material | None) -> None:
        """Gives two bodies a material of their own in place of the combined one; None takes it back."""
        call(library.rayc_contact_system_set_pair_material, self._handle, a, b, struct_of(material))

    def set_half_space_material(self, body: int, half_space: int, material: Material | None) -> None:
        """The same for a body and a half-space, counted in the order they were added."""
        call(library.rayc_contact_system_set_half_space_material, self._handle, body, half_space, struct_of(material))

    def set_motion(self, body: int, position: Array, rotation: Array, velocity: Array, free_velocity: Array) -> None:
        """Where a rigid or moved body is, (3,) and (3, 3); both velocities, (6,), now and without contact at the end."""
        x, v = {"position": (position, 3), "rotation": (rotation, 9)}, {"free_velocity": (free_velocity, 6)}
        call(library.rayc_contact_system_set_motion, self._handle, body, packed(**x, velocity=(velocity, 6), **v))

    def unknown_count(self) -> int:
        """How many numbers a vector of unknowns has."""
        return int(answer(library.rayc_contact_system_unknown_count, self._handle))

    def _ask(self, name: str, velocities: Array, *given: Any, ask: Any = answer) -> Any:
        (v,) = alike("velocities", velocities)
        return ask(call_for(name, v), self._handle, *given, v.size, v)

    def begin(self, scene: Scene, dt: float, positions: Array, velocities: Array, free_velocities: Array) -> None:
        """Begins a step of dt seconds: positions and velocities at its start, and velocities at its end without contact."""
        x, v, free = alike("positions velocities free_velocities", positions, velocities, free_velocities)
        call(call_for("begin", x), self._handle, scene._handle, dt, x.size, x, v, free)

    def add_forces(self, velocities: Array, forces: NDArray[Any]) -> None:
        """Adds the contact forces to `forces`, in N."""
        f = to_write(forces, "forces", is_packed=True)
        call(call_for("add_forces", f), self._handle, f.size, numbers(velocities, "velocities", f.size, f.dtype), f)

    def add_product(self, factor: float, change: Array, result: NDArray[Any]) -> None:
        """Adds factor · (−∂force/∂velocity) · change to `result`; the matrix is positive semi-definite."""
        r = to_write(result, "result", is_packed=True)
        call(call_for("add_product", r), self._handle, factor, r.size, numbers(change, "change", r.size, r.dtype), r)

    def blocks(self, factor: float) -> tuple[NDArray[np.uint32], NDArray[np.uint32], Doubles]:
        """The same matrix in blocks, those of equal place to be added: rows (n,), columns (n,), blocks (n, 3, 3)."""
        count = answer(library.rayc_contact_system_block_count, self._handle)
        found = np.empty(count, np.uint32), np.empty(count, np.uint32), np.empty((count, 3, 3))
        call(library.rayc_contact_system_copy_blocks, self._handle, factor, count, *found)
        return found

    def csr(self, factor: float = 1.0) -> tuple[Doubles, NDArray[np.int32], NDArray[np.int32]]:
        """The same matrix as scipy.sparse.csr_array(system.csr(), shape) takes it: numbers, columns, where rows begin."""
        m = answer(library.rayc_contact_system_csr, self._handle, factor)
        return copy_of(m.values, m.value_count), copy_of(m.columns, m.value_count), copy_of(m.offsets, m.row_count + 1)

    def energy(self, velocities: Array) -> float:
        """The potential of the rows, in J. Forces are its negative gradient by the positions at the end of the step."""
        return float(self._ask("energy", velocities))

    def potential(self, scene: Scene, velocities: Array, part: float = 1.0) -> float:
        """The energy stored after a part of the step at these velocities, in J, with contacts looked for there."""
        v = numbers(velocities, "velocities")
        return float(answer(library.rayc_contact_system_potential, self._handle, scene._handle, v.size, v, part))

    def linearise(self, velocities: Array) -> float:
        """Decides anew which rows push and rub; returns the part of all force predicted wrongly: above 0.05 solve again."""
        return float(self._ask("linearise", velocities))

    def misjudged(self, velocities: Array) -> float:
        """What linearise() would return; the rows stay as they are."""
        return float(self._ask("misjudged", velocities))

    def detect_again(self, scene: Scene, velocities: Array) -> bool:
        """Looks whether bodies that were stopped are in the way of others; True: another solve is due."""
        return bool(self._ask("detect_again", velocities, scene._handle))

    def finish(self, velocities: Array) -> None:
        """Ends the step with these velocities: loads and what friction holds on to are remembered."""
        self._ask("finish", velocities, ask=call)

    def cancel(self) -> None:
        """Ends the step as if it had not begun, but for the positions of the scene's bodies."""
        call(library.rayc_contact_system_cancel, self._handle)

    def contacts(self) -> Contacts:
        """A copy of the contacts of the last detection."""
        return filled(None, library.rayc_contact_system_copy_contacts, self._handle)

    def pair_force(self, body: int, other: int, is_half_space: bool = False) -> Doubles:
        """The net force, in N, of another body or a half-space on a body in the last finished step: (3,)."""
        return copied(library.rayc_contact_system_pair_force, 3, self._handle, body, other, is_half_space)

    def rigid_velocity(self, body: int) -> Doubles:
        """Linear and angular velocity of a rigid body at the end of the last finished step: (6,)."""
        return copied(library.rayc_contact_system_rigid_velocity, 6, self._handle, body)

    def explicit_step(self, scene: Scene, dt: float, positions: Array, velocities: Array, forces: Any) -> float:
        """For explicit integrators: adds contact forces; returns the longest step in s for which they are stable."""
        f = to_write(forces, "forces", is_packed=True)
        x, v = alike("positions velocities", positions, velocities, dtype=f.dtype)
        return float(answer(call_for("explicit_step", f), self._handle, scene._handle, dt, x.size, x, v, f.size, f))


class Batch:
    """Many scenes, such as those of robot learning, in one call, on the threads of the first one (option `threads`).
    Each gets the same bits as by itself. Arrays have a row for each scene. Where some have an error, others are done
    nevertheless: Error is that of the first, and `statuses` has the Status of each in the last call."""

    def __init__(self, scenes: Sequence[Scene], systems: Sequence[ContactSystem] = ()) -> None:
        self.contacts, self.statuses = [Contacts() for _ in scenes], np.zeros(len(scenes), np.uint32)
        self._kept: Any = {"contact_system": [*systems], "scene": [*scenes], "contacts": [*self.contacts]}
        self._handles = [ffi.new(f"rayc_{name} *[]", [x._handle for x in each]) for name, each in self._kept.items()]

    def query(self) -> None:
        """Scene.query() of each scene, into `contacts`, a list of one Contacts for each."""
        call(library.rayc_scenes_query, len(self.statuses), *self._handles[1:], self.statuses)

    def begin(self, dt: float, positions: Array, velocities: Array, free_velocities: Array) -> None:
        """ContactSystem.begin() of each system."""
        names = "positions velocities free_velocities"
        self._call("begin", alike(names, positions, velocities, free_velocities, dtype=np.float64), dt)

    def detect_again(self, velocities: Array) -> NDArray[np.bool_]:
        """ContactSystem.detect_again() of each system."""
        is_more = np.zeros(len(self.statuses), np.uint32)
        self._call("detect_again", [*alike("velocities", velocities, dtype=np.float64), is_more])
        return np.not_equal(is_more, 0)

    def _call(self, name: str, arrays: list[NDArray[Any]], *given: Any) -> None:
        count, rows = len(self._kept["contact_system"]), [array.shape[:1] for array in arrays]
        if {(count,), *rows} != {self.statuses.shape}:
            raise ValueError(f"{len(self.statuses)} scenes have {count} systems and {rows} rows; give equally many")
        given = *self._handles[:2], *given, arrays[0].size // max(count, 1), *arrays, self.statuses
        call(getattr(library, f"rayc_contact_systems_{name}"), count, *given)
