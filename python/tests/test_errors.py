# SPDX-License-Identifier: MIT OR Apache-2.0
"""Bad input raises what says what is wrong and where, and changes nothing."""

import pickle

import numpy as np
import pytest
from raycontact import Contacts, Error, Mesh, Sampling, Scalar, Scene, Status, query_pair
from shapes import TETRAHEDRON, box, tetrahedron

X = tetrahedron()[0]


def with_nan():
    x = X.copy()
    x[2, 1] = np.nan
    return x


@pytest.mark.parametrize(
    "positions, triangles, status, text",
    [
        (X, TETRAHEDRON[:3], Status.MESH_OPEN, r"edge \(1, 2\)"),
        (X, TETRAHEDRON[:, ::-1], Status.MESH_INWARD, "inside out"),
        (X, TETRAHEDRON + 1, Status.MESH_INDEX_OUT_OF_RANGE, "triangle"),
        (X, TETRAHEDRON[:, [0, 0, 1]], Status.MESH_DEGENERATE_TRIANGLE, "triangle 0"),
        (X, np.vstack([TETRAHEDRON[:3], [1, 3, 2]]), Status.MESH_INCONSISTENT_ORIENTATION, "triangle"),
        (X, np.vstack([TETRAHEDRON, TETRAHEDRON]), Status.MESH_NON_MANIFOLD, "edge"),
        (X, np.empty((0, 3), np.uint32), Status.MESH_EMPTY, "triangle"),
        (with_nan(), TETRAHEDRON, Status.NOT_FINITE, "vertex 2"),
        (1e200 * X, TETRAHEDRON, Status.MESH_BEYOND_RANGE, "vertex|triangle"),
    ],
)
def test_faults_of_a_surface(positions, triangles, status, text):
    with pytest.raises(Error, match=text) as caught:
        Mesh(positions, triangles)
    assert caught.value.status == status
    assert str(caught.value) != status.name
    # As from another process.
    sent = pickle.loads(pickle.dumps(caught.value))
    assert (type(sent), sent.status, str(sent)) == (Error, status, str(caught.value))


@pytest.mark.parametrize(
    "positions, triangles, error, text",
    [
        (X[:, :2], TETRAHEDRON, ValueError, r"positions has the shape \(4, 2\); give \(n, 3\)"),
        (X.ravel(), TETRAHEDRON, ValueError, r"\(12,\)"),
        (X[None], TETRAHEDRON, ValueError, r"\(1, 4, 3\)"),
        (X.astype(complex), TETRAHEDRON, TypeError, "complex128"),
        (X.astype(str), TETRAHEDRON, TypeError, "<U"),
        (X.astype(object), TETRAHEDRON, TypeError, "object"),
        (X, TETRAHEDRON.ravel(), ValueError, r"triangles has the shape \(12,\); give \(m, 3\)"),
        (X, TETRAHEDRON.astype(float), TypeError, "float64"),
        (X, TETRAHEDRON.astype(bool), TypeError, "bool"),
        (X, TETRAHEDRON.astype(int) - 1, ValueError, r"triangles\[0, 0\] is -1; give a whole number from 0"),
        (X, TETRAHEDRON + [[0, 0, 0], [0, 0, 0], [0, 2**32, 0], [0, 0, 0]], ValueError, r"triangles\[2, 1\] is 4294967299"),
    ],
)
def test_arrays_that_are_none(positions, triangles, error, text):
    with pytest.raises(error, match=text):
        Mesh(positions, triangles)


@pytest.mark.parametrize(
    "options, error, text",
    [
        ({"sampling": Sampling.SPACING, "sampling_value": -2.0}, Error, "sampling_value"),
        ({"sampling": Sampling.ACCURACY, "sampling_value": float("nan")}, Error, "sampling_value"),
        ({"sampling_value": 1.5}, Error, "Sampling.ACCURACY; give a part > 0 and at most 1, or 0 for the default"),
        ({"sampling": 3}, Error, "sampling"),
        ({"law": 7}, Error, "law"),
        ({"law": "presure"}, TypeError, "option law: .*; give one of pressure, ray_length"),
        ({"edges": "on"}, TypeError, "option edges"),
        ({"edges": -1}, OverflowError, "option edges"),
        ({"edges": 0.5}, TypeError, "option edges"),
        ({"spacing": 0.1}, TypeError, "no option 'spacing'; there are: sampling_value, sampling, edges"),
        ({"struct_size": 8}, TypeError, "no option 'struct_size'"),
    ],
)
def test_options(options, error, text):
    scene = Scene()
    for shift in (0, 0.2):
        scene.add(Mesh(*tetrahedron(shift)))
    before = scene.query().to_array()
    with pytest.raises(error, match=text):
        scene.set_detection_options(**options)
    np.testing.assert_array_equal(scene.query().to_array(), before)


def test_refused_positions_leave_the_old_ones():
    scene, mesh = Scene(), Mesh(X, TETRAHEDRON)
    body = scene.add(mesh)
    scene.add(Mesh(*tetrahedron(0.2)))
    before = scene.query().to_array()
    for refused, status in ((with_nan(), Status.NOT_FINITE), (X[:3], Status.WRONG_COUNT)):
        for owner in (mesh.set_positions, lambda x: scene.set_positions(body, x)):
            with pytest.raises(Error) as caught:
                owner(refused)
            assert caught.value.status == status
    np.testing.assert_array_equal(mesh.vertices, X)
    np.testing.assert_array_equal(scene.query().to_array(), before)


def test_numbers_of_bodies():
    scene = Scene()
    with pytest.raises(Error) as caught:
        scene.remove(0)
    assert caught.value.status == Status.UNKNOWN_BODY
    for wrong, text in ((-1, "negative"), (2**32, "4294967296"), (np.int64(2**32), "4294967296")):
        with pytest.raises(OverflowError, match=text):
            scene.remove(wrong)
    with pytest.raises(TypeError):
        scene.remove(0.5)
    with pytest.raises(Error) as caught:
        scene.advance(-1)
    assert caught.value.status == Status.INVALID_OPTION
    with pytest.raises(Error) as caught:
        Scene(threads=100000)
    assert caught.value.status == Status.INVALID_OPTION


def test_precisions_do_not_mix():
    single, double = (Mesh(X, TETRAHEDRON, precision=precision) for precision in (Scalar.F32, Scalar.F64))
    for wrong in (lambda: Scene().add(single), lambda: query_pair(single, double)):
        with pytest.raises(Error) as caught:
            wrong()
        assert caught.value.status == Status.PRECISION_MISMATCH


def test_arrays_of_bodies():
    contacts = query_pair(Mesh(*tetrahedron()), Mesh(*tetrahedron(0.2)))
    forces = [np.zeros((4, 3)), np.zeros((4, 3))]
    with pytest.raises(ValueError, match="positions has 1 arrays for 2 bodies"):
        contacts.add_forces(forces, [X])
    with pytest.raises(ValueError, match="displacements has 3 arrays for 2 bodies"):
        contacts.add_differential([X] * 3, forces)
    with pytest.raises(Error) as caught:
        contacts.add_forces(forces, [X, with_nan()])
    assert caught.value.status == Status.NOT_FINITE
    with pytest.raises(Error) as caught:
        contacts.energy(stiffness=-1)
    assert caught.value.status == Status.INVALID_OPTION
    with pytest.raises(Error, match="damping_time is 0.1, but there are no velocities to damp") as caught:
        contacts.add_forces(forces, damping_time=0.1)
    assert caught.value.status == Status.INVALID_OPTION
    assert not np.any(forces)
    velocities = [X.copy(), X.copy()]
    with pytest.raises(Error, match="velocities of body 1 and forces of body 0 share memory") as caught:
        contacts.add_forces([velocities[1], forces[1]], velocities=velocities)
    assert caught.value.status == Status.INVALID_OPTION
    np.testing.assert_array_equal(velocities[1], X)


def test_points_and_rays():
    mesh = Mesh(*box([-1] * 3, [1] * 3))
    with pytest.raises(Error, match="point 1") as caught:
        mesh.closest_points([[0, 0, 0], [np.inf, 0, 0]])
    assert caught.value.status == Status.NOT_FINITE
    with pytest.raises(Error, match="1") as caught:
        mesh.closest_points([[0, 0, 0], [1, 0, 0]], bounds=[1, -1])
    assert caught.value.status == Status.INVALID_OPTION
    with pytest.raises(ValueError):
        mesh.closest_points([[0, 0, 0], [1, 0, 0]], bounds=[1, 2, 3])
    with pytest.raises(ValueError, match="origins"):
        mesh.trace_rays([[0.0], [1.0]], [1, 0, 0])
    with pytest.raises(ValueError):
        mesh.trace_rays(np.zeros((2, 3)), np.ones((3, 3)))
    with pytest.raises(TypeError, match="t_max"):
        mesh.trace_rays([0, 0, 0], [1, 0, 0], t_max=1j)
    with pytest.raises(Error, match="ray 1") as caught:
        mesh.trace_rays(np.zeros((2, 3)), [[1, 0, 0], [0, 0, 0]])
    assert caught.value.status == Status.INVALID_OPTION


def test_files(tmp_path):
    with pytest.raises(Error, match="missing.obj") as caught:
        Mesh.from_file(tmp_path / "missing.obj")
    assert caught.value.status == Status.FILE_NOT_READABLE
    (tmp_path / "cut").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n")
    with pytest.raises(ValueError, match="cut.*give one without a null character"):
        Mesh.from_file(f"{tmp_path}/cut\0.obj")
    (tmp_path / "ball.stl").write_text("solid ball\nfacet normal 0 0 1\n")
    with pytest.raises(Error, match="ball.stl .*; only .obj files are read"):
        Mesh.from_file(tmp_path / "ball.stl")
    (tmp_path / "broken.obj").write_text("v 0 0 0\nf 1 2 3\n")
    with pytest.raises(Error, match="line 2") as caught:
        Mesh.from_file(tmp_path / "broken.obj")
    assert caught.value.status == Status.FILE_BROKEN


def test_an_object_that_was_never_made():
    with pytest.raises(AttributeError):
        len(Contacts.__new__(Contacts))
    with pytest.raises((TypeError, AttributeError)):
        Scene().add(None)
