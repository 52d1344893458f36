# SPDX-License-Identifier: MIT OR Apache-2.0
"""The task simulate: masses against closed forms, the integrator against what springs and flight do, and its verdicts."""

import numpy as np
import pytest

from penetration_benchmark import files, rigid, shapes, simulate, volumes
from penetration_benchmark.library import Contacts, Library, Surface

NONE = Contacts.make([], [], [], [])
HEAVY = np.array([0, 0, -9.81])


def surface(name):
    positions, triangles = shapes.make(name)
    return Surface(name, positions, triangles, name in shapes.CONVEX)


def turned(body, seed=1):
    random = np.random.default_rng(seed)
    return np.column_stack([files.rotation_of(*random.normal(size=4)), random.normal(size=3)])


def test_a_box_has_its_mass_and_inertia():
    box = surface("box")
    placement = turned(box)
    volume, centre, moments = rigid.integrals(files.placed(box, placement), box.triangles)
    sides = np.ptp(box.positions, axis=0)
    assert volume == pytest.approx(sides.prod())
    assert np.allclose(centre, placement[:, 3])
    expected = placement[:, :3] @ np.diag(sides.prod() * sides**2 / 12) @ placement[:, :3].T
    assert np.allclose(moments, expected, atol=1e-12)
    body = rigid.RigidBody(box, np.eye(3, 4))
    squares = sides**2
    assert np.allclose(np.diag(body.inertia), sides.prod() / 12 * (squares.sum() - squares))


def test_a_ball_has_its_mass_and_inertia():
    ball = surface("ball_fine")
    volume, centre, moments = rigid.integrals(ball.positions + [1, 2, 3], ball.triangles)
    assert volume == pytest.approx(4 / 3 * np.pi * 0.5**3, rel=5e-3)
    assert np.allclose(centre, [1, 2, 3])
    assert np.allclose(moments, volume * 0.5**2 / 5 * np.eye(3), rtol=5e-3, atol=1e-12)


@pytest.mark.parametrize("name", ["tray", "comb", "l"])
def test_tetrahedra_fill_their_surface(name):
    vertices, tetrahedra = volumes.fill(surface(name))
    a, b, c, d = (vertices[tetrahedra[:, i]] for i in range(4))
    parts = np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) / 6
    assert parts.min() > 0
    own = surface(name)
    assert parts.sum() == pytest.approx(rigid.integrals(own.positions, own.triangles)[0], rel=1e-5)


def test_flight_keeps_energy():
    body = rigid.RigidBody(surface("star"), turned(surface("star")))
    body.velocity = np.array([1, -2, 0.5, 3, -1, 4.0])
    still = rigid.RigidBody(surface("slab"), np.eye(3, 4), is_fixed=True)
    start = body.energy(np.zeros(3))
    for _ in range(200):
        rigid.step([still, body], NONE, 1 / 60, np.zeros(3))
    assert body.energy(np.zeros(3)) == pytest.approx(start, rel=1e-12)
    start = body.energy(HEAVY)
    for _ in range(60):
        rigid.step([still, body], NONE, 1 / 60, HEAVY)
    # What implicit Euler takes from a fall: half the square of each step's gain in speed.
    assert body.energy(HEAVY) == pytest.approx(start - 60 * body.mass * 0.5 * (9.81 / 60) ** 2, rel=1e-12)


def pair_in_contact(count=7):
    random = np.random.default_rng(3)
    bodies = [rigid.RigidBody(surface(name), turned(surface(name), i)) for i, name in enumerate(("l", "box"))]
    for body in bodies:
        body.velocity = random.normal(size=6)
    points, ways = random.normal(size=(2, count, 3))
    ways /= np.linalg.norm(ways, axis=1)[:, None]
    return bodies, Contacts.make(points, points, ways, random.uniform(0.1, 0.5, count), random.uniform(1, 2, count))


def test_contacts_keep_momentum():
    bodies, contacts = pair_in_contact()
    centres = [body.centre for body in bodies]

    def momentum():
        linear = sum(body.mass * body.velocity[:3] for body in bodies)
        return np.concatenate([linear, sum(
            turning @ body.velocity[3:] + np.cross(centre, body.mass * body.velocity[:3])
            for body, centre, turning in zip(bodies, centres, spins))])

    spins = [body.masses()[3:, 3:] for body in bodies]
    before, speeds = momentum(), [body.velocity.copy() for body in bodies]
    rigid.step(bodies, contacts, 1 / 30, np.zeros(3))
    assert np.allclose(momentum(), before, rtol=1e-12, atol=1e-12)
    assert not np.allclose(bodies[0].velocity, speeds[0])


def test_the_unit_of_weights_does_not_matter():
    ends = []
    for unit in (1.0, 1e6):
        bodies, contacts = pair_in_contact()
        contacts["weight"] *= unit
        rigid.step(bodies, contacts, 1 / 30, np.zeros(3))
        ends.append([body.velocity for body in bodies])
    assert np.allclose(*ends, rtol=1e-12)


@pytest.mark.parametrize("speed, pulled", [(1.0, False), (-1.0, True)])
def test_contacts_never_pull(speed, pulled):
    box = surface("box")
    bodies = [rigid.RigidBody(box, np.eye(3, 4), is_fixed=True), rigid.RigidBody(box, np.eye(3, 4), (speed, 0, 0))]
    rigid.step(bodies, Contacts.make(np.zeros((1, 3)), np.zeros((1, 3)), [[-1, 0, 0]], [0.01]), 1 / 60, np.zeros(3))
    assert (bodies[1].velocity[0] != speed) == pulled


class Ground(Library):
    """Pushes up all vertices of the second body that are below the top of the first, as far as `error` times their depth."""

    name = "ground"

    def __init__(self, error=1.0):
        self.error = error

    def load(self, first, second):
        self.top = first.positions[:, 2].max()

    def move(self, poses, positions):
        self.positions = positions[1]

    def inside(self):
        raise NotImplementedError

    def contacts(self):
        points = self.positions[self.positions[:, 2] < self.top]
        return Contacts.make(points, points, np.broadcast_to([0, 0, -1.0], points.shape),
                             self.error * (self.top - points[:, 2]))


class Nothing(Ground):
    def contacts(self):
        return NONE


def scene(kind, height=0.01):
    pair = surface("slab"), surface("box")
    pose = files.Pose(0, ("slab", "box"), kind, np.eye(3), np.array([0, 0, 0.5 + np.ptp(pair[1].positions[:, 2]) / 2 + height]))
    return pair, pose


def run(library, kind, parts, height=0.01):
    pair, pose = scene(kind, height)
    return simulate.run(library, pair, pose, simulate.Scene(pair, pose).put_in(), parts)


@pytest.mark.parametrize("parts", simulate.TIME_STEPS)
def test_a_box_comes_to_rest_where_its_spring_holds_it(parts):
    ended, gained, depth = run(Ground(), "drop", parts)
    assert ended == "done" and gained == 0
    # Mass · gravity = stiffness · depth, with four corners as deep as one another.
    assert depth == pytest.approx(9.81 * rigid.SWING**2, rel=0.03)


def test_a_shot_box_comes_back():
    assert run(Ground(), "impact", 60)[0] == "done"


def test_what_has_no_contacts_falls_through():
    assert run(Nothing(), "drop", 60)[0] == "sunk"
    assert run(Nothing(), "impact", 60)[0] == "sunk"
    assert run(Nothing(), "part", 60, height=-0.1)[0] == "stuck"


def test_a_body_that_lies_too_deep_has_sunk():
    assert run(Ground(error=0.05), "drop", 60)[0] == "sunk"


def test_depths_beyond_all_bounds_explode():
    ended, gained, _ = run(Ground(error=1000), "drop", 60)
    assert ended == "exploded" and gained > simulate.MOST_GAINED


def test_two_boxes_part_with_less_than_their_spring_has():
    ended, gained, _ = run(Ground(), "part", 240, height=-0.1)
    assert ended == "done" and 0 < gained < 0.3


def test_the_shortest_way_out_of_boxes():
    pair, pose = scene("part", height=-0.1)
    assert simulate.Scene(pair, pose).way_out() == pytest.approx(0.1, rel=5e-3)
