#!/usr/bin/env python3
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Writes poses.csv, where the second body of each pair stands; the first stays as in its .obj: python3 poses.py

random: the second body is turned uniformly at random and comes from afar along a uniformly random line through both
    origins. From the first touch on (exact: the farthest of all vertex-triangle and edge-edge events along the line) it
    moves on by 5 to 25 % of the size, which is 1 for all these shapes.
pressed: the first body is wider than the gap in the second by a tenth of the gap; 1 to 9 % of the gap's width overlap
    at one wall, the rest of the tenth at the other. The second is tilted by up to 3 degrees about a random axis.
"""
import math
import pathlib
import random

import numpy

from shapes.make import SHAPES

SEED = 20261122
RANDOM = ["cube-cube", "box-box", "l-l", "cylinder-cylinder", "cube-box", "cylinder-box", "l-cube"]
RANDOM += ["cone-cone", "cone-cube"]
RANDOM_COUNT = 250
PRESSED_COUNT = 40


def rotation(q):
    w, x, y, z = q
    return numpy.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ])


def unit(generator, count):
    v = numpy.array([generator.gauss(0, 1) for _ in range(count)])
    return v / numpy.linalg.norm(v)


def edges(triangles):
    return numpy.array(sorted({tuple(sorted((t[i], t[i - 1]))) for t in triangles for i in range(3)}))


def vertices_to_triangles(points, corners, direction):
    """The farthest t at which point + t * direction lies in a triangle, over all pairs; minus infinity if none does."""
    origin, u, v = corners[:, 0], corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    normal = numpy.cross(u, v)
    slope = normal @ direction
    with numpy.errstate(divide="ignore", invalid="ignore"):
        t = numpy.einsum("ptk,tk->pt", origin[None] - points[:, None], normal) / slope
        at = points[:, None] + t[..., None] * direction - origin
        area = (normal * normal).sum(1)
        b = numpy.einsum("ptk,tk->pt", numpy.cross(at, v[None]), normal) / area
        c = numpy.einsum("ptk,tk->pt", numpy.cross(u[None], at), normal) / area
        inside = (b >= 0) & (c >= 0) & (b + c <= 1) & numpy.isfinite(t)
    return t[inside].max(initial=-math.inf)


def edges_to_edges(first, second, direction):
    """The farthest t at which second + t * direction meets first, over all pairs of edges."""
    p, u = first[:, 0], first[:, 1] - first[:, 0]
    q, v = second[:, 0], second[:, 1] - second[:, 0]
    normal = numpy.cross(u[:, None], v[None])
    gap = p[:, None] - q[None]
    determinant = normal @ direction
    with numpy.errstate(divide="ignore", invalid="ignore"):
        t = numpy.einsum("ijk,ijk->ij", gap, normal) / determinant
        r = t[..., None] * direction - gap
        along_u = numpy.einsum("ijk,ijk->ij", numpy.cross(r, v[None]), normal) / (normal * normal).sum(2)
        along_v = numpy.einsum("ijk,ijk->ij", numpy.cross(r, u[:, None]), normal) / (normal * normal).sum(2)
        inside = (along_u >= 0) & (along_u <= 1) & (along_v >= 0) & (along_v <= 1) & numpy.isfinite(t)
    return t[inside].max(initial=-math.inf)


def first_touch(first, second, turn, direction):
    """How far along the direction the second body stands when it first touches, coming from afar."""
    a, b = numpy.array(first[0]), numpy.array(second[0]) @ turn.T
    return max(
        vertices_to_triangles(b, a[numpy.array(first[1])], direction),
        vertices_to_triangles(a, b[numpy.array(second[1])], -direction),
        edges_to_edges(a[edges(first[1])], b[edges(second[1])], direction),
    )


def random_pose(generator, first, second):
    q = unit(generator, 4)
    direction = unit(generator, 3)
    along = first_touch(SHAPES[first], SHAPES[second], rotation(q), direction) - generator.uniform(0.05, 0.25)
    return q, along * direction


def tilt(generator):
    half = math.radians(generator.uniform(0, 3)) / 2
    return numpy.concatenate([[math.cos(half)], math.sin(half) * unit(generator, 3)])


def aside(generator, gap):
    """How far from the middle a body stands that is a tenth of the gap too wide for it."""
    return (generator.uniform(0.01, 0.09) - 0.05) * gap


def block_in_channel(generator):
    """The block ends 0.03 to 0.2 above the channel's floor, its middle within 0.2 of the channel's along it."""
    above_floor = generator.uniform(0.03, 0.2)
    turn, x = tilt(generator), aside(generator, 0.6)
    return turn, numpy.array([x, -0.25 + 0.2 - above_floor, generator.uniform(-0.2, 0.2)])


def peg_in_hole(generator):
    """From a peg whose end is 0.3 deep in the hole to one that looks out on both sides."""
    return tilt(generator), numpy.array([aside(generator, 0.5), aside(generator, 0.5), generator.uniform(-0.4, 0.4)])


def rows():
    generator = random.Random(SEED)
    for pair in RANDOM:
        for _ in range(RANDOM_COUNT):
            yield pair, "random", *random_pose(generator, *pair.split("-"))
    for pair, make in (("block-channel", block_in_channel), ("peg-hole", peg_in_hole)):
        for _ in range(PRESSED_COUNT):
            yield pair, "pressed", *make(generator)


if __name__ == "__main__":
    lines = [",".join(["id,pair,kind", *("quaternion_" + c for c in "wxyz"), *("translation_" + c for c in "xyz")])]
    for id, (pair, kind, q, t) in enumerate(rows()):
        numbers = [repr(float(x)) for x in q] + [repr(round(float(x), 9)) for x in t]
        lines.append(",".join([str(id), pair, kind] + numbers))
    pathlib.Path(__file__).with_name("poses.csv").write_text("\n".join(lines) + "\n")
