# SPDX-License-Identifier: MIT OR Apache-2.0
"""The shared library: how it is called, and how it fails."""

from __future__ import annotations

import functools
import os
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _header
from ._ffi import ffi

NULL: Any = ffi.NULL
NUMBERS = {"double": np.float64, "int32_t": np.int32, "uint8_t": np.uint8, "uint32_t": np.uint32, "uint64_t": np.uint64}
SCALARS = {np.dtype(np.float32): _header.Scalar.F32, np.dtype(np.float64): _header.Scalar.F64}
# It stays until the process ends: Python then frees objects in no certain order, some of them through the library.
FLAGS = ffi.RTLD_NOW | getattr(ffi, "RTLD_NODELETE", 0)
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
    formats, offsets = [dtype_of(field.type) for field in fields], [field.offset for field in fields]
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


def create(kind: str, *given: Any, way: str = "create") -> Any:
    """A handle that is freed with its last reference."""
    handle = answer(getattr(library, f"rayc_{kind}_{way}"), *given)
    return ffi.gc(handle, getattr(library, f"rayc_{kind}_destroy"))


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
