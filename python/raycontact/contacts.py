# SPDX-License-Identifier: MIT OR Apache-2.0
"""The contacts of one query, and the forces they make."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._arrays import BodyVectors, copied, pointer, to_write
from ._ffi import ffi
from ._header import DetectionOptions, ResponseOptions
from ._library import DTYPES, answer, check, create, library, options
from .mesh import Mesh

if TYPE_CHECKING:
    from typing_extensions import Unpack

    Arrays = Iterable[ArrayLike | None]
    Targets = Iterable[NDArray[Any] | None]


class Contacts:
    """The contacts of one query, by pair, then the colliding body, then along its surface. Each query replaces what is
    there and uses its memory again. They stay when scene and meshes are gone.

    Forces follow the penalty law of ResponseOptions, keyword arguments of each call (stiffness in N/m³ by default).
    Forces, positions, velocities and displacements are one (n, 3) for each body, in the order of the bodies' numbers;
    None for a body that has been removed or has no contact.
    """

    def __init__(self) -> None:
        self._handle = create("contacts")

    def __len__(self) -> int:
        return int(answer("size_t", library.rayc_contacts_count, self._handle))

    def to_array(self) -> NDArray[Any]:
        """A copy of all contacts: (n,) with the fields of rayc_contact.

        kind, a ContactKind; colliding and collided, the body that the ray starts from and the one it ends on; p1 and
        p2, the ray's ends, each with triangle, vertices, weights (barycentric) and position in m; direction, of unit
        length; depth in m; cos_alpha; area in m².
        """
        count = len(self)
        return copied("contact", count, library.rayc_contacts_copy, self._handle, 0, count)

    def statistics(self) -> dict[str, int]:
        """What the query did, by the names of rayc_statistics."""
        kind = ffi.typeof("rayc_statistics")
        found = answer(kind.cname, library.rayc_contacts_statistics, self._handle, ffi.sizeof(kind))
        return {name: getattr(found, name) for name, _ in kind.fields}

    def coefficients(self, **response: Unpack[ResponseOptions]) -> NDArray[np.float64]:
        """The spring coefficient of each contact, in N/m: (n,). The force on p1 is coefficient · depth · direction,
        that on p2 its opposite."""
        found, law = np.empty(len(self)), options("response", response)
        check(library.rayc_contacts_copy_coefficients(self._handle, law, 0, len(found), pointer(found)))
        return found

    def add_forces(
        self,
        forces: Targets,
        positions: Arrays | None = None,
        velocities: Arrays | None = None,
        **response: Unpack[ResponseOptions],
    ) -> None:
        """Adds the contact forces to `forces`, in N, at `positions` in m (without: those of detection) and with damping
        by `velocities` in m/s (without: none). Each contact stays at its two surface points and along its direction."""
        f, law = BodyVectors(forces, "forces", to_write), options("response", response)
        x = BodyVectors(positions, "positions", count=f.count)
        v = BodyVectors(velocities, "velocities", count=f.count)
        check(library.rayc_contacts_add_forces(self._handle, law, f.count, x.structs, v.structs, f.structs))

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
        f, law = BodyVectors(forces, "forces", to_write), options("response", response)
        d = BodyVectors(displacements, "displacements", count=f.count)
        factors, arrays = (stiffness_factor, damping_factor), (f.count, d.structs, f.structs)
        check(library.rayc_contacts_add_differential(self._handle, law, *factors, *arrays))

    def energy(self, positions: Arrays | None = None, **response: Unpack[ResponseOptions]) -> float:
        """The energy stored in the contacts, in J, at `positions` in m (without: those of detection). The elastic force
        is its negative gradient."""
        x, law = BodyVectors(positions, "positions"), options("response", response)
        return float(answer("double", library.rayc_contacts_energy, self._handle, law, x.count, x.structs))

    def escape_pushes(self) -> NDArray[Any]:
        """How each escaping pair is pushed as a whole: one for each such pair, with the fields of rayc_escape_push."""
        count = answer("size_t", library.rayc_contacts_escape_push_count, self._handle)
        given = self._handle, 0, count, DTYPES["escape_push"].itemsize
        return copied("escape_push", count, library.rayc_contacts_copy_escape_pushes, *given)


def query_pair(a: Mesh, b: Mesh, contacts: Contacts | None = None, **detection: Unpack[DetectionOptions]) -> Contacts:
    """Finds the contacts between two meshes, bodies 0 and 1; a scene also lets pairs escape. They replace those of
    `contacts`, which is returned, or are new. Options: see DetectionOptions."""
    contacts, given = Contacts() if contacts is None else contacts, options("detection", detection)
    check(library.rayc_query_pair(given, a._handle, a.octree(), b._handle, b.octree(), contacts._handle))
    return contacts


def query_self(mesh: Mesh, contacts: Contacts | None = None, **detection: Unpack[DetectionOptions]) -> Contacts:
    """The same for the contacts of a mesh with itself, body 0."""
    contacts, given = Contacts() if contacts is None else contacts, options("detection", detection)
    check(library.rayc_query_self(given, mesh._handle, mesh.octree(), contacts._handle))
    return contacts
