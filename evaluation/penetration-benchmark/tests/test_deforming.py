# SPDX-License-Identifier: MIT OR Apache-2.0
"""The elastic bodies, their solid and the judge's depth, against closed forms and finite differences."""

import numpy as np
import pytest
from penetration_benchmark import bodies, deforming

SHAPES = {"box": deforming.box, "ball": deforming.ball, "torus": deforming.torus}


@pytest.mark.parametrize("name", SHAPES)
def test_bodies_are_closed_and_not_inside_out(name):
    body = deforming.Body(*SHAPES[name]())
    assert bodies.volumes(body.points, body.tetrahedra).min() > 0
    ways = np.concatenate([body.triangles[:, pair] for pair in ((0, 1), (1, 2), (2, 0))])
    assert {tuple(way) for way in ways} == {tuple(way) for way in ways[:, ::-1]} and len(set(map(tuple, ways))) == len(ways)
    assert np.ptp(body.points, axis=0).max() == pytest.approx(1)
    corners = body.points[body.triangles]
    enclosed = np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6
    assert enclosed == pytest.approx(bodies.volumes(body.points, body.tetrahedra).sum())


def scene(is_deep=True):
    box = deforming.Body(*deforming.box())
    return deforming.Scene(box, box, is_deep)


def test_the_solid_rests_at_rest_and_its_derivatives_are_those_of_its_energy():
    pair, random = scene(), np.random.default_rng(1)
    solid, x = deforming.Solid(pair), pair.rest
    scale = deforming.YOUNG
    assert solid.mass.sum() == pytest.approx(2 * deforming.DENSITY)
    assert np.abs(solid.slope(x)).max() < 1e-12 * scale
    there, way, step = x + 0.02 * random.normal(size=x.shape), random.normal(size=x.shape), 1e-6
    difference = (solid.energy(there + step * way) - solid.energy(there - step * way)) / (2 * step)
    assert (solid.slope(there) * way).sum() == pytest.approx(difference, rel=1e-6)
    # At rest nothing is cut off.
    bent = (solid.slope(x + step * way) - solid.slope(x - step * way)) / (2 * step)
    product = solid.curvature(x) @ way.ravel()
    assert product == pytest.approx(bent.ravel(), abs=1e-6 * np.abs(bent).max())


class Still:
    def __init__(self, pair):
        self.x = pair.rest

    def step(self):
        pass


def test_bodies_that_do_not_move_have_not_parted():
    for is_deep, parted in ((False, "never met"), (True, "no")):
        pair = scene(is_deep)
        assert deforming.run(Still, pair, deforming.Solid(pair))[1] == parted


def test_depth_is_that_of_two_boxes():
    pair = scene()
    assert not pair.is_apart(pair.halves(pair.rest))
    # Vertices of the face that lies a quarter deep, and farther than that from the faces beside.
    assert pair.depth(pair.rest) == pytest.approx(deforming.INTO, rel=1e-12)
    pair = scene(is_deep=False)
    assert pair.is_apart(pair.halves(pair.rest)) and pair.depth(pair.rest) == 0
