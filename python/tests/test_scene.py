# SPDX-License-Identifier: MIT OR Apache-2.0
"""Bodies over many steps, against laws that do not depend on the method."""

import numpy as np
import pytest
from raycontact import Contacts, Error, Mesh, Sampling, Scalar, Scene, Status
from shapes import ball, box, tetrahedron, torus


def rigid_balls(steps, **options):
    """Two rigid balls of 1 kg that start one inside the other: their middles and velocities at the end."""
    points, triangles = ball(12)
    scene, contacts = Scene(**options), Contacts()
    middles, velocities = np.array([[0.0, 0, 0], [0.9, 0.1, 0.2]]), np.zeros((2, 3))
    mesh = Mesh(points, triangles, precision=options.get("precision", Scalar.F64))
    bodies = [scene.add(mesh) for _ in middles]
    for _ in range(steps):
        for body, middle in zip(bodies, middles):
            scene.set_positions(body, points + middle)
        forces = np.zeros((2, len(points), 3))
        scene.query(contacts).add_forces(forces, stiffness=100)
        scene.advance(0.005)
        velocities += 0.005 * forces.sum(axis=1)
        middles += 0.005 * velocities
    return middles, velocities, len(contacts)


def test_balls_part_and_keep_their_momentum():
    middles, velocities, left = rigid_balls(600)
    assert left == 0
    assert np.linalg.norm(middles[1] - middles[0]) > 2
    np.testing.assert_allclose(velocities.sum(axis=0), 0, atol=1e-12)
    assert np.linalg.norm(velocities) > 0.1


def test_the_potential_of_a_box_on_a_slab_grows_by_the_work():
    corners, triangles = box([-0.5] * 3, [0.5] * 3)
    scene = Scene()
    slab, body = scene.add(Mesh(*box([-5, -5, -5], [5, 5, 0]))), scene.add(Mesh(corners, triangles))

    def at(depth):
        scene.set_positions(body, corners + [0, 0, 0.5 - depth])
        contacts = Contacts()
        joules = scene.potential(contacts, stiffness=100.0)
        forces = [np.zeros((8, 3)), np.zeros((8, 3))]
        contacts.add_forces(forces, stiffness=100.0)
        return joules, forces[body][:, 2].sum()

    (before, first), (after, last) = at(0.08), at(0.1)
    assert body > slab and after - before == pytest.approx(0.02 * (first + last) / 2, rel=0.02)


def test_results_do_not_depend_on_threads():
    for one, many in zip(rigid_balls(20, threads=1), rigid_balls(20, threads=3)):
        np.testing.assert_array_equal(one, many)


def test_float_scenes_agree_with_double():
    for single, double in zip(rigid_balls(20, precision=Scalar.F32), rigid_balls(20)):
        np.testing.assert_allclose(single, double, rtol=1e-3, atol=1e-4)


def test_the_same_positions_have_the_same_contacts():
    scene = Scene()
    for shift in (0, 0.2):
        scene.add(Mesh(*tetrahedron(shift)))
    first, again = scene.query().to_array(), scene.query().to_array()
    np.testing.assert_array_equal(first, again)
    assert len(first)


@pytest.mark.parametrize("precision", [Scalar.F32, Scalar.F64])
def test_poses_are_positions(precision):
    points, triangles = torus()
    rotation, _ = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))
    rotation *= np.sign(np.linalg.det(rotation))
    scenes = [Scene(precision=precision) for _ in range(2)]
    for scene in scenes:
        for _ in range(2):
            scene.add(Mesh(points, triangles, precision=precision))
    for step in range(3):
        position = np.array([0.3, 0.2 * step, 0.1])
        scenes[0].set_pose(1, position, rotation)
        # In the order of the sums that the header names.
        x, y, z = points.astype(np.float32 if precision == Scalar.F32 else float).astype(float).T
        moved = [((row[0] * x + row[1] * y) + row[2] * z) + p for row, p in zip(rotation, position)]
        scenes[1].set_positions(1, np.transpose(moved))
        by_pose, by_positions = (scene.query().to_array() for scene in scenes)
        assert len(by_pose)
        np.testing.assert_array_equal(by_pose, by_positions)
    for position, turn, status in (
        ([0, np.nan, 0], rotation, Status.NOT_FINITE),
        ([0, 0, 0], -rotation, Status.INVALID_DIRECTION),
        ([0, 0, 0], 2 * rotation, Status.INVALID_DIRECTION),
    ):
        with pytest.raises(Error) as error:
            scenes[0].set_pose(1, position, turn)
        assert error.value.status == status
    with pytest.raises(ValueError, match="rotation has 4 numbers; give 9"):
        scenes[0].set_pose(1, [0, 0, 0], np.eye(2))


def test_switches_and_removal():
    scene = Scene()
    numbers = [scene.add(Mesh(*tetrahedron(shift))) for shift in (0, 0.1, 0.2)]
    assert numbers == [0, 1, 2]
    assert scene.query().statistics()["pairs"] == 3
    scene.set_pair_collision(0, 1, False)
    assert scene.query().statistics()["pairs"] == 2
    scene.remove(1)
    contacts = scene.query()
    assert contacts.statistics()["pairs"] == 1
    forces = [np.zeros((4, 3)), None, np.zeros((4, 3))]
    contacts.add_forces(forces)
    np.testing.assert_allclose(forces[0].sum(axis=0), -forces[2].sum(axis=0), atol=1e-15)
    assert scene.add(Mesh(*tetrahedron())) == 3
    with pytest.raises(Error) as caught:
        scene.set_positions(1, tetrahedron()[0])
    assert caught.value.status == Status.UNKNOWN_BODY
    scene.release_body_numbers()
    assert [scene.add(Mesh(*tetrahedron())) for _ in range(2)] == [1, 4]


def test_self_collision_is_switched_on_by_body():
    (a, faces), (b, _) = ball(10), ball(10, (1.5, 0.01, 0.02))
    scene = Scene()
    body = scene.add(Mesh(np.concatenate([a, b]), np.concatenate([faces, faces + len(a)])))
    assert len(scene.query()) == 0
    scene.set_self_collision(body, True)
    assert scene.query().statistics()["self_contacts"] > 0


def test_coarse_carriers_take_fewer_samples():
    scene = Scene()
    for shift in (0, 1.5):
        scene.add(Mesh(*ball(20, (shift, 0.01, 0.02))))
    default = len(scene.query())
    for body in (0, 1):
        scene.set_carrier_spacing(body, 0.3)
    assert 5 < len(scene.query()) < default / 2
    scene.set_carrier_spacing(1, 0)  # the finer of both decides
    assert len(scene.query()) == default
    for wrong in (-1, np.nan):
        with pytest.raises(Error, match="carrier_spacing is"):
            scene.set_carrier_spacing(0, wrong)
    with pytest.raises(Error):
        scene.set_carrier_spacing(2, 0.3)


def test_detection_options_hold_until_set_again():
    scene = Scene()
    for shift in (0, 0.2):
        scene.add(Mesh(*tetrahedron(shift)))
    default = len(scene.query())
    scene.set_detection_options(sampling=Sampling.SPACING, sampling_value=0.3)
    assert len(scene.query()) < default
    scene.set_detection_options()
    assert len(scene.query()) == default


def test_what_pairs_remember_can_be_saved():
    def swallowed():
        scene = Scene()
        scene.add(Mesh(*box([-1] * 3, [1] * 3)))
        scene.add(Mesh(*torus(20, 10, 0.4, 0.1)))
        return scene

    scene, other = swallowed(), swallowed()
    scene.query()
    scene.advance(1 / 60)
    memories = scene.pair_memories()
    assert memories[["first", "second", "escaping"]].tolist() == [(0, 1, 1)]
    saved = scene.save_pair_memories()
    other.query()
    other.restore_pair_memories(saved)
    np.testing.assert_array_equal(other.pair_memories(), memories)
    with pytest.raises(Error) as caught:
        other.restore_pair_memories(saved[:-1] + bytes([saved[-1] ^ 1]))
    assert caught.value.status == Status.SAVED_STATE_BROKEN
    np.testing.assert_array_equal(other.pair_memories(), memories)


def test_the_derivative_of_contacts_found_anew_refuses_what_is_not_theirs():
    scene, positions = Scene(), [tetrahedron(at)[0] for at in (0, 0.2)]
    for x in positions:
        scene.add(Mesh(x, tetrahedron(0)[1]))
    contacts, along = scene.query(), [np.ones((4, 3)), np.zeros((4, 3))]
    assert len(contacts)

    def refused(status, what, displacements, of=scene):
        forces = [np.zeros((4, 3)), np.zeros((4, 3))]
        with pytest.raises(Error, match=what) as error:
            contacts.add_differential(displacements, forces, scene=of)
        assert error.value.status == status and not np.any(forces)

    refused(Status.WRONG_COUNT, "vertex 3 of body 0", [along[0][:3], along[1]])
    refused(Status.NOT_FINITE, "displacements", [along[0] * np.nan, along[1]])
    refused(Status.UNKNOWN_BODY, "no body 0", along, of=Scene())
    refused(Status.PRECISION_MISMATCH, "same precision", along, of=Scene(precision="f32"))
    scene.set_positions(1, positions[1] + 0.01)
    refused(Status.OCTREE_STALE, "a query of this scene", along)
    scene.query(contacts)
    forces = [np.zeros((4, 3)), np.zeros((4, 3))]
    contacts.add_differential(along, forces, scene=scene)
    assert np.any(forces) and np.abs(forces[0].sum(axis=0) + forces[1].sum(axis=0)).max() < 1e-12
