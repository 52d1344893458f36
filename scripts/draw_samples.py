#!/usr/bin/env python3
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Draws where rays start, by default and from the vertices as the paper has it: docs/images/samples.png.

Needs the package (pip install .), numpy and matplotlib.
"""

import argparse
from typing import Any

import matplotlib
import numpy as np
import raycontact
from PIL import Image

matplotlib.use("agg")
import matplotlib.pyplot as plot  # after the choice of output

TURN = 2 * np.pi


def torus(around: int, across: int) -> tuple[Any, Any]:
    """Around z, with radii 1 and 0.4."""
    u, v = np.meshgrid(TURN * np.arange(around) / around, TURN * np.arange(across) / across, indexing="ij")
    radius = 1 + 0.4 * np.cos(v)
    points = np.stack([radius * np.cos(u), radius * np.sin(u), 0.4 * np.sin(v)], axis=-1).reshape(-1, 3)
    i, j = np.meshgrid(np.arange(around), np.arange(across), indexing="ij")

    def number(i: Any, j: Any) -> Any:
        return (i % around) * across + j % across

    a, b, c, d = number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)
    return points, np.stack([a, b, c, a, c, d], axis=-1).reshape(-1, 3)


def thread(sides: int, turns: int, radius: float, pitch: float = 0.3) -> tuple[Any, Any]:
    """A rod with a thread, cut off along it: its ends are fans of triangles."""
    profile = 8
    along = turns * profile + 1
    place, side = np.meshgrid(np.arange(along), np.arange(sides))
    rise = 1 - np.abs(2 * (place / profile % 1) - 1)
    turn = side / sides
    r, z = radius + 0.15 * (rise - 0.5), pitch * (place / profile + turn - turns / 2 - 0.5)
    points = np.stack([r * np.cos(TURN * turn), r * np.sin(TURN * turn), z], axis=-1).reshape(-1, 3)
    points = np.concatenate([points, points[-along:] * 0, [[0, 0, z.min()], [0, 0, z.max()]]])
    last = np.arange(along)
    # Once around, a point is one turn further on; those of the last turn have none there.
    own = sides * along + last
    points[own] = np.stack([r[0], 0 * r[0], z[0] + pitch], axis=-1)
    seam = np.where(last + profile < along, last + profile, own)
    number = np.concatenate([np.arange(sides * along).reshape(sides, along), seam[None]])
    a, b, c, d = number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]
    triangles = np.stack([a, b, c, a, c, d], axis=-1).reshape(-1, 3)
    edges = triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
    known = {tuple(edge) for edge in edges}
    border = [(b, a) for a, b in edges if (b, a) not in known]
    top = {number for number in map(int, np.flatnonzero(points[:, 2] > 0))}
    ends = len(points) - 2
    fans = [(a, b, ends + (int(a) in top)) for a, b in border]
    triangles = np.concatenate([triangles, fans])
    used, inverse = np.unique(triangles, return_inverse=True)
    return points[used], inverse.reshape(-1, 3)


def hollow(sides: int, turns: int) -> tuple[Any, Any]:
    """A nut: a thread turned inside out, without its ends, in a smooth ring."""
    points, triangles = thread(sides, turns, 1.002)
    middle = [number for number in range(len(points)) if np.hypot(*points[number, :2]) < 0.5]
    inner = triangles[~np.isin(triangles, middle).any(axis=1)]
    outer = points.copy()
    outer[:, :2] *= 1.5 / np.maximum(np.hypot(outer[:, 0], outer[:, 1]), 1e-9)[:, None]
    count = len(points)
    known = {tuple(edge) for edge in inner[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)}
    border = [(b, a) for a, b in known if (b, a) not in known]
    rings = [corners for a, b in sorted(border) for corners in ((b, a, a + count), (b, a + count, b + count))]
    triangles = np.concatenate([inner[:, ::-1], inner + count, rings])
    used, inverse = np.unique(triangles, return_inverse=True)
    return np.concatenate([points, outer])[used], inverse.reshape(-1, 3)


def scenes() -> list[tuple[str, list[tuple[Any, Any]], tuple[float, float]]]:
    """By name the bodies, and from where they are looked at."""
    ring = torus(80, 40)
    tilt = np.array([[1, 0, 0], [0, np.cos(1.1), -np.sin(1.1)], [0, np.sin(1.1), np.cos(1.1)]])
    moved = (ring[0] @ tilt.T + [0.3, 0.4, 0.25], ring[1])
    nut = hollow(48, 3)
    small = torus(40, 20)
    pile = [(small[0] + [0.13 * np.sin(k), 0.13 * np.cos(1.7 * k), 0.6 * k], small[1]) for k in range(4)]
    return [
        ("a nut on a bolt", [thread(64, 8, 1.0), (nut[0] + [0, 0, 0.02], nut[1])], (15, 40)),
        ("tori, deep in one another", [ring, moved], (35, -60)),
        ("a pile", pile, (20, -60)),
    ]


def draw(path: str) -> None:
    """One row for each way to choose where rays start, one column for each scene."""
    found = scenes()
    figure = plot.figure(figsize=(4 * len(found), 7.5))
    ways = [("the default, 0.01", {}), ("the paper: vertices", {"sampling": raycontact.Sampling.VERTICES})]
    for row, (way, options) in enumerate(ways):
        for column, (name, bodies, view) in enumerate(found):
            scene = raycontact.Scene()
            scene.set_detection_options(**options)
            for points, triangles in bodies:
                scene.add(raycontact.Mesh(points, triangles))
            contacts = scene.query().to_array()
            axes = figure.add_subplot(len(ways), len(found), row * len(found) + column + 1, projection="3d")
            for points, triangles in bodies:
                axes.plot_trisurf(*points.T, triangles=triangles, color=(0.6, 0.7, 0.8, 0.08), linewidth=0)
            for body in range(len(bodies)):
                start = contacts["p1"]["position"][contacts["colliding"] == body]
                axes.scatter(*start.T, s=2, depthshade=False)
            axes.view_init(*view)
            axes.set_box_aspect(np.ptp(np.concatenate([points for points, _ in bodies]), axis=0), zoom=1.5)
            axes.set_axis_off()
            axes.set_title(f"{name}\n{way}: {len(contacts)} contacts", fontsize=9)
    figure.tight_layout()
    figure.savefig(path, dpi=72)
    # Few colours keep it small.
    Image.open(path).convert("RGB").quantize(48).save(path, optimize=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("picture", nargs="?", default="docs/images/samples.png")
    draw(parser.parse_args().picture)
