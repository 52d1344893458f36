#!/usr/bin/env python3
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Draws figure8.svg and convergence.svg from figure8.csv and convergence.csv in one folder.

Usage: draw_accuracy.py [docs/accuracy]

scripts/accuracy.sh measures and calls it. Needs Debian's python3-matplotlib.
"""

import os

import document_tables
from drawing import FuncFormatter, NullFormatter, draw_in_folder, plot, save

# Told apart by colour-blind readers too.
MODES = {
    "paper": ("paper: vertices, no areas", "#555555", "s"),
    "vertices": ("vertices, areas", "#ee8822", "o"),
    "default": ("default", "#1b6ab3", "D"),
}
CASES = {
    "ball": "ball on a slab",
    "globe": "ball by latitude and longitude, on a slab",
    "ellipsoid": "ellipsoid on a slab",
    "lens": "lens on a slab",
    "spheres": "two spheres",
    "tori": "two tori",
}


def read(folder, name, columns):
    """The rows of a CSV file, as dictionaries."""
    path = os.path.join(folder, name)
    rows = document_tables.rows(path)
    missing = [column for column in columns if not rows or column not in rows[0]]
    if missing:
        raise ValueError(f"{path} has no rows or no column {', '.join(missing)}: run scripts/accuracy.sh")
    return rows


def percent_axis(axis):
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{100 * value:g} %"))
    axis.set_minor_formatter(NullFormatter())


def count_axis(axis, ticks):
    axis.set_ticks(ticks)
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:,.0f}".replace(",", " ")))
    axis.set_minor_formatter(NullFormatter())


def draw_figure8(folder):
    rows = read(folder, "figure8.csv", ["sides", "mode", "mean", "worst"])
    figure, axes = plot.subplots(figsize=(7.2, 5.2), layout="constrained")
    axes.set(xscale="log", yscale="log", xlabel="sides of the cylinder", ylabel="tangential / normal force")
    for mode, (label, colour, marker) in MODES.items():
        own = [row for row in rows if row["mode"] == mode]
        sides = [int(row["sides"]) for row in own]
        for column, line in (("worst", "-"), ("mean", ":")):
            # Wide beneath the other, since the two are often one line.
            width = 3.0 if mode == "paper" else 1.3
            axes.plot(sides, [float(row[column]) for row in own], line, color=colour, linewidth=width,
                      marker=marker if column == "worst" else None, markersize=3.5, label=f"{label}: {column}")
    axes.plot([10, 150], [0.08, 0.01], "*", color="#c02050", markersize=11, label="the paper's figure: worst")
    axes.plot([10, 150], [0.01, 0.0005], "_", color="black", markersize=14, label="target of the default: worst")
    percent_axis(axes.yaxis)
    count_axis(axes.xaxis, [10, 20, 50, 100, 150])
    axes.grid(which="major", linewidth=0.4)
    figure.legend(fontsize=7.5, ncols=4, loc="lower center", bbox_to_anchor=(0.5, 1.0))
    save(figure, folder, "figure8.svg", bbox_inches="tight")


def draw_case(axes, rows):
    for mode, (_, colour, marker) in MODES.items():
        style = {"color": colour, "marker": marker, "markersize": 3.5, "linewidth": 1.3}
        for mesh, line in (("exact", "-"), ("fitted", "-"), ("inscribed", "--")):
            own = [row for row in rows if (row["mode"], row["mesh"]) == (mode, mesh)]
            triangles = [int(row["triangles"]) for row in own]
            axes.plot(triangles, [float(row["force_error"]) for row in own], line, **style)
            if mesh == "fitted" and own and own[0]["torque_error"]:
                torques = [float(row["torque_error"]) for row in own]
                axes.plot(triangles, torques, ":", markerfacecolor="white", **style)


def draw_convergence(folder):
    columns = ["case", "mesh", "mode", "triangles", "force_error", "torque_error"]
    rows = read(folder, "convergence.csv", columns)
    figure, panels = plot.subplots(2, 3, figsize=(10, 6.2), sharex=True, sharey=True, layout="constrained")
    guide = {"color": "#aaaaaa", "linewidth": 3, "alpha": 0.6}
    for axes, (case, title) in zip(panels.flat, CASES.items()):
        axes.set(xscale="log", yscale="log")
        axes.set_title(title, fontsize=9)
        # The error falls with the edge length squared, so with one over the number of triangles.
        axes.plot([500, 50000], [0.02, 0.0002], zorder=0, **guide)
        draw_case(axes, [row for row in rows if row["case"] == case])
        axes.plot([1600], [0.01], "_", color="black", markersize=14)
        percent_axis(axes.yaxis)
        count_axis(axes.xaxis, [500, 1600, 5000, 16000, 50000])
        axes.tick_params(labelsize=7.5)
        axes.grid(which="major", linewidth=0.4)
    figure.supxlabel("triangles of a body", fontsize=9)
    figure.supylabel("error", fontsize=9)

    def key(label, **style):
        return plot.Line2D([], [], label=label, **style)

    figure.legend(handles=[
        *(key(MODES[mode][0], color=MODES[mode][1], marker=MODES[mode][2], markersize=4)
          for mode in ("vertices", "default")),
        key("force, inscribed meshes", color="black", linestyle="--"),
        key("torque", color="black", linestyle=":", marker="o", markerfacecolor="white", markersize=4),
        key("order 2", **guide),
        key("target of the default", color="black", linestyle="", marker="_", markersize=12),
    ], loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=6, fontsize=8)
    save(figure, folder, "convergence.svg", bbox_inches="tight")


def draw(folder):
    draw_figure8(folder)
    draw_convergence(folder)


if __name__ == "__main__":
    draw_in_folder(__doc__, "docs/accuracy", "accuracy", draw)
