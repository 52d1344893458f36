# SPDX-License-Identifier: MIT OR Apache-2.0
"""Arrays as the library sees them: the caller's where they lie, wherever that can be, and those that it fills."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._ffi import ffi
from ._header import Scalar
from ._library import DTYPES, NULL, check

SCALARS = {np.dtype(np.float32): Scalar.F32, np.dtype(np.float64): Scalar.F64}
NONE = np.empty((0, 3))


def pointer(array: NDArray[Any]) -> Any:
    """A packed array for C. It must live for as long as the call."""
    return ffi.cast("void *", array.__array_interface__["data"][0])


def numbers(given: ArrayLike, name: str, count: int | None = None) -> NDArray[np.float64]:
    """Packed doubles in any shape; used where they lie if they are so already."""
    array = np.ascontiguousarray(given, np.float64)
    if count not in (None, array.size):
        raise ValueError(f"{name} has {array.size} numbers; give {count}")
    return array


def packed(kind: str, *fields: tuple[str, ArrayLike, int]) -> Any:
    """A struct of doubles alone, of the name, the numbers and their count for each field."""
    struct = ffi.new(f"{kind} *")
    ffi.buffer(struct)[:] = b"".join(numbers(given, name, count).tobytes() for name, given, count in fields)
    return struct


def copied(kind: str, count: int, function: Any, *arguments: Any) -> NDArray[Any]:
    """`count` structs that a call copies to its last argument."""
    array = np.empty(count, DTYPES[kind])
    check(function(*arguments, pointer(array)))
    return array


def lies_well(array: NDArray[Any]) -> bool:
    """Whether the library can use an array where it is: in its numbers, each row packed, rows in ascending order."""
    size, rows = array.itemsize, len(array)
    is_ascending = rows < 2 or array.strides[0] >= 3 * size
    return array.dtype in SCALARS and (rows == 0 or array.strides[1] == size and is_ascending)


def require_shape(array: NDArray[Any], name: str, count: str = "n") -> None:
    if array.ndim != 2 or array.shape[1] != 3:
        raise ValueError(f"{name} has the shape {array.shape}; give ({count}, 3)")


def converted(array: NDArray[Any], name: str) -> NDArray[np.float64]:
    """A packed copy in double precision, where the numbers are real."""
    if not np.can_cast(array.dtype, np.float64, "same_kind"):
        raise TypeError(f"{name} has the dtype {array.dtype}; give real numbers")
    return array.astype(np.float64, order="C")


def to_read(given: ArrayLike, name: str) -> NDArray[Any]:
    """The array itself where the library can read it, else a copy."""
    array = np.asarray(given)
    require_shape(array, name)
    return array if lies_well(array) else converted(array, name)


def to_write(given: Any, name: str) -> NDArray[Any]:
    """The array itself: its owner would not see what is added to a copy."""
    if not isinstance(given, np.ndarray):
        raise TypeError(f"{name} is of the type {type(given).__name__}; give a numpy array, which is added to")
    require_shape(given, name)
    if not (lies_well(given) and given.flags.writeable):
        found = f"dtype {given.dtype}, strides {given.strides}, writeable {given.flags.writeable}"
        raise ValueError(f"{name} cannot be added to where it lies ({found}); give one such as np.zeros((n, 3))")
    return given


def corners(given: ArrayLike) -> NDArray[np.uint32]:
    """Vertex numbers of triangles; a packed array of uint32 is used where it lies."""
    array = np.asarray(given)
    require_shape(array, "triangles", "m")
    if array.dtype.kind not in "iu" and array.size:
        raise TypeError(f"triangles has the dtype {array.dtype}; give whole numbers")
    wrong = np.flatnonzero(((array < 0) | (array > 2**32 - 1)).any(axis=1))
    if len(wrong):
        raise ValueError(f"triangle {wrong[0]} names the vertices {array[wrong[0]].tolist()}; give numbers from 0")
    return np.ascontiguousarray(array, np.uint32)


def show(struct: Any, array: NDArray[Any]) -> None:
    """Tells the library where an array lies."""
    struct.data, struct.count, struct.scalar = pointer(array), len(array), SCALARS[array.dtype]
    struct.stride = array.strides[0] if len(array) > 1 else 0


class Vectors:
    """An array of vectors to be read. It must live for as long as the call that is given its struct."""

    def __init__(self, given: ArrayLike, name: str) -> None:
        self.array, self.struct = to_read(given, name), ffi.new("rayc_vectors *")
        show(self.struct, self.array)


class BodyVectors:
    """One array for each body, in the order of their numbers, None for a body that has none; to live as Vectors."""

    def __init__(
        self,
        given: Iterable[Any] | None,
        name: str,
        prepare: Callable[[Any, str], NDArray[Any]] = to_read,
        count: int | None = None,
    ) -> None:
        arrays = [] if given is None else list(given)
        self.arrays = [NONE if array is None else prepare(array, f"{name}[{i}]") for i, array in enumerate(arrays)]
        self.structs, self.count = NULL, len(arrays)
        if given is None:
            return
        if count not in (None, self.count):  # the library cannot tell
            raise ValueError(f"{name} has {self.count} arrays for {count} bodies; give one for each")
        self.structs = ffi.new("rayc_vectors_mut[]" if prepare is to_write else "rayc_vectors[]", self.count)
        for struct, array in zip(self.structs, self.arrays):
            show(struct, array)
