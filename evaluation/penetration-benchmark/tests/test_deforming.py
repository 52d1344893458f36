# SPDX-License-Identifier: MIT OR Apache-2.0
"""The elastic bodies, their solid, the judge's depth and what libraries make of held nodes, against closed forms and
finite differences."""

import numpy as np
import pytest
from penetration_benchmark import bodies
from penetration_benchmark.deforming import __main__ as program
from penetration_benchmark.deforming import scenes, solid, solvers

SHAPES = {"box": scenes.box, "ball": scenes.ball, "torus": scenes.torus}


class Middle:
    """Draws nothing: the middle between two bounds."""

    def between(self, low, high):
        return (low + high) / 2


@pytest.mark.parametrize("name", SHAPES)
def test_bodies_are_closed_and_not_inside_out(name):
    body = scenes.Body(*SHAPES[name]())
    assert bodies.volumes(body.points, body.tetrahedra).min() > 0
    ways = np.concatenate([body.triangles[:, pair] for pair in ((0, 1), (1, 2), (2, 0))])
    assert {tuple(way) for way in ways} == {tuple(way) for way in ways[:, ::-1]} and len(set(map(tuple, ways))) == len(ways)
    assert np.ptp(body.points, axis=0).max() == pytest.approx(1)
    corners = body.points[body.triangles]
    enclosed = np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6
    assert enclosed == pytest.approx(bodies.volumes(body.points, body.tetrahedra).sum())


def boxes(is_deep=True):
    box = scenes.Body(*scenes.box())
    return scenes.pair("box-box", box, box, is_deep, Middle())


def test_the_solid_rests_at_rest_and_its_derivatives_are_those_of_its_energy():
    pair, random = boxes(), np.random.default_rng(1)
    body, x = solid.Solid(pair), pair.rest
    scale = solid.YOUNG
    assert body.mass.sum() == pytest.approx(2 * solid.DENSITY)
    assert np.abs(body.slope(x)).max() < 1e-12 * scale
    there, way, step = x + 0.02 * random.normal(size=x.shape), random.normal(size=x.shape), 1e-6
    difference = (body.energy(there + step * way) - body.energy(there - step * way)) / (2 * step)
    assert (body.slope(there) * way).sum() == pytest.approx(difference, rel=1e-6)
    # At rest nothing is cut off.
    bent = (body.slope(x + step * way) - body.slope(x - step * way)) / (2 * step)
    product = body.curvature(x) @ way.ravel()
    assert product == pytest.approx(bent.ravel(), abs=1e-6 * np.abs(bent).max())


class Still(solvers.Solver):
    def build(self, stiffness):
        pass

    def step(self):
        pass


def test_bodies_that_do_not_move_have_not_parted():
    for is_deep, outcome in ((False, "never met"), (True, "stuck")):
        assert program.run(Still, boxes(is_deep), None, 0.01)[0] == outcome


def test_depth_is_that_of_two_boxes():
    pair = boxes()
    assert not pair.is_apart(pair.parts(pair.rest))
    # Vertices of the face that lies a fifth deep, and farther than that from the faces beside.
    assert pair.depth(pair.rest) == pytest.approx(scenes.INTO, rel=1e-12)
    pair = boxes(is_deep=False)
    assert pair.is_apart(pair.parts(pair.rest)) and pair.depth(pair.rest) == 0


def test_scenes_start_as_they_are_named_and_a_seed_moves_them():
    drawn = [list(scenes.scenes(seed)) for seed in (1, 1, 2)]
    for scene, again, other in zip(*drawn):
        assert (scene.rest == again.rest).all() and (scene.rest != other.rest).any()
        assert (scene.depth(scene.rest) > 0) == (scene.start == "deep"), scene.name
        assert program.Solid(scene).volume.min() > 0
        assert scene.start != "loaded" or len(scene.fixed) > 0


@pytest.mark.parametrize("library", solvers.LIBRARIES, ids=lambda library: library.name)
def test_held_nodes_go_where_they_are_pushed(library):
    if not program.is_installed(library):
        pytest.skip(f"{library.name} is not installed; scripts/penetration.sh --deforming installs it")
    column = next(scene for scene in scenes.scenes(1) if scene.name == "column to 75 %")
    solver = library(column, next(iter(library.stiffnesses.values())), library.time_steps[0])
    for frame in range(1, 11):
        solver.advance()
        gone = solver.x - column.rest
        assert np.abs(gone[column.fixed]).max() < 1e-3
        # A frame is two or three of Bullet's steps, and MuJoCo's positions are those of a step before.
        early, late = (column.push * 0.01 * (frame + part) for part in (0.5, -0.5))
        assert early - 1e-3 < gone[column.pushed, 0].min() and gone[column.pushed, 0].max() < late + 1e-3
