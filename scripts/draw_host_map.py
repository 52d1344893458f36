#!/usr/bin/env python3
# SPDX-License-Identifier: MIT OR Apache-2.0
"""Draws which runs of other hosts' scenes end well, by who makes the contact and by time step.

FOLDER (default docs/hosts) holds map.csv with the columns host, scene, contact, dt, verdict, and gets map.svg. The lines of
MuJoCo are those of `mujoco_flexes map`, SOFA's are those of
`plugins/sofa/tests/measure.py --map`. Needs Debian's python3-matplotlib.
"""

import os

from draw_stability import VERDICTS
import document_tables
from drawing import draw_in_folder, plot, save

CONTACTS = {
    "raycontact": "raycontact",
    "raycontact_own_solvers": "raycontact, a solver each",
    "mujoco": "MuJoCo, constraints",
    "passive": "MuJoCo, passive",
    "sofa": "SOFA, ray tracing",
    "raycontact_sofa_response": "raycontact, SOFA's response",
}


def read(path):
    rows = document_tables.rows(path)
    unknown = {row["verdict"] for row in rows} - set(VERDICTS) | {row["contact"] for row in rows} - set(CONTACTS)
    if not rows or unknown:
        raise ValueError(f"{path} has no rows, or verdicts or contacts that nobody knows: {sorted(unknown)}")
    return rows


def draw_panel(axes, rows):
    contacts = [c for c in CONTACTS if any(row["contact"] == c for row in rows)][::-1]
    steps = sorted({float(row["dt"]) for row in rows})
    for row in rows:
        x, y = steps.index(float(row["dt"])), contacts.index(row["contact"])
        colour, letter = VERDICTS[row["verdict"]]
        axes.add_patch(plot.Rectangle((x, y), 0.94, 0.94, color=colour, linewidth=0))
        axes.text(x + 0.47, y + 0.47, letter, ha="center", va="center", color="white", fontsize=8)
    axes.set_xlim(0, len(steps))
    axes.set_ylim(0, len(contacts))
    axes.set_xticks([i + 0.47 for i in range(len(steps))], [f"{s:g}" for s in steps], fontsize=7)
    axes.set_yticks([i + 0.47 for i in range(len(contacts))], [CONTACTS[c] for c in contacts], fontsize=7)
    axes.set_xlabel("time step / s", fontsize=7)
    for side in axes.spines.values():
        side.set_visible(False)
    axes.tick_params(length=0)


def draw(folder):
    rows = read(os.path.join(folder, "map.csv"))
    scenes = list(dict.fromkeys((row["host"], row["scene"]) for row in rows))
    columns = 2
    lines = -(-len(scenes) // columns)
    figure, panels = plot.subplots(lines, columns, figsize=(9, 1.5 * lines), squeeze=False)
    for axes, (host, scene) in zip(panels.flat, scenes):
        draw_panel(axes, [row for row in rows if (row["host"], row["scene"]) == (host, scene)])
        axes.set_title(f"{host}: {scene}", fontsize=8)
    for axes in panels.flat[len(scenes) :]:
        axes.axis("off")
    used = [v for v in VERDICTS if any(row["verdict"] == v for row in rows)]
    handles = [plot.Rectangle((0, 0), 1, 1, color=VERDICTS[v][0]) for v in used]
    labels = [v.replace("_", " ") + (f" ({VERDICTS[v][1]})" if VERDICTS[v][1] else "") for v in used]
    figure.tight_layout()
    figure.legend(handles, labels, loc="upper center", ncol=len(used), fontsize=7, frameon=False, bbox_to_anchor=(0.5, 1.04))
    save(figure, folder, "map.svg", bbox_inches="tight")


if __name__ == "__main__":
    draw_in_folder(__doc__, "docs/hosts", "raycontact", draw)
