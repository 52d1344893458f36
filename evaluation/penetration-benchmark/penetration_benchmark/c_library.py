# SPDX-License-Identifier: MIT OR Apache-2.0
"""Libraries behind c/penetration.h."""

import ctypes

import numpy as np

from .library import CONTACT, EXIT, Library

NOT_SUPPORTED = 1


class SurfaceStruct(ctypes.Structure):
    _fields_ = [("positions", ctypes.c_void_p), ("triangles", ctypes.c_void_p), ("vertex_count", ctypes.c_size_t),
                ("triangle_count", ctypes.c_size_t), ("is_convex", ctypes.c_int)]


class BodyStruct(ctypes.Structure):
    _fields_ = [*((name, ctypes.c_void_p) for name in ("positions", "triangles", "tetrahedra")),
                *((name, ctypes.c_size_t) for name in ("vertex_count", "triangle_count", "tetrahedron_count"))]


class CLibrary(Library):
    """A shared library with the four functions; load_body and exits may be left out."""

    settings = "as its authors have built it"

    def __init__(self, path, name=None):
        self.name = name or type(self).name
        # One copy for each object could not be had: the functions keep the pair between calls.
        self.functions = ctypes.CDLL(str(path))
        self.functions.penetration_contacts.restype = ctypes.c_ssize_t
        self.functions.penetration_contacts.argtypes = [ctypes.c_void_p, ctypes.c_size_t]
        self.functions.penetration_move.argtypes = [ctypes.c_void_p] * 3
        self.functions.penetration_inside.argtypes = [ctypes.c_void_p] * 2
        self.array = np.zeros(1024, CONTACT)
        self.exit_array = np.zeros(1024, np.dtype(EXIT.descr, align=True))
        if hasattr(self.functions, "penetration_exits"):
            self.functions.penetration_exits.restype = ctypes.c_ssize_t
            self.functions.penetration_exits.argtypes = [ctypes.c_void_p, ctypes.c_void_p, ctypes.c_size_t]

    def check(self, status, function):
        if status == NOT_SUPPORTED:
            raise NotImplementedError(f"penetration_{function} says that the library has not got it")
        if status:
            raise ValueError(f"penetration_{function} failed with {status}")

    def load(self, first, second):
        self.counts = len(first.positions), len(second.positions)
        kept, structs = [], []
        for surface in (first, second):
            positions = np.ascontiguousarray(surface.positions, float)
            triangles = np.ascontiguousarray(surface.triangles, np.uint32)
            kept += [positions, triangles]
            structs.append(SurfaceStruct(positions.ctypes.data, triangles.ctypes.data, len(positions), len(triangles),
                                         surface.is_convex))
        self.check(self.functions.penetration_load(*map(ctypes.byref, structs)), "load")

    def move(self, poses, positions):
        # They must stay until the next call.
        self.kept = [np.ascontiguousarray(array, float) for array in (poses, *positions)]
        self.check(self.functions.penetration_move(*(array.ctypes.data for array in self.kept)), "move")

    def inside(self):
        marks = [np.zeros(count, np.uint8) for count in self.counts]
        self.check(self.functions.penetration_inside(*(array.ctypes.data for array in marks)), "inside")
        return tuple(array.astype(bool) for array in marks)

    def contacts(self):
        count = self.functions.penetration_contacts(self.array.ctypes.data, len(self.array))
        if count > len(self.array):
            self.array = np.zeros(2 * count, CONTACT)
            count = self.functions.penetration_contacts(self.array.ctypes.data, len(self.array))
        if count < 0:
            self.check(-count, "contacts")
        return lambda: self.array[:count].copy()

    def load_body(self, body):
        if not hasattr(self.functions, "penetration_load_body"):
            super().load_body(body)
        arrays = [np.ascontiguousarray(body.positions, float), np.ascontiguousarray(body.triangles, np.uint32),
                  np.ascontiguousarray(body.tetrahedra, np.uint32)]
        struct = BodyStruct(*(array.ctypes.data for array in arrays), *map(len, arrays))
        self.check(self.functions.penetration_load_body(ctypes.byref(struct)), "load_body")

    def exits(self, positions):
        at = np.ascontiguousarray(positions, float)
        count = self.functions.penetration_exits(at.ctypes.data, self.exit_array.ctypes.data, len(self.exit_array))
        if count > len(self.exit_array):
            self.exit_array = np.zeros(2 * count, self.exit_array.dtype)
            count = self.functions.penetration_exits(at.ctypes.data, self.exit_array.ctypes.data, len(self.exit_array))
        if count < 0:
            self.check(-count, "exits")
        return lambda: self.exit_array[:count].copy()
