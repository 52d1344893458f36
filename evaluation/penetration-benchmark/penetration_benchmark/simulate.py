# SPDX-License-Identifier: MIT OR Apache-2.0
"""The task simulate: scenes with momentum, by time step. A library gives contacts only; rigid.py moves the bodies, and
the judge tells how it ended."""

import itertools

import numpy as np

from . import exact
from .library import found
from .rigid import RigidBody, step, stiffness
from .tasks import Table, group, note, number, quantile, refuse

SIMULATE = ["library", "scene", "shapes", "time_step", "scenes", "refused", "done", "sunk", "restless", "stuck", "exploded",
            "gained_median", "gained_worst", "depth_median", "asked", "ended_well", "note"]
OUTCOMES = ("done", "sunk", "restless", "stuck", "exploded")
# Parts of a second.
TIME_STEPS = (240, 120, 60, 30, 15)
GRAVITY = np.array([0, 0, -9.81])
# Speeds at the start: that after a fall by half a size, and a shot.
SPEEDS = {"drop": (2 * 9.81 * 0.5) ** 0.5, "impact": 10.0, "part": 0.0}
SECONDS = {"drop": 3.0, "impact": 1.0, "part": 2.0}
# Where the judge is asked whether the bodies are apart: after each so many parts of a second.
JUDGED = 15
# A body rests when no point has been faster than this, in sizes a second, for so long.
REST_SPEED, REST_SECONDS = 0.1, 0.25
# A body that ends deeper than this, in its size, has sunk.
DEEPEST = 0.05
# Of what was put in: whoever gains more has exploded.
MOST_GAINED = 1.0


class Scene:
    """drop and impact: the second body falls or is shot on the first, which is fixed. part: both are free and at rest."""

    def __init__(self, surfaces, pose):
        self.kind, (first, second) = pose.kind, pose.placements()
        is_fixed = pose.kind != "part"
        self.bodies = [RigidBody(surfaces[0], first, is_fixed=is_fixed),
                       RigidBody(surfaces[1], second, (0, 0, -SPEEDS[pose.kind]))]
        self.gravity = GRAVITY if pose.kind == "drop" else np.zeros(3)
        self.apart = exact.Apart([surface.triangles for surface in surfaces])
        self.start = self.energy()

    def positions(self):
        return [body.positions() for body in self.bodies]

    def energy(self):
        return sum(body.energy(self.gravity) for body in self.bodies)

    def depth(self, direction, way):
        """How far the second body must go that way to be apart, 0 to `way`, to a thousandth."""
        (first, second), near, far = self.positions(), 0.0, way
        if self.apart((first, second)):
            return 0.0
        for _ in range(10):
            middle = (near + far) / 2
            near, far = (near, middle) if self.apart((first, second + middle * direction)) else (middle, far)
        return far

    def way_out(self):
        """The shortest of those along 26 directions."""
        shortest = sum(body.size for body in self.bodies) * 2
        for way in itertools.product((-1, 0, 1), repeat=3):
            if any(way):
                direction = np.array(way) / np.linalg.norm(way)
                first, second = self.positions()
                if self.apart((first, second + shortest * direction)):
                    shortest = self.depth(direction, shortest)
        return shortest

    def put_in(self):
        """The energy of the fall or the shot; of bodies that overlap, that of a spring pressed by the shortest way out."""
        if self.kind == "part":
            return 0.5 * stiffness(self.bodies) * self.way_out() ** 2
        return 0.5 * self.bodies[1].mass * SPEEDS[self.kind] ** 2

    def is_below(self):
        return self.bodies[1].centre[2] < self.bodies[0].centre[2]

    def is_over(self):
        """Whether bodies that were to part have done so; one that was shot must be on its way back, or through."""
        is_away = self.kind == "part" or self.bodies[1].velocity[2] > 0 or self.is_below()
        return is_away and self.apart(self.positions())

    def lift(self):
        """How deep the second body lies, in its size: how far up it must go to be free of the first."""
        first, second = self.positions()
        return self.depth(np.array([0, 0, 1.0]), max(first[:, 2].max() - second[:, 2].min(), 0.0)) / self.bodies[1].size

    def outcome(self, is_at_rest):
        """At the end: (outcome, depth at rest or None)."""
        if self.kind == "part":
            return "done" if self.apart(self.positions()) else "stuck", None
        depth = self.lift()
        if self.is_below() or depth > DEEPEST:
            return "sunk", None
        if self.kind == "impact":
            return "done", None
        return ("done", depth) if is_at_rest else ("restless", None)


def run(library, surfaces, pose, put_in, parts):
    """(outcome, the greatest energy gained in what was put in, depth at rest or None)."""
    library.load(*surfaces)
    scene, calm, gained = Scene(surfaces, pose), 0, 0.0
    for steps in range(1, round(SECONDS[pose.kind] * parts) + 1):
        library.move(np.stack([body.placement() for body in scene.bodies]), tuple(scene.positions()))
        step(scene.bodies, found(library.contacts()), 1 / parts, scene.gravity)
        gained = max(gained, (scene.energy() - scene.start) / put_in)
        if not gained <= MOST_GAINED:
            return "exploded", gained, None
        calm = calm + 1 if scene.bodies[1].speed() < REST_SPEED * scene.bodies[1].size else 0
        if pose.kind == "drop" and calm >= REST_SECONDS * parts:
            break
        if pose.kind != "drop" and steps % (parts // JUDGED) == 0 and scene.is_over():
            break
    ended, depth = scene.outcome(calm >= REST_SECONDS * parts)
    return ended, gained, depth


def simulate(libraries, surfaces, poses, progress):
    """Each scene at each time step, from its start. Poses are listed by number, so that intervals can be had by scene."""
    table = Table()
    for done, pose in enumerate(poses):
        pair = [surfaces[name] for name in pose.pair]
        put_in = Scene(pair, pose).put_in()
        for library, parts in itertools.product(libraries, TIME_STEPS):
            cell = table.cell(library.name, pose.kind, group(pair), f"1/{parts}")
            cell["poses"] += 1
            try:
                ended, gained, depth = run(library, pair, pose, put_in, parts)
            except (ValueError, NotImplementedError) as error:
                refuse(cell, error)
                continue
            cell[ended] = cell.get(ended, 0) + 1
            cell.setdefault("asked", []).append(pose.id)
            cell.setdefault("ended_well", []).extend([pose.id] if ended == "done" else [])
            cell.setdefault("gained", []).append(float(gained))
            cell.setdefault("depths", []).extend([] if depth is None else [float(depth)])
        progress(done + 1, len(poses))
    for key, cell in table.cells.items():
        gained, depths = cell.get("gained"), cell.get("depths")
        numbers = [" ".join(map(str, cell.get(of, []))) for of in ("asked", "ended_well")]
        yield [*key, cell["poses"], cell["refused"], *(cell.get(ended, 0) for ended in OUTCOMES),
               *map(number, (quantile(gained, 0.5), quantile(gained, 1.0), quantile(depths, 0.5))), *numbers, note(cell)]
