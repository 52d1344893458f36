# SPDX-License-Identifier: MIT OR Apache-2.0
"""Many bodies, one detection for all of them."""

from __future__ import annotations

from typing import Any

from numpy.typing import NDArray

from ._arrays import Array, Unpack, packed, to_read
from ._ffi import ffi
from ._header import DetectionOptions, SceneOptions
from ._library import answer, call, copied, create, library, options
from .contacts import Contacts
from .mesh import Mesh


class Scene:
    """Many bodies, numbered from 0, and all contacts among them.

    Options: see SceneOptions; threads=0 starts a pool of one thread for each core, which ends with the scene. Results
    do not depend on it. An unknown body raises Error with Status.UNKNOWN_BODY. After an Error all is as it was.
    """

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
        """Finds all contacts at the present positions, into `contacts` or new ones, and returns them. Pairs that contacts
        cannot part escape; set_detection_options(escape=False) stops it."""
        contacts = Contacts() if contacts is None else contacts
        call(library.rayc_scene_query, self._handle, contacts._handle)
        return contacts

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
