# SPDX-License-Identifier: MIT OR Apache-2.0
"""Each library in its own solver: what is read is where the bodies are, and a scene of either start runs to its end."""

import numpy as np
import pytest
from penetration_benchmark import files, shapes, simulate, solvers
from penetration_benchmark.library import Surface

TURN = files.rotation_of(0.9, 0.3, -0.2, 0.4)


def surface(name):
    positions, triangles = shapes.make(name)
    return Surface(name, positions, triangles, name in shapes.CONVEX)


def scene(library, kind, turn, height):
    """An L for what takes concave bodies alone, else a box: above a slab, or deep in a box."""
    names = "slab" if kind == "drop" else "box", "l" if library.only_concave else "box"
    pair = tuple(map(surface, names))
    lowest = (pair[1].positions @ turn.T)[:, 2].min()
    return pair, files.Pose(0, names, kind, turn, np.array([0.1, 0.2, pair[0].positions[:, 2].max() - lowest + height]))


@pytest.fixture(params=solvers.LIBRARIES, ids=lambda library: library.name)
def library(request):
    if not solvers.is_installed(request.param):
        pytest.skip(f"{request.param.name} is not installed; scripts/penetration.sh --solvers installs it")
    return request.param


def test_a_body_in_flight_is_read_where_it_is(library):
    pair, pose = scene(library, "drop", TURN, 1.0)
    here = simulate.Scene(pair, pose)
    start, steps = here.bodies[1].centre, 24
    solver = library(here, pair, next(iter(library.stiffnesses.values())), 1 / 240)
    solver.read()
    assert here.positions()[1] == pytest.approx(files.placed(pair[1], pose.placements()[1]), abs=1e-6)
    solver.advance(steps)
    solver.read()
    # Between explicit and implicit Euler, by single precision.
    fall, dt = start[2] - here.bodies[1].centre[2], 1 / 240
    exact = simulate.SPEEDS["drop"] * steps * dt + 9.81 * (steps * dt) ** 2 / 2
    assert fall == pytest.approx(exact, abs=9.81 * steps * dt**2)
    assert here.bodies[1].centre[:2] == pytest.approx(start[:2], abs=1e-5)
    assert here.bodies[1].rotation == pytest.approx(TURN, abs=1e-5)
    speed = simulate.SPEEDS["drop"] + 9.81 * steps * dt
    assert here.bodies[1].velocity == pytest.approx([0, 0, -speed, 0, 0, 0], abs=1e-3 * speed)


def test_a_body_that_is_dropped_comes_to_rest(library):
    pair, pose = scene(library, "drop", np.eye(3), 0.01)
    own = next(iter(library.stiffnesses))
    ended, depth, cost = solvers.run(library, pair, pose, own, 1 / 240, simulate.Scene(pair, pose).put_in())
    assert ended == "done" and depth < 0.02 and cost > 0


def test_a_deep_start_runs_to_its_end(library):
    pair, pose = scene(library, "part", TURN, -0.2)
    rows = list(solvers.measure("test", [(pose, pair)], {library: ([list(library.stiffnesses)[:1]] * 2, [1 / 60])},
                                lambda done, of: None))
    (row,) = (dict(zip(solvers.HEAD, each)) for each in rows)
    if not library.may_overlap:
        assert row["outcome"] == "does not apply" and row["depth"] == row["cost"] == ""
    else:
        assert row["outcome"] in ("done", "stuck", "thrown") and (row["depth"] != "0") == (row["outcome"] == "stuck")


def test_the_stiffness_taken_is_the_first_of_the_best():
    a, b, _ = solvers.Mujoco.stiffnesses
    row = ["tuned", 0, "drop", "convex", "slab-box", "MuJoCo", "4", a, "1/60", "stuck", "", ""]
    won = [*row[:7], b, "1/60", "done", "", ""]
    deep = [*won[:2], "part", *won[3:]]
    assert solvers.best_stiffness(solvers.Mujoco, False, [row, row, row]) == a
    assert solvers.best_stiffness(solvers.Mujoco, False, [row, row, won]) == b
    assert solvers.best_stiffness(solvers.Mujoco, False, [row, deep]) == a
    assert solvers.best_stiffness(solvers.Mujoco, True, [row, deep]) == b
