#!/usr/bin/env python3
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Times raycontact beside coal and the IPC Toolkit where two bodies touch, all called from Python in turns.

Usage: measure_anchors.py [--rounds N] [--sizes AROUNDxACROSS,...] [CSV]

Two tori side by side that ripple from step to step, so that each library follows them to new positions in every step:
`apart` by a 2000th of their length, and `touching`, as deep in one another. In each step every library is asked in turn,
twice, of which the second time counts: the processor's time, one thread, double precision, medians of the steps. What
each answers has a row:
  yes/no     whether the surfaces cross
  contacts   the contacts and the forces they give: coal's contacts alone; of the IPC Toolkit the collisions within a
             1000th of the scene's diagonal and the gradient of their barrier, and with `+ Hessian` its second derivative
  CCD        how far the bodies may go before they touch (tight inclusion, additive): the IPC Toolkit's alone
coal builds its trees anew in each step, since from Python it takes new vertices one call each, which is slower;
`coal, rigid` is what it is made for, bodies that stay as they were in the first step.

Exit status: 0 when measured, 1 when something fails, 2 for a wrong command line.
scripts/anchors.sh installs what this needs and calls it."""

import argparse
import csv
import statistics
import sys
import time

RING, TUBE = 1.0, 0.4
LENGTH = 2 * (RING + TUBE)
GAPS = {"apart": LENGTH / 2000, "touching": -LENGTH / 2000}


def torus(np, around, across, shift):
    """Points and triangles; the first meridian is where the other torus is."""
    u = 2 * np.pi * np.arange(around)[:, None] / around
    v = 2 * np.pi * np.arange(across)[None, :] / across
    radius = RING + TUBE * np.cos(v)
    points = np.stack([radius * np.cos(u), radius * np.sin(u), TUBE * np.sin(v) + 0 * u], axis=-1).reshape(-1, 3)
    i, j = [grid.ravel() for grid in np.meshgrid(np.arange(around), np.arange(across), indexing="ij")]
    at = lambda i, j: i % around * across + j % across
    corners = at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)
    a, b, c, d = corners
    triangles = np.stack([np.stack([a, b, c], 1), np.stack([a, c, d], 1)], 1).reshape(-1, 3)
    return points + [shift, 0, 0], triangles


def rippled(np, points, step):
    """The standard motion at a hundredth of its height, so that the gap stays a gap; the same for both bodies."""
    height = 0.0002 * np.sin(3 * points[:, 1] + 2 * points[:, 2] + 0.3 * step)
    return points + height[:, None] * [0, 0, 1]


class Ipc:
    name = "IPC Toolkit"

    def __init__(self, np, bodies):
        import ipctk

        self.ipctk, self.np = ipctk, np
        ipctk.set_num_threads(1)
        ipctk.set_logger_level(ipctk.LoggerLevel.off)
        counts = [len(points) for points, _ in bodies]
        faces = np.concatenate([bodies[0][1], bodies[1][1] + counts[0]]).astype(np.int32)
        rest = np.concatenate([points for points, _ in bodies])
        self.mesh = ipctk.CollisionMesh(np.asfortranarray(rest), ipctk.edges(faces), np.asfortranarray(faces))
        self.mesh.can_collide = ipctk.make_vertex_patches_filter(np.repeat([0, 1], counts).astype(np.int32))
        self.distance = 1e-3 * np.linalg.norm(np.ptp(rest, axis=0))
        self.barrier = ipctk.BarrierPotential(self.distance, 1.0)
        self.found = ipctk.NormalCollisions()

    def start(self, positions):
        """What is not timed: all vertices in one array, column by column."""
        self.before = getattr(self, "now", None)
        self.now = self.np.asfortranarray(self.np.concatenate(positions))

    def questions(self, is_apart):
        yield "yes/no", lambda: self.ipctk.has_intersections(self.mesh, self.now)
        if is_apart:
            # It is made for bodies that do not cross.
            yield "contacts", self.gradient
            yield "contacts + Hessian", self.hessian
            yield "CCD", lambda: self.step(self.ipctk.TightInclusionCCD())
            yield "CCD (additive)", lambda: self.step(self.ipctk.AdditiveCCD())

    def gradient(self):
        self.found.build(self.mesh, self.now, self.distance)
        self.barrier.gradient(self.found, self.mesh, self.now)
        return len(self.found)

    def hessian(self):
        count = self.gradient()
        self.barrier.hessian(self.found, self.mesh, self.now)
        return count

    def step(self, search):
        before = self.now if self.before is None else self.before
        return self.ipctk.compute_collision_free_stepsize(self.mesh, before, self.now, narrow_phase_ccd=search)


class Coal:
    name = "coal"

    def __init__(self, np, bodies):
        import coal

        self.coal, self.np = coal, np
        self.models = []
        for points, triangles in bodies:
            model = coal.BVHModelOBBRSS()
            model.beginModel(len(triangles), len(points))
            model.addVertices(np.asfortranarray(points))
            model.addTriangles(np.asfortranarray(triangles.astype(np.uint64)))
            model.endModel()
            self.models.append((model, triangles))
        self.at_rest = coal.Transform3s()

    def start(self, positions):
        self.positions = positions

    def questions(self, is_apart):
        yield "yes/no", lambda: self.collide(1, False)
        yield "contacts", lambda: self.collide(100_000, True)
        del is_apart

    def collide(self, most, with_contacts):
        """New positions go in by building anew: from Python, coal takes new vertices one call each, which is slower."""
        models = []
        for (_, triangles), points in zip(self.models, self.positions):
            model = self.coal.BVHModelOBBRSS()
            model.beginModel(len(triangles), len(points))
            model.addVertices(self.np.asfortranarray(points))
            model.addTriangles(self.np.asfortranarray(triangles.astype(self.np.uint64)))
            model.endModel()
            models.append(model)
        self.models = [(model, triangles) for model, (_, triangles) in zip(models, self.models)]
        return self.ask(most, with_contacts)

    def ask(self, most, with_contacts):
        request, result = self.coal.CollisionRequest(), self.coal.CollisionResult()
        request.num_max_contacts, request.enable_contact = most, with_contacts
        first, second = [model for model, _ in self.models]
        self.coal.collide(first, self.at_rest, second, self.at_rest, request, result)
        return result.numContacts()


class RigidCoal(Coal):
    """As coal is meant: bodies that do not deform, trees built once. The positions of step 0."""

    name = "coal, rigid"

    def collide(self, most, with_contacts):
        return self.ask(most, with_contacts)


class Raycontact:
    name = "raycontact"
    options: dict = {}

    def __init__(self, np, bodies):
        import raycontact

        self.np = np
        self.scene, self.found = raycontact.Scene(threads=1), raycontact.Contacts()
        self.scene.set_detection_options(**self.options)
        self.bodies = [self.scene.add(raycontact.Mesh(points, triangles)) for points, triangles in bodies]
        self.forces = [np.zeros_like(points) for points, _ in bodies]

    def start(self, positions):
        self.positions = positions

    def questions(self, is_apart):
        yield "yes/no", self.detect
        yield "contacts", self.respond
        del is_apart

    def detect(self):
        for body, positions in zip(self.bodies, self.positions):
            self.scene.set_positions(body, positions)
        self.scene.query(self.found)
        return len(self.found)

    def respond(self):
        count = self.detect()
        self.found.add_forces(self.forces)
        return count


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter, usage="%(prog)s [options] [CSV]")
    parser.add_argument("--rounds", type=int, default=15)
    parser.add_argument("--sizes", default="40x20,75x39,160x80")
    parser.add_argument("csv", metavar="CSV", nargs="?", default="out/anchors/anchors.csv")
    arguments = parser.parse_args()
    try:
        sizes = [tuple(int(number) for number in size.split("x")) for size in arguments.sizes.split(",")]
        assert all(len(size) == 2 and min(size) > 2 for size in sizes) and arguments.rounds > 0
    except (ValueError, AssertionError):
        parser.error("--sizes are numbers like 40x20, above 2, and --rounds is above 0")

    import numpy as np

    with open(arguments.csv, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(["scene", "triangles", "library", "question", "ms", "times_raycontact", "answer"])
        for around, across in sizes:
            for scene, gap in GAPS.items():
                writer.writerows(measure(np, scene, gap, around, across, arguments.rounds))
                file.flush()


def measure(np, scene, gap, around, across, rounds):
    # The first is turned by half a turn about z, so that both have a vertex where they are nearest.
    (points, triangles), (other, _) = torus(np, around, across, 0.0), torus(np, around, across, 0.0)
    bodies = [(points, triangles), (other * [-1, -1, 1] + [LENGTH + gap, 0, 0], triangles)]
    libraries = [kind(np, bodies) for kind in (Raycontact, Ipc, Coal, RigidCoal)]
    times, answers = {}, {}
    for step in range(rounds + 2):
        positions = [np.ascontiguousarray(rippled(np, points, step)) for points, _ in bodies]
        for library in libraries:
            library.start(positions)
            for question, ask in library.questions(scene == "apart"):
                # What other libraries did before has pushed its memory out of the caches.
                ask()
                begin = time.process_time()
                answer = ask()
                # The first two steps warm up, and have no step before them.
                if step > 1:
                    times.setdefault((library.name, question), []).append((time.process_time() - begin) * 1e3)
                answers[library.name, question] = answer
    for (name, question), found in times.items():
        own = times["raycontact", "yes/no" if question == "yes/no" else "contacts"]
        ratio = statistics.median(a / b for a, b in zip(found, own))
        answer = answers[name, question]
        row = [scene, 2 * len(triangles), name, question, f"{statistics.median(found):.4g}", f"{ratio:.3g}", f"{answer:.4g}"]
        print("{:9} {:>7} {:12} {:19} {:>9} ms {:>7} x raycontact, answer {}".format(*row), flush=True)
        yield row


if __name__ == "__main__":
    sys.exit(main())
