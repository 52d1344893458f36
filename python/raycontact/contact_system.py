# SPDX-License-Identifier: MIT OR Apache-2.0
"""A step's contact on the unknowns that a simulator solves for."""

from __future__ import annotations

from dataclasses import astuple, dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._arrays import Array, Doubles, Unpack, counted, indices, numbers, packed, to_write
from ._ffi import ffi
from ._header import ContactSystemOptions
from ._library import NULL, answer, call, copied, create, library, options
from .contacts import Contacts
from .scene import Scene

Weights = tuple[Array, Array, Array]


@dataclass(frozen=True)
class Material:
    """How a surface bears load, damps and rubs: N/m³, s, Coulomb's coefficient, and the depth in m beyond which one
    step asks for no more force than there. Material.bearing() suggests values."""

    stiffness: float
    damping_time: float = 0.05
    friction: float = 0.5
    depth_cap: float = float("inf")

    @classmethod
    def bearing(cls, pressure: float, depth: float) -> Material:
        """One that bears `pressure` in Pa at `depth` in m: of an elastic body, a quarter of Young's modulus at a
        quarter of its elements' edge; of a rigid or still one, ten times the pressure at rest at ten times the depth
        to which bodies may sink in."""
        found = answer(library.rayc_bearing_material, pressure, depth, ffi.sizeof("rayc_material"))
        return cls(*(getattr(found, name) for name in cls.__annotations__))


def struct_of(material: Material | None) -> Any:
    """The C struct; NULL for none."""
    return NULL if material is None else ffi.new("rayc_material *", (ffi.sizeof("rayc_material"), *astuple(material)))


class ContactSystem:
    """What a simulator needs of contact beyond forces: rows that only push, on the host's own unknowns, friction that
    holds, rigid bodies, skins on cages, floors. Options: see ContactSystemOptions.

    A step: set_motion() for bodies that are not deformable, begin(); a solve with add_forces() and add_product(), then
    linearise() and detect_again(), as often as needed; finish(). SI units. Vectors of unknowns hold x, y, z of each
    node, in any shape of float64, then six numbers of each rigid body where those are kept. Velocities are those at
    the end of the step where nothing else is said.
    """

    def __init__(self, **system_options: Unpack[ContactSystemOptions]) -> None:
        self._handle = create("contact_system", options("contact_system", system_options))

    def set_node_masses(self, masses: Array) -> None:
        """The mass of each node in kg, infinity for one held fast; before bodies that have these nodes are added."""
        call(library.rayc_contact_system_set_node_masses, self._handle, *counted(masses, "masses"))

    def add_deformable(
        self, scene: Scene, body: int, first: int, count: int, material: Material, weights: Weights | None = None
    ) -> None:
        """Adds body `body` of the scene with the nodes first, …, first + count − 1: one for each surface vertex, or the
        offsets, nodes and weights of a table in compressed rows, a row for each surface vertex."""
        table: Any = (NULL, 0, NULL, NULL)
        if weights is not None:
            offsets, nodes = indices(weights[0], "offsets"), indices(weights[1], "nodes")
            entries, shares = counted(weights[2], "weights")
            if entries != nodes.size:
                raise ValueError(f"{nodes.size} nodes have {entries} weights; give one for each")
            table = offsets, entries, nodes, shares
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
        """Where a rigid or moved body is and how it moves: (3,), (3, 3), and linear and angular velocity, (6,), at the
        start of the step and at its end without contact."""
        pose, velocities = {"position": (position, 3), "rotation": (rotation, 9)}, (velocity, 6)
        motion = packed(**pose, velocity=velocities, free_velocity=(free_velocity, 6))
        call(library.rayc_contact_system_set_motion, self._handle, body, motion)

    def unknown_count(self) -> int:
        """How many numbers a vector of unknowns has."""
        return int(answer(library.rayc_contact_system_unknown_count, self._handle))

    def begin(self, scene: Scene, dt: float, positions: Array, velocities: Array, free_velocities: Array) -> None:
        """Begins a step of dt seconds: the nodes' positions and velocities at its start, and their velocities at its
        end without contact. Detects where bodies would then be."""
        count, x = counted(positions, "positions")
        given = count, x, numbers(velocities, "velocities", count), numbers(free_velocities, "free_velocities", count)
        call(library.rayc_contact_system_begin, self._handle, scene._handle, dt, *given)

    def add_forces(self, velocities: Array, forces: Doubles) -> None:
        """Adds the contact forces to `forces`, in N."""
        f = to_write(forces, "forces", is_packed=True)
        call(library.rayc_contact_system_add_forces, self._handle, *counted(velocities, "velocities", f.size), f)

    def add_product(self, factor: float, change: Array, result: Doubles) -> None:
        """Adds factor · (−∂force/∂velocity) · change to `result`; the matrix is positive semi-definite."""
        r = to_write(result, "result", is_packed=True)
        call(library.rayc_contact_system_add_product, self._handle, factor, *counted(change, "change", r.size), r)

    def blocks(self, factor: float) -> tuple[NDArray[np.uint32], NDArray[np.uint32], Doubles]:
        """The same matrix in blocks, those of equal place to be added: rows (n,), columns (n,), blocks (n, 3, 3)."""
        count = answer(library.rayc_contact_system_block_count, self._handle)
        found = np.empty(count, np.uint32), np.empty(count, np.uint32), np.empty((count, 3, 3))
        call(library.rayc_contact_system_copy_blocks, self._handle, factor, count, *found)
        return found

    def energy(self, velocities: Array) -> float:
        """The potential of the rows, in J. Forces are its negative gradient by the positions at the end of the step."""
        return float(answer(library.rayc_contact_system_energy, self._handle, *counted(velocities, "velocities")))

    def linearise(self, velocities: Array) -> float:
        """Decides anew which rows push and rub, after a solve; returns the part of all force, 0 to 1, that was
        predicted wrongly: above 0.05 or so another solve is due."""
        return float(answer(library.rayc_contact_system_linearise, self._handle, *counted(velocities, "velocities")))

    def misjudged(self, velocities: Array) -> float:
        """What linearise() would return; the rows stay as they are."""
        return float(answer(library.rayc_contact_system_misjudged, self._handle, *counted(velocities, "velocities")))

    def detect_again(self, scene: Scene, velocities: Array) -> bool:
        """Looks whether bodies that were stopped are in the way of others; True: another solve is due."""
        given = self._handle, scene._handle, *counted(velocities, "velocities")
        return bool(answer(library.rayc_contact_system_detect_again, *given))

    def finish(self, velocities: Array) -> None:
        """Ends the step with these velocities: loads and what friction holds on to are remembered."""
        call(library.rayc_contact_system_finish, self._handle, *counted(velocities, "velocities"))

    def cancel(self) -> None:
        """Ends the step as if it had not begun, but for the positions of the scene's bodies."""
        call(library.rayc_contact_system_cancel, self._handle)

    def contacts(self) -> Contacts:
        """A copy of the contacts of the last detection."""
        found = Contacts()
        call(library.rayc_contact_system_copy_contacts, self._handle, found._handle)
        return found

    def pair_force(self, body: int, other: int, is_half_space: bool = False) -> Doubles:
        """The net force, in N, of another body or a half-space on a body in the last finished step: (3,)."""
        return copied(library.rayc_contact_system_pair_force, 3, self._handle, body, other, is_half_space)

    def rigid_velocity(self, body: int) -> Doubles:
        """Linear and angular velocity of a rigid body at the end of the last finished step: (6,)."""
        return copied(library.rayc_contact_system_rigid_velocity, 6, self._handle, body)

    def explicit_step(self, scene: Scene, dt: float, positions: Array, velocities: Array, forces: Doubles) -> float:
        """For hosts that integrate explicitly: adds the contact forces at these positions and velocities, and returns
        the longest step in s for which they are stable."""
        (count, x), f = counted(positions, "positions"), to_write(forces, "forces", is_packed=True)
        given = scene._handle, dt, count, x, numbers(velocities, "velocities", count), f.size, f
        return float(answer(library.rayc_contact_system_explicit_step, self._handle, *given))
