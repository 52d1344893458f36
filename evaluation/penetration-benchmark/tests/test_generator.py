# SPDX-License-Identifier: MIT OR Apache-2.0
"""Shapes and poses: the same for the same seed, and what they are said to be."""

import collections

import numpy as np
import pytest

from penetration_benchmark import exact, files, poses, shapes
from penetration_benchmark.generate import generate


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    path = tmp_path_factory.mktemp("set")
    generate(path, 1, 0.08)
    return path


def contents(folder):
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def test_a_seed_gives_the_same_files(folder, tmp_path):
    generate(tmp_path / "same", 1, 0.08)
    generate(tmp_path / "other", 2, 0.08)
    assert contents(tmp_path / "same") == contents(folder)
    assert contents(tmp_path / "other")["poses.csv"] != contents(folder)["poses.csv"]


def test_a_small_set_is_the_beginning_of_a_larger(folder, tmp_path):
    generate(tmp_path, 1, 0.1)
    small, large = ([(pose.kind, pose.pair, pose.translation.tolist()) for pose in files.read_poses(path / "poses.csv")]
                    for path in (folder, tmp_path))
    for kind in {kind for kind, *_ in small}:
        own = [pose for pose in small if pose[0] == kind]
        assert [pose for pose in large if pose[0] == kind][:len(own)] == own
    assert len(large) > len(small)


def test_kinds_may_be_left_out(folder, tmp_path):
    generate(tmp_path, 1, 0.08, kinds=("drop",))
    assert [pose.kind for pose in files.read_poses(tmp_path / "poses.csv")] == ["drop"] * 2
    assert not list((tmp_path / "bodies").iterdir()) and len(list((tmp_path / "shapes").iterdir())) == len(shapes.SHAPES)


def test_concentric_bodies_overlap():
    # Two Ls whose first draw is apart: their middle is outside them.
    known = poses.Shape("l")
    names, _, q, t = poses.draw(1, "concentric", 1269, lambda name: known if name == "l" else poses.Shape(name))
    assert names == ("l", "l") and not poses.Pair(known, known).are_apart(q, t)


@pytest.mark.parametrize("name", shapes.SHAPES)
def test_shapes_are_closed_and_outward(folder, name):
    surface = files.read_shape(folder / "shapes" / f"{name}.obj")
    positions, triangles = surface.positions, surface.triangles
    edges = collections.Counter((a, b) for t in triangles.tolist() for a, b in zip(t, t[1:] + t[:1]))
    assert all(count == 1 and (b, a) in edges for (a, b), count in edges.items())
    corners = positions[triangles]
    assert np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) > 0
    assert surface.is_convex == (name in shapes.CONVEX)


def test_poses_are_of_their_kind(folder):
    surfaces = {path.stem: files.read_shape(path) for path in (folder / "shapes").glob("*.obj")}
    for pose in files.read_poses(folder / "poses.csv"):
        if pose.kind == "fine":
            continue
        first, second = (surfaces[name] for name in pose.pair)
        x, y = (files.placed(surface, placement) for surface, placement in zip((first, second), pose.placements()))
        inside = [(exact.classify(p, q, surface.triangles) > 0).mean()
                  for p, q, surface in ((x, y, second), (y, x, first))]
        is_apart = exact.Apart((first.triangles, second.triangles))((x, y))
        assert is_apart == (pose.kind in ("apart", "drop", "impact"))
        assert pose.kind != "contained" or inside == [0, 1]
        assert not (pose.kind == "edges" or is_apart) or inside == [0, 0]
