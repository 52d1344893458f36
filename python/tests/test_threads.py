# SPDX-License-Identifier: MIT OR Apache-2.0
"""Python threads run beside the library's calls, and are told where they get in one another's way."""

import sys
import threading
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from raycontact import Contacts, Error, Mesh, Scene, Status
from shapes import ball, torus


@pytest.fixture
def threads_change_only_in_calls():
    """Another thread then runs during a call if and only if the call lets it."""
    before = sys.getswitchinterval()
    sys.setswitchinterval(1000)
    yield
    sys.setswitchinterval(before)


class Worker(threading.Thread):
    """Makes one call again and again until it is told to stop."""

    def __init__(self, call):
        super().__init__()
        self.call, self.is_working, self.stop = call, False, False

    def run(self):
        self.is_working = True
        for _ in range(100):
            if not self.stop:
                self.call()
        self.is_working = False


def large_scene():
    points, triangles = torus(120, 60)
    scene = Scene()
    scene.add(Mesh(points, triangles))
    scene.add(Mesh(points + [0.5, 0.02, 0.01], triangles))
    return scene, points


def query():
    scene, contacts = large_scene()[0], Contacts()
    return lambda: scene.query(contacts)


def winding_numbers():
    mesh = Mesh(*torus())
    points = np.random.default_rng(4).uniform(-1, 1, (20_000, 3))
    mesh.winding_numbers(points)  # the octree is there from here on
    return lambda: mesh.winding_numbers(points)


def add_forces():
    scene, points = large_scene()
    contacts, forces = scene.query(), [np.zeros_like(points) for _ in range(2)]
    return lambda: contacts.add_forces(forces)


@pytest.mark.parametrize("make_call", [query, winding_numbers, add_forces])
def test_another_thread_runs_during_a_call(make_call, threads_change_only_in_calls):
    worker = Worker(make_call())
    worker.start()  # comes back during one of the worker's calls, or after all where they let nobody run
    was_working = worker.is_working
    worker.stop = True
    worker.join()
    assert was_working


def test_two_threads_with_a_scene_each():
    def steps(shift):
        points, triangles = ball(20)
        scene, contacts, counts = Scene(), Contacts(), []
        bodies = [scene.add(Mesh(points, triangles)) for _ in range(2)]
        for i in range(30):
            scene.set_positions(bodies[1], points + [shift + 0.05 * i, 0.1, 0.2])
            counts.append(scene.query(contacts).to_array()["depth"].sum())
        return counts

    shifts = [0.1, 0.3, 0.5, 0.7]
    with ThreadPoolExecutor(4) as pool:
        side_by_side = list(pool.map(steps, shifts))
    assert side_by_side == [steps(shift) for shift in shifts]


def test_many_threads_may_ask_one_mesh():
    mesh = Mesh(*torus())
    points = np.random.default_rng(5).uniform(-1.5, 1.5, (8, 500, 3))
    with ThreadPoolExecutor(8) as pool:
        found = np.concatenate(list(pool.map(mesh.signed_distances, points)))  # the first of them builds the octree
    np.testing.assert_array_equal(found, Mesh(*torus()).signed_distances(points.reshape(-1, 3)))


def test_a_scene_in_use_says_so():
    scene, points = large_scene()
    contacts, statuses = Contacts(), set()

    def catching(call):
        try:
            call()
        except Error as error:
            statuses.add(error.status)

    worker = Worker(lambda: catching(lambda: scene.query(contacts)))
    worker.start()
    while worker.is_working and not statuses:
        catching(lambda: scene.set_positions(0, points))
    worker.stop = True
    worker.join()
    assert statuses == {Status.BUSY}
    scene.set_positions(0, points)
    assert len(scene.query(contacts))


def test_messages_belong_to_their_thread():
    def failing(index):
        mesh = Mesh(*ball(4))
        for _ in range(50):
            with pytest.raises(Error, match=f"body {index}"):
                Scene().remove(index)
            assert mesh.contains([[0, 0, 0]]).all()
        return True

    with ThreadPoolExecutor(4) as pool:
        assert all(pool.map(failing, range(7, 11)))
