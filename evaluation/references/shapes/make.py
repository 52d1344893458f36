#!/usr/bin/env python3
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Writes the closed, outward-oriented triangle meshes of this folder: python3 shapes/make.py

Every shape but the cone is a prism along z: its profile is one or more loops of points (the outer one
counter-clockwise, holes clockwise) and the triangles that fill it.
"""
import math
import pathlib


def rectangle(width, depth):
    x, y = width / 2, depth / 2
    return [(-x, -y), (x, -y), (x, y), (-x, y)]


def circle(sides, radius):
    angles = [2 * math.pi * i / sides for i in range(sides)]
    return [(radius * math.cos(a), radius * math.sin(a)) for a in angles]


def fan(count):
    return [(0, i, i + 1) for i in range(1, count - 1)]


L = [(-0.5, -0.5), (0.5, -0.5), (0.5, 0.0), (0.0, 0.0), (0.0, 0.5), (-0.5, 0.5)]
L_TRIANGLES = [(0, 1, 3), (1, 2, 3), (0, 3, 5), (3, 4, 5)]
CHANNEL = [(-0.5, -0.4), (0.5, -0.4), (0.5, 0.4), (0.3, 0.4), (0.3, -0.2), (-0.3, -0.2), (-0.3, 0.4), (-0.5, 0.4)]
CHANNEL_TRIANGLES = [(1, 2, 3), (1, 3, 4), (0, 1, 4), (0, 4, 5), (0, 5, 6), (0, 6, 7)]
FRAME_TRIANGLES = [t for i in range(4) for t in ((i, (i + 1) % 4, 7 - (i + 1) % 4), (i, 7 - (i + 1) % 4, 7 - i))]

# name: (loops, triangles over the points of all loops, height)
PRISMS = {
    "cube": ([rectangle(1, 1)], fan(4), 1.0),
    "box": ([rectangle(1, 1)], fan(4), 0.3),
    "l": ([L], L_TRIANGLES, 0.4),
    "cylinder": ([circle(32, 0.5)], fan(32), 1.0),
    "channel": ([CHANNEL], CHANNEL_TRIANGLES, 1.0),
    "block": ([rectangle(0.66, 0.5)], fan(4), 0.6),
    "peg": ([rectangle(0.55, 0.55)], fan(4), 0.9),
    "hole": ([rectangle(1.5, 1.5), rectangle(0.5, 0.5)[::-1]], FRAME_TRIANGLES, 0.5),
}


def prism(loops, cap, height):
    profile = [p for loop in loops for p in loop]
    count = len(profile)
    vertices = [(x, y, z) for z in (-height / 2, height / 2) for x, y in profile]
    triangles = [(c, b, a) for a, b, c in cap] + [(a + count, b + count, c + count) for a, b, c in cap]
    first = 0
    for loop in loops:
        for i in range(len(loop)):
            a, b = first + i, first + (i + 1) % len(loop)
            triangles += [(a, b, b + count), (a, b + count, a + count)]
        first += len(loop)
    return vertices, triangles


def cone(sides, radius, height):
    vertices = [(x, y, -height / 2) for x, y in circle(sides, radius)] + [(0.0, 0.0, height / 2)]
    triangles = [(c, b, a) for a, b, c in fan(sides)] + [(i, (i + 1) % sides, sides) for i in range(sides)]
    return vertices, triangles


SHAPES = {name: prism(*profile) for name, profile in PRISMS.items()} | {"cone": cone(32, 0.5, 1.0)}


def volume(vertices, triangles):
    total = 0.0
    for triangle in triangles:
        (a, b, c), (d, e, f), (g, h, i) = (vertices[v] for v in triangle)
        total += a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)
    return total / 6


def is_closed(triangles):
    """Each directed edge is there once, and so is its reverse."""
    edges = [(t[i], t[(i + 1) % 3]) for t in triangles for i in range(3)]
    return len(edges) == len(set(edges)) and set(edges) == {(b, a) for a, b in edges}


if __name__ == "__main__":
    for name, (vertices, triangles) in SHAPES.items():
        assert is_closed(triangles), name
        lines = ["v " + " ".join(map(repr, map(float, v))) for v in vertices]
        lines += ["f " + " ".join(str(i + 1) for i in t) for t in triangles]
        path = pathlib.Path(__file__).with_name(name + ".obj")
        path.write_text("\n".join(lines) + "\n")
        print(f"{name}: {len(vertices)} vertices, {len(triangles)} triangles, volume {volume(vertices, triangles):.9g}")
