#!/usr/bin/env python3
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Draws choices.svg, a dozen labelled settings and methods on one scene, from chart.csv in one folder.

Usage: draw_choices.py [docs/chart]

scripts/chart.sh calls it. Needs matplotlib.
"""

import argparse
import csv
import os
import sys

try:
    import matplotlib

    matplotlib.use("svg")
    import matplotlib.pyplot as plot  # after the choice of output
except ModuleNotFoundError:
    matplotlib = None  # --help works without

SCENE = "deep-tori"
OWN = "law=pressure sampling={} precision={} layout=wide edges=on weights=area"
# Method and settings, the label, and where that stands beside its point, in points.
POINTS = [
    ("raycontact", OWN.format("automatic", "f64"), "default", (8, -3)),
    ("raycontact", OWN.format("automatic", "f32"), "default in single precision", (0, -12)),
    ("raycontact", OWN.format("vertices", "f64"), "vertices", (8, -7)),
    ("raycontact", OWN.format("spacing:0.081", "f64"), "spacing of two edges", (-8, -3)),
    ("raycontact", OWN.format("spacing:0.16", "f64"), "spacing of four edges", (-8, -3)),
    ("raycontact", OWN.format("spacing:0.32", "f64"), "spacing of eight edges", (8, 2)),
    ("raycontact", OWN.format("tolerance:0.1", "f64"), "tolerance 0.1", (8, 0)),
    ("raycontact", OWN.format("tolerance:0.03", "f64"), "tolerance 0.03", (8, 0)),
    ("paper", "law=ray-length sampling=vertices precision=f32 layout=wide edges=off weights=paper", "the paper's mode in single precision", (-8, 1)),
    ("embree-refit", "precision=f32 weights=paper", "Embree, Algorithm 1", (8, 3)),
    ("embree-refit", "precision=f32 weights=area", "Embree, area weights", (-8, -3)),
    ("bullet-vf", "precision=f32 weights=paper", "Bullet, vertices near faces", (-8, -3)),
    ("proximity", "precision=f64 weights=paper", "closest features", (-8, -3)),
]


def draw(folder):
    with open(os.path.join(folder, "chart.csv"), newline="", encoding="utf-8") as file:
        rows = {(row["method"], row["settings"]): row for row in csv.DictReader(file) if row["scene"] == SCENE}
    figure, axes = plot.subplots(figsize=(7.6, 4.6), layout="constrained")
    for method, settings, label, offset in POINTS:
        row = rows[method, settings]
        time, error = float(row["time_over_lower_bound"]), 100 * float(row["force_error"])
        is_own = method in ("raycontact", "paper")
        axes.plot(time, error, "o" if is_own else "s", color="#1b6ab3" if is_own else "#888888", markersize=6)
        side = {-1: "right", 0: "center", 1: "left"}[(offset[0] > 0) - (offset[0] < 0)]
        weight = "bold" if label.startswith("default") else "normal"
        axes.annotate(label, (time, error), offset, textcoords="offset points", ha=side, fontsize=9, fontweight=weight)
    axes.set(xscale="log", yscale="log", xlim=(2, 8000), ylim=(0.015, 200))
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_formatter("{x:g}")
    axes.set(xlabel="time of a step, as a multiple of one pass over the positions", ylabel="error of net force and torque, %")
    axes.grid(linewidth=0.4)
    # Neither date nor random names: the same figures give the same file.
    figure.savefig(os.path.join(folder, "choices.svg"), bbox_inches="tight", metadata={"Date": None})


def main():
    parser = argparse.ArgumentParser(
        description=__doc__.split("\n\n", maxsplit=1)[0],
        epilog="Exit status: 0 when drawn, 1 when something is missing, 2 for a wrong command line.",
    )
    parser.add_argument("folder", nargs="?", default="docs/chart", help="default: docs/chart")
    folder = parser.parse_args().folder
    if matplotlib is None:
        sys.exit("draw_choices.py: matplotlib is missing (Debian: python3-matplotlib)")
    # Letters as text and fixed names keep the file small and the same from run to run.
    matplotlib.rcParams.update({"svg.fonttype": "none", "svg.hashsalt": "choices", "font.size": 9})
    try:
        draw(folder)
    except (OSError, ValueError, KeyError) as error:
        sys.exit(f"draw_choices.py: {error}: run scripts/chart.sh full, then scripts/chart.sh docs")


if __name__ == "__main__":
    main()
