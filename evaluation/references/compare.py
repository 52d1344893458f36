#!/usr/bin/env python3
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Prints the angles in degrees between the forces of hydroelastic contact and of an even pressure, for random pairs.

Not for the pressed pairs: an even pressure on two opposed walls is balanced wherever the body stands between them.
"""
import csv
import math
import pathlib

HERE = pathlib.Path(__file__).parent


def read(name):
    with open(HERE / name) as file:
        return list(csv.DictReader(file))


def angle(a, b):
    cross = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    return math.degrees(math.atan2(math.hypot(*cross), sum(x * y for x, y in zip(a, b))))


angles = {}
for pose, *results in zip(read("poses.csv"), read("hydroelastic.csv"), read("overlap_volume.csv"), strict=True):
    assert all(row["id"] == pose["id"] for row in results)
    if pose["kind"] == "random":
        forces = [[float(row["force_" + axis]) for axis in "xyz"] for row in results]
        angles.setdefault(pose["pair"], []).append(angle(*forces))

print("| pair | rows | median | 90 % below | worst |\n| --- | --- | --- | --- | --- |")
for pair, values in angles.items():
    values.sort()
    median, most = (values[int(share * len(values))] for share in (0.5, 0.9))
    print(f"| {pair} | {len(values)} | {median:.1f} | {most:.1f} | {values[-1]:.1f} |")
