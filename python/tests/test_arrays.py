# SPDX-License-Identifier: MIT OR Apache-2.0
"""Arrays are used where they lie, whatever their layout, and refused where that would lose what is written."""

import numpy as np
import pytest
from raycontact import Mesh, Scene, query_pair
from raycontact._library import indices, lies_well, to_read
from shapes import TETRAHEDRON, tetrahedron

X = tetrahedron()[0]


def packed(dtype):
    whole = np.full((4, 3), 7, dtype)
    return whole, whole


def columns_of_wider(dtype):
    whole = np.full((4, 5), 7, dtype)
    return whole, whole[:, 1:4]


def every_second(dtype):
    whole = np.full((8, 3), 7, dtype)
    return whole, whole[::2]


def unaligned(dtype):
    whole = np.full(4 * (3 * np.dtype(dtype).itemsize + 1), 7, np.uint8)
    records = whole.view([("kind", np.uint8), ("x", dtype, 3)])
    return whole, records["x"]


LAYOUTS = [packed, columns_of_wider, every_second, unaligned]


def read_only():
    x = X.copy()
    x.flags.writeable = False
    return x


COPIED = [
    X.tolist(),
    X.astype(int),
    np.asfortranarray(X),
    X[::-1][::-1].astype(">f8"),
    X.astype(np.float16),
    X[:, ::-1],
]


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("layout", LAYOUTS)
def test_read_where_they_lie(layout, dtype):
    _, view = layout(dtype)
    view[:] = X
    assert to_read(view, "view") is view
    np.testing.assert_array_equal(Mesh(view, TETRAHEDRON).vertices, X)
    view.flags.writeable = False
    assert to_read(view, "view") is view


@pytest.mark.parametrize("x", COPIED, ids=str)
def test_copied_where_they_cannot_be_read(x):
    wanted = np.asarray(x, float)
    copy = to_read(x, "x")
    assert lies_well(copy) and copy.flags.c_contiguous
    np.testing.assert_array_equal(copy, wanted)
    mesh = Mesh(X, TETRAHEDRON)
    mesh.set_positions(x)
    np.testing.assert_array_equal(mesh.vertices, wanted)


class OnDevice:
    """What an array of Warp, PyTorch or JAX tells of the memory of a GPU, which DLPack gives the number 2."""

    def __dlpack_device__(self):
        return (2, 0)


def test_arrays_on_a_device_are_refused():
    mesh, scene = Mesh(X, TETRAHEDRON), Scene()
    scene.add(mesh)
    for call in (
        lambda: Mesh(OnDevice(), TETRAHEDRON),
        lambda: Mesh(X, OnDevice()),
        lambda: mesh.set_positions(OnDevice()),
        lambda: scene.set_positions(0, OnDevice()),
    ):
        with pytest.raises(TypeError, match=r"lies on a device; give a copy on the host, such as .numpy\(\)"):
            call()


def test_rows_in_descending_order_are_copied():
    mesh = Mesh(X, TETRAHEDRON)
    mesh.set_positions(X[::-1])
    np.testing.assert_array_equal(mesh.vertices, X[::-1])
    one = np.broadcast_to(X[3], (4, 3))
    mesh.set_positions(one)
    np.testing.assert_array_equal(mesh.vertices, one)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("layout", LAYOUTS)
def test_forces_are_added_where_they_lie(layout, dtype):
    # Few contacts, since each rounds once where it is added.
    contacts = query_pair(Mesh(X, TETRAHEDRON), Mesh(*tetrahedron(0.2)), sampling="spacing", sampling_value=0.3)
    wanted = [np.zeros((4, 3)) for _ in range(2)]
    contacts.add_forces(wanted)
    assert np.abs(wanted[1]).max() > 1e-3
    (whole, view), (untouched, same) = layout(dtype), layout(dtype)
    view[:] = 1
    contacts.add_forces([np.zeros((4, 3)), view])
    np.testing.assert_allclose(view, 1 + wanted[1], rtol=1e-6)
    same[:] = view
    np.testing.assert_array_equal(whole, untouched)  # nothing beside them


@pytest.mark.parametrize(
    "forces, error, text",
    [
        (np.zeros((4, 3), int), ValueError, "int64"),
        (np.zeros((4, 3), order="F"), ValueError, "strides"),
        (np.zeros((4, 3))[::-1], ValueError, "strides"),
        (np.broadcast_to(np.zeros(3), (4, 3)), ValueError, "writeable False"),
        (read_only(), ValueError, "writeable False"),
        (np.zeros((4, 3), ">f8"), ValueError, ">f8"),
        (np.zeros((4, 2)), ValueError, r"forces\[1\] has the shape \(4, 2\)"),
        (np.zeros(12), ValueError, r"\(12,\)"),
        ([[0.0] * 3] * 4, TypeError, "list"),
    ],
)
def test_forces_that_would_be_lost_are_refused(forces, error, text):
    contacts = query_pair(Mesh(X, TETRAHEDRON), Mesh(*tetrahedron(0.2)))
    first = np.zeros((4, 3))
    with pytest.raises(error, match=text):
        contacts.add_forces([first, forces])
    assert not first.any()


def test_triangles_of_any_whole_numbers():
    assert np.shares_memory(indices(TETRAHEDRON, "triangles"), TETRAHEDRON)
    for given in (TETRAHEDRON.astype(np.int64), TETRAHEDRON.tolist(), np.asfortranarray(TETRAHEDRON)):
        np.testing.assert_array_equal(Mesh(X, given).faces, TETRAHEDRON)


def test_one_array_for_each_of_many_bodies():
    scene = Scene()
    for i in range(50):
        scene.add(Mesh(*tetrahedron(3 * (i // 2) + 0.2 * (i % 2))))
    forces = [np.zeros((4, 3), np.float32 if i % 3 else np.float64) for i in range(50)]
    forces += [None]
    scene.query().add_forces(forces)
    pushes = np.array([f.sum(axis=0) for f in forces[:50]])
    np.testing.assert_allclose(pushes[1::2], -pushes[::2], rtol=1e-5)
    np.testing.assert_allclose(pushes[1::2], np.broadcast_to(pushes[1], (25, 3)), rtol=1e-4)
