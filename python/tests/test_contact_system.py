# SPDX-License-Identifier: MIT OR Apache-2.0
"""A simulator in a few lines on the contact system alone, held to closed forms and finite differences."""

from dataclasses import replace

import numpy as np
import pytest
import raycontact
from raycontact import ContactSystem, Material, Mesh, Scene, Status
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


def soft_ball():
    """A ball whose surface vertices are nodes, pressed 5 cm into a floor."""
    points, faces = ball(rings=12)
    scene, system = Scene(), ContactSystem()
    body = scene.add(Mesh(points, faces))
    system.set_node_masses(np.full(len(points), 0.1))
    system.add_deformable(scene, body, 0, len(points), MATERIAL)
    system.add_half_space([0, 0, 1], -0.95, MATERIAL)
    return scene, system, np.array(points)


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
        system.add_forces(v, np.zeros(x.shape, np.float32))
    suggested = Material.bearing(1000.0, 0.01)
    assert suggested.stiffness == pytest.approx(1e5) and suggested.depth_cap == 0.01
