# SPDX-License-Identifier: MIT OR Apache-2.0
"""Bodies that overlap themselves, the judge of their shortest ways out, and how answers are counted."""

import collections
import pathlib
import shutil
import subprocess

import numpy as np
import pytest

from penetration_benchmark import bodies, files, self_contact, shortest
from penetration_benchmark.c_library import CLibrary
from penetration_benchmark.library import EXIT, Body, Library, found

KINDS = tuple(bodies.COUNTS)


def box(counts, sides, middle=(0, 0, 0)):
    grid, tetrahedra = bodies.blocks(counts, False)
    return (grid / counts - 0.5) * sides + middle, tetrahedra


def two_boxes():
    """One mesh of two that overlap, with a surface of their own each."""
    parts = [box((4, 4, 4), (1, 1, 1)), box((3, 3, 3), (0.6, 0.7, 0.8), (0.41, 0.33, 0.27))]
    tetrahedra = np.concatenate([parts[0][1], parts[1][1] + len(parts[0][0])])
    return bodies.from_tetrahedra("boxes_0", np.concatenate([p for p, _ in parts]), tetrahedra)


def insides_of_boxes(positions, count=2):
    """Of points: how far inside the first box, and the second; negative outside."""
    halves, middles = np.array([[0.5, 0.5, 0.5], [0.3, 0.35, 0.4]]), np.array([[0, 0, 0], [0.41, 0.33, 0.27]])
    return [(half - np.abs(positions - middle)).min(1) for half, middle in zip(halves, middles)][:count]


@pytest.mark.parametrize("kind", KINDS)
def test_bodies_are_closed_and_overlap_themselves(kind):
    body = bodies.make(1, kind, 0)
    same, other = bodies.make(1, kind, 0), bodies.make(2, kind, 0)
    assert (body.positions == same.positions).all() and not np.array_equal(body.positions, other.positions)
    assert (bodies.volumes(body.positions, body.tetrahedra) > 0).all()
    assert np.ptp(body.positions, axis=0).max() == pytest.approx(1)
    assert set(body.triangles.ravel().tolist()) == set(range(int(body.triangles.max()) + 1))
    edges = collections.Counter((a, b) for t in body.triangles.tolist() for a, b in zip(t, t[1:] + t[:1]))
    assert all(count == 1 and (b, a) in edges for (a, b), count in edges.items())
    corners = body.positions[body.triangles]
    volume = np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6
    assert volume == pytest.approx(bodies.volumes(body.positions, body.tetrahedra).sum())
    assert sum(bool(held) for held in shortest.Judge(body).holders()) >= 6


def test_files_keep_bodies(tmp_path):
    body = bodies.make(1, "ring", 0)
    files.write_shape(tmp_path / "ring_0.obj", *body[1:])
    for kept, written in zip(files.read_body(tmp_path / "ring_0.obj"), body):
        assert kept == written if isinstance(kept, str) else (kept == written).all()


def test_vertices_inside_boxes_and_their_ways_out():
    body = two_boxes()
    judge = shortest.Judge(body)
    held, insides = judge.holders(), np.array(insides_of_boxes(body.positions))
    count = 0
    for vertex, tetrahedra in enumerate(held):
        # On the surface of one box, so the depth in the other is the larger.
        depth = insides[:, vertex].max()
        assert bool(tetrahedra) == (depth > 1e-9)
        if tetrahedra:
            length, _ = judge.ways_out(body.positions[vertex], tetrahedra[0])
            assert length == pytest.approx(depth, rel=1e-9)
            count += 1
    assert 20 < count < len(held) / 2


def test_without_an_overlap_the_shortest_way_leads_to_the_nearest_surface():
    grid, tetrahedra = bodies.blocks((24, 3, 3), False)

    def curve(s):
        return np.stack([np.cos(5 * s), np.sin(5 * s), 0 * s], -1)

    body = bodies.from_tetrahedra("arc_0", bodies.bent(grid / (24, 3, 3), (0.4, 0.5), curve), tetrahedra)
    judge, random = shortest.Judge(body), np.random.default_rng(1)
    assert not any(judge.holders())
    for tetrahedron in random.choice(len(body.tetrahedra), 60, replace=False):
        point = random.dirichlet(np.ones(4)) @ body.positions[body.tetrahedra[tetrahedron]]
        nearest = shortest.nearest_points(point, body.positions[body.triangles])
        assert judge.ways_out(point, tetrahedron)[0] == pytest.approx(np.linalg.norm(nearest - point, axis=1).min())


def test_nearest_points_of_a_triangle_are_no_farther_than_any():
    random = np.random.default_rng(3)
    corners, points = random.normal(size=(200, 3, 3)), random.normal(size=(20, 3))
    weights = random.dirichlet(np.ones(3), 4000)
    for point in points:
        lengths = np.linalg.norm(shortest.nearest_points(point, corners) - point, axis=1)
        sampled = np.linalg.norm(np.einsum("sk,tkx->tsx", weights, corners) - point, axis=2).min(1)
        assert (lengths <= sampled + 1e-12).all() and (sampled - lengths < 0.2).all()


class Oracle(Library):
    """Answers with the second box's or the first's nearest face, and then as a test wants it spoilt."""

    name = "oracle"
    spoil = staticmethod(lambda vertices, points, ways: (vertices, points))

    def load(self, first, second):
        raise NotImplementedError

    move = inside = contacts = load

    def load_body(self, body):
        self.count = body.triangles.max() + 1

    def exits(self, positions):
        found = []
        for vertex, point in enumerate(positions[:self.count]):
            for half, middle in (((0.5, 0.5, 0.5), (0, 0, 0)), ((0.3, 0.35, 0.4), (0.41, 0.33, 0.27))):
                gaps = np.array(half) - np.abs(point - middle)
                if gaps.min() > 1e-9:
                    axis = gaps.argmin()
                    way = np.zeros(3)
                    way[axis] = np.copysign(gaps[axis], point[axis] - middle[axis])
                    found.append((vertex, point + way, way))
        vertices, points, ways = map(np.array, zip(*found))
        vertices, points = type(self).spoil(vertices, points, ways)
        exits = np.zeros(len(vertices), EXIT)
        exits["vertex"], exits["point"] = vertices, points
        return exits


def count(spoil):
    library = type("Spoilt", (Oracle,), {"spoil": staticmethod(spoil)})()
    (row,) = self_contact.self_contact([library], [two_boxes()], lambda done, of: None)
    cell = dict(zip(self_contact.SELF, row))
    assert cell["kind"] == "boxes" and cell["refused"] == 0
    return {key: int(cell[key]) for key in ("inside", "missed", "false", "shortest")}, float(cell["length_median"])


def test_answers_are_counted_as_they_are():
    right, length = count(lambda vertices, points, ways: (vertices, points))
    inside = right["inside"]
    assert right == {"inside": inside, "missed": 0, "false": 0, "shortest": inside} and inside > 20
    assert length == pytest.approx(1)
    assert count(lambda v, p, w: (v[2:], p[2:]))[0] == right | {"missed": 2, "shortest": inside - 2}
    # Too far, not far enough, and through the opposite face.
    assert count(lambda v, p, w: (v, p + 0.02 * w))[0] == right | {"shortest": 0}
    assert count(lambda v, p, w: (v, p - 0.02 * w))[0] == right | {"shortest": 0}
    assert count(lambda v, p, w: (v, p - 2 * w))[1] == pytest.approx(1)
    assert count(lambda v, p, w: (v, p - 2 * w))[0]["shortest"] == 0
    outside = np.flatnonzero(np.max(insides_of_boxes(two_boxes().positions), axis=0) < 1e-9)[:3]
    assert count(lambda v, p, w: (np.append(v, outside), np.vstack([p, p[:3]])))[0] == right | {"false": 3}


def test_a_library_without_the_task_is_listed():
    class Without(Oracle):
        load_body, exits = Library.load_body, Library.exits

    (row,) = self_contact.self_contact([Without()], [two_boxes()], lambda done, of: None)
    cell = dict(zip(self_contact.SELF, row))
    assert cell["refused"] == 1 and cell["shortest"] == "" and "itself" in cell["note"]


SOURCE = """
#include "brute_force.c"
static penetration_body kept;
int penetration_load_body(const penetration_body* body) { kept = *body; return PENETRATION_OK; }
/* For each vertex: a vertex number of an element, and that vertex's position. */
ptrdiff_t penetration_exits(const double* positions, penetration_exit* exits, size_t capacity) {
  for (size_t i = 0; i < kept.vertex_count && i < capacity; ++i) {
    const size_t last = kept.tetrahedron_count - 1, end = kept.triangle_count - 1;
    exits[i].vertex = i % 2 ? kept.tetrahedra[4 * last + i % 4] : kept.triangles[3 * end + i % 3];
    for (int k = 0; k < 3; ++k) exits[i].point[k] = positions[3 * (size_t)exits[i].vertex + k];
  }
  return (ptrdiff_t)kept.vertex_count;
}
"""


def test_bodies_and_exits_pass_through_the_c_interface(tmp_path):
    folder = pathlib.Path(__file__).resolve().parents[1] / "c"
    (tmp_path / "exits.c").write_text(SOURCE, encoding="utf-8")
    libraries = []
    for name, source in (("exits", tmp_path / "exits.c"), ("pairs", folder / "brute_force.c")):
        flags = ["-std=c99", "-shared", "-fPIC", f"-I{folder}", str(source), "-o", str(tmp_path / f"{name}.so")]
        subprocess.run([shutil.which("cc"), *flags, "-lm"], check=True)
        libraries.append(CLibrary(tmp_path / f"{name}.so", name))
    body = bodies.make(1, "ring", 1)  # more vertices than there is room for at first
    moved = body.positions + [1, 2, 3]
    with pytest.raises(NotImplementedError, match="itself"):
        libraries[1].load_body(body)
    kept = Body(body.name, *(np.ascontiguousarray(array) for array in body[1:]))
    libraries[0].load_body(kept)
    exits, i = found(libraries[0].exits(moved)), np.arange(len(moved))
    vertices = np.where(i % 2, kept.tetrahedra[-1, i % 4], kept.triangles[-1, i % 3])
    assert len(moved) > 1024 and (exits["vertex"] == vertices).all() and (exits["point"] == moved[vertices]).all()
