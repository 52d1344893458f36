# SPDX-License-Identifier: MIT OR Apache-2.0
"""What a library has to answer: four functions, and two for self-contact. The same in C: c/penetration.h."""

from __future__ import annotations

import abc
from collections.abc import Callable
from typing import ClassVar, NamedTuple, Optional

import numpy as np
from numpy.typing import NDArray

Vectors = NDArray[np.float64]

CONTACT = np.dtype([("first", float, 3), ("second", float, 3), ("direction", float, 3), ("depth", float),
                    ("weight", float)])


class Contacts:
    """An array with the fields of CONTACT, one for each contact: its points on the two bodies, the direction (of unit
    length) in which it pushes the first body, how far, and its weight. Its force is weight · depth · direction on the
    first body, the opposite on the second; every library chooses its own unit of weights."""

    @staticmethod
    def make(first, second, direction, depth, weight=1.0) -> NDArray:
        array = np.zeros(len(direction), CONTACT)
        if len(array):
            array["first"], array["second"], array["direction"] = first, second, direction
            array["depth"], array["weight"] = depth, weight
        return array

    @staticmethod
    def force(contacts: NDArray) -> Vectors:
        """On the first body."""
        return np.einsum("i,i,ij->j", contacts["weight"], contacts["depth"], contacts["direction"])


class Surface(NamedTuple):
    """A closed surface as it lies in its file: (n, 3) positions, (m, 3) triangles, counter-clockwise from outside."""

    name: str
    positions: Vectors
    triangles: NDArray[np.uint32]
    is_convex: bool


class Body(NamedTuple):
    """A body of tetrahedra that may overlap itself: (n, 3) positions, those of the surface first; (m, 3) triangles of
    the surface, counter-clockwise from outside; (k, 4) tetrahedra, none inside out."""

    name: str
    positions: Vectors
    triangles: NDArray[np.uint32]
    tetrahedra: NDArray[np.uint32]


EXIT = np.dtype([("vertex", np.uint32), ("point", float, 3)])


class Library(abc.ABC):
    """One library at one choice of settings. One thread. A function that the library has not got raises
    NotImplementedError, with the reason, and the task is listed as not done."""

    name: ClassVar[str]
    version: ClassVar[str] = ""
    settings: ClassVar[str] = ""
    documentation: ClassVar[str] = ""  # where its authors say that these settings are the ones to take
    tasks: ClassVar[tuple[str, ...]] = ("detect", "measure", "free", "intersecting", "simulate", "self")  # to take part in

    @abc.abstractmethod
    def load(self, first: Surface, second: Surface) -> None:
        """Takes a pair of bodies, in place of the one before, and forgets that. Not timed. Raises ValueError with the
        reason where the library cannot take such shapes."""

    @abc.abstractmethod
    def move(self, poses: Vectors, positions: tuple[Vectors, Vectors]) -> None:
        """Moves both bodies: a step begins. poses: (2, 3, 4), rotation and translation of each; positions: the vertices
        so placed. Take which you need."""

    @abc.abstractmethod
    def inside(self) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
        """Which vertices of the first body are inside the second, and of the second inside the first."""

    @abc.abstractmethod
    def contacts(self) -> NDArray | Callable[[], NDArray]:
        """The contacts at these poses: an array of Contacts.make(), or a function that makes it from what was found,
        which is not timed: putting objects of Python's into arrays is no work of the library's."""

    # For the task self, which a library may leave out:

    def load_body(self, body: Body) -> None:
        """Takes a body in place of whatever it had before. Not timed. Raises ValueError as load() does."""
        raise NotImplementedError("no query tells the ways out of a body that overlaps itself")

    def exits(self, positions: Vectors) -> NDArray | Callable[[], NDArray]:
        """Moves the body to `positions`: a step begins. Of each vertex of the surface that is inside another part of
        the body: where the shortest way from it, through that part, leads out. An array with the fields of EXIT, or a
        function that makes it, which is not timed."""
        raise NotImplementedError("no query tells the ways out of a body that overlaps itself")


def found(contacts: Optional[NDArray | Callable[[], NDArray]]) -> NDArray:
    return contacts() if callable(contacts) else contacts
