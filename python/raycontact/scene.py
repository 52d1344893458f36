# SPDX-License-Identifier: MIT OR Apache-2.0
"""Many bodies, one detection for all of them, its contacts, and the forces they make."""

from __future__ import annotations

from typing import Any, Iterator

import numpy as np
from numpy.typing import DTypeLike, NDArray

from ._header import DetectionOptions, ResponseOptions, SceneOptions
from ._library import Array, Arrays, Doubles, Targets, Unpack, answer, call, copied, create, ffi, library, of_bodies
from ._library import numbers, options, packed, to_read, to_write
from .mesh import Mesh


class Contacts:
    """A query's contacts by pair, colliding body, and along its surface. Each query replaces them; scenes may go before.

    Forces follow the penalty law of ResponseOptions, keyword arguments of each call (stiffness in N/m³ by default).
    Forces, positions, velocities and displacements are one (n, 3) for each body, in the order of the bodies' numbers;
    None for a body that has been removed or has no contact. Without positions, those of detection count."""

    def __init__(self) -> None:
        self._handle = create("contacts")

    def __len__(self) -> int:
        return int(answer(library.rayc_contacts_count, self._handle))

    def __repr__(self) -> str:
        return f"Contacts({len(self)} contacts)"

    def __getitem__(self, which: Any) -> Any:
        """Some of to_array(), which is copied for each call, or one of its fields by name."""
        return self.to_array()[which]

    def __iter__(self) -> Iterator[Any]:
        return iter(self.to_array())

    def to_array(self) -> NDArray[Any]:
        """A copy of all contacts: kind, a ContactKind; colliding and collided, the bodies that the ray starts from and
        ends on; piece, the part of p1's triangle; id, from step to step; p1 and p2, the ray's ends, each with triangle,
        vertices, barycentric weights and position in m; a unit direction; depth in m; cos_alpha; area in m²."""
        return copied(library.rayc_contacts_copy, len(self), self._handle, 0, len(self))

    def __array__(self, dtype: DTypeLike | None = None, copy: bool | None = None) -> NDArray[Any]:
        if copy is False:
            raise ValueError("contacts can only be copied; use np.asarray(contacts)")
        return np.asarray(self.to_array(), dtype)

    def statistics(self) -> dict[str, float]:
        """What the query did, by the names of rayc_statistics."""
        found = answer(library.rayc_contacts_statistics, self._handle, ffi.sizeof("rayc_statistics"))
        return {name: getattr(found, name) for name, _ in ffi.typeof(found).fields}

    def coefficients(self, **response: Unpack[ResponseOptions]) -> Doubles:
        """The spring coefficient c of each contact, in N/m. The force on p1 is c · depth · direction, on p2 its opposite."""
        law, count = options("response", response), len(self)
        return copied(library.rayc_contacts_copy_coefficients, count, self._handle, law, 0, count)

    def add_forces(
        self, forces: Targets, positions: Arrays = None, velocities: Arrays = None, **response: Unpack[ResponseOptions]
    ) -> None:
        """Adds the contact forces to `forces`, in N. Damping and friction need `velocities` in m/s."""
        f, law = of_bodies(forces, "forces", prepare=to_write), options("response", response)
        x, v = of_bodies(positions, "positions", len(f)), of_bodies(velocities, "velocities", len(f))
        call(library.rayc_contacts_add_forces, self._handle, law, len(f), x, v, f)

    def add_wrenches(self, wrenches: Doubles, about: Array, twists: Array, **response: Unpack[ResponseOptions]) -> None:
        """Adds force, torque `about` points to rigid `wrenches` (n, 6); `twists` (n, 6): velocity of the point, angular."""
        w, law = to_write(wrenches, "wrenches", is_packed=True), options("response", response)
        if w.dtype != np.float64:
            raise ValueError(f"wrenches has the dtype {w.dtype}; give float64")
        x, v = numbers(about, "about", w.size // 2), numbers(twists, "twists", w.size)
        call(library.rayc_contacts_add_wrenches, self._handle, law, w.size // 6, x, v, w)

    def add_differential(
        self, displacements: Arrays, forces: Targets, stiffness_factor: float = 1.0, damping_factor: float = 0.0,
        scene: Scene | None = None, **response: Unpack[ResponseOptions]
    ) -> None:
        """Adds stiffness_factor · (∂force/∂position) d + damping_factor · (∂force/∂velocity) d to `forces`, without friction.
        Given the `scene` whose newest query these are of, contacts are not held but found anew: for Newton's method."""
        f, law = of_bodies(forces, "forces", prepare=to_write), options("response", response)
        given = law, stiffness_factor, damping_factor, len(f), of_bodies(displacements, "displacements", len(f)), f
        add = library.rayc_contacts_add_differential if scene is None else library.rayc_scene_add_differential
        call(add, *([] if scene is None else [scene._handle]), self._handle, *given)

    def energy(self, positions: Arrays = None, **response: Unpack[ResponseOptions]) -> float:
        """The energy stored in the contacts, in J. The elastic force is its negative gradient."""
        x, law = of_bodies(positions, "positions"), options("response", response)
        return float(answer(library.rayc_contacts_energy, self._handle, law, 0 if positions is None else len(x), x))

    def escape_pushes(self) -> NDArray[Any]:
        """How each escaping pair is pushed as a whole: one for each such pair, with the fields of rayc_escape_push."""
        count, size = answer(library.rayc_contacts_escape_push_count, self._handle), ffi.sizeof("rayc_escape_push")
        return copied(library.rayc_contacts_copy_escape_pushes, count, self._handle, 0, count, size)


def filled(contacts: Contacts | None, function: Any, *given: Any) -> Contacts:
    """These contacts, or new ones, once a call has filled them."""
    contacts = Contacts() if contacts is None else contacts
    call(function, *given, contacts._handle)
    return contacts


def query_pair(a: Mesh, b: Mesh, contacts: Contacts | None = None, **detection: Unpack[DetectionOptions]) -> Contacts:
    """Finds the contacts between two meshes, bodies 0 and 1; a scene also lets pairs escape. They replace those of
    `contacts`, which is returned, or are new. Options: see DetectionOptions."""
    given = options("detection", detection), a._handle, a.octree(), b._handle, b.octree()
    return filled(contacts, library.rayc_query_pair, *given)


def query_self(mesh: Mesh, contacts: Contacts | None = None, **detection: Unpack[DetectionOptions]) -> Contacts:
    """The same for the contacts of a mesh with itself, body 0."""
    return filled(contacts, library.rayc_query_self, options("detection", detection), mesh._handle, mesh.octree())


class Scene:
    """Many bodies, numbered from 0, and all contacts among them.

    Options: see SceneOptions; threads=0: one for each core, until the scene ends. After an Error all is as it was."""

    def __init__(self, **scene_options: Unpack[SceneOptions]) -> None:
        self._handle = create("scene", options("scene", scene_options))

    def add(self, mesh: Mesh) -> int:
        """Adds a copy of `mesh` with its present positions; returns the body's number."""
        return int(answer(library.rayc_scene_add_mesh, self._handle, mesh._handle))

    def remove(self, body: int) -> None:
        """Removes a body. Its number is refused from here on; no other body has it before release_body_numbers()."""
        call(library.rayc_scene_remove_body, self._handle, body)

    def release_body_numbers(self) -> None:
        """Lets new bodies have the numbers of removed ones, once no contacts, saved state or contact system use them."""
        call(library.rayc_scene_release_body_numbers, self._handle)

    def set_positions(self, body: int, positions: Array) -> None:
        """Renews the positions of a body's vertices: (n, 3), in m."""
        call(library.rayc_scene_set_positions, self._handle, body, [to_read(positions, "positions")])

    def set_pose(self, body: int, position: Array, rotation: Array) -> None:
        """Moves a body that keeps its shape, at the cost of where it meets others: position is (3,) in m, rotation
        (3, 3), and a point p of its mesh as it was created is at rotation @ p + position."""
        call(library.rayc_scene_set_pose, self._handle, body, packed(position=(position, 3), rotation=(rotation, 9)))

    def set_detection_options(self, **detection: Unpack[DetectionOptions]) -> None:
        """Sets how contacts are found from the next query on; what is not given becomes the default."""
        call(library.rayc_scene_set_detection_options, self._handle, options("detection", detection))

    def set_self_collision(self, body: int, is_on: bool) -> None:
        """Switches contacts of a body with itself on or off from the next query on; off for a new body."""
        call(library.rayc_scene_set_self_collision, self._handle, body, is_on)

    def set_carrier_spacing(self, body: int, spacing: float) -> None:
        """How far apart a body's unknowns are in m, as samples may be: the nodes of a cage; inf for none; else 0."""
        call(library.rayc_scene_set_carrier_spacing, self._handle, body, spacing)

    def set_pair_collision(self, a: int, b: int, is_on: bool) -> None:
        """Switches contacts between two bodies off or on again from the next query on."""
        call(library.rayc_scene_set_pair_collision, self._handle, a, b, is_on)

    def allow_escape(self, a: int, b: int, allowed: bool) -> None:
        """Lets two bodies escape from one another where contacts cannot part them, as by default, or forbids it."""
        call(library.rayc_scene_allow_escape, self._handle, a, b, allowed)

    def may_escape(self, a: int, b: int) -> bool:
        """Whether two bodies may escape from one another."""
        return bool(answer(library.rayc_scene_may_escape, self._handle, a, b))

    def query(self, contacts: Contacts | None = None) -> Contacts:
        """Finds all contacts into `contacts`, or new ones, and returns them. Pairs may escape unless the options say no."""
        return filled(contacts, library.rayc_scene_query, self._handle)

    def potential(self, contacts: Contacts, **response: Unpack[ResponseOptions]) -> float:
        """Queries, and returns the energy that bodies store where they are, in J; queries differ in it by the work between."""
        return float(answer(library.rayc_scene_potential, self._handle, options("response", response), contacts._handle))

    def advance(self, seconds: float) -> None:
        """Ends a step of so many seconds, after its last query: what pairs remember, by which they escape, goes on."""
        call(library.rayc_scene_advance, self._handle, seconds)

    def pair_memories(self) -> NDArray[Any]:
        """What each pair remembers from step to step: one for each, with the fields of rayc_pair_memory."""
        count, size = answer(library.rayc_scene_pair_memory_count, self._handle), ffi.sizeof("rayc_pair_memory")
        return copied(library.rayc_scene_copy_pair_memories, count, self._handle, 0, count, size)

    def save_pair_memories(self) -> bytes:
        """The same for files: a scene of the same bodies and options that restores it goes on as this, to the bit."""
        length = answer(library.rayc_scene_saved_length, self._handle)
        return copied(library.rayc_scene_save_pair_memories, length, self._handle, length).tobytes()

    def restore_pair_memories(self, saved: bytes) -> None:
        """Goes on from saved bytes."""
        call(library.rayc_scene_restore_pair_memories, self._handle, len(saved), ffi.from_buffer(saved))
