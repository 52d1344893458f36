# SPDX-License-Identifier: MIT OR Apache-2.0
"""The programs for other packages, where those are installed."""

import pathlib
import re
import subprocess
import sys

import numpy as np
import pytest

PROGRAMS = pathlib.Path(__file__).parents[2] / "examples/python_hosts"


def run(program, *arguments):
    command = [sys.executable, str(PROGRAMS / program), *map(str, arguments)]
    ended = subprocess.run(command, capture_output=True, text=True)
    assert ended.returncode == 0, ended.stderr
    return ended.stdout


def test_trimesh_reads_two_files_and_draws_them(tmp_path):
    trimesh = pytest.importorskip("trimesh")
    ball = trimesh.creation.icosphere(4)
    ball.export(tmp_path / "ball.stl")
    box = trimesh.creation.box((2, 2, 2)).apply_translation((0, 0, 1.9))
    box.update_faces(np.arange(len(box.faces)) != np.argmax(box.triangles_center[:, 2]))  # a hole in its lid
    box.export(tmp_path / "box.ply")
    printed = run("trimesh_files.py", tmp_path / "ball.stl", tmp_path / "box.ply", tmp_path / "both.glb")
    assert "ball.stl: 5120 triangles, 0 holes closed" in printed
    assert "box.ply: 12 triangles, 1 holes closed" in printed
    assert "0.100 m below" in printed
    # A cap of height h has the volume π h² (1 − h / 3), which is the integral of the depth below the box's face.
    force, along = re.search(r"(\d+) N along \[(.*)\]", printed).groups()
    assert float(force) == pytest.approx(1e5 * np.pi * 0.1**2 * (1 - 0.1 / 3), rel=0.05)
    assert np.fromstring(along, sep=" ") == pytest.approx([0, 0, -1], abs=0.02)
    assert len(trimesh.load(tmp_path / "both.glb").geometry) == 2


def test_scikit_fem_converges():
    pytest.importorskip("skfem")
    printed = run("scikit_fem_blocks.py")
    sizes = [float(size) for size in re.findall(r"residual (\S+) N", printed)]
    assert sizes[0] > 100 and sizes[-1] < 1e-8 and len(sizes) <= 6
    assert "pressed by 0.05 m" in printed


def test_newton_stacks_its_grids():
    pytest.importorskip("newton")
    printed = run("newton_grids.py")
    assert "0 tetrahedra inverted" in printed
    lowest = re.findall(r"lowest points at \[(.*)\]", printed)[-1]
    assert np.fromstring(lowest, sep=" ") == pytest.approx([0, 0.2], abs=0.03)
