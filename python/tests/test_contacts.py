# SPDX-License-Identifier: MIT OR Apache-2.0
"""Contacts and the forces they make, against closed forms, finite differences and the contacts' own numbers."""

import numpy as np
import pytest
from raycontact import (
    ContactKind,
    Contacts,
    Error,
    Law,
    Mesh,
    Sampling,
    Scalar,
    Scene,
    Status,
    Weighting,
    query_pair,
    query_self,
)
from shapes import ball, box, tetrahedron, torus


def overlapping(law=Law.PRESSURE):
    """Two tori in one another, their contacts, and where their vertices are."""
    (a, triangles), (b, _) = torus(40, 20), torus(40, 20)
    b = np.ascontiguousarray(b[:, [0, 2, 1]] * [1, 1, -1] + [1.2, 0.1, 0.05])
    contacts = query_pair(Mesh(a, triangles), Mesh(b, triangles), law=law)
    assert set(contacts.to_array()["colliding"]) == {0, 1}
    return contacts, [a, b]


def forces_at(contacts, positions=None, like=None, **options):
    forces = [np.zeros_like(x) for x in (positions or like)]
    contacts.add_forces(forces, positions, **options)
    return forces


@pytest.mark.parametrize("depth", [0.2, 0.5])
def test_a_ball_in_a_flat_face_is_pushed_by_stiffness_times_volume(depth):
    floor, sphere = box([-3, -3, -3], [3, 3, 0]), ball(60, (0, 0, 1 - depth))
    contacts = query_pair(Mesh(*floor), Mesh(*sphere))
    forces = forces_at(contacts, like=[floor[0], sphere[0]], stiffness=1000)
    cap = np.pi * depth**2 * (3 - depth) / 3
    np.testing.assert_allclose(forces[1].sum(axis=0), [0, 0, 1000 * cap], rtol=0.01, atol=1000 * cap * 1e-3)
    np.testing.assert_allclose(forces[0].sum(axis=0), -forces[1].sum(axis=0), rtol=1e-12, atol=1e-9)


def test_net_force_and_torque_are_zero():
    contacts, x = overlapping()
    forces = forces_at(contacts, like=x)
    scale = np.abs(np.concatenate(forces)).sum()
    assert np.abs(sum(f.sum(axis=0) for f in forces)).max() < 1e-14 * scale
    torque = sum(np.cross(p, f).sum(axis=0) for p, f in zip(x, forces))
    assert np.abs(torque).max() < 1e-13 * scale


def test_a_ball_that_slides_on_a_floor_is_braked():
    floor, sphere = box([-3, -3, -3], [3, 3, 0]), ball(30, (0, 0, 0.9))
    contacts = query_pair(Mesh(*floor), Mesh(*sphere), sampling_value=0.05)
    about, twists, wrenches = np.array([[0, 0, 0], [0, 0, 0.9]]), np.zeros((2, 6)), np.zeros((2, 6))
    twists[1, :3] = 3, 4, 0
    contacts.add_wrenches(wrenches, about, twists, friction=0.5, slip_speed=12)
    # Shallow contact: all rays are nearly vertical, and all slip at 5 m/s; 5 / sqrt(5² + 12²).
    x, y, n = wrenches[1, :3]
    np.testing.assert_allclose([x / n, y / n], np.array([-0.6, -0.8]) * 0.5 * 5 / 13, rtol=0.1)
    torques = wrenches[:, 3:] + np.cross(about, wrenches[:, :3])
    np.testing.assert_allclose(wrenches[0, :3] + wrenches[1, :3], 0, atol=1e-14 * n)
    np.testing.assert_allclose(torques[0] + torques[1], 0, atol=1e-13 * n)
    with pytest.raises(Error, match="slip_speed is 0") as caught:
        contacts.add_wrenches(wrenches, about, twists, friction=0.5)
    assert caught.value.status == Status.INVALID_OPTION
    with pytest.raises(ValueError, match="about has 3 numbers; give 6"):
        contacts.add_wrenches(wrenches, about[:1], twists)


@pytest.mark.parametrize("law", list(Law))
@pytest.mark.parametrize("weighting", list(Weighting))
def test_forces_are_those_of_the_contacts_own_numbers(law, weighting):
    contacts, x = overlapping(law)
    options = dict(stiffness=3.0, weighting=weighting)
    array = contacts.to_array()
    assert array.shape == (len(contacts),) and (array["kind"] == ContactKind.RAY).all()
    weight = array["area"] if weighting == Weighting.AREA else 1.0
    coefficients = contacts.coefficients(**options)
    np.testing.assert_allclose(coefficients, 3 * weight * array["cos_alpha"], rtol=1e-14)
    pushes = (coefficients * array["depth"])[:, None] * array["direction"]
    expected = [np.zeros_like(p) for p in x]
    for end, sign, owner in (("p1", 1, "colliding"), ("p2", -1, "collided")):
        for body in (0, 1):
            mine = array[owner] == body
            spread = sign * array[end]["weights"][mine][:, :, None] * pushes[mine][:, None, :]
            np.add.at(expected[body], array[end]["vertices"][mine], spread)
    for found, wanted in zip(forces_at(contacts, like=x, **options), expected):
        np.testing.assert_allclose(found, wanted, atol=1e-14)


def test_fields_of_a_contact_belong_together():
    contacts, x = overlapping()
    array = contacts.to_array()
    np.testing.assert_allclose(
        array["p2"]["position"] - array["p1"]["position"], array["depth"][:, None] * array["direction"], atol=1e-12
    )
    for end, owner in (("p1", "colliding"), ("p2", "collided")):
        corners = np.stack([x[body][vertices] for body, vertices in zip(array[owner], array[end]["vertices"])])
        np.testing.assert_allclose(
            np.einsum("ij,ijk->ik", array[end]["weights"], corners), array[end]["position"], atol=1e-13
        )
    assert (array["depth"] >= 0).all() and (array["area"] > 0).all()


def test_forces_are_the_negative_gradient_of_the_energy():
    contacts, x = overlapping()
    rng = np.random.default_rng(2)
    d = [rng.standard_normal(p.shape) for p in x]
    forces = forces_at(contacts, x)
    step = 1e-5
    ahead, behind = (contacts.energy([p + s * q for p, q in zip(x, d)]) for s in (step, -step))
    work = sum((f * q).sum() for f, q in zip(forces, d))
    assert -(ahead - behind) / (2 * step) == pytest.approx(work, rel=1e-7)
    assert contacts.energy() == pytest.approx(contacts.energy(x), rel=1e-10)


def test_the_differential_is_that_of_the_forces():
    contacts, x = overlapping()
    rng = np.random.default_rng(3)
    d, e = ([rng.standard_normal(p.shape) for p in x] for _ in range(2))
    options = dict(stiffness=2.0, damping_time=0.1)
    ahead, behind = (forces_at(contacts, [p + s * q for p, q in zip(x, d)], stiffness=2.0) for s in (0.5, -0.5))
    found, other = ([np.zeros_like(p) for p in x] for _ in range(2))
    contacts.add_differential(d, found, **options)
    contacts.add_differential(e, other, **options)
    for f, a, b in zip(found, ahead, behind):
        np.testing.assert_allclose(f, a - b, atol=1e-12 * np.abs(f).max() + 1e-12)
    inner = [sum((p * q).sum() for p, q in zip(*pair)) for pair in ((found, e), (other, d), (found, d))]
    assert inner[0] == pytest.approx(inner[1], rel=1e-10)
    assert inner[2] < 0

    damped, still = ([np.zeros_like(p) for p in x] for _ in range(2))
    contacts.add_forces(damped, velocities=d, **options)
    contacts.add_forces(still, stiffness=2.0)
    by_velocity = [np.zeros_like(p) for p in x]
    contacts.add_differential(d, by_velocity, stiffness_factor=0, damping_factor=1, **options)
    for a, b, c in zip(damped, still, by_velocity):
        np.testing.assert_allclose(a - b, c, atol=1e-13)


def test_every_ray_is_counted():
    contacts, _ = overlapping()
    counted = contacts.statistics()
    assert counted["pairs"] == 1 and counted["contacts"] == len(contacts)
    reasons = ("contacts", "misses", "entry_hits", "own_surface_hits", "replaced")
    assert counted["rays"] == sum(counted[name] for name in reasons) > 0


def test_options_reach_the_query():
    a, b = Mesh(*tetrahedron()), Mesh(*tetrahedron(0.2))
    reused = Contacts()
    coarse = query_pair(a, b, reused, sampling=Sampling.SPACING, sampling_value=0.2, edges=False)
    assert coarse is reused
    count = len(coarse)
    assert 0 < count < len(query_pair(a, b, reused, sampling=Sampling.SPACING, sampling_value=0.02))


def test_enums_may_be_given_by_name():
    a, b = Mesh(*tetrahedron(), precision="f32"), Mesh(*tetrahedron(0.2), precision=Scalar.F32)
    by_name = query_pair(a, b, sampling="vertices", law="Ray_Length").to_array()
    by_number = query_pair(a, b, sampling=Sampling.VERTICES, law=Law.RAY_LENGTH).to_array()
    assert len(by_name) > 0
    np.testing.assert_array_equal(by_name, by_number)


def test_a_body_that_overlaps_itself_touches_itself():
    (a, faces), (b, _) = ball(12), ball(12, (1.5, 0.01, 0.02))
    contacts = query_self(Mesh(np.concatenate([a, b]), np.concatenate([faces, faces + len(a)])))
    array = contacts.to_array()
    assert len(array) and (array["colliding"] == 0).all() and (array["collided"] == 0).all()
    force = np.zeros((2 * len(a), 3))
    contacts.add_forces([force])
    assert force[: len(a), 0].sum() < 0 < force[len(a) :, 0].sum()


def test_numpy_makes_of_contacts_what_they_hold():
    contacts, _ = overlapping()
    array = contacts.to_array()
    for found in (np.asarray(contacts), np.array(contacts), np.array(contacts, copy=True), np.asarray(contacts, array.dtype)):
        assert found.dtype == array.dtype
        np.testing.assert_array_equal(found, array)
    with pytest.raises(ValueError, match="only be copied"):
        np.asarray(contacts, copy=False)


def test_a_list_without_contacts_is_an_empty_array():
    contacts = Contacts()
    assert len(contacts) == 0 and contacts.to_array().shape == (0,)
    assert contacts.energy() == 0 and contacts.escape_pushes().shape == (0,)


def test_a_swallowed_body_escapes():
    scene = Scene()
    scene.add(Mesh(*box([-1] * 3, [1] * 3)))
    scene.add(Mesh(*box([-0.3, -0.2, -0.1], [0.1, 0.2, 0.3])))
    contacts = scene.query()
    (push,) = contacts.escape_pushes()
    assert (contacts.to_array()["kind"] == ContactKind.ESCAPE).all()
    assert (push["first"], push["second"]) in {(0, 1), (1, 0)}
    assert np.linalg.norm(push["direction"]) == pytest.approx(1)
    # Out of the nearest side: 0.7 m to it, and 0.4 m of the body's own.
    assert push["depth"] == pytest.approx(1.1, abs=1e-12)
    assert contacts.statistics()["escaping_pairs"] == 1
    scene.allow_escape(0, 1, False)
    assert not scene.may_escape(1, 0)
    assert len(scene.query().escape_pushes()) == 0
    assert contacts.statistics()["escapes_forbidden"] == 0  # a list of its own


def test_a_body_without_an_array_is_told():
    contacts, x = overlapping()
    with pytest.raises(Error, match="body 1, which has no array") as caught:
        contacts.add_forces([np.zeros_like(x[0])])
    assert caught.value.status == Status.WRONG_COUNT
    with pytest.raises(Error) as caught:
        contacts.add_forces([np.zeros_like(x[0]), None])
    assert caught.value.status == Status.WRONG_COUNT


def test_contacts_are_a_sequence_that_says_how_long_it_is():
    contacts, _ = overlapping()
    array = contacts.to_array()
    assert repr(contacts) == f"Contacts({len(array)} contacts)"
    assert contacts[0] == array[0] and contacts[-1] == array[-1] and list(contacts) == list(array)
    np.testing.assert_array_equal(contacts["depth"], array["depth"])
    np.testing.assert_array_equal(contacts[contacts["depth"] > 0.1], array[array["depth"] > 0.1])
    with pytest.raises(IndexError):
        contacts[len(contacts)]
