#!/usr/bin/env python3
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Draws choices.svg, a dozen labelled settings and methods on one scene, from chart.csv in one folder.

Usage: draw_choices.py [docs/chart]

scripts/chart.sh calls it. Needs matplotlib.
"""

import os

import document_tables
from drawing import draw_in_folder, plot, save

SCENE = "deep-tori"
OWN = "law={} sampling={} precision={} layout=wide edges={} weights={}"
# Method and settings, the label, and where that stands beside its point in the left and the right panel, in points.
POINTS = [
    ("raycontact", OWN.format("pressure", "accuracy:0.01", "f64", "on", "area"), "default", (8, -3), (8, -3)),
    ("raycontact", OWN.format("pressure", "accuracy:0.01", "f32", "on", "area"), "single precision", (-8, -3), (-8, -3)),
    ("raycontact", OWN.format("pressure", "vertices", "f64", "on", "area"), "vertices", (8, -3), (8, -3)),
    ("raycontact", OWN.format("pressure", "spacing:0.16", "f64", "on", "area"), "spacing of four edges", (-8, -8), (-8, -8)),
    ("raycontact", OWN.format("pressure", "spacing:0.32", "f64", "on", "area"), "spacing of eight edges", (8, 2), (-8, -3)),
    ("raycontact", OWN.format("pressure", "accuracy:0.1", "f64", "on", "area"), "accuracy 0.1", (8, -1), (8, -1)),
    ("raycontact", OWN.format("pressure", "accuracy:0.03", "f64", "on", "area"), "accuracy 0.03", (8, -3), (8, -3)),
    ("raycontact", OWN.format("ray-length", "accuracy:0.01", "f64", "on", "area"), "ray lengths", (-8, -3), (8, -9)),
    ("paper", OWN.format("ray-length", "vertices", "f32", "off", "paper"), "the paper's mode, single", (-8, 1), (-8, -1)),
    ("embree-refit", "precision=f32 weights=paper", "Embree, Algorithm 1", (8, 3), (4, 5)),
    ("embree-refit", "precision=f32 weights=area", "Embree, area weights", (8, -3), None),
    ("bullet-vf", "precision=f32 weights=paper", "Bullet, vertices near faces", (-8, -3), (-8, -3)),
    ("bullet-cl", "precision=f32 weights=paper", "Bullet, clusters", None, (8, -1)),
    ("fcl-aabb", "precision=f32 weights=paper", "FCL, crossing triangles", None, (-8, -3)),
    ("proximity", "precision=f64 weights=paper", "closest features", (-8, -3), (0, -14)),
]
# The column, what its numbers are multiplied with, the label of the axis, and its ends.
PANELS = [
    ("force_error", 100, "force and torque off the limit of the own law, %", (0.005, 300)),
    ("direction_error", 1, "force off the direction of the pressure law's limit, degrees", (0.0005, 400)),
]


def draw(folder):
    found = document_tables.rows(os.path.join(folder, "chart.csv"))
    rows = {(row["method"], row["settings"]): row for row in found if row["scene"] == SCENE}
    figure, panels = plot.subplots(1, 2, figsize=(11, 4.6), layout="constrained")
    for number, (axes, (column, factor, name, ends)) in enumerate(zip(panels, PANELS)):
        for method, settings, label, *offsets in POINTS:
            row, offset = rows[method, settings], offsets[number]
            if offset is None:
                continue
            time, error = float(row["time_over_lower_bound"]), factor * float(row[column])
            is_own = method in ("raycontact", "paper")
            axes.plot(time, error, "o" if is_own else "s", color="#1b6ab3" if is_own else "#888888", markersize=6)
            side = {-1: "right", 0: "center", 1: "left"}[(offset[0] > 0) - (offset[0] < 0)]
            weight = "bold" if label.startswith("default") else "normal"
            axes.annotate(label, (time, error), offset, textcoords="offset points", ha=side, fontsize=9, fontweight=weight)
        axes.set(xscale="log", yscale="log", xlim=(2, 20000), ylim=ends, ylabel=name)
        for axis in (axes.xaxis, axes.yaxis):
            axis.set_major_formatter("{x:g}")
        axes.grid(linewidth=0.4)
    figure.supxlabel("time of a step, as a multiple of one pass over the positions", fontsize=9)
    save(figure, folder, "choices.svg", bbox_inches="tight")


if __name__ == "__main__":
    hint = ": run scripts/chart.sh full, then scripts/chart.sh docs"
    draw_in_folder(__doc__, "docs/chart", "choices", draw, hint)
