# SPDX-License-Identifier: MIT OR Apache-2.0
"""The shared library, its errors, and its structs."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any

import numpy as np

from . import _header
from ._ffi import ffi

# It stays until the process ends: Python then frees objects in no certain order, some of them through the library.
FLAGS = ffi.RTLD_NOW | getattr(ffi, "RTLD_NODELETE", 0)
library: Any = ffi.dlopen(os.path.join(os.path.dirname(os.path.abspath(__file__)), _header.LIBRARY), FLAGS)

NULL: Any = ffi.NULL
NUMBERS = {"double": np.float64, "int32_t": np.int32, "uint8_t": np.uint8, "uint32_t": np.uint32, "uint64_t": np.uint64}


class Error(RuntimeError):
    """A call of the library has failed and changed nothing. The text is the library's: what was wrong where, and what
    to do."""

    def __init__(self, status: int) -> None:
        self.status = _header.Status(status)
        text = ffi.string(library.rayc_last_error_message()).decode()
        super().__init__(text or self.status.name)


def check(status: int) -> None:
    """Raises Error unless a call has succeeded."""
    if status:
        raise Error(status)


def answer(kind: str, function: Any, *arguments: Any) -> Any:
    """What a call writes to its last argument."""
    out = ffi.new(f"{kind} *")
    check(function(*arguments, out))
    return out[0]


def create(kind: str, *arguments: Any, way: str = "create") -> Any:
    """A handle that is freed with its last reference."""
    handle = answer(f"rayc_{kind} *", getattr(library, f"rayc_{kind}_{way}"), *arguments)
    return ffi.gc(handle, getattr(library, f"rayc_{kind}_destroy"))


def version() -> str:
    """The library's version, such as "0.2.0"."""
    number = library.rayc_version()
    return f"{number // 10000}.{number // 100 % 100}.{number % 100}"


def options(kind: str, given: Mapping[str, Any]) -> Any:
    """The library's defaults with what is given; NULL, which stands for them, where nothing is."""
    if not given:
        return NULL
    struct = ffi.new(f"rayc_{kind}_options *")
    check(getattr(library, f"rayc_default_{kind}_options")(ffi.sizeof(struct[0]), struct))
    known = getattr(_header, f"{kind.title().replace('_', '')}Options").__annotations__
    for name, value in given.items():
        if name not in known:
            raise TypeError(f"there is no option '{name}'; there are: {', '.join(known)}")
        try:
            setattr(struct, name, value)
        except (TypeError, OverflowError) as error:
            raise type(error)(f"option {name}: {error}") from None
    return struct


def paper_detection_options() -> dict[str, Any]:
    """The options of a query that does just what the paper does, as keyword arguments."""
    struct = ffi.new("rayc_detection_options *")
    check(library.rayc_paper_detection_options(ffi.sizeof(struct[0]), struct))
    return {name: getattr(struct, name) for name in _header.DetectionOptions.__annotations__}


def dtype_of(kind: Any) -> np.dtype[Any]:
    """The numpy type of a C type, structs field by field."""
    if kind.kind == "primitive":
        return np.dtype(NUMBERS[kind.cname])
    if kind.kind == "array":
        return np.dtype((dtype_of(kind.item), (kind.length,)))
    names, fields = zip(*kind.fields)
    formats, offsets = [dtype_of(field.type) for field in fields], [field.offset for field in fields]
    return np.dtype({"names": names, "formats": formats, "offsets": offsets, "itemsize": ffi.sizeof(kind)})


DTYPES = {
    name: dtype_of(ffi.typeof(f"rayc_{name}"))
    for name in ("closest_point", "contact", "escape_push", "hit", "own_exit", "pair_memory", "ray")
}
