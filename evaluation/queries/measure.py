#!/usr/bin/env python3
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Times nearest points, inside tests and signed distances of raycontact beside other libraries, all called from Python
in turns.

Usage: measure.py [--peers FILE] [--points N] [--rounds N] [--files OBJ,...] [CSV]

Surfaces: a cube of 12 triangles, tori of 500, 5000 and 100 000, and closed surfaces of your own (--files). They ripple
by a 200th of their size from step to step. Points: `near`, within 2 % of the size of the surface, and `far`, anywhere in
a box of twice the size, both in random order; and `body`, the vertices of a torus that overlaps the surface, in the
order of the mesh, as in contact. Questions: `distance` to the nearest point, `inside` by a winding number or as a
library tells it, and `signed`, the distance negative inside.

Each question is asked twice: `still`, the points alone, and `moved`, with new positions of all vertices, and the tree
refitted, or built anew where a library cannot refit. Arrays are ready in the form that a library wants, and answers stay
in the form that it gives. Times are the processor's of all threads, medians of the rounds; a library that has taken
three seconds for its rounds is asked no more, and `rounds` says how often it was. trimesh is left out on surfaces of
more than 1000 triangles.

Before they are timed, the answers for some points are held against all triangles in double precision, before and after
a move: `worst` is the largest error of a distance in parts of the surface's size, and `wrong_side` counts wrong sides.
Of points nearer to the surface than a 100 000th of the size the sign does not count, since single precision cannot tell.

Exit status: 0 when measured, 1 when something fails or a distance is off by more than a 10 000th of the size, 2 for a
wrong command line. scripts/queries.sh builds what this needs and calls it."""

import argparse
import csv
import ctypes
import glob
import importlib.metadata
import os
import pathlib
import statistics
import sys
import time

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "IGL_NUM_THREADS"):
    os.environ[variable] = "1"

import numpy as np  # noqa: E402, after the number of threads

CHECKED = 48
PATIENCE = 3.0
# On finer ones it takes seconds to minutes for one round.
MOST_TRIANGLES = {"trimesh": 1000}
MOST_OFF = 1e-4
SIGN_COUNTS_BEYOND = 1e-5
STEPS = 4


# ---- Surfaces and points ----

def torus(around, across, tube=0.4):
    u, v = (2 * np.pi * np.arange(count) / count for count in (around, across))
    u, v = u[:, None], v[None, :]
    radius = 1 + tube * np.cos(v)
    points = np.stack([radius * np.cos(u), radius * np.sin(u), tube * np.sin(v) + 0 * u], axis=-1).reshape(-1, 3)
    i, j = (grid.ravel() for grid in np.meshgrid(np.arange(around), np.arange(across), indexing="ij"))
    a, b, c, d = ((i + di) % around * across + (j + dj) % across for di, dj in ((0, 0), (1, 0), (1, 1), (0, 1)))
    return points, np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])


def cube():
    points = np.array([[x, y, z] for x in (0.0, 1.0) for y in (0.0, 1.0) for z in (0.0, 1.0)])
    quads = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
    return points, np.array([triangle for a, b, c, d in quads for triangle in ([a, b, c], [a, c, d])])


def read_obj(path):
    points, triangles = [], []
    with open(path, encoding="utf-8") as file:
        for words in map(str.split, file):
            if words[:1] == ["v"]:
                points.append([float(word) for word in words[1:4]])
            elif words[:1] == ["f"]:
                corners = [int(word.split("/")[0]) - 1 for word in words[1:]]
                triangles += [[corners[0], *corners[i:i + 2]] for i in range(1, len(corners) - 1)]
    return np.array(points), np.array(triangles)


def size_of(points):
    return np.ptp(points, axis=0).max()


def rippled(points, step):
    size = size_of(points)
    height = size / 200 * np.sin((9 * points[:, 1] + 6 * points[:, 2]) / size + 0.9 * step)
    return points + height[:, None] * [0, 0, 1]


def point_sets(points, triangles, count, random):
    size, middle = size_of(points), (points.min(axis=0) + points.max(axis=0)) / 2
    corners = points[triangles[random.integers(len(triangles), size=count)]]
    weights = random.dirichlet([1, 1, 1], count)
    ways = random.normal(size=(count, 3))
    ways *= (0.02 * size * random.random(count) / np.linalg.norm(ways, axis=1))[:, None]
    side = round(count ** 0.5)
    body = torus(side, count // side)[0] * size / 2.8 + middle + [0.3 * size, 0.1 * size, 0.05 * size]
    return {
        "near": np.einsum("ij,ijk->ik", weights, corners) + ways,
        "far": middle + size * (2 * random.random((count, 3)) - 1),
        "body": body,
    }


# ---- The judge: all triangles, in double precision ----

def exact_distances(points, triangles, asked):
    a, b, c = (points[triangles[:, i]] for i in range(3))
    found = []
    for p in asked:
        squared = np.full(len(triangles), np.inf)
        for start, end in ((a, b), (b, c), (c, a)):
            way = end - start
            t = np.clip(np.einsum("ij,ij->i", p - start, way) / np.einsum("ij,ij->i", way, way), 0, 1)
            squared = np.minimum(squared, ((start + t[:, None] * way - p) ** 2).sum(axis=1))
        normal = np.cross(b - a, c - a)
        height = np.einsum("ij,ij->i", p - a, normal)
        sides = [np.einsum("ij,ij->i", np.cross(end - start, p - start), normal)
                 for start, end in ((a, b), (b, c), (c, a))]
        above = np.minimum.reduce(sides) >= 0
        squared[above] = np.minimum(squared, height ** 2 / np.einsum("ij,ij->i", normal, normal))[above]
        found.append(squared.min() ** 0.5)
    return np.array(found)


def exact_inside(points, triangles, asked):
    """By the sum of the solid angles."""
    found = []
    for p in asked:
        a, b, c = (points[triangles[:, i]] - p for i in range(3))
        x, y, z = (np.linalg.norm(side, axis=1) for side in (a, b, c))
        dot = lambda u, v: np.einsum("ij,ij->i", u, v)  # noqa: E731
        angle = np.arctan2(dot(a, np.cross(b, c)), x * y * z + dot(a, b) * z + dot(b, c) * x + dot(c, a) * y)
        found.append(angle.sum() / (2 * np.pi) > 0.5)
    return np.array(found)


# ---- The libraries. `ready` turns an array into what `move` and the questions take; `distances` reads an answer. ----

class Library:
    dtype = np.float64
    questions = ("distance", "inside", "signed")

    def ready_positions(self, positions):
        return np.ascontiguousarray(positions, self.dtype)

    ready_points = ready_positions

    def distances(self, answer):
        return np.asarray(answer, np.float64)

    def are_inside(self, answer):
        return np.asarray(answer) > 0.5


class Raycontact(Library):
    name, follows_by = "raycontact", "refits"

    def __init__(self, positions, triangles):
        import raycontact

        self.version = importlib.metadata.version("raycontact")
        self.mesh = raycontact.Mesh(self.ready_positions(positions), triangles.astype(np.uint32))
        self.mesh.octree()

    def move(self, positions):
        self.mesh.set_positions(positions)

    def distance(self, points):
        return self.mesh.closest_points(points)["distance"]

    def inside(self, points):
        return self.mesh.contains(points)

    def signed(self, points):
        return self.mesh.signed_distances(points)


class RaycontactSingle(Raycontact):
    name, dtype = "raycontact, single", np.float32


class Shim(Library):
    """A class of peers.cpp."""

    kind = ""
    library = None

    def create(self, *first):
        self.of = lambda function: getattr(Shim.library, f"{self.kind}_{function}")
        self.of("create").restype = ctypes.c_void_p
        self.handle = ctypes.c_void_p(self.of("create")(
            *first, self.at(self.positions), ctypes.c_size_t(len(self.positions)), self.at(self.triangles),
            ctypes.c_size_t(len(self.triangles))))

    @staticmethod
    def at(array):
        return ctypes.c_void_p(array.ctypes.data)

    def take(self, positions, triangles):
        self.positions, self.triangles = self.ready_positions(positions), np.ascontiguousarray(triangles, np.uint32)

    def move(self, positions):
        # Embree reads them where they are, so they have to stay.
        self.positions = positions
        self.of("move")(self.handle, self.at(positions))

    def ask(self, question, points):
        found = np.empty(len(points))
        self.of(question)(self.handle, self.at(points), ctypes.c_size_t(len(points)), self.at(found))
        return found

    def distance(self, points):
        return self.ask("closest", points)

    def inside(self, points):
        return self.ask("inside", points)

    def signed(self, points):
        return self.ask("signed", points)

    def __del__(self):
        self.of("destroy")(self.handle)


class Embree3(Shim):
    name, kind, dtype, follows_by, questions = "Embree 3", "embree", np.float32, "refits", ("distance",)
    version = "3.13.5"

    def path(self):
        return "libembree3.so.3"

    def __init__(self, positions, triangles):
        self.take(positions, triangles)
        self.create(self.path().encode())


class Embree4(Embree3):
    name = "Embree 4"

    def path(self):
        import embreex

        self.version = importlib.metadata.version("embreex")
        folder = pathlib.Path(embreex.__file__).parents[1] / "embreex.libs"
        for path in sorted(glob.glob(f"{folder}/libtbb*")):
            ctypes.CDLL(path, ctypes.RTLD_GLOBAL)
        return glob.glob(f"{folder}/libembree4*")[0]


class Cgal(Shim):
    name, kind, follows_by, version = "CGAL", "cgal", "builds", "5.5.1"

    def __init__(self, positions, triangles):
        self.take(positions, triangles)
        self.create()


class Libigl(Library):
    name, follows_by = "libigl", "builds"

    def __init__(self, positions, triangles):
        import igl

        self.igl, self.version = igl, importlib.metadata.version("libigl")
        self.triangles = np.ascontiguousarray(triangles, np.int64)
        self.move(self.ready_positions(positions))

    def move(self, positions):
        self.positions, self.tree, self.winding = positions, self.igl.AABB(), None
        self.tree.init(positions, self.triangles)

    def distance(self, points):
        return np.sqrt(self.tree.squared_distance(self.positions, self.triangles, points)[0])

    def inside(self, points):
        if self.winding is None:
            self.winding = self.igl.FastWindingNumberBVH()
            self.winding.init(self.positions, self.triangles)
        return self.winding.winding_number(points)

    def signed(self, points):
        return np.where(self.inside(points) > 0.5, -(d := self.distance(points)), d)


class Open3d(Library):
    name, dtype, follows_by = "Open3D", np.float32, "builds"

    def __init__(self, positions, triangles):
        import open3d

        self.o3d, self.version = open3d, importlib.metadata.version("open3d")
        self.triangles = open3d.core.Tensor(np.ascontiguousarray(triangles, np.uint32))
        self.move(self.ready_positions(positions))

    def ready_positions(self, positions):
        return self.o3d.core.Tensor(np.ascontiguousarray(positions, np.float32))

    ready_points = ready_positions

    def move(self, positions):
        self.scene = self.o3d.t.geometry.RaycastingScene(nthreads=1)
        self.scene.add_triangles(positions, self.triangles)

    def distance(self, points):
        return self.scene.compute_distance(points, nthreads=1)

    def inside(self, points):
        return self.scene.compute_occupancy(points, nthreads=1)

    def signed(self, points):
        return self.scene.compute_signed_distance(points, nthreads=1)

    def distances(self, answer):
        return answer.numpy().astype(np.float64)

    def are_inside(self, answer):
        return answer.numpy() > 0.5


class Fcpw(Library):
    name, dtype, follows_by = "fcpw", np.float32, "refits"

    def __init__(self, positions, triangles):
        import fcpw

        self.fcpw, self.version, self.scene = fcpw, importlib.metadata.version("fcpw"), fcpw.scene_3D()
        self.scene.set_object_count(1)
        self.scene.set_object_vertices(np.asfortranarray(positions, np.float32), 0)
        self.scene.set_object_triangles(np.asfortranarray(triangles, np.int32), 0)
        self.scene.build(fcpw.aggregate_type.bvh_surface_area, True)

    def ready_positions(self, positions):
        return self.fcpw.float_3D_list([row for row in np.ascontiguousarray(positions, np.float32)])

    def ready_points(self, points):
        # contains() writes its answers into lists alone.
        return np.asfortranarray(points, np.float32), self.ready_positions(points)

    def move(self, positions):
        self.scene.update_object_vertices(positions, 0)
        self.scene.refit()

    def ask(self, points):
        found = self.fcpw.interaction_3D_list()
        self.scene.find_closest_points(points, np.full(len(points), np.inf, np.float32), found)
        return found

    def distance(self, points):
        return self.ask(points[0]), None

    def inside(self, points):
        inside = self.fcpw.uint32_list()
        self.scene.contains(points[1], inside)
        return inside

    def signed(self, points):
        inside = self.inside(points)
        return self.ask(points[0]), inside

    def are_inside(self, answer):
        return np.array(list(answer)) != 0

    def distances(self, answer):
        found, inside = answer
        far = np.array([one.d for one in found], np.float64)
        return far if inside is None else np.where(np.array(list(inside)) != 0, -far, far)


class Trimesh(Library):
    name, follows_by = "trimesh", "builds"

    def __init__(self, positions, triangles):
        import trimesh

        self.trimesh, self.version, self.triangles = trimesh, importlib.metadata.version("trimesh"), triangles
        self.move(positions)

    def move(self, positions):
        self.mesh = self.trimesh.Trimesh(positions, self.triangles, process=False)

    def distance(self, points):
        return self.trimesh.proximity.closest_point(self.mesh, points)[1]

    def inside(self, points):
        return self.mesh.contains(points)

    def signed(self, points):
        return -self.trimesh.proximity.signed_distance(self.mesh, points)


LIBRARIES = (Raycontact, RaycontactSingle, Embree3, Embree4, Cgal, Libigl, Open3d, Fcpw, Trimesh)
HEAD = ["surface", "triangles", "points", "count", "question", "positions", "library", "version", "precision", "follows_by",
        "rounds", "us", "times_raycontact", "worst", "wrong_side"]


def checks(libraries, positions, triangles, asked):
    """By library and question: the worst error in parts of the size, and how many signs are wrong; after moves too."""
    found = {}
    for step in (0, 1):
        there = rippled(positions, step)
        size, far = size_of(positions), exact_distances(there, triangles, asked)
        inside = exact_inside(there, triangles, asked)
        for library in libraries:
            if step:
                library.move(library.ready_positions(there))
            for question in library.questions:
                answer, off = getattr(library, question)(library.ready_points(asked)), 0.0
                told = library.are_inside(answer) if question == "inside" else None
                if told is None:
                    answer = library.distances(answer)
                    off, told = np.abs(np.abs(answer) - far).max() / size, answer < 0
                sure = far > SIGN_COUNTS_BEYOND * size
                wrong = int((told != inside)[sure].sum()) if question != "distance" else 0
                before = found.get((library, question), (0, 0))
                found[library, question] = max(before[0], off), before[1] + wrong
    return found


def timed(libraries, steps, points, question, moves, rounds):
    times = {library: [] for library in libraries}
    ready = {library: (library.ready_points(points), [library.ready_positions(step) for step in steps])
             for library in libraries}
    # The first round still allocates.
    for turn in range(rounds + 1):
        for library, spent in times.items():
            if sum(spent) > PATIENCE:
                continue
            asked, positions = ready[library]
            ask = getattr(library, question)
            start = time.process_time_ns()
            if moves:
                library.move(positions[turn % len(positions)])
            ask(asked)
            spent.append((time.process_time_ns() - start) / 1e9)
    return {library: (len(spent[1:] or spent), statistics.median(spent[1:] or spent))
            for library, spent in times.items()}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("csv", nargs="?", default="-", help="where the figures go (default: printed)")
    parser.add_argument("--peers", default="", help="the shared library made of peers.cpp (default: without these)")
    parser.add_argument("--points", type=int, default=4096, help="of each set (default: 4096)")
    parser.add_argument("--rounds", type=int, default=7, help="of each question (default: 7)")
    parser.add_argument("--files", default="", help="further surfaces, .obj, with commas between")
    parser.add_argument("--seed", type=int, default=1, help="of the points (default: 1)")
    options = parser.parse_args()
    if options.peers:
        Shim.library = ctypes.CDLL(os.path.abspath(options.peers))
    kinds = [kind for kind in LIBRARIES if options.peers or not issubclass(kind, Shim)]
    surfaces = {"cube": cube(), "torus 25×10": torus(25, 10), "torus 50×50": torus(50, 50),
                "torus 250×200": torus(250, 200)}
    surfaces |= {pathlib.Path(path).stem: read_obj(path) for path in options.files.split(",") if path}
    random, rows, faults = np.random.default_rng(options.seed), [], []
    for surface, (positions, triangles) in surfaces.items():
        steps = [rippled(positions, step) for step in range(STEPS)]
        libraries = [kind(steps[0], triangles) for kind in kinds
                     if len(triangles) <= MOST_TRIANGLES.get(kind.name, len(triangles))]
        for name, points in point_sets(positions, triangles, options.points, random).items():
            for library in libraries:
                library.move(library.ready_positions(steps[0]))
            judged = checks(libraries, positions, triangles, points[:: max(1, len(points) // CHECKED)])
            for question in Library.questions:
                asked = [library for library in libraries if question in library.questions]
                for moves in (True, False):
                    times = timed(asked, steps, points, question, moves, options.rounds)
                    for library, (rounds, seconds) in times.items():
                        off, wrong = judged[library, question]
                        if off > MOST_OFF:
                            faults.append(f"{library.name} is off by {off:.2g}: {question}, {surface}, {name}")
                        rows.append([
                            surface, len(triangles), name, len(points), question, "moved" if moves else "still",
                            library.name, library.version, "f64" if library.dtype is np.float64 else "f32",
                            library.follows_by, rounds, f"{1e6 * seconds:.4g}", f"{seconds / times[libraries[0]][1]:.3g}",
                            f"{off:.2g}", wrong])
                    told = " ".join(f"{library.name} {1e6 * seconds:.0f}" for library, (_, seconds) in times.items())
                    print(surface, name, question, "moved" if moves else "still", told, file=sys.stderr)
    out = sys.stdout if options.csv == "-" else open(options.csv, "w", newline="", encoding="utf-8")
    with out:
        writer = csv.writer(out, lineterminator="\n")
        writer.writerow(HEAD)
        writer.writerows(rows)
    sys.exit("\n".join(dict.fromkeys(faults)) or None)


if __name__ == "__main__":
    main()
