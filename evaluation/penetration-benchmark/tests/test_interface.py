# SPDX-License-Identifier: MIT OR Apache-2.0
"""The example in C through the interface, the rule of motion, and this library's own rows."""

import csv
import pathlib
import shutil
import subprocess

import numpy as np
import pytest

from penetration_benchmark import __main__ as command_line
from penetration_benchmark import exact, files, motion, shapes
from penetration_benchmark.c_library import CLibrary
from penetration_benchmark.generate import generate
from penetration_benchmark.library import CONTACT, Contacts, Library, Surface, found

ROOT = pathlib.Path(__file__).resolve().parents[3]
PUBLISHED = ROOT / "docs/penetration"


@pytest.fixture(scope="module")
def example(tmp_path_factory):
    compiler = shutil.which("cc")
    assert compiler, "the example in C needs a C compiler"
    path = tmp_path_factory.mktemp("c") / "brute_force.so"
    source = ROOT / "evaluation/penetration-benchmark/c/brute_force.c"
    flags = "-std=c99 -Wall -Wextra -Wpedantic -Werror -O2 -shared -fPIC".split()
    subprocess.run([compiler, *flags, str(source), "-o", str(path), "-lm"], check=True)
    return CLibrary(path, "brute force")


def surface(name):
    positions, triangles = shapes.make(name)
    return Surface(name, positions, triangles, name in shapes.CONVEX)


def test_the_example_agrees_with_the_judge(example, tmp_path):
    generate(tmp_path, 1, 0.1)
    surfaces = {path.stem: files.read_shape(path) for path in (tmp_path / "shapes").glob("*.obj")}
    count = 0
    for pose in files.read_poses(tmp_path / "poses.csv"):
        if pose.kind == "fine":
            continue
        pair = [surfaces[name] for name in pose.pair]
        positions = tuple(files.placed(s, p) for s, p in zip(pair, pose.placements()))
        example.load(*pair)
        example.move(pose.placements(), positions)
        for i, marks in enumerate(example.inside()):
            truth = exact.classify(positions[i], positions[1 - i], pair[1 - i].triangles)
            assert (marks[truth != 0] == (truth > 0)[truth != 0]).all()
            count += (truth > 0).sum()
    assert count > 200


def test_the_example_pushes_a_corner_out(example):
    box = surface("box")
    # One corner of the second lies 0.01, 0.02 and 0.03 deep: the nearest face is 0.01 away.
    way = np.ptp(box.positions, axis=0) - [0.01, 0.02, 0.03]
    poses = np.stack([np.eye(3, 4), np.column_stack([np.eye(3), way])])
    example.load(box, box)
    example.move(poses, (box.positions, box.positions + way))
    contacts = found(example.contacts())
    assert contacts.dtype == CONTACT and len(contacts) == 2  # a corner of either
    assert np.allclose(contacts["depth"], 0.01) and np.allclose(contacts["direction"], [-1, 0, 0])
    assert np.allclose((contacts["first"] - contacts["second"]) @ [1, 0, 0], 0.01)
    assert np.allclose(Contacts.force(contacts), [-0.01 * contacts["weight"].sum(), 0, 0])


def test_the_rule_moves_as_it_says():
    box = surface("box")
    bodies = [motion.Body(box, np.column_stack([np.eye(3), shift])) for shift in ([0, 0, 0], [0.98, 0, 0])]
    contacts = Contacts.make([[0.5, 0, 0]], [[0.48, 0, 0]], [[-1, 0, 0]], [0.02])
    # (s₁ + s₂ − d)² + 0.05 (s₁² + s₂²) is least at s = d / 2.05, with d the depth and the clearance.
    assert motion.step(bodies, contacts) == pytest.approx(0.021 / 2.05)
    assert np.allclose(bodies[0].centre, [-0.021 / 2.05, 0, 0])
    assert np.allclose(bodies[1].centre, [0.98 + 0.021 / 2.05, 0, 0])
    assert motion.step(bodies, contacts[:0]) == 0


def test_the_example_frees_a_corner(example):
    box = surface("box")
    pose = files.Pose(0, ("box", "box"), "deep", np.eye(3), np.array([0.9, 0.7, 0.6]))
    example.load(box, box)
    outcome, steps, *_ = motion.free(example, (box, box), pose, exact.Apart((box.triangles, box.triangles)), found)
    assert outcome == "freed" and 1 <= steps < 20


def read(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


class Remembering(Library):
    """Has one contact, where the pair's shapes are those whose names it met first."""

    name = version = settings = documentation = "remembering"

    def __init__(self):
        self.shapes = {}

    def load(self, first, second):
        shapes = [(surface.name, surface.positions.tobytes()) for surface in (first, second)]
        self.is_known = all(self.shapes.setdefault(name, shape) == shape for name, shape in shapes)

    def move(self, poses, positions):
        self.positions = positions

    def inside(self):
        return tuple(np.zeros(len(positions), bool) for positions in self.positions)

    def contacts(self):
        up = np.array([[0.0, 0.0, 1.0]] * self.is_known).reshape(-1, 3)
        return Contacts.make(up, up, up, 1.0)


def test_what_a_library_keeps_ends_with_the_task(tmp_path, monkeypatch):
    monkeypatch.setattr(command_line.libraries, "KNOWN", {"remembering": None})
    monkeypatch.setattr(command_line.libraries, "make", lambda _: Remembering())
    for tasks in ("measure", "detect,measure"):
        command_line.main([str(tmp_path / tasks), "--share", "0.05", "--tasks", tasks])
    alone, after = (read(tmp_path / tasks / "measure.csv") for tasks in ("measure", "detect,measure"))
    assert alone == after and all(row["silent"] == "0" for row in alone)


def test_own_rows_are_those_published(tmp_path):
    command_line.main([str(tmp_path), "--share", "0.1", "--libraries",
                       "raycontact,raycontact-paper,raycontact-own-exits", "--tasks", "detect,measure,free,simulate,self"])
    for task in ("detect", "measure", "free", "simulate", "self"):
        rows, published = read(tmp_path / f"{task}.csv"), read(PUBLISHED / "quick" / f"{task}.csv")
        assert len(rows) == len(published) > 0
        for row, expected in zip(rows, published):
            for column, value in expected.items():
                if column.endswith(("_us", "_ratio")):
                    continue
                try:
                    assert float(row[column]) == pytest.approx(float(value), rel=2e-3), (task, column, expected)
                except ValueError:
                    assert row[column] == value, (task, column, expected)
