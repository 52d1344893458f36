# SPDX-License-Identifier: MIT OR Apache-2.0
"""Shapes and poses as files; README.md describes them."""

import csv
import os
import pathlib
from typing import NamedTuple

import numpy as np

from .library import Body, Surface

COLUMNS = ["id", "pair", "kind", *(f"quaternion_{c}" for c in "wxyz"), *(f"translation_{c}" for c in "xyz")]
# The folder of the repository with forces from judges that are not ours; to be named where the package is installed.
REFERENCES = pathlib.Path(os.environ.get("PENETRATION_REFERENCES",
                                         pathlib.Path(__file__).resolve().parents[2] / "references"))


class Pose(NamedTuple):
    """Where the second body of a pair stands; the first stays as in its file."""

    id: int
    pair: tuple[str, str]
    kind: str
    rotation: np.ndarray
    translation: np.ndarray

    def placements(self):
        """(2, 3, 4)."""
        return np.stack([np.eye(3, 4), np.column_stack([self.rotation, self.translation])])


def rotation_of(w, x, y, z):
    n = w * w + x * x + y * y + z * z
    return np.eye(3) + 2 / n * np.array([[-y * y - z * z, x * y - w * z, x * z + w * y],
                                         [x * y + w * z, -x * x - z * z, y * z - w * x],
                                         [x * z - w * y, y * z + w * x, -x * x - y * y]])


def placed(surface, placement):
    return surface.positions @ placement[:, :3].T + placement[:, 3]


def read_shape(path):
    positions, triangles, _ = read_lines(path)
    corners = positions[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    heights = np.einsum("tj,tvj->tv", normals, positions[None] - corners[:, :1])
    is_convex = bool((heights <= 1e-9 * np.linalg.norm(normals, axis=1)[:, None]).all())
    return Surface(path.stem, positions, triangles, is_convex)


def read_body(path):
    return Body(path.stem, *read_lines(path))


def read_lines(path):
    """The v and f lines of an .obj file, and the t lines of tetrahedra beside them."""
    positions, numbers = [], {"f": [], "t": []}
    for line in path.read_text(encoding="utf-8").splitlines():
        mark, *words = line.split() or [""]
        if mark == "v":
            positions.append([float(x) for x in words[:3]])
        elif mark in numbers:
            numbers[mark].append([int(x.split("/")[0]) - 1 for x in words[:3 if mark == "f" else 4]])
    return np.array(positions), np.array(numbers["f"], np.uint32), np.array(numbers["t"], np.uint32)


def write_shape(path, positions, triangles, tetrahedra=()):
    lines = ["v " + " ".join(f"{x:.9g}" for x in p) for p in positions]
    for mark, elements in (("f", triangles), ("t", tetrahedra)):
        lines += [f"{mark} " + " ".join(str(v + 1) for v in element) for element in elements]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def read_poses(path):
    poses = []
    with open(path, newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            q, t = ([float(row[column]) for column in columns] for columns in (COLUMNS[3:7], COLUMNS[7:]))
            poses.append(Pose(int(row["id"]), tuple(row["pair"].split("-")), row["kind"], rotation_of(*q), np.array(t)))
    return poses


def write_poses(path, rows):
    """rows: (pair, kind, quaternion, translation)."""
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(COLUMNS)
        for number, (pair, kind, q, t) in enumerate(rows):
            writer.writerow([number, "-".join(pair), kind, *(f"{x + 0.0:.9g}" for x in (*q, *t))])
