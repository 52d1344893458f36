# SPDX-License-Identifier: MIT OR Apache-2.0
"""The caller's arrays as the library can use them: where they lie, wherever that can be."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._library import NULL, SCALARS

if TYPE_CHECKING:  # the options of calls, for type checkers alone
    from typing_extensions import Unpack as Unpack
else:
    Unpack = None

Array = ArrayLike
Doubles = NDArray[np.float64]


def rows(given: Array, name: str, count: str = "n") -> NDArray[Any]:
    """One vector for each row."""
    array = np.asarray(given)
    if array.ndim != 2 or array.shape[1] != 3:
        raise ValueError(f"{name} has the shape {array.shape}; give ({count}, 3)")
    return array


def lies_well(array: NDArray[Any]) -> bool:
    """Whether vectors can be used where they are: in the library's numbers, rows packed and in ascending order."""
    is_ascending = len(array) < 2 or array.strides[0] >= 3 * array.itemsize
    return array.dtype in SCALARS and (len(array) == 0 or array.strides[1] == array.itemsize and is_ascending)


def to_read(given: Array, name: str) -> NDArray[Any]:
    """Vectors: the array itself where the library can read it, else a copy."""
    array = rows(given, name)
    return array if lies_well(array) else numbers(array, name)


def to_write(given: Any, name: str, is_packed: bool = False) -> NDArray[Any]:
    """Vectors, or packed doubles in any shape: the array itself, as its owner would not see what is added to a copy."""
    if not isinstance(given, np.ndarray):
        raise TypeError(f"{name} is of the type {type(given).__name__}; give a numpy array, which is added to")
    fits = given.dtype == np.float64 and given.flags.carray if is_packed else lies_well(rows(given, name))
    if not (fits and given.flags.writeable):
        found = f"dtype {given.dtype}, strides {given.strides}, writeable {given.flags.writeable}"
        example = "np.zeros(n)" if is_packed else "np.zeros((n, 3))"
        raise ValueError(f"{name} cannot be added to where it lies ({found}); give one such as {example}")
    return given


def of_bodies(given: Any, name: str, count: int | None = None, prepare: Any = to_read) -> Any:
    """One array for each body, in the order of their numbers, None for a body that has none. NULL for no arrays."""
    if given is None and prepare is to_read:
        return NULL
    none = np.empty((0, 3))
    arrays = [none if array is None else prepare(array, f"{name}[{i}]") for i, array in enumerate(given)]
    if count not in (None, len(arrays)):  # the library cannot tell
        raise ValueError(f"{name} has {len(arrays)} arrays for {count} bodies; give one for each")
    return arrays


def numbers(given: Array, name: str, count: int | None = None) -> Doubles:
    """Packed doubles in any shape; used where they lie if they are so already."""
    array = np.asarray(given)
    if not np.can_cast(array.dtype, np.float64, "same_kind"):
        raise TypeError(f"{name} has the dtype {array.dtype}; give real numbers")
    if count not in (None, array.size):
        raise ValueError(f"{name} has {array.size} numbers; give {count}")
    return np.ascontiguousarray(array, np.float64)


def counted(given: Array, name: str, count: int | None = None) -> tuple[int, Doubles]:
    """How many, and the numbers."""
    array = numbers(given, name, count)
    return array.size, array


def packed(**fields: tuple[Array, int]) -> Doubles:
    """The numbers of a struct that is made of doubles alone, given with their count for each field."""
    return np.concatenate([numbers(given, name, count).ravel() for name, (given, count) in fields.items()])


def indices(given: Array, name: str) -> NDArray[np.uint32]:
    """Numbers of vertices or nodes in any shape; a packed array of uint32 is used where it lies."""
    array = np.asarray(given)
    if array.dtype.kind not in "iu" and array.size:
        raise TypeError(f"{name} has the dtype {array.dtype}; give whole numbers")
    for wrong in np.argwhere((array < 0) | (array > 2**32 - 1)):
        raise ValueError(f"{name}{wrong.tolist()} is {array[tuple(wrong)]}; give a whole number from 0 to 2**32 - 1")
    return np.ascontiguousarray(array, np.uint32)
