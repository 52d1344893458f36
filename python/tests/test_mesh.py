# SPDX-License-Identifier: MIT OR Apache-2.0
"""What can be asked of one surface, against closed forms."""

import copy
import pickle
from types import SimpleNamespace

import numpy as np
import pytest
import raycontact
from raycontact import NO_TRIANGLE, Error, Mesh, OctreeLayout, Scalar, Status
from shapes import ball, box, torus, volume


def random_points(count, reach):
    return np.random.default_rng(1).uniform(-reach, reach, (count, 3))


def distance_to_cube(points):
    """Signed, of the cube of 2 m around the origin."""
    beyond = np.abs(points) - 1
    outside = np.linalg.norm(np.maximum(beyond, 0), axis=1)
    return outside + np.minimum(beyond.max(axis=1), 0)


@pytest.mark.parametrize("precision, tolerance", [(Scalar.F64, 1e-14), (Scalar.F32, 1e-6)])
def test_signed_distances_to_a_cube(precision, tolerance):
    mesh = Mesh(*box([-1] * 3, [1] * 3), precision=precision)
    points = random_points(2000, 3)
    np.testing.assert_allclose(mesh.signed_distances(points), distance_to_cube(points), atol=tolerance * 10)


def test_closest_points_of_a_cube_are_those_of_its_sides():
    mesh = Mesh(*box([-1] * 3, [1] * 3))
    points = 4 * random_points(500, 1) * [1, 1, 1]
    points = points[distance_to_cube(points) > 0]
    found = mesh.closest_points(points)
    np.testing.assert_allclose(found["position"], np.clip(points, -1, 1), atol=1e-14)
    np.testing.assert_allclose(found["distance"], np.linalg.norm(points - found["position"], axis=1), atol=1e-14)
    corners = mesh.vertices[mesh.faces[found["triangle"]]]
    np.testing.assert_allclose(np.einsum("ij,ijk->ik", found["weights"], corners), found["position"], atol=1e-14)


def test_a_bound_leaves_out_what_is_farther():
    mesh = Mesh(*box([-1] * 3, [1] * 3))
    points = np.array([[3, 0, 0], [1.5, 0, 0]])
    assert mesh.closest_points(points, bounds=1.0)["is_found"].tolist() == [0, 1]
    found = mesh.closest_points(points, bounds=[2.5, 0.1])
    assert found["is_found"].tolist() == [1, 0]
    assert found["triangle"][1] == NO_TRIANGLE


def test_winding_numbers_of_a_torus():
    points, triangles = torus()
    mesh = Mesh(points, triangles)
    asked = random_points(5000, 1.5)
    to_ring = np.hypot(np.hypot(asked[:, 0], asked[:, 1]) - 1, asked[:, 2])
    # The facets lie at most this far inside the round surface.
    sagitta = 1.4 * (1 - np.cos(np.pi / 60)) + 0.4 * (1 - np.cos(np.pi / 30))
    clear = (to_ring > 0.4) | (to_ring < 0.4 - sagitta)
    assert clear.sum() > 4500
    assert (mesh.winding_numbers(asked[clear]) == (to_ring[clear] < 0.4)).all()
    assert (mesh.contains(asked) == (mesh.winding_numbers(asked) == 1)).all()


def test_a_surface_that_overlaps_itself_winds_twice():
    (a, faces), (b, _) = ball(10), ball(10, (1, 0, 0))
    mesh = Mesh(np.concatenate([a, b]), np.concatenate([faces, faces + len(a)]))
    asked = [[-0.5, 0, 0], [0.5, 0.01, 0.02], [1.5, 0, 0], [3, 0, 0]]
    assert mesh.winding_numbers(asked).tolist() == [1, 2, 1, 0]


@pytest.mark.parametrize("precision, tolerance", [(Scalar.F64, 1e-14), (Scalar.F32, 1e-6)])
def test_own_exits_of_two_boxes_are_their_corners_ways_out(precision, tolerance):
    (a, faces), (b, _) = box([0, 0, 0], [1, 1, 1]), box([0.8, 0.1, 0.2], [1.8, 1.1, 1.2])
    mesh = Mesh(np.concatenate([a, b]), np.concatenate([faces, faces + len(a)]), precision=precision)
    exits = mesh.own_exits()
    assert exits["vertex"].tolist() == [7, 8]
    np.testing.assert_allclose(exits["distance"], [0.1, 0.1], atol=10 * tolerance)
    np.testing.assert_allclose(exits["position"], [[1, 1.1, 1], [0.8, 0, 0.2]], atol=10 * tolerance)
    mesh.set_positions(np.concatenate([a, b + 3]))
    assert len(mesh.own_exits()) == 0
    with pytest.raises(Error) as error:
        Mesh(a, faces[1:], open=True).own_exits()
    assert error.value.status == Status.MESH_OPEN


def test_the_share_of_points_inside_a_ball_is_its_volume():
    mesh = Mesh(*ball(40))
    steps = (np.arange(60) + 0.5) / 30 - 1
    grid = np.stack(np.meshgrid(steps, steps, steps), 3).reshape(-1, 3)
    assert 8 * mesh.contains(grid).mean() == pytest.approx(4 / 3 * np.pi, rel=5e-3)
    assert 8 * mesh.contains(grid).mean() == pytest.approx(volume(*ball(40)), rel=2e-3)


def test_rays_into_a_cube():
    mesh = Mesh(*box([-1] * 3, [1] * 3))
    starts = np.column_stack([np.full(200, -5.0), random_points(200, 2)[:, 1:]])
    hits = mesh.trace_rays(starts, [2, 0, 0])
    meets = (np.abs(starts[:, 1:]) < 1).all(axis=1)
    assert 0 < meets.sum() < 200
    assert ((hits["triangle"] != NO_TRIANGLE) == meets).all()
    np.testing.assert_allclose(hits["t"][meets], 2, atol=1e-14)  # 4 m, at 2 m for each t
    assert not hits["is_exit"].any()
    assert mesh.trace_rays([0, 0.1, 0.2], [[1, 0, 0], [0, 0, -1]])["is_exit"].tolist() == [1, 1]
    assert (mesh.trace_rays(starts, [2, 0, 0], t_max=1.99)["triangle"] == NO_TRIANGLE).all()


def test_both_layouts_of_the_search_tree_answer_alike():
    mesh = Mesh(*torus())
    points = random_points(200, 1.5)
    wide = mesh.closest_points(points)
    mesh.set_octree_options(layout=OctreeLayout.CLASSIC)
    np.testing.assert_array_equal(mesh.closest_points(points), wide)


def test_answers_follow_new_positions():
    points, triangles = box([-1] * 3, [1] * 3)
    mesh = Mesh(points, triangles)
    assert mesh.contains([[0, 0, 0]]).all()
    mesh.set_positions(points + [5, 0, 0])
    assert mesh.contains([[0, 0, 0], [5, 0, 0]]).tolist() == [False, True]
    np.testing.assert_array_equal(mesh.vertices, points + [5, 0, 0])
    assert (mesh.vertex_count, mesh.triangle_count) == (8, 12)
    np.testing.assert_array_equal(mesh.faces, triangles)
    for array, count in ((mesh.vertices, 8), (mesh.faces, 12)):
        assert array.shape == (count, 3)
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0


def test_no_points_have_no_answers():
    mesh = Mesh(*box([-1] * 3, [1] * 3))
    none = np.empty((0, 3))
    for answers in (mesh.closest_points(none), mesh.winding_numbers(none), mesh.trace_rays(none, none)):
        assert answers.shape == (0,)


def test_an_open_surface_has_distances_and_no_inside():
    points, triangles = box([-1] * 3, [1] * 3)
    floor = Mesh(points, triangles[:2], open=True)  # the side at z = -1
    assert floor.closest_points([[0, 0.1, 2]])["distance"] == pytest.approx(3)
    with pytest.raises(Error) as caught:
        floor.contains([[0, 0, 0]])
    assert caught.value.status == Status.MESH_OPEN


def test_obj_files(tmp_path):
    points, triangles = torus(12, 8)
    lines = [f"v {x} {y} {z}" for x, y, z in points.tolist()]
    lines += [f"f {a} {b} {c}" for a, b, c in (triangles + 1).tolist()]
    path = tmp_path / "törus.obj"
    path.write_text("\n".join(lines))
    mesh = Mesh.from_file(path)
    np.testing.assert_array_equal(mesh.vertices, points)
    np.testing.assert_array_equal(mesh.faces, triangles)
    assert raycontact.Scene().add(mesh) == 0


def test_a_mesh_says_what_it_is_and_is_copied_whole():
    positions, triangles = box([-1] * 3, [1] * 3)
    mesh = Mesh.from_trimesh(SimpleNamespace(vertices=positions, faces=triangles), precision=Scalar.F32)
    assert repr(mesh) == f"Mesh({len(positions)} vertices, {len(triangles)} triangles)"
    moved = np.asarray(positions) + [0.1, 0.2, 0.3]
    mesh.set_positions(moved)
    for again in (copy.copy(mesh), copy.deepcopy(mesh), pickle.loads(pickle.dumps(mesh))):
        mesh.set_positions(positions)  # not of the copy
        np.testing.assert_array_equal(again.vertices, moved.astype(np.float32))
        np.testing.assert_array_equal(again.faces, triangles)
        mesh.set_positions(moved)
    sheet = Mesh(positions, triangles[:-1], open=True)
    assert pickle.loads(pickle.dumps(sheet)).triangle_count == len(triangles) - 1


def test_holes_are_closed_over_their_own_vertices():
    x, faces = box((0, 0, 0), (1, 2, 3))
    assert len(Mesh(x, faces).holes) == 0
    mesh = Mesh(x, faces[1:], close_holes=0.2)
    (hole,) = mesh.holes
    assert (hole["first_triangle"], hole["triangle_count"], mesh.vertex_count) == (len(faces) - 1, 1, len(x))
    assert sorted(mesh.faces[-1]) == sorted(faces[0])
    assert volume(mesh.vertices, mesh.faces) == pytest.approx(6)
    with pytest.raises(Error, match="close_holes is 0.01") as error:
        Mesh(x, faces[1:], close_holes=0.01)
    assert error.value.status == Status.MESH_OPEN
    with pytest.raises(Error, match="leave one of them 0") as error:
        Mesh(x, faces[1:], close_holes=0.2, open=True)
    assert error.value.status == Status.INVALID_OPTION
