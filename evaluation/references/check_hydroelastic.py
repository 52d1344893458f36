#!/usr/bin/env python3
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Checks what Drake computes for hydroelastic.csv in three ways: python3 check_hydroelastic.py"""
import numpy
from pydrake.math import RigidTransform

import volume_mesh
from hydroelastic import STIFFNESS, Pair, Pairs, placement, read_poses


def closed_forms():
    """Shapes flush on a slab of 4 x 4 x 1, depth 0.05 times their width w: where the section lies s from its side, the
    pressure is the lesser of s and half the depth."""
    slab = volume_mesh.prism([[(-2, -2), (2, -2), (2, 2), (-2, 2)]], None, 1.0, 1)
    for name in ("cube", "box", "peg"):
        (loop,), _, height = volume_mesh.PRISMS[name]
        w = loop[1][0] - loop[0][0]
        depth = 0.05 * w
        expected = STIFFNESS * (w**3 - (w - depth) ** 3) / 6
        pose = RigidTransform([0, 0, depth - height / 2 - 0.5])
        force, torque = Pair(volume_mesh.make(name), slab).force_and_torque(pose)
        print(f"{name} flush on a slab: force {force[2]:.12g}, closed form {expected:.12g}; "
              f"aside {numpy.abs(force[:2]).max():.1g}, torque {numpy.abs(torque).max():.1g}")


def surface(name):
    vertices, triangles = volume_mesh.SHAPES[name]
    return numpy.array(vertices)[numpy.array(triangles)]


def is_inside(points, triangles):
    """By the solid angle under which the surface is seen."""
    total = numpy.zeros(len(points))
    for triangle in triangles:
        a, b, c = (corner - points for corner in triangle)
        x, y, z = (numpy.linalg.norm(v, axis=1) for v in (a, b, c))
        below = x * y * z + (a * b).sum(1) * z + (b * c).sum(1) * x + (c * a).sum(1) * y
        total += numpy.arctan2((a * numpy.cross(b, c)).sum(1), below)
    return total > numpy.pi


def crossings(first, second):
    """Where the edges of the first surface meet the triangles of the second."""
    found = []
    for start, end in ((t[i], t[i - 1]) for t in first for i in range(3)):
        for a, b, c in second:
            matrix = numpy.array([end - start, a - b, a - c]).T
            if abs(numpy.linalg.det(matrix)) > 1e-12:
                t, u, v = numpy.linalg.solve(matrix, a - start)
                if 0 <= t <= 1 and u >= 0 and v >= 0 and u + v <= 1:
                    found.append(start + t * (end - start))
    return found


def overlap_box(first, second):
    points = crossings(first, second) + crossings(second, first)
    for one, other in ((first, second), (second, first)):
        corners = one.reshape(-1, 3)
        points += list(corners[is_inside(corners, other)])
    return numpy.min(points, axis=0), numpy.max(points, axis=0)


def random_points(rows, count=200_000):
    """Neither Drake nor a volume mesh: by the divergence theorem the force is STIFFNESS times the integral of the
    gradient of the first body's distance over those points of both bodies where it is the lesser, and the torque is
    the integral of its moment."""
    generator = numpy.random.default_rng(1)
    pairs = Pairs(16)
    for pair in dict.fromkeys(row["pair"] for row in rows):
        errors, percents = [], []
        for row in [row for row in rows if row["pair"] == pair][:2]:
            pose = placement(row)
            turn, move = pose.rotation().matrix(), pose.translation()
            first, second = map(surface, pair.split("-"))
            second = second @ turn.T + move
            low, high = overlap_box(first, second)
            points = generator.uniform(low, high, (count, 3))
            points = points[is_inside(points, first)]
            points = points[is_inside(points, second)]
            distance, nearest = volume_mesh.nearest_on_surface(points, first)
            lesser = distance < volume_mesh.nearest_on_surface(points, second)[0]
            gradient = ((points - nearest) / distance[:, None])[lesser]
            each = numpy.hstack([gradient, numpy.cross(points[lesser], gradient)])
            scale = STIFFNESS * numpy.prod(high - low) / count
            total, squares = each.sum(0), (each * each).sum(0)
            noise = scale * numpy.sqrt(squares - total * total / count)
            drake = numpy.concatenate(pairs[pair].force_and_torque(pose))
            off = numpy.abs(scale * total - drake)
            errors.append(numpy.max(off / numpy.maximum(noise, 1e-12)))
            percents.append(100 * numpy.linalg.norm(off[:3]) / numpy.linalg.norm(drake[:3]))
        print(f"{pair}, {count} random points, 2 poses: off by at most {max(errors):.2g} standard errors, "
              f"the force by {max(percents):.2g} %", flush=True)


def refinement(rows):
    coarse, fine = Pairs(16), Pairs(32)
    changes = {}
    for row in rows[::10]:
        if set(row["pair"].split("-")) & {"l", "channel", "hole"}:
            a, b = (pairs[row["pair"]].force_and_torque(placement(row)) for pairs in (coarse, fine))
            change = [numpy.linalg.norm(x - y) / numpy.linalg.norm(y) for x, y in zip(a, b)]
            changes.setdefault(row["pair"], []).append(change)
    for pair, values in changes.items():
        force, torque = 100 * numpy.max(values, axis=0)
        print(f"{pair}, 16 to 32 sectors: force changes by at most {force:.2g} %, torque {torque:.2g} %")


if __name__ == "__main__":
    closed_forms()
    random_points(read_poses())
    refinement(read_poses())
