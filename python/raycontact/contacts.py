# SPDX-License-Identifier: MIT OR Apache-2.0
"""The contacts of one query, and the forces they make."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Any

from numpy.typing import DTypeLike, NDArray

from ._arrays import Array, Doubles, Unpack, of_bodies, to_write
from ._ffi import ffi
from ._header import DetectionOptions, ResponseOptions
from ._library import answer, call, copied, create, library, options
from .mesh import Mesh

if TYPE_CHECKING:
    Arrays = Iterable[Array | None] | None
    Targets = Iterable[NDArray[Any] | None]


class Contacts:
    """The contacts of one query, by pair, then the colliding body, then along its surface. Each query replaces what is
    there and uses its memory again. They stay when scene and meshes are gone.

    Forces follow the penalty law of ResponseOptions, keyword arguments of each call (stiffness in N/m³ by default).
    Forces, positions, velocities and displacements are one (n, 3) for each body, in the order of the bodies' numbers;
    None for a body that has been removed or has no contact. Without positions, those of detection count.
    """

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
        contacts = self.to_array()
        return contacts if dtype is None else contacts.astype(dtype)

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
        """Adds the contact forces to `forces`, in N, with damping by `velocities` in m/s; without them damping_time must
        be 0, its default. Each contact stays at its two surface points and along its direction."""
        f, law = of_bodies(forces, "forces", prepare=to_write), options("response", response)
        x, v = of_bodies(positions, "positions", len(f)), of_bodies(velocities, "velocities", len(f))
        call(library.rayc_contacts_add_forces, self._handle, law, len(f), x, v, f)

    def add_differential(
        self,
        displacements: Arrays,
        forces: Targets,
        stiffness_factor: float = 1.0,
        damping_factor: float = 0.0,
        **response: Unpack[ResponseOptions],
    ) -> None:
        """Adds stiffness_factor · (∂force/∂position) d + damping_factor · (∂force/∂velocity) d to `forces`, in N, for
        the displacements d in m (or m/s). Both Jacobians are symmetric and negative semi-definite."""
        f, law = of_bodies(forces, "forces", prepare=to_write), options("response", response)
        given = law, stiffness_factor, damping_factor, len(f), of_bodies(displacements, "displacements", len(f)), f
        call(library.rayc_contacts_add_differential, self._handle, *given)

    def energy(self, positions: Arrays = None, **response: Unpack[ResponseOptions]) -> float:
        """The energy stored in the contacts, in J. The elastic force is its negative gradient."""
        x, law = of_bodies(positions, "positions"), options("response", response)
        return float(answer(library.rayc_contacts_energy, self._handle, law, 0 if positions is None else len(x), x))

    def escape_pushes(self) -> NDArray[Any]:
        """How each escaping pair is pushed as a whole: one for each such pair, with the fields of rayc_escape_push."""
        count, size = answer(library.rayc_contacts_escape_push_count, self._handle), ffi.sizeof("rayc_escape_push")
        return copied(library.rayc_contacts_copy_escape_pushes, count, self._handle, 0, count, size)


def query_pair(a: Mesh, b: Mesh, contacts: Contacts | None = None, **detection: Unpack[DetectionOptions]) -> Contacts:
    """Finds the contacts between two meshes, bodies 0 and 1; a scene also lets pairs escape. They replace those of
    `contacts`, which is returned, or are new. Options: see DetectionOptions."""
    contacts, given = Contacts() if contacts is None else contacts, options("detection", detection)
    call(library.rayc_query_pair, given, a._handle, a.octree(), b._handle, b.octree(), contacts._handle)
    return contacts


def query_self(mesh: Mesh, contacts: Contacts | None = None, **detection: Unpack[DetectionOptions]) -> Contacts:
    """The same for the contacts of a mesh with itself, body 0."""
    contacts, given = Contacts() if contacts is None else contacts, options("detection", detection)
    call(library.rayc_query_self, given, mesh._handle, mesh.octree(), contacts._handle)
    return contacts
