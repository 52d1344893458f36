# SPDX-License-Identifier: MIT OR Apache-2.0
"""The judges against closed forms, on balls and boxes."""

import csv
from fractions import Fraction

import numpy as np
import pytest

from penetration_benchmark import exact, files, shapes, tasks


def random_points(count, reach, seed=1):
    return np.random.default_rng(seed).uniform(-reach, reach, (count, 3))


def test_inside_a_box_is_between_its_faces():
    positions, triangles = shapes.make("box")
    half = positions.max(0)
    points = random_points(4000, 0.7)
    points[:1000, 0] = half[0]  # in a face's plane
    points[1000:2000] = np.sign(points[1000:2000]) * half * (1 + 2.0**-52)  # at a corner, the next number out
    points[2000:2500] = np.sign(points[2000:2500]) * np.nextafter(half, 0)
    sizes = np.abs(points)
    expected = np.where((sizes < half).all(1), 1, np.where((sizes > half).any(1), -1, 0))
    assert (exact.classify(points, positions, triangles) == expected).all()
    assert min((expected == value).sum() for value in (-1, 0, 1)) > 300


@pytest.mark.parametrize("name", ["ball", "ball_fine"])
def test_inside_a_ball_goes_by_its_planes(name):
    positions, triangles = shapes.make(name)
    corners = positions[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    offsets = np.einsum("ij,ij->i", normals, corners[:, 0])
    points = random_points(1500, 0.55)
    expected = np.where((points @ normals.T < offsets).all(1), 1, -1)
    assert (exact.classify(points, positions, triangles) == expected).all()
    lengths = np.linalg.norm(points, axis=1)
    inner = (offsets / np.linalg.norm(normals, axis=1)).min()
    assert (expected[lengths < inner] == 1).all() and (expected[lengths > 0.5] == -1).all()


def test_signs_are_those_of_fractions():
    random = np.random.default_rng(2)
    base = random.uniform(-1, 1, (300, 3, 3))
    weights = random.integers(-4, 5, (300, 2, 1)) / 4
    # In the plane of three points but for rounding.
    last = base[:, 0] + weights[:, 0] * (base[:, 1] - base[:, 0]) + weights[:, 1] * (base[:, 2] - base[:, 0])
    found = exact.side_of_plane(*base.transpose(1, 0, 2), last)
    for corners, d, sign in zip(base.tolist(), last.tolist(), found):
        u, v, w = ([Fraction(x) - Fraction(y) for x, y in zip(corner, d)] for corner in corners)
        value = -(u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2])
                  + u[2] * (v[0] * w[1] - v[1] * w[0]))
        assert sign == (value > 0) - (value < 0)
    assert len(set(found.tolist())) == 3


@pytest.mark.parametrize("way, is_apart", [(1.0 - 2.0**-53, False), (1.0, False), (1.0 + 2.0**-51, True), (0.0, False),
                                           (0.3, False)])
def test_boxes_are_apart_beyond_a_touch(way, is_apart):
    positions, triangles = shapes.make("box")
    apart = exact.Apart((triangles, triangles))
    assert apart((positions, positions + [way, 0, 0])) == is_apart
    assert apart((positions + [way, 0, 0], positions)) == is_apart
    if not way:
        assert not apart((positions, 0.1 * positions)) and not apart((0.1 * positions, positions))


def test_one_crossing_is_that_of_all_crossings():
    random = np.random.default_rng(4)
    counts = [0, 0]
    for corners in random.integers(-1, 2, (3000, 5, 3)).astype(float):
        segment, triangle = corners[:2], corners[2:]
        if not np.cross(triangle[1] - triangle[0], triangle[2] - triangle[0]).any():
            continue
        sides = exact.side_of_plane(*(np.broadcast_to(p, (2, 3)) for p in triangle), segment)
        if not sides.any():
            continue
        met = exact.edges_meet(segment, np.array([[0, 1]]), triangle, np.array([[0, 1, 2]])) is not None
        assert exact.crosses(*segment, *triangle) == met
        counts[met] += 1
    assert min(counts) > 200


def test_what_is_remembered_changes_no_answer():
    random = np.random.default_rng(5)
    positions, triangles = shapes.make("comb")
    remembering, answers = exact.Apart((triangles, triangles)), []
    for way in np.cumsum(random.normal(scale=0.15, size=(150, 3)), axis=0):
        moved = positions + way % 2 - 1
        answers.append(remembering((positions, moved)))
        assert answers[-1] == exact.Apart((triangles, triangles))((positions, moved))
    assert 20 < sum(answers) < 130


def area_inside(first, triangles, planes):
    """The area vector of a surface within half-spaces normal · x ≤ offset: each triangle clipped by all."""
    area = np.zeros(3)
    for corners in first[triangles]:
        polygon = list(corners)
        for normal, offset in planes:
            clipped = []
            for p, q in zip(polygon, polygon[1:] + polygon[:1]):
                a, b = normal @ p - offset, normal @ q - offset
                if a <= 0:
                    clipped.append(p)
                if a * b < 0:
                    clipped.append(p + a / (a - b) * (q - p))
            polygon = clipped
        for p, q in zip(polygon[1:], polygon[2:]):
            area += 0.5 * np.cross(p - polygon[0], q - polygon[0])
    return area


def test_even_pressure_is_the_clipped_surface_of_boxes():
    judge = tasks.read_judges()["overlap_volume"]
    surfaces = {name: files.read_shape(files.REFERENCES / "shapes" / f"{name}.obj") for name in ("cube", "box")}
    poses = [pose for pose in files.read_poses(files.REFERENCES / "poses.csv") if set(pose.pair) <= set(surfaces)]
    assert len(poses) == 750
    for pose in poses[::15]:
        first, second = (surfaces[name] for name in pose.pair)
        moved = files.placed(second, pose.placements()[1])
        corners = moved[second.triangles]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        planes = list(zip(normals, np.einsum("ij,ij->i", normals, corners[:, 0])))
        expected = -area_inside(first.positions, first.triangles, planes)
        assert np.abs(judge[pose.id] - expected).max() < 1e-12


def test_references_name_the_same_poses():
    with open(files.REFERENCES / "poses.csv", encoding="utf-8") as file:
        count = sum(1 for _ in csv.DictReader(file))
    assert {len(forces) for forces in tasks.read_judges().values()} == {count}
