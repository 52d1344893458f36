# SPDX-License-Identifier: MIT OR Apache-2.0
"""A step's contact on the unknowns that a simulator solves for."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._arrays import numbers, packed, pointer
from ._ffi import ffi
from ._header import ContactSystemOptions
from ._library import NULL, answer, check, create, library, options
from .contacts import Contacts
from .scene import Scene

if TYPE_CHECKING:
    from typing_extensions import Unpack

    Weights = tuple[ArrayLike, ArrayLike, ArrayLike]


class Material(NamedTuple):
    """How a surface bears load, damps and rubs: N/m³, s, Coulomb's coefficient, and the depth in m beyond which one step
    asks for no more force than there. Material.bearing() suggests values."""

    stiffness: float
    damping_time: float = 0.05
    friction: float = 0.5
    depth_cap: float = float("inf")

    @classmethod
    def bearing(cls, pressure: float, depth: float) -> Material:
        """One that bears `pressure` in Pa at `depth` in m: of an elastic body, a quarter of Young's modulus at a quarter
        of its elements' edge; of a rigid or still one, ten times the pressure at rest at ten times the depth to which
        bodies may sink in."""
        found = answer("rayc_material", library.rayc_bearing_material, pressure, depth, ffi.sizeof("rayc_material"))
        return cls(found.stiffness, found.damping_time, found.friction, found.depth_cap)


def struct_of(material: Material | None) -> Any:
    """The C struct; NULL for none."""
    return NULL if material is None else ffi.new("rayc_material *", (ffi.sizeof("rayc_material"), *material))


def added_to(given: Any, name: str) -> NDArray[np.float64]:
    """The array itself: its owner would not see what is added to a copy."""
    if isinstance(given, np.ndarray) and given.dtype == np.float64 and given.flags.carray:
        return given
    raise ValueError(f"{name} cannot be added to where it lies; give a packed array of float64, such as np.zeros(n)")


class ContactSystem:
    """What a simulator needs of contact beyond forces: rows that only push, on the host's own unknowns, friction that holds,
    rigid bodies, skins on cages, floors. Options: see ContactSystemOptions.

    A step: set_motion() for bodies that are not deformable, begin(); a solve with add_forces() and add_product(), then
    linearise() and detect_again(), as often as needed; finish(). SI units. Vectors of unknowns hold x, y, z of each node,
    in any shape of float64, then six numbers of each rigid body where those are kept.
    """

    def __init__(self, **system_options: Unpack[ContactSystemOptions]) -> None:
        self._handle = create("contact_system", options("contact_system", system_options))

    def set_node_masses(self, masses: ArrayLike) -> None:
        """The mass of each node in kg, infinity for one held fast; before bodies that have these nodes are added."""
        m = numbers(masses, "masses")
        check(library.rayc_contact_system_set_node_masses(self._handle, m.size, pointer(m)))

    def add_deformable(
        self, scene: Scene, body: int, first: int, count: int, material: Material, weights: Weights | None = None
    ) -> None:
        """Adds body `body` of the scene with the nodes first, …, first + count − 1: one for each surface vertex, or the
        offsets, nodes and weights of a table in compressed rows, a row for each surface vertex."""
        table, entries = [NULL] * 3, 0
        if weights is not None:
            arrays = [np.ascontiguousarray(*part) for part in zip(weights, (np.uint32, np.uint32, np.float64))]
            table, entries = [pointer(array) for array in arrays], arrays[1].size
            if arrays[2].size != entries:
                raise ValueError(f"{entries} nodes have {arrays[2].size} weights; give one for each")
        given = table[0], entries, table[1], table[2], struct_of(material)
        check(library.rayc_contact_system_add_deformable(self._handle, scene._handle, body, first, count, *given))

    def add_rigid(self, scene: Scene, body: int, mass: float, inertia: ArrayLike, material: Material) -> None:
        """Adds a rigid body: mass in kg, inertia in kg m², (3, 3), about the origin of the mesh, its centre of mass."""
        tensor, given = numbers(inertia, "inertia", 9), struct_of(material)
        check(library.rayc_contact_system_add_rigid(self._handle, scene._handle, body, mass, pointer(tensor), given))

    def add_moved(self, scene: Scene, body: int, material: Material) -> None:
        """Adds a body that stands still or that the host moves."""
        check(library.rayc_contact_system_add_moved(self._handle, scene._handle, body, struct_of(material)))

    def add_half_space(self, normal: ArrayLike, offset: float, material: Material) -> None:
        """Adds a floor, solid where normal · x < offset."""
        n = numbers(normal, "normal", 3)
        check(library.rayc_contact_system_add_half_space(self._handle, pointer(n), offset, struct_of(material)))

    def remove_body(self, body: int) -> None:
        """Removes a body from the system; to be removed from the scene too."""
        check(library.rayc_contact_system_remove_body(self._handle, body))

    def set_pair_material(self, a: int, b: int, material: Material | None) -> None:
        """Gives two bodies a material of their own in place of the combined one; None takes it back."""
        check(library.rayc_contact_system_set_pair_material(self._handle, a, b, struct_of(material)))

    def set_half_space_material(self, body: int, half_space: int, material: Material | None) -> None:
        """The same for a body and a half-space, counted in the order they were added."""
        given = struct_of(material)
        check(library.rayc_contact_system_set_half_space_material(self._handle, body, half_space, given))

    def set_motion(
        self, body: int, position: ArrayLike, rotation: ArrayLike, velocity: ArrayLike, free_velocity: ArrayLike
    ) -> None:
        """Where a rigid or moved body is and how it moves: (3,), (3, 3), and linear and angular velocity, (6,), at the
        start of the step and at its end without contact."""
        pose = ("position", position, 3), ("rotation", rotation, 9)
        velocities = ("velocity", velocity, 6), ("free_velocity", free_velocity, 6)
        check(library.rayc_contact_system_set_motion(self._handle, body, packed("rayc_motion", *pose, *velocities)))

    def unknown_count(self) -> int:
        """How many numbers a vector of unknowns has."""
        return int(answer("size_t", library.rayc_contact_system_unknown_count, self._handle))

    def begin(
        self, scene: Scene, dt: float, positions: ArrayLike, velocities: ArrayLike, free_velocities: ArrayLike
    ) -> None:
        """Begins a step of dt seconds: the nodes' positions and velocities at its start, and their velocities at its end
        without contact. Detects where bodies would then be."""
        x = numbers(positions, "positions")
        v, free = numbers(velocities, "velocities", x.size), numbers(free_velocities, "free_velocities", x.size)
        given = x.size, pointer(x), pointer(v), pointer(free)
        check(library.rayc_contact_system_begin(self._handle, scene._handle, dt, *given))

    def add_forces(self, velocities: ArrayLike, forces: NDArray[np.float64]) -> None:
        """Adds the contact forces to `forces`, in N, for these velocities at the end of the step."""
        f = added_to(forces, "forces")
        v = numbers(velocities, "velocities", f.size)
        check(library.rayc_contact_system_add_forces(self._handle, f.size, pointer(v), pointer(f)))

    def add_product(self, factor: float, change: ArrayLike, result: NDArray[np.float64]) -> None:
        """Adds factor · (−∂force/∂velocity) · change to `result`; the matrix is positive semi-definite."""
        r = added_to(result, "result")
        d = numbers(change, "change", r.size)
        check(library.rayc_contact_system_add_product(self._handle, factor, r.size, pointer(d), pointer(r)))

    def blocks(self, factor: float) -> tuple[NDArray[np.uint32], NDArray[np.uint32], NDArray[np.float64]]:
        """The same matrix in 3 × 3 blocks, those of equal place to be added: rows (n,), columns (n,), blocks (n, 3, 3)."""
        count = answer("size_t", library.rayc_contact_system_block_count, self._handle)
        found = np.empty(count, np.uint32), np.empty(count, np.uint32), np.empty((count, 3, 3))
        check(library.rayc_contact_system_copy_blocks(self._handle, factor, count, *map(pointer, found)))
        return found

    def _answer(self, kind: str, function: Any, velocities: ArrayLike, *others: Any) -> Any:
        """What a call finds out about these velocities at the end of the step."""
        v = numbers(velocities, "velocities")
        return answer(kind, function, self._handle, *others, v.size, pointer(v))

    def energy(self, velocities: ArrayLike) -> float:
        """The potential of the rows, in J: the forces are its negative gradient by the positions at the end of the step."""
        return float(self._answer("double", library.rayc_contact_system_energy, velocities))

    def linearise(self, velocities: ArrayLike) -> float:
        """Decides anew which rows push and rub, after a solve; returns the part of all force, 0 to 1, that was predicted
        wrongly: above 0.05 or so another solve is due."""
        return float(self._answer("double", library.rayc_contact_system_linearise, velocities))

    def misjudged(self, velocities: ArrayLike) -> float:
        """What linearise() would return; the rows stay as they are."""
        return float(self._answer("double", library.rayc_contact_system_misjudged, velocities))

    def detect_again(self, scene: Scene, velocities: ArrayLike) -> bool:
        """Looks whether bodies that were stopped are in the way of others; True: another solve is due."""
        return bool(self._answer("uint32_t", library.rayc_contact_system_detect_again, velocities, scene._handle))

    def finish(self, velocities: ArrayLike) -> None:
        """Ends the step with these velocities: loads and what friction holds on to are remembered."""
        v = numbers(velocities, "velocities")
        check(library.rayc_contact_system_finish(self._handle, v.size, pointer(v)))

    def cancel(self) -> None:
        """Ends the step as if it had not begun, but for the positions of the scene's bodies."""
        check(library.rayc_contact_system_cancel(self._handle))

    def contacts(self) -> Contacts:
        """A copy of the contacts of the last detection."""
        found = Contacts()
        check(library.rayc_contact_system_copy_contacts(self._handle, found._handle))
        return found

    def pair_force(self, body: int, other: int, is_half_space: bool = False) -> NDArray[np.float64]:
        """The net force, in N, of another body or a half-space on a body in the last finished step: (3,)."""
        found = np.empty(3)
        check(library.rayc_contact_system_pair_force(self._handle, body, other, is_half_space, pointer(found)))
        return found

    def rigid_velocity(self, body: int) -> NDArray[np.float64]:
        """Linear and angular velocity of a rigid body at the end of the last finished step: (6,)."""
        found = np.empty(6)
        check(library.rayc_contact_system_rigid_velocity(self._handle, body, pointer(found)))
        return found

    def explicit_step(
        self, scene: Scene, dt: float, positions: ArrayLike, velocities: ArrayLike, forces: NDArray[np.float64]
    ) -> float:
        """For hosts that integrate explicitly: adds the contact forces at these positions and velocities, and returns the
        longest step in s for which they are stable."""
        x, f = numbers(positions, "positions"), added_to(forces, "forces")
        v = numbers(velocities, "velocities", x.size)
        given = scene._handle, dt, x.size, pointer(x), pointer(v), f.size, pointer(f)
        return float(answer("double", library.rayc_contact_system_explicit_step, self._handle, *given))
