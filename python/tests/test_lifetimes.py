# SPDX-License-Identifier: MIT OR Apache-2.0
"""What a call has returned stays, whatever becomes of the objects it came from; the process ends well."""

import gc
import subprocess
import sys

import numpy as np
from raycontact import Mesh, Scene, query_pair
from shapes import TETRAHEDRON, tetrahedron, torus


def test_arrays_outlive_their_scene():
    scene, mesh = Scene(threads=2), Mesh(*torus())
    scene.add(mesh)
    scene.add(Mesh(torus()[0] + [0.3, 0.2, 0.1], torus()[1]))
    contacts = scene.query()
    array, near, positions = contacts.to_array(), mesh.closest_points([[0, 0, 0]]), mesh.vertices
    for kept in (array, near, positions):
        assert kept.flags.owndata
    before = [kept.copy() for kept in (array, near, positions)]
    del scene, mesh
    gc.collect()
    again = contacts.to_array()  # the list too is its own
    scene = Scene()
    scene.add(Mesh(*tetrahedron()))
    scene.query(contacts)
    assert len(contacts) == 0
    del contacts, scene
    gc.collect()
    for kept, was in zip((array, near, positions, again), (*before, before[0])):
        np.testing.assert_array_equal(kept, was)


def test_the_caller_may_change_its_arrays_after_the_call():
    x, triangles = tetrahedron()
    triangles = triangles.copy()
    mesh, scene = Mesh(x, triangles), Scene()
    scene.add(mesh)
    scene.add(Mesh(*tetrahedron(0.2)))
    before = scene.query().to_array()
    x += np.nan
    triangles += 100
    del x, triangles
    np.testing.assert_array_equal(scene.query().to_array(), before)
    np.testing.assert_array_equal(mesh.vertices, tetrahedron()[0])


def test_temporary_arrays_live_for_as_long_as_the_call():
    """Lists and views that are copied, with nobody but the call to keep the copy."""
    mesh, scene = Mesh(*tetrahedron()), Scene()
    body = scene.add(mesh)
    for i in range(200):
        wanted = tetrahedron()[0] * (1 + i / 100)
        mesh.set_positions(wanted.tolist())
        np.testing.assert_array_equal(mesh.vertices, wanted)
        scene.set_positions(body, np.asfortranarray(wanted))


def test_large_temporary_arrays_live_for_as_long_as_the_call():
    """Memory of this size goes back to the system when it is freed, so that whoever reads it then crashes."""
    positions = np.zeros((1_500_000, 3), order="F")
    positions[:4] = tetrahedron()[0]
    mesh, scene = Mesh(positions, TETRAHEDRON), Scene()
    body = scene.add(mesh)
    mesh.set_positions(positions)
    scene.set_positions(body, positions)
    contacts = query_pair(mesh, Mesh(*tetrahedron(0.2)))
    assert contacts.energy([positions, tetrahedron(0.2)[0]]) > 0
    assert (mesh.winding_numbers(positions) != 2).all()


def run(program):
    ended = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert (ended.returncode, ended.stderr) == (0, "")
    return ended.stdout


def test_the_process_ends_with_objects_left():
    """Python frees what is left in no certain order: cycles, globals, objects that other modules hold."""
    program = """
import sys, threading, raycontact, numpy
class Holder: pass
x = numpy.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], float)
mesh = raycontact.Mesh(x, [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])
holder = Holder()
holder.self, holder.scene = holder, raycontact.Scene(threads=2)
for shift in (0, 0.2):
    mesh.set_positions(x + shift)
    holder.scene.add(mesh)
holder.contacts = sys.modules["sys"].kept = holder.scene.query()
mesh.contains(x)
Holder.again = raycontact.Scene(threads=0)
threading.kept = Holder.again
print(len(holder.contacts))
"""
    assert int(run(program)) > 0


def test_what_the_library_frees_may_outlive_the_package():
    program = """
import gc, sys, threading
handles = []
def use():
    import raycontact
    handles.append(raycontact.Scene()._handle)
thread = threading.Thread(target=use)
thread.start()
thread.join()
del use
for name in [name for name in sys.modules if name.startswith("raycontact")]:
    del sys.modules[name]
gc.collect()
handles.clear()
print("freed")
"""
    assert run(program) == "freed\n"
