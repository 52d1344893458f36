# SPDX-License-Identifier: MIT OR Apache-2.0
"""A simulator in a few lines on the contact system alone, held to closed forms and finite differences."""

from dataclasses import replace

import numpy as np
import pytest
import raycontact
from raycontact import Batch, ContactSystem, Error, Material, Mesh, Scene, Status
from shapes import ball, box

GRAVITY = np.array([0.0, 0.0, -9.81])
MATERIAL = Material(stiffness=1e5, damping_time=0.05, friction=0.5)


def rigid_box(friction, tilt):
    """A box of 2 kg and edge 1 on a floor that is tilted about y."""
    corners, faces = box([-0.5] * 3, [0.5] * 3)
    scene, system = Scene(), ContactSystem()
    body = scene.add(Mesh(corners, faces))
    system.set_node_masses([])
    material = replace(MATERIAL, friction=friction)
    system.add_rigid(scene, body, 2.0, np.eye(3) * 2.0 / 6.0, material)
    normal = np.array([np.sin(tilt), 0.0, np.cos(tilt)])
    system.add_half_space(normal, 0.0, material)
    turn = np.array([[np.cos(tilt), 0, np.sin(tilt)], [0, 1, 0], [-np.sin(tilt), 0, np.cos(tilt)]])
    return scene, system, body, normal, turn


def slide(friction, tilt, seconds, dt=1 / 60):
    """How fast the box goes down the slope at the end."""
    scene, system, body, normal, turn = rigid_box(friction, tilt)
    position, velocity, empty = 0.5 * normal, np.zeros(6), np.zeros(0)
    for _ in range(round(seconds / dt)):
        free = velocity + dt * np.concatenate([GRAVITY, np.zeros(3)])
        system.set_motion(body, position, turn, velocity, free)
        system.begin(scene, dt, empty, empty, empty)
        for _ in range(3):
            if system.linearise(empty) < 0.01:
                break
        system.finish(empty)
        velocity = system.rigid_velocity(body)
        position = position + dt * velocity[:3]
    return velocity[:3] @ (turn @ [1.0, 0.0, 0.0])


def test_a_box_holds_at_friction_above_the_slope_and_slides_below():
    assert abs(slide(0.5, 0.2, 1.0)) < 1e-3
    expected = 9.81 * (np.sin(0.2) - 0.1 * np.cos(0.2))
    assert slide(0.1, 0.2, 1.0) - slide(0.1, 0.2, 0.5) == pytest.approx(0.5 * expected, rel=0.02)


def soft_ball(precision="f64"):
    """A ball whose surface vertices are nodes, pressed 5 cm into a floor."""
    points, faces = ball(rings=12)
    scene, system = Scene(precision=precision), ContactSystem(precision=precision)
    body = scene.add(Mesh(points, faces, precision=precision))
    system.set_node_masses(np.full(len(points), 0.1))
    system.add_deformable(scene, body, 0, len(points), MATERIAL)
    system.add_half_space([0, 0, 1], -0.95, MATERIAL)
    return scene, system, np.array(points)


def test_the_potential_is_that_of_what_lies_below_the_floor():
    x, faces = box([-0.5] * 3, [0.5] * 3)
    scene, system = Scene(), ContactSystem()
    body = scene.add(Mesh(x, faces))
    system.set_node_masses(np.full(8, 0.1))
    system.add_deformable(scene, body, 0, 8, MATERIAL)
    system.add_half_space([0, 0, 1], -0.48, MATERIAL)
    dt, v = 0.01, np.zeros_like(x)
    system.begin(scene, dt, x, v, v)
    v[:, 2] = -1.0
    stiffness = MATERIAL.stiffness / 2  # of two in series
    for part in (0.0, 0.5, 1.0):
        depth = 0.02 + part * dt
        assert system.potential(scene, v, part) == pytest.approx(0.5 * stiffness * depth**2, rel=1e-9)
    before = np.zeros_like(x)
    system.add_forces(np.zeros_like(x), before)
    with pytest.raises(Error, match="part") as wrong:
        system.potential(scene, v, 1.5)
    assert wrong.value.status == Status.INVALID_OPTION
    v[3, 1] = np.nan
    with pytest.raises(Error, match="velocities"):
        system.potential(scene, v)
    after = np.zeros_like(x)
    system.add_forces(np.zeros_like(x), after)
    np.testing.assert_array_equal(before, after)


def test_forces_are_the_gradient_of_the_energy_and_products_their_derivative():
    scene, system, x = soft_ball()
    dt, v = 0.01, np.zeros_like(x)
    v[:, 2] = -0.3
    system.begin(scene, dt, x, v, v)
    forces, product, change = np.zeros_like(x), np.zeros_like(x), np.random.default_rng(1).normal(size=x.shape)
    system.add_forces(v, forces)
    assert forces[:, 2].sum() > 1 and np.all(forces[x[:, 2] > 0] == 0)
    step = 1e-6
    difference = (system.energy(v + step * change) - system.energy(v - step * change)) / (2 * step)
    assert difference == pytest.approx(-dt * np.sum(forces * change), rel=1e-6)
    system.add_product(1.0, change, product)
    moved = np.zeros_like(x)
    system.add_forces(v + change, moved)
    assert product == pytest.approx(forces - moved, rel=1e-9, abs=1e-9 * np.abs(forces).max())
    rows, columns, blocks = system.blocks(1.0)
    assembled = np.zeros_like(x)
    np.add.at(assembled, rows, np.einsum("nij,nj->ni", blocks, change[columns]))
    assert assembled == pytest.approx(product, rel=1e-9, abs=1e-9 * np.abs(product).max())
    system.cancel()


def test_an_explicit_step_adds_forces_and_says_how_long_it_may_be():
    scene, _, x = soft_ball()
    system = ContactSystem(keeps_rigid_unknowns=True)
    system.set_node_masses(np.full(len(x), 0.1))
    system.add_deformable(scene, 0, 0, len(x), MATERIAL)
    system.add_half_space([0, 0, 1], -0.95, MATERIAL)
    forces = np.zeros_like(x)
    longest = system.explicit_step(scene, 1e-3, x, np.zeros_like(x), forces)
    assert 1e-4 < longest < 1 and forces[:, 2].sum() > 1


def test_a_skin_follows_its_nodes_by_weights():
    corners, faces = box([-0.5] * 3, [0.5] * 3)
    scene, system = Scene(), ContactSystem()
    body = scene.add(Mesh(corners, faces))
    # One node carries all eight corners.
    system.set_node_masses([2.0])
    system.add_deformable(scene, body, 0, 1, MATERIAL, (np.arange(9), np.zeros(8, int), np.ones(8)))
    with pytest.raises(raycontact.Error) as refused:
        system.add_half_space([0, 0, 2], 0.0, MATERIAL)
    assert refused.value.status == Status.INVALID_DIRECTION
    with pytest.raises(ValueError, match="weights has 7 numbers; give 8"):
        system.add_deformable(scene, body, 0, 1, MATERIAL, (np.arange(9), np.zeros(8, int), np.ones(7)))


@pytest.mark.parametrize(
    "offsets, nodes, error, text",
    [
        (np.arange(9) + 2**32, np.zeros(8, int), ValueError, r"offsets\[0\] is 4294967296"),
        (np.arange(9), np.full(8, 2**32), ValueError, r"nodes\[0\] is 4294967296"),
        (np.arange(9), [0, 0, -1, 0, 0, 0, 0, 0], ValueError, r"nodes\[2\] is -1"),
        (np.arange(9), np.full(8, 0.7), TypeError, "nodes has the dtype float64"),
    ],
)
def test_a_skin_of_numbers_that_would_wrap_is_refused(offsets, nodes, error, text):
    scene, system = Scene(), ContactSystem()
    body = scene.add(Mesh(*box([-0.5] * 3, [0.5] * 3)))
    system.set_node_masses([2.0])
    with pytest.raises(error, match=text):
        system.add_deformable(scene, body, 0, 1, MATERIAL, (offsets, nodes, np.ones(8)))


def test_refusals():
    scene, system, x = soft_ball()
    v = np.zeros_like(x)
    with pytest.raises(raycontact.Error) as refused:
        system.add_forces(v, np.zeros_like(x))
    assert refused.value.status == Status.OUT_OF_ORDER
    with pytest.raises(raycontact.Error) as refused:
        system.begin(scene, 0.0, x, v, v)
    assert refused.value.status == Status.INVALID_STEP
    with pytest.raises(ValueError, match="velocities has 3 numbers"):
        system.begin(scene, 0.01, x, np.zeros(3), v)
    with pytest.raises(ValueError, match="forces cannot be added to"):
        system.add_forces(v, np.zeros(x.shape, np.float16))
    suggested = Material.bearing(1000.0, 0.01)
    assert suggested.stiffness == pytest.approx(1e5) and suggested.depth_cap == 0.01 and suggested.restitution == 0
    elastic = Material.elastic(1e5, 0.3, 0.04)
    assert elastic.stiffness == pytest.approx(1e8) and elastic.depth_cap == 0.002
    assert Material.elastic(1e5, 0.49, 0.04).stiffness == pytest.approx(1e8 / 0.06)  # by its bulk
    with pytest.raises(raycontact.Error, match="restitution is 1.5; it must be from 0 to 1") as refused:
        system.add_half_space([0, 0, 1], 0.0, Material(1e5, restitution=1.5))
    assert refused.value.status == Status.INVALID_MATERIAL


@pytest.mark.parametrize("precision", ["f32", "f64"])
def test_compressed_rows_are_the_matrix_of_the_products(precision):
    scene, system, x = soft_ball(precision)
    v = np.zeros_like(x)
    system.begin(scene, 0.01, x, v, v)
    numbers, columns, ends = system.csr(0.5)
    assert (numbers.dtype, columns.dtype, ends.dtype) == (np.float64, np.int32, np.int32)
    assert len(ends) == x.size + 1 and ends[0] == 0 and ends[-1] == len(columns) == len(numbers) > 9
    rows = np.repeat(np.arange(x.size), np.diff(ends))
    places = rows * x.size + columns
    assert np.all(np.diff(places) > 0)  # columns ascend in each row, and none comes twice
    matrix = np.zeros((x.size, x.size))
    matrix[rows, columns] = numbers
    change, product = np.random.default_rng(2).normal(size=x.shape), np.zeros_like(x)
    system.add_product(0.5, change, product)
    assert matrix @ change.ravel() == pytest.approx(product.ravel(), rel=1e-9, abs=1e-12 * np.abs(product).max())
    assert np.array_equal(matrix, matrix.T)
    kept = numbers.copy()
    system.csr(1.0)
    system.cancel()
    del system
    assert np.array_equal(numbers, kept)  # they own their memory


def test_compressed_rows_of_nothing_and_of_eliminated_bodies():
    system, scene = ContactSystem(), Scene()
    empty = np.zeros(0)
    with pytest.raises(raycontact.Error) as refused:
        system.csr()
    assert refused.value.status == Status.OUT_OF_ORDER
    system.begin(scene, 0.01, empty, empty, empty)
    numbers, columns, ends = system.csr()
    assert len(numbers) == len(columns) == 0 and ends.tolist() == [0]
    scene, system, body, *_ = rigid_box(0.5, 0.0)
    system.begin(scene, 0.01, empty, empty, empty)
    with pytest.raises(raycontact.Error) as refused:
        system.csr()
    assert refused.value.status == Status.RIGID_ELIMINATED


@pytest.mark.parametrize("precision", ["f32", "f64"])
def test_floats_come_in_and_go_out_where_they_lie(precision):
    scene, system, x = soft_ball(precision)
    twin_scene, twin, _ = soft_ball(precision)
    single = x.astype(np.float32)
    x, v = single.astype(np.float64), np.zeros(x.shape)
    v[:, 2] = -0.25
    v32 = v.astype(np.float32)
    system.begin(scene, 0.01, x, v, v)
    twin.begin(twin_scene, 0.01, single, v32, v32)
    for add in ("forces", "product"):
        sums, sums32 = np.zeros_like(x), np.zeros_like(single)
        given = () if add == "forces" else (0.01,)
        getattr(system, f"add_{add}")(*given, v, sums)
        getattr(twin, f"add_{add}")(*given, v32, sums32)
        assert np.any(sums32) and np.array_equal(sums32, sums.astype(np.float32))
    assert twin.energy(v32) == system.energy(v) > 0
    assert twin.misjudged(0 * v32) == system.misjudged(0 * v)
    assert twin.linearise(v32) == system.linearise(v)
    assert not twin.detect_again(twin_scene, v32)
    twin.finish(v32)
    system.finish(v)
    assert np.array_equal(twin.pair_force(0, 0, True), system.pair_force(0, 0, True))
    mixed = np.zeros_like(single)
    system.begin(scene, 0.01, single, v, v32)
    system.add_forces(v, mixed)
    assert np.any(mixed)


def overlapping_boxes(count, threads):
    """So many scenes of two soft boxes each, by which the overlap differs; positions have a row for each scene."""
    scenes, systems, positions = [], [], np.zeros((count, 2, 8, 3))
    for k in range(count):
        scenes.append(Scene(threads=threads))
        systems.append(ContactSystem())
        systems[k].set_node_masses(np.ones(16))
        for body in range(2):
            corners, faces = box([-0.5 + body * (0.8 + 0.01 * k)] * 3, [0.5 + body * (0.8 + 0.01 * k)] * 3)
            systems[k].add_deformable(scenes[k], scenes[k].add(Mesh(corners, faces)), 8 * body, 8, MATERIAL)
            positions[k, body] = corners
    return scenes, systems, positions


@pytest.mark.parametrize("threads", [1, 2])
def test_a_batch_does_what_each_scene_does(threads):
    (scenes, systems, x), (twin_scenes, twins, _) = overlapping_boxes(9, 1), overlapping_boxes(9, threads)
    batch, v = Batch(twin_scenes, twins), np.zeros_like(x)
    batch.begin(0.01, x, v, v)
    assert not batch.statuses.any() and not batch.detect_again(v).any()
    batch.query()
    for k in range(9):
        systems[k].begin(scenes[k], 0.01, x[k], v[k], v[k])
        forces, of_twin = np.zeros((2, 2, 8, 3))
        systems[k].add_forces(v[k], forces)
        twins[k].add_forces(v[k], of_twin)
        assert np.any(forces) and np.array_equal(forces, of_twin)
        assert batch.contacts[k].to_array().tobytes() == scenes[k].query().to_array().tobytes()


def test_an_error_in_a_batch_spares_the_other_scenes():
    scenes, systems, x = overlapping_boxes(5, 2)
    batch, v = Batch(scenes, systems), np.zeros_like(x)
    x[3, 1, 0, 0] = np.nan
    with pytest.raises(raycontact.Error, match=r"scene 3: positions\[24\]") as refused:
        batch.begin(0.01, x, v, v)
    assert refused.value.status == Status.NOT_FINITE
    assert batch.statuses.tolist() == [0, 0, 0, Status.NOT_FINITE, 0]
    assert all(systems[k].energy(v[k]) > 0 for k in (0, 1, 2, 4))
    with pytest.raises(ValueError, match="5 scenes have 5 systems"):
        batch.begin(0.01, x[:4], v[:4], v[:4])
    with pytest.raises(ValueError, match="5 scenes have 0 systems"):
        Batch(scenes).begin(0.01, x, v, v)
    with pytest.raises(ValueError, match="velocities has 96 numbers; give 240"):
        batch.begin(0.01, x, v[:2], v)
    empty = Batch([])
    empty.query()
    assert empty.contacts == []
