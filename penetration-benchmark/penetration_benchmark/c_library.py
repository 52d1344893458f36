# SPDX-License-Identifier: MIT OR Apache-2.0
"""Libraries behind c/penetration.h."""

import ctypes

import numpy as np

from .library import CONTACT, Library

NOT_SUPPORTED = 1


class SurfaceStruct(ctypes.Structure):
    _fields_ = [("positions", ctypes.c_void_p), ("triangles", ctypes.c_void_p), ("vertex_count", ctypes.c_size_t),
                ("triangle_count", ctypes.c_size_t), ("is_convex", ctypes.c_int)]


class CLibrary(Library):
    """A shared library with the four functions."""

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
