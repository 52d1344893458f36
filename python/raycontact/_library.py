# SPDX-License-Identifier: MIT OR Apache-2.0
"""The shared library: how it is called and fails, and the caller's arrays: where they lie, wherever that can be."""

from __future__ import annotations

import functools
import os
from typing import TYPE_CHECKING, Any, Iterable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _header
from ._ffi import ffi as ffi

NULL: Any = ffi.NULL
NUMBERS = {"double": np.float64, "int32_t": np.int32, "uint8_t": np.uint8, "uint32_t": np.uint32, "uint64_t": np.uint64}
SCALARS = {np.dtype(np.float32): _header.Scalar.F32, np.dtype(np.float64): _header.Scalar.F64}
FLAGS = ffi.RTLD_NOW | getattr(ffi, "RTLD_NODELETE", 0)  # it stays, since objects may be freed as the process ends
library: Any = ffi.dlopen(os.path.join(os.path.dirname(os.path.abspath(__file__)), _header.LIBRARY), FLAGS)


class Error(RuntimeError):
    """A call of the library has failed and changed nothing. The text says what was wrong where, and what to do."""

    def __init__(self, status: int, told: str = "") -> None:
        self.status = _header.Status(status)
        told = told or ffi.string(library.rayc_last_error_message()).decode().replace("RAYC_SAMPLING_", "Sampling.")
        super().__init__(self.status, told or self.status.name)

    def __str__(self) -> str:
        return str(self.args[1])


@functools.lru_cache(None)
def dtype_of(kind: Any) -> np.dtype[Any]:
    """The numpy type of a C type, structs field by field."""
    if kind.kind == "primitive":
        return np.dtype(NUMBERS[kind.cname])
    if kind.kind == "array":
        return np.dtype((dtype_of(kind.item), (kind.length,)))
    names, fields = zip(*kind.fields)
    formats, offsets = zip(*((dtype_of(field.type), field.offset) for field in fields))
    return np.dtype({"names": names, "formats": formats, "offsets": offsets, "itemsize": ffi.sizeof(kind)})


def argument(kind: Any, given: Any) -> Any:
    """What C is given for an array, or a list of arrays where it asks for vectors: where they lie."""
    if kind.kind != "pointer" or not isinstance(given, (np.ndarray, list)):
        return given
    if isinstance(given, np.ndarray):
        return ffi.cast("void *", given.__array_interface__["data"][0])
    structs = ffi.new(ffi.getctype(kind.item, "[]"), len(given))
    for struct, array in zip(structs, given):
        struct.data, struct.count, struct.scalar = argument(kind, array), len(array), SCALARS[array.dtype]
        struct.stride = array.strides[0] if len(array) > 1 else 0
    return structs


def call(function: Any, *given: Any) -> None:
    """Raises Error unless a call succeeds. Its arrays live for as long as it lasts."""
    if status := function(*map(argument, ffi.typeof(function).args, given)):
        raise Error(status)


def answer(function: Any, *given: Any) -> Any:
    """What a call writes to its last argument."""
    out = ffi.new(ffi.typeof(function).args[-1])
    call(function, *given, out)
    return out[0]


def copied(function: Any, shape: int | tuple[int, ...], *given: Any) -> NDArray[Any]:
    """The numbers or structs that a call copies to its last argument."""
    found = np.empty(shape, dtype_of(ffi.typeof(function).args[-1].item))
    call(function, *given, found)
    return found


def copy_of(numbers: Any, count: int) -> NDArray[Any]:
    """A copy of so many numbers of the library's own."""
    kind = ffi.typeof(numbers).item
    return np.frombuffer(ffi.buffer(numbers, count * ffi.sizeof(kind)), dtype_of(kind)).copy()


def call_for(name: str, array: NDArray[Any]) -> Any:
    """The function of contact systems for arrays of this type."""
    return getattr(library, f"rayc_contact_system_{name}" + "_f32" * (array.dtype == np.float32))


def create(kind: str, *given: Any, way: str = "create") -> Any:
    """A handle that is freed with its last reference."""
    return ffi.gc(answer(getattr(library, f"rayc_{kind}_{way}"), *given), getattr(library, f"rayc_{kind}_destroy"))


def options(kind: str, given: Any) -> Any:
    """The library's defaults with what is given; NULL, which stands for them, where nothing is."""
    if not given:
        return NULL
    struct = ffi.new(f"rayc_{kind}_options *")
    call(getattr(library, f"rayc_default_{kind}_options"), ffi.sizeof(struct[0]), struct)
    known = getattr(_header, f"{kind.title().replace('_', '')}Options").__annotations__
    for name, value in given.items():
        if name not in known:
            raise TypeError(f"there is no option '{name}'; there are: {', '.join(known)}")
        names = getattr(_header.ENUMS.get(name), "__members__", {})
        try:
            setattr(struct, name, names.get(str(value).upper(), value))
        except (TypeError, OverflowError) as error:
            by_name = f"; give one of {', '.join(names).lower()}" if names else ""
            raise type(error)(f"option {name}: {error}{by_name}") from None
    return struct


def paper_detection_options() -> dict[str, Any]:
    """The options of a query that does just what the paper does, as keyword arguments."""
    found = answer(library.rayc_paper_detection_options, ffi.sizeof("rayc_detection_options"))
    return {name: getattr(found, name) for name in _header.DetectionOptions.__annotations__}


if TYPE_CHECKING:  # for type checkers alone: the options of calls, and an array or none for each body
    from typing_extensions import Unpack as Unpack

    Arrays = Iterable[ArrayLike | None] | None
    Targets = Iterable[NDArray[Any] | None]
else:
    Unpack = Arrays = Targets = None

Array = ArrayLike
Doubles = NDArray[np.float64]


def on_host(given: Any, name: str) -> NDArray[Any]:
    """An array of numpy's; memory of a device is not to be read from here."""
    if getattr(given, "__dlpack_device__", lambda: (1, 0))()[0] not in (1, 3):  # DLPack's numbers of the host's memory
        raise TypeError(f"{name} lies on a device; give a copy on the host, such as .numpy() or .cpu() makes")
    return np.asarray(given)


def rows(given: Array, name: str, count: str = "n") -> NDArray[Any]:
    """One vector for each row."""
    if (array := on_host(given, name)).ndim != 2 or array.shape[1] != 3:
        raise ValueError(f"{name} has the shape {array.shape}; give ({count}, 3)")
    return array


def lies_well(array: NDArray[Any]) -> bool:
    """Whether vectors can be used where they are: in the library's numbers, rows packed and in ascending order."""
    is_ascending = len(array) < 2 or array.strides[0] >= 3 * array.itemsize
    return array.dtype in SCALARS and (len(array) == 0 or array.strides[1] == array.itemsize and is_ascending)


def to_read(given: Array, name: str) -> NDArray[Any]:
    """Vectors: the array itself where the library can read it, else a copy."""
    return array if lies_well(array := rows(given, name)) else numbers(array, name)


def to_write(given: Any, name: str, is_packed: bool = False) -> NDArray[Any]:
    """Vectors, or packed numbers in any shape: the array itself, as its owner would not see what is added to a copy."""
    if not isinstance(given, np.ndarray):
        raise TypeError(f"{name} is of the type {type(given).__name__}; give a numpy array, which is added to")
    fits = given.dtype in SCALARS and given.flags.carray if is_packed else lies_well(rows(given, name))
    if not (fits and given.flags.writeable):
        found = f"dtype {given.dtype}, strides {given.strides}, writeable {given.flags.writeable}"
        raise ValueError(f"{name} cannot be added to where it lies ({found}); give one such as np.zeros({given.shape})")
    return given


def of_bodies(given: Any, name: str, count: int | None = None, prepare: Any = to_read) -> Any:
    """One array for each body, in the order of their numbers, None for a body that has none. NULL for no arrays."""
    if given is None and prepare is to_read:
        return NULL
    arrays = [np.empty((0, 3)) if a is None else prepare(a, f"{name}[{i}]") for i, a in enumerate(given)]
    if count not in (None, len(arrays)):  # the library cannot tell
        raise ValueError(f"{name} has {len(arrays)} arrays for {count} bodies; give one for each")
    return arrays


def numbers(given: Array, name: str, count: int | None = None, dtype: Any = np.float64) -> NDArray[Any]:
    """Packed doubles, or numbers of another type, in any shape; used where they lie if they are so already."""
    if not np.can_cast((array := on_host(given, name)).dtype, np.float64, "same_kind"):
        raise TypeError(f"{name} has the dtype {array.dtype}; give real numbers")
    if count not in (None, array.size):
        raise ValueError(f"{name} has {array.size} numbers; give {count}")
    return np.ascontiguousarray(array, dtype)


def alike(names: str, *given: Array, dtype: Any = None) -> list[NDArray[Any]]:
    """Equally many numbers each, of this type; by default as floats if all are, else as doubles."""
    arrays = [on_host(array, name) for array, name in zip(given, names.split())]
    dtype = dtype or (np.float32 if {array.dtype for array in arrays} == {np.dtype(np.float32)} else np.float64)
    return [numbers(array, name, arrays[0].size, dtype) for name, array in zip(names.split(), arrays)]


def packed(**fields: tuple[Array, int]) -> Doubles:
    """The numbers of a struct that is made of doubles alone, given with their count for each field."""
    return np.concatenate([numbers(given, name, count).ravel() for name, (given, count) in fields.items()])


def indices(given: Array, name: str) -> NDArray[np.uint32]:
    """Numbers of vertices or nodes in any shape; a packed array of uint32 is used where it lies."""
    if (array := on_host(given, name)).dtype.kind not in "iu" and array.size:
        raise TypeError(f"{name} has the dtype {array.dtype}; give whole numbers")
    for wrong in np.argwhere((array < 0) | (array > 2**32 - 1)):
        raise ValueError(f"{name}{wrong.tolist()} is {array[tuple(wrong)]}; give a whole number from 0 to 2**32 - 1")
    return np.ascontiguousarray(array, np.uint32)
