#!/usr/bin/env python3
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Draws a heat map of verdicts for each scene of map.csv, and counts the ok runs of each method by scene,
stiffness and time step.

Usage: draw_stability.py [FOLDER] [document.md]

FOLDER (default out/stability) holds map.csv and gets <scene>_map.svg. In the document, the lines between "<!-- map -->"
and "<!-- end -->" are replaced by the tables of counts. scripts/stability.sh runs the scenes and calls it. Needs Debian's
python3-matplotlib.

Exit status: 0; 1 where map.csv cannot be read; 2 for a wrong command line.
"""

import os

import document_tables
from drawing import draw_and_tabulate, plot, save

METHODS = {
    "ours": "raycontact, paper's law",
    "pressure": "raycontact, pressure law",
    "contact_system": "contact system, no Bullet",
    "paper": "raycontact, paper's mode",
    "classic": "raycontact, classic bodies",
    "vf_dd_implicit": "Bullet VF_DD, implicit",
    "vf_dd_explicit": "Bullet VF_DD, explicit",
    "vf_ss": "Bullet VF_SS",
    "cl_ss": "Bullet CL_SS",
}
# Told apart by colour-blind readers too, and by their letters.
VERDICTS = {
    "ok": ("#1b6ab3", ""),
    "overlapping": ("#f4b860", "o"),
    "inverted": ("#c08bd0", "i"),
    "passed_through": ("#d95f3b", "p"),
    "drifting": ("#7fbf7b", "d"),
    "exploded": ("#333333", "x"),
    "unfinished": ("#999999", "u"),
}


def read(path):
    rows = document_tables.rows(path)
    unknown = {row["verdict"] for row in rows} - set(VERDICTS)
    if not rows or unknown:
        raise ValueError(f"{path} has no rows or verdicts that nobody knows {sorted(unknown)}: run scripts/stability.sh")
    return rows


def draw_panel(axes, rows, steps):
    stiffnesses = sorted({float(row["stiffness"]) for row in rows})
    for row in rows:
        x, y = steps.index(float(row["dt"])), stiffnesses.index(float(row["stiffness"]))
        colour, letter = VERDICTS[row["verdict"]]
        axes.add_patch(plot.Rectangle((x, y), 0.94, 0.94, color=colour, linewidth=0))
        axes.text(x + 0.47, y + 0.47, letter, ha="center", va="center", color="white", fontsize=7)
    axes.set_xlim(0, len(steps))
    axes.set_ylim(0, max(1, len(stiffnesses)))
    axes.set_xticks([i + 0.47 for i in range(len(steps))], [f"{s:.2g}" for s in steps], rotation=60, fontsize=6)
    axes.set_yticks([])
    for side in axes.spines.values():
        side.set_visible(False)
    axes.tick_params(length=0)


def draw_scene(folder, scene, rows):
    methods = [m for m in METHODS if any(row["method"] == m for row in rows)]
    steps = sorted({float(row["dt"]) for row in rows})
    figure, panels = plot.subplots(1, len(methods), figsize=(1.75 * len(methods), 1.9), squeeze=False)
    for axes, method in zip(panels[0], methods):
        draw_panel(axes, [row for row in rows if row["method"] == method], steps)
        axes.set_title(METHODS[method].replace(", ", ",\n"), fontsize=7)
        axes.set_xlabel("time step / s", fontsize=6)
    # For all panels but those of methods that know no stiffness.
    stiffnesses = sorted({float(row["stiffness"]) for row in rows})
    panels[0][0].set_yticks([i + 0.47 for i in range(len(stiffnesses))], [f"{k:.3g}" for k in stiffnesses], fontsize=6)
    panels[0][0].set_ylabel("stiffness / (N/m)", fontsize=6)
    used = [v for v in VERDICTS if any(row["verdict"] == v for row in rows)]
    handles = [plot.Rectangle((0, 0), 1, 1, color=VERDICTS[v][0]) for v in used]
    labels = [v.replace("_", " ") + (f" ({VERDICTS[v][1]})" if VERDICTS[v][1] else "") for v in used]
    figure.legend(handles, labels, loc="upper center", ncol=len(used), fontsize=7, frameon=False, bbox_to_anchor=(0.5, 1.22))
    # Neither date nor random names: the same map gives the same file.
    plot.rcParams["svg.hashsalt"] = "raycontact"
    plot.rcParams["svg.fonttype"] = "none"
    save(figure, folder, f"{scene}_map.svg", bbox_inches="tight")


def count(rows):
    return f"{sum(row['verdict'] == 'ok' for row in rows)} of {len(rows)}" if rows else "–"


def table(title, groups):
    """The ok runs by method of groups of rows: (name, rows)."""
    methods = [m for m in METHODS if any(row["method"] == m for _, rows in groups for row in rows)]
    lines = [f"| {title} | " + " | ".join(METHODS[m] for m in methods) + " |", "| --- |" + " --- |" * len(methods)]
    for name, rows in groups:
        cells = [count([row for row in rows if row["method"] == m]) for m in methods]
        lines.append(f"| {name} | " + " | ".join(cells) + " |")
    return lines


def tables(rows, scenes):
    of_scenes = {scene: [row for row in rows if row["scene"] == scene] for scene in scenes}
    lines = table("scene", [(f"[{s}](stability/{s}_map.svg)", of_scenes[s]) for s in scenes] + [("all", rows)])
    by_part = {}
    for some in of_scenes.values():
        values = sorted({float(row["stiffness"]) for row in some})
        # The suggested one is in the middle. Methods that know no stiffness are listed with that alone.
        for row in some:
            by_part.setdefault(f"{float(row['stiffness']) / values[len(values) // 2]:.3g}", []).append(row)
    lines += ["", *table("part of the suggested stiffness", sorted(by_part.items(), key=lambda part: float(part[0])))]
    steps = sorted({float(row["dt"]) for row in rows})
    suggested = by_part["1"]
    by_step = [(f"{step:.3g}", [row for row in suggested if float(row["dt"]) == step]) for step in steps]
    return lines + ["", *table("time step / s, suggested stiffness", by_step)]


def draw(folder):
    rows = read(os.path.join(folder, "map.csv"))
    scenes = list(dict.fromkeys(row["scene"] for row in rows))
    for scene in scenes:
        draw_scene(folder, scene, [row for row in rows if row["scene"] == scene])
    return tables(rows, scenes)


if __name__ == "__main__":
    draw_and_tabulate(__doc__, "out/stability", "map", draw)
